"""Radio control: a supervised train, and an observer that records what it did in the cycle before.

The observer only observes: nothing that it records is read by the train or its unit, whose registers follow the same
terms as without it.  It is for proofs: said of what a cycle began with, the stop that is left is linear in few numbers.
Source: section 10, AR-3; the argument [D].
"""

from __future__ import annotations

from models.kinematics import CYCLE, need_accelerating
from models.radio.messages import Arrival
from models.radio.on_board import Drive, Supervised
from models.radio.train import Motion, SetBack
from safety import ANY, Bit, Model, Real, power_up, select


class Watched(Model, tick_s=CYCLE):
    """A supervised train and, what it did in the cycle before.

    `head` and `held`, the authority, are those at its beginning; `time` is what was left then of the reaction time, all
    of it where no brake was demanded; `needed` is `need_accelerating` with it; `shorter`: a shorter one was taken.
    """

    driven: Supervised
    head: Real = power_up(ANY)
    held: Real = power_up(ANY)
    way: Real = power_up(ANY)
    reached: Real = power_up(ANY)
    time: Real = power_up(ANY)
    needed: Real = power_up(ANY)
    demanded: Bit = power_up(False)
    shorter: Bit = power_up(False)
    acted: Bit = power_up(False)

    def step(self, now: Real, came: Arrival, order: SetBack, motion: Motion) -> tuple[Watched, Drive]:
        """One cycle."""
        driven, drive = self.driven.step(now, came, order, motion)
        train = self.driven.train
        whole = train.free_run + 2 * CYCLE
        left, all_left = (need_accelerating(train.speed, train.b, time, train.a) for time in (train.left, whole))
        acted = drive.brake & (train.left < CYCLE)
        way, reached = motion.possible(train.speed, train.a, train.b, acted)
        return Watched(
            driven=driven, head=train.head, held=self.driven.unit.limit, way=way, reached=reached,
            time=select(drive.brake, train.left, whole), needed=select(drive.brake, left, all_left),
            demanded=drive.brake, shorter=drive.shortened, acted=acted,
        ), drive  # fmt: skip
