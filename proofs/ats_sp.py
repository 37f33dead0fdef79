"""The on-board set of ATS-SP: what a reading does, and that every line that is lost brakes.

Source: architecture, energise-to-release [P]; rules in detail [A].
Main results: a balise that is not understood acts as one at stop; one of another signal does nothing to the home
signal's pattern; without a sure position a stop reading makes the
pattern for the shortest distance; supply or cycle lost brakes at once; "stopping" is told only behind a stop pattern.
"""

from __future__ import annotations

from models.ats.ats_sp import AnySignalCounts, AtsSp, KeepsAPlace, UnknownProceeds
from models.kinematics import CYCLE
from models.position.correction import REFERENCE
from safety import PROVED, REFUTED, Bit, Fault, Seen, at_most, claim, implies, stuck

SOURCE = "[P] architecture; [A] rules in detail"


def restrictive(s: Seen) -> Bit:
    """A signal, release or branch balise is passed, and its shift is that of stop or diverging, or none that is
    known."""
    return s.shift.seen & (s.shift.kind != REFERENCE) & (s.shift.stop | ~s.shift.proceed)


@claim(AtsSp, expect=PROVED, requirement="AV-2", source=SOURCE)
def a_stop_balise_makes_a_pattern(s: Seen) -> Bit:
    """A signal or release balise at stop, a branch balise of a diverging route, or one that is not understood, makes a
    pattern in its cycle: that of its target, or, where it cannot be assigned, the one for the shortest distance."""
    assigned = s.locator.matched.adopted & (s.sp.home.target.pattern | s.sp.turnout.target.pattern)
    return implies(restrictive(s), assigned | s.sp.blind.target.pattern)


@claim(UnknownProceeds, expect=REFUTED, requirement="AV-2", source=SOURCE, twin_of=a_stop_balise_makes_a_pattern)
def a_stop_balise_makes_a_pattern_where_unknown_is_proceed(s: Seen) -> Bit:
    """So it does where a reading that is not understood is taken for proceed."""
    return a_stop_balise_makes_a_pattern(s)


SILENT = Fault(stuck(0), ["coil.seen"], name="coil silent")


@claim(AtsSp, expect=REFUTED, faults=at_most(1, [SILENT]), requirement="AV-2", source=SOURCE, defeat=True,
       twin_of=a_stop_balise_makes_a_pattern)  # fmt: skip
def a_stop_balise_makes_a_pattern_with_a_silent_coil(s: Seen) -> Bit:
    """So it does with a coil that reads nothing: only the map of expected balises finds that."""
    return a_stop_balise_makes_a_pattern(s)


def of_another_signal(s: Seen) -> Bit:
    """A balise is passed and found in the line data, as that of another target."""
    matched, ours = s.locator.matched, s.locator.correction.data.a.place
    return s.shift.seen & matched.adopted & (matched.fix.place != ours)


@claim(AtsSp, expect=PROVED, requirement="AV-2", source=SOURCE)
def another_signal_does_nothing_to_the_pattern(s: Seen) -> Bit:
    """A balise of another signal neither makes the home signal's pattern nor ends it."""
    home, told = s.sp.home.target, s.receiver.back_at_stop | s.receiver.released
    ends = s.sp.freed | told | (s.locator.position.low >= s.sp.signal_at)
    return implies(of_another_signal(s), (home.active | ~home.pattern | told) & (~home.active | home.pattern | ends))


@claim(AnySignalCounts, expect=REFUTED, requirement="AV-2", source=SOURCE,
       twin_of=another_signal_does_nothing_to_the_pattern)  # fmt: skip
def another_signal_does_nothing_where_any_counts(s: Seen) -> Bit:
    """So it is where each balise that is matched counts as one of the home signal."""
    return another_signal_does_nothing_to_the_pattern(s)


@claim(AtsSp, expect=PROVED, requirement="AV-2", source=SOURCE)
def no_fix_lifts_the_worst_pattern(s: Seen) -> Bit:
    """Whatever a code or a balise tells of the position, the pattern for the shortest distance stays until stop and
    reset, and what is left to its target falls by what the upper speed runs, or by more."""
    blind = s.sp.blind.target
    falls = blind.left <= blind.rest - s.locator.position.fastest * CYCLE
    return implies(blind.active & ~s.sp.freed, blind.pattern & falls)


@claim(KeepsAPlace, expect=REFUTED, requirement="AV-2", source=SOURCE, twin_of=no_fix_lifts_the_worst_pattern)
def no_fix_lifts_the_worst_pattern_at_a_place(s: Seen) -> Bit:
    """So it is where its target is kept as a place."""
    return no_fix_lifts_the_worst_pattern(s)


@claim(AtsSp, expect=PROVED, requirement="AV-2", source=SOURCE)
def a_lost_position_makes_the_worst_pattern(s: Seen) -> Bit:
    """In the cycle in which the position ceases to be sure there is the pattern for the shortest distance."""
    return implies(s.sure & ~s.locator.matched.reliable, s.sp.blind.target.pattern)


@claim(AtsSp, expect=REFUTED, requirement="AV-2", source=SOURCE, twin_of=a_lost_position_makes_the_worst_pattern)
def an_unsure_position_keeps_the_worst_pattern(s: Seen) -> Bit:
    """There is that pattern whenever the position is not sure: not before it has been sure for the first time."""
    return implies(~s.locator.matched.reliable, s.sp.blind.target.pattern)


@claim(AtsSp, expect=PROVED, requirement="SP-F1", source=SOURCE)
def a_lost_line_brakes(s: Seen) -> Bit:
    """Supply or program cycle lost, or a brake asked for: its line is dead in the same cycle."""
    lost = ~s.inputs.supply | ~s.inputs.cycle
    return implies(lost | s.sp.service, ~s.service_line) & implies(lost | s.sp.emergency, ~s.emergency_line)


HELD = Fault(stuck(1), ["service_line"], name="service line held")


@claim(AtsSp, expect=REFUTED, faults=at_most(1, [HELD]), requirement="SP-F1", source=SOURCE, twin_of=a_lost_line_brakes)
def a_lost_line_brakes_with_a_stuck_output(s: Seen) -> Bit:
    """So it does with an output that is stuck energised."""
    return a_lost_line_brakes(s)


@claim(AtsSp, expect=PROVED, requirement="AO-1", source=SOURCE)
def stopping_is_told_behind_a_pattern(s: Seen) -> Bit:
    """The set tells a crossing "stopping" only while the pattern to the stop mark acts, and the position is sure."""
    return implies(s.loop, s.sp.station.target.pattern & s.locator.matched.reliable)


LOOP = Fault(stuck(1), ["loop"], name="false stopping")


@claim(AtsSp, expect=REFUTED, faults=at_most(1, [LOOP]), requirement="AO-1", source=SOURCE,
       twin_of=stopping_is_told_behind_a_pattern)  # fmt: skip
def stopping_is_told_behind_a_pattern_with_a_false_message(s: Seen) -> Bit:
    """So it does with a loop coil that says "stopping" for ever."""
    return stopping_is_told_behind_a_pattern(s)
