"""Kinematics: the figures of the common physics, readings that agree, refusals; the laws with their verdicts."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import flint
import pytest

from models import kinematics as k
from proofs import kinematics, kinematics_brakes, kinematics_cycle, kinematics_monotone  # noqa: F401  declared on import
from safety import PROVED, ModelError
from safety.prove.bounds.claims import declared
from safety.prove.laws import LawClaim
from safety.terms.direct import evaluate
from safety.terms.graph import REAL, variable

SERVICE, EMERGENCY = (k.B_SERVICE, k.T_SERVICE), (k.B_EMERGENCY, k.T_EMERGENCY)
LAWS = {c.id: c for c in declared() if isinstance(c, LawClaim) and c.id.partition(".")[0].startswith("kinematics")}


def close(value: Fraction | float, printed: str) -> bool:
    return abs(float(value) - float(printed)) <= 0.00051 * 10 ** (3 - len(printed.partition(".")[2]))


@pytest.mark.parametrize(
    ("kmh", "service", "emergency"),
    [(25, "48.611", "35.218"), (45, "137.500", "99.107"), (65, "270.833", "194.742"), (95, "554.167", "397.718"),
     (100, "611.111", "438.492"), (110, "733.333", "525.992"), (130, "1011.11", "724.802")],
)  # fmt: skip
def test_sp_01_distances(kmh: int, service: str, emergency: str) -> None:
    assert close(k.distance(k.mps(kmh), *SERVICE), service)
    assert close(k.distance(k.mps(kmh), *EMERGENCY), emergency)


@pytest.mark.parametrize(
    ("x", "gradient", "ceiling"),
    [(50, 0, "22.295"), (100, 0, "35.559"), (200, 0, "53.694"), (400, 0, "78.934"), (600, 0, "98.175"),
     (400, -20, "67.477"), (400, 20, "88.687")],
)  # fmt: skip
def test_sp_02_ceilings(x: int, gradient: int, ceiling: str) -> None:
    found = k.ceiling(x - k.MARGIN, k.effective(k.B_SERVICE, gradient), k.T_SERVICE)
    assert close(k.kmh(found.low), ceiling) and 0 < found.high - found.low <= Fraction(1, 10**30)


def test_figures_of_the_common_physics() -> None:
    assert close(k.kmh(k.ceiling(390, *EMERGENCY).low), "94.025")
    assert close(k.distance(k.mps(100), k.effective(k.B_SERVICE, -20), k.T_SERVICE), "829.775")
    assert close(k.distance(k.mps(100), k.effective(k.B_SERVICE, 20), k.T_SERVICE), "488.760")


def test_sp_03_conservative_ceiling() -> None:
    found = k.ceiling_accelerating(390, *SERVICE, k.ACCELERATION)
    assert close(k.kmh(found.low), "73.346")
    for x in (Fraction(n, 7) for n in range(0, 7000, 13)):
        assert k.ceiling_accelerating(x, *SERVICE, k.ACCELERATION).high < k.ceiling(x, *SERVICE).low or x == 0


def test_the_conservative_ceiling_is_not_clamped() -> None:
    assert k.ceiling_accelerating(Fraction(1, 8), 1, 1, 1).high == Fraction(-1, 2)
    assert not k.permits_accelerating(Fraction(0), Fraction(1, 8), 1, 1, 1)


def test_sp_04_ceiling_and_distance_are_inverse() -> None:
    draw = random.Random(4)
    for _ in range(1000):
        v, t = draw.uniform(0, 80), draw.uniform(0, 6)
        b = k.effective(draw.uniform(0.5, 1.5), draw.uniform(-35, 35), draw.choice([0, 0.06, 0.1]))
        v1 = draw.uniform(0, v)
        assert k.ceiling_float(k.distance(v, b, t), b, t) == pytest.approx(v, rel=1e-9, abs=1e-9)
        assert k.ceiling_float(k.distance(v, b, t, v1) + 1e-12, b, t, v1) == pytest.approx(v, rel=1e-9, abs=1e-8)


def test_sp_05_target_65() -> None:
    assert close(k.kmh(k.ceiling(300, *SERVICE, k.mps(65)).low), "93.234")


# --- one text, all readings ------------------------------------------------------------------------------------------

RULES: dict[str, tuple[Any, int]] = {
    "permits": (k.permits, 5), "intervenes": (k.intervenes, 5), "stops_within": (k.stops_within, 5),
    "permits_accelerating": (k.permits_accelerating, 6), "intervenes_accelerating": (k.intervenes_accelerating, 6),
    "permits_building_up": (k.permits_building_up, 6),
}  # fmt: skip


def drawn(draw: random.Random, count: int) -> list[Fraction]:
    """Speed, distance, deceleration, free run, then what the rule has beside; now and then on the ceiling itself."""
    v, b, t = Fraction(draw.randrange(60)), Fraction(draw.randrange(3, 15), 10), Fraction(draw.randrange(40), 10)
    rest = [Fraction(draw.randrange(20), 10) for _ in range(count - 4)]
    x = k.distance(v, b, t) if draw.random() < 0.3 else Fraction(draw.randrange(-100, 20000), 10)
    return [v, x, b, t, *rest]


@pytest.mark.parametrize("name", RULES)
def test_all_readings_agree(name: str) -> None:
    rule, count = RULES[name]
    draw = random.Random(name)
    terms = [variable(f"x{i}", REAL) for i in range(count)]
    formula = rule(*terms)
    for _ in range(150):
        numbers = drawn(draw, count)
        exact = rule(*numbers)
        assert evaluate([formula], dict(zip(terms, numbers, strict=True))) == [exact]
        balls = rule(*(flint.arb(flint.fmpq(n.numerator, n.denominator)) for n in numbers))
        assert exact or not balls  # of balls only what surely holds
        doubles, margin = rule(*map(float, numbers)), rule(*nudged(numbers, 1)) == rule(*nudged(numbers, -1))
        assert doubles == exact or not margin  # a double may differ at the ceiling only


def nudged(numbers: list[Fraction], way: int) -> list[Fraction]:
    return [numbers[0], numbers[1] + Fraction(way, 10**9), *numbers[2:]]


def test_intervening_is_not_permitting() -> None:
    draw = random.Random(1)
    for _ in range(500):
        plain, pulled = drawn(draw, 5), drawn(draw, 6)
        assert k.permits(*plain) != k.intervenes(*plain)
        assert k.permits_accelerating(*pulled) != k.intervenes_accelerating(*pulled)


def test_a_ceiling_divides_what_is_permitted() -> None:
    draw = random.Random(2)
    for _ in range(200):
        _, x, b, t, v1 = drawn(draw, 5)
        low, high = k.ceiling(x, b, t, v1)
        assert k.permits(low, x, b, t, v1) and k.intervenes(high + Fraction(1, 10**29), x, b, t, v1)
        assert (
            low - Fraction(1, 10**6)
            <= k.ceiling_float(float(x), float(b), float(t), float(v1))
            <= high + Fraction(1, 10**6)
        )


def test_the_enclosure_holds_the_ball_of_the_ceiling() -> None:
    ends = k.ceiling(390, *SERVICE)
    with flint.ctx.workprec(200):
        b, t = flint.arb(flint.fmpq(25, 36)), flint.arb(2)
        ball = ((b * t) ** 2 + 2 * b * 390).sqrt() - b * t
        low, high = (flint.arb(flint.fmpq(end.numerator, end.denominator)) for end in ends)
        assert low < ball < high


# --- build-up --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("v", "v1"),
    [(Fraction(v), Fraction(v1)) for v, v1 in (("20", "0"), ("20", "15"), ("1", "0"), ("0.7", "0.5"), ("3", "3"))],
)
def test_the_way_of_a_brake_that_builds_up_is_that_of_its_motion(v: Fraction, v1: Fraction) -> None:
    """Against a motion in small steps, which knows nothing of the formula."""
    b, t, build_up, h = 0.8, 1.2, 1.9, 1e-3
    speed, way, time = float(v), float(v) * t, 0.0
    while speed > v1:
        way, speed, time = way + speed * h, speed - h * min(b, b * time / build_up), time + h
    brake = Fraction("0.8"), Fraction("1.2"), Fraction("1.9")
    found = k.distance_building_up(v, *brake, v1)
    assert float(found.middle) == pytest.approx(way, abs=0.05)
    assert found.high <= k.distance(v, brake[0], k.same_as_free_run(*brake[1:]), v1)
    assert k.permits_building_up(v, found.high, *brake, v1)
    assert v == v1 or not k.permits_building_up(v, found.low - Fraction(1, 1000), *brake, v1)


# --- refusals --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("call", "said"),
    [(lambda: k.effective(k.B_SERVICE, -80), "above -70.8136 permille"),
     (lambda: k.distance(3, Fraction(1), 1, 4), "4 m/s"), (lambda: k.distance(3, 0, 1), "above 0"),
     (lambda: k.ceiling(1, 1, -1), "free run = -1 s"), (lambda: k.ceiling_accelerating(-1, 1, 1, 1), "brake is held"),
     (lambda: k.distance(float("nan"), 1.0, 1.0), "nan"), (lambda: k.root(-1), "radicand"),
     (lambda: k.distance_building_up(3, 1, 1, -1), "build-up time")],
)  # fmt: skip
def test_what_cannot_be_is_refused(call: Any, said: str) -> None:
    with pytest.raises(ModelError, match=said):
        call()


# --- laws ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", LAWS)
def test_sp_14_laws(name: str) -> None:
    found = LAWS[name].found(20.0)
    assert found["verdict"] == LAWS[name].expect, found
    assert found["verdict"] != PROVED or found["agreed_by"] == ["z3 nlsat", "cvc5"]


@pytest.mark.parametrize(
    ("law", "witness"),
    [(kinematics.stop_fits_behind_the_point, "v=0 x=-1 b=1 t=1 c=0"),
     (kinematics.braking_less_keeps_the_stop, "v=1 x=1 b=1 d=0 h=1"),
     (kinematics.stop_fits_after_accelerating_under_a_clamped_ceiling, "v=0 x=1/8 b=1 t=1 a=1 c=-1/2")],
)  # fmt: skip
def test_the_counterexamples_of_the_specification_contradict(law: Any, witness: str) -> None:
    pairs = [pair.split("=") for pair in witness.split()]
    terms = {name: variable(name, REAL) for name, _ in pairs}
    assert evaluate([law(**terms)], {terms[name]: Fraction(value) for name, value in pairs}) == [False]


def test_every_property_of_the_ceiling_is_a_law_with_a_twin() -> None:
    assert {f"SP-P{n}" for n in range(1, 7)} == {c.law.requirement for c in LAWS.values()}
    proved = {c.id for c in LAWS.values() if c.expect == PROVED}
    assert {c.twin_of for c in LAWS.values() if c.twin_of} <= proved
