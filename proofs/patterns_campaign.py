"""Speed patterns: every failure mode of the fault table injected, singly and in pairs, into each equipment.

One step is a cycle of 0.1 s.  The train approaches at 100 km/h; the faults strike 2 s after the start.  Rides:

* **stop**: the signal at stop, the driver coasts; **power**: the same with the driver drawing power all the way;
* **downgrade**: -20 permille, the steepest bin; **restriction**: 45 km/h to be held from the point instead of a stop;
* **clear**: the signal at proceed; nothing may brake.

Wrong side: the train passes the point at stop, or faster than its restriction.  Safe side: the brake is on for longer
than in the equipment in order.  With detectors fitted: what finds a fault no later than the train passes.  There the
ride begins with a brake test at departure, from 5 s to 9 s.

Results: the wrong-side singles are the single cut sets of `patterns_hazards`, all of them and no others; of the pairs,
those with one of these.  Rates are those of the fault table [A].
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from models.kinematics import ACCELERATION, mps
from models.patterns.detectors import Found
from models.patterns.equipment import Equipment
from models.patterns.failures import ADDED, ASSUMED_RATES, TABLE, Mode, component_faults
from proofs.patterns_hazards import CHECKED, PLAIN_ONES
from proofs.patterns_rides import STEPS, STRIKE, approach, start
from safety.inject import Campaign, Counts, Group, Runs

DOWNGRADE, RESTRICTION = -20, mps(45)  # permille, m/s
TEST = range(50, 90)  # cycles of the brake test at departure
Expect = Mapping[str, int]


def groups(equipment: type[Equipment], rows: Sequence[Mode]) -> Iterator[Group]:
    """The rows that an equipment has, each a group with its rate."""
    of = {row.name: row for row in rows}
    for fault in component_faults(equipment, rows):
        row, struck = of[fault.name], replace(fault, at=STRIKE)
        yield Group(row.name, [struck], row.component, row.mode, Fraction(row.rate), ASSUMED_RATES)


def passes(counts: Counts) -> Runs:
    """The train passes the point, which it must not."""
    return counts.total("passes") > 0


def brakes_more(counts: Counts) -> Runs:
    """The brake is off for less time than in the equipment in order."""
    return counts.total("free") < counts.healthy("free")


def never(counts: Counts) -> Runs:
    """Nothing in a plain equipment tells a fault."""
    return counts.total("passes") < 0


RIDES: Mapping[str, Mapping[str, Any]] = {"power": {"drive": ACCELERATION}, "clear": {"stop": False}}
SETTINGS: Mapping[str, Mapping[str, Any]] = {
    "downgrade": {"vehicle.gradient": DOWNGRADE}, "restriction": {"target": RESTRICTION},
}  # fmt: skip


def singles(name: str, ride: str, expect: Expect) -> Campaign:
    """Each mode by itself in a plain equipment, under a ride."""
    equipment = PLAIN_ONES[name].equipment
    return Campaign(
        id=f"patterns_{name}_{ride}",
        model=equipment,
        stimulus=approach(equipment, **RIDES.get(ride, {})), start=start(equipment), settings=SETTINGS.get(ride, {}),
        measured=STEPS,
        observe={"passes": lambda wires: wires["passed"] & wires["stop"], "free": lambda wires: ~wires["brake.on"]},
        wrong_side=passes, safe_side=brakes_more, detected=never,
        faults=list(groups(equipment, TABLE)), expect=expect,
    )  # fmt: skip


def found(name: str, expect: Expect) -> Campaign:
    """Each mode by itself in an equipment with detectors, after a brake test."""
    equipment = CHECKED[name].equipment
    return Campaign(
        id=f"patterns_{name}_detectors",
        model=equipment,
        stimulus=approach(equipment, test=lambda cycle: cycle in TEST), start=start(equipment),
        measured=STEPS,
        hazard="passed", safe="failed", detectors={label: f"found.{label}" for label in Found._fields},
        faults=list(groups(equipment, (*TABLE, *ADDED))), expect=expect,
    )  # fmt: skip


FOUND: Mapping[str, Mapping[str, tuple[int, int, int]]] = {  # safe, wrong, without effect
    "stop": {
        "point": (4, 9, 2),
        "magnet": (4, 7, 1),
        "continuous": (2, 4, 4),
        "combined": (8, 7, 2),
        "program": (3, 4, 2),
    },
    "power": {
        "point": (5, 9, 1),
        "magnet": (4, 7, 1),
        "continuous": (2, 4, 4),
        "combined": (9, 7, 1),
        "program": (3, 4, 2),
    },
    "clear": {
        "point": (4, 0, 11),
        "magnet": (3, 0, 9),
        "continuous": (2, 0, 8),
        "combined": (4, 0, 13),
        "program": (3, 0, 6),
    },
    "downgrade": {
        "point": (4, 9, 2),
        "magnet": (4, 7, 1),
        "continuous": (2, 4, 4),
        "combined": (8, 7, 2),
        "program": (3, 4, 2),
    },
    "restriction": {"point": (3, 8, 4), "magnet": (3, 6, 3), "combined": (7, 6, 4), "program": (3, 4, 2)},
    "pairs": {
        "point": (39, 60, 6),
        "magnet": (29, 37, 0),
        "continuous": (12, 25, 8),
        "combined": (80, 48, 8),
        "program": (17, 18, 1),
    },
}


def counted(ride: str, name: str) -> Expect:
    """What a campaign has to find."""
    return dict(zip(("safe", "dangerous_undetected", "no_effect"), FOUND[ride][name], strict=True))


STOP = {name: singles(name, "stop", counted("stop", name)) for name in PLAIN_ONES}
ELSEWHERE = {
    (ride, name): singles(name, ride, counted(ride, name))
    for ride in ("power", "clear", "downgrade", "restriction")
    for name in FOUND[ride]
}
PAIRS = {
    name: replace(one, id=f"patterns_{name}_pairs", order=2, expect=counted("pairs", name),
                  faults=[replace(fault, at=STRIKE) for fault in component_faults(PLAIN_ONES[name].equipment)])
    for name, one in STOP.items()
}  # fmt: skip
DETECTED = {
    "point": found("point", {"detected": 13, "dangerous_undetected": 0, "no_effect": 8, "wrong/yes": 1}),
    "magnet": found("magnet", {"detected": 10, "dangerous_undetected": 1, "no_effect": 5}),
    "continuous": found("continuous", {"detected": 11, "dangerous_undetected": 0, "no_effect": 3}),
    "combined": found("combined", {"detected": 16, "dangerous_undetected": 0, "no_effect": 8}),
    "program": found("program", {"detected": 9, "dangerous_undetected": 0, "no_effect": 4}),
}
