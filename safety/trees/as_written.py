"""Numbers as they are written in a fault tree, and the error for what is no fault tree."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

Rational = Fraction | int | float | str | Decimal
LARGEST_EXPONENT = 400  # of ten, in a number as written; beyond any double, and small enough to compute with


class TreeError(ValueError):
    """What was given is no fault tree: `item` is the event or gate at fault, `place` the "file:line" if it was read."""

    exit_code = 2

    def __init__(self, message: str, item: str = "", place: str = "") -> None:
        super().__init__(f"{place}: {message}" if place else message)
        self.message, self.item, self.place = message, item, place

    def at(self, place: str) -> TreeError:
        """The same error with its place, unless it has one."""
        return self if self.place else TreeError(self.message, self.item, place)


def exact(value: Rational, what: str, item: str = "") -> Fraction:
    """The rational that `value` was written as; a float means the decimal it prints as.

    Raises TreeError when it is no finite number.
    """
    if isinstance(value, Fraction):
        return value
    text = str(value)
    try:
        if abs(int(text.lower().partition("e")[2] or 0)) <= LARGEST_EXPONENT and not isinstance(value, bool):
            return Fraction(text)
    except (ValueError, ZeroDivisionError):
        pass
    raise TreeError(f"{what} is {text[:40]!r}, expected a number such as 0.01, 1e-6 or 1/3; correct it", item)
