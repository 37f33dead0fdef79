"""Expressions: every value in doubles, rationals, intervals and derivatives against plain Python arithmetic."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import flint
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety.trees.as_written import TreeError
from safety.trees.expressions.distributions import Lognormal, Normal, Uniform
from safety.trees.expressions.expression import Constant, Expression, MissionTime, Operation, Parameter
from safety.trees.expressions.lifetimes import Exponential, Glm
from safety.trees.expressions.readings import MISSION_TIME
from safety.trees.tree import BasicEvent, FaultTree, Gate

NUMBERS = st.fractions(-20, 20, max_denominator=50)
RATIONAL: dict[str, Callable[..., Fraction]] = {
    "add": lambda *x: sum(x, Fraction(0)),
    "sub": lambda x, *rest: x - sum(rest, Fraction(0)),
    "mul": lambda *x: math.prod(x, start=Fraction(1)),
    "min": lambda *x: min(x),
    "max": lambda *x: max(x),
    "mean": lambda *x: sum(x, Fraction(0)) / len(x),
    "neg": operator.neg,
    "abs": abs,
    "lt": lambda x, y: Fraction(x < y),
    "eq": lambda x, y: Fraction(x == y),
    "df": lambda x, y: Fraction(x != y),
    "geq": lambda x, y: Fraction(x >= y),
    "and": lambda *x: Fraction(all(x)),
    "or": lambda *x: Fraction(any(x)),
    "not": lambda x: Fraction(not x),
    "ite": lambda c, x, y: x if c else y,
    "floor": lambda x: Fraction(math.floor(x)),
    "ceil": lambda x: Fraction(math.ceil(x)),
}
ONE, TWO, THREE = ("neg", "abs", "not", "floor", "ceil"), ("lt", "eq", "df", "geq"), ("ite",)


@st.composite
def written(draw: st.DrawFn, depth: int = 3) -> tuple[Expression, Fraction]:
    """An expression of rationals and its value by plain Python."""
    if depth == 0 or draw(st.integers(0, 3)) == 0:
        number = draw(NUMBERS)
        return Constant(number), number
    tag = draw(st.sampled_from(sorted(RATIONAL)))
    count = 1 if tag in ONE else 2 if tag in TWO else 3 if tag in THREE else draw(st.integers(1, 3))
    parts = [draw(written(depth - 1)) for _ in range(count)]
    return Operation(tag, *(part for part, _ in parts)), RATIONAL[tag](*(value for _, value in parts))


@settings(max_examples=150, deadline=None)
@given(written())
def test_rational_expressions_are_exact_and_their_enclosure_holds(pair: tuple[Expression, Fraction]) -> None:
    expression, value = pair
    assert expression.exact() == value
    low, high = expression.enclosure()
    assert low <= value <= high
    if not {"floor", "ceil", "lt", "eq", "df", "geq", "not", "and", "or", "ite"} & {e.tag for e in expression.below()}:
        assert expression.value() == pytest.approx(float(value), rel=1e-12, abs=1e-9)
        assert high - low <= 1e-9 * (1 + abs(value))


FUNCTIONS = [  # tag, Python's function, arguments
    ("exp", math.exp, (-1.5,)),
    ("log", math.log, (0.3,)),
    ("log10", math.log10, (250.0,)),
    ("sqrt", math.sqrt, (2.5,)),
    ("sin", math.sin, (0.7,)),
    ("cos", math.cos, (2.7,)),
    ("tan", math.tan, (0.7,)),
    ("asin", math.asin, (0.7,)),
    ("acos", math.acos, (-0.7,)),
    ("atan", math.atan, (1.7,)),
    ("sinh", math.sinh, (-0.7,)),
    ("cosh", math.cosh, (0.7,)),
    ("tanh", math.tanh, (0.7,)),
    ("pow", math.pow, (1.3, 2.7)),
    ("pow", math.pow, (-1.3, 3.0)),
    ("mod", math.fmod, (7.5, 2.0)),
    ("div", operator.truediv, (7.5, 2.2)),
    ("mul", operator.mul, (7.5, 2.2)),
    ("sub", operator.sub, (7.5, 2.2)),
    ("abs", abs, (-2.2,)),
    ("max", max, (7.5, 2.2)),
    ("min", min, (7.5, 2.2)),
]


@pytest.mark.parametrize(("tag", "function", "arguments"), FUNCTIONS)
def test_functions_their_enclosures_and_their_derivatives(
    tag: str, function: Callable[..., float], arguments: tuple[float, ...]
) -> None:
    for place, x in enumerate(arguments):
        if tag == "pow" and x == 3.0:
            continue  # of a negative base: defined at whole exponents only
        others = [Constant(value) for value in arguments]
        expression = Operation(tag, *others[:place], Parameter("x", x), *others[place + 1 :])
        value = function(*arguments)
        assert expression.value() == value
        low, high = expression.enclosure()
        assert low <= value <= high <= low + 1e-13 * (1 + abs(value))
        h = 1e-5

        def at(x: float, place: int = place) -> float:
            return function(*arguments[:place], x, *arguments[place + 1 :])

        slope = (at(x - 2 * h) - 8 * at(x - h) + 8 * at(x + h) - at(x + 2 * h)) / (12 * h)
        assert expression.derivative("x") == pytest.approx(slope, rel=1e-8, abs=1e-8)


WIDE = [
    ("exp", math.exp, -2, 3),
    ("sin", math.sin, 0, 7),
    ("cosh", math.cosh, -2, 1),
    ("tan", math.tan, -0.5, 0.5),
    ("acos", math.acos, -0.9, 0.3),
    ("log", math.log, 0.1, 4),
    ("sqrt", math.sqrt, 0, 4),
    ("abs", abs, -2, 1),
    ("floor", math.floor, -1.5, 1.5),
    ("neg", operator.neg, -1, 2),
]


@pytest.mark.parametrize(("tag", "function", "low", "high"), WIDE)
def test_the_interval_of_possible_values_holds_them_all(
    tag: str, function: Callable[[float], float], low: float, high: float
) -> None:
    found = Operation(tag, Uniform(low, high)).interval()
    values = [function(low + (high - low) * n / 200) for n in range(201)]
    assert found[0] <= min(values) and max(values) <= found[1]


@pytest.mark.parametrize(
    ("base", "exponent"), [((-2, 3), 2), ((-2, 3), 3), ((0, 2), 0.5), ((-3, -1), -2), ((1, 2), -1)]
)
def test_the_interval_of_a_power_holds_all_values(base: tuple[int, int], exponent: float) -> None:
    low, high = Operation("pow", Uniform(*base), exponent).interval()
    values = [math.pow(base[0] + (base[1] - base[0]) * n / 100, exponent) for n in range(101)]
    assert low <= min(values) and max(values) <= high


def test_the_interval_of_a_comparison_of_ranges_is_open() -> None:
    assert Operation("lt", Uniform(0, 2), 1).interval() == (0, 1)
    assert Operation("lt", Uniform(0, 2), 3).interval() == (1, 1)
    assert Operation("ite", Operation("gt", Uniform(0, 2), 1), "0.25", "0.5").interval() == (0.25, 0.5)
    assert Operation("div", 1, Uniform(-1, 1)).interval() == (-math.inf, math.inf)


def test_a_branch_that_is_not_taken_needs_no_value() -> None:
    x = Parameter("x", 0)
    safe = Operation("ite", Operation("eq", x, 0), "0.5", Operation("div", 1, x))
    assert (safe.value(), safe.exact(), safe.value(parameters={"x": 4})) == (0.5, Fraction(1, 2), 0.25)
    switch = Operation("switch", Operation("eq", x, 1), "0.1", Operation("eq", x, 2), "0.2", "0.3")
    assert [switch.value(parameters={"x": n}) for n in range(4)] == [0.3, 0.1, 0.2, 0.3]
    with pytest.raises(TreeError, match="<div> has no value here"):
        Operation("div", 1, x).value()


def test_parameters_are_replaced_by_name_and_the_mission_time_is_needed() -> None:
    rate = Parameter("rate", "1e-4", "hours-1")
    law = Exponential(rate, MissionTime())
    assert law.value(1000) == -math.expm1(-0.1)
    assert law.value(1000, {"rate": "2e-4"}) == -math.expm1(-0.2)
    assert law.derivative("rate", 1000) == pytest.approx(1000 * math.exp(-0.1), rel=1e-14)
    assert law.derivative(MISSION_TIME, 1000) == pytest.approx(1e-4 * math.exp(-0.1), rel=1e-14)
    assert law.derivative("unheard of", 1000) == 0
    assert law.parameters == {"rate": rate}
    with pytest.raises(TreeError, match="pass mission_time_h"):
        law.value()


def test_operators_and_equality_go_by_structure() -> None:
    x, y = Parameter("x", 2), Parameter("y", 3)
    assert (x + y, x - y, x * y, x / y, -x) == tuple(
        Operation(*each) for each in (("add", x, y), ("sub", x, y), ("mul", x, y), ("div", x, y), ("neg", x))
    )
    assert (x * y).exact() == 6 and x * y != y * x and hash(x * y) == hash(Parameter("x", 2) * y)
    assert Parameter("x", 2) != Parameter("x", 3)
    assert repr(Exponential("1e-3", 2)) == "Exponential(Constant('1/1000'), Constant('2'))"


def test_expressions_nest_to_a_limit() -> None:
    chain: Expression = Constant("0.5")
    for n in range(99):
        chain = Parameter(f"p{n}", chain) if n % 2 else Operation("ite", 1, chain, chain)
    assert event(chain).chance == (0.5, 0.5) and chain.enclosure() == chain.interval() == (0.5, 0.5)
    with pytest.raises(TreeError, match="at most 100"):
        Parameter("one more", chain)


def test_a_distribution_stands_for_its_mean() -> None:
    assert Exponential(Lognormal("1e-3", 3, "0.95"), 10).value() == -math.expm1(-0.01)
    assert Exponential(0, Uniform(0, 4)).exact() == 0
    assert Normal("0.2", "0.1").interval() == (-math.inf, math.inf)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Operation("ite", 1, 2), "has 2 arguments, expected 3"),
        (lambda: Operation("switch", 1, 2), "expected an odd number"),
        (lambda: Operation("add"), "has 0 arguments, expected 1 or more"),
        (lambda: Operation("expm1", 1), "<expm1> is no operation"),
        (lambda: Constant("many"), "expected a number"),
        (lambda: Exponential("-1e-3", 2), "failure rate per hour of <exponential> is -0.001, expected 0 or more"),
        (lambda: Exponential("1e-3"), r"<exponential> has 1 arguments, expected 2 \(failure rate per hour, time"),
        (lambda: Lognormal("1e-3", "0.5", "0.95"), "error factor of <lognormal-deviate> is 0.5, expected 1 or more"),
        (lambda: Lognormal("1e-3", 3, 1), "level of <lognormal-deviate> is 1, expected more than 0 and less than 1"),
        (lambda: Uniform(2, 1), "fall, from 2.0 to 1.0"),
        (lambda: Exponential(Operation("sub", 1, 2), MissionTime()).value(5), "failure rate per hour .* is -1"),
        (lambda: Exponential("1e-3", MissionTime()).value(-5), "time in hours .* is -5"),
    ],
)
def test_what_has_no_meaning_is_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(TreeError, match=message):
        make()


def event(expression: Expression, **more: object) -> BasicEvent:
    return BasicEvent("e", expression=expression, **more)  # type: ignore[arg-type]


def test_an_event_takes_its_chance_from_the_expression() -> None:
    product = Parameter("p", "0.1") * "0.5"
    assert event(product).exact_chance == (Fraction(1, 20), Fraction(19, 20))
    assert event(product).chance == (0.05, 0.95)
    law = Exponential("1e-2", MissionTime())
    assert event(law).chance is None and event(law).exact_chance is None
    tree = FaultTree("t", "top", (Gate("top", "or", ("e",)),), (event(law),), mission_time_h=Fraction(5000))
    assert tree.events[0].chance == (-math.expm1(-50), math.exp(-50))
    assert tree.events[0].exact_chance is None
    assert tree.events[0].formula == law


def test_the_formula_of_a_plain_event_says_the_same() -> None:
    for plain in (BasicEvent("e", Fraction(1, 3)), BasicEvent("e", None, Fraction(1, 1000), Fraction(70))):
        assert plain.formula is not None
        assert plain.formula.chance() == pytest.approx(plain.chance, rel=1e-15)
    assert BasicEvent("e").formula is None


def test_a_sum_that_rounds_to_more_than_one_is_one() -> None:
    total = Operation("add", "0.1", "0.7", "0.2", "1e-17", "-1e-17")
    assert total.exact() == 1
    tree_event = event(replace_first(total))
    assert tree_event.chance is not None and tree_event.chance[0] <= 1


def replace_first(total: Expression) -> Expression:
    """A sum whose doubles may exceed 1 although it is 1 exactly."""
    return Operation("add", *total.arguments, Operation("sub", Operation("exp", 0), 1))


@pytest.mark.parametrize(
    "law",
    [
        Constant("0.1") + Constant("0.2"),
        Exponential("1e-3", 700),
        Exponential(Parameter("r", "1e-3") * 2, "700"),
        Glm("0.1", "1e-3", "1e-2", 70),
        Operation("exp", -3),
    ],
)
def test_the_error_of_a_chance_is_bounded(law: Expression) -> None:
    one = BasicEvent("e", None, Fraction("1e-3"), Fraction(700)) if law == Exponential("1e-3", 700) else event(law)
    assert one.chance is not None and one.chance_error < 1e-13
    with flint.ctx.workprec(200):
        true = in_balls(law)
        for double, ball in zip(one.chance, (true, 1 - true), strict=True):
            assert abs(flint.arb(double) - ball) <= one.chance_error * ball


def in_balls(law: Expression) -> flint.arb:
    """The value in ball arithmetic of 200 bits."""
    values = [in_balls(argument) for argument in law.arguments]
    match law.tag:
        case "float":
            number = law.exact() or Fraction(0)
            return flint.arb(flint.fmpq(number.numerator, number.denominator))
        case "parameter":
            return values[0]
        case "add":
            return sum(values, flint.arb(0))
        case "mul":
            return values[0] * values[1]
        case "exp":
            return values[0].exp()
        case "exponential":
            return 1 - (-values[0] * values[1]).exp()
    gamma, rate, repair, time = values
    steady = rate / (rate + repair)
    return steady - (steady - gamma) * (-(rate + repair) * time).exp()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: event(Constant("1.3")), 'expression of basic event "e" gives 1.3, expected a probability'),
        (lambda: event(Normal("-0.1", 1)), "gives -0.1"),
        (lambda: event(Exponential("1e-3", MissionTime()), rate_per_hour=1), "an expression besides"),
        (lambda: event(Operation("log", Parameter("x", 0))), 'basic event "e": <log> has no value here'),
        (
            lambda: FaultTree("t", "g", (Gate("g", "or", ("e",)),), (event(Exponential(1, MissionTime())),)),
            "an expression of the mission time and no mission time",
        ),
        (
            lambda: replace(event(Operation("mul", 1, MissionTime())), mission_time_h=Fraction(3)),
            "gives 3, expected a probability",
        ),
    ],
)
def test_an_expression_that_is_no_probability_is_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(TreeError, match=message):
        make()
