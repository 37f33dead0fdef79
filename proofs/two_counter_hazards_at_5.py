"""Two-counter ATC at 5 km/h, the other extreme: minimal cut sets of "too fast and no brake", as at 250 km/h.

The same three lists of faults as in `two_counter_hazards`, complete at every order, while 5 km/h is selected; the
stages that are stuck at 0 without doing harm are claims by themselves.

Results: 58 single faults, 22 of 39 functional failures, 28 of 44 stages, 8 of 39 of the selection; and 6 pairs: the
line of 5 km/h missing and another one besides.  Unlike at 250 km/h, six edges of preparation more or less are no small
part of a count (57 edges), and a counting gate that breaks off a count is wrong-side: counter 2 then runs on to 2048
before a read-out comes, which takes 11 s.  Five stages of counter 2 lie beyond the preset: stuck at 0 they do nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

from models.two_counter.equipment import Equipment
from models.two_counter.selection import Lines
from proofs.two_counter_brake_chain import Chain, excuse
from proofs.two_counter_formulas import Formula, named
from proofs.two_counter_hazards import brakes_with, chosen, rates
from proofs.two_counter_rides import Ride
from proofs.two_counter_wrong_side import singles
from safety import (
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Scenario,
    Seen,
    at_most,
    claim,
    hazard,
    implies,
)

RIDE = Ride(5)
SINGLES_AT_5 = singles(RIDE.m)
PAIRS_AT_5 = tuple(("line s5 missing", f"line {name} besides") for name in Lines._fields if name != "s5")

SELECTION = chosen(lambda name: name.startswith(("preset", "line", "no selection")))
COUNTERS = chosen(lambda name: ": stage" in name and name in SINGLES_AT_5)
STAGES_AT_0 = chosen(lambda name: ": stage" in name and name not in SINGLES_AT_5)
LISTED = {fault.name for fault in (*SELECTION, *COUNTERS, *STAGES_AT_0)}
FUNCTIONAL = chosen(lambda name: name not in LISTED)


def lemmas(faults: Sequence[Fault]) -> list[Formula]:
    """The way to the brake where these faults may be."""
    return Chain(RIDE.m, excuse(faults, (*SINGLES_AT_5, "power off"), PAIRS_AT_5)).lemmas()


def only_5(s: Seen) -> Bit:
    """The check speed 5 km/h is selected, and no other."""
    return RIDE.selected(s)


@hazard(
    Equipment, faults=FUNCTIONAL, scenarios=RIDE.scenarios, given=only_5, lemmas=lemmas(FUNCTIONAL),
    rates=rates(FUNCTIONAL), hours="10000", requirement="TC-16", source="[D]", expect={1: 22},
)  # fmt: skip
def overspeed_without_brake_at_5(s: Seen) -> Bit:
    """At 5 km/h, after a functional failure: overspeed for 4350 steps (0.678 s) and no brake."""
    return RIDE.too_fast_too_long(s) & ~s.brake


@hazard(
    Equipment, faults=COUNTERS, scenarios=RIDE.scenarios, given=only_5, lemmas=lemmas(COUNTERS),
    rates=rates(COUNTERS), hours="10000", requirement="TC-16", source="[D]", expect={1: 28},
)  # fmt: skip
def overspeed_without_brake_by_a_stage_at_5(s: Seen) -> Bit:
    """At 5 km/h, with stages of the counters stuck: overspeed for 4350 steps (0.678 s) and no brake."""
    return RIDE.too_fast_too_long(s) & ~s.brake


@hazard(
    Equipment, faults=SELECTION, scenarios=RIDE.scenarios, given=only_5, lemmas=lemmas(SELECTION),
    rates=rates(SELECTION), hours="10000", requirement="TC-16", source="[D]", expect={1: 8, 2: 6},
)  # fmt: skip
def overspeed_without_brake_by_the_selection_at_5(s: Seen) -> Bit:
    """At 5 km/h, with lines or bits of the preset stuck: overspeed for 4350 steps (0.678 s) and no brake."""
    return RIDE.too_fast_too_long(s) & ~s.brake


def with_fault(fault: Fault) -> Formula:
    """The claim that one component fault does no harm."""

    def formula(s: Seen) -> Bit:
        return implies(RIDE.too_fast_too_long(s), s.brake)

    formula.__doc__ = f"At 5 km/h, with {fault.name}, at any time, overspeed for 4350 steps (0.678 s) brakes."
    return named(f"{brakes_with(fault)}_at_5", formula)


HARMLESS_AT_5 = [
    claim(
        Equipment, expect=PROVED, faults=at_most(1, [one]), given=only_5, lemmas=lemmas([one]),
        witness=Scenario(5000, {**RIDE.lines, "speed": RIDE.chain.speed}), requirement="TC-16", source="[D]",
    )(with_fault(one))
    for one in STAGES_AT_0
]  # fmt: skip


@claim(Equipment, expect=REFUTED, faults=at_most(1, COUNTERS), given=only_5, requirement="TC-16", defeat=True,
       source="property 15 (l)", scenario=RIDE.scenarios(("counter 1: stage 9 at 1",))[0])  # fmt: skip
def brakes_with_a_stage_at_1_at_5(s: Seen) -> Bit:
    """At 5 km/h, with a stage of counter 1 stuck at 1, overspeed for 4350 steps (0.678 s) brakes."""
    return implies(RIDE.too_fast_too_long(s), s.brake)
