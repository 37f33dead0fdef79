"""Intervals and fractions: known values, exact coverage by enumeration, and what has to be refused."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest

from safety.inject.statistics import Stratum, clopper_pearson, runs_without_failure, share, weighted


@pytest.mark.parametrize(
    ("hits", "of", "confidence", "low", "high"),
    [  # quantiles of the beta distribution, computed with scipy 1.17 (scipy.stats.beta.ppf)
        (0, 10, 0.95, 0.0, 0.3084971078187607),
        (5, 10, 0.95, 0.18708602844739855, 0.8129139715526015),
        (1, 100, 0.95, 0.00025314603297742086, 0.054459385392080645),
        (99, 100, 0.99, 0.9280423175983636, 0.9999498758380223),
        (35, 46, 0.99, 0.5665640192433985, 0.8995786095758257),
        (3, 1_000_000, 0.99, 3.3786366951563994e-07, 1.0977433709368371e-05),
        (500_000, 1_000_000, 0.99, 0.4987115878088738, 0.5012884121911262),
        (0, 4_605_168, 0.98, 0.0, 9.999999746812e-07),
    ],
)
def test_the_interval_has_the_known_ends_rounded_outward(
    hits: int, of: int, confidence: float, low: float, high: float
) -> None:
    found = clopper_pearson(hits, of, confidence)
    assert found == pytest.approx((low, high), rel=3e-8)
    assert found[0] <= low and high <= found[1]


@pytest.mark.parametrize(
    ("probability", "runs"),
    [("1e-2", 459), ("1e-3", 4603), ("1e-4", 46_050), ("1e-5", 460_515), ("1e-6", 4_605_168), ("1e-7", 46_051_700)],
)
def test_runs_without_failure_at_99_percent(probability: str, runs: int) -> None:
    assert runs_without_failure(Fraction(probability), 0.99) == runs


def test_runs_without_failure_are_the_least_that_do() -> None:
    remaining = Fraction(99, 100)
    assert remaining**459 <= Fraction(1, 100) < remaining**458


@pytest.mark.parametrize(("missed", "runs"), [(0, 459), (1, 662), (2, 838), (5, 1307), (10, 2010)])
def test_runs_for_a_coverage_of_99_percent_with_some_missed(missed: int, runs: int) -> None:
    low = [clopper_pearson(n - missed, n, 0.98)[0] for n in (runs - 1, runs)]
    assert low[0] < 0.99 <= low[1] * (1 + 2e-8)


def coverage(interval: dict[int, tuple[float, float]], n: int, p: Fraction) -> Fraction:
    """The exact probability that the interval holds p."""
    return sum(
        (math.comb(n, k) * p**k * (1 - p) ** (n - k) for k in range(n + 1) if interval[k][0] <= p <= interval[k][1]),
        Fraction(0),
    )


PROBABILITIES = [Fraction(k, 97) for k in range(98)]


@pytest.mark.parametrize("confidence", [0.8, 0.95, 0.99])
@pytest.mark.parametrize("n", [1, 2, 5, 12, 25])
def test_the_interval_holds_the_truth_at_least_as_often_as_stated(n: int, confidence: float) -> None:
    interval = {k: clopper_pearson(k, n, confidence) for k in range(n + 1)}
    assert min(coverage(interval, n, p) for p in PROBABILITIES) >= Fraction(str(confidence))


def test_the_normal_approximation_would_not() -> None:
    n = 25
    half = {k: 2.576 * math.sqrt(k / n * (1 - k / n) / n) for k in range(n + 1)}
    interval = {k: (k / n - half[k], k / n + half[k]) for k in range(n + 1)}
    assert min(coverage(interval, n, p) for p in PROBABILITIES) < Fraction("0.99")


def test_everything_tried_leaves_no_interval() -> None:
    found = share(35, 46, exhaustive=True)
    assert found is not None
    assert (found.exact, found.low, found.high) == (Fraction(35, 46), 35 / 46, 35 / 46)
    assert share(0, 0, exhaustive=True) is None


@pytest.mark.parametrize("arguments", [(3, 2, 0.9), (0, 0, 0.9), (-1, 3, 0.9), (1, 3, 1.0), (1, 3, 0.0)])
def test_impossible_counts_and_confidences_are_refused(arguments: tuple[int, int, float]) -> None:
    with pytest.raises(ValueError, match=r"trials|confidence"):
        clopper_pearson(*arguments)


def stratum(weight: str, tried: int, safe: int, found: int, missed: int, *, exhaustive: bool = True) -> Stratum:
    return Stratum("s", Fraction(weight), tried, safe, found, missed, exhaustive)


def test_each_stratum_weighs_what_it_weighs() -> None:
    strata = [stratum("3e-8", 4, 1, 2, 1), stratum("1e-8", 2, 0, 0, 1)]
    coverage = weighted(strata, safe_too=False)
    fraction = weighted(strata, safe_too=True)
    assert coverage is not None and coverage.exact == Fraction(6, 11)  # 1.5e-8 of 2.75e-8
    assert fraction is not None and fraction.exact == Fraction(9, 14)  # 2.25e-8 of 3.5e-8


@pytest.mark.parametrize(
    ("bad", "message"), [(stratum("0", 4, 0, 4, 0), "weighs 0"), (stratum("1e-8", 0, 0, 0, 0), "has no trial")]
)
def test_a_stratum_that_would_pass_unseen_fails(bad: Stratum, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        weighted([stratum("1e-8", 4, 0, 4, 0), bad], safe_too=False)


def test_the_weighted_interval_holds_the_truth_over_all_samples() -> None:
    """Two strata with known shares of (dangerous detected, dangerous undetected), five drawn from each."""
    truth, weights, n = [(0.6, 0.2), (0.3, 0.1)], [3, 1], 5
    good, bad = (sum(w * t[i] for w, t in zip(weights, truth, strict=True)) for i in (0, 1))
    held = 0.0
    for first in outcomes(n):
        for second in outcomes(n):
            strata = [Stratum("s", Fraction(w), n, 0, *o, False) for w, o in zip(weights, (first, second), strict=True)]
            found = weighted(strata, safe_too=False, confidence=0.9)
            if found is None or found.low <= good / (good + bad) <= found.high:
                held += chance(first, truth[0], n) * chance(second, truth[1], n)
    assert held >= 0.9


def outcomes(n: int) -> list[tuple[int, int]]:
    return [(a, b) for a in range(n + 1) for b in range(n + 1 - a)]


def chance(outcome: tuple[int, int], share: tuple[float, float], n: int) -> float:
    (a, b), (p, q) = outcome, share
    return math.comb(n, a) * math.comb(n - a, b) * p**a * q**b * (1 - p - q) ** (n - a - b)
