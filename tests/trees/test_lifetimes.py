"""Laws of repairable and tested parts against their Markov chains (matrix exponentials) and against SCRAM."""

from __future__ import annotations

import itertools
import math
import random
import re
import shutil
import subprocess
from decimal import Decimal, localcontext
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from safety.rates.exponential import transient_by_exponential
from safety.rates.markov import Chain
from safety.trees.as_written import TreeError
from safety.trees.expressions.expression import Expression, MissionTime, Operation, Parameter
from safety.trees.expressions.lifetimes import Exponential, Glm, PeriodicTest, Weibull
from safety.trees.expressions.readings import MISSION_TIME

RATES = [("1e-5", "0.1", "0"), ("1e-3", "1e-2", "0.2"), ("1e-2", "0", "1"), ("0", "1e-2", "0.5"), ("0", "0", "0.3")]


@pytest.mark.parametrize(("rate", "repair", "gamma"), RATES)
@pytest.mark.parametrize("time", ["0", "1e-3", "100", "8760"])
def test_glm_is_the_chain_of_a_repairable_part(rate: str, repair: str, gamma: str, time: str) -> None:
    value = Glm(gamma, rate, repair, time).value()
    q, r = Fraction(gamma), Fraction(rate)
    down = Fraction(0)
    for start, weight in (("up", 1 - q), ("down", q)):
        rates = {("up", "down"): r, ("down", "up"): Fraction(repair)}
        chain = Chain(start, rates)
        down += (
            weight * transient_by_exponential(chain, time).probability["down"].low
            if any(rates.values())
            else (weight * (start == "down"))
        )
    exponent = float((r + Fraction(repair)) * Fraction(time))  # its rounding is a relative error of the exponential
    assert value == pytest.approx(float(down), rel=1e-15 * (4 + exponent), abs=1e-300)


def test_weibull_against_its_formula_and_zero_before_the_shift() -> None:
    law = Weibull(1000, 2, 100, MissionTime())
    assert law.value(400) == pytest.approx(1 - math.exp(-0.09), rel=1e-14)
    assert law.value(400) + law.chance(400)[1] == pytest.approx(1, abs=1e-15)
    assert (law.value(50), law.exact(50), law.value(100)) == (0, 0, 0)
    assert law.chance(40_000)[1] == pytest.approx(math.exp(-(39.9**2)), rel=1e-12)
    assert Weibull(1000, 1, 0, 7).value() == pytest.approx(Exponential("1e-3", 7).value(), rel=1e-15)


def simulated(values: list[float]) -> float:
    """The part of 11 arguments, phase by phase with 3 x 3 matrix exponentials over (up, failed, in repair)."""
    rate, in_test, repair, tau, theta, gamma, duration, available, sigma, omega, time = values

    def chain(failing: float) -> np.ndarray:
        generator = np.zeros((3, 3))
        generator[0, 1] = failing
        generator[2, 0], generator[2, 1] = repair * (1 - omega), repair * omega
        return generator - np.diag(generator.sum(axis=1))

    state = np.array([1.0, 0.0, 0.0]) @ expm(chain(rate) * min(time, theta))
    for n in itertools.count():
        begin = theta + n * tau
        if time <= begin:
            return float(state[1] + state[2])
        begun = np.array([state[0] * (1 - gamma), state[1] + state[0] * gamma, 0.0])
        untested = np.array([0.0, 0.0, state[2]])
        hours = min(time - begin, duration)
        begun, untested = begun @ expm(chain(in_test) * hours), untested @ expm(chain(rate) * hours)
        if time <= begin + duration:
            return float(begun[0] * (1 - available) + begun[1] + untested[1] + untested[2])
        state = np.array([begun[0], begun[1] * (1 - sigma), begun[1] * sigma]) + untested
        state = state @ expm(chain(rate) * (min(time, begin + tau) - begin - duration))
    raise AssertionError


def parts(seed: int) -> list[float]:
    draw = random.Random(seed)
    tau = draw.uniform(100, 1000)
    return [
        10 ** draw.uniform(-6, -2),
        10 ** draw.uniform(-6, -2),
        draw.choice([0.0, 10 ** draw.uniform(-4, 0)]),
        tau,
        draw.uniform(0, 1500),
        draw.choice([0.0, draw.random()]),
        draw.choice([0.0, draw.uniform(0, tau)]),
        draw.choice([0.0, 1.0, draw.random()]),
        draw.random(),
        draw.random(),
        draw.uniform(0, 3000),
    ]


@pytest.mark.parametrize("seed", range(16))
def test_the_tested_part_follows_its_chain(seed: int) -> None:
    values = parts(seed)
    law = PeriodicTest(*values)
    assert law.value() == pytest.approx(simulated(values), rel=1e-9)
    low, high = law.enclosure()
    assert low <= law.value() <= high <= low + 1e-3
    rate, _, repair, tau, theta, *_, time = values
    shorter = [rate, rate, repair, tau, theta, 0.0, 0.0, 1.0, 1.0, 0.0, time]
    assert PeriodicTest(rate, repair, tau, theta, time).value() == pytest.approx(simulated(shorter), rel=1e-9)
    at_once = [rate, rate, 1e4, tau, theta, 0.0, 0.0, 1.0, 1.0, 0.0, time]
    assert PeriodicTest(rate, tau, theta, time).value() == pytest.approx(simulated(at_once), rel=1e-3)


@pytest.mark.parametrize("place", range(10))
@pytest.mark.parametrize("seed", [3, 4, 8])
def test_derivatives_of_the_tested_part(seed: int, place: int) -> None:
    values = parts(seed)
    values[5] = values[7] = 0.5
    values[2] = 1e-3
    law = PeriodicTest(*(Parameter("x", v) if n == place else v for n, v in enumerate(values)))
    h = values[place] * 1e-5

    def at(x: float) -> float:
        return PeriodicTest(*(x if n == place else v for n, v in enumerate(values))).value()

    x = values[place]
    slope = (at(x - 2 * h) - 8 * at(x - h) + 8 * at(x + h) - at(x + 2 * h)) / (12 * h) if h else 0.0
    assert law.derivative("x") * x == pytest.approx(slope * x, rel=1e-6, abs=1e-9)


def test_equal_rates_of_failure_and_repair_are_no_division_by_zero() -> None:
    law = PeriodicTest("1e-3", "1e-3", 100, 10, MissionTime())
    near = PeriodicTest("1e-3", "1.0000001e-3", 100, 10, MissionTime())
    assert law.value(555) == pytest.approx(near.value(555), rel=1e-6)
    assert law.derivative(MISSION_TIME, 555) == pytest.approx((law.value("555.001") - law.value(555)) * 1000, rel=1e-3)


@pytest.mark.parametrize(("tau", "time"), [("0.1", "0.3"), ("0.1", "1.1"), ("0.1", "0.7"), (4380, 8760), ("1/3", 1)])
def test_at_the_instant_of_a_test_the_value_is_that_before_it(tau: object, time: object) -> None:
    law = PeriodicTest("1e-2", tau, 0, MissionTime())  # type: ignore[arg-type]
    before = Exponential("1e-2", tau).value()  # type: ignore[arg-type]
    assert law.value(time) == pytest.approx(before, rel=1e-9)  # type: ignore[arg-type]
    low, high = law.enclosure(time)  # type: ignore[arg-type]
    assert low <= law.value(time) <= high <= low * (1 + 1e-9)  # type: ignore[arg-type]


@pytest.mark.parametrize(("rate", "repair"), [("1", "1e-9"), ("1e-9", "1"), ("2", "1"), ("1", "1")])
def test_rates_far_apart_from_each_other_and_from_the_interval(rate: str, repair: str) -> None:
    """Against the recursion in decimals of 2000 digits, where nothing overflows or cancels."""
    q, r, tau, time = Decimal(rate), Decimal(repair), Decimal(1000), Decimal(8760)
    with localcontext() as context:
        context.prec, context.Emin = 2000, -(10**9)

        def run(state: tuple[Decimal, Decimal, Decimal], hours: Decimal) -> tuple[Decimal, Decimal, Decimal]:
            up, failed, repair = state
            stays, still = (-q * hours).exp(), (-r * hours).exp()
            back = repair * (r * hours * stays if q == r else r * (stays - still) / (r - q))
            return up * stays + back, failed + up * (1 - stays) + repair - still * repair - back, still * repair

        state = (Decimal(1), Decimal(0), Decimal(0))
        begun = 9  # at 0, 1000, ..., 8000
        for n in range(begun):
            up, failed, mended = state
            state = run((up, Decimal(0), mended + failed), tau if n < begun - 1 else time - 1000 * (begun - 1))
        down = state[1] + state[2]
    law = PeriodicTest(rate, repair, 1000, 0, MissionTime())
    assert law.value(8760) == pytest.approx(float(down), rel=1e-14)
    low, high = law.enclosure(8760)
    assert low <= down <= high <= low + 1e-8
    assert math.isfinite(PeriodicTest(Parameter("q", rate), repair, 1000, 0, 8760).derivative("q"))


def test_tests_at_uncertain_times_are_counted_alike_in_rationals_and_doubles() -> None:
    """At the instant of the third test, after two that each make a tenth of the good parts fail for good."""
    from safety.trees.expressions.distributions import Uniform

    law = PeriodicTest(0, 0, 0, Uniform(40, 60), 0, "0.1", 0, 1, 0, 0, MissionTime())
    assert law.exact(100) == Fraction(19, 100) and law.value(100) == pytest.approx(0.19, rel=1e-15)
    assert law.exact(101) == Fraction(271, 1000)


def test_uncertain_test_times_leave_the_interval_open() -> None:
    from safety.trees.expressions.distributions import Uniform

    assert PeriodicTest("1e-2", Uniform(10, 20), 0, 15).interval() == (0, 1)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((1, 2, 3), "has 3 arguments, expected 4 "),
        (("1e-3", 0, 0, 5), "test interval in hours of <periodic-test> is 0, expected more than 0"),
        (
            ("1e-3", "1e-3", 1, 10, 0, 0, 11, 1, 1, 0, 5),
            "test interval less test duration of <periodic-test> is -1, expected 0 or more",
        ),
        (("1e-3", "1e-3", 1, 10, 0, 2, 1, 1, 1, 0, 5), "makes the part fail .* is 2, expected between 0 and 1"),
        (("1e-3", 1, "1e-3", 0, 5000), "has 5000000 tests"),
    ],
)
def test_a_test_plan_without_meaning_is_refused(arguments: tuple[str | int, ...], message: str) -> None:
    with pytest.raises(TreeError, match=message):
        PeriodicTest(*arguments).value()


def mef(expression: Expression) -> str:
    """The expression in the format's XML."""
    if not expression.arguments and expression.tag == "float":
        return f'<float value="{expression.value()!r}"/>'
    parts = [mef(argument) for argument in expression.arguments]
    if expression.tag == "switch":
        pairs = zip(parts[:-1:2], parts[1:-1:2], strict=True)
        parts = [*(f"<case>{condition}{value}</case>" for condition, value in pairs), parts[-1]]
    return f"<{expression.tag}>{''.join(parts)}</{expression.tag}>"


def operation(tag: str, *arguments: Expression | float) -> Expression:
    return Operation(tag, *arguments)


@pytest.mark.skipif(shutil.which("scram") is None, reason="scram is not installed (Debian package scram)")
def test_all_laws_agree_with_scram(tmp_path: Path) -> None:
    laws: list[Expression] = [
        Exponential(1e-4, 8760),
        Glm(0.01, 1e-4, 1e-2, 100),
        Weibull(1000, 2, 100, 400),
        Weibull(1000, 2, 100, 50),
        *(PeriodicTest(1e-4, 720, 100, t) for t in (50, 100, 820, 8000)),
        *(PeriodicTest(1e-4, 1e-2, 720, 100, t) for t in (50, 820, 8000)),
        *(PeriodicTest(1e-4, 2e-4, 1e-2, 720, 100, 0.01, 10, x, 0.9, 0.02, t) for x in (0, 1) for t in (50, 105, 8025)),
        *(PeriodicTest(*values) for values in (parts(seed) for seed in range(12)) if values[2] and values[6]),
        Operation("sub", 0.9, 0.2, 0.1),
        Operation("div", 0.9, 2, 3),
        Operation("mean", 0.1, 0.2, 0.6),
        *(
            (operation(tag, 0.3) + 2) / 10
            for tag in ("exp", "sin", "cos", "asin", "acos", "atan", "sinh", "cosh", "tanh")
        ),
        *(operation(tag, 1.7) for tag in ("log", "log10", "sqrt", "abs", "floor", "ceil")),
        operation("neg", -0.3),
        operation("pow", 0.3, 1.7),
        operation("mod", 17, 5),
        operation("pi"),
        *(operation(tag, 0.7, 0.2, 0.4) for tag in ("min", "max", "add", "mul")),
        *(operation(tag, a, b) for tag in ("eq", "df", "lt", "gt", "leq", "geq") for a in (1, 2) for b in (1, 2)),
        *(operation(tag, a, b) for tag in ("and", "or") for a in (0, 1) for b in (0, 1)),
        operation("not", 0),
        operation("ite", operation("lt", 1, 2), 0.3, 0.4),
        *(operation("switch", operation("eq", x, 1), 0.1, operation("eq", x, 2), 0.2, 0.3) for x in (1, 2, 3)),
    ]
    laws = [law if 0 <= law.value() <= 1 else operation("div", law, 10) for law in laws]
    events = "".join(f'<define-basic-event name="e{n}">{mef(law)}</define-basic-event>' for n, law in enumerate(laws))
    trees = "".join(
        f'<define-fault-tree name="T{n}"><define-gate name="g{n}"><basic-event name="e{n}"/></define-gate>'
        "</define-fault-tree>"
        for n in range(len(laws))
    )
    file = tmp_path / "laws.xml"
    file.write_text(f"<opsa-mef>{trees}<model-data>{events}</model-data></opsa-mef>")
    run = subprocess.run(["scram", "--probability", "1", str(file)], capture_output=True, text=True, timeout=60)
    found = dict(re.findall(r'<sum-of-products name="g(\d+)"[^>]* probability="([^"]*)"', run.stdout))
    assert len(found) == len(laws), run.stderr
    for n, law in enumerate(laws):
        assert law.value() == pytest.approx(float(found[str(n)]), rel=1e-5), law  # 6 digits are printed
