"""Wrong check windows."""

from __future__ import annotations

from models.ts7.parts import HALF, QUARTER, CheckWindow
from safety import Bit, UInt, bit


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
    """The count is compared as a signed number of eight bits, and its size only: 192 reads as -64, less than a half."""

    def normal(self, counted: UInt) -> Bit:
        size = counted.low(8)
        size = size.bit(7).select(256 - size, size)
        return (size > QUARTER) & (size < HALF)


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
