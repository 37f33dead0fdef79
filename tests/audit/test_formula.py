"""Formulas: what is read, how it is written again, its value, its units, and what is refused."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety.audit import AuditError, Span, sqrt
from safety.audit.formula import Formula, constant, decimal, formula, relation, symbol
from safety.audit.spans import NUMBERS
from safety.audit.symbols import Symbol, Symbols
from safety.audit.units import Mismatch, dimension, unit


def value(text: str, **values: int) -> Fraction:
    return formula(text).over(NUMBERS, {name: Span(number) for name, number in values.items()}).low


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1 + 2*3", 7),
        ("(1 + 2)*3", 9),
        ("8/4/2", 1),
        ("8 - 4 - 2", 2),
        ("2^3", 8),
        ("-2^2", -4),
        ("2*-3", -6),
        ("2^-2", Fraction(1, 4)),
        ("sqrt(9/4)", Fraction(3, 2)),
        ("0.25 · 4 − 1", 0),
        ("a × b", 6),
        ("x'c + x''c", 12),
        ("ΔV/α", Fraction(1, 2)),
    ],
)
def test_a_formula_has_the_value_that_a_reader_expects(text: str, expected: Fraction) -> None:
    assert value(text, a=2, b=3, α=4, ΔV=2, **{"x'c": 5, "x''c": 7}) == expected


@pytest.mark.parametrize(
    "text",
    ["1 +", "a b", "2a", "a^b", "a**0.5", "f(x)", "(a", "a)", "", "a; b", "__import__('os')", "a = = b", "a ^ 2 ^ 3"],
)
def test_what_is_no_formula_is_refused_with_the_text(text: str) -> None:
    with pytest.raises(AuditError, match="|".join([r"products need a \*", "cannot be read"])):
        relation(text)


@pytest.mark.parametrize(
    "text",
    ["(" * 2000 + "x" + ")" * 2000, "(" * 60 + "x" + ")" * 60, "-" * 5000 + "x", "x+" * 1500 + "x", "x^999999",
     "x^9999999999", "((x^99)^99)^99", "2^9^9", "9" * 5000, "x^1001", "1/x^600*x^600"],
)  # fmt: skip
def test_what_is_too_large_is_refused_at_once(text: str) -> None:
    with pytest.raises(AuditError, match=r"too l|brackets|exponent|not expected"):
        relation(text)


def test_definitions_do_not_grow_beyond_what_can_be_judged() -> None:
    for grow in ("{0}*{0}", "{0} + {0}", "{0} - {0}^9"):
        symbols = Symbols({"x0": Symbol("x0", "1")})
        for n in range(1, 60):
            symbols.of[f"x{n}"] = Symbol(f"x{n}", "1", by=formula(grow.format(f"x{n - 1}")))
        with pytest.raises(AuditError, match="too l"):
            symbols.expanded(symbol("x59"), {}, values=False)


def test_a_relation_is_no_formula() -> None:
    with pytest.raises(AuditError, match="a single formula"):
        formula("a = b")


def test_a_chain_has_its_signs() -> None:
    chain = relation("a ≤ b < c = 2")
    assert (chain.signs, str(chain)) == (("<=", "<", "="), "a <= b < c = 2")


names = st.sampled_from("abc").map(symbol) | st.integers(1, 9).map(constant)
formulas = st.recursive(
    names,
    lambda inner: (
        st.builds(lambda op, a, b: Formula(op, (a, b)), st.sampled_from("+-*/"), inner, inner)
        | inner.map(lambda a: Formula("neg", (a,)))
        | st.builds(lambda a, n: Formula("^", (a,), number=Fraction(n)), inner, st.integers(-2, 3))
    ),
    max_leaves=8,
)


@given(formulas)
def test_what_is_written_again_is_read_as_the_same(each: Formula) -> None:
    at = {"a": Span(Fraction(7, 3)), "b": Span(Fraction(5, 11)), "c": Span(13)}
    try:
        expected = each.over(NUMBERS, at).low
    except ZeroDivisionError:
        return
    assert formula(str(each)).over(NUMBERS, at).low == expected


@given(st.fractions(max_denominator=4000))
def test_a_decimal_is_exact(number: Fraction) -> None:
    assert Fraction(decimal(number)) == number


@given(st.fractions(0, 1000), st.fractions(0, 10))
def test_a_root_is_enclosed(low: Fraction, width: Fraction) -> None:
    root = sqrt(Span(low, low + width))
    assert root.low**2 <= low and low + width <= root.high**2
    assert sqrt(low * low).exact and sqrt(low * low).low == low


spans = st.tuples(st.fractions(-9, 9), st.fractions(0, 3)).map(lambda each: Span(each[0], each[0] + each[1]))


@given(spans, spans, st.fractions(0, 1), st.fractions(0, 1))
def test_an_interval_has_every_result(a: Span, b: Span, s: Fraction, t: Fraction) -> None:
    x, y = a.low + s * (a.high - a.low), b.low + t * (b.high - b.low)
    assert Span(x + y).within(a + b) and Span(x - y).within(a - b) and Span(x * y).within(a * b)
    if not b.low <= 0 <= b.high:
        assert Span(x / y).within(a / b)


@pytest.mark.parametrize(
    ("text", "scale"),
    [
        ("km/h", Fraction(5, 18)), ("kHz", 1000), ("c/s", 1), ("%", Fraction(1, 100)), ("km/h/s", Fraction(5, 18)),
        ("Hz/(km/h)", Fraction(18, 5)), ("mm", Fraction(1, 1000)), ("ms", Fraction(1, 1000)), ("min", 60), ("1", 1),
        ("kVA", 1000), ("ppm", Fraction(1, 10**6)), ("day", 86400), ("mile/h", Fraction("0.44704")),
    ],
)  # fmt: skip
def test_units_are_converted_exactly(text: str, scale: Fraction) -> None:
    assert unit(text).scale == scale


def test_an_unknown_unit_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(AuditError, match="there is no 'furlong'"):
        unit("furlong")


def test_unlike_quantities_are_not_added() -> None:
    units = {"f": unit("Hz"), "T": unit("s")}
    assert dimension(formula("f*T"), units) == ()
    with pytest.raises(Mismatch, match=r"s\^-1 and a pure number"):
        dimension(formula("f + 1"), units)
