"""The reversible counter: what makes it not fail-safe, each single fault injected at 250 km/h (nE = 530).

The train runs 10 pulses (4.9 km/h) below nE, the count being settled; the fault strikes; after 9000 steps the train is
10 pulses above nE, for the 8643 steps in which the proof has the brake applied, and as long again.
Wrong side: after that time, no brake.  Safe side: a brake below nE.  Nothing in the device detects a fault.

Results: 30 of 99 modes are wrong-side: generator dead or losing pulses, oscillator fast, up line open, down line or
divider giving too much, 6 stages of the counter, 4 bits of the check speed, comparator, contact.  A dead generator does
not hold the command, as in the two-counter device: the count decays and a brake is released.
Failure rates are INVENTED, 1 FIT a stage or line: they show the method [A].
"""

from __future__ import annotations

from fractions import Fraction

from models.reversible_counter import ReversibleCounter
from models.reversible_failures import component_modes
from proofs.reversible_counter import LIMIT, at, steps_to_brake
from safety import Bit
from safety.inject import Campaign, Group, Wires

WITHIN, EXCESS = 9000, 10  # steps below nE, pulses below and above it
BRAKED = steps_to_brake(EXCESS)
INVENTED = "[A] invented parts list: 1 FIT a stage or line"
FIT = Fraction(1, 10**9)


def ride(step: int) -> dict[str, int]:
    """Within the limit, then too fast."""
    return {"speed": at(LIMIT - EXCESS) if step < WITHIN else at(LIMIT + EXCESS)}


def unbraked(wires: Wires) -> Bit:
    """No brake, though the time to brake is over."""
    return wires.lasting(above(wires), BRAKED) & ~wires["brake"]


def stopped(wires: Wires) -> Bit:
    """A brake within the limit."""
    return wires["brake"] & ~above(wires)


def above(wires: Wires) -> Bit:
    """The train is too fast."""
    return wires["speed"] >= at(LIMIT + EXCESS)


single_faults = Campaign(
    id="reversible_single_faults",
    model=ReversibleCounter,
    stimulus=ride, measured=WITHIN + 2 * BRAKED,
    start={"counter.n": LIMIT - EXCESS},
    faults=[
        Group(part, faults, part, "any", len(faults) * FIT, INVENTED) for part, faults in component_modes().items()
    ],
    hazard=unbraked, safe=stopped,
    expect={"safe": 27, "dangerous_undetected": 30, "no_effect": 42},
)  # fmt: skip
