"""Axle, speed generator and odometer under a train that rolls between two balises: the position's part of the table.

Nothing but the axle's faults comes between the train's speed and the speed that the wheel shows.
Source: components [P]; parameters [A].
"""

from __future__ import annotations

from typing import NamedTuple

from models.ats.stretch import Axle
from models.position.odometer import Fix, Odometer, Position, SpeedGenerator, larger, step_s
from safety import Bit, Model, Real, power_up, real


class Rolled(NamedTuple):
    """What is true at the end of a cycle, beside what is believed."""

    there: Real  # head, m
    most: Real  # m/s, with all that the train may gain at the end of the cycle
    beyond: Bit  # the head is beyond s_hi, or the train faster than v_hi
    behind: Bit  # the head is behind s_lo


class Rolling(Model, tick_s=step_s):
    """The train, and what measures its way."""

    axle: Axle
    generator: SpeedGenerator
    odometer: Odometer
    way: Real = power_up(0)  # true position of the head, m
    speed: Real = power_up(0)  # true mean speed over the last cycle, m/s

    def step(self, gain: Real, fix: Fix) -> tuple[Rolling, Rolled]:
        """One cycle: m/s^2 that the train gains; what is told before it of the place."""
        cycle = self.odometer.cycle
        now = larger(real(0), self.speed + gain * cycle)
        axle, counted = self.axle.step(now, real(0))
        generator, wheel = self.generator.step(counted.pulses)
        odometer, position = self.odometer.step(wheel, fix)
        there, most = self.way + now * cycle, now + self.odometer.a_hi * cycle
        following = type(self)(axle=axle, generator=generator, odometer=odometer, way=there, speed=now)
        return following, Rolled(there, most, beyond(there, most, position), there < position.low)


def beyond(there: Real, fastest: Real, position: Position) -> Bit:
    """Farther or faster than supervision reckons with."""
    return (there > position.high) | (fastest > position.fastest)
