"""Supervision as it must not be: the variants that proofs refute.

A blind target that is kept as a place is lifted by the next fix of the position, one that a later stop replaces moves
on; ending before making loses a stop that is read with a release; a turnout's limit from the balise on is too early.
"""

from __future__ import annotations

from typing import Self

from models.ats.supervision import BlindGuard, Demand, Guard, Supervision, Target, WayLeft
from models.position.odometer import Position, step_s
from safety import Bit, Real, point, power_up, select


class MovesOn(WayLeft, tick_s=step_s):
    """The variant to be refuted: one that is made later replaces the one that there is."""

    def counts(self, shortest: Real) -> Bit:
        """Always."""
        return self.active | ~self.active


class AtAPlace(WayLeft, tick_s=step_s):
    """The variant to be refuted: a place is kept, though the position is not known."""

    place: Real = power_up(0)  # m

    def step(self, made: Bit, shortest: Real, ended: Bit, where: Position) -> tuple[Self, Demand]:
        """One cycle: what is left from the far end, wherever that is now said to be."""
        on = point("pattern", made | (self.active & ~ended))
        place = select(made & self.counts(shortest), where.high + shortest, self.place)
        left = point("left", place - where.high)
        return type(self)(active=on, rest=left, place=place), Demand(on, left)


class EndsFirst(Target, tick_s=step_s):
    """The variant to be refuted: what ends a target goes before what makes it."""

    def step(self, made: Bit, place: Real, ended: Bit) -> tuple[Target, Demand]:
        """One cycle."""
        return super().step(made & ~ended, place, ended)


class EndsFirstGuard(Guard, tick_s=step_s):
    """With that target."""

    target: EndsFirst


class EndingGoesFirst(Supervision, tick_s=step_s):
    """With the variant for the home signal."""

    home: EndsFirstGuard


class BlindMovesOnGuard(BlindGuard, tick_s=step_s):
    """With the blind target that a later one replaces."""

    target: MovesOn


class BlindMovesOn(Supervision, tick_s=step_s):
    """With that guard."""

    blind: BlindMovesOnGuard


class BlindAtAPlaceGuard(BlindGuard, tick_s=step_s):
    """With the blind target that is kept as a place."""

    target: AtAPlace


class BlindAtAPlace(Supervision, tick_s=step_s):
    """With that guard."""

    blind: BlindAtAPlaceGuard


class LimitAtBalise(Supervision, tick_s=step_s):
    """The variant to be refuted: the turnout's limit is enforced where the branch balise lies."""

    def held_from(self, where: Position) -> Real:
        """From here on."""
        return where.low
