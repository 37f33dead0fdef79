"""Two-counter ATC at the check speeds below 250 km/h: every failure mode of its components injected by itself.

All 125 modes at two of the moments of `two_counter_rides`, which between them show all that is wrong-side: a fault at
the outset of a count, and one late in it.  Wrong side: too fast without a brake, the time to brake being over.

Results: what is wrong-side by itself is, at each check speed, what `two_counter_wrong_side` says and why, and the
generator that reads low.  Every check speed but 250 km/h has "counting gate at 0" more.
"""

from __future__ import annotations

from collections.abc import Callable

from models.two_counter.equipment import Equipment
from models.two_counter.failures import component_faults
from proofs.two_counter_rides import LOWER, Ride, struck
from safety import Bit
from safety.inject import Campaign, Wires

EXPECTED = {  # wrong-side modes by check speed: at the outset of a count, late in it
    210: (58, 59), 160: (60, 62), 110: (58, 59), 70: (59, 60), 30: (59, 60), 5: (58, 59),
}  # fmt: skip


def too_fast(ride: Ride) -> Callable[[Wires], Bit]:
    """The train is at the least speed at which the brake is certain."""
    return lambda wires: wires["speed"] >= ride.chain.speed


def lower_speed(v: int, when: str, wrong: int | None = None) -> Campaign:
    """Each mode by itself, at one of the moments; so many of them are expected to be wrong-side."""
    ride = Ride(v)
    fast, braked = too_fast(ride), ride.chain.braked
    strike, begins = ride.moments[when]
    return Campaign(
        id=f"two_counter_single_faults_{v}_{when}",
        model=Equipment,
        constant=ride.lines,
        stimulus=lambda step: {"speed": ride.speed(step, begins)},
        run_in=ride.run_in, measured=begins - ride.run_in + ride.lasts,
        faults=list(struck(component_faults(), strike, begins)),
        hazard=lambda wires: wires.lasting(fast(wires), braked) & ~wires["brake"],
        safe=lambda wires: wires["brake"] & ~fast(wires),
        expect=None if wrong is None else {"dangerous_undetected": wrong},
    )  # fmt: skip


LOWER_SPEEDS = {
    v: [lower_speed(v, when, n) for when, n in zip(("outset", "late"), EXPECTED[v], strict=True)] for v in LOWER
}
