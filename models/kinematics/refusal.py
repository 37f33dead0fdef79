"""How a value that a formula cannot honour is refused: reason, value, nearest admissible value.

A nearest value is rounded to the admissible side, `at_least` up and `at_most` down: it can be taken as it is told.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from typing import Any, NoReturn

from safety import ModelError, Real
from safety.terms import Term


def refuse(what: str, value: Any, unit: str, why: str, nearest: str) -> NoReturn:
    """Raise ModelError: the value, why it cannot be, the nearest one that can."""
    raise ModelError(f"{what} = {shown(value)} {unit}: {why}; the nearest admissible value is {nearest}")


def shown(value: Any) -> str:
    """A number as people read it."""
    return f"{float(value):.6g}"


def at_least(value: Any) -> str:
    """A least value with 6 digits, rounded up."""
    return _rounded(value, ROUND_CEILING)


def at_most(value: Any) -> str:
    """A greatest value with 6 digits, rounded down."""
    return _rounded(value, ROUND_FLOOR)


def _rounded(value: Any, way: str) -> str:
    exact = Fraction(value)
    return f"{Context(prec=6, rounding=way).divide(Decimal(exact.numerator), Decimal(exact.denominator)).normalize():f}"


def nearest(
    name: str, value: Real, unit: str, rounded: Callable[[Any], str] = at_least, side: str = ""
) -> Callable[[], str]:
    """What `require` is to say of parameters that do not go together: the nearest admissible value of one.

    `side` is "any above" or "any below" where the value itself is not admissible.
    """
    return lambda: f"the nearest admissible {name} is {side}{' ' if side else ''}{rounded(value.attr)} {unit}"


def exact(what: str, value: Any, unit: str) -> None:
    """Refuse what is no exact number: of a double no enclosure holds what it says."""
    if isinstance(value, bool) or not isinstance(value, int | Fraction):
        raise ModelError(f"{what} = {value!r} {unit} is not exact; give an int or a Fraction")


def positive(what: str, value: Any, unit: str) -> None:
    """Refuse what is not above 0 (nor a number at all)."""
    if not isinstance(value, Term) and not value > 0:
        refuse(what, value, unit, "it has to be above 0", "any above 0")


def not_negative(what: str, value: Any, unit: str) -> None:
    """Refuse what is below 0 (or no number at all)."""
    if not isinstance(value, Term) and not value >= 0:
        refuse(what, value, unit, "it has to be 0 or more", "0")
