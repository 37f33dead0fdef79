"""American code control: distances, the acknowledgement in runs, planted bugs."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from models.kinematics import KMH, distance
from models.patterns.code_control import (
    APPROACH,
    CLEAR,
    DECELERATION,
    FREE_RUN,
    LIMITS,
    RED,
    CodeControl,
    HeldButton,
    SilenceAccepted,
)
from proofs.patterns_code_control import CLOSED_AND_RED, RED_AT_1
from safety import ModelError, Scenario, run
from safety.tracing import trace
from tests.models.patterns.planted import judged
from tests.models.ts7.test_readings import direct_and_python_agree

MODELS = (CodeControl, HeldButton, SilenceAccepted)


@pytest.mark.parametrize("model", MODELS)
def test_direct_and_python_agree(model: Any) -> None:
    direct_and_python_agree(model)


def test_every_parameter_has_unit_range_and_source() -> None:
    assert all(
        s.unit and s.low <= s.value <= s.high and len(s.source) > 5 for s in trace(CodeControl).settings.values()
    )


def test_limits_in_km_h() -> None:
    assert [float(v / KMH) for v in reversed(LIMITS)] == pytest.approx([144.841, 72.420, 40.234, 24.140], abs=6e-4)


def test_sp_13_american_distances() -> None:
    steps = [(LIMITS[3], LIMITS[2]), (LIMITS[2], LIMITS[1]), (LIMITS[1], LIMITS[0]), (LIMITS[1], 0), (LIMITS[0], 0)]
    found = [float(distance(v, DECELERATION, FREE_RUN, w)) for v, w in steps]
    assert found == pytest.approx([1132.41, 293.50, 100.14, 137.61, 57.59], rel=1e-4)


def driving(press: int | None, steps: int = 90, v: Fraction = LIMITS[RED]) -> Any:
    """Red from step 10 on, the button pressed at one step."""
    return run(
        CodeControl,
        lambda k: {"code": CLEAR if k < 10 else RED, "button": k == press, "v": v, "now": Fraction(k, 10)},
        steps,
    )


def test_no_acknowledgement_brings_the_emergency_brake_after_6_s() -> None:
    seen = driving(None)
    assert seen["emergency"].index(True, 10) == 10 + 60
    assert all(seen["emergency"][70:])


def test_acknowledged_in_time_no_brake_comes() -> None:
    seen = driving(40)
    assert not any(seen["brake"][10:]) and all(seen["acknowledged"][40:])


def test_pressed_as_red_comes_counts_as_too_early() -> None:
    assert driving(10)["emergency"][-1]


def test_above_15_mph_at_red_the_service_brake_comes_at_once() -> None:
    seen = driving(40, v=LIMITS[APPROACH])
    assert seen["brake"][10] and not seen["emergency"][10]


def test_a_time_out_of_range_is_refused() -> None:
    with pytest.raises(ModelError, match="nearest admissible value is 60"):
        trace(CodeControl, {"patience": 61})


RUN = Scenario(8, RED_AT_1, {"patience": Fraction(1, 2)})


@pytest.mark.parametrize(
    ("claim", "model", "script"),
    [
        ("silence_brings_the_emergency_brake", SilenceAccepted, RUN),
        ("stuck_button_acknowledges_nothing", HeldButton, CLOSED_AND_RED),
    ],
)
def test_planted_bugs_are_found(claim: str, model: Any, script: Scenario) -> None:
    assert judged(f"patterns_code_control.{claim}", model, script).verdict == "refuted"
