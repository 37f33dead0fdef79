"""Whether inputs within their ranges give a value: a yes has a point, a no survives every sample."""

from decimal import Decimal
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety.audit import AuditError, Figure, Paper, Span, printed, sqrt
from safety.audit.exceptions import Undecided
from safety.audit.reach import escapes, find
from safety.audit.text import text
from tests.apart import kept

SMALL = st.fractions(-4, 4, max_denominator=20)
RANGES = st.tuples(SMALL, st.fractions(0, 2, max_denominator=20)).map(lambda each: Span(each[0], each[0] + each[1]))
FUNCTIONS = [
    lambda at: at["x"] + 2 * at["y"],
    lambda at: at["x"] * at["y"] - at["y"],
    lambda at: at["x"] * at["x"] - at["y"],
    lambda at: (at["x"] + 9) / (at["y"] + 9),
    lambda at: sqrt(at["x"] * at["x"] + 1) - at["y"],
]


@settings(max_examples=60)
@given(st.sampled_from(FUNCTIONS), RANGES, RANGES, RANGES, st.lists(st.tuples(st.fractions(0, 1), st.fractions(0, 1))))
def test_a_yes_has_a_point_and_a_no_survives_samples(
    function: Any, x: Span, y: Span, target: Span, shares: list[tuple[Fraction, Fraction]]
) -> None:
    box = {"x": x, "y": y}
    start = {name: Span(each.middle) for name, each in box.items()}
    target = Span(target.low, target.high + Fraction(1, 100))
    try:
        point = find(function, box, start, target)
    except AuditError:
        return  # it may stay open, but is never answered wrongly
    if point is not None:
        found = {name: Span(point.get(name, start[name].low)) for name in box}
        assert all(found[name].within(box[name]) for name in box)
        assert function(found).within(target)
        return
    for s, t in [(Fraction(0), Fraction(1)), (Fraction(1), Fraction(0)), *shares]:
        at = {"x": Span(x.low + s * (x.high - x.low)), "y": Span(y.low + t * (y.high - y.low))}
        assert not function(at).within(target)


def test_a_gap_is_not_crossed() -> None:
    box, start = {"x": Span(-1, 1)}, {"x": Span(Fraction(1, 2))}
    with pytest.raises(AuditError, match="stays open"):
        find(lambda at: 1 / at["x"], box, start, Span(0, Fraction(1, 2)))


def test_a_target_of_no_width_is_crossed() -> None:
    box, start = {"x": Span(1, 2)}, {"x": Span(1)}
    point = find(lambda at: at["x"] * at["x"] - 2, box, start, Span(0))
    assert point is not None and abs(point["x"] ** 2 - 2) < Fraction(1, 10**20)


def test_a_leap_is_not_crossed() -> None:
    def leap(at: Any) -> Span:
        return Span(at["x"].low // 1, at["x"].high // 1)

    box, start = {"x": Span(0, 3)}, {"x": Span(0)}
    for target in (Span(Fraction(3, 2)), Span(Fraction(5, 4), Fraction(7, 4))):
        with pytest.raises(Undecided, match="stays open"):
            find(leap, box, start, target)


@settings(max_examples=60)
@given(st.sampled_from(FUNCTIONS), RANGES, st.integers(-3, 3), st.integers(0, 4), RANGES)
def test_with_counts_a_yes_is_whole_and_a_no_survives_all(function: Any, x: Span, y: int, n: int, target: Span) -> None:
    box, whole = {"x": x, "y": Span(y, y + n)}, frozenset("y")
    start = {"x": Span(x.middle), "y": Span(y)}
    wide = Span(target.low, target.high + Fraction(1, 100))
    for ask, inside in ((find, True), (escapes, False)):
        try:
            point = ask(function, box, start, wide, whole)
        except AuditError:
            continue
        if point is not None:
            found = {name: Span(point.get(name, start[name].low)) for name in box}
            assert all(found[name].within(box[name]) for name in box) and found["y"].low.denominator == 1
            assert function(found).within(wide) is inside
            continue
        for count in range(y, y + n + 1):
            for share in (Fraction(0), Fraction(1, 3), Fraction(1)):
                at = {"x": Span(x.low + share * (x.high - x.low)), "y": Span(count)}
                assert function(at).within(wide) is not inside


@settings(max_examples=40)
@given(st.fractions(-50, 50, max_denominator=64), st.integers(0, 4), st.integers(-3, 3))
def test_what_is_printed_right_is_confirmed_and_nothing_else(value: Fraction, places: int, units: int) -> None:
    def relation() -> Fraction:
        return value

    in_units = value * 10**places
    number = round(in_units) + units
    found = judged(f"{Decimal(number).scaleb(-places):.{places}f}", relation)
    assert found == ("confirmed" if abs(in_units - number) <= Fraction(1, 2) else "inconsistent")


def judged(shown: str, by: Any) -> str:
    """The verdict on a pure number."""
    with kept():
        return Paper("sums", "Sums").figure("sum", shown, "1", where="", by=by).judged.verdict


@settings(max_examples=40)
@given(st.decimals(1, 9, places=2), st.decimals(1, 9, places=2), st.integers(1, 3))
def test_a_product_rounds_within_the_precision_of_its_factors_and_no_further(x: Any, y: Any, units: int) -> None:
    with kept():
        figure = product(x, y)
    half = Fraction(1, 200)
    highest = (Fraction(str(x)) + half) * (Fraction(str(y)) + half)
    inside, outside = (int(highest * 1000) - units, int(highest * 1000) + 1 + units)
    assert figure.if_printed(text(f"{inside / 1000:.3f}")).verdict in ("rounding", "confirmed")
    assert figure.if_printed(text(f"{outside / 1000:.3f}")).verdict == "inconsistent"


def product(x: Any, y: Any) -> Figure:
    """Of two printed numbers."""
    paper = Paper("products", "Products")
    paper.symbol("x", "1", known=printed(str(x)))
    paper.symbol("y", "1", known=printed(str(y)))
    return paper.figure("product", "1.000", "1", where="", by="x*y")
