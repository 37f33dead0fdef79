"""Radio control: what holds of a pair of trains at every step, as the claims about it use it.

`Pair(s, leader, follower, now)` names the parts of one pair in a model of any number of trains.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from models.kinematics import CYCLE, stops_accelerating
from models.radio.ride import CHANNELS
from safety import Bit, Seen, all_of, implies

Formula = Callable[[Seen], Bit]


SLOTS = ("one", "two")


def _of_message(lemma: Callable[[Seen, str], Bit], name: str) -> Formula:
    """A lemma of the message in one slot."""

    def of_this(s: Seen) -> Bit:
        return lemma(s, name)

    of_this.__name__ = f"{lemma.__name__} ({name})"
    return of_this


@dataclass(frozen=True)
class Pair:
    """Where a leader, its follower and the clock stand in a model."""

    leader: str = "leader"
    follower: str = "follower"
    now: str = "now"

    def slot(self, s: Seen, channel: str, name: str) -> Any:
        """One of the two slots of a channel."""
        return s[f"{self.follower}.{channel}.{name}"]

    def lemmas(self) -> list[Formula]:
        """The invariants of the pair, its authority being kept; what is said of a message is said of each by itself."""
        of_all = (
            self.known_is_past,
            self.request_is_past,
            self.carried_out_is_known,
            self.taken_is_past,
            self.leader_rolls_back_within,
            self.known_is_true,
            self.authority_keeps_distance,
            self.taken_is_in_force,
            self.request_is_counted_on,
        )
        of_one = (self.report_is_past, self.report_is_true, self.authority_is_past, self.authority_is_in_force,
                  self.authority_is_as_asked, self.echo_is_true,
                  self.order_is_open, self.receipt_is_true)  # fmt: skip
        return [*of_all, *(_of_message(lemma, name) for lemma in of_one for name in SLOTS)]

    def known_is_past(self, s: Seen) -> Bit:
        return all_of(s[self.follower].cell.known_stamp < s[self.now])

    def request_is_past(self, s: Seen) -> Bit:
        return all_of(s[self.follower].cell.asked_stamp < s[self.now])

    def taken_is_past(self, s: Seen) -> Bit:
        return all_of(s[self.follower].driven.unit.stamp < s[self.now])

    def leader_rolls_back_within(self, s: Seen) -> Bit:
        t = s[self.leader]
        whole = t.parted | (t.head == t.rear + t.length)
        return all_of(whole, (t.rear <= t.furthest), (t.rear >= t.furthest - t.roll_back))

    def known_is_true(self, s: Seen) -> Bit:
        return all_of(s[self.follower].cell.known <= s[self.leader].furthest)

    def authority_keeps_distance(self, s: Seen) -> Bit:
        cell = s[self.follower].cell
        return all_of(cell.in_force + cell.allowance + cell.margin <= cell.known)

    def taken_is_in_force(self, s: Seen) -> Bit:
        return all_of(s[self.follower].driven.unit.limit <= s[self.follower].cell.in_force)

    def request_is_counted_on(self, s: Seen) -> Bit:
        cell, unit = s[self.follower].cell, s[self.follower].driven.unit
        taken = implies(unit.stamp >= cell.asked_stamp, unit.limit <= cell.asked)
        return implies(cell.asking, (cell.asked <= cell.in_force) & taken)

    def report_is_past(self, s: Seen, name: str) -> Bit:
        return all_of(self.slot(s, "reports", name).sent_at < s[self.now])

    def report_is_true(self, s: Seen, name: str) -> Bit:
        m = self.slot(s, "reports", name)
        cell = s[self.follower].cell
        return implies(~cell.backing & (m.sent_at > cell.known_stamp), m.says <= s[self.leader].furthest)

    def authority_is_past(self, s: Seen, name: str) -> Bit:
        return all_of(self.slot(s, "authorities", name).sent_at < s[self.now])

    def authority_is_in_force(self, s: Seen, name: str) -> Bit:
        m, f = self.slot(s, "authorities", name), s[self.follower]
        return implies(m.sent_at > f.driven.unit.stamp, m.says <= f.cell.in_force)

    def authority_is_as_asked(self, s: Seen, name: str) -> Bit:
        m, cell = self.slot(s, "authorities", name), s[self.follower].cell
        return implies(cell.asking & (m.sent_at >= cell.asked_stamp), m.says <= cell.asked)

    def echo_is_true(self, s: Seen, name: str) -> Bit:
        return all_of(self.slot(s, "echoes", name).sent_at <= s[self.follower].driven.unit.stamp)

    def carried_out_is_known(self, s: Seen) -> Bit:
        f = s[self.follower]
        return all_of(f.setting_back.stamp <= f.cell.known_stamp)

    def order_is_open(self, s: Seen, name: str) -> Bit:
        m, f = self.slot(s, "orders", name), s[self.follower]
        is_it = (m.sent_at == f.cell.known_stamp) & (m.says == f.cell.known)
        return implies(m.sent_at > f.setting_back.stamp, f.cell.backing & is_it)

    def receipt_is_true(self, s: Seen, name: str) -> Bit:
        return all_of(self.slot(s, "receipts", name).sent_at <= s[self.follower].setting_back.stamp)

    def keeps_its_authority(self, s: Seen) -> Bit:
        """What `radio_authority.stays_within_its_authority` proves of a supervised train, whatever messages come."""
        return within_authority(s[self.follower].driven)

    def commissioned(self, s: Seen) -> Bit:
        """Power-up: nothing is on its way but what was sent before, and all of it is true."""
        f, leader, now = s[self.follower], s[self.leader], s[self.now]
        cell, unit = f.cell, f.driven.unit
        reports, authorities, echoes, orders, receipts = (
            [self.slot(s, channel, name) for name in SLOTS] for channel in CHANNELS
        )
        return all_of(
            *(m.sent_at < now for m in (*reports, *authorities, *echoes)),
            cell.known_stamp < now, unit.stamp < now, cell.asked_stamp < now, ~leader.parted,
            leader.head == leader.rear + leader.length, leader.rear == leader.furthest, cell.known <= leader.rear,
            *(m.says <= cell.known for m in reports),
            cell.in_force + cell.allowance + cell.margin <= cell.known, unit.limit <= cell.in_force,
            *(m.says <= unit.limit for m in authorities), *(m.sent_at <= unit.stamp for m in echoes),
            *(m.sent_at <= f.setting_back.stamp for m in (*orders, *receipts)),
            f.setting_back.stamp <= cell.known_stamp,
        )  # fmt: skip

    def allowed_for(self, s: Seen) -> Bit:
        """R4: the ground allows for as much as the leader rolls back."""
        return all_of(s[self.follower].cell.allowance >= s[self.leader].roll_back)

    def never_passed(self, s: Seen) -> Bit:
        """The follower's head is not beyond the leader's rear, as it truly is."""
        return all_of(s[self.follower].driven.train.head <= s[self.leader].rear)

    @property
    def left_open(self) -> tuple[str, ...]:
        """The parameters of which these formulas speak."""
        cell = f"{self.follower}.cell"
        return f"{cell}.margin", f"{cell}.allowance", f"{self.leader}.roll_back", f"{self.leader}.length"


def within_authority(driven: Any) -> Bit:
    """The train's head is not beyond the authority that its unit has taken."""
    return all_of(driven.train.head <= driven.unit.limit)


def reacts_in_time(driven: Any, free_run: Any) -> Bit:
    """What is left of the reaction time is no more than all of it."""
    train = driven.train
    return all_of((train.left >= 0), (train.left <= free_run + CYCLE), (train.speed >= 0))


def braking_fits(driven: Any, b: Any, a: Any) -> Bit:
    """With what is left of its reaction time, traction going on through it, the train stops within its authority."""
    train = driven.train
    return all_of(stops_accelerating(train.speed, driven.unit.limit - train.head, b, train.left, a))


TWO = Pair()
