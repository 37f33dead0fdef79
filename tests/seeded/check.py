"""Wrong check windows."""

from __future__ import annotations

from models.ts7.parts import HALF, QUARTER, CheckWindow
from safety import Bit, UInt, bit, point, select


class Judging(CheckWindow):
    """The check window, with its judgement and its reset each in a place of its own."""

    def step(self, overflow: Bit) -> tuple[Judging, Bit]:
        counted, last = self.count + overflow.word(), self.frame == 255
        faulty = point("faulty", self.kept() | (last & ~self.normal(counted)))
        count = select(self.starts_anew(last), 0, counted.low(8))
        return type(self)(frame=(self.frame + 1).low(8), count=count, faulty=faulty), faulty

    def normal(self, counted: UInt) -> Bit:
        return (counted > QUARTER) & (counted < HALF)

    def kept(self) -> Bit:
        return self.faulty

    def starts_anew(self, last: Bit) -> Bit:
        return last


class Blind(Judging):
    """The check window never judges."""

    def normal(self, counted: UInt) -> Bit:
        return bit(True)


class QuarterIsNormal(Judging):
    """The lower end belongs to the window: 64 overflows pass."""

    def normal(self, counted: UInt) -> Bit:
        return (counted >= QUARTER) & (counted < HALF)


class HalfIsNormal(Judging):
    """The upper end belongs to the window: 128 overflows pass."""

    def normal(self, counted: UInt) -> Bit:
        return (counted > QUARTER) & (counted <= HALF)


class SignedCount(Judging):
    """Only the upper end is compared, and as a signed number: from 128 on the count reads as below 0 and passes."""

    def normal(self, counted: UInt) -> Bit:
        low = counted.low(8)
        signed = low.low(7).int() - 128 * low.bit(7).word().int()
        return (signed < HALF) & (counted > QUARTER)


class CountNotReset(Judging):
    """The count goes on after the end of a block."""

    def starts_anew(self, last: Bit) -> Bit:
        return bit(False)


class FaultForgotten(Judging):
    """The fault is not kept: it is reported in the last frame of a block only."""

    def kept(self) -> Bit:
        return bit(False)
