"""Quantities are read exactly, and what cannot be read says what to write instead."""

from fractions import Fraction

import pytest

from safety.rates.exceptions import NotExact, UnitError
from safety.rates.units import exact, quantity, read


@pytest.mark.parametrize(
    ("text", "per_hour"),
    [
        ("2.6e-5 /h", Fraction(26, 10**6)),
        ("2.77778·10⁻⁵ /h", Fraction(277778, 10**10)),
        ("2.77778 x 10^-5 /h", Fraction(277778, 10**10)),
        ("1/24 /h", Fraction(1, 24)),
        ("350 FIT", Fraction(350, 10**9)),
        ("0.1 per year", Fraction(1, 87600)),
        ("36 000 h", Fraction(1, 36000)),
        ("36\N{NARROW NO-BREAK SPACE}000 h", Fraction(1, 36000)),
        ("36_000 h", Fraction(1, 36000)),
        ("3 d", Fraction(1, 72)),
        ("90 min", Fraction(2, 3)),
        ("0 /h", Fraction(0)),
    ],
)
def test_a_rate_is_the_fraction_of_its_text(text: str, per_hour: Fraction) -> None:
    assert quantity(text).per_hour == per_hour


def test_one_rate_in_every_unit() -> None:
    rate = quantity("2.5e-5 /h", "P", "a channel")
    assert (rate.hours, rate.fit, rate.source, rate.about, str(rate)) == (
        40_000,
        25_000,
        "P",
        "a channel",
        "2.5e-5 /h [P]",
    )
    assert quantity("0 /h").hours == float("inf")
    assert quantity("90 %").fraction == Fraction(9, 10) == quantity("0.9").fraction


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("", "number"),
        ("about 3 h", "number"),
        ("2,6e-5 /h", "number"),
        ("3e /h", "number"),
        ("36 00 h", "unit '00 h'"),
        ("1.2.3 h", "number"),
        ("5 km/h", "unit 'km/h'"),
        ("-1 /h", "negative"),
        ("\N{MINUS SIGN}1 /h", "negative"),
        ("1/24 h", "'1/24 /h'"),
        ("1/0 /h", "zero"),
    ],
)
def test_an_unreadable_text_names_the_trouble(text: str, word: str) -> None:
    with pytest.raises(UnitError, match=word):
        quantity(text)


def test_the_wrong_kind_of_quantity_is_refused() -> None:
    for text, kind in [
        ("0.9", "per_hour"),
        ("0 h", "per_hour"),
        ("0.9", "hours"),
        ("3 h", "fraction"),
        ("120 %", "fraction"),
    ]:
        with pytest.raises(UnitError):
            getattr(quantity(text), kind)
    with pytest.raises(UnitError, match="source 'X'"):
        quantity("1 h", "X")  # type: ignore[arg-type]
    with pytest.raises(NotExact, match="quotes"):
        quantity(1e-5)  # type: ignore[arg-type]


def test_a_double_is_refused_where_exact_numbers_are_needed() -> None:
    assert exact("2.6e-5", "channel") == Fraction(26, 10**6)
    for value in (0.1, True, "-1", "1 h", "1/0"):
        with pytest.raises(NotExact, match="channel"):
            exact(value, "channel")  # type: ignore[arg-type]


def test_significant_digits_are_those_that_the_text_shows() -> None:
    shown = {
        "2.77778e-5 /h": 6,
        "0.0050 /h": 2,
        "36 085 h": 5,
        "36 000 h": None,
        "36000.0 h": 6,
        "1/24 /h": None,
        "0 h": None,
    }
    assert {text: read(text).digits for text in shown} == shown
