"""Rising speeds: public check P20, the tests of figure 8 and table 2, the exact ramp, lost pulses."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from models.two_counter.measuring import DynamicTest, Ride, StaticTest
from safety.trace import run
from tests.models.two_counter.runs import KMH, PRESET, SPACING, STEP_S, TC, Fleet, lines, threshold

GAIN = 311_739  # 1 km/h/s in a millionth of a speed unit per step


def turned(start: Any, k: int) -> Any:
    """Twice the millionth part of a unit: position after k steps from a start speed with 1 km/h/s."""
    return 2_000_000 * start * k + GAIN * k * k


def excess_at_brake(check: int, starts: Any, phases: Any, from_count_start: bool = False, steps: int = 14_000) -> Any:
    """Excess over f2E, in units, at the instant of the first read-out that brakes after a release; per train.

    The speed rises from power-up on, or from the first count start on; a train without such a read-out has none.
    """
    fleet, shape = Fleet(check, phases), np.shape(phases)
    found, released = np.full(shape, np.nan), np.zeros(shape, bool)
    rising = np.full(shape, -1 if from_count_start else 0)  # steps of the rise
    while not (np.isfinite(found) | (rising > steps)).all():
        k = np.maximum(rising, 0)
        after = turned(starts, k + 1)
        speed = np.where(rising < 0, starts, -(after // -2_000_000) + turned(starts, k) // -2_000_000)
        brake, _, begins = fleet(speed)
        since = fleet.state["train.phase"] + 1 + after / 2e6 + (after // -2_000_000)  # turned since the edge
        last = starts + GAIN / 1e6 * (k + 1)
        at_edge = last - GAIN / 1e6 * since / last
        found = np.where(np.isnan(found) & released & brake, at_edge - threshold(check), found)
        released, rising = released | ~brake, np.where((rising >= 0) | begins, rising + 1, rising)
    return found


def read_out_frequency(check: int) -> tuple[float, float]:
    """Hz and s: f2 at the read-out and t4 - t1, where the mean frequency of the first window is f2E (exact model)."""
    k, tc = 2 / float(TC), float(TC)
    first = threshold(check) / 1000 / tc - k * tc / 2
    last = (first**2 + 2 * k * (PRESET[check] + 5)) ** 0.5
    return last, (last - first) / k


def worst_excess(check: int) -> float:
    """km/h: what the speed gains from the window that is just missed to the read-out, and one count."""
    last, _ = read_out_frequency(check)
    return last * float(TC) / 2 - threshold(check) / KMH * (1 - 1 / 1999)


def spread(check: int, trains: int, reached: float) -> None:
    rng = np.random.default_rng(20)
    starts = threshold(check) - KMH - rng.integers(0, 700, trains)
    found = excess_at_brake(check, starts, rng.integers(0, SPACING, trains)) / KMH
    most = worst_excess(check)
    assert reached * most < found.max() <= most < 0.625
    assert found.min() > 0.15


@pytest.mark.parametrize(("check", "trains"), [(250, 500), pytest.param(30, 100, marks=pytest.mark.slow)])
def test_p20_ramp(check: int, trains: int) -> None:
    """1 km/h/s, phases spread over the sampling period and the oscillator: at most 0.5997 km/h at 250."""
    spread(check, trains, reached=0.97)
    assert abs(worst_excess(250) - 0.5997) < 5e-5


def test_p20_bound_is_nearly_reached() -> None:
    """From the count start of a window just missed, right before a pulse: within 0.0005 km/h of the bound."""
    rng = np.random.default_rng(1)
    starts = threshold(250) - 312 + rng.integers(230, 265, 200)
    phases = 8 * SPACING - 15 * starts + rng.integers(0, 2000, 200)
    most = np.nanmax(excess_at_brake(250, starts, phases, from_count_start=True, steps=4500)) / KMH
    assert worst_excess(250) - 0.0005 < most <= worst_excess(250)


@pytest.mark.slow
def test_p20_ramp_over_many_phases() -> None:
    spread(250, 20_000, reached=0.997)


def steps_of(start: int, begins: int, k: int) -> int:
    """Speed of a step: steady, then rising by 1 km/h/s."""
    j = max(0, k - begins)
    rising = turned(0, j + (k >= begins)) // -2_000_000 - turned(0, j) // -2_000_000
    return start - rising


@pytest.mark.parametrize(("check", "published"), [(250, "0.62611"), (110, "0.62918"), (5, "0.66976")])
def test_measuring_circuit(check: int, published: str) -> None:
    """Figure 8: from the start of a window that is just missed to the brake, t4 - t1 of the exact model, P9."""
    start = threshold(check) - 313  # half a counting time of 1 km/h/s below, and a unit to be safe

    def row(k: int) -> dict[str, Any]:
        return {"speed": steps_of(start, 2100, k), "reset": k < 2030, **lines(check)}

    before = run(DynamicTest, lambda k: row(0), 4600)
    counts = [k for k, begins in enumerate(before["signal3"]) if begins]
    begins = counts[1] + 1

    def ridden(k: int) -> dict[str, Any]:
        return {"speed": steps_of(start, begins, k), "reset": k < counts[1] - 9, **lines(check)}

    seen = run(DynamicTest, ridden, begins + 4600)
    assert seen["me"].index(True) == counts[1] and not seen["brake"][counts[1]] and seen["brake"][-1]
    _, exact = read_out_frequency(check)
    assert abs(exact - float(published)) < 1e-5
    assert abs(seen["time"][-1] * float(STEP_S) - exact) < 1.5 * float(STEP_S)


def test_static_test_reads_the_frequency_at_which_the_brake_appears() -> None:
    """An oscillator 102 ppm slow: the brake appears in some samples from 102 ppm below 8*f2E on, not before."""
    nominal = 8 * threshold(250) * (1 - Fraction(102, 10**6))
    for above, appears in ((1200, True), (-20, False)):
        row = {"frequency": round(nominal + above), **lines(250)}
        seen = run(StaticTest, row, 20_000, settings={"error": -102}, keep=["brake"])["brake"]
        assert any(seen[2100:]) is appears and not all(seen[2100:])


@pytest.mark.parametrize(("n1f", "acceleration"), [(2000, 50), (1885, 300), (2047, 1)])
def test_ride_is_the_continuous_ramp(n1f: int, acceleration: int) -> None:
    """From 100 km/h: the way turned in each step of Tc/n1F."""
    settings = {"start": 10_000, "acceleration": acceleration, "n1f": n1f}
    seen = run(Ride, lines(250), 3000, settings=settings)["speed"]
    gain = Fraction(acceleration, 100) * KMH * TC / n1f
    way = [math.ceil(200_000 * k + gain * k * k / 2) for k in range(3001)]
    assert seen == [b - a for a, b in pairwise(way)]


def test_ride_brakes_within_the_bound() -> None:
    """1 km/h/s, 250 km/h selected: 0.15 to 0.6 km/h above f2E."""
    seen = run(Ride, lines(250), 12_000)
    braked = seen["brake"].index(True, 2100)
    assert 0.15 * KMH < seen["speed"][braked] - threshold(250) < 0.6 * KMH


@pytest.mark.parametrize(("lost", "brakes"), [(0, True), (100, False), (200, True)])
def test_lost_pulses_raise_the_permitted_speed(lost: int, brakes: bool) -> None:
    """At 0.8 % above the threshold: one pulse in 100 lost hides it, one in 200 does not."""
    speed = threshold(250) * 1008 // 1000 // 20
    settings = {"start": speed, "acceleration": 0, "lost_one_in": lost}
    assert run(Ride, lines(250), 6500, settings=settings, keep=["brake"])["brake"][-1] is brakes
