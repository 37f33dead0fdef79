"""Bounds for draws without replacement: exact coverage for every population up to 60, and against scipy beyond."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from functools import cache

import pytest

from safety.inject.statistics import any_population, clopper_pearson, hypergeometric_limits, share, tails

Interval = Callable[[int, int, int, float], tuple[float | Fraction, float | Fraction]]


@cache
def chance(k: int, drawn: int, marked: int, population: int) -> Fraction:
    ways = math.comb(marked, k) * math.comb(population - marked, drawn - k)
    return Fraction(ways, math.comb(population, drawn))


def limits(hits: int, of: int, population: int, confidence: float) -> tuple[Fraction, Fraction]:
    low, high = hypergeometric_limits(hits, of, population, confidence)
    return Fraction(low, population), Fraction(high, population)


for_any = cache(any_population)


def of_unknown_size(hits: int, of: int, population: int, confidence: float) -> tuple[float, float]:
    return for_any(hits, of, confidence)


def least_coverage(interval: Interval, population: int, of: int, confidence: float) -> Fraction:
    """The least probability, over all numbers of hits in the population, that the interval holds their share."""
    bounds = [interval(k, of, population, confidence) for k in range(of + 1)]
    return min(
        sum(
            (
                chance(k, of, marked, population)
                for k in range(max(0, of + marked - population), min(of, marked) + 1)
                if bounds[k][0] <= Fraction(marked, population) <= bounds[k][1]
            ),
            Fraction(0),
        )
        for marked in range(population + 1)
    )


def least_one_sided(interval: Interval, population: int, of: int, confidence: float) -> Fraction:
    """As `least_coverage`, for the lower end alone and for the upper end alone, whichever is held less often."""
    return min(
        least_coverage(lambda *a: (interval(*a)[0], 1.0), population, of, confidence),
        least_coverage(lambda *a: (0.0, interval(*a)[1]), population, of, confidence),
    )


SIZES = [(1, 1), (2, 1), (5, 3), (13, 12), (20, 7), (33, 20), (60, 1), (60, 2), (60, 9), (60, 30), (60, 59), (60, 60)]


@pytest.mark.parametrize("interval", [limits, of_unknown_size])
@pytest.mark.parametrize("confidence", [0.8, 0.95, 0.99])
@pytest.mark.parametrize(("population", "of"), SIZES)
def test_the_limits_hold_the_truth_at_least_as_often_as_stated(
    interval: Interval, population: int, of: int, confidence: float
) -> None:
    assert least_coverage(interval, population, of, confidence) >= Fraction(str(confidence))
    assert least_one_sided(interval, population, of, confidence) >= 1 - (1 - Fraction(str(confidence))) / 2


@pytest.mark.slow
@pytest.mark.parametrize("interval", [limits, of_unknown_size])
def test_the_limits_hold_for_every_population_up_to_60(interval: Interval) -> None:
    for population in range(1, 61):
        for of in range(1, population + 1):
            for confidence in (0.5, 0.98):
                least = least_one_sided(interval, population, of, confidence)
                assert least >= 1 - (1 - Fraction(str(confidence))) / 2, (population, of, confidence)


def swapped(hits: int, of: int, population: int, confidence: float) -> tuple[Fraction, Fraction]:
    low, high = limits(of - hits, of, population, confidence)
    return low, high


def off_by_one(hits: int, of: int, population: int, confidence: float) -> tuple[Fraction, Fraction]:
    low, _ = limits(min(hits + 1, of), of, population, confidence)
    _, high = limits(max(hits - 1, 0), of, population, confidence)
    return low, high


def not_halved(hits: int, of: int, population: int, confidence: float) -> tuple[Fraction, Fraction]:
    return limits(hits, of, population, 2 * confidence - 1)


def shifted(hits: int, of: int, population: int, confidence: float) -> tuple[Fraction, Fraction]:
    low, high = limits(hits, of, population, confidence)
    return low + Fraction(1, population), high - Fraction(1, population)


@pytest.mark.parametrize("wrong", [swapped, off_by_one, not_halved, shifted])
def test_a_wrong_bound_is_found(wrong: Interval) -> None:
    found = [least_coverage(wrong, population, of, 0.9) for population, of in ((20, 7), (33, 20), (60, 9))]
    assert min(found) < Fraction(9, 10)


def test_clopper_and_pearson_do_not_hold_without_replacement() -> None:
    """One hit in the population, one draw of 60, confidence 1 - 2/61: the lower end is wrong with 1/60 > 1/61."""

    def independent(hits: int, of: int, population: int, confidence: float) -> tuple[float, float]:
        return clopper_pearson(hits, of, confidence)

    confidence, nominal = 1 - 2 * 0.1660, 1 - Fraction("0.1660")
    assert least_one_sided(independent, 60, 10, confidence) < nominal  # 1 - (1 - 1/60)^10 < 0.1660 < 10/60
    assert least_one_sided(of_unknown_size, 60, 10, confidence) >= nominal


@pytest.mark.parametrize("n", [2, 3, 5, 9])
def test_uhlmanns_condition_makes_the_tail_thinner(n: int) -> None:
    """What `any_population` takes from the source, by enumeration: for k >= 2 and K/N <= (k-1)/(n-1) N/(N+1)."""
    for population in range(n, 31):
        for marked in range(population + 1):
            p = Fraction(marked, population)
            for k in range(2, n + 1):
                if p <= Fraction(k - 1, n - 1) * Fraction(population, population + 1):
                    without = sum(chance(j, n, marked, population) for j in range(k, min(n, marked) + 1))
                    independent = sum(math.comb(n, j) * p**j * (1 - p) ** (n - j) for j in range(k, n + 1))
                    assert without <= independent


@pytest.mark.parametrize(
    ("hits", "of", "population"),
    [
        (0, 100, 10_000),
        (1, 2000, 5000),
        (7, 500, 1_000_000),
        (40, 3000, 4000),
        (3, 10**6, 10**9),
        (10**4, 10**5, 10**8),
    ],
)
def test_the_limits_are_the_least_and_greatest_numbers_that_pass_by_scipy(hits: int, of: int, population: int) -> None:
    from scipy.stats import hypergeom

    low, high = hypergeometric_limits(hits, of, population, 0.99)
    at_least = [float(hypergeom.sf(hits - 1, population, k, of)) for k in (low, max(low - 1, 0))]
    at_most = [float(hypergeom.cdf(hits, population, k, of)) for k in (high, high + 1)]
    assert low == hits == 0 or at_least[1] <= 0.005 < at_least[0]
    assert at_most[1] <= 0.005 < at_most[0]


@pytest.mark.parametrize("hits", [0, 1, 2, 10, 30])
def test_whole_numbers_and_floating_point_agree(hits: int, monkeypatch: pytest.MonkeyPatch) -> None:
    exact = [hypergeometric_limits(hits, 30, n, c) for n in (31, 60, 400, 999) for c in (0.5, 0.9, 0.999)]
    monkeypatch.setattr(tails, "INTEGER", 0)
    assert [hypergeometric_limits(hits, 30, n, c) for n in (31, 60, 400, 999) for c in (0.5, 0.9, 0.999)] == exact


def test_everything_drawn_leaves_one_number() -> None:
    assert hypergeometric_limits(3, 40, 40) == (3, 3)


def test_a_share_of_a_known_population() -> None:
    found = share(1, 30, exhaustive=False, confidence=0.9, population=40)
    low, high = hypergeometric_limits(1, 30, 40, 0.9)
    assert found is not None and found.low <= Fraction(low, 40) and Fraction(high, 40) <= found.high
    assert (found.low, found.high) == pytest.approx((low / 40, high / 40), rel=1e-15)
    wide = share(1, 30, exhaustive=False, confidence=0.9)
    assert wide is not None and wide.low < found.low and found.high < wide.high


def test_a_population_beyond_all_measure_is_taken_as_endless() -> None:
    assert share(1, 30, exhaustive=False, population=10**15) == share(1, 30, exhaustive=False)


@pytest.mark.parametrize("arguments", [(3, 2, 9), (0, 0, 9), (1, 10, 9), (1, 10, 10**9 + 1)])
def test_impossible_counts_are_refused(arguments: tuple[int, int, int]) -> None:
    with pytest.raises(ValueError, match=r"trials|population"):
        hypergeometric_limits(*arguments)
