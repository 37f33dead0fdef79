"""Energise-to-release: what holds the brake off needs supply, program cycle, a valid speed and a valid code.

One step is one cycle of 0.1 s.  Whatever is lost drops the line, and a line that is down is the brake.
Source: fail-safe direction of every output [P principle]; the four lines, one cycle [A].  A speed sensor is
lost when its validity line drops; one that is silent and still valid is another fault.
"""

from __future__ import annotations

from typing import NamedTuple

from models.patterns.train import TICK
from safety import Bit, Model, point, power_up


class Held(NamedTuple):
    """What has to be there for the brake to stay off."""

    supply: Bit
    cycle: Bit
    speed_valid: Bit
    code: Bit


class HeldLine(Model, tick_s=TICK):
    """The output relay of one brake."""

    energised: Bit = power_up(False)

    def step(self, held: Held, asked: Bit) -> tuple[HeldLine, Bit]:
        """One cycle; whether the brake is on, by what was there in the cycle before."""
        up = point("supply", held.supply) & point("cycle", held.cycle)
        valid = point("speed_valid", held.speed_valid) & point("code", held.code)
        return type(self)(energised=up & valid & ~asked), ~self.energised
