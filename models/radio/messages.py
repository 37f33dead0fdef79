"""Radio control: what goes over the air, and what the surroundings may do with it.

A message is a place with the time stamp of its sender: a report (the rear of a train as surely known on board), an
authority (the limit of movement), or an echo (the authority that the train holds, sent back: it is the
acknowledgement).  Places in m in the direction of running, stamps in s on one clock [A].  A step is a cycle of 0.1 s.
Source: next-generation radio control, section 9 [P]; contents of the messages, one clock [A].
"""

from __future__ import annotations

from typing import NamedTuple

from models.kinematics import CYCLE
from safety import ANY, Bit, Model, Real, bit, point, power_up, select


class Message(NamedTuple):
    """What one message says."""

    stamp: Real
    place: Real


class Arrival(NamedTuple):
    """What comes in within a cycle, if anything `comes`."""

    comes: Bit
    stamp: Real
    place: Real


class Choices(NamedTuple):
    """What the air does in a cycle: which slot takes what is sent now, whether one is delivered, and which."""

    keep_one: Bit
    keep_two: Bit
    deliver: Bit
    second: Bit


class Slot(Model, tick_s=CYCLE):
    """One message that was really sent, whichever and however long ago."""

    sent_at: Real = power_up(ANY)
    says: Real = power_up(ANY)

    def step(self, keep: Bit, sent: Message) -> tuple[Slot, Message]:
        """Take what is sent now, or hold what is there."""
        takes = point("takes", keep)
        now = Message(select(takes, sent.stamp, self.sent_at), select(takes, sent.place, self.says))
        return Slot(sent_at=now.stamp, says=now.place), now


class Channel(Model, tick_s=CYCLE):
    """An adversary's radio in one direction: it loses, delays, replays and reorders messages as it likes.

    Either slot may hold any message that was ever sent, and each may be delivered at any time, any number of times.  It
    makes none up: what is corrupted does not pass its check sum (`intact`), which covers sender and addressee [A]: no
    message for another train is taken.
    """

    one: Slot
    two: Slot

    def step(self, sends: Bit, sent: Message, air: Choices) -> tuple[Channel, Arrival]:
        """One cycle; a message may arrive in the cycle in which it is sent."""
        one, first = self.one.step(sends & air.keep_one, sent)
        two, second = self.two.step(sends & air.keep_two, sent)
        arrival = Arrival(
            point("heard", air.deliver) & point("intact", bit(True)),
            point("stamp_heard", select(air.second, second.stamp, first.stamp)),
            point("place_heard", select(air.second, second.place, first.place)),
        )
        return Channel(one=one, two=two), arrival
