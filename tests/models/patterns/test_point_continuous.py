"""Point and continuous control: distances, the run to the signal, missing inductors, planted bugs."""

from __future__ import annotations

from itertools import accumulate
from typing import Any

import pytest

from models.kinematics import KMH
from models.patterns.point_continuous import (
    DECELERATION,
    LIMITS,
    LINE,
    WAYS,
    Control,
    InductorApproach,
    Inductors,
    OnBoard,
    PointAndContinuous,
)
from proofs.patterns_point_continuous import with_missing
from safety import Bit, Real, Scenario, run, select
from safety.tracing import trace
from tests.models.patterns.planted import judged
from tests.models.ts7.test_readings import direct_and_python_agree

NEAR = 1e-4


@pytest.mark.parametrize("model", [PointAndContinuous, InductorApproach])
def test_direct_and_python_agree(model: Any) -> None:
    direct_and_python_agree(model)


def test_every_parameter_has_unit_range_and_source() -> None:
    assert all(
        s.unit and s.low <= s.value <= s.high and len(s.source) > 5 for s in trace(InductorApproach).settings.values()
    )


def test_sp_13_soviet_distances() -> None:
    laid = [trace(InductorApproach).settings[name].value for name in ("way_cd", "way_bc", "way_ab")]
    assert [float(x) for x in accumulate(laid)] == pytest.approx([25.694, 70.448, 167.901], rel=NEAR)


def inputs(**what: Any) -> dict[str, Any]:
    return {f"passed.{n}": False for n in "abcd"} | {"clear": False, "current": True, "v": 0} | what


def test_the_limit_falls_from_point_to_point() -> None:
    rows = [inputs(clear=True), inputs(), *(inputs(**{f"passed.{n}": True}) for n in "abcd"), inputs(clear=True)]
    seen = run(PointAndContinuous, lambda k: rows[k], len(rows))
    limits = [LINE, LIMITS[0], LIMITS[1], LIMITS[2], 0, 0, LINE]
    assert seen["limit"] == limits


@pytest.mark.parametrize(("missing", "overrun"), [("a", 75.231), ("b", 36.420), ("c", 25.694)])
def test_overrun_without_an_inductor(missing: str, overrun: float) -> None:
    """What is left at D is braked there; after C alone is missing the free run comes first."""
    v = with_missing(missing)[-1]
    free = 2 * v if missing == "c" else 0
    assert float(free + v * v / (2 * DECELERATION)) == pytest.approx(overrun, rel=NEAR)


def test_the_train_of_the_run_stands_at_d() -> None:
    speeds = [LINE, *LIMITS]
    seen = run(InductorApproach, lambda k: {"v": speeds[k]}, 5)
    assert seen["at_signal"] == [False, False, False, False, True] and seen["brake"][-1]
    assert seen["way"] == [0, 0, *WAYS]


def test_a_missing_inductor_is_told_from_a_missed_one() -> None:
    """Passing B while free is at once the limit of B: the equipment does not count."""
    rows = [inputs(clear=True), inputs(**{"passed.b": True})]
    assert run(PointAndContinuous, lambda k: rows[k], 2)["limit"][-1] == LIMITS[2]


class Rises(PointAndContinuous, tick_s="0.1"):
    """Planted: an inductor sets its limit even where that is higher."""

    def step(self, passed: Inductors, clear: Bit, current: Bit, v: Real) -> tuple[OnBoard, Control]:
        """A gives 25 km/h again, whatever is held."""
        _, control = super().step(passed, clear, current, v)
        limit = select(passed.a & current & ~clear, 25 * KMH, control.limit)
        return type(self)(held=limit), Control(limit, control.brake)


def test_a_planted_rise_is_found() -> None:
    script = Scenario(2, {"current": True, "passed.a": lambda k: k == 1})
    outcome = judged("patterns_point_continuous.limit_only_falls_until_clear", Rises, script)
    assert outcome.verdict == "refuted"
