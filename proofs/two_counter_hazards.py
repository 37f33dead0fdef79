"""Two-counter ATC at 250 km/h: minimal cut sets of "too fast and no brake", over component faults at any time.

Three lists of faults, each complete at every order: the functional failures of all components; the stages of the
counters that do harm (the others are claims); lines and bits of the check-speed selection.  Sets across the lists are
not among them: the campaign of pairs injects these.

Results: 61 single faults, 21 of 56 functional failures, 33 of 44 stages, 7 of 39 of the selection; and 8 pairs, all of
the selection.  What the paper concedes is seen here: hardly anything in this circuit is redundant.  Beside the known
defeats (`DEFEATS`, of property 15) there are those of `FURTHER`, each with its reason; see `two_counter_wrong_side`,
also for the other check speeds.

That signal 3 is missing does not hold the command for ever: counter 2 has 11 stages and runs through 0 again, so the
next read-out brakes, 2050 edges later, which is later than property 4 allows.

Too fast: a speed at which the count is sure to fall short of n1F, for the 2 n2E + 5 pulses of property 4.
Not in these lists: `SIMULATED`.  Signals 1 and 2 swapped are a claim of their own (`two_counter_swapped`); a generator
that reads high or low is injected only, since its offset would reach what the model assumes of the phase of the axle.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from models.two_counter.equipment import Equipment
from models.two_counter.failures import component_faults
from proofs.two_counter_brake_chain import Chain, excuse
from proofs.two_counter_formulas import Formula, named
from proofs.two_counter_parts import INVENTED, component_rate
from proofs.two_counter_rides import Ride
from proofs.two_counter_wrong_side import defeats, further, singles
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    TRANSIENT,
    Bit,
    Fault,
    Scenario,
    Seen,
    at_most,
    claim,
    hazard,
    implies,
)

DEFEATS, FURTHER, SINGLES = defeats(1035), further(1035), singles(1035)

SIMULATED = ("generator 5 km/h high", "generator 5 km/h low", "signals 1 and 2 swapped")


def chosen(which: Callable[[str], bool]) -> list[Fault]:
    """The component faults with such names, at any time."""
    found = (f for f in component_faults() if f.name not in SIMULATED and which(f.name))
    return [f if f.onset == TRANSIENT else replace(f, onset=ANY_TIME) for f in found]


FUNCTIONAL = chosen(lambda name: ": stage" not in name and "preset bit" not in name)
COUNTERS = chosen(lambda name: ": stage" in name and name in SINGLES)
STAGES_AT_0 = chosen(lambda name: ": stage" in name and name not in SINGLES)  # of counter 1
SELECTION = chosen(lambda name: name.startswith(("preset", "line", "no selection")))
LOWER = ("line s250 missing", *(f"line s{v} besides" for v in (210, 160, 110, 70, 30, 5)), "no selection")
PAIRS = tuple(("preset bit 10 at 1", name) for name in LOWER)  # 1024 added to the preset of a lower check speed


def chain(faults: Sequence[Fault]) -> Chain:
    """The way to the brake where these faults may be."""
    return Chain(1035, excuse(faults, (*SINGLES, "power off"), PAIRS), excuse(faults, ("counting gate at 0",), ()))


def rates(faults: Sequence[Fault]) -> dict[str, tuple[str, str]]:
    """Failures per hour of each, from the parts list."""
    return {fault.name: (component_rate(fault), INVENTED) for fault in faults}


RIDE = Ride(250)
CHAIN, LINES = RIDE.chain, RIDE.lines


def only_250(s: Seen) -> Bit:
    """The check speed 250 km/h is selected, and no other."""
    return RIDE.selected(s)


@hazard(
    Equipment, faults=FUNCTIONAL, scenarios=RIDE.scenarios, lemmas=chain(FUNCTIONAL).lemmas(),
    rates=rates(FUNCTIONAL), hours="10000",
    requirement="TC-16", source="[D]", expect={1: 21},
)  # fmt: skip
def overspeed_without_brake(s: Seen) -> Bit:
    """At 250 km/h, after a functional failure: overspeed for 4019 steps (0.626 s) and no brake."""
    return RIDE.too_fast_too_long(s) & ~s.brake


def with_fault(fault: Fault) -> Formula:
    """The claim that one component fault does no harm."""

    def formula(s: Seen) -> Bit:
        return implies(RIDE.too_fast_too_long(s), s.brake)

    formula.__doc__ = f"At 250 km/h, with {fault.name}, at any time, overspeed for 4019 steps (0.626 s) brakes."
    return named(brakes_with(fault), formula)


def brakes_with(fault: Fault) -> str:
    """The name of such a claim."""
    return f"brakes_with_{fault.name.replace(':', '').replace(' ', '_')}"


HARMLESS_STAGES = [
    claim(
        Equipment, expect=PROVED, faults=at_most(1, [one]), lemmas=chain([one]).lemmas(),
        witness=Scenario(5000, {**LINES, "speed": CHAIN.speed}), requirement="TC-16", source="[D]",
    )(with_fault(one))
    for one in STAGES_AT_0
]  # fmt: skip


@claim(
    Equipment, expect=REFUTED, faults=at_most(1, COUNTERS), requirement="TC-16", defeat=True,
    source="property 15 (l)", scenario=RIDE.scenarios(("counter 1: stage 0 at 1",))[0],
)  # fmt: skip
def brakes_with_a_stage_at_1(s: Seen) -> Bit:
    """At 250 km/h, with a stage of counter 1 stuck at 1, overspeed for 4019 steps (0.626 s) brakes."""
    return implies(RIDE.too_fast_too_long(s), s.brake)


@hazard(
    Equipment, faults=COUNTERS, scenarios=RIDE.scenarios, lemmas=chain(COUNTERS).lemmas(),
    rates=rates(COUNTERS), hours="10000",
    requirement="TC-16", source="[D]", expect={1: 33},
)  # fmt: skip
def overspeed_without_brake_by_a_stage(s: Seen) -> Bit:
    """At 250 km/h, with stages of the counters stuck: overspeed for 4019 steps (0.626 s) and no brake."""
    return RIDE.too_fast_too_long(s) & ~s.brake


@hazard(
    Equipment, faults=SELECTION, scenarios=RIDE.scenarios, given=only_250, lemmas=chain(SELECTION).lemmas(),
    rates=rates(SELECTION), hours="10000",
    requirement="TC-16", source="[D]", expect={1: 7, 2: 8},
)  # fmt: skip
def overspeed_without_brake_by_the_selection(s: Seen) -> Bit:
    """At 250 km/h, with lines or bits of the preset stuck: overspeed for 4019 steps (0.626 s) and no brake."""
    return RIDE.too_fast_too_long(s) & ~s.brake
