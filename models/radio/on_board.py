"""Radio control on board: a one-stage pattern to the end of the authority, and the train that it supervises.

The unit takes a newer authority that reaches further at once, one that is shorter only if the train can still keep it
(R1); what it holds it sends back.  An authority is valid until it is used up (R2).  When the newest is older than
T_loss the service brake is demanded until a new one comes (R3); that the train stays within its authority does not rest
on it.  The pattern is the conservative one: traction may go on through the cycle and the free run.
Source: section 9, R1 to R3 [P]; T_loss, report period, latency [A].
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from models.kinematics import CYCLE, Decision, nearest, permits_accelerating
from models.radio.messages import Arrival, Message
from models.radio.train import Motion, Reading, SetBack, Train, read
from safety import ANY, Bit, Model, Real, parameter, point, power_up, require, select


class Drive(NamedTuple):
    """Outputs of the unit: the brake that it demands, and why: the pattern, or a lost radio."""

    brake: Bit
    radio_lost: Bit
    shortened: Bit


class OnBoard(Model, tick_s=CYCLE):
    """End of the authority that holds, and the stamp of the message that gave it."""

    limit: Real = power_up(ANY)
    stamp: Real = power_up(ANY)

    t_loss: Real = parameter(
        3, unit="s", within=(0, 60), source="[A] T_loss, age of an authority that raises radio_lost"
    )
    period: Real = parameter(1, unit="s", within=(0, 10), source="[A] T_r, a report and an authority each so often")
    latency: Real = parameter(Fraction(1, 2), unit="s", within=(0, 10), source="[A] T_c, of a message")

    def step(self, now: Real, train: Reading, came: Arrival) -> tuple[OnBoard, Drive]:
        """One cycle; `train` as read at its beginning."""
        least = self.period + self.latency + CYCLE
        require("T_loss covers a period, the latency and a cycle", self.t_loss >= least,
                nearest=nearest("t_loss", least, "s"))  # fmt: skip
        reaction = point("reaction", train.free_run + 2 * CYCLE)  # this cycle, free run, rest of the cycle it ends in

        def kept(end: Real) -> Decision:
            return permits_accelerating(train.speed, end - train.head, train.b, reaction, train.a)

        can_keep = kept(came.place)
        newer, further = point("newer", came.stamp > self.stamp), came.place >= self.limit
        takes = came.comes & newer & (further | point("can_keep", can_keep))
        stamp = select(takes, came.stamp, self.stamp)
        lost = point("lost", now - stamp > self.t_loss)
        brake = point("brake", ~select(takes, can_keep, kept(self.limit)) | lost)
        unit = OnBoard(limit=select(takes, came.place, self.limit), stamp=stamp)
        return unit, Drive(brake, lost, takes & ~further)


class Supervised(Model, tick_s=CYCLE):
    """A train under its unit: whatever messages come, it stays within the authority that it has taken."""

    unit: OnBoard
    train: Train

    def step(self, now: Real, came: Arrival, order: SetBack, motion: Motion) -> tuple[Supervised, Drive]:
        """One cycle."""
        unit, drive = self.unit.step(now, read(self.train), came)
        return Supervised(unit=unit, train=self.train.step(drive.brake, order, motion)), drive

    def echo(self) -> Message:
        """The authority it holds, as it echoes it."""
        return Message(self.unit.stamp, self.unit.limit)
