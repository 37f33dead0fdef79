"""A train, its wheel and the odometer, as a bench: what is true beside what the odometer believes.

The surroundings choose the acceleration, the speed that the wheel shows, and whether it spins, slides or grips; the
claims say what they must not do.  `raw` is the plain count of the wheel's way.
"""

from __future__ import annotations

from typing import NamedTuple, Self

from models.position.odometer import Fix, Odometer, RememberingOdometer, larger, step_s
from safety import Bit, Model, Real, assume, power_up, real


class Surroundings(NamedTuple):
    """What happens in a cycle."""

    gain: Real  # m/s^2, between the mean speeds of the last cycle and of this one; no speed below 0
    wheel: Real  # m/s, mean speed that the pulses show
    spins: Bit  # the wheel may turn faster than the train
    slides: Bit  # the wheel may turn slower than the train


class Limits(NamedTuple):
    """Which limits of the odometer's parameters the surroundings keep."""

    gains: Bit  # at most a_hi
    loses: Bit  # at most b_hi
    under: Bit  # the wheel shows at most eps too little
    over: Bit  # the wheel shows at most eps too much


class Truth(NamedTuple):
    """What is true of a cycle."""

    now: Real  # mean speed over it, m/s
    least: Real  # speed at its end, with all its braking at its end, m/s
    most: Real  # the same with all its gain there
    there: Real  # position of the head at its end, m
    counted: Real  # the plain count at its end, m
    kept: Limits


class Travelled(NamedTuple):
    """What is true before a cycle: way m, mean speed of the last cycle m/s, plain count m."""

    way: Real
    speed: Real
    raw: Real


def travelled(known: Odometer, before: Travelled, at: Surroundings) -> Truth:
    """A cycle as the surroundings choose it."""
    assume("the pulses have no sign", at.wheel >= 0)
    cycle, off = known.cycle, at.wheel * known.eps
    now = larger(real(0), before.speed + at.gain * cycle)
    kept = Limits(at.gain <= known.a_hi, -at.gain <= known.b_hi, now <= at.wheel + off, at.wheel - off <= now)
    least, most = now - known.b_hi * cycle, now + known.a_hi * cycle
    return Truth(now, least, most, before.way + now * cycle, before.raw + at.wheel * cycle, kept)


class Ride(Model, tick_s=step_s):
    """Train, wheel and odometer."""

    odometer: Odometer
    way: Real = power_up(0)  # true position of the head, m
    speed: Real = power_up(0)  # true mean speed over the last cycle, m/s
    raw: Real = power_up(0)  # way by the plain count, m

    def step(self, at: Surroundings, fix: Fix) -> tuple[Self, Truth]:
        """One cycle, with what is told before it of the place."""
        true = travelled(self.odometer, Travelled(self.way, self.speed, self.raw), at)
        odometer, _ = self.odometer.step(at.wheel, fix)
        return type(self)(odometer=odometer, way=true.there, speed=true.now, raw=true.counted), true


class RememberingRide(Ride, tick_s=step_s):
    """The same with the odometer that keeps the highest speed seen in a slide."""

    odometer: RememberingOdometer
