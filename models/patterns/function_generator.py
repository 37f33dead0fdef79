"""Brake-start control with a function generator: infinitely many markers, and one curve for each gradient bin.

Point 1 starts the generator, which gives the speed of the standard curve for the distance left; when the train's speed
equals it, the brake is applied once, with constant force, and nothing corrects it afterwards.  A signal from the ground
selects one of five curves for gradients of +-20 permille, each for a bin of 8.  One step is one comparison.
The line that prevents braking is held: de-energised brakes.
Source: principle, +-20 permille in five curves, about +-25 m [P]; deceleration, equal bins [A].

Main results: +-25 m from 100 km/h in all bins for 3.4374 km/h/s and more; 35.11 m at 3.0; with one curve the stops
spread by 230.7 m there, by 100 m and more up to 4.4846 km/h/s.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from models.kinematics import KMH, Exact, G, Interval, Quantity, distance, effective, root
from safety import Bit, Model, Real, any_of, assume, parameter, point, power_up, require

STEEPEST, BINS = 20, 5  # permille, curves [P]
WIDTH = Fraction(2 * STEEPEST, BINS)  # permille, of a bin
CENTRES = tuple(WIDTH * k for k in range(-(BINS // 2), BINS // 2 + 1))
FROM = 100 * KMH  # m/s [P]
GUARANTEED = Fraction("3.5") * KMH  # m/s^2 [A]


class Started(NamedTuple):
    """What a comparison gives."""

    brake: Bit
    now: Bit  # the brake is applied in this step


class BrakeStart(Model, event="comparison of speed and curve"):
    """Gradient selector, generator, comparator and brake; the surroundings choose when they are looked at."""

    running: Bit = power_up(False)
    braking: Bit = power_up(False)
    level: Real = parameter(GUARANTEED, unit="m/s^2", within=(Fraction(1, 10), 3), source="[A] deceleration, level")
    gradient: Real = parameter(0, unit="permille", within=(-100, 100), source="[P] up to 20, uphill positive")

    def step(self, v: Real, x: Real, at_point_1: Bit, ground: Real) -> tuple[BrakeStart, Started]:
        """Speed, distance left to the stop, whether point 1 is passed, centre of the bin as the ground signals it."""
        bins = (self.gradient <= STEEPEST) & (self.gradient >= -STEEPEST)
        require("no bin for the gradient", bins, "the nearest admissible values are -20 and 20 permille")
        stops = effective(self.level, self.gradient) > 0
        require("no stop is possible", stops, "the nearest admissible deceleration is above g times the downgrade")
        assume("runs towards the stop", (v >= 0) & (x >= 0))
        assume("one of the five bins", any_of(*(ground == centre for centre in CENTRES)))
        running = self.running | at_point_1
        curve = point("generator", effective(self.level, point("gradient_selector", ground)))
        speed = point("speed_generator", v)
        reached = point("comparator", running & (speed * speed >= 2 * curve * x))
        brake = ~point("valve", ~(reached | self.braking))
        return type(self)(running=running, braking=brake), Started(brake, brake & ~self.braking)


# --- numbers ---------------------------------------------------------------------------------------------------------


def deviation(b: Quantity, centre: Exact, rho: Quantity = 0, v: Quantity = FROM) -> tuple[Quantity, Quantity]:
    """Greatest overrun and greatest falling short in the bin of a centre, m, from a speed; level deceleration m/s^2."""
    half = WIDTH / 2
    stops = [distance(v, effective(b, i, rho), 0) for i in (centre - half, centre, centre + half)]
    return stops[0] - stops[1], stops[1] - stops[2]


def spread(b: Quantity, steepest: Quantity = STEEPEST, rho: Quantity = 0, v: Quantity = FROM) -> Quantity:
    """Total spread of the stops with one curve, gradients up to `steepest` either way, m."""
    return distance(v, effective(b, -steepest, rho), 0) - distance(v, effective(b, steepest, rho), 0)


def least_level(centre: Exact, off: Exact = 25, rho: Exact = 0, v: Exact = FROM) -> Interval:
    """The least level deceleration with which no stop of the bin is more than `off` m too long, m/s^2."""
    half = added(WIDTH / 2, rho)
    middle = root(half * half / 4 + Fraction(v * v) * half / (2 * off)).shifted(half / 2)
    return middle.shifted(-added(centre, rho))


def level_of_spread(total: Exact, rho: Exact = 0, v: Exact = FROM) -> Interval:
    """The level deceleration at which the stops with one curve, +-20 permille, spread by so much, m/s^2.

    Bins that share the spread equally, each with its curve in the middle, leave +- a tenth of it.
    """
    steepest = added(STEEPEST, rho)
    return root(steepest * steepest + Fraction(v * v) * steepest / total)


def gradient_of_spread(total: Exact, b: Exact, v: Exact = FROM) -> Interval:
    """The gradient at which the stops with one curve spread by so much, permille either way."""
    squared = Fraction(v * v)
    slope = root(squared * squared + 4 * Fraction(total * total) * b * b).shifted(-squared)
    return slope.scaled(1 / (2 * Fraction(total)) * 1000 / G)


def added(i: Exact, rho: Exact) -> Fraction:
    """What a gradient adds to the deceleration, m/s^2."""
    return Fraction(G * i) / (1000 * (1 + rho))
