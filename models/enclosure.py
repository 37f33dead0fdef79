"""Enclosures with exact ends, and the square root as one.

Source: interval arithmetic.
"""

from __future__ import annotations

from fractions import Fraction
from math import isqrt
from typing import NamedTuple

Exact = Fraction | int
DIGITS = 30  # after the point, of a root


class Interval(NamedTuple):
    """An enclosure with exact ends."""

    low: Fraction
    high: Fraction

    def scaled(self, factor: Exact, shift: Exact = 0) -> Interval:
        """Multiplied by a factor above 0, then shifted."""
        return Interval(self.low * factor + shift, self.high * factor + shift)

    def shifted(self, by: Exact) -> Interval:
        """Both ends moved."""
        return Interval(self.low + by, self.high + by)

    @property
    def middle(self) -> Fraction:
        """Halfway between the ends."""
        return (self.low + self.high) / 2


def root(x: Exact, digits: int = DIGITS) -> Interval:
    """Square root of a number from 0 up; the ends coincide where it is that short, else lie 10^-digits apart.

    Raises ValueError below 0.
    """
    scale = 10**digits
    scaled = Fraction(x) * scale * scale
    if scaled < 0:
        raise ValueError(f"{x} has no square root; it is below 0")
    low = isqrt(int(scaled))
    return Interval(Fraction(low, scale), Fraction(low + (low * low != scaled), scale))
