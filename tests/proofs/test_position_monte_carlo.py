"""The odometer in drawn slides: the counts are those pinned, bounds hold, and planted intervals lose the train."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Self

import pytest

from models.position.odometer import Mode, SpeedBounds, Speeds, WheelWatch, step_s
from models.position.ride import Ride
from proofs import position_monte_carlo as sampled
from safety import Model, Real
from safety.exhibits import declared
from tests.seeded.planting import planted

FEW = 20
B_REF = Fraction("0.6")  # m/s^2, mean of the drawn brakings


class ReckonsWithTwiceTheBraking(SpeedBounds, tick_s=step_s):
    """Planted: s_hi takes it that the train loses twice what it lost before the slide."""

    def carried(self, most: Real) -> Real:
        return self.top - 2 * B_REF * Fraction(1, 10)


class ReckonsWithHalfTheLoss(SpeedBounds, tick_s=step_s):
    """Planted: s_lo takes it that the train loses half of what is possible."""

    def step(self, wheel: Real, mode: Mode, eps: Real, gain: Real, loss: Real) -> tuple[Self, Speeds]:
        return super().step(wheel, mode, eps, gain, loss / 2)


class NeverSlides(WheelWatch, tick_s=step_s):
    """Planted: the wheel's speed counts, whatever it does."""

    def step(self, speed: Real, cycle: Real, b_hi: Real) -> tuple[WheelWatch, Mode]:
        return super().step(speed, cycle * 1000, b_hi)


@pytest.mark.parametrize("name", ["position.slides_sampled", "position.slide_errors_sampled"])
def test_as_many_missions_come_out_so_as_are_pinned(name: str) -> None:
    found = next(each for each in declared() if each.id == name).evaluate()
    assert found["as_expected"], found.get("note")


def test_the_train_is_always_inside_and_the_estimate_often_short() -> None:
    found = sampled.counts(sampled.missions())
    assert found[sampled.BREAKS] == found[sampled.LEAVES] == 0 < found[sampled.SLID]


def few(model: type[Model]) -> dict[str, int]:
    """Some of the missions on a bench."""
    return sampled.counts([*map(sampled.Bench(model).mission, sampled.slides()[:FEW])])


@pytest.mark.parametrize("bounds", [ReckonsWithTwiceTheBraking, ReckonsWithHalfTheLoss])
def test_a_planted_interval_loses_the_train(bounds: type[Model]) -> None:
    found = few(planted(Ride, {"odometer.bounds": bounds}))
    assert found[sampled.LEAVES] > 0 == found[sampled.BREAKS]


def test_a_slide_that_is_not_seen_breaks_a_premise_and_loses_the_train() -> None:
    found = few(planted(Ride, {"odometer.watch": NeverSlides}))
    assert found[sampled.LEAVES] > 0 and found[sampled.BREAKS] == FEW


@pytest.mark.parametrize("b", [Fraction("0.6"), Fraction(1)], ids=str)
def test_error_of_the_reference_slide(b: Fraction) -> None:
    """3 s with a locked wheel: (b_true - b_ref) t^2 / 2, and b_ref T t / 2 since v_0 is a mean, half a cycle old."""
    t, b_true, cycle = 3, Fraction("0.8"), Fraction(1, 10)
    slide = sampled.Slide(23, Fraction(0), b, 30, 10 * t, b_true, Fraction(230))
    assert sampled.Bench().mission(slide).slid == (b_true - b) * t * t / 2 + b * cycle * t / 2


def test_bounds_of_a_quantile_miss_no_more_often_than_stated() -> None:
    """By the binomial distribution, with a loop of its own."""
    n, share = 200, Fraction(1, 4)
    _, low, high = sampled.quantile([Fraction(k) for k in range(1, n + 1)], share)

    def at_most(hits: int) -> float:
        return sum(math.comb(n, h) * 0.25**h * 0.75 ** (n - h) for h in range(hits + 1))

    assert at_most(int(low) - 1) <= 0.005 < at_most(int(low))
    assert 1 - at_most(int(high) - 1) <= 0.005 < 1 - at_most(int(high) - 2)


def test_few_values_bound_no_far_quantile() -> None:
    with pytest.raises(ValueError, match="draw more"):
        sampled.quantile([Fraction(k) for k in range(20)], Fraction(1, 20))
