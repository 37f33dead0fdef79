"""Check-speed selection of the two-counter ATC: from seven lines to the preset m of counter 2, in edges.

One step is one period of the standard oscillator, 155.8695 us.  An edge is half a pulse of the speed generator.
Source: seven check speeds [P], presets [D]; the lowest active line wins, none is the lowest check speed [A].
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from models.two_counter import step_s
from safety import Bit, Model, UInt, parameter, point, select

Stages = Annotated[UInt, 11]
PRESET = "[D] from table 2(A): 2*f2E*Tc"


class Lines(NamedTuple):
    """Check-speed lines, km/h, true = selected; healthy equipment has one."""

    s250: Bit
    s210: Bit
    s160: Bit
    s110: Bit
    s70: Bit
    s30: Bit
    s5: Bit


class Selection(Model, tick_s=step_s):
    """Selection of the preset: the lowest active line wins; no line active gives the lowest preset."""

    m250: Stages = parameter(1035, unit="edge", within=(16, 2047), source=PRESET)
    m210: Stages = parameter(875, unit="edge", within=(16, 2047), source=PRESET)
    m160: Stages = parameter(677, unit="edge", within=(16, 2047), source=PRESET)
    m110: Stages = parameter(477, unit="edge", within=(16, 2047), source=PRESET)
    m70: Stages = parameter(317, unit="edge", within=(16, 2047), source=PRESET)
    m30: Stages = parameter(157, unit="edge", within=(16, 2047), source=PRESET)
    m5: Stages = parameter(57, unit="edge", within=(16, 2047), source=PRESET)

    def step(self, lines: Lines) -> tuple[Selection, Stages]:
        """The preset of the lowest selected check speed."""
        chosen = self.none_selected()
        presets = (self.m250, self.m210, self.m160, self.m110, self.m70, self.m30, self.m5)
        for name, line, m in zip(Lines._fields, lines, presets, strict=True):
            chosen = select(point(f"line.{name}", line), m, chosen)
        return type(self)(), point("preset", chosen)

    def none_selected(self) -> UInt:
        """What stands where no line is active."""
        return self.m5
