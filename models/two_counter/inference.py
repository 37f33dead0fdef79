"""Two-counter ATC: what the printed tables let one infer, by exact arithmetic: presets, counting time, common errors.

Times s, frequencies Hz, pulses half-integers (edges whole).  Each function uses the printed columns alone.
Source: tables 2(A), 2(B), brake test of section 6.1 [P]; the rest [D].

Main results: with a counter of 11 bits the seven frequencies leave one set of presets and Tc within 0.9 us; one crystal
error of -102 ppm explains all seven static errors; the theory column of table 2(B) has four pulses of preparation.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import permutations
from math import ceil, floor

from models.two_counter.numbers import (
    BRAKE_TEST_HZ,
    BRAKE_TEST_SIGNAL_HZ,
    BRAKE_TEST_SPEED,
    CHECK_SPEEDS,
    COUNTING_S,
    DYNAMIC,
    OSCILLATOR_SCALE,
    PRESETS,
    STATIC,
    half_unit,
    pulses,
    threshold_hz,
)
from models.two_counter.theory import HALF, Interval, counts

CAPACITY = 2047  # edges, counter 2 of 11 bits [A]
DIVIDED = 8  # the oscillator of the static test by the speed signal
SUSPECT = 30  # the row of table 2(B) whose theory value is misprinted


def window_of(row_theory: str, edges: int) -> Interval:
    """Counting times with which a preset of some edges gives the printed frequency."""
    frequency, half = Fraction(row_theory), half_unit(row_theory)
    return Interval(edges * HALF / (frequency + half), edges * HALF / (frequency - half))


def counting_time_range(presets: Sequence[int] = PRESETS) -> Interval:
    """Counting times that fit all seven theoretical frequencies; ValueError if none does."""
    windows = [window_of(row.theory, m) for row, m in zip(STATIC, presets, strict=True)]
    found = Interval(max(w.low for w in windows), min(w.high for w in windows))
    if found.low > found.high:
        raise ValueError(f"no counting time fits the presets {tuple(presets)}")
    return found


def possible_presets(capacity: int = CAPACITY) -> list[tuple[int, ...]]:
    """All sets of whole edges, up to a counter's capacity, that with one counting time give the seven frequencies."""
    found: list[tuple[int, ...]] = []

    def extend(chosen: tuple[int, ...], low: Fraction, high: Fraction) -> None:
        left = len(STATIC) - len(chosen)
        if not left:
            found.append(chosen)
            return
        theory = STATIC[left - 1].theory
        least, most = Fraction(theory) - half_unit(theory), Fraction(theory) + half_unit(theory)
        for edges in range(max(1, ceil(2 * low * least)), min(floor(2 * high * most), capacity) + 1):
            window = window_of(theory, edges)
            if max(low, window.low) <= min(high, window.high):
                extend((edges, *chosen), max(low, window.low), min(high, window.high))

    extend((), Fraction(0), Fraction(capacity))
    return found


def slopes() -> Interval:
    """Open range of s for which some c gives n2E = floor(s V + c) + 1/2 in all rows.

    The c that a row leaves are [n - s V, n + 1 - s V); intervals of a line meet if every two do.
    """
    rows = [(v, pulses(v) - HALF) for v in CHECK_SPEEDS]
    pairs = [(v - u, n - m) for (v, n), (u, m) in permutations(rows, 2) if v > u]
    return Interval(max((n - 1) / v for v, n in pairs), min((n + 1) / v for v, n in pairs))


def measured_counting_times() -> list[Fraction]:
    """By row of table 2(A): the counting time with which the measured oscillator frequency meets the preset."""
    return [pulses(row.speed) * DIVIDED / (int(row.oscillator) * OSCILLATOR_SCALE) for row in STATIC]


def crystal_error() -> Fraction:
    """The one relative error of the oscillator that explains the mean of the measured counting times."""
    times = measured_counting_times()
    return COUNTING_S / (sum(times, Fraction(0)) / len(times)) - 1


def least_squares(points: Sequence[tuple[Fraction, Fraction]]) -> tuple[Fraction, Fraction]:
    """(a, b) of y = a + b x with the least sum of squares, exact; ValueError for fewer than two different x."""
    n, sx, sy = len(points), sum(x for x, _ in points), sum(y for _, y in points)
    sxx, sxy = sum(x * x for x, _ in points), sum(x * y for x, y in points)
    if n * sxx == sx * sx:
        raise ValueError(f"{n} points at one place: no line")
    b = Fraction(n * sxy - sx * sy) / (n * sxx - sx * sx)
    return (sy - b * sx) / n, b


def preparation_pulses() -> tuple[Fraction, Fraction]:
    """(a, pulses) of theory = a + pulses / f2E, without the misprinted row of table 2(B)."""
    rows = [row for row in DYNAMIC if row.speed != SUSPECT]
    return least_squares([(1 / threshold_hz(row.speed), Fraction(row.theory)) for row in rows])


def decisive_count_range() -> Interval:
    """n1F, above low and up to high: the brake test of 6.1 brakes at the one and releases at the other."""
    seen = {name: counts(hz, pulses(BRAKE_TEST_SPEED), BRAKE_TEST_SIGNAL_HZ) for name, hz in BRAKE_TEST_HZ.items()}
    return Interval(seen["brake"], seen["release"])


def subtracted() -> Iterator[tuple[int, Fraction]]:
    """By row of table 2(B): measured time less measured error, T''c / 2 where both are printed right."""
    return ((row.speed, Fraction(row.time) - Fraction(row.measured)) for row in DYNAMIC)
