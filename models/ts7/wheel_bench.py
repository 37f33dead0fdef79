"""TS-7, one channel on the test bench with the wheel switch set once for a run, as it is in service.

One step is one frame, 125 us.  On `Bench` both diameters are inputs, and proofs hold though they change; here they are
parameters, so that a claim may take one setting and a wheel that differs from it.
Source: switch 780..860 mm [P].
"""

from __future__ import annotations

from models.ts7.channel import Channel, Demand
from models.ts7.system import WheelSwitch
from models.ts7.train import Axle, Speed
from safety import U8, Bit


class WheelBench(WheelSwitch, tick_s="125e-6"):
    """One channel behind an axle, the wheel switch and the wheel's error being parameters."""

    a: Channel
    axle: Axle

    def step(self, word: U8, speed: Speed, lowered: Bit, backward: Bit) -> tuple[WheelBench, Demand]:
        """One frame at a true speed."""
        axle, seen = self.axle.step(speed, backward, (self.wheel + self.wheel_error).sat(8))
        a, demand = self.a.step(word, self.wheel, lowered, seen.pulse, seen.backward)
        return type(self)(axle=axle, a=a), demand
