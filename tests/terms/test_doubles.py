"""Doubles that enclose reals, on every kind of processor, and mistakes in them, each of which shows as a bound."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from safety.terms import column_doubles
from safety.terms.column_doubles import DOUBLE, DOUBLES, apply, encloses, enclosure, pattern, value_of
from safety.terms.graph import Sort, integer, uint, variable
from safety.terms.native import compile_native
from tests.terms.agreement import targets

TARGETS = targets()
GREATEST = 1.7976931348623157e308
SPECIAL = (0.0, 1.0, -1.0, 3.0, math.nextafter(1, 2), 5e-324, -5e-324, 2.0**-1022, 1e-200, GREATEST, -GREATEST, 0.1)
WIDE = (uint(64), integer(-(2**63), 2**63 - 1), integer(-(2**60), 5), uint(8), integer(-300, 2**53))


def numbers(number: int) -> list[tuple[float, float]]:
    """Pairs of doubles: all special ones, and random ones near to each other or not."""
    pick = random.Random(7)

    def one() -> float:
        return pick.choice([
            lambda: float(pick.randint(-20, 20)), lambda: pick.uniform(-10, 10), lambda: pick.choice(SPECIAL),
            lambda: pick.uniform(-1, 1) * 2.0 ** pick.randint(-60, 60),
            lambda: pick.choice((-1, 1)) * pick.uniform(1, 2) * 2.0 ** pick.randint(-1060, 1022),
        ])()  # fmt: skip

    pairs = [(x, y) for x in SPECIAL for y in SPECIAL]
    return pairs + [(one(), one()) for _ in range(number)]


def words(values: list[float]) -> Any:
    return np.array([pattern(v) for v in values], object)


def wrong_bounds(processor: str, number: int = 600) -> Iterator[str]:
    """Operations whose bounds do not enclose the exact result, or are not next to it where that is an ordinary one."""
    names = ("add", "sub", "mul")
    x, y = variable("x", DOUBLE), variable("y", DOUBLE)
    given = {name: (x, x, y, y) if name == "mul" else (x, y) for name in names}
    outputs = [apply(f"{name}_{side}", *given[name]) for name in names for side in ("down", "up")]
    pairs = numbers(number)
    seen = compile_native([x, y], outputs, TARGETS[processor])(*(words(list(v)) for v in zip(*pairs, strict=True)))
    for row, (a, b) in enumerate(pairs):
        exact = (Fraction(a) + Fraction(b), Fraction(a) - Fraction(b), Fraction(a) * Fraction(b))
        for name, value, bounds in zip(names, exact, zip(seen[::2], seen[1::2], strict=True), strict=True):
            low, high = (int(side[row]) for side in bounds)
            ordinary = value == 0 or 2.0**-800 < abs(value) < 2.0**900
            if not_enclosed(low, high, value) or (ordinary and not near(low, high, value)):
                yield f"{name}: {a!r}, {b!r}"


def not_enclosed(low: int, high: int, value: Fraction) -> bool:
    """Whether a bound that is a number lies on the wrong side."""
    least, greatest = value_of(low), value_of(high)
    return (least == least and not least <= value) or (greatest == greatest and not greatest >= value)


def near(low: int, high: int, value: Fraction) -> bool:
    """Whether bounds are a double that is the value, or lie at most one double further out than those next to it."""
    least, greatest = (value_of(word) for word in enclosure(value))
    if least == greatest:
        return value_of(low) == least == value_of(high)
    return math.nextafter(least, -math.inf) <= value_of(low) and value_of(high) <= math.nextafter(greatest, math.inf)


def wrong_products(processor: str) -> Iterator[str]:
    """Factors between bounds whose products are not all enclosed."""
    bounds = [variable(name, DOUBLE) for name in "abcd"]
    pick = random.Random(3)
    rows = [[*sorted(pick.uniform(-3, 2) for _ in "ab"), *sorted(pick.uniform(-2, 3) for _ in "cd")] for _ in range(99)]
    outputs = [apply("mul_down", *bounds), apply("mul_up", *bounds)]
    columns = [words(list(v)) for v in zip(*rows, strict=True)]
    low, high = compile_native(bounds, outputs, TARGETS[processor])(*columns)
    for row, (a, b, c, d) in enumerate(rows):
        corners = [Fraction(x) * Fraction(y) for x in (a, b) for y in (c, d)]
        if not all(encloses(int(low[row]), int(high[row]), value) for value in corners):
            yield f"{a}..{b} * {c}..{d}"


def wrong_casts(processor: str) -> Iterator[str]:
    """Whole numbers that are not enclosed as closely as they can be."""
    for sort in WIDE:
        x = variable("x", sort)
        values = values_of(sort)
        outputs = [apply("cast_down", x), apply("cast_up", x)]
        low, high = compile_native([x], outputs, TARGETS[processor])(np.array(values, object))
        for value, least, greatest in zip(values, low, high, strict=True):
            if (int(least), int(greatest)) != enclosure(value):
                yield f"{value} of {sort}"


def values_of(sort: Sort) -> list[int]:
    pick, (low, high) = random.Random(5), sort.bounds
    near_53 = [v for b in (2**53, -(2**53), 2**62) for v in range(b - 3, b + 4) if low <= v <= high]
    return [low, high, *near_53, *(pick.randint(low, high) for _ in range(40))]


def wrong(processor: str) -> list[str]:
    return [*wrong_bounds(processor), *wrong_products(processor), *wrong_casts(processor)]


@pytest.mark.parametrize("processor", TARGETS)
def test_bounds_enclose_the_exact_result_closely(processor: str) -> None:
    assert wrong(processor) == []


@pytest.mark.parametrize("processor", TARGETS)
def test_comparisons_are_those_of_the_doubles(processor: str) -> None:
    x, y = variable("x", DOUBLE), variable("y", DOUBLE)
    pairs = [*numbers(100), (math.nan, 1.0), (1.0, math.nan), (math.inf, 1.0), (-math.inf, math.inf)]
    found = compile_native([x, y], [apply("below", x, y), apply("up_to", x, y)], TARGETS[processor])
    below, up_to = found(*(words(list(v)) for v in zip(*pairs, strict=True)))
    assert below.tolist() == [a < b for a, b in pairs] and up_to.tolist() == [a <= b for a, b in pairs]


def test_what_is_no_number_stays_none() -> None:
    """In a product with bounds that are numbers too, on either side."""
    bounds = [variable(name, DOUBLE) for name in "abcd"]
    outputs = [apply("mul_down", *bounds), apply("mul_up", *bounds), apply("add_down", *bounds[:2])]
    for row in (
        [math.nan, 1.0, 2.0, 3.0],
        [1.0, math.nan, 2.0, 3.0],
        [1.0, 2.0, math.nan, 3.0],
        [0.0, math.inf, 0.0, 1.0],
    ):
        for processor in TARGETS:
            low, high, _ = compile_native(bounds, outputs, TARGETS[processor])(*(words([v]) for v in row))
            assert math.isnan(value_of(int(low[0]))) and math.isnan(value_of(int(high[0])))


@pytest.mark.parametrize("value", [0, 1, Fraction(1, 3), Fraction(-1, 10), 10**400, -(10**400), Fraction(1, 10**400)])
def test_the_enclosure_of_a_constant(value: Fraction | int) -> None:
    low, high = enclosure(value)
    assert encloses(low, high, value)
    assert low == high or math.nextafter(value_of(low), math.inf) == value_of(high)
    assert (low == high) == (value in (0, 1))


# --- mistakes --------------------------------------------------------------------------------------------------------

Plant = Callable[[pytest.MonkeyPatch], None]


def setting(name: str, value: Any) -> Plant:
    return lambda monkeypatch: monkeypatch.setattr(column_doubles, name, value)


def entries(**changed: Any) -> Plant:
    def plant(monkeypatch: pytest.MonkeyPatch) -> None:
        for row, entry in changed.items():
            monkeypatch.setitem(DOUBLES, row, entry)

    return plant


RIGHT, PRODUCT = column_doubles.outward, column_doubles.double_product
EXACT = "splat (double 0.0)"


def moved(change: Callable[..., str]) -> Plant:
    """Another step outward: `change(k, down, x, error, known)`."""
    return setting("outward", change)


MISTAKES: dict[str, Plant] = {
    "nothing is moved outward": moved(lambda k, down, x, *_: x),
    "moved inward": moved(lambda k, down, *rest: RIGHT(k, not down, *rest)),
    "every result is taken for exact": moved(lambda k, down, x, error, known: RIGHT(k, down, x, EXACT, known)),
    "a step too short": setting("SHARE", 2.0**-55),
    "a step too far": setting("SHARE", 2.0**-50),
    "no step at 0": setting("LEAST", 0.0),
    "the error of small products is believed": setting("SMALL", 0.0),
    "the least product is of the least factors": entries(
        mul_down=lambda k, t, a, b, c, d: PRODUCT(True)(k, t, a, a, c, c)
    ),
    "the greatest product is of the greatest factors": entries(
        mul_up=lambda k, t, a, b, c, d: PRODUCT(False)(k, t, b, b, d, d)
    ),
    "the greatest product stands for the least": entries(mul_down=PRODUCT(False)),
    "a difference is a sum": entries(sub_down=DOUBLES["add_down"]),
    "every whole number is a double": setting("fits", lambda sort: True),
    "a wide number is rounded down twice": entries(cast_up=DOUBLES["cast_down"]),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_shows_as_a_bound(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    MISTAKES[name](monkeypatch)
    assert wrong("plain")
