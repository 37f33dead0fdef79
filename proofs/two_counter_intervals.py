"""Two-counter ATC: how many edges of the speed generator lie between the events of a sample.

What the error bound rests on (`two_counter_accuracy`), as claims about the equipment: a count takes in no more than m
edges, and from the end of one to the read-out of the next come no more than m + 10, whatever the speed does.  One step
is one oscillator period; the check speed stays what it is.
Source: preset, 4 pulses of preparation, read-out after 1 [D].
"""

from __future__ import annotations

from models.two_counter.circuit import READ_OUT
from models.two_counter.equipment import Equipment
from proofs.two_counter_formulas import (
    PREPARATION,
    counting,
    edges,
    greatest_permitted,
    kept,
    last_preset,
    preparation_in_order,
    steadily,
)
from safety import PROVED, REFUTED, Bit, Int, Seen, bit, claim, implies, last, once, select, total

LONG = 2**40  # edges that are counted: ten years; from then on the difference of two totals is less than it was


def check_speed_stays(s: Seen) -> Bit:
    """The check speed is what it was a step before."""
    return implies(once(bit(True)), kept(s))


def before(s: Seen) -> Int:
    """Edges before this step."""
    return total(s["train.edge"].word(), LONG).int()


def come(s: Seen) -> Int:
    """Edges up to this step, its own included."""
    return before(s) + s["train.edge"].word()


def closes(s: Seen) -> Bit:
    """A count ends in this step."""
    return counting(s) & ~s.gate


def start(s: Seen) -> Int:
    """Edges up to the start of the last count."""
    return last(come(s), s.signal3, 0)  # type: ignore[no-any-return]


def end(s: Seen) -> Int:
    """Edges up to the end of the last count, from power-up if there was none."""
    return last(come(s), closes(s), 0)  # type: ignore[no-any-return]


def end_before_start(s: Seen) -> Int:
    """Edges up to the end of the count that was the last one when the last count started."""
    return last(end(s), s.signal3, 0)  # type: ignore[no-any-return]


def edges_are_counted(s: Seen) -> Bit:
    """Lemma: counter 2 has the edges since the last event of a sample; those between the events are known."""
    m, n = last_preset(s).int(), edges(s).int()
    in_count = (before(s) <= start(s) + n) & (start(s) <= end(s) + PREPARATION) & (end(s) <= end_before_start(s))
    in_preparation = (before(s) <= end(s) + n) & (end(s) <= end_before_start(s) + m + PREPARATION)
    return select(counting(s), in_count & (n < m), in_preparation)


def at_power_up(s: Seen) -> Bit:
    """Lemma: the check speed may be a new one only at power-up, when nothing has been counted."""
    nothing = ~counting(s) & (edges(s) == 0) & (before(s) == 0) & (end(s) == 0) & (end_before_start(s) == 0)
    return once(bit(True)) | nothing


LEMMAS = [at_power_up, preparation_in_order, edges_are_counted]
RUN = steadily(250, greatest_permitted(1035), 4300)


@claim(Equipment, expect=PROVED, requirement="TC-5", source="presets [D]", given=check_speed_stays, lemmas=LEMMAS,
       witness=RUN)  # fmt: skip
def a_count_has_m_edges(s: Seen) -> Bit:
    """From signal 3 to the end of the count come m edges at most."""
    return implies(closes(s), come(s) <= start(s) + last_preset(s).int())


@claim(
    Equipment, expect=REFUTED, requirement="TC-5", given=check_speed_stays, scenario=RUN, twin_of=a_count_has_m_edges
)
def a_count_has_fewer_edges(s: Seen) -> Bit:
    """There come fewer than m."""
    return implies(closes(s), come(s) < start(s) + last_preset(s).int())


def to_the_next_read_out(s: Seen, spare: int = 0) -> Bit:
    """At signal 1, the edges since the end of the count before the last are m + 10 at most, or less."""
    most = last_preset(s).int() + PREPARATION + READ_OUT - spare
    return implies(s.signal1, come(s) <= end_before_start(s) + most)


@claim(Equipment, expect=PROVED, requirement="TC-5", source="4 pulses, read-out after 1 [D]", given=check_speed_stays,
       lemmas=LEMMAS)  # fmt: skip
def the_next_read_out_comes_after_m_plus_10_edges(s: Seen) -> Bit:
    """From the end of a count to the read-out of the next come m + 10 edges at most: n2E + 5 pulses."""
    return to_the_next_read_out(s)


@claim(Equipment, expect=REFUTED, requirement="TC-5", given=check_speed_stays, scenario=RUN,
       twin_of=the_next_read_out_comes_after_m_plus_10_edges)  # fmt: skip
def the_next_read_out_comes_after_m_plus_9_edges(s: Seen) -> Bit:
    """There come m + 9 at most."""
    return to_the_next_read_out(s, 1)
