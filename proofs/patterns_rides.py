"""Runs of the equipments that protect a point: what the signal, the currents and the driver do, by scenario.

A ride is a stimulus of the campaigns and a scenario of the hazards.  All start at the line speed, 100 km/h, 300 m
before the equipment first speaks, and end at rest or well beyond the point.  One step is a cycle of 0.1 s.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from models.kinematics import ACCELERATION
from models.patterns.equipment import B_POINT, ContinuousEquipment, Equipment
from models.patterns.stored_pattern import POINT
from models.patterns.vehicle import LINE_SPEED
from safety import Scenario
from safety.tracing import trace

RUN_UP, STRIKE = 300, 20  # m before the equipment first speaks; cycle of the fault
STEPS = 2200  # cycles: to rest from the line speed, or at 15 mph to the point
Row = dict[str, Any]
Ride = Callable[[int], Row]


def first_word(equipment: type[Equipment]) -> int:
    """Where the equipment first speaks of the point, m before it."""
    return B_POINT if issubclass(equipment, ContinuousEquipment) else POINT


def start(equipment: type[Equipment]) -> Row:
    """At the line speed, before all of it."""
    return {"vehicle.v": LINE_SPEED, "vehicle.x": Fraction(first_word(equipment) + RUN_UP)}


def inputs(equipment: type[Equipment], **given: Any) -> Row:
    """The signal at stop, current in the rails, a driver who does nothing; `given` are others, by cycle or fixed."""
    usual: Mapping[str, Any] = {"stop": True, "current": True, "button": False, "drive": Fraction(0), "test": False}
    return {name: given.get(name, value) for name, value in usual.items() if name in trace(equipment).inputs}


def approach(equipment: type[Equipment], **given: Any) -> Ride:
    """The same as the stimulus of a campaign."""
    row = inputs(equipment, **given)
    return lambda cycle: {name: v(cycle) if callable(v) else v for name, v in row.items()}


def to_the_stop(equipment: type[Equipment]) -> Callable[[tuple[str, ...]], Sequence[Scenario]]:
    """Runs to a signal at stop with some faults, for a hazard: they strike early; the driver coasts, or draws power."""

    def scenarios(present: tuple[str, ...]) -> Sequence[Scenario]:
        drives = (inputs(equipment, drive=drive) for drive in (Fraction(0), ACCELERATION))
        return [Scenario(STEPS, row, present=present, at=STRIKE, start=start(equipment)) for row in drives]

    return scenarios
