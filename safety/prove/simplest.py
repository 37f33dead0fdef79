"""The simplest fraction of an interval, and of a set of which only questions can be asked."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

HIGHEST = 200  # powers of two up to which a set is looked for
HALVINGS = 60


def simplest(low: Fraction, high: Fraction) -> Fraction:
    """The fraction of least denominator from low to high (continued fractions)."""
    if low <= 0 <= high:
        return Fraction(0)
    if high < 0:
        return -simplest(-high, -low)
    whole = low.numerator // low.denominator
    if whole == low or whole + 1 <= high:
        return Fraction(whole if whole == low else whole + 1)
    return whole + 1 / simplest(1 / (high - whole), 1 / (low - whole))


def simple_one(meets: Callable[[Fraction, Fraction], bool]) -> Fraction | None:
    """A simple fraction of a set, by questions whether the set meets an interval, ends included; none if none is found.

    It depends on the set alone: from 0 up if there are such, of the least power of two, then of the lower half.
    """
    zero, most = Fraction(0), Fraction(2) ** HIGHEST
    if meets(zero, zero):
        return zero
    sign = 1 if meets(zero, most) else -1

    def there(low: Fraction, high: Fraction) -> bool:
        return meets(low, high) if sign > 0 else meets(-high, -low)

    low, high = zero, next((Fraction(2) ** n for n in range(HIGHEST + 1) if there(zero, Fraction(2) ** n)), zero)
    for _ in range(HALVINGS if high else 0):
        middle, quarter = (low + high) / 2, (high - low) / 4
        for value in (high, middle, simplest(low + quarter, high - quarter)):
            if there(value, value):
                return sign * value
        low, high = (low, middle) if there(low, middle) else (middle, high)
    return None
