"""Radio control: points between two trains, moved only where no authority reaches (R5).

Points at `place` are free when the authority in force of the train behind ends before them and the train ahead is known
to be past them, rolling back included; from the cycle in which they begin to move until they stand, the authority goes
no further, and nobody is told to set back over them.  What is in force is what the ground counts on, so after a
shortening it is the acknowledgement that frees the points.
Source: section 9, R5 [P]; how points are told to move [A].
"""

from __future__ import annotations

from typing import NamedTuple

from models.kinematics import CYCLE
from models.radio.ground import Wish
from models.radio.moving_block import Air, TwoTrains
from models.radio.train import Motion, SetBack
from safety import Bit, Model, Real, bit, parameter, point, power_up, select


class Between(NamedTuple):
    """Whether the points move in this cycle."""

    moves: Bit


class Points(Model, tick_s=CYCLE):
    """Whether the points are moving; they lie at `place`."""

    moving: Bit = power_up(False)
    place: Real = parameter(500, unit="m", within=(-10_000, 10_000), source="[A] where the points lie")

    def step(self, throw: Bit, done: Bit, free: Bit) -> tuple[Points, Bit]:
        """One cycle; whether they move in it."""
        moves = self.moving | (throw & point("route_free", free))
        return Points(moving=moves & ~done), moves


class PointsAhead(Model, tick_s=CYCLE):
    """Two trains with points between them."""

    line: TwoTrains
    points: Points

    def step(
        self, throw: Bit, done: Bit, air: Air, wish: Wish, ahead: Motion, behind: Motion
    ) -> tuple[PointsAhead, Between]:
        """One cycle; whether the points move in it."""
        cell, place = self.line.follower.cell, self.points.place
        free = (cell.in_force <= place) & (cell.known - cell.allowance >= place)
        points, moves = self.points.step(throw, done, free)
        barrier = select(moves & (place < wish.barrier), place, wish.barrier)
        over = moves & (wish.to - cell.allowance < place)
        held = Wish(barrier, wish.set_back & ~over, wish.to)
        order = SetBack(bit(False), place)
        line = self.line.step(place, order, bit(False), air, held, ahead, behind)
        return PointsAhead(line=line, points=points), Between(moves)
