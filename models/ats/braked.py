"""Supervision of a signal down to the wheel: line data, patterns, output unit, relay and brake of one train.

The train is that of radio control, so it moves as it can: traction may go on through the free run, which the
conservative pattern allows for.
Source: components [P]; one relay, one force of the brake [A].
"""

from __future__ import annotations

from typing import Self

from models.ats.supervision import Accelerating, Aim, Asked, Brakes, Braking, strictest
from models.kinematics import CYCLE, MARGIN
from models.position.odometer import Position, step_s
from models.radio.train import Motion, SetBack, Train
from safety import Bit, Model, Real, bit, parameter, point, real

STATE = ("head", "speed", "rear", "furthest", "left", "parted")


class Vehicle(Train, tick_s=step_s):
    """The train of radio control; its cycle is that of the patterns."""

    def step(self, brake: Bit, order: SetBack, motion: Motion) -> Self:
        """One cycle."""
        moved = super().step(brake, order, motion)
        return type(self)(**{name: getattr(moved, name) for name in STATE})


class Braked(Model, tick_s=step_s):
    """One target, the brakes, and the train under them."""

    guard: Accelerating
    brakes: Brakes
    train: Vehicle
    place: Real = parameter(600, unit="m", within=(-10_000, 10_000), source="[A] line data: signal")
    margin: Real = parameter(MARGIN, unit="m", within=(0, 100), source="[A] m")

    def step(
        self, made: Bit, ended: Bit, where: Position, others: Asked, freed: Bit, motion: Motion
    ) -> tuple[Self, Bit]:
        """One cycle; whether its brake is applied to the train in it."""
        train, never = self.train, SetBack(bit(False), real(0))
        reaction = train.free_run + 2 * CYCLE  # this cycle, free run, rest of the cycle it ends in
        braking = Braking(train.b, reaction, train.b, reaction, real(0))
        guard, asked = self.guard.step(Aim(made, self.place, ended, real(0), self.margin), where, braking)
        brakes, orders = self.brakes.step(strictest(asked, others), freed)
        held_off = point("relay", point("io_unit", ~(orders.service | orders.emergency)))
        following = type(self)(guard=guard, brakes=brakes, train=train.step(~held_off, never, motion))
        return following, ~held_off
