"""Wrong check windows."""

from __future__ import annotations

from models.ts7.parts import HALF, QUARTER, CheckWindow
from safety import Bit, UInt, bit, select


class Blind(CheckWindow):
    """The check window never judges."""

    def normal(self, counted: UInt) -> Bit:
        return bit(True)


class QuarterIsNormal(CheckWindow):
    """The lower end belongs to the window: 64 overflows pass."""

    def normal(self, counted: UInt) -> Bit:
        return (counted >= QUARTER) & (counted < HALF)


class HalfIsNormal(CheckWindow):
    """The upper end belongs to the window: 128 overflows pass."""

    def normal(self, counted: UInt) -> Bit:
        return (counted > QUARTER) & (counted <= HALF)


class SignedCount(CheckWindow):
    """The count is taken as a signed number of eight bits and judged by its size: 190 reads as -66 and passes."""

    def normal(self, counted: UInt) -> Bit:
        count = counted.low(8)
        return super().normal(select(count.bit(7), (256 - count).sat(8), count))


class CountNotReset(CheckWindow):
    """The count goes on after the end of a block."""

    def step(self, overflow: Bit) -> tuple[CountNotReset, Bit]:
        following, fault = super().step(overflow)
        count = (self.count + overflow.word()).low(8)
        return type(self)(frame=following.frame, count=count, faulty=following.faulty), fault


class FaultForgotten(CheckWindow):
    """The fault is not kept: it is reported in the last frame of a block only."""

    def step(self, overflow: Bit) -> tuple[FaultForgotten, Bit]:
        following, fault = super().step(overflow)
        return type(self)(frame=following.frame, count=following.count, faulty=bit(False)), fault
