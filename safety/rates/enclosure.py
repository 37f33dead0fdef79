"""Certified intervals: every figure that is not exactly rational is known between two rationals."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Final, NamedTuple, TypeAlias

Extended: TypeAlias = Fraction | float  # a float here is always the infinity below, nothing else
INFINITE: Final = math.inf


def reciprocal(x: Extended) -> Extended:
    """1/x of a non-negative number, with 1/0 = infinite and 1/infinite = 0: a rate from a mean time and back."""
    if x == 0:
        return INFINITE
    return Fraction(0) if x == INFINITE else 1 / x


class Enclosure(NamedTuple):
    """The true value lies in [low, high]; where the ends are equal it is known exactly."""

    low: Extended
    high: Extended

    @classmethod
    def exactly(cls, value: Extended) -> Enclosure:
        """The enclosure of a value that is known."""
        return cls(value, value)

    @property
    def exact(self) -> bool:
        """Is the value known exactly?"""
        return self.low == self.high

    @property
    def middle(self) -> Extended:
        """The value itself when exact, otherwise halfway between the ends."""
        return self.low if self.exact else (self.low + self.high) / 2

    @property
    def relative_width(self) -> float:
        """Width over the upper end: 0 when exact, 1 when the lower end is 0, infinite when only the upper end is."""
        if self.exact:
            return 0.0
        return INFINITE if self.high == INFINITE else float((self.high - self.low) / self.high)

    def overlaps(self, other: Enclosure) -> bool:
        """Can both enclose the same value?"""
        return self.low <= other.high and other.low <= self.high

    def reciprocal(self) -> Enclosure:
        """[1/high, 1/low] of a non-negative enclosure."""
        return Enclosure(reciprocal(self.high), reciprocal(self.low))


class Estimate(NamedTuple):
    """A figure under uncertain inputs: at the inputs' best values, and the smallest and largest value in their range.

    This is a range of inputs, not of arithmetic: each of the three is itself a certified enclosure.
    """

    value: Enclosure
    low: Enclosure
    high: Enclosure

    @classmethod
    def certain(cls, value: Enclosure) -> Estimate:
        """The estimate under inputs without a range."""
        return cls(value, value, value)

    def reciprocal(self) -> Estimate:
        """The rate from a mean time and back: 1/value, and the ends exchanged."""
        return Estimate(self.value.reciprocal(), self.high.reciprocal(), self.low.reciprocal())
