"""Wrong speed-check channels: comparator, divider, limit, direction, output."""

from __future__ import annotations

from models.ts7.channel import Channel, Demand
from models.ts7.parts import Comparator, Divider, Drive
from safety import U8, Bit, UInt, point, select


class LatchesAtTwo(Comparator):
    """The latch sets when the upper train is two pulses ahead, not three."""

    def step(self, up: Bit, down: Bit) -> tuple[LatchesAtTwo, Bit]:
        rise, fall = up & ~down, down & ~up
        u = point("u", select(rise, (self.u + 1).sat(2), select(fall, self.u.sat_sub(1), self.u)))
        latch = point("latch", (u >= 2) | (self.latch & (u != 0)))
        return type(self)(u=u, latch=latch), latch


class NeverClears(Comparator):
    """The latch is never cleared: once braked, always braked."""

    def step(self, up: Bit, down: Bit) -> tuple[NeverClears, Bit]:
        rise, fall = up & ~down, down & ~up
        u = point("u", select(rise, (self.u + 1).sat(2), select(fall, self.u.sat_sub(1), self.u)))
        latch = point("latch", (u == 3) | self.latch)
        return type(self)(u=u, latch=latch), latch


class WrapsRound(Comparator):
    """The counter does not stop at its ends: one pulse more than three is none."""

    def step(self, up: Bit, down: Bit) -> tuple[WrapsRound, Bit]:
        rise, fall = up & ~down, down & ~up
        u = point("u", select(rise, (self.u + 1).low(2), select(fall, (self.u + 3).low(2), self.u)))
        latch = point("latch", (u == 3) | (self.latch & (u != 0)))
        return type(self)(u=u, latch=latch), latch


class SignedCounter(Comparator):
    """The counter is compared as a signed number of two bits: 3 reads as -1, so the latch never sets."""

    def step(self, up: Bit, down: Bit) -> tuple[SignedCounter, Bit]:
        rise, fall = up & ~down, down & ~up
        u = point("u", select(rise, (self.u + 1).sat(2), select(fall, self.u.sat_sub(1), self.u)))
        signed = u.low(1).int() - 2 * u.bit(1).word().int()
        latch = point("latch", (signed >= 3) | (self.latch & (u != 0)))
        return type(self)(u=u, latch=latch), latch


class SwappedTrains(Comparator):
    """f_v and f_p are swapped at the comparator."""

    def step(self, up: Bit, down: Bit) -> tuple[SwappedTrains, Bit]:
        following, latch = super().step(up=down, down=up)
        return following, latch


class DividesByEight(Divider):
    """The post-divider gives a pulse for eight, so the pattern is twice as fast."""

    def step(self, pulse: Bit) -> tuple[DividesByEight, Bit]:
        counted = point("n", self.n).low(3) + pulse.word()
        return type(self)(n=counted.low(4) & 7), counted.bit(3)


class NeverStartsAnew(Divider):
    """The post-divider is not reset by its own pulse: from the sixteenth on, each pulse in is one out."""

    def step(self, pulse: Bit) -> tuple[NeverStartsAnew, Bit]:
        counted = point("n", self.n) + pulse.word()
        return type(self)(n=counted.sat(4)), counted.bit(4)


class RaisesInsteadOfLowering(Channel):
    """During synchronisation the limit is raised by four words, not lowered."""

    def limit(self, word: UInt, lowered: Bit) -> UInt:
        own = select(word == 0, word, (word + self.offset).sat(8))
        return select(lowered, (own + self.lowering).sat(8), own)


class SignedWord(Channel):
    """The word of the signal is taken as a signed number: from 128 on it is below 0, so 65 km/h permits nothing."""

    def limit(self, word: UInt, lowered: Bit) -> UInt:
        return super().limit(select(word.bit(7), 0, word), lowered)


class OffsetAtStop(Channel):
    """A channel whose threshold errs upward permits a low speed without any signal."""

    def limit(self, word: UInt, lowered: Bit) -> UInt:
        own = (word + self.offset).sat(8)
        return select(lowered, own.sat_sub(self.lowering), own)


class WheelWordOfSevenBits(Channel):
    """The wheel word loses its highest bit: the speed is taken for about a quarter of what it is."""

    def step(self, word: U8, wheel: U8, lowered: Bit, pulse: Bit, backward: Bit) -> tuple[WheelWordOfSevenBits, Demand]:
        following, demand = super().step(word, wheel & 127, lowered, pulse, backward)
        return following, demand


class RollsBackForward(Channel):
    """Roll-back detection does not look at the sense of rotation."""

    def step(self, word: U8, wheel: U8, lowered: Bit, pulse: Bit, backward: Bit) -> tuple[RollsBackForward, Demand]:
        following, demand = super().step(word, wheel, lowered, pulse, backward | ~backward)
        return following, demand


class StaticDrive(Drive):
    """The output holds its level for "run": a relay without a transformer, which a stuck output keeps up."""

    def step(self, run: Bit) -> tuple[StaticDrive, Bit]:
        level = point("level", point("toggle", run))
        return type(self)(level=level), level
