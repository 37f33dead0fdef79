"""What is claimed of the error of Gauss's rule: on coarse rules, and on the ellipse that it is derived from."""

import cmath
import math
from fractions import Fraction

import pytest

from safety.trees.expressions.expression import Operation
from safety.trees.expressions.lifetimes import Exponential, Glm
from safety.trees.over_time import quadrature
from safety.trees.over_time.behaviour import AfterTest
from safety.trees.over_time.mission import Mission
from tests.trees.over_time import L, M, T, voted


@pytest.mark.parametrize("tolerance", [1e-1, 1e-3, 1e-6])
def test_the_error_of_a_rule_is_within_its_bound(tolerance, monkeypatch):
    """Coarse rules, so that the error is far above rounding."""
    monkeypatch.setattr(quadrature, "TOLERANCE", tolerance)
    mission = Mission(voted(2, [Exponential(L, T)] * 3))
    for low, high in ((0, 10_000), (4000, 8000), (20_000, 40_000), (0, 100_000)):
        given = list(quadrature.rules(mission.events, quadrature.Panel(Fraction(0), low, high), 1.0))
        places = [place for rule in given for place in rule.places()]
        down = mission.solution.many(mission.columns([place for place, _ in places]))
        found = math.fsum(w * q for (_, w), q in zip(places, down, strict=True))
        two, three = ((math.exp(-k * 1e-4 * low) - math.exp(-k * 1e-4 * high)) / (k * 1e-4) for k in (2, 3))
        assert (
            abs(found - (high - low - 3 * two + 2 * three)) <= sum(rule.cut for rule in given) <= 2 * tolerance * high
        )


LAWS = [
    (Exponential(L, T), lambda z: cmath.exp(-1e-4 * z)),
    (Glm("0.3", L, M, T), lambda z: 1 - (1e-4 / 0.1001 + (0.3 - 1e-4 / 0.1001) * cmath.exp(-0.1001 * z))),
    (Operation("mul", Fraction(1, 4), Exponential(L, T)), lambda z: 0.75 + cmath.exp(-1e-4 * z) / 4),
]


@pytest.mark.parametrize(("law", "up"), LAWS)
@pytest.mark.parametrize("panel", [(0, 10), (10, 20), (0, 3000), (50_000, 100_000), (0, 6000)])
def test_growth_bounds_the_ellipse(law, up, panel):
    """On the boundary of the ellipse, where analytic functions are largest."""
    (event,) = Mission(voted(1, [law])).events
    middle, half = sum(panel) / 2, (panel[1] - panel[0]) / 2
    bound = event.growth(middle - 3 * half, math.sqrt(8) * half)
    for n in range(200):
        angle = 2 * math.pi * n / 200
        u = up(middle + half * complex(3 * math.cos(angle), math.sqrt(8) * math.sin(angle)))
        assert math.log(abs(u) + abs(1 - u)) <= bound + 1e-9


@pytest.mark.parametrize("rates", [(1e-4, 0.1), (0.1, 1e-4), (0.01, 0.01)])
@pytest.mark.parametrize("panel", [(0, 10), (10, 20), (0, 300), (300, 600)])
def test_growth_bounds_the_ellipse_after_a_test(rates, panel):
    fails, repairs = rates
    after = AfterTest(fails, repairs, 0.4, 1.0)
    middle, half = sum(panel) / 2, (panel[1] - panel[0]) / 2
    bound = after.growth(middle - 3 * half, math.sqrt(8) * half)
    for n in range(200):
        angle = 2 * math.pi * n / 200
        z = middle + half * complex(3 * math.cos(angle), math.sqrt(8) * math.sin(angle))
        fails_only, repairs_only = cmath.exp(-fails * z), cmath.exp(-repairs * z)
        apart = repairs - fails
        back = repairs * (z * fails_only if not apart else (fails_only - repairs_only) / apart)
        u = 0.6 * cmath.exp(-fails * z) + 0.4 * back
        assert math.log(abs(u) + abs(1 - u)) <= bound + 1e-9
    assert 1 - after.unscaled(50) == pytest.approx(0.6 * math.exp(-fails * 50) + 0.4 * after._back(50))
