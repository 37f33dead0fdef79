"""Fractions with what is known about them: exact where everything was tried, an interval where a sample was.

Interval: Clopper and Pearson (Biometrika 26, 1934), whose coverage is never below the stated confidence.  Drawing
without replacement, as campaigns do, only narrows the true distribution, so the interval stays valid.
Diagnostic coverage and safe failure fraction: IEC 61508-4:2010, 3.8.6 and 3.6.15.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

OUTWARD = 1e-8  # relative; the beta function of counts up to 10^7 is good to better than this


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


def share(hits: int, of: int, *, exhaustive: bool, confidence: float = 0.99) -> Share | None:
    """`hits` out of `of`: exact when every case was tried, Clopper-Pearson otherwise; None when there was no case."""
    if of == 0:
        return None
    if exhaustive:
        return Share.known(Fraction(hits, of))
    return Share(hits / of, *clopper_pearson(hits, of, confidence))


def clopper_pearson(hits: int, of: int, confidence: float = 0.99) -> tuple[float, float]:
    """Two-sided bounds on a probability after `hits` in `of` independent trials, rounded outward.

    For a one-sided bound at confidence c ask for 2c - 1 and take one end.
    Raises `ValueError` unless 0 <= hits <= of, of >= 1 and 0 < confidence < 1.
    """
    if not (0 <= hits <= of and of >= 1):
        raise ValueError(f"{hits} hits of {of} trials: there is at least 1 trial, and no more hits than trials")
    if not 0 < confidence < 1:
        raise ValueError(f"confidence {confidence}: it lies between 0 and 1, e.g. 0.99")
    tail = (1 - confidence) / 2
    low = 0.0 if hits == 0 else beta_quantile(tail, hits, of - hits + 1) * (1 - OUTWARD)
    high = 1.0 if hits == of else min(beta_quantile(1 - tail, hits + 1, of - hits) * (1 + OUTWARD), 1.0)
    return low, high


def beta_quantile(probability: float, a: float, b: float) -> float:
    """The x at which the regularised incomplete beta function I_x(a, b) reaches `probability`."""
    if b == 1:
        return math.exp(math.log(probability) / a)
    if a == 1:
        return -math.expm1(math.log1p(-probability) / b)
    low, high = 0.0, 1.0
    while (middle := (low + high) / 2) not in (low, high):
        if beta(middle, a, b) < probability:
            low = middle
        else:
            high = middle
    return low


def beta(x: float, a: float, b: float) -> float:
    """The regularised incomplete beta function I_x(a, b), by its continued fraction (Abramowitz and Stegun 26.5.8)."""
    if x <= 0 or x >= 1:
        return float(x >= 1)
    if x > (a + 1) / (a + b + 2):
        return 1 - beta(1 - x, b, a)
    front = a * math.log(x) + b * math.log1p(-x) + math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b)
    return math.exp(front) / a / _continued_fraction(x, a, b)


def _continued_fraction(x: float, a: float, b: float) -> float:
    """1 + d1/(1 + d2/(1 + ...)), by the modified Lentz method."""
    tiny = 1e-300
    value, c, d = 1.0, 1.0, 0.0
    for step in range(1, 100_000):
        m = step // 2
        if step % 2:
            term = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        else:
            term = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        d = 1 / ((1 + term * d) or tiny)
        c = (1 + term / c) or tiny
        value *= c * d
        if abs(c * d - 1) < 1e-15:
            return value
    raise ArithmeticError(f"the incomplete beta function at x = {x}, a = {a}, b = {b} does not settle")


def runs_without_failure(probability: float | Fraction, confidence: float | Fraction) -> int:
    """The least n such that n runs without one failure show "probability per run at most `probability`".

    That is the least n with (1 - probability)**n <= 1 - confidence: 4 605 168 for 1e-6 at 99 %.
    """
    if not (0 < probability < 1 and 0 < confidence < 1):
        raise ValueError(f"probability {probability}, confidence {confidence}: both lie between 0 and 1")
    return math.ceil(math.log(1 - confidence) / math.log1p(-float(probability)))


@dataclass(frozen=True)
class Stratum:
    """Faults that share a weight: `weight` of all of them, how many were tried, and how they divided."""

    name: str
    weight: Fraction
    tried: int
    safe: int
    dangerous_detected: int
    dangerous_undetected: int
    exhaustive: bool


def weighted(strata: Sequence[Stratum], *, safe_too: bool, confidence: float = 0.99) -> Share | None:
    """Diagnostic coverage, or with `safe_too` the safe failure fraction, each stratum weighing what it weighs.

    Value: good / (good + bad), good = sum of weight * share of the good, bad likewise of the dangerous undetected.
    Bounds: from Clopper-Pearson intervals that hold all at once (Bonferroni over two in each sampled stratum).
    None when nothing is dangerous (or, for the safe failure fraction, nothing has an effect).
    Raises `ValueError` for a stratum without weight or without trials: it would pass unseen.
    """
    for s in strata:
        if s.weight <= 0 or s.tried <= 0:
            lack = f"weighs {s.weight}" if s.weight <= 0 else "has no trial"
            raise ValueError(
                f"stratum {s.name!r} {lack}: give it a rate above 0 and at least one trial, or leave it out"
            )
    good = [s.dangerous_detected + (s.safe if safe_too else 0) for s in strata]
    bad = [s.dangerous_undetected for s in strata]
    totals = [
        sum((s.weight * Fraction(n, s.tried) for s, n in zip(strata, counts, strict=True)), Fraction(0))
        for counts in (good, bad)
    ]
    value = totals[0] / sum(totals) if sum(totals) else None
    sampled = sum(not s.exhaustive for s in strata)
    if not sampled:
        return None if value is None else Share.known(value)
    level = 1 - (1 - confidence) / (2 * sampled)
    goods, bads = ([_bounds(s, n, level) for s, n in zip(strata, counts, strict=True)] for counts in (good, bad))
    low, high = (_ratio(sum(g[i] for g in goods), sum(b[1 - i] for b in bads)) for i in (0, 1))
    return None if value is None else Share(float(value), low * (1 - OUTWARD), min(high * (1 + OUTWARD), 1.0))


def _bounds(stratum: Stratum, hits: int, level: float) -> tuple[float, float]:
    if stratum.exhaustive:
        value = float(stratum.weight * Fraction(hits, stratum.tried))
        return value, value
    low, high = clopper_pearson(hits, stratum.tried, level)
    return float(stratum.weight) * low, float(stratum.weight) * high


def _ratio(good: float, bad: float) -> float:
    return good / (good + bad) if good + bad else 1.0
