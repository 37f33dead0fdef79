"""Failure rates, mean times and fractions, read exactly from the text that an engineer writes.

A value is the Fraction of its decimal text, never a double: "2.6e-5 /h" is 26/1000000 per hour.
Base units are 1/h, h and 1. A year is 8760 h; FIT is failures in 10^9 h.
Source tags: P printed, D derived, A assumed, R reconstructed.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from typing import Final, Literal, NamedTuple, TypeAlias, get_args

from safety.rates.enclosure import Extended, reciprocal
from safety.rates.exceptions import NotExact, UnitError

Tag: TypeAlias = Literal["P", "D", "A", "R"]
Unit: TypeAlias = Literal["1/h", "h", "1"]
Rational: TypeAlias = Fraction | int | str

_YEAR = Fraction(8760)
UNITS: Final[dict[str, tuple[Unit, Fraction]]] = {
    **dict.fromkeys(("/h", "1/h", "h^-1", "per h", "per hour"), ("1/h", Fraction(1))),
    **dict.fromkeys(("/a", "/y", "/year", "per year"), ("1/h", 1 / _YEAR)),
    **dict.fromkeys(("FIT", "fit"), ("1/h", Fraction(1, 10**9))),
    **dict.fromkeys(("h", "hour", "hours"), ("h", Fraction(1))),
    **dict.fromkeys(("a", "y", "year", "years"), ("h", _YEAR)),
    **dict.fromkeys(("d", "day", "days"), ("h", Fraction(24))),
    "min": ("h", Fraction(1, 60)),
    "s": ("h", Fraction(1, 3600)),
    "": ("1", Fraction(1)),
    "%": ("1", Fraction(1, 100)),
}
_PLAIN = str.maketrans(
    "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺\N{MINUS SIGN}\N{NO-BREAK SPACE}\N{THIN SPACE}\N{NARROW NO-BREAK SPACE}", "0123456789-+-   "
)
_NUMBER = re.compile(
    r"""
    (?P<sign>[+-]?)
    (?P<whole>\d{1,3}(?:[ _]\d{3})+|\d+)
    (?: / (?P<denominator>\d+)
      | (?:\.(?P<decimals>\d+))? (?: [eE](?P<exponent>[+-]?\d+) | \s*[·×x*]\s*10\^?(?P<power>[+-]?\d+) )? )
    (?![\d.,eE])""",
    re.VERBOSE,
)


@dataclass(frozen=True, slots=True)
class Quantity:
    """A rate, a time or a fraction with its origin.

    value: exact, in `unit`, which is "1/h", "h" or "1".  source: P, D, A or R.
    about: what it is, for people.  text: as it was written.
    """

    value: Fraction
    unit: Unit
    source: Tag
    about: str
    text: str

    @property
    def per_hour(self) -> Fraction:
        """The rate; a mean time T stands for 1/T. Raises UnitError for a fraction or a time of 0 h."""
        if self.unit == "1/h":
            return self.value
        if self.unit == "h" and self.value:
            return 1 / self.value
        raise UnitError(f"{self.text!r} is no failure rate; write '2.6e-5 /h', or a mean time above 0 h")

    @property
    def hours(self) -> Extended:
        """The time; a rate r stands for 1/r, infinite for rate 0. Raises UnitError for a fraction."""
        if self.unit == "1":
            raise UnitError(f"{self.text!r} has no unit; write a time such as '24 h' or a rate such as '2.6e-5 /h'")
        return self.value if self.unit == "h" else reciprocal(self.value)

    @property
    def fit(self) -> Fraction:
        """The rate in failures per 10^9 h. Raises as per_hour does."""
        return self.per_hour * 10**9

    @property
    def fraction(self) -> Fraction:
        """A number from 0 to 1. Raises UnitError when there is a unit or the value lies outside."""
        if self.unit != "1" or self.value > 1:
            raise UnitError(f"{self.text!r} is no fraction; write a number from 0 to 1, or '90 %'")
        return self.value

    def __str__(self) -> str:
        return f"{self.text} [{self.source}]"


def quantity(text: str, source: Tag = "A", about: str = "") -> Quantity:
    """Reads "2.6e-5 /h", "2.77778·10⁻⁵ /h", "350 FIT", "36 000 h", "1/24 /h", "90 %".

    Raises UnitError, with the text and the remedy, for no number, an unknown unit or source, a decimal comma,
    a negative value, or a fraction of hours ("1/24 h" may be meant as a time or a rate); NotExact for a number.

    >>> quantity("36 000 h").per_hour
    Fraction(1, 36000)
    """
    if source not in get_args(Tag):
        raise UnitError(f"unknown source {source!r} of {text!r}; use P printed, D derived, A assumed, R reconstructed")
    written = read(text)
    return Quantity(written.number * written.scale, written.unit, source, about, text)


class Written(NamedTuple):
    """A text taken apart: number * scale is the value in `unit`; `digits` are significant, None where zeros hide it."""

    number: Fraction
    scale: Fraction
    unit: Unit
    digits: int | None


def read(text: str) -> Written:
    """Takes a number with a unit apart; `quantity` says which texts are read and what is raised."""
    if not isinstance(text, str):
        raise NotExact(f"{text!r} is no text; write the number with its unit in quotes, such as '2.6e-5 /h'")
    plain = text.translate(_PLAIN).strip()
    match = _NUMBER.match(plain)
    if match is None:
        raise UnitError(f"{text!r} does not start with a number; write '2.6e-5 /h', '36 000 h' or '1/24 /h'")
    name = plain[match.end() :].strip()
    if name not in UNITS:
        raise UnitError(f"unit {name!r} in {text!r} is unknown; use one of {', '.join(u for u in UNITS if u)}, or none")
    unit, scale = UNITS[name]
    if match["sign"] == "-":
        raise UnitError(f"{text!r} is negative; rates, times and fractions are 0 or more")
    whole = re.sub("[ _]", "", match["whole"])
    if match["denominator"]:
        if unit == "h":
            raise UnitError(f"{text!r} may be a rate or a time; write '{whole}/{match['denominator']} /h' or decimals")
        if int(match["denominator"]) == 0:
            raise UnitError(f"{text!r} divides by zero")
        return Written(Fraction(int(whole), int(match["denominator"])), scale, unit, None)
    number = Fraction(f"{whole}.{match['decimals'] or '0'}e{match['exponent'] or match['power'] or '0'}")
    mantissa = (whole + (match["decimals"] or "")).lstrip("0")
    hidden = match["decimals"] is None and mantissa.endswith("0")
    return Written(number, scale, unit, None if hidden or not mantissa else len(mantissa))


def exact(value: Rational, name: str) -> Fraction:
    """A non-negative Fraction from a Fraction, an int or a decimal text; `name` is what a message calls it.

    Raises NotExact for a float (0.1 is not 1/10 in binary), a bool, a negative number or an unreadable text.
    """
    if isinstance(value, bool) or not isinstance(value, (Fraction, int, str)):
        raise NotExact(f"{name} = {value!r} is a {type(value).__name__}; write '{value}' in quotes or a Fraction")
    try:
        result = Fraction(value)
    except (ValueError, ZeroDivisionError):
        raise NotExact(f"{name} = {value!r} is no number; write '2.6e-5' or quantity(...).per_hour") from None
    if result < 0:
        raise NotExact(f"{name} = {value!r} is negative; a rate, time or fraction is 0 or more")
    return result
