"""TS-7 with full-scale wheel words: the words 231, 234 .. 255 that use the whole range of a word, but have to round.

The reference takes diameter / 5 mm (156 .. 172), which is exact; a word in proportion to the diameter, 255 for 860 mm,
is not whole for the other eight steps.  It raises f_v by 255/172, so that signal 90 would need the word 283: it takes
another divider or fewer pulses a revolution.  One step is one frame, 125 us.
Source: nine steps of 10 mm [P]; either set of words [A].
"""

from __future__ import annotations

from models.ts7.channel import Channel, Demand
from models.ts7.train import Axle, Speed
from safety import U4, U8, Bit, Model, UInt, parameter, point

SMALLEST, LARGEST_WORD, STEPS = 156, 255, 8  # 5 mm; word of 860 mm; steps above the smallest


class FullScaleBench(Model, tick_s="125e-6"):
    """One channel behind an axle whose wheel is that of the switch's step; the matrix holds the full-scale words."""

    a: Channel
    axle: Axle
    place: U4 = parameter(4, unit="10 mm", within=(0, STEPS), source="[P] step of the wheel switch above 780 mm")

    def step(self, word: U8, speed: Speed, lowered: Bit, backward: Bit) -> tuple[FullScaleBench, Demand]:
        """One frame at a true speed."""
        axle, seen = self.axle.step(speed, backward, (SMALLEST + 2 * self.place).low(8))
        wheel = point("wheel_word", self.full_scale())
        a, demand = self.a.step(word, wheel, lowered, seen.pulse, seen.backward)
        return type(self)(a=a, axle=axle), demand

    def full_scale(self) -> UInt:
        """The nearest word: the nine of them rise by 3."""
        return (LARGEST_WORD - 3 * STEPS + 3 * self.place).low(8)
