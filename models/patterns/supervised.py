"""A supervised train: the supervisor, the one brake that it has, and the train, in one cycle of 0.1 s.

`ServiceRun` has the service brake only, `EmergencyRun` the emergency brake only: each has to be enough.  The
surroundings choose the motion of the train, and how wide the intervals are that the supervisor is given.
"""

from __future__ import annotations

from typing import NamedTuple, Self

from models.kinematics import stops_accelerating
from models.patterns.supervisor import Lines, Seen, Supervisor
from models.patterns.train import TICK, Brake, T, Train
from safety import Bit, Model, Real, assume, select


class Errors(NamedTuple):
    """By how much each interval reaches beyond the truth, m/s and m."""

    slow: Real
    fast: Real
    near: Real
    far: Real


class Outcome(NamedTuple):
    """Lines, and ghost truth: the stop fits with the time left until the brake acts, which is within the budget."""

    lines: Lines
    fits: Bit
    budgeted: Bit


class Promised(NamedTuple):
    """What is promised of a brake and of the time before it acts."""

    b: Real
    t: Real
    a: Real


class ServiceRun(Model, tick_s=TICK):
    """The train under its service brake."""

    guard: Supervisor
    brake: Brake
    train: Train

    def step(self, reached: Real, moving: Real, errors: Errors, acknowledged: Bit) -> tuple[Self, Outcome]:
        """One cycle; the train reaches a speed, moving for so many seconds."""
        self.containing(errors)
        (b, t, a), v, x, left = self.promised(), self.train.v, self.train.x, self.brake.left
        seen = Seen(v - errors.slow, v + errors.fast, x - errors.near, x + errors.far, acknowledged)
        guard, lines = self.guard.step(seen)
        brake, acts = self.brake.step(self.line(lines), t)
        train = self.train.step(reached, moving, self.push(acts, b, a))
        outcome = Outcome(lines, stops_accelerating(v, x, b, left, a), (left >= 0) & (left <= t - T))
        return type(self)(guard=guard, brake=brake, train=train), outcome

    def promised(self) -> Promised:
        """What the supervisor relies on."""
        return Promised(self.guard.b_s, self.guard.t_s, self.guard.a)

    def line(self, lines: Lines) -> Bit:
        """The line that the brake hangs on, dropped."""
        return lines.service

    def containing(self, errors: Errors) -> None:
        """The intervals contain the truth."""
        contain(errors)

    def push(self, acts: Bit, b: Real, a: Real) -> Real:
        """The most that the train accelerates by."""
        return select(acts, -b, a)


class EmergencyRun(ServiceRun, tick_s=TICK):
    """The train under its emergency brake, the service brake having failed."""

    def promised(self) -> Promised:
        """What the supervisor relies on."""
        return Promised(self.guard.b_e, self.guard.t_e, self.guard.a)

    def line(self, lines: Lines) -> Bit:
        """The line that the brake hangs on, dropped."""
        return lines.emergency


def contain(errors: Errors) -> None:
    """Assume that intervals that reach so far contain the truth."""
    assume("the speed lies in its interval", (errors.slow >= 0) & (errors.fast >= 0))
    assume("the distance lies in its interval", (errors.near >= 0) & (errors.far >= 0))
