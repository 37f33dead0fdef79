"""Follow-up control: the correction demanded, the error that is left, what is refused, planted bugs."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from models.kinematics import B_SERVICE, KMH, Quantity
from models.patterns.follow_up import GAIN, SHARPEST, FollowUp, WithoutMargin, bound, pull, sharpness
from safety import ModelError, Scenario, run
from safety.tracing import trace
from tests.models.patterns.planted import judged
from tests.models.ts7.test_readings import direct_and_python_agree


@pytest.mark.parametrize("model", [FollowUp, WithoutMargin])
def test_direct_and_python_agree(model: Any) -> None:
    direct_and_python_agree(model)


def test_every_parameter_has_unit_range_and_source() -> None:
    assert all(s.unit and s.low <= s.value <= s.high and len(s.source) > 5 for s in trace(FollowUp).settings.values())


@pytest.mark.parametrize(("steepest", "demand"), [(20, "0.1961"), (4, "0.0392")])
def test_sp_16_static_correction(steepest: int, demand: str) -> None:
    """With one curve +-20 permille are left, with five +-4: the correction of the model settles at -g i."""
    for sign in (1, -1):
        seen = run(trace(FollowUp, {"steepest": steepest}), {"i": sign * steepest, "q": 0}, 200)
        correction = -sign * float(seen["correction"][-1])
        assert f"{correction:.4f}" == demand and (steepest == 20 or correction <= 0.03923)
        assert -sign * float(seen["effort"][-1] - B_SERVICE) == pytest.approx(correction, rel=1e-4)
        assert -sign * float(seen["after"][-1] * GAIN) == pytest.approx(correction, rel=1e-4)


def test_the_error_that_is_claimed() -> None:
    assert float(2 * bound(Fraction(20)) / KMH) == pytest.approx(2.118, abs=1e-3)
    assert float(2 * bound(Fraction(4)) / KMH) == pytest.approx(0.4237, abs=1e-3)


@pytest.mark.parametrize("turn", [7, 13, 40])
def test_gradients_that_change_keep_the_error_within_its_bound(turn: int) -> None:
    def inputs(k: int) -> dict[str, Any]:
        return {"i": 20 if k // turn % 2 else -20, "q": SHARPEST}

    seen = run(FollowUp, inputs, 160)
    worst = max(abs(e) for e in seen["after"])
    assert 0 < worst <= 2 * bound(Fraction(20))


def test_sharpness_at_18_km_h() -> None:
    assert sharpness(B_SERVICE, 5) < SHARPEST < sharpness(B_SERVICE, Fraction("4.9"))


def test_without_margin_the_error_grows_for_ever() -> None:
    seen = run(trace(WithoutMargin, {"curve": Fraction(11, 10)}), {"i": -20, "q": 0}, 400)
    assert seen["after"][399] > 1 and seen["after"][399] > seen["after"][300] > seen["after"][200]


@pytest.mark.parametrize(
    ("setting", "says"),
    [
        ({"curve": Fraction(11, 10)}, "no margin.*nearest admissible curves are 0.2942 and 0.9058 m/s"),
        ({"curve": Fraction(1, 5)}, "no margin"),
        ({"steepest": 41}, "nearest admissible value is 40"),
        ({"steepest": 40}, "no margin"),
    ],
)
def test_parameters_that_cannot_be_honoured_are_refused(setting: dict[str, Any], says: str) -> None:
    with pytest.raises(ModelError, match=says):
        trace(FollowUp, setting)


def test_pull_is_uphill_positive() -> None:
    steepest: Quantity = Fraction(20)
    assert pull(steepest) == Fraction("0.196133") and pull(-steepest) == -pull(steepest)


def test_a_planted_bug_is_found() -> None:
    """Planted: nothing is required of the limits of the effort."""
    start = {"curve": Fraction(11, 10), "steepest": 20}
    found = judged("patterns_follow_up.error_stays_bounded", WithoutMargin, Scenario(80, {"i": -20}, start))
    assert found.verdict == "refuted"
