"""Two-counter ATC: section 5 taken at its word releases a train that is too fast; read consistently it does not.

The paper says of overspeed that FF6 "remains set by signal 2" and that signal 1 "resets" FF2.  Each of the two, put
beside its sentences about the normal case, gives a circuit that releases at overspeed; the runs are the solver's.
Source: section 5 [P]; the consistent reading is proved in two_counter_decision.
"""

from __future__ import annotations

from models.two_counter.equipment import Equipment
from models.two_counter.train import KMH
from models.two_counter.variants import SignalOneResets, SignalTwoSets
from proofs.two_counter_decision import no_release_on_overspeed
from proofs.two_counter_formulas import (
    counted,
    counting,
    edges,
    position,
    preparation_in_order,
    preset,
    safe,
)
from safety import PROVED, REFUTED, Bit, Seen, claim, implies

SMALLEST = 16  # edges: with the smallest preset that is admitted the solver's run is shorter, nothing else changes
SETTINGS = {"selection.m5": SMALLEST}
AT_ONCE = 11  # periods with the inputs held: at 400 km/h such a sample takes 33


def always_too_fast(s: Seen) -> Bit:
    """400 km/h on the frequency scale from power-up on, twenty-five times the speed permitted or more."""
    return (s.speed == 400 * KMH) & (preset(s) == SMALLEST)


def just_after_an_edge(s: Seen) -> Bit:
    """An edge has just come at power-up."""
    return s.train.phase == 0


@claim(SignalTwoSets, start=just_after_an_edge, given=always_too_fast, settings=SETTINGS, steps=4,
       steps_per_frame=AT_ONCE, expect=REFUTED, requirement="TC-2", source="[P] FF6 remains set by signal 2",
       twin_of=no_release_on_overspeed)  # fmt: skip
def never_releases_if_signal_2_sets(s: Seen) -> Bit:
    """Literal reading L1, always too fast: never released.  False: FF6 is set whatever was counted."""
    return s.brake


@claim(SignalOneResets, start=just_after_an_edge, given=always_too_fast, settings=SETTINGS, steps=4,
       steps_per_frame=AT_ONCE, expect=REFUTED, requirement="TC-2", source="[P] FF2 is reset by signal 1",
       twin_of=no_release_on_overspeed)  # fmt: skip
def never_releases_if_signal_1_resets(s: Seen) -> Bit:
    """Literal reading L2, always too fast: never released.  False: every reading releases."""
    return s.brake


def nothing_said_safe(s: Seen) -> Bit:
    """Counter 2 runs ahead of counter 1; FF6 is reset, FF2 set."""
    ahead = (edges(s) < SMALLEST) & (position(s) >= 400 * KMH * (counted(s).int() - 1))
    return ~safe(s) & s.circuit.ff2.on & implies(counting(s), ahead)


@claim(Equipment, start=just_after_an_edge, given=always_too_fast, settings=SETTINGS, expect=PROVED, requirement="TC-2",
       source="[P] section 5", lemmas=[preparation_in_order, nothing_said_safe])  # fmt: skip
def never_releases_if_read_consistently(s: Seen) -> Bit:
    """Consistent reading, always too fast: never released."""
    return s.brake
