"""Two-counter ATC at 250 km/h: every failure mode of its components injected, singly and in pairs.

All 125 modes of `component_modes()`.  One step is an oscillator period.  The train runs at 250 km/h on the frequency
scale, 8.75 km/h below the threshold, and is released; the fault strikes; then it runs at the least speed at which the
brake is certain, for twice the time in which the proof has it applied (2 n2E + 5 pulses, 4019 steps).

Wrong side: no brake after that time.  Safe side: a brake within the limit.  Nothing in the equipment detects a fault:
the diagnostic coverage is 0.  Three moments of fault and overspeed: both in one count, the fault late in it, and the
overspeed in a preparation; transients end just before the overspeed.

Results: 62 of the 125 modes are wrong-side: the 61 single cut sets of `two_counter_hazards`, all of them and no others,
and the generator that reads low, of which no proof is.  Of 7750 pairs, both striking early, 4472 are: all but 8 with a
mode that is so by itself, and these 8 are the pairs of the proof, 1024 added to the preset of a lower check speed.  In
1333 pairs the other fault hides a wrong-side one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

from models.two_counter.equipment import Equipment
from models.two_counter.failures import component_faults, component_modes
from proofs.two_counter_hazards import (
    CHAIN,
    HARMLESS_STAGES,
    LINES,
    overspeed_without_brake,
    overspeed_without_brake_by_a_stage,
)
from proofs.two_counter_parts import COMPONENTS, INVENTED, mode_rate
from proofs.two_counter_rides import struck
from safety import Bit, Model
from safety.inject import Campaign, Group, Wires

WITHIN = 500_000  # 250 km/h on the frequency scale, 8.75 km/h below the threshold
RUN_IN = 2200  # released by then
MOMENTS = {"early": (3000, 4182), "late": (4100, 4182), "midst": (5900, 5901)}  # steps of fault and overspeed


def too_fast(wires: Wires) -> Bit:
    """The train is at the least speed at which the brake is certain."""
    return wires["speed"] >= CHAIN.speed


def unbraked(allowed: int) -> Callable[[Wires], Bit]:
    """No brake, though the time to brake is over."""
    return lambda wires: wires.lasting(too_fast(wires), allowed) & ~wires["brake"]


def stopped(wires: Wires) -> Bit:
    """A brake within the limit."""
    return wires["brake"] & ~too_fast(wires)


def groups(strike: int, begins: int) -> Iterator[Group]:
    """The failure modes as groups: those with a rate of their own, and the elements of each component."""
    for part, faults in component_modes().items():
        alike = [f for f in faults if f.name not in COMPONENTS]
        for mode, some in [("element stuck", alike), *((f.name, [f]) for f in faults if f.name in COMPONENTS)]:
            rate = sum(map(mode_rate, some), Fraction(0))
            if some:
                yield Group(f"{part}: {mode}", list(struck(some, strike, begins)), part, mode, rate, INVENTED)


def singles(
    when: str, strike: int, begins: int, model: type[Model] = Equipment, allowed: int = CHAIN.braked, **more: Any
) -> Campaign:
    """Each mode by itself, at some moment; the brake is allowed so many steps."""
    return Campaign(
        id=f"two_counter_single_faults_{when}",
        model=model,
        constant=LINES,
        stimulus=lambda step: {"speed": WITHIN if step < begins else CHAIN.speed},
        run_in=RUN_IN, measured=begins - RUN_IN + 2 * allowed,
        faults=list(groups(strike, begins)),
        hazard=unbraked(allowed), safe=stopped, **more,
    )  # fmt: skip


PROOFS = (overspeed_without_brake, overspeed_without_brake_by_a_stage, *HARMLESS_STAGES)

early = singles("early", *MOMENTS["early"], proofs=PROOFS, expect={"safe": 35, "dangerous_undetected": 60})
late = singles("late", *MOMENTS["late"], expect={"safe": 25, "dangerous_undetected": 61})
midst = singles("midst", *MOMENTS["midst"], expect={"safe": 7, "dangerous_undetected": 60})
SINGLE = (early, late, midst)

pairs = replace(
    early, id="two_counter_pairs", proofs=(), order=2,
    faults=list(struck(component_faults(), *MOMENTS["early"])),
    expect={"safe": 2468, "dangerous_undetected": 4472, "no_effect": 810},
)  # fmt: skip
