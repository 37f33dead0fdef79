"""Bounds that hold at all times at once: coverage over all paths with the worst stopping, and the stopping itself."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from functools import cache

import pytest

from safety.inject.statistics import StopWhenSure, anytime, anytime_limits, clopper_pearson, hypergeometric_limits

Interval = Callable[[int, int], tuple[float, float]]
LONGEST = 200


def mixture(confidence: float, around: float) -> Interval:
    return cache(lambda hits, of: anytime(hits, of, confidence, around))


def chance_of_holding_throughout(interval: Interval, p: float, longest: int) -> float:
    """Probability that the interval holds p after every one of the trials 1 to `longest`, over all paths.

    Whoever stops when it suits him is wrong at most as often as the interval ever is.
    """
    alive = {0: 1.0}
    for n in range(1, longest + 1):
        after: dict[int, float] = {}
        for k, weight in alive.items():
            after[k] = after.get(k, 0.0) + weight * (1 - p)
            after[k + 1] = after.get(k + 1, 0.0) + weight * p
        alive = {k: weight for k, weight in after.items() if weight > 1e-12}
        lost = {k for k in alive if not (bounds := interval(k, n))[0] <= p <= bounds[1]}
        alive = {k: weight for k, weight in alive.items() if k not in lost}
    return sum(alive.values())


@pytest.mark.parametrize(("confidence", "around"), [(0.9, 0.5), (0.9, 0.02), (0.99, 0.95)])
def test_the_truth_is_held_throughout_at_least_as_often_as_stated(confidence: float, around: float) -> None:
    interval = mixture(confidence, around)
    for p in (0.0, 0.001, 0.02, 0.1, 0.3, 0.5, 0.77, 0.95, 0.999, 1.0):
        assert chance_of_holding_throughout(interval, p, LONGEST) >= confidence


def fixed_size(hits: int, of: int) -> tuple[float, float]:
    return clopper_pearson(hits, of, 0.9)


def too_sure(hits: int, of: int) -> tuple[float, float]:
    return anytime(hits, of, 0.5)


def swapped(hits: int, of: int) -> tuple[float, float]:
    return anytime(of - hits, of, 0.9)


def off_by_one(hits: int, of: int) -> tuple[float, float]:
    return anytime(min(hits + 1, of), of, 0.9)[0], anytime(max(hits - 1, 0), of, 0.9)[1]


@pytest.mark.parametrize("wrong", [fixed_size, too_sure, swapped, off_by_one])
def test_a_bound_that_does_not_last_is_found(wrong: Interval) -> None:
    assert min(chance_of_holding_throughout(cache(wrong), p, 60) for p in (0.02, 0.1, 0.5)) < 0.9


def chance_of_holding_all_draws(limits: Interval, marked: int, population: int) -> Fraction:
    """As `chance_of_holding_throughout`, for draws without replacement until all are drawn; exact."""
    alive = {0: Fraction(1)}
    for n in range(1, population + 1):
        after: dict[int, Fraction] = {}
        for k, weight in alive.items():
            left = population - n + 1
            for drawn, ways in ((k, left - (marked - k)), (k + 1, marked - k)):
                if ways:
                    after[drawn] = after.get(drawn, Fraction(0)) + weight * Fraction(ways, left)
        alive = {k: w for k, w in after.items() if limits(k, n)[0] <= marked <= limits(k, n)[1]}
    return sum(alive.values(), Fraction(0))


@pytest.mark.parametrize("population", [1, 2, 7, 20, 40])
@pytest.mark.parametrize(("confidence", "around"), [(0.9, 0.5), (0.8, 0.05)])
def test_the_number_is_held_through_all_draws(population: int, confidence: float, around: float) -> None:
    limits = cache(lambda hits, of: anytime_limits(hits, of, population, confidence, around))
    for marked in range(population + 1):
        assert chance_of_holding_all_draws(limits, marked, population) >= Fraction(str(confidence))


def test_limits_for_a_fixed_size_do_not_last_through_all_draws() -> None:
    limits = cache(lambda hits, of: hypergeometric_limits(hits, of, 40, 0.8))
    assert min(chance_of_holding_all_draws(limits, marked, 40) for marked in range(41)) < Fraction(4, 5)


def test_all_drawn_leaves_one_number() -> None:
    assert anytime_limits(7, 30, 30) == (7, 7)


def test_without_replacement_the_bounds_are_narrower() -> None:
    low, high = anytime(20, 800)
    least, greatest = anytime_limits(20, 800, 1000)
    assert low < least / 1000 and greatest / 1000 < high


@pytest.mark.parametrize("of", [1000, 10**6, 10**8])
def test_without_replacement_from_very_many_is_as_with(of: int) -> None:
    low, high = anytime(of // 500, of)
    least, greatest = anytime_limits(of // 500, of, 10**9)
    assert (least / 1e9, greatest / 1e9) == pytest.approx((low, high), rel=0.06 if of == 10**8 else 2e-3)


# --- stopping ---------------------------------------------------------------------------------------------------------


def test_a_clear_case_stops_early_and_the_answer_stays() -> None:
    watch = StopWhenSure(Fraction("0.99"))
    answers = [watch.look(n, n) for n in range(100, 1001, 100)]
    sure = answers.index("sure above")
    assert answers == ["go on"] * sure + ["sure above"] * (len(answers) - sure)
    assert 459 < 100 * (sure + 1) < 1000  # a fixed number of trials would be 459; looking at will costs a little
    watch.look(1000, 1900)
    assert watch.answer == "sure above"
    assert watch.bounds[1] < 0.99  # what is seen is still reported as it is


def test_below_is_found_too() -> None:
    watch = StopWhenSure(0.9)
    assert [watch.look(k, 2 * k) for k in (1, 5, 50)] == ["go on", "go on", "sure below"]


def test_a_case_at_the_target_goes_on() -> None:
    watch = StopWhenSure(0.5, 0.95)
    assert {watch.look(k, 2 * k) for k in range(1, 2000)} == {"go on"}


def test_when_all_of_a_population_is_drawn_the_answer_is_sure() -> None:
    watch = StopWhenSure(Fraction(1, 3), 0.99, population=60)
    assert watch.look(21, 60) == "sure above"
    assert watch.bounds == pytest.approx((0.35, 0.35), rel=1e-15)


def test_both_bounds_stand_side_by_side() -> None:
    watch = StopWhenSure(0.9, 0.95)
    assert watch.bounds == watch.bounds_at_fixed_size == (0.0, 1.0)
    watch.look(70, 100)
    found = watch.to_json()
    assert found["anytime"]["low"] < found["fixed"]["low"] < 0.7 < found["fixed"]["high"] < found["anytime"]["high"]
    assert (found["answer"], found["hits"], found["of"], found["target"]) == ("sure below", 70, 100, 0.9)


@pytest.mark.parametrize("counts", [(5, 10), (9, 13)])
def test_counts_that_go_back_are_refused(counts: tuple[int, int]) -> None:
    watch = StopWhenSure(0.5)
    watch.look(7, 12)
    with pytest.raises(ValueError, match="after 7 of 12: give the counts from the first trial"):
        watch.look(*counts)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: StopWhenSure(1.0), "target 1.0"),
        (lambda: StopWhenSure(0.5, 1.0), "confidence 1.0"),
        (lambda: anytime(3, 2), "3 hits of 2 trials"),
        (lambda: anytime(1, 2, around=0.0), "around 0.0"),
        (lambda: anytime_limits(1, 20, 10), "population 10 with 20 draws"),
    ],
)
def test_impossible_questions_are_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.slow
@pytest.mark.parametrize(("p", "target"), [(0.985, 0.99), (0.99, 0.99), (0.0001, 0.001), (0.001, 0.001), (0.5, 0.45)])
def test_ten_thousand_campaigns_that_stop_when_sure_are_seldom_wrong(p: float, target: float) -> None:
    """Looks at 20 to 20 000 trials; a campaign is wrong when it stops with the wrong answer."""
    import numpy as np

    rng, confidence, looks = np.random.default_rng(7), 0.95, [round(20 * 1.4**i) for i in range(21)]
    bounds = cache(lambda hits, of: anytime(hits, of, confidence, target))
    wrong = 0
    for _ in range(10_000):
        hits, before = 0, 0
        for n in looks:
            hits, before = hits + int(rng.binomial(n - before, p)), n
            low, high = bounds(hits, n)
            if low >= target or high <= target:
                wrong += (low >= target) != (p >= target) and p != target
                wrong += p == target and (low > target or high < target)
                break
    assert wrong <= 500


@pytest.mark.slow
def test_ten_thousand_campaigns_on_a_finite_space_are_seldom_wrong() -> None:
    random_draws, population, marked = random.Random(3), 500, 30
    limits = cache(lambda hits, of: anytime_limits(hits, of, population, 0.9, 0.1))
    wrong = 0
    for _ in range(10_000):
        drawn, hits = random_draws.sample(range(population), 300), 0
        for n, one in enumerate(drawn, 1):
            hits += one < marked
            least, greatest = limits(hits, n)
            if not least <= marked <= greatest:
                wrong += 1
                break
    assert wrong <= 1000
