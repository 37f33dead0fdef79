"""TS-7 speed-check channel (one of three), frame by frame.

One step is one frame, 125 us.  Speeds are in words: 1 word = 0.47124 km/h of pattern rate.
Source: ring arithmetic, NB for f_v > f_p, detection of its own faults, roll-back detection [P]; dividers, comparator,
offset and the lowering by four words, a speed pulse is consumed in its own frame [A]; check window [R].
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from models.ts7.parts import CheckWindow, Comparator, Divider, Drive, RollBackComparator
from models.ts7.ring import Words
from safety import U4, U8, Bit, Int, Model, UInt, parameter, point, select

Offset = Annotated[Int, (-4, 4)]


class Demand(NamedTuple):
    """What a channel tells the common part; the drive is de-energised for brake."""

    drive: Bit  # AC at the output: neither brake nor fault
    brake: Bit  # b_i, the latched demand: f_v > f_p
    fault: Bit  # its own check window has found it faulty
    rev: Bit  # backward and faster than the roll-back limit


class ChannelData(Model):
    """The words that one channel works with, and the limit made from them."""

    offset: Offset = parameter(
        0, unit="word", within=(-4, 4), source="[A] error e_i of this channel's threshold; accuracy +-2.0 km/h"
    )
    lowering: U4 = parameter(4, unit="word", within=(0, 8), source="[A] 1.885 km/h for the printed 2 km/h")
    check_word: U8 = parameter(85, unit="word", within=(0, 255), source="[R] 256/3, alternate bits")
    rollback_word: U8 = parameter(11, unit="word", within=(9, 16), source="[A] 5.18 km/h for the printed 5; 13 is 6.13")

    def limit(self, word: UInt, lowered: Bit) -> UInt:
        """The word against which the speed is checked; a signal 0 or none stays 0 in every channel."""
        own = select(word == 0, word, (word + self.offset).sat(8))
        return select(lowered, own.sat_sub(self.lowering), own)


class Channel(ChannelData, tick_s="125e-6"):
    """Speed-check channel: ring, dividers, comparators, check window, output drive."""

    ring: Words
    div0: Divider
    div3: Divider
    comparator: Comparator
    rollback: RollBackComparator
    check: CheckWindow
    output: Drive

    def step(self, word: U8, wheel: U8, lowered: Bit, pulse: Bit, backward: Bit) -> tuple[Channel, Demand]:
        """One frame: `word` of the signal and `wheel` from the matrix, a generator pulse, the sense of rotation."""
        limit = point("limit", self.limit(word, point("lowered", lowered)))
        ring, o = self.ring.step(limit, wheel, self.check_word, self.rollback_word, point("f_s", pulse))
        div0, reference = self.div0.step(o.o0)
        div3, rollback_reference = self.div3.step(o.o3)
        f_v, f_p, f_rev = point("f_v", o.o1), point("f_p", reference), point("f_rev", rollback_reference)
        comparator, brake = self.comparator.step(up=f_v, down=f_p)
        rollback, fast = self.rollback.step(up=f_v, down=f_rev)
        check, fault = self.check.step(o.o2)
        output, drive = self.output.step(run=~brake & ~fault)
        rev = point("rev", fast & point("backward", backward))
        following = type(self)(
            ring=ring, div0=div0, div3=div3, comparator=comparator, rollback=rollback, check=check, output=output
        )  # fmt: skip
        return following, Demand(drive=drive, brake=brake, fault=fault, rev=rev)
