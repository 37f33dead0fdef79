"""The surroundings of ATS-SP supervision: a train as ghost truth, under the brakes that supervision orders.

A step is a cycle.  Without an order, driver and line do what they like.  From an order on, the train rolls `acts`
seconds at most until the brake acts, and may still gain `push` in them; then the brake takes at least b_s.  Both are
written as ways: `roll` is what is left of the way without the brake, `way` of that with it, 2 b_s way = speed^2 -
limit^2.  So every course of accelerations and decelerations within these limits is one of the motions, without a root,
a quotient or a clock.
Source: free run contains sampling, processing and build-up [A].
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple, Self

from models.ats.supervision import (
    PLACES,
    Accelerating,
    Aim,
    Asked,
    Brakes,
    Braking,
    Guard,
    NearEnd,
    NoFreeRun,
    Orders,
    strictest,
)
from models.kinematics import B_SERVICE, CYCLE, MARGIN, T_SERVICE, nearest
from models.position.odometer import Position, step_s
from safety import ANY, Bit, Model, Real, assume, parameter, point, power_up, real, require, select


class Course(NamedTuple):
    """What a train does within a cycle."""

    rolled: Real  # m without the brake
    braked: Real  # m with it
    speed: Real  # m/s at the end of the cycle
    roll: Real  # ghost: m that it would roll, from the speed read, until the brake acts
    way: Real  # ghost: m that b_s would take from there down to the limit


class Train(Model, tick_s=step_s):
    """The train's head along the line (m) and its speed (m/s)."""

    head: Real = power_up(ANY)
    speed: Real = power_up(ANY)
    roll: Real = power_up(ANY)  # m that it rolls at most until the brake acts, ordered now or before
    way: Real = power_up(ANY)  # m that the brake then takes at most
    cycle: Real = parameter(CYCLE, unit="s", within=(Fraction(1, 1000), 1), source="[A] control cycle")
    acts: Real = parameter(
        Fraction("1.9"), unit="s", within=(0, 10), source="[A] from order to brake: t_s less the cycle of sampling"
    )
    push: Real = parameter(0, unit="m/s^2", within=(0, 3), source="[A] traction that an order does not cut")

    def step(
        self, orders: Orders, course: Course, where: Position, b_s: Real, t_s: Real, limit: Real
    ) -> tuple[Train, Bit]:
        """One cycle under the orders given at its beginning, which brake down to `limit`; whether there are any."""
        require("the free run contains sampling and build-up", t_s >= self.cycle + self.acts,
                nearest("t_s", self.cycle + self.acts, "s"))  # fmt: skip
        order = orders.service | orders.emergency
        ghosts(course, where.fastest, self.push * self.acts, self.acts, b_s, limit)
        assume("no brake without an order", order | (course.braked == 0))
        assume("until the brake acts it rolls no farther", ~order | (course.rolled <= self.roll))
        roll = select(order, self.roll - course.rolled, course.roll)
        way = select(order, self.way - course.braked, course.way)
        return type(self)(head=self.head + course.rolled + course.braked, speed=course.speed, roll=roll, way=way), order


def ghosts(course: Course, v: Real, gained: Real, acts: Real, b_s: Real, limit: Real) -> None:
    """Assume that the ghosts are the ways from the speed read, and that the train runs forward."""
    assume("roll: the speed read for so long, with push", 2 * course.roll == (2 * v + gained) * acts)
    assume("way: from the speed then reached", 2 * b_s * course.way == (v + gained) * (v + gained) - limit * limit)
    assume("the train runs forward", (course.rolled >= 0) & (course.braked >= 0) & (course.speed >= 0))


class GuardRide(Model, tick_s=step_s):
    """A train under one target; other targets may ask for the brake as they like."""

    guard: Guard
    brakes: Brakes
    train: Train
    b_s: Real = parameter(B_SERVICE, unit="m/s^2", within=(Fraction(1, 10), 3), source="[A] 2.5 km/h/s")
    t_s: Real = parameter(T_SERVICE, unit="s", within=(0, 10), source="[A] free run and processing, service")
    margin: Real = parameter(MARGIN, unit="m", within=(0, 100), source="[A] m")
    place: Real = parameter(600, unit="m", within=PLACES, source="[A] line data: signal or first facing switch")
    limit: Real = parameter(0, unit="m/s", within=(0, 50), source="[A] speed to be held from there")

    def step(
        self, made: Bit, ended: Bit, where: Position, others: Asked, freed: Bit, course: Course
    ) -> tuple[Self, Bit]:
        """One cycle; whether the brake is ordered in it."""
        braking = Braking(self.b_s, self.t_s, self.b_s, self.t_s, real(0))
        aim = Aim(made, self.place, ended, self.limit, self.margin)
        guard, asked = self.guard.step(aim, where, braking)
        brakes, orders = self.brakes.step(strictest(asked, others), freed)
        train, order = self.train.step(orders, course, where, self.b_s, self.t_s, self.limit)
        return type(self)(guard=guard, brakes=brakes, train=train), point("order", order)


class NearEndRide(GuardRide, tick_s=step_s):
    """With distances from the wrong end of the interval."""

    guard: NearEnd


class NoFreeRunRide(GuardRide, tick_s=step_s):
    """With the free run left out."""

    guard: NoFreeRun


class AcceleratingRide(GuardRide, tick_s=step_s):
    """With the conservative pattern."""

    guard: Accelerating
