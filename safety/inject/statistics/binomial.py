"""Bounds on a probability from independent trials, and from draws of a population of unknown size.

Clopper and Pearson (Biometrika 26, 1934): the coverage is never below the stated confidence.  Against a belief often
heard, drawing without replacement does not always keep that: with one hit the tail of the hypergeometric distribution
is the fatter one.  `any_population` mends it, at next to no cost.
"""

from __future__ import annotations

import math
from fractions import Fraction

from safety.inject.statistics import tails
from safety.inject.statistics.tails import check_counts, one_tail

OUTWARD = 1e-8  # relative; the beta function of counts up to 10^9 is good to better than this


def clopper_pearson(hits: int, of: int, confidence: float = 0.99) -> tuple[float, float]:
    """Two-sided bounds on a probability after `hits` in `of` independent trials, rounded outward.

    For a one-sided bound at confidence c ask for 2c - 1 and take one end.
    Raises `ValueError` unless 0 <= hits <= of, of >= 1 and 0 < confidence < 1.
    """
    check_counts(hits, of)
    tail = float(one_tail(confidence))
    return _lower(hits, of, tail), _upper(hits, of, tail)


def any_population(hits: int, of: int, confidence: float = 0.99) -> tuple[float, float]:
    """Bounds on a share that hold for independent trials and for draws without replacement from any population.

    By Uhlmann (Metrika 10, 1966) drawing without replacement makes "k or more hits" less likely wherever the share is
    at most (k-1)/(n-1) N/(N+1), N >= n; there Clopper and Pearson's lower bound holds.  Elsewhere, with k = 1, Markov's
    inequality gives tail/n.  Upper bounds are lower bounds of the misses.  Raises as `clopper_pearson`.
    """
    check_counts(hits, of)
    tail = float(one_tail(confidence))
    low, high, misses = _lower(hits, of, tail), _upper(hits, of, tail), of - hits
    if hits and not _narrows(low, hits, of):
        low = min(low, tail * hits / of * (1 - OUTWARD))
    if misses and not _narrows(1 - high, misses, of):
        high = max(high, 1 - tail * misses / of * (1 - OUTWARD))
    return low, high


def _narrows(share: float, hits: int, of: int) -> bool:
    """Whether up to this share a draw without replacement makes `hits` or more less likely, by Uhlmann's condition."""
    return hits > 1 and share <= (hits - 1) / (of - 1) * (of / (of + 1))


def _lower(hits: int, of: int, tail: float) -> float:
    if hits == 0:
        return 0.0
    if 2 * hits > of:  # near 1 it is the distance from 1 that has to be right
        return math.nextafter(1 - _upper(of - hits, of, tail), 0)
    return beta_quantile(tail, hits, of - hits + 1) * (1 - OUTWARD)


def _upper(hits: int, of: int, tail: float) -> float:
    if hits == of:
        return 1.0
    if 2 * hits > of:
        return math.nextafter(1 - _lower(of - hits, of, tail), 1)
    return min(beta_quantile(1 - tail, hits + 1, of - hits) * (1 + OUTWARD), 1.0)


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
    return tails.binomial(a, a + b, x) * (b / (a + b)) / _continued_fraction(x, a, b)


def _continued_fraction(x: float, a: float, b: float) -> float:
    """1 + d1/(1 + d2/(1 + ...)), by the modified Lentz method."""
    tiny = 1e-300
    value, c, d = 1.0, 1.0, 0.0
    for step in range(1, 1_000_000):
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
