"""Point and continuous transmission: runs, what fails to the wrong side, planted bugs."""

from __future__ import annotations

from itertools import product
from typing import Any

import pytest

from models.patterns.transmission import (
    CLEAR,
    LIMITS,
    SLOW,
    STOP,
    Code,
    ContinuousCode,
    MagnetPoint,
    ResonantPoint,
    Shown,
    TripStop,
)
from proofs.patterns_transmission import WRONG_SIDE
from safety import Real, run, select
from safety.faults import instrument
from safety.tracing import trace
from tests.models.patterns.planted import judged
from tests.models.ts7.test_readings import direct_and_python_agree

MODELS = (MagnetPoint, ResonantPoint, TripStop, ContinuousCode)


@pytest.mark.parametrize("model", MODELS)
def test_direct_and_python_agree(model: Any) -> None:
    direct_and_python_agree(model)


@pytest.mark.parametrize("model", MODELS)
def test_every_parameter_has_unit_range_and_source(model: Any) -> None:
    assert all(s.unit and s.low <= s.value <= s.high and len(s.source) > 5 for s in trace(model).settings.values())


def passing(**what: Any) -> dict[str, Any]:
    return {"proceed": False, "passing": True, "reset": False, "standing": False} | what


@pytest.mark.parametrize("model", [MagnetPoint, ResonantPoint])
def test_a_point_brakes_just_who_passes_it_at_stop(model: Any) -> None:
    for proceed, over in product((False, True), repeat=2):
        assert run(model, passing(proceed=proceed, passing=over), 1)["out"] == [over and not proceed]


@pytest.mark.parametrize("part", WRONG_SIDE)
def test_wrong_side_modes_read_as_proceed(part: str) -> None:
    fault = WRONG_SIDE[part]
    system = instrument(trace(ResonantPoint), [fault]).system
    acts = {name: passing().get(name, True) for name in system.inputs}  # the fault begins in this step
    assert run(system, acts, 1)["out"] == [False]


def test_a_trip_stop_works_up_to_its_speed() -> None:
    for v, stops in ((20, True), (21, False)):
        assert run(TripStop, passing(v=v), 1)["out"] == [stops]


def test_a_code_is_taken_after_the_detection_time_and_loss_at_once() -> None:
    codes = [CLEAR] * 8 + [SLOW] * 6 + [STOP] + [CLEAR] * 3
    seen = run(ContinuousCode, lambda k: {"code": codes[k], "v": 0}, len(codes))
    assert seen["limit"] == [LIMITS[STOP]] * 4 + [LIMITS[CLEAR]] * 8 + [LIMITS[SLOW]] * 2 + [LIMITS[STOP]] * 4


class Sluggish(ContinuousCode, tick_s="0.1"):
    """Planted: loss of the current is taken like any other code, after the detection time."""

    def step(self, code: Code, v: Real) -> tuple[ContinuousCode, Shown]:
        """Holds the former code for a cycle more."""
        after, seen = super().step(code, v)
        return after, Shown(select(self.held > code, LIMITS[CLEAR], seen.limit), seen.decoded, seen.brake)


def test_a_planted_delay_is_found() -> None:
    assert judged("patterns_transmission.loss_takes_the_limit_to_zero", Sluggish).verdict == "refuted"
    assert judged("patterns_transmission.restriction_acts_within_detection", Sluggish).verdict == "refuted"
