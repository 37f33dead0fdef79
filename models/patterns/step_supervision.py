"""Speed-step supervision: a constant limit from each indication to the next, by track current or by balises.

Where the supervision steps down is fixed by the ground, so each section is as long as the worst-braked train needs.
`Sections` takes a section as one step (the induction over sections), the receivers take a cycle of 0.1 s.
Source: speed-step supervision (section 2.2) and properties SP-S1, SP-S2, SP-C1, SP-H1; ladder, worst train [A].

Main results: ladder 100/65/45/25/0 needs 825.0 m for a train of 2.0 km/h/s, where one pattern needs 750.0 m, and
518.5 m for a train of 3.0; a last step above 0 needs an overlap.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import NamedTuple, Self

from models.kinematics import KMH, T_SERVICE, at_least, distance, effective, mps, need, refuse
from models.patterns.train import TICK
from safety import ANY, Bit, Model, Real, assume, parameter, point, power_up, select

LADDER = (100, 65, 45, 25, 0)  # km/h [A]
WORST = 2 * KMH  # m/s^2, the worst-braked train that is admitted [A]


def sections(
    ladder: Sequence[int] = LADDER, b: Fraction = WORST, t: Fraction = T_SERVICE, downgrade: Fraction | int = 0
) -> list[Fraction]:
    """Shortest sections, m, in which a train slows from each step to the next, on gradients down to `downgrade`."""
    braking = effective(b, downgrade)
    return [distance(mps(above), braking, t, mps(below)) for above, below in pairwise(ladder)]


def check_sections(
    lengths: Sequence[Fraction | int], ladder: Sequence[int] = LADDER, b: Fraction = WORST, t: Fraction = T_SERVICE
) -> None:
    """Refuse a ladder with a section that is too short for the worst train; ModelError with the least length."""
    least = sections(ladder, b, t)
    if len(lengths) != len(least):
        refuse("number of sections", len(lengths), "", f"the ladder has {len(ladder)} speeds", f"{len(least)}")
    for (above, below), length, needed in zip(pairwise(ladder), lengths, least, strict=True):
        if length < needed:
            refuse(f"section {above} to {below} km/h", length, "m", "too short for the worst-braked train",
                   f"{at_least(needed)} m")  # fmt: skip


def overlap(last: int, b: Fraction, t: Fraction) -> Fraction:
    """Way behind a signal, m, that a train needs which reaches it at the last step, km/h, and then brakes."""
    found: Fraction = distance(mps(last), b, t)
    return found


class Sections(Model, event="section"):
    """A train through sections, each with its limit; a step is a section.

    `entry` is the speed at which it enters, `before` the limit of the section before.
    """

    entry: Real = power_up(ANY)  # m/s
    before: Real = power_up(ANY)  # m/s, limit of the section before
    b: Real = parameter(WORST, unit="m/s^2", within=(Fraction("0.3"), Fraction("1.5")), source="[A] worst train")
    t: Real = parameter(T_SERVICE, unit="s", within=(0, 10), source="[A] free run")

    def step(self, limit: Real, length: Real, leaving: Real) -> tuple[Self, Bit]:
        """A section with its limit and length, left at a speed; whether its limit was exceeded on leaving."""
        assume("speeds are from 0 up", (limit >= 0) & (leaving >= 0) & (length >= 0))
        self.laid(limit, length)
        assume("no traction at or above the limit: who leaves above it has braked all the way",
               (leaving <= limit) | self.braked(leaving, length))  # fmt: skip
        return type(self)(entry=leaving, before=limit), leaving > limit

    def laid(self, limit: Real, length: Real) -> None:
        """The section is long enough to slow down from the limit before."""
        assume("the section is long enough for the worst-braked train",
               need(self.before, self.b, self.t, limit) <= 2 * self.b * length)  # fmt: skip

    def braked(self, leaving: Real, length: Real) -> Bit:
        """Free run at the entry speed, then at least b: leaving^2 <= entry^2 - 2 b (length - entry t)."""
        return leaving * leaving <= self.entry * self.entry - 2 * self.b * (length - self.entry * self.t)


class ShortSections(Sections, event="section"):
    """Sections of any length."""

    def laid(self, limit: Real, length: Real) -> None:
        """Nothing is promised."""


class WeakTrain(Sections, event="section"):
    """A train that gives nine tenths of the worst train's deceleration."""

    def braked(self, leaving: Real, length: Real) -> Bit:
        """Not at least b."""
        return leaving * leaving <= self.entry * self.entry - self.b * 9 / 5 * (length - self.entry * self.t)


class SlowTrain(Sections, event="section"):
    """A train whose brake takes half a second longer."""

    def braked(self, leaving: Real, length: Real) -> Bit:
        """A longer free run."""
        run = self.entry * (self.t + Fraction(1, 2))
        return leaving * leaving <= self.entry * self.entry - 2 * self.b * (length - run)


class Traction(Sections, event="section"):
    """A train that may accelerate by 0.8 m/s^2 [A] at or above the limit until the brake acts."""

    def braked(self, leaving: Real, length: Real) -> Bit:
        """It may have passed the limit within the free run before the section's end."""
        return super().braked(leaving, length) | (leaving <= self.entry + Fraction("0.8") * self.t)


class Limit(NamedTuple):
    """The limit in force, and whether the brake is asked for."""

    limit: Real
    brake: Bit


class Continuous(Model, tick_s=TICK):
    """Receiver of track current: of two receptions in a row the lower one counts; no current is speed 0 [A]."""

    last: Real = power_up(0)  # m/s, received in the cycle before

    def step(self, aspect: Real, current: Bit, v: Real) -> tuple[Self, Limit]:
        """One cycle: the section's speed, whether its current arrives, the train's speed; all m/s."""
        assume("an aspect is a speed from 0 up", aspect >= 0)
        received = point("received", select(current, aspect, 0))
        limit = point("limit", select(received < self.last, received, self.last))
        return type(self)(last=received), Limit(self.in_force(limit, received), v > self.in_force(limit, received))

    def in_force(self, limit: Real, received: Real) -> Real:
        """The lower of both receptions."""
        return limit


class HoldsLast(Continuous, tick_s=TICK):
    """Slip: without current the limit before stays."""

    def in_force(self, limit: Real, received: Real) -> Real:
        """What was received last, if anything is."""
        return select(received > 0, limit, self.last)


class Balises(Model, tick_s=TICK):
    """Receiver of balises: the limit stays until the next one, whatever happens in between."""

    held: Real = power_up(0)  # m/s

    def step(self, aspect: Real, balise: Bit, v: Real) -> tuple[Balises, Limit]:
        """One cycle: the speed that the ground shows, whether a balise is passed, the train's speed."""
        limit = select(point("read", balise), aspect, self.held)
        return type(self)(held=limit), Limit(limit, v > limit)
