"""Spacing of the ground markers: the least distances and the greatest level that are safe, as numbers.

Speeds m/s, distances m before the signal, gradient permille, uphill positive.
Source: points and levels, spacing stretched with the gradient [P]; dimensioning [A], as the paper gives no numbers.

Main results: v4max = 30.633 km/h, A = 74.677 km/h, x1, x2, x3 = 910.279, 608.980, 349.168 m.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor

from models.kinematics import (
    B_EMERGENCY,
    B_SERVICE,
    KMH,
    T_EMERGENCY,
    T_SERVICE,
    Interval,
    Quantity,
    at_least,
    at_most,
    ceiling,
    distance,
    effective,
    refuse,
    root,
)

TOP, STOP_BEFORE, RELEASE = 100 * KMH, Fraction(50), 30 * KMH  # Vmax, l, B [A]
GRAIN = 10**6  # parts of a m or m/s to which markers are laid and levels set [A]


@dataclass(frozen=True)
class Line:
    """What the spacing follows from, and the brakes there.

    Raises ModelError where B is above v4max or no stop is possible, with the nearest admissible value.
    """

    top: Fraction = TOP
    stop_before: Fraction = STOP_BEFORE
    b: Fraction = RELEASE
    gradient: Fraction | int = 0  # the spacing is stretched by it
    free_run: bool = True  # of the brake at point 2; the drawing has none

    def __post_init__(self) -> None:
        emergency, fastest = self.brakes[1], self.fastest
        if self.b > fastest.low:
            longer = distance(self.b, emergency, T_EMERGENCY)
            nearest = f"{at_most(fastest.low / KMH)} km/h, or l = {at_least(longer)} m"
            refuse("B", self.b / KMH, "km/h", "above v4max, from which the emergency brake still stops", nearest)
        if self.top < fastest.high:
            nearest = f"{at_least(fastest.high / KMH)} km/h"
            refuse("Vmax", self.top / KMH, "km/h", "below v4max: point 4 alone will do", nearest)

    @property
    def brakes(self) -> tuple[Fraction, Fraction]:
        """Deceleration of service and emergency brake on the gradient, m/s^2."""
        return Fraction(effective(B_SERVICE, self.gradient)), Fraction(effective(B_EMERGENCY, self.gradient))

    @property
    def fastest(self) -> Interval:
        """v4max: the fastest at 4 from which the emergency brake still stops before the signal."""
        return ceiling(self.stop_before, self.brakes[1], T_EMERGENCY)


class Scheme(Line):
    """The spacing, as enclosures of the exact values."""

    @property
    def x2(self) -> Interval:
        """Point 2: the service brake suffices from Vmax."""
        return Interval(_point_2(self, self.fastest.high), _point_2(self, self.fastest.low))

    @property
    def a(self) -> Interval:
        """A: the driver's curve that meets B at 3 meets A at 2."""
        return Interval(
            _level(self, self.fastest.low, self.x2.low).low, _level(self, self.fastest.high, self.x2.high).high
        )

    @property
    def x3(self) -> Interval:
        """Point 3: the service brake suffices from A."""
        return Interval(_ahead(self, self.a.low, self.fastest.high), _ahead(self, self.a.high, self.fastest.low))

    @property
    def x1(self) -> Interval:
        """Point 1: a driver who brakes there is at B at 3."""
        return self.x3.shifted(distance(self.top, self.brakes[0], T_SERVICE, self.b))

    def settings(self) -> dict[str, Fraction]:
        """Parameters of `Markers`: points laid and levels set one after the other, each rounded to the safe side."""
        fastest = Fraction(floor(self.fastest.low * GRAIN), GRAIN)
        x2 = Fraction(ceil(_point_2(self, fastest) * GRAIN), GRAIN)
        a = Fraction(floor(_level(self, fastest, x2).low * GRAIN), GRAIN)
        x3 = Fraction(ceil(_ahead(self, a, fastest) * GRAIN), GRAIN)
        laid = {"top": self.top, "stop_before": self.stop_before, "level_b": self.b, "fastest": fastest, "level_a": a}
        return laid | {"x2": x2, "x3": x3} | dict(zip(("b_service", "b_emergency"), self.brakes, strict=True))


def _point_2(line: Line, reached: Fraction) -> Fraction:
    """Where the service brake has to be ordered from Vmax; as drawn, the standard curve down to 0."""
    if line.free_run:
        return _ahead(line, line.top, reached)
    return line.stop_before + Fraction(distance(line.top, line.brakes[0], 0))


def _ahead(line: Line, level: Fraction, reached: Fraction) -> Fraction:
    """Where the service brake has to be ordered to be at a speed at point 4."""
    return line.stop_before + Fraction(distance(level, line.brakes[0], T_SERVICE, reached))


def _level(line: Line, reached: Fraction, x2: Fraction) -> Interval:
    """A from 2 A^2 + 2 b_s t_s A = B^2 + v4max^2 + 2 b_s (x2 - l)."""
    half = line.brakes[0] * T_SERVICE / 2
    ahead = (line.b * line.b + reached * reached) / 2 + line.brakes[0] * (x2 - line.stop_before)
    return root(half * half + ahead).shifted(-half)


AS_DIMENSIONED, DRAWN = Scheme().settings(), Scheme(free_run=False).settings()


def overrun(v: Quantity, stop_before: Quantity = STOP_BEFORE) -> Quantity:
    """How far beyond the signal (below 0: before it) the emergency brake at 4 stops a train, m; plain form."""
    return distance(v, B_EMERGENCY, T_EMERGENCY) - stop_before


def way_with_service_brake_on(v: Quantity) -> Quantity:
    """Way from 4 to the stop if the service brake goes on acting during the free run of the emergency brake, m."""
    left = v - B_SERVICE * T_EMERGENCY
    return (v + left) * T_EMERGENCY / 2 + left * left / (2 * B_EMERGENCY)
