"""Radio control on the ground: the cell of one train, which knows the rear of its leader and grants the authority.

    authority = rear of the leader as reported - allowance for rolling back - margin,  no further than the barrier

R1: it is extended at once.  To shorten it the ground asks, and counts on the old one until the train's echo shows that
it has taken the shorter.  While a request is open nothing else is sent; an extension ends the request.  Stamps tell a
new report from an old one (the leader may have set back since), and the echo of this request from an earlier one.
A leader may set back as far as the follower's authority in force keeps its distance.  The order goes over the air like
any message: from the cycle in which it is given the ground counts on the place it names and takes no report, until a
receipt shows that the leader has carried it out; only reports sent later count again.
Source: section 9, authority and R1 [P]; margin, allowance, order of messages, setting back [A].
"""

from __future__ import annotations

from typing import NamedTuple

from models.kinematics import CYCLE
from models.radio.messages import Arrival, Message
from safety import ANY, Bit, Model, Real, bit, parameter, point, power_up, select


class Wish(NamedTuple):
    """What the dispatcher wants: no authority beyond the barrier; the leader to set back to a place."""

    barrier: Real
    set_back: Bit
    to: Real


class Orders(NamedTuple):
    """The authority that goes to the train, the order that goes to its leader."""

    authority: Message
    backs: Bit  # whether an order to set back is open, and sent
    back: Message


class Grant(NamedTuple):
    """The authority in force, and the request to shorten it."""

    in_force: Real
    extends: Bit  # nothing is asked for
    asked: Real
    still_open: Bit  # an earlier request
    place: Real  # what is sent


class Cell(Model, tick_s=CYCLE):
    """The leader's rear as known, the authority in force, the request to shorten it and the order to set back, if open.

    The open order is `known` with `known_stamp`.
    """

    known: Real = power_up(ANY)
    known_stamp: Real = power_up(ANY)
    in_force: Real = power_up(ANY)
    asking: Bit = power_up(False)
    asked: Real = power_up(ANY)
    asked_stamp: Real = power_up(ANY)
    backing: Bit = power_up(False)

    allowance: Real = parameter(0, unit="m", within=(0, 100), source="[A] err_leader: how far a leader may roll back")
    margin: Real = parameter(50, unit="m", within=(0, 1000), source="[A] m")

    def step(
        self, now: Real, report: Arrival, echo: Arrival, receipt: Arrival, beyond: Real, wish: Wish
    ) -> tuple[Cell, Orders]:
        """One cycle; `beyond` is the rear of another train, further ahead, for faults of the list of trains."""
        known, stamp = heard(self, report, beyond)
        room = select(point("lost_train", bit(False)), beyond, known) - self.allowance - self.margin
        want = select(wish.barrier < room, wish.barrier, room)
        grant = granted(self, want, echo)
        sets_back, done = ordered(self, known, grant.in_force, receipt, wish)
        cell = Cell(
            known=select(sets_back, wish.to, known), known_stamp=select(sets_back | done, now, stamp),
            in_force=grant.in_force, asking=~grant.extends, asked=grant.asked,
            asked_stamp=select(grant.still_open, self.asked_stamp, now), backing=sets_back | (self.backing & ~done),
        )  # fmt: skip
        return cell, Orders(Message(now, grant.place), self.backing, Message(self.known_stamp, self.known))


def heard(cell: Cell, report: Arrival, beyond: Real) -> tuple[Real, Real]:
    """The leader's rear as known with a report, and the stamp of the newest: a rear that comes back is allowed for."""
    place = select(point("wrong_order", bit(False)), beyond, report.place)
    fresh = report.comes & ~cell.backing & point("fresh", report.stamp > cell.known_stamp)
    return select(fresh & (place > cell.known), place, cell.known), select(fresh, report.stamp, cell.known_stamp)


def granted(cell: Cell, want: Real, echo: Arrival) -> Grant:
    """R1: longer at once, shorter once the echo shows that the train has taken it."""
    taken = point("acknowledged", cell.asking & echo.comes & (echo.stamp >= cell.asked_stamp))
    before, still_open = select(taken, cell.asked, cell.in_force), cell.asking & ~taken
    extends, asked = want >= before, select(still_open, cell.asked, want)
    return Grant(select(extends, want, before), extends, asked, still_open, select(extends, want, asked))


def ordered(cell: Cell, known: Real, in_force: Real, receipt: Arrival, wish: Wish) -> tuple[Bit, Bit]:
    """Whether the leader is ordered to set back, and whether an open order is carried out."""
    keeps = in_force <= wish.to - cell.allowance - cell.margin
    sets_back = point("sets_back", wish.set_back & ~cell.backing & (wish.to <= known) & keeps)
    done = cell.backing & point("carried_out", receipt.comes & (receipt.stamp >= cell.known_stamp))
    return sets_back, done
