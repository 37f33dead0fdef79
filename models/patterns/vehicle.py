"""Speed generator, brake gear and running of the train that the equipments of `equipment` supervise.

One step is one cycle of 0.1 s.  The train runs with constant acceleration through a cycle; in the cycle in which it
comes to rest it is taken to have moved for the whole of it, 3.5 mm too far at most.
The traction is governed to the line speed.
The brake is held off by current: relay, coil and valve vent when it fails.  Full braking comes after the free run, and
until then the traction may go on.
Source: components and their failures after the fault table of the speed patterns [A]; values of the common physics [A].
"""

from __future__ import annotations

from typing import NamedTuple

from models.kinematics import ACCELERATION, B_SERVICE, CYCLE, T_SERVICE, G, mps, way_doubled
from safety import ANY, Bit, Model, Real, assume, parameter, point, power_up, real, select

LINE_SPEED = mps(100)  # m/s [A]


class Reading(NamedTuple):
    """What the speed generator tells in a cycle."""

    v: Real  # m/s
    way: Real  # m since the cycle before
    differ: Bit  # the two generators do


class Speedometer(Model, tick_s="0.1"):
    """A speed generator; where a second one is fitted, the higher reading counts and the two are compared."""

    before: Real = power_up(0)  # the reading of the cycle before, m/s

    def step(self, v: Real, second: Bit) -> tuple[Speedometer, Reading]:
        """Read the speed; the way follows from two readings."""
        first, other = point("first", v), point("second", v)
        read = select(second & (other > first), other, first)
        differ = second & (first != other)
        return type(self)(before=read), Reading(read, way_doubled(self.before, read, CYCLE) / 2, differ)


class Brake(NamedTuple):
    """What the brake gear shows."""

    on: Bit  # vented
    acting: Bit  # the free run is over
    valve_fails: Bit  # no current and not vented
    weak: Bit  # less than the guaranteed deceleration was measured


class Vehicle(Model, tick_s="0.1"):
    """A train on a constant gradient: speed, distance to go to the protected point (below 0: beyond it), brake gear."""

    v: Real = power_up(ANY)
    x: Real = power_up(ANY)
    building: Real = power_up(0)  # s for which the brake has been building up, of the free run
    acted: Bit = power_up(False)  # it acted in the cycle before
    gradient: Real = parameter(0, unit="permille", within=(-20, 20), source="[A] uphill positive")

    def step(self, held_off: Bit, drive: Real, read: Reading, before: Real, fitted: Bit) -> tuple[Vehicle, Brake]:
        """Run for a cycle with the acceleration that the driver gives, unless the brake is acting."""
        current = point("coil", point("relay", held_off))
        vented = point("vent", ~current)
        on = vented | (fitted & point("second_vent", ~current))
        acting = on & (self.building > T_SERVICE - CYCLE)  # whole cycles: at T_SERVICE
        force = point("force", real(B_SERVICE)) + self.gradient * G / 1000
        reached = self.v + select(acting, -force, drive) * CYCLE
        reached = select(reached < 0, real(0), select(reached > LINE_SPEED, real(LINE_SPEED), reached))
        assume("accelerates by 0.8 m/s^2 at most", drive <= ACCELERATION)
        longer = self.building + CYCLE
        building = select(on, select(longer < T_SERVICE, longer, real(T_SERVICE)), real(0))
        weak = self.acted & (read.v > 0) & (before - read.v < self.guaranteed * CYCLE)
        x = self.x - way_doubled(self.v, reached, CYCLE) / 2
        return type(self)(v=reached, x=x, building=building, acted=acting), Brake(on, acting, ~current & ~vented, weak)

    @property
    def guaranteed(self) -> Real:
        """The deceleration on this gradient of a brake in order, m/s^2."""
        return self.gradient * G / 1000 + B_SERVICE
