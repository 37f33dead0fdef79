"""Overrun prevention: the pattern to the stop mark comes with the timetable alone, and goes with a stop at the mark.

Source: principle [P]; 1 km/h for 1 s, 5 m [A].
Main results: no timetable, no pattern; it ends only after the train has truly stood for 1 s within the window widened
by the uncertainty of the position; with a window without bounds a standstill anywhere ends it.
"""

from __future__ import annotations

from models.ats.overrun import AnywhereBench, StopBench
from safety import PROVED, REFUTED, Bit, Seen, claim, implies

SOURCE = "[P] overrun prevention; [A] window, times"
OPEN = (
    "mark_at",
    *(f"station.{name}" for name in ("cycle", "approach", "window", "uncertain", "standstill", "patience")),
)


def estimated(s: Seen) -> Bit:
    """The head is within `uncertain` of the estimate."""
    off = s.pos - s.where.guess
    return (off <= s.station.uncertain) & (-off <= s.station.uncertain)


def counted(s: Seen) -> Bit:
    """Lemma: no more standstill has been counted than there was."""
    return (s.station.still >= 0) & (s.station.still <= s.stood)


@claim(StopBench, expect=PROVED, symbolic=OPEN, requirement="AO-1", source=SOURCE)
def only_the_timetable_makes_it(s: Seen) -> Bit:
    """The pattern is made only where the timetable says stop, the position is sure, and the mark lies ahead."""
    return implies(s.made, s.timetable_stop & s.known & (s.where.low < s.mark_at))


@claim(StopBench, expect=REFUTED, symbolic=OPEN, requirement="AO-1", source=SOURCE,
       twin_of=only_the_timetable_makes_it)  # fmt: skip
def a_sure_position_makes_it(s: Seen) -> Bit:
    """It is made wherever the position is sure and the mark lies ahead."""
    return implies(s.known & (s.where.low < s.mark_at), s.made)


@claim(StopBench, expect=PROVED, given=estimated, lemmas=[counted], symbolic=OPEN, requirement="AO-1", source=SOURCE)
def only_a_stop_at_the_mark_ends_it(s: Seen) -> Bit:
    """The pattern ends only after the train has stood for `patience` within the window, as it truly is."""
    return implies(s.ended, s.standing >= s.station.patience)


@claim(StopBench, expect=REFUTED, lemmas=[counted], symbolic=OPEN, requirement="AO-1", source=SOURCE,
       twin_of=only_a_stop_at_the_mark_ends_it)  # fmt: skip
def only_a_stop_at_the_mark_ends_it_wherever_it_is(s: Seen) -> Bit:
    """So it is where the estimate is further off."""
    return only_a_stop_at_the_mark_ends_it(s)


def by_7_m(s: Seen) -> Bit:
    """The head is within 7 m of the mark."""
    return (s.pos - s.mark_at <= 7) & (s.mark_at - s.pos <= 7)


def estimated_by_2_m(s: Seen) -> Bit:
    """The head is within 2 m of the estimate."""
    return (s.pos - s.where.guess <= 2) & (s.where.guess - s.pos <= 2)


@claim(StopBench, expect=PROVED, given=estimated_by_2_m, symbolic=["mark_at"], requirement="AO-1",
       source=SOURCE)  # fmt: skip
def it_ends_at_the_mark(s: Seen) -> Bit:
    """With a window of 5 m, and an estimate that is 2 m off at most, it ends within 7 m of the mark."""
    return implies(s.ended, by_7_m(s))


@claim(AnywhereBench, expect=REFUTED, given=estimated_by_2_m, symbolic=["mark_at"], requirement="AO-1", source=SOURCE,
       twin_of=it_ends_at_the_mark)  # fmt: skip
def it_ends_at_the_mark_with_any_standstill(s: Seen) -> Bit:
    """So it does where a standstill anywhere is taken for one."""
    return it_ends_at_the_mark(s)


@claim(StopBench, expect=REFUTED, symbolic=["mark_at"], requirement="AO-1", source=SOURCE, twin_of=it_ends_at_the_mark)
def it_ends_at_the_mark_wherever_it_is(s: Seen) -> Bit:
    """So it does where the estimate is further off."""
    return it_ends_at_the_mark(s)
