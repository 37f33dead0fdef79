"""TS-7 with the other reading of the check window: 1/2 between 1/4 and 3/4 of the word frequency, check word 128.

The print has lost its fractions; the reference reads 1/3 between 1/4 and 1/2 (word 85), this is the one that remains
possible [R].  Steps: a frame of 125 us; 3.90625 us, 32 to a frame, on `HalfCheckedRing`.
Source: check word between two divided frequencies [P]; which fractions [R].

Main result: word 128 is a single bit, so it exercises neither alternate bits nor the carry chain; what the window then
misses is in `proofs/ts7_half_window.py`.
"""

from __future__ import annotations

from models.ts7.bench import CheckedRing, Strobed
from models.ts7.channel import Channel
from models.ts7.parts import CheckWindow
from models.ts7.system import Ts7
from models.ts7.train import Bench
from safety import U8, Bit, UInt, parameter

QUARTER, THREE_QUARTERS = 64, 192  # overflows in 256 frames at 1/4 and 3/4 of the word frequency 8 kHz


class HalfWindow(CheckWindow, tick_s="125e-6"):
    """Fault detection: the ring-made 1/2 of the word frequency must lie between 1/4 and 3/4 [R]."""

    def normal(self, counted: UInt) -> Bit:
        """Strictly between both ends."""
        return (counted > QUARTER) & (counted < THREE_QUARTERS)


class HalfChannel(Channel, tick_s="125e-6"):
    """Speed-check channel with check word 128."""

    check: HalfWindow
    check_word: U8 = parameter(128, unit="word", within=(0, 255), source="[R] 256/2, one bit")


class HalfBench(Bench, tick_s="125e-6"):
    """One such channel on the test bench."""

    a: HalfChannel


class HalfTs7(Ts7, tick_s="125e-6"):
    """The whole equipment with such channels."""

    a: HalfChannel
    b: HalfChannel
    c: HalfChannel


class HalfStrobed(Strobed, tick_s="3.90625e-6"):
    """The same window in bit times."""

    def normal(self, counted: UInt) -> Bit:
        """Strictly between both ends."""
        return (counted > QUARTER) & (counted < THREE_QUARTERS)


class HalfCheckedRing(CheckedRing, tick_s="3.90625e-6"):
    """Ring as built, and the window of this reading."""

    check: HalfStrobed
