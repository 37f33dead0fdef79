"""Function generator with gradient bins: the table, the limits, what is refused, planted bugs."""

from __future__ import annotations

from fractions import Fraction

import pytest

from models.kinematics import KMH
from models.patterns.function_generator import (
    CENTRES,
    FROM,
    BrakeStart,
    Started,
    deviation,
    gradient_of_spread,
    least_level,
    level_of_spread,
    spread,
)
from proofs.patterns_function_generator import bins, run_at
from safety import Bit, ModelError, Real, run
from safety.prove.weakest import declared
from safety.prove.weakest_search import find
from safety.tracing import trace
from tests.models.patterns.planted import judged
from tests.models.ts7.test_readings import direct_and_python_agree

PRINTED = {  # specification 2.6: overrun and short by bin, spread of one curve, gradient of 100 m
    "2.5": "56.50/48.81 42.60/37.50 33.26/29.70 26.69/24.11 21.89/19.96 341.0 6.32",
    "3.0": "35.11/31.26 28.01/25.25 22.87/20.81 19.02/17.45 16.07/14.85 230.7 9.07",
    "3.5": "23.92/21.72 19.81/18.15 16.68/15.39 14.24/13.22 12.30/11.47 166.9 12.30",
    "4.0": "17.33/15.96 14.75/13.67 12.71/11.84 11.06/10.35 9.71/9.13 126.5 15.99",
}


def test_direct_and_python_agree() -> None:
    direct_and_python_agree(BrakeStart)


def test_every_parameter_has_unit_range_and_source() -> None:
    assert all(s.unit and s.low <= s.value <= s.high and len(s.source) > 5 for s in trace(BrakeStart).settings.values())


@pytest.mark.parametrize("level", PRINTED)
def test_sp_06_gradient_table(level: str) -> None:
    *cells, total, steepest = PRINTED[level].split()
    b = Fraction(level) * KMH
    for centre, cell in zip(CENTRES, cells, strict=True):
        assert [f"{float(part):.2f}" for part in deviation(b, centre)] == cell.split("/")
    assert f"{float(spread(b)):.1f}" == total
    assert f"{float(gradient_of_spread(100, b).middle):.2f}" == steepest


@pytest.mark.parametrize(("gradient", "centre", "off"), [(-20, -16, "35.11"), (-12, -16, "-31.26"), (4, 0, "-20.81")])
def test_sp_06_on_the_model(gradient: int, centre: int, off: str) -> None:
    """The model brakes where speed and curve are equal; the stop lies that far from its place."""
    scenario = run_at(3 * KMH, gradient, centre)
    system = trace(BrakeStart, {"level": 3 * KMH, "gradient": gradient})
    seen = run(system, lambda k: {**scenario.inputs, "x": scenario.inputs["x"](k)}, 2)
    assert seen["now"] == [False, True]
    actual = 3 * KMH + Fraction("9.80665") * gradient / 1000
    assert f"{float(FROM * FROM / (2 * actual) - seen['x'][1]):.2f}" == off


def test_sp_07_least_decelerations() -> None:
    found = [least_level(-16), least_level(0), level_of_spread(250)]
    assert [float(b.middle / KMH) for b in found] == pytest.approx([3.437, 2.872, 2.889], abs=0.002)
    assert 3.4373 < float(least_level(-16).middle / KMH) < 3.4374
    for rho, least in (("0.06", 3.321), ("0.10", 3.249)):
        assert float(least_level(-16, rho=Fraction(rho)).middle / KMH) == pytest.approx(least, abs=0.0006)


def test_sp_08_spread_of_100_m() -> None:
    assert float(level_of_spread(100).middle / KMH) == pytest.approx(4.4846, rel=1e-5)
    assert float(spread(level_of_spread(100).middle)) == pytest.approx(100, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "centre", "rho"),
    [
        ("", -16, "0"),
        ("_level_bin", 0, "0"),
        ("_rotating_6_percent", -16, "0.06"),
        ("_rotating_10_percent", -16, "0.1"),
    ],
)
def test_the_weakest_deceleration_is_the_exact_one(name: str, centre: int, rho: str) -> None:
    (found,) = (find(s) for s in declared() if s.id == f"patterns_function_generator.least_deceleration{name}")
    assert found.settled and found.refuted_at is not None and found.safe_from is not None
    assert found.refuted_at < least_level(centre, rho=Fraction(rho)).middle < found.safe_from


def test_the_table_says_where_25_m_are_kept() -> None:
    assert [row[-1] for row in bins()] == [False, False, True, True]


@pytest.mark.parametrize(
    ("setting", "says"),
    [
        ({"gradient": 21}, "nearest admissible values are -20 and 20 permille"),
        ({"level": Fraction(1, 10), "gradient": -20}, "no stop is possible"),
        ({"level": 4}, "nearest admissible value is 3"),
    ],
)
def test_parameters_that_cannot_be_honoured_are_refused(setting: dict[str, Fraction], says: str) -> None:
    with pytest.raises(ModelError, match=says):
        trace(BrakeStart, setting)


def test_no_stop_is_possible_on_a_gradient_that_is_too_steep() -> None:
    with pytest.raises(ModelError, match=r"nearest admissible value is above -40\.7"):
        deviation(Fraction("0.4"), -40)


class LetsGo(BrakeStart, event="comparison of speed and curve"):
    """Planted: the brake is not held once the train is below the curve again."""

    def step(self, v: Real, x: Real, at_point_1: Bit, ground: Real) -> tuple[BrakeStart, Started]:
        """Forgets that the brake was on."""
        after, seen = super().step(v, x, at_point_1, ground)
        return type(self)(running=after.running, braking=after.braking & ~self.braking), seen


def test_a_planted_bug_is_found() -> None:
    assert judged("patterns_function_generator.brake_stays_on", LetsGo).verdict == "refuted"
