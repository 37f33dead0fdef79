"""Probabilities of the binomial and the hypergeometric distribution, accurate for counts up to 10^9.

Differences of log-gamma functions lose what matters at such counts, so the deviance is taken apart as in Loader, "Fast
and accurate computation of binomial probabilities" (2000): relative errors stay near 1e-13.
"""

from __future__ import annotations

import math
from fractions import Fraction

INTEGER = 1000  # populations up to this size are counted in whole numbers
SLACK = 1e-9  # relative; what a tail in floating point may be wrong by


def binomial(k: float, n: float, p: float) -> float:
    """C(n, k) p^k (1-p)^(n-k), for real 0 <= k <= n too (factorials by the gamma function)."""
    if k == 0:
        return math.exp(n * math.log1p(-p)) if p < 1 else float(n == 0)
    if k == n:
        return math.exp(n * math.log(p)) if p > 0 else 0.0
    if p <= 0 or p >= 1:
        return 0.0
    rest = n - k
    log = stirling_error(n) - stirling_error(k) - stirling_error(rest)
    log -= deviance(k, n * p) + deviance(rest, n * (1 - p))
    return math.exp(log) * math.sqrt(n / (2 * math.pi * k * rest))


def hypergeometric(k: int, drawn: int, marked: int, population: int) -> float:
    """Probability of k marked among `drawn` of a population with `marked`."""
    if not max(0, drawn + marked - population) <= k <= min(drawn, marked):
        return 0.0
    if drawn == population:
        return 1.0
    p = drawn / population
    whole = binomial(drawn, population, p)
    return binomial(k, marked, p) * (binomial(drawn - k, population - marked, p) / whole)


def reaches(k: int, drawn: int, marked: int, population: int, level: Fraction) -> bool:
    """Whether k or more marked are drawn with a probability above `level`; yes where rounding leaves it open."""
    if population <= INTEGER:
        ways = sum(
            math.comb(marked, j) * math.comb(population - marked, drawn - j) for j in range(k, min(drawn, marked) + 1)
        )
        return ways > level * math.comb(population, drawn)
    bar = float(level) * (1 - SLACK)
    unmarked = population - marked
    mode = (drawn + 1) * (marked + 1) // (population + 2)
    if k > mode:
        total, term = 0.0, hypergeometric(k, drawn, marked, population)
        while term > total * 1e-17 and total <= bar:
            total += term
            term *= (marked - k) / (k + 1) * ((drawn - k) / (unmarked - drawn + k + 1))
            k += 1
        return total > bar
    k -= 1
    below, term = 0.0, hypergeometric(k, drawn, marked, population)
    while term > below * 1e-17 and below < 1 - bar:
        below += term
        term *= k / (marked - k + 1) * ((unmarked - drawn + k) / (drawn - k + 1))
        k -= 1
    return 1 - below > bar


def stirling_error(n: float) -> float:
    """log(n!) less Stirling's approximation sqrt(2 pi n) (n/e)^n."""
    if n <= 15:
        return math.lgamma(n + 1) - (n + 0.5) * math.log(n) + n - math.log(2 * math.pi) / 2
    square = n * n
    return (1 / 12 - (1 / 360 - (1 / 1260 - (1 / 1680 - 1 / 1188 / square) / square) / square) / square) / n


def deviance(x: float, mean: float) -> float:
    """x log(x/mean) + mean - x without cancellation near x = mean."""
    if abs(x - mean) >= 0.1 * (x + mean):
        return x * math.log(x / mean) + mean - x
    v = (x - mean) / (x + mean)
    total, power, j = (x - mean) * v, 2 * x * v, 0
    while True:
        j += 1
        power *= v * v
        more = total + power / (2 * j + 1)
        if more == total:
            return total
        total = more


def one_tail(confidence: float | Fraction) -> Fraction:
    """Half of what the confidence leaves open, exactly as written: 1/200 for 0.99.

    Raises `ValueError` unless 0 < confidence < 1.
    """
    if not 0 < confidence < 1:
        raise ValueError(f"confidence {confidence}: it lies between 0 and 1, e.g. 0.99")
    return (1 - Fraction(str(confidence))) / 2


def check_counts(hits: int, of: int) -> None:
    """Raises `ValueError` unless 0 <= hits <= of and of >= 1."""
    if not (0 <= hits <= of and of >= 1):
        raise ValueError(f"{hits} hits of {of} trials: there is at least 1 trial, and no more hits than trials")
