"""Totals over strata: exact values, coverage by enumeration of all samples, and strata that would pass unseen."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache

import pytest

from safety.inject.statistics import Share, Stratum, Trials, any_population, clopper_pearson, share, total, weighted

Bounds = Callable[[tuple[int, ...]], tuple[float, float]]
WEIGHTS, DRAWS = (Fraction(5), Fraction(2), Fraction(1, 2)), (3, 5, 2)
SHARES = [Fraction(k, 12) for k in (0, 1, 5, 11, 12)]


def trials(hits: Sequence[int], weights: Sequence[Fraction] = WEIGHTS, draws: Sequence[int] = DRAWS) -> list[Trials]:
    return [Trials(str(i), *stratum) for i, stratum in enumerate(zip(weights, hits, draws, strict=True))]


def bounds_of(hits: tuple[int, ...]) -> tuple[float, float]:
    found = total(trials(hits), 0.9)
    return found.low, found.high


def independent(k: int, n: int, p: Fraction) -> Fraction:
    return math.comb(n, k) * p**k * (1 - p) ** (n - k)


def of_twelve(k: int, n: int, p: Fraction) -> Fraction:
    """Draws without replacement from 12."""
    marked = int(12 * p)
    return Fraction(math.comb(marked, k) * math.comb(12 - marked, n - k), math.comb(12, n))


def least_coverage(bounds: Bounds, chance: Callable[[int, int, Fraction], Fraction]) -> Fraction:
    """The least probability over a grid of shares that the total is held, by summing over all samples."""
    found = {hits: bounds(hits) for hits in itertools.product(*(range(n + 1) for n in DRAWS))}
    least = Fraction(1)
    for shares in itertools.product(SHARES, repeat=len(DRAWS)):
        truth = sum(w * p for w, p in zip(WEIGHTS, shares, strict=True))
        held = [hits for hits, (low, high) in found.items() if low <= truth <= high]
        single = [[chance(k, n, p) for k in range(n + 1)] for n, p in zip(DRAWS, shares, strict=True)]
        least = min(
            least, sum((math.prod(c[k] for c, k in zip(single, hits, strict=True)) for hits in held), Fraction(0))
        )
    return least


@pytest.mark.parametrize("chance", [independent, of_twelve])
def test_the_total_is_held_at_least_as_often_as_stated(chance: Callable[[int, int, Fraction], Fraction]) -> None:
    assert least_coverage(bounds_of, chance) >= Fraction(9, 10)


def swapped(hits: tuple[int, ...]) -> tuple[float, float]:
    return bounds_of(tuple(n - k for k, n in zip(hits, DRAWS, strict=True)))


def off_by_one(hits: tuple[int, ...]) -> tuple[float, float]:
    up = tuple(min(k + 1, n) for k, n in zip(hits, DRAWS, strict=True))
    down = tuple(max(k - 1, 0) for k in hits)
    return bounds_of(up)[0], bounds_of(down)[1]


def of_the_mean_share(hits: tuple[int, ...]) -> tuple[float, float]:
    """All draws in one heap, whatever their weights: simple, and wrong."""
    low, high = clopper_pearson(sum(hits), sum(DRAWS), 0.9)
    return float(sum(WEIGHTS)) * low, float(sum(WEIGHTS)) * high


@pytest.mark.parametrize("wrong", [swapped, off_by_one, of_the_mean_share])
def test_a_wrong_bound_is_found(wrong: Bounds) -> None:
    assert least_coverage(wrong, independent) < Fraction(9, 10)


def bonferroni(strata: Sequence[Trials], confidence: float) -> tuple[float, float]:
    """Bounds of each stratum by itself that hold together."""
    each = [clopper_pearson(s.hits, s.of, 1 - (1 - confidence) / len(strata)) for s in strata]
    low, high = (sum(float(s.weight) * e[i] for s, e in zip(strata, each, strict=True)) for i in (0, 1))
    return low, high


@pytest.mark.parametrize("hits", [[0] * 10, [1, 0, 0, 2, 0, 0, 0, 0, 1, 0], [1000, 0, 999, 0, 3, 1000, 0, 0, 0, 998]])
def test_the_bounds_are_narrower_than_those_of_each_stratum_together(hits: list[int]) -> None:
    strata = trials(hits, [Fraction(1 + i) for i in range(10)], [1000] * 10)
    found, (low, high) = total(strata), bonferroni(strata, 0.99)
    assert low <= found.low <= found.value <= found.high < high
    assert found.high - found.value < 0.75 * (high - found.value)


def test_without_hits_the_bound_is_that_of_one_stratum() -> None:
    """1000 runs in each of ten equal strata without a hit say as much as 10 000 runs of all, not as 1000."""
    found = total(trials([0] * 10, [Fraction(1, 10)] * 10, [1000] * 10))
    assert found.high == pytest.approx(-math.log(0.005 * 0.9) / 10_000, rel=1e-3)


def test_what_was_tried_fully_is_exact_and_adds_up() -> None:
    strata = [Trials("a", Fraction("0.9"), 0, 7, True), Trials("b", Fraction("0.1"), 3, 12, True)]
    assert total(strata) == Share.known(Fraction(1, 40))
    sampled = Trials("c", Fraction("0.01"), 0, 500)
    found = total([*strata, sampled])
    assert 0.025 * (1 - 1e-7) <= found.low <= 0.025 < found.high < 0.025 + 0.01 * 0.0107


def test_the_estimate_is_that_of_horvitz_and_thompson() -> None:
    assert total(trials([1, 2, 2])).value == float(5 * Fraction(1, 3) + 2 * Fraction(2, 5) + Fraction(1, 2))


def test_very_unequal_weights_and_draws() -> None:
    found = total([Trials("a", Fraction(1), 3, 10**6), Trials("b", Fraction("1e-9"), 5, 10)])
    low, high = clopper_pearson(3, 10**6, 0.99)
    assert 0 < found.low <= low and high <= found.high <= 1.3 * high


# --- coverage by rate -------------------------------------------------------------------------------------------------


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


@pytest.mark.parametrize("bad", [Trials("s", Fraction(0), 0, 5), Trials("s", Fraction(1), 0, 0)])
def test_a_total_with_a_stratum_that_would_pass_unseen_fails(bad: Trials) -> None:
    with pytest.raises(ValueError, match=r"stratum 's' (weighs 0|has no trial): give it a rate above 0"):
        total([Trials("a", Fraction(1), 0, 5), bad])


def test_strata_that_are_nearly_all_tried_are_nearly_exact() -> None:
    some, most = ([Trials(str(i), Fraction(1), 5 * i, 95, population=n) for i in range(4)] for n in (None, 100))
    wide, narrow = total(some), total(most)
    assert wide.low < narrow.low <= narrow.value <= narrow.high < wide.high
    assert narrow.high - narrow.low < 0.3


@pytest.mark.parametrize("population", [6, 12])
def test_the_total_of_known_populations_is_held_as_often_as_stated(population: int) -> None:
    """Two strata of so many cases each, four of them drawn: all numbers of hits, all samples."""
    of, weights = 4, (Fraction(3), Fraction(1))
    found = {
        hits: total(
            [
                Trials(str(i), w, k, of, population=population)
                for i, (w, k) in enumerate(zip(weights, hits, strict=True))
            ],
            0.8,
        )
        for hits in itertools.product(range(of + 1), repeat=2)
    }
    for marked in itertools.product(range(population + 1), repeat=2):
        truth = sum(w * Fraction(m, population) for w, m in zip(weights, marked, strict=True))
        held = Fraction(0)
        for hits, share_found in found.items():
            if share_found.low <= truth <= share_found.high:
                ways = (math.comb(m, k) * math.comb(population - m, of - k) for m, k in zip(marked, hits, strict=True))
                held += Fraction(math.prod(ways), math.comb(population, of) ** 2)
        assert held >= Fraction(4, 5)


def test_a_single_sampled_stratum_has_the_bounds_of_its_trials() -> None:
    found = total([Trials("a", Fraction(1), 3, 50)], 0.9)
    assert (found.low, found.high) == pytest.approx(any_population(3, 50, 0.9), rel=3e-8)


def test_the_coverage_by_rate_is_made_of_bounds_that_hold_together() -> None:
    """Half of the error goes to the bounds of the good, half to those of the bad."""
    strata = [stratum("3", 90, 10, 60, 5, exhaustive=False), stratum("1", 40, 0, 10, 1, exhaustive=False)]
    good, bad = (
        total([Trials("s", s.weight, getattr(s, kind), s.tried) for s in strata], 0.95)
        for kind in ("dangerous_detected", "dangerous_undetected")
    )
    found = weighted(strata, safe_too=False, confidence=0.9)
    assert found is not None
    expected = good.low / (good.low + bad.high), good.high / (good.high + bad.low)
    assert (found.low, found.high) == pytest.approx(expected, rel=3e-8)


def test_nothing_dangerous_has_no_coverage() -> None:
    assert weighted([stratum("1", 4, 0, 0, 0)], safe_too=False) is None


def test_one_stratum_is_as_without_weights() -> None:
    found = weighted([stratum("3e-8", 50, 20, 25, 1, exhaustive=False)], safe_too=True)
    assert found == share(45, 46, exhaustive=False)


@cache
def found(outcomes: tuple[tuple[int, int], ...], draws: int, confidence: float) -> Share | None:
    strata = [Stratum("s", Fraction(w), draws, 0, *o, False) for w, o in zip((3, 1), outcomes, strict=True)]
    return weighted(strata, safe_too=False, confidence=confidence)


@pytest.mark.parametrize("truth", [((0.6, 0.2), (0.3, 0.1)), ((0.9, 0.01), (0.2, 0.7)), ((0.1, 0.01), (0.1, 0.05))])
def test_the_coverage_by_rate_is_held_over_all_samples(truth: tuple[tuple[float, float], ...]) -> None:
    """Two strata with known shares of (dangerous detected, dangerous undetected), four drawn from each."""
    weights, n = (3, 1), 4
    good, bad = (sum(w * t[i] for w, t in zip(weights, truth, strict=True)) for i in (0, 1))
    held = 0.0
    for pair in itertools.product(outcomes(n), repeat=2):
        bounds = found(pair, n, 0.9)
        if bounds is None or bounds.low <= good / (good + bad) <= bounds.high:
            held += math.prod(chance(o, t, n) for o, t in zip(pair, truth, strict=True))
    assert held >= 0.9


def outcomes(n: int) -> list[tuple[int, int]]:
    return [(a, b) for a in range(n + 1) for b in range(n + 1 - a)]


def chance(outcome: tuple[int, int], share: tuple[float, float], n: int) -> float:
    (a, b), (p, q) = outcome, share
    return math.comb(n, a) * math.comb(n - a, b) * p**a * q**b * (1 - p - q) ** (n - a - b)
