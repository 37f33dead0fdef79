"""Bounds over clusters: coverage by enumeration of all outcomes, and clusters taken for trials."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from fractions import Fraction

import pytest

from safety.inject.statistics import any_population, clustered, clustered_ratio

Interval = Callable[[Sequence[Fraction], float], tuple[float, float]]
# What a scenario's share may be, and how likely it is: all or nothing, nearly so, and of all sizes.
WORLDS = [
    {Fraction(0): Fraction(1, 10), Fraction(1): Fraction(9, 10)},
    {Fraction(0): Fraction(1, 100), Fraction(1): Fraction(99, 100)},
    {Fraction(0): Fraction(1, 2), Fraction(1): Fraction(1, 2)},
    {Fraction(1, 10): Fraction(1, 5), Fraction(1, 2): Fraction(2, 5), Fraction(99, 100): Fraction(2, 5)},
    {Fraction(1, 3): Fraction(1)},
]


def coverage(interval: Interval, world: dict[Fraction, Fraction], clusters: int, confidence: float) -> Fraction:
    """The exact probability that the interval holds the expected share."""
    truth = sum(share * chance for share, chance in world.items())
    held = Fraction(0)
    for shares in itertools.product(world, repeat=clusters):
        low, high = interval(shares, confidence)
        if low <= truth <= high:
            chance = Fraction(1)
            for share in shares:
                chance *= world[share]
            held += chance
    return held


@pytest.mark.parametrize("clusters", [1, 2, 5])
@pytest.mark.parametrize("confidence", [0.5, 0.9, 0.99])
@pytest.mark.parametrize("world", WORLDS)
def test_the_expected_share_is_held_as_often_as_stated(
    world: dict[Fraction, Fraction], clusters: int, confidence: float
) -> None:
    assert coverage(clustered, world, clusters, confidence) >= Fraction(str(confidence))


def as_trials(shares: Sequence[Fraction], confidence: float) -> tuple[float, float]:
    """A hundred faults under each scenario, taken for independent trials."""
    return any_population(int(100 * sum(shares)), 100 * len(shares), confidence)


def swapped(shares: Sequence[Fraction], confidence: float) -> tuple[float, float]:
    low, high = clustered(shares, confidence)
    return 1 - high, 1 - low


@pytest.mark.parametrize("wrong", [as_trials, swapped])
def test_a_wrong_bound_is_found(wrong: Interval) -> None:
    assert min(coverage(wrong, world, 5, 0.9) for world in WORLDS) < Fraction(9, 10)


def test_the_ratio_is_held_as_often_as_stated() -> None:
    """Scenarios with shares of good and bad that go together."""
    world = {(Fraction(9, 10), Fraction(0)): 6, (Fraction(1, 2), Fraction(1, 2)): 3, (Fraction(0), Fraction(1, 5)): 1}
    good = sum(g * w for (g, _), w in world.items())
    bad = sum(b * w for (_, b), w in world.items())
    held = 0
    for pairs in itertools.product(world, repeat=4):
        low, high = clustered_ratio([g for g, _ in pairs], [b for _, b in pairs], 0.8)
        if low <= good / (good + bad) <= high:
            chance = 1
            for pair in pairs:
                chance *= world[pair]
            held += chance
    assert held >= 0.8 * 10**4


def test_more_scenarios_say_more_and_one_says_hardly_anything() -> None:
    low = [clustered([Fraction(1)] * n, 0.99)[0] for n in (1, 10, 100, 1000)]
    assert low == pytest.approx([0.005 ** (1 / n) for n in (1, 10, 100, 1000)], rel=1e-8)
    assert clustered([Fraction(1)], 0.99)[1] == 1.0


@pytest.mark.parametrize("shares", [[], [Fraction(3, 2)], [Fraction(-1, 9)]])
def test_impossible_shares_are_refused(shares: list[Fraction]) -> None:
    with pytest.raises(ValueError, match="give at least one, each from 0 to 1"):
        clustered(shares)
