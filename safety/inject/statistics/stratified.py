"""Totals over strata: sums of weight times share, with bounds that hold for all strata at once.

Value: the estimate of Horvitz and Thompson (JASA 47, 1952).  Bounds: Chernoff's inequality for the weighted sum of all
hits, over every set of shares that gives the same total.  For shares p, weights w, h hits of n draws and any u, v > 0,

    P(sum w h/n <= t) <= exp(u t + sum n log(1 - p d)),  d = 1 - exp(-u w/n),

so with probability 1 - a the total sum w p is below (u t - log a + sum max_p [n log(1 - p d) + v w p]) / v: Lagrange's
multiplier v frees the shares from their sum.  Every u, v gives a valid bound; the least is looked for.  The maximum is
over those p only that bounds of each stratum by itself allow, which hold together (Bonferroni) but for a tenth of a.
Against these alone the errors of the strata do not add up.  Chernoff's inequality also holds for draws without
replacement (Hoeffding, JASA 58, 1963, theorem 4).
Diagnostic coverage and safe failure fraction: IEC 61508-4:2010, 3.8.6 and 3.6.15.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from safety.inject.statistics.binomial import OUTWARD
from safety.inject.statistics.shares import Share, above, below, bounds, share
from safety.inject.statistics.tails import one_tail

FOR_EACH = 0.1  # the part of the error that goes to bounds of each stratum by itself


@dataclass(frozen=True)
class Trials:
    """`hits` among the `of` cases tried in a stratum that weighs `weight`; `exhaustive`: there are no other cases.

    `population`: how many cases there are, when they are drawn without replacement.
    """

    name: str
    weight: Fraction
    hits: int
    of: int
    exhaustive: bool = False
    population: int | None = None

    def bounds(self, confidence: float) -> tuple[float, float]:
        """Bounds on the share of the stratum by itself."""
        low, high = bounds(self.hits, self.of, self.population, confidence)
        return below(low), above(high)


@dataclass(frozen=True)
class Stratum:
    """Faults that share a weight: `weight` of all of them, how many were tried, and how they divided.

    `population`: how many there are, when those tried are drawn without replacement.
    """

    name: str
    weight: Fraction
    tried: int
    safe: int
    dangerous_detected: int
    dangerous_undetected: int
    exhaustive: bool
    population: int | None = None

    def trials(self, hits: int) -> Trials:
        """So many of those tried as trials."""
        return Trials(self.name, self.weight, hits, self.tried, self.exhaustive, self.population)


def total(strata: Sequence[Trials], confidence: float = 0.99) -> Share:
    """The sum of weight * share: exact when all strata are exhaustive, else with bounds valid for all at once.

    A probability of failure, when the weights are the probabilities of the strata; give a stratum that was not tried
    as one hit of one, exhaustive.  Raises `ValueError` for a stratum without weight or without trials: it would pass
    unseen.
    """
    _refuse_unseen([(s.name, s.weight, s.of) for s in strata])
    value = _sum(strata)
    if all(s.exhaustive for s in strata):
        return Share.known(value)
    return Share(float(value), *_bounds(strata, float(one_tail(confidence))))


def weighted(strata: Sequence[Stratum], *, safe_too: bool, confidence: float = 0.99) -> Share | None:
    """Diagnostic coverage, or with `safe_too` the safe failure fraction, each stratum weighing what it weighs.

    Value: good / (good + bad), good = sum of weight * share of the good, bad likewise of the dangerous undetected.
    Bounds: those of `total` for good and bad, which hold together; with one stratum those of `share`.
    None when nothing is dangerous (or, for the safe failure fraction, nothing has an effect).
    Raises `ValueError` for a stratum without weight or without trials: it would pass unseen.
    """
    _refuse_unseen([(s.name, s.weight, s.tried) for s in strata])
    good = [s.trials(s.dangerous_detected + (s.safe if safe_too else 0)) for s in strata]
    bad = [s.trials(s.dangerous_undetected) for s in strata]
    sums = [_sum(good), _sum(bad)]
    if not sum(sums):
        return None
    value = sums[0] / sum(sums)
    if all(s.exhaustive for s in strata):
        return Share.known(value)
    if len(strata) == 1:
        return share(good[0].hits, good[0].hits + bad[0].hits, exhaustive=False, confidence=confidence)
    tail = float(one_tail(confidence)) / 2
    (good_low, good_high), (bad_low, bad_high) = _bounds(good, tail), _bounds(bad, tail)
    low, high = _ratio(good_low, bad_high), _ratio(good_high, bad_low)
    return Share(float(value), low * (1 - OUTWARD), min(high * (1 + OUTWARD), 1.0))


def _refuse_unseen(strata: Sequence[tuple[str, Fraction, int]]) -> None:
    for name, weight, tried in strata:
        if weight <= 0 or tried <= 0:
            lack = f"weighs {weight}" if weight <= 0 else "has no trial"
            raise ValueError(f"stratum {name!r} {lack}: give it a rate above 0 and at least one trial, or leave it out")


def _sum(strata: Sequence[Trials]) -> Fraction:
    return sum((s.weight * Fraction(s.hits, s.of) for s in strata), Fraction(0))


def _ratio(good: float, bad: float) -> float:
    return good / (good + bad) if good + bad else 1.0


def _bounds(strata: Sequence[Trials], tail: float) -> tuple[float, float]:
    """Bounds on the sum of weight * share, each wrong with a probability of at most `tail`."""
    known = float(_sum([s for s in strata if s.exhaustive]))
    sampled = [s for s in strata if not s.exhaustive]
    if not sampled:
        return known, known
    whole = float(sum((s.weight for s in sampled), Fraction(0)))
    if len(sampled) == 1:
        low, high = sampled[0].bounds(1 - 2 * tail)
    else:
        alone = 1 - FOR_EACH * tail / len(sampled)
        cases = [_Case(float(s.weight) / whole, s.hits, s.of, *s.bounds(alone)) for s in sampled]
        low, high = sum(c.weight * c.low for c in cases), sum(c.weight * c.high for c in cases)
        low = max(low, -_least_bound(cases, (1 - FOR_EACH) * tail, -1))
        high = min(high, _least_bound(cases, (1 - FOR_EACH) * tail, 1))
    return (known + whole * low) * (1 - OUTWARD), (known + whole * high) * (1 + OUTWARD)


@dataclass(frozen=True)
class _Case:
    """A sampled stratum; the weights sum to 1; `low` and `high` bound its share by itself."""

    weight: float
    hits: int
    of: int
    low: float
    high: float


def _least_bound(cases: Sequence[_Case], tail: float, sign: int) -> float:
    """The least upper bound on the sum of weight * share, or with `sign` -1 on its negative (u and v are then < 0)."""
    scales = [c.of / c.weight for c in cases]
    start, end = math.log(min(scales)) - 15, math.log(max(scales)) + 5

    def best_over_u(v: float) -> float:
        return _least(lambda u: _bound(cases, tail, sign * math.exp(u), sign * math.exp(v)), start, end)

    return _least(best_over_u, start, end)


def _bound(cases: Sequence[_Case], tail: float, u: float, v: float) -> float:
    """The bound of the module's description for these u and v."""
    free = -math.log(tail)
    for case in cases:
        x = u * case.weight / case.of
        if x < -500:
            return math.inf
        free += x * case.hits + _most(case, min(-math.expm1(-x), 1 - 1e-15), v * case.weight)  # a lesser d only widens
    return free / abs(v)


def _most(case: _Case, d: float, slope: float) -> float:
    """The maximum over the shares p allowed of n log(1 - p d) + slope p, which is concave in p."""
    p = min(max((1 - case.of * d / slope) / d, case.low), case.high)
    return case.of * math.log1p(-p * d) + slope * p


def _least(function: Callable[[float], float], low: float, high: float) -> float:
    """The least value that golden-section search meets; the function falls, then rises."""
    golden = (math.sqrt(5) - 1) / 2
    left, right = high - golden * (high - low), low + golden * (high - low)
    at_left, at_right = function(left), function(right)
    best = min(at_left, at_right)
    for _ in range(32):
        if at_left < at_right or at_right == math.inf:
            high, right, at_right = right, left, at_left
            left = high - golden * (high - low)
            at_left = function(left)
        else:
            low, left, at_left = left, right, at_right
            right = low + golden * (high - low)
            at_right = function(right)
        best = min(best, at_left, at_right)
    return best
