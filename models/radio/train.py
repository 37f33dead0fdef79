"""Radio control: a train as it moves, whatever its driver does.

Within a cycle it comes `way` forward and has the speed `reached` at the end.  Any motion with at most the acceleration
`a`, not only a uniform one, keeps `reached <= v + a T` and `way <= v T + a T^2 / 2`; a brake of at least `b` all the
time takes at least 2 b way from v^2.  After a demand the brake needs its free run; until then nothing is assumed of it.
What no such motion is, is taken as a stop at once, which a
brake of at least b may give.  R4: the rear comes back no further than `roll_back` from where it has been.
Head and rear are the ends of the interval that surely holds the train, as the measured position gives it.
Source: speed patterns, common physics [D]; rule R4 [P] section 9; a coupling that breaks, setting back [A].
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from models.kinematics import ACCELERATION, B_SERVICE, CYCLE, T_SERVICE
from safety import ANY, Bit, Model, Real, parameter, point, power_up, select


class Motion(NamedTuple):
    """What driver, gradient and couplings do in a cycle."""

    way: Real
    reached: Real
    back: Real  # m rolled back
    parts: Bit  # a coupling breaks

    def possible(self, v: Real, a: Real, b: Real, braked: Bit) -> tuple[Real, Real]:
        """Way and speed at the end, from the speed v; a stop at once where the choice is none that a train has."""
        forward = (self.way >= 0) & (self.reached >= 0)
        pulled = (self.reached <= v + a * CYCLE) & (self.way <= v * CYCLE + a * (CYCLE * CYCLE / 2))
        slowed = (self.reached <= v) & (self.reached * self.reached + 2 * b * self.way <= v * v)
        chosen = forward & pulled & (~braked | slowed)
        return select(chosen, self.way, 0), select(chosen, self.reached, 0)


class SetBack(NamedTuple):
    """An order to set back until the rear stands at a place."""

    ordered: Bit
    place: Real


class Reading(NamedTuple):
    """What the unit on board reads, and what it has been told of its train."""

    head: Real
    speed: Real
    b: Real
    a: Real
    free_run: Real


class Train(Model, tick_s=CYCLE):
    """Head, rear and speed; `furthest` is how far the rear has been, `left` what is left of the reaction time.

    When a coupling breaks the rear stays behind.  Setting back is one step: what happens in between is not looked at.
    """

    head: Real = power_up(ANY)
    speed: Real = power_up(ANY)
    rear: Real = power_up(ANY)
    furthest: Real = power_up(ANY)
    left: Real = power_up(ANY)
    parted: Bit = power_up(False)

    length: Real = parameter(200, unit="m", within=(1, 1000), source="[A] length of the train")
    b: Real = parameter(B_SERVICE, unit="m/s^2", within=(Fraction("0.1"), 3), source="[A] service brake at least")
    a: Real = parameter(ACCELERATION, unit="m/s^2", within=(0, 3), source="[A] greatest acceleration")
    free_run: Real = parameter(T_SERVICE, unit="s", within=(0, 10), source="[A] free run of the service brake")
    roll_back: Real = parameter(0, unit="m", within=(0, 100), source="[A] how far the rear comes back at most")

    def step(self, brake: Bit, order: SetBack, motion: Motion) -> Train:
        """One cycle."""
        acts = point("brake_acts", brake & (self.left < CYCLE))
        way, reached = motion.possible(self.speed, self.a, point("brake_force", self.b), acts)
        parted = self.parted | motion.parts
        sets_back = order.ordered & ~parted & (order.place <= self.rear)
        moved = rolled(select(parted, self.rear, self.rear + way), motion.back, self.furthest - self.roll_back)
        rear = select(sets_back, order.place, moved)
        return Train(
            head=self.head + select(parted, way, rear - self.rear), rear=rear, parted=parted,
            furthest=select(sets_back, order.place, select(rear > self.furthest, rear, self.furthest)),
            speed=select(sets_back, 0, reached), left=left_after(brake, self.left, self.free_run + CYCLE),
        )  # fmt: skip


def rolled(rear: Real, back: Real, lowest: Real) -> Real:
    """A rear that rolls back, unless that is below the lowest place or forward."""
    return rear - select((back >= 0) & (rear - back >= lowest), back, 0)


def left_after(brake: Bit, left: Real, whole: Real) -> Real:
    """What is left of the reaction time after a cycle: all of it as long as nothing is demanded."""
    return select(brake, select(left >= CYCLE, left - CYCLE, 0), whole)


def read(train: Train) -> Reading:
    """A train as its unit reads it."""
    return Reading(train.head, train.speed, train.b, train.a, train.free_run)
