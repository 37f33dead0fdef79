"""The five equipments in order stop the train before the point, let it pass a proceed, and brake for a lost line."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from models.kinematics import ACCELERATION, mps
from models.patterns.failures import TABLE, component_faults
from proofs.patterns_hazards import CHECKED, PLAIN_ONES
from proofs.patterns_rides import STEPS, approach, start
from safety import FROM_START, Fault, dead, run
from safety.faults import instrument, schedule
from safety.trace import Trace
from safety.tracing import trace

KEEP = ("passed", "brake.on", "vehicle.v", "vehicle.x")
EQUIPMENTS = {f"{kind} {way}": one for kind, ones in (("plain", PLAIN_ONES), ("checked", CHECKED))
              for way, one in ones.items()}  # fmt: skip


def ride(which: str, steps: int = STEPS, settings: dict[str, Any] | None = None, **given: Any) -> Trace:
    equipment = EQUIPMENTS[which].equipment
    row = approach(equipment, **given)
    return run(equipment, row, steps, start=start(equipment), settings=settings, keep=KEEP)


@pytest.mark.parametrize("drive", [Fraction(0), pytest.param(ACCELERATION, marks=pytest.mark.slow)])
@pytest.mark.parametrize("which", EQUIPMENTS)
def test_stops_before_a_point_at_stop(which: str, drive: Fraction) -> None:
    found = ride(which, drive=drive)
    assert found["vehicle.v"][-1] == 0 and found["vehicle.x"][-1] > 0 and not any(found["passed"])


@pytest.mark.slow
@pytest.mark.parametrize("which", EQUIPMENTS)
@pytest.mark.parametrize("gradient", [-20, 20])
def test_stops_on_every_gradient(which: str, gradient: int) -> None:
    found = ride(which, settings={"vehicle.gradient": gradient})
    assert not any(found["passed"]) and found["vehicle.v"][-1] == 0


@pytest.mark.parametrize("which", EQUIPMENTS)
def test_does_not_brake_at_proceed(which: str) -> None:
    found = ride(which, 700, stop=False)
    assert not any(found["brake.on"]) and found["vehicle.x"][-1] < 0


@pytest.mark.parametrize("which", ["plain point", "plain magnet", "plain combined", "plain program"])
def test_restriction_is_held_from_the_point_on(which: str) -> None:
    found = ride(which, settings={"target": mps(45)})
    speeds = [v for v, x in zip(found["vehicle.v"], found["vehicle.x"], strict=True) if x < 0]
    assert speeds and max(speeds) <= mps(45) and not any(found["passed"])


LINES = [
    ("plain point", "vehicle.relay"), ("plain magnet", "vehicle.coil"), ("plain point", "pattern.comparator"),
    ("plain continuous", "receiver"), ("plain combined", "receiver"), ("plain program", "ticks"),
]  # fmt: skip


@pytest.mark.parametrize(("which", "line"), LINES)
def test_sp_15_dropping_a_held_line_brakes_within_a_cycle(which: str, line: str) -> None:
    equipment = EQUIPMENTS[which].equipment
    lost = Fault(dead(), [line], onset=FROM_START)
    faulted = instrument(trace(equipment), [lost])
    acts, row = schedule(faulted), approach(equipment, stop=False)
    found = run(faulted.system, lambda k: {**row(k), **acts(k)}, 2, start=start(equipment), keep=("brake.on",))
    assert found["brake.on"][0]


def test_rows_with_their_component_are_not_silently_left_out() -> None:
    names = {fault.name for fault in component_faults(PLAIN_ONES["point"].equipment)}
    of_others = ("permanent magnet", "clearing coil", "code receiver", "acknowledgement", "program clock")
    assert names == {row.name for row in TABLE if not row.component.startswith(of_others)}
