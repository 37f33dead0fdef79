"""Wrong ring arithmetic, frame by frame and bit by bit."""

from __future__ import annotations

from models.ts7.ring import Overflow, Ring, Words
from safety import U8, Bit, UInt, bit


class J1EveryFrame(Words):
    """The wheel word is added in every frame, not only in one with a speed pulse."""

    def step(self, d0: U8, d1: U8, d2: U8, d3: U8, pulse: Bit) -> tuple[J1EveryFrame, Overflow]:
        following, overflow = super().step(d0, d1, d2, d3, bit(True))
        return following, overflow


class CarryNotCleared(Ring):
    """The carry out of a word goes into the next one: it is not cleared at P0."""

    def clears(self, p: UInt) -> Bit:
        return bit(False)


class CarryClearedLate(Ring):
    """The carry is cleared at P1, after it has been used."""

    def clears(self, p: UInt) -> Bit:
        return p == 1
