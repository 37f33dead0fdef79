"""Intervals and fractions: known values, exact coverage by enumeration, and what has to be refused."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from statistics import NormalDist

import pytest

from safety.inject.statistics import any_population, clopper_pearson, runs_without_failure, share


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


@pytest.mark.parametrize(("missed", "runs"), [(0, 4603), (1, 6636), (2, 8403), (5, 13_105)])
def test_runs_for_a_coverage_of_99_9_percent_with_some_missed(missed: int, runs: int) -> None:
    low = [clopper_pearson(n - missed, n, 0.98)[0] for n in (runs - 1, runs)]
    assert low[0] < 0.999 <= low[1] * (1 + 2e-8)


@pytest.mark.parametrize(
    ("hits", "of"), [(0, 10**9), (1, 10**9), (5, 10**9), (10**6, 10**9), (5 * 10**8, 10**9), (10**9 - 3, 10**9)]
)
def test_the_interval_is_right_for_a_thousand_million_trials(hits: int, of: int) -> None:
    from scipy.stats import binom

    low, high = clopper_pearson(hits, of, 0.99)
    if hits:
        assert 0.005 * (1 - 1e-3) < binom.cdf(of - hits, of, 1 - low) <= 0.005 * (1 + 1e-6)
    assert 0.005 * (1 - 1e-3) < binom.cdf(hits, of, high) <= 0.005 * (1 + 1e-6)


Interval = Callable[[int, int, float], tuple[float, float]]


def coverage(bounds: list[tuple[float, float]], p: Fraction) -> Fraction:
    """The exact probability that the interval holds p, by summing over all outcomes."""
    n = len(bounds) - 1
    return sum(
        (math.comb(n, k) * p**k * (1 - p) ** (n - k) for k in range(n + 1) if bounds[k][0] <= p <= bounds[k][1]),
        Fraction(0),
    )


def least_coverage(interval: Interval, n: int, confidence: float) -> Fraction:
    """The least coverage over a grid and over the ends of all intervals, just outside of them.

    The outcomes whose intervals hold p follow each other and change at these ends only; the probability of a run of
    outcomes rises, then falls with p.  So the least over all p is met just beside an end.
    """
    bounds = [interval(k, n, confidence) for k in range(n + 1)]
    ends = [Fraction(math.nextafter(low, -1)) for low, _ in bounds if low > 0]
    ends += [Fraction(math.nextafter(high, 2)) for _, high in bounds if high < 1]
    return min(coverage(bounds, p) for p in (*ends, *(Fraction(k, 97) for k in range(98))))


@pytest.mark.parametrize("interval", [clopper_pearson, any_population])
@pytest.mark.parametrize("confidence", [0.5, 0.8, 0.95, 0.99])
@pytest.mark.parametrize("n", [1, 2, 5, 12, 25])
def test_the_interval_holds_the_truth_at_least_as_often_as_stated(
    interval: Interval, n: int, confidence: float
) -> None:
    assert least_coverage(interval, n, confidence) >= Fraction(str(confidence))


def swapped(hits: int, of: int, confidence: float) -> tuple[float, float]:
    return clopper_pearson(of - hits, of, confidence)


def off_by_one(hits: int, of: int, confidence: float) -> tuple[float, float]:
    low, _ = clopper_pearson(min(hits + 1, of), of, confidence)
    _, high = clopper_pearson(max(hits - 1, 0), of, confidence)
    return low, high


def low_off_by_one(hits: int, of: int, confidence: float) -> tuple[float, float]:
    return off_by_one(hits, of, confidence)[0], 1.0


def not_halved(hits: int, of: int, confidence: float) -> tuple[float, float]:
    return clopper_pearson(hits, of, 2 * confidence - 1)


def one_trial_too_many(hits: int, of: int, confidence: float) -> tuple[float, float]:
    return clopper_pearson(hits, of + 1, confidence)


def normal_approximation(hits: int, of: int, confidence: float) -> tuple[float, float]:
    p, z = hits / of, NormalDist().inv_cdf((1 + confidence) / 2)
    half = z * math.sqrt(p * (1 - p) / of)
    return p - half, p + half


@pytest.mark.parametrize(
    "wrong", [swapped, off_by_one, low_off_by_one, not_halved, one_trial_too_many, normal_approximation]
)
@pytest.mark.parametrize("n", [12, 25])
def test_a_wrong_interval_is_found(wrong: Interval, n: int) -> None:
    assert least_coverage(wrong, n, 0.95) < Fraction("0.95")


def test_everything_tried_leaves_no_interval() -> None:
    found = share(35, 46, exhaustive=True)
    assert found is not None
    assert (found.exact, found.low, found.high) == (Fraction(35, 46), 35 / 46, 35 / 46)
    assert share(0, 0, exhaustive=True) is None


@pytest.mark.parametrize("arguments", [(3, 2, 0.9), (0, 0, 0.9), (-1, 3, 0.9), (1, 3, 1.0), (1, 3, 0.0)])
def test_impossible_counts_and_confidences_are_refused(arguments: tuple[int, int, float]) -> None:
    with pytest.raises(ValueError, match=r"trials|confidence"):
        clopper_pearson(*arguments)
