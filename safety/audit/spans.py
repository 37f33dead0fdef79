"""Numbers known between two fractions: exact arithmetic on intervals, and square roots as tight enclosures.

A Span of no width is a fraction; what is computed from such ones without a root is exact.
"""

from __future__ import annotations

from fractions import Fraction
from math import isqrt
from typing import Any

from safety.audit.exceptions import AuditError
from safety.audit.formula import Reading

Exact = int | Fraction
ROOT_DIGITS = 40  # of a square root


class Span:
    """All numbers from low to high; + - * / with others and with fractions enclose every result."""

    __slots__ = ("high", "low")

    def __init__(self, low: Exact, high: Exact | None = None) -> None:
        self.low, self.high = Fraction(low), Fraction(low if high is None else high)
        if self.low > self.high:
            raise AuditError(f"a span from {low} to {high}; give the lower end first")

    def __repr__(self) -> str:
        return f"Span({self.low})" if self.exact else f"Span({self.low}, {self.high})"

    @property
    def exact(self) -> bool:
        """Whether it is one number."""
        return self.low == self.high

    @property
    def middle(self) -> Fraction:
        """Halfway between the ends."""
        return (self.low + self.high) / 2

    def within(self, other: Span) -> bool:
        """Whether all of it lies in another."""
        return other.low <= self.low and self.high <= other.high

    def meets(self, other: Span) -> bool:
        """Whether the two share a number."""
        return self.low <= other.high and other.low <= self.high

    def distance(self, other: Span) -> Fraction:
        """Between the nearest two numbers; 0 where the spans meet."""
        return max(self.low - other.high, other.low - self.high, Fraction(0))

    def __add__(self, other: Span | Exact) -> Span:
        it = span(other)
        return Span(self.low + it.low, self.high + it.high)

    def __sub__(self, other: Span | Exact) -> Span:
        it = span(other)
        return Span(self.low - it.high, self.high - it.low)

    def __mul__(self, other: Span | Exact) -> Span:
        it = span(other)
        ends = [a * b for a in (self.low, self.high) for b in (it.low, it.high)]
        return Span(min(ends), max(ends))

    def __truediv__(self, other: Span | Exact) -> Span:
        it = span(other)
        if it.low <= 0 <= it.high:
            raise ZeroDivisionError(f"a divisor lies between {float(it.low):g} and {float(it.high):g}")
        return self * Span(1 / it.high, 1 / it.low)

    def __radd__(self, other: Exact) -> Span:
        return self + other

    def __rsub__(self, other: Exact) -> Span:
        return span(other) - self

    def __rmul__(self, other: Exact) -> Span:
        return self * other

    def __rtruediv__(self, other: Exact) -> Span:
        return span(other) / self

    def __neg__(self) -> Span:
        return Span(-self.high, -self.low)


def span(value: Any) -> Span:
    """Whatever a relation gives, as a span: an int, a Fraction, a Span, or anything with exact ends low and high.

    Raises AuditError for a double, which says nothing of its error, and for anything else.
    """
    if isinstance(value, Span):
        return value
    if isinstance(value, int | Fraction) and not isinstance(value, bool):
        return Span(value)
    low, high = getattr(value, "low", None), getattr(value, "high", None)
    if isinstance(low, int | Fraction) and isinstance(high, int | Fraction):
        return Span(low, high)
    raise AuditError(f"{value!r} is not exact; give a Fraction, or a Span between two of them")


def sqrt(value: Span | Exact) -> Span:
    """The square root, exact where it is a fraction.  Raises ArithmeticError below 0."""
    it = span(value)
    if it.low < 0:
        raise ArithmeticError(f"the square root of {float(it.low):g} is asked for")
    return Span(_root(it.low, up=False), _root(it.high, up=True))


def _root(x: Fraction, up: bool) -> Fraction:
    top, bottom = isqrt(x.numerator), isqrt(x.denominator)
    if top * top == x.numerator and bottom * bottom == x.denominator:
        return Fraction(top, bottom)
    scale = 10**ROOT_DIGITS
    return Fraction(isqrt(x.numerator * scale * scale // x.denominator) + up, scale)


NUMBERS = Reading(Span, sqrt)
