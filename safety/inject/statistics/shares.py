"""Fractions with what is known about them: exact where everything was tried, an interval where a sample was."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from safety.inject.statistics.binomial import any_population
from safety.inject.statistics.hypergeometric import MOST, hypergeometric_limits


@dataclass(frozen=True)
class Share:
    """A fraction of 0 to 1 with its bounds; `exact` where nothing was sampled (then low = value = high)."""

    value: float
    low: float
    high: float
    exact: Fraction | None = None

    @classmethod
    def known(cls, value: Fraction) -> Share:
        """A fraction that is known exactly."""
        return cls(float(value), float(value), float(value), value)

    def to_json(self) -> dict[str, Any]:
        """Keys value, low, high, and exact as "p/q"."""
        plain: dict[str, Any] = {"value": self.value, "low": self.low, "high": self.high}
        return plain if self.exact is None else plain | {"exact": str(self.exact)}


def share(
    hits: int, of: int, *, exhaustive: bool, confidence: float = 0.99, population: int | None = None
) -> Share | None:
    """`hits` out of `of`: exact when every case was tried, with bounds otherwise; None when there was no case.

    Bounds: see `bounds`.
    """
    if of == 0:
        return None
    if exhaustive:
        return Share.known(Fraction(hits, of))
    low, high = bounds(hits, of, population, confidence)
    return Share(hits / of, below(low), above(high))


def bounds(hits: int, of: int, population: int | None, confidence: float = 0.99) -> tuple[Fraction, Fraction]:
    """Bounds on a share after `hits` of `of` cases: hypergeometric for draws without replacement from a `population`.

    Where its size is not known, or beyond 10^9, those that hold for any population, and for independent trials.
    """
    if population is None or population > MOST:
        low, high = any_population(hits, of, confidence)
        return Fraction(low), Fraction(high)
    least, greatest = hypergeometric_limits(hits, of, population, confidence)
    return Fraction(least, population), Fraction(greatest, population)


def below(value: Fraction) -> float:
    """The greatest number in floating point that is not above `value`."""
    near = float(value)
    return near if near <= value else math.nextafter(near, -math.inf)


def above(value: Fraction) -> float:
    """The least number in floating point that is not below `value`."""
    return -below(-value)
