"""Radio control on the ground: the cell of one train, which knows the rear of its leader and grants the authority.

    authority = rear of the leader as reported - allowance for rolling back - margin,  no further than the barrier

R1: it is extended at once.  To shorten it the ground asks, and counts on the old one until the train's echo shows that
it has taken the shorter.  While a request is open nothing else is sent; an extension ends the request.  Stamps tell a
new report from an old one (the leader may have set back since), and the echo of this request from an earlier one.
A leader may set back as far as the follower's authority in force keeps its distance.
Source: section 9, authority and R1 [P]; margin, allowance, order of messages, setting back [A].
"""

from __future__ import annotations

from typing import NamedTuple

from models.kinematics import CYCLE
from models.radio.messages import Arrival, Message
from models.radio.train import SetBack
from safety import ANY, Bit, Model, Real, bit, parameter, point, power_up, select


class Wish(NamedTuple):
    """What the dispatcher wants: no authority beyond the barrier; the leader to set back to a place."""

    barrier: Real
    set_back: Bit
    to: Real


class Orders(NamedTuple):
    """The authority that goes to the train, the order that goes to its leader."""

    authority: Message
    back: SetBack


class Cell(Model, tick_s=CYCLE):
    """The leader's rear as known, the authority in force, and the request to shorten it, if one is open."""

    known: Real = power_up(ANY)
    known_stamp: Real = power_up(ANY)
    in_force: Real = power_up(ANY)
    asking: Bit = power_up(False)
    asked: Real = power_up(ANY)
    asked_stamp: Real = power_up(ANY)

    allowance: Real = parameter(0, unit="m", within=(0, 100), source="[A] err_leader: how far a leader may roll back")
    margin: Real = parameter(50, unit="m", within=(0, 1000), source="[A] m")

    def step(self, now: Real, report: Arrival, echo: Arrival, beyond: Real, wish: Wish) -> tuple[Cell, Orders]:
        """One cycle; `beyond` is the rear of another train, further ahead, for faults of the list of trains."""
        known, stamp = heard(self, report, beyond)
        room = select(point("lost_train", bit(False)), beyond, known) - self.allowance - self.margin
        want = select(wish.barrier < room, wish.barrier, room)
        taken = point("acknowledged", self.asking & echo.comes & (echo.stamp >= self.asked_stamp))
        before, open_still = select(taken, self.asked, self.in_force), self.asking & ~taken
        extends, asked = want >= before, select(open_still, self.asked, want)
        in_force = select(extends, want, before)
        sets_back = wish.set_back & (wish.to <= known) & (in_force <= wish.to - self.allowance - self.margin)
        cell = Cell(
            known=select(sets_back, wish.to, known), known_stamp=select(sets_back, now, stamp), in_force=in_force,
            asking=~extends, asked=asked, asked_stamp=select(open_still, self.asked_stamp, now),
        )  # fmt: skip
        return cell, Orders(Message(now, select(extends, want, asked)), SetBack(sets_back, wish.to))


def heard(cell: Cell, report: Arrival, beyond: Real) -> tuple[Real, Real]:
    """The leader's rear as known with a report, and the stamp of the newest: a rear that comes back is allowed for."""
    place = select(point("wrong_order", bit(False)), beyond, report.place)
    fresh = report.comes & point("fresh", report.stamp > cell.known_stamp)
    return select(fresh & (place > cell.known), place, cell.known), select(fresh, report.stamp, cell.known_stamp)
