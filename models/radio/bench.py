"""Two trains under radio control in a closed loop: the bench for the components of radio control.

The follower's driver pulls to `wants` m/s, the leader's to `leads`; a train whose brake acts loses what its brake
gives.  In each direction the same messages are sent and heard.
Source: components of the table [A]; T_r, T_c [A].
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from models.kinematics import ACCELERATION, B_SERVICE, CYCLE
from models.radio.ground import Wish
from models.radio.messages import Choices
from models.radio.moving_block import Air, TwoTrains
from models.radio.train import Motion, SetBack
from safety import Bit, Model, Real, bit, parameter, point, real, select

FAR = 10**6  # m


class Outcome(NamedTuple):
    """What a cycle shows."""

    contact: Bit  # the follower's head is beyond the rear of the leader
    brake: Bit
    radio_lost: Bit


class Driven(Model, tick_s=CYCLE):
    """Drivers, trains, radio and ground."""

    pair: TwoTrains
    b: Real = parameter(B_SERVICE, unit="m/s^2", within=(Fraction(1, 10), 3), source="[A] service brake")

    def step(self, send: Bit, hear: Bit, leads: Real, wants: Real, parts: Bit) -> tuple[Driven, Outcome]:
        """One cycle: whether messages are sent and heard in it, speeds wanted, whether the leader's coupling breaks."""
        train, leader = self.pair.follower.driven.train, self.pair.leader
        force = point("force", self.b)
        behind = driven(train.speed, select(train.left < CYCLE, -force, asked(train.speed, wants)), force, bit(False))
        ahead = driven(leader.speed, asked(leader.speed, leads), self.b, parts)
        one = Choices(send, bit(False), hear, bit(False))
        air, far, off = Air(one, one, one, one, one), real(FAR), bit(False)
        pair = self.pair.step(far, SetBack(off, far), off, air, Wish(far, off, far), ahead, behind)
        contact = self.pair.follower.driven.train.head > self.pair.leader.rear
        lost = self.pair.now - self.pair.follower.driven.unit.stamp > self.pair.follower.driven.unit.t_loss
        return type(self)(pair=pair), Outcome(contact, train.left < CYCLE, lost)


def asked(speed: Real, wanted: Real) -> Real:
    """Traction up to the speed wanted, the brake above it, m/s^2."""
    return select(speed < wanted, real(ACCELERATION), select(speed > wanted, real(-B_SERVICE), real(0)))


def driven(speed: Real, acceleration: Real, force: Real, parts: Bit) -> Motion:
    """A cycle with that acceleration; one that would end below 0 ends at a standstill, after a way of v^2 / 2b."""
    reached = speed + acceleration * CYCLE
    stands = reached <= 0
    way = select(stands, speed * speed / (2 * B_SERVICE), (speed + reached) * (CYCLE / 2))
    return Motion(way, select(stands, real(0), reached), real(0), parts)
