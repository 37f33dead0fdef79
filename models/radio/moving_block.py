"""Radio control: trains one behind the other, each kept behind the rear of the one ahead by messages alone.

A `Follower` is a train with its unit, its cell on the ground, the five channels of the pair that it makes with its
leader, and what the leader has carried out of its orders.  A line of n trains is a leader that nothing supervises (its
authority does not matter here) and n - 1 followers; each is built onto the line ahead of it, so all pairs are made of
one text.
Source: section 9 [P]; one cell a train [A].
"""

from __future__ import annotations

from typing import NamedTuple

from models.kinematics import CYCLE
from models.radio.ground import Cell, Wish
from models.radio.messages import Arrival, Channel, Choices, Message
from models.radio.on_board import Supervised
from models.radio.train import Motion, SetBack, Train
from safety import ANY, Bit, Model, Real, bit, point, power_up, select


class Air(NamedTuple):
    """What the radio does with each kind of message of a pair."""

    reports: Choices
    authorities: Choices
    echoes: Choices
    orders: Choices
    receipts: Choices


class Report(NamedTuple):
    """What a leader tells: its rear, as it follows from head and length, if it `sends` at all."""

    sends: Bit
    rear: Real


class SettingBack(Model, tick_s=CYCLE):
    """On board of a leader: an order newer than any before is carried out; `stamp` is that of the newest."""

    stamp: Real = power_up(ANY)

    def step(self, came: Arrival) -> tuple[SettingBack, SetBack]:
        """One cycle; the order, if one is to be carried out."""
        takes = came.comes & point("newer", came.stamp > self.stamp)
        return SettingBack(stamp=select(takes, came.stamp, self.stamp)), SetBack(takes, came.place)


class Follower(Model, tick_s=CYCLE):
    """One train behind a leader."""

    reports: Channel
    authorities: Channel
    echoes: Channel
    orders: Channel
    receipts: Channel
    cell: Cell
    setting_back: SettingBack
    driven: Supervised

    def step(
        self, now: Real, leader: Report, beyond: Real, order: SetBack, air: Air, wish: Wish, motion: Motion
    ) -> tuple[Follower, SetBack]:
        """One cycle; the order that reaches its leader."""
        reports, report = self.reports.step(leader.sends, Message(now, leader.rear), air.reports)
        echoes, echo = self.echoes.step(bit(True), self.driven.echo(), air.echoes)
        receipts, receipt = self.receipts.step(bit(True), Message(self.setting_back.stamp, leader.rear), air.receipts)
        cell, told_all = self.cell.step(now, report, echo, receipt, beyond, wish)
        authorities, came = self.authorities.step(bit(True), told_all.authority, air.authorities)
        orders, back = self.orders.step(told_all.backs, told_all.back, air.orders)
        setting_back, ordered = self.setting_back.step(back)
        driven, _ = self.driven.step(now, came, order, motion)
        follower = Follower(reports=reports, authorities=authorities, echoes=echoes, orders=orders, receipts=receipts,
                            cell=cell, setting_back=setting_back, driven=driven)  # fmt: skip
        return follower, ordered


def told(train: Train) -> Report:
    """The report of a train: only a train that knows itself to be whole knows where its rear is."""
    return Report(point("integrity", ~train.parted), train.head - train.length)


class TwoTrains(Model, tick_s=CYCLE):
    """A leader that brakes or not, and its follower; `beyond` is the rear of a train ahead of the leader."""

    now: Real = power_up(0)
    leader: Train
    follower: Follower

    def step(
        self, beyond: Real, order: SetBack, braked: Bit, air: Air, wish: Wish, ahead: Motion, behind: Motion
    ) -> TwoTrains:
        """One cycle; `order` comes from a cell behind the follower."""
        follower, back = self.follower.step(self.now, told(self.leader), beyond, order, air, wish, behind)
        leader = self.leader.step(braked, back, ahead)
        return TwoTrains(now=self.now + CYCLE, leader=leader, follower=follower)


class More(NamedTuple):
    """What air, dispatcher and driver do for one more train."""

    air: Air
    wish: Wish
    motion: Motion


class ThreeTrains(Model, tick_s=CYCLE):
    """Two trains, and a third behind them."""

    ahead: TwoTrains
    follower: Follower

    def step(
        self,
        beyond: Real,
        order: SetBack,
        braked: Bit,
        air: Air,
        wish: Wish,
        first: Motion,
        second: Motion,
        third: More,
    ) -> ThreeTrains:
        """One cycle."""
        line = self.ahead
        leader = told(self.next_ahead(line.follower.driven.train, line.leader))
        follower, back = self.follower.step(
            line.now, leader, line.leader.rear, order, third.air, third.wish, third.motion
        )
        return type(self)(ahead=line.step(beyond, back, braked, air, wish, first, second), follower=follower)

    def next_ahead(self, second: Train, first: Train) -> Train:
        """Whose report the third train's cell is given, as the ground lists the trains."""
        return second


class FourTrains(Model, tick_s=CYCLE):
    """Three trains, and a fourth behind them."""

    ahead: ThreeTrains
    follower: Follower

    def step(
        self, beyond: Real, order: SetBack, braked: Bit, air: Air, wish: Wish, first: Motion, second: Motion,
        third: More, fourth: More,
    ) -> FourTrains:  # fmt: skip
        """One cycle."""
        line = self.ahead
        leader, further = line.follower.driven.train, line.ahead.follower.driven.train.rear
        follower, back = self.follower.step(
            line.ahead.now, told(leader), further, order, fourth.air, fourth.wish, fourth.motion
        )
        return FourTrains(ahead=line.step(beyond, back, braked, air, wish, first, second, third), follower=follower)
