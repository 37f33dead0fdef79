"""TS-7, the ring as built with its check window, on the test bench.

One step is one bit time, 3.90625 us; 32 make a frame, in whose last bit time the window counts.
Source: ring, serial adder [P]; window [R].
"""

from __future__ import annotations

from typing import NamedTuple

from models.ts7.parts import CheckWindow
from models.ts7.ring import BITS_A_FRAME, Ring
from safety.model import Model
from safety.terms import U8, Bit, select


class Strobed(CheckWindow, tick_s="3.90625e-6"):
    """The check window in bit times: it stands still except where it is strobed."""

    def step(self, overflow: Bit, strobe: Bit) -> tuple[Strobed, Bit]:
        """Count and judge one frame at its strobe; the verdict is that of the last strobe."""
        judged, fault = super().step(overflow)
        frame, count = select(strobe, judged.frame, self.frame), select(strobe, judged.count, self.count)
        faulty = select(strobe, fault, self.faulty)
        return type(self)(frame=frame, count=count, faulty=faulty), faulty


class Verdict(NamedTuple):
    """What the window says."""

    fault: Bit


class CheckedRing(Model, tick_s="3.90625e-6"):
    """Ring and check window."""

    ring: Ring
    check: Strobed

    def step(self, d0: U8, d1: U8, d2: U8, d3: U8, pulse: Bit) -> tuple[CheckedRing, Verdict]:
        """One bit time; data and `pulse` stay as they are for a frame."""
        ring, overflow = self.ring.step(d0, d1, d2, d3, pulse)
        check, fault = self.check.step(overflow.o2, self.ring.place == BITS_A_FRAME - 1)
        return type(self)(ring=ring, check=check), Verdict(fault)
