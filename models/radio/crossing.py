"""Radio control: a level crossing that trains ask for by radio.

The unit asks when, at its speed and with the traction it may use, it could be at the crossing within the warning time
and the time that a message may take.  Until the crossing has warned for T_min the ground's barrier stays before it: a
request that is lost costs time, not safety.  It warns as long as an authority reaches it.
Source: section 9 [P] (the train asks, from speed and position); the barrier, T_min [A].
"""

from __future__ import annotations

from models.kinematics import CYCLE
from models.radio.ground import Wish
from models.radio.moving_block import Air, TwoTrains
from models.radio.train import Motion, Reading, SetBack, read
from safety import Bit, Model, Real, bit, parameter, point, power_up, select


class Crossing(Model, tick_s=CYCLE):
    """For how long it has been warning, s."""

    warned: Real = power_up(0)
    place: Real = parameter(500, unit="m", within=(-10_000, 10_000), source="[A] where the crossing lies")
    t_min: Real = parameter(20, unit="s", within=(0, 120), source="[A] least warning")
    ahead: Real = parameter(35, unit="s", within=(0, 300), source="[A] how long before it a train asks")

    def asks(self, train: Reading) -> Bit:
        """Whether the train asks: it could be there within `ahead` seconds."""
        reach = train.speed * self.ahead + train.a * (self.ahead * self.ahead / 2)
        return train.head + reach >= self.place

    def step(self, request: Bit, needed: Bit) -> tuple[Crossing, Bit]:
        """One cycle; whether an authority may reach beyond it."""
        warns = point("warns", request | needed)
        return Crossing(warned=select(warns, self.warned + CYCLE, 0)), warns & point(
            "warned_enough", self.warned >= self.t_min
        )


class CrossingAhead(Model, tick_s=CYCLE):
    """Two trains, the second of which comes to a crossing; `passed`: its rear has cleared it, rolling back included."""

    line: TwoTrains
    crossing: Crossing
    passed: Bit = power_up(False)

    def step(self, heard: Bit, air: Air, wish: Wish, ahead: Motion, behind: Motion) -> CrossingAhead:
        """One cycle; `heard`: a request that the train sends arrives."""
        cell, train, place = self.line.follower.cell, self.line.follower.driven.train, self.crossing.place
        passed = self.passed | (train.rear - train.roll_back > place)
        crossing, may = self.crossing.step(heard & self.crossing.asks(read(train)), ~passed & (cell.in_force > place))
        barrier = select(passed | may | (wish.barrier < place), wish.barrier, place)
        order = SetBack(bit(False), place)
        line = self.line.step(place, order, bit(False), air, Wish(barrier, wish.set_back, wish.to), ahead, behind)
        return CrossingAhead(line=line, crossing=crossing, passed=passed)
