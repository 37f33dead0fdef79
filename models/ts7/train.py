"""The surroundings of TS-7: axle with speed generator, as ghost truth, and one channel on the test bench.

One step is one frame, 125 us.  Speed is the train's true speed in 1/4096 word per frame, so that a speed of n words
(0.47124 km/h each) is 4096*n: the *scaled phase*.  A generator period is 65536 times the diameter of the real wheel
in units of 5 mm, whatever the speed; so no division occurs, and speed may change every frame.  To a channel whose own
oscillator is fast by 1 % the train is slower by 1/1.01: in its own frames its drift is a change of speed.
Source: 60 pulses a revolution [A]; two windings whose phase tells the sense of rotation [P].
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from models.ts7.channel import Channel, Demand
from safety import ANY, U8, Bit, Int, Model, assume, point, power_up, select

SCALE = 65536  # phase of one generator pulse for each 5 mm of wheel diameter
PER_WORD = 4096  # speed input for each word
GREATEST_WHEEL = 176  # 880 mm, two steps above the greatest setting
Speed = Annotated[Int, (0, 2**24 - 1)]
Phase = Annotated[Int, (0, SCALE * GREATEST_WHEEL - 1)]


class Pulses(NamedTuple):
    """What the generator's windings deliver."""

    pulse: Bit
    backward: Bit


class Axle(Model, tick_s="125e-6"):
    """Axle and speed generator; `wheel` is the true diameter in units of 5 mm (156 = 780 mm .. 172 = 860 mm)."""

    phase: Phase = power_up(ANY)

    def step(self, speed: Speed, backward: Bit, wheel: U8) -> tuple[Axle, Pulses]:
        """Turn for one frame; a pulse when the phase completes a period."""
        period = SCALE * wheel
        assume("wheel from 152 to 176 (760 to 880 mm)", (wheel >= 152) & (wheel <= GREATEST_WHEEL))
        assume("f_s below 8 kHz: at most one pulse a frame", speed < period)
        assume("phase within one period", self.phase < period)
        turned = self.phase + speed
        full = turned >= period
        phase = select(full, turned - period, turned).clip(0, SCALE * GREATEST_WHEEL - 1)
        return type(self)(phase=phase), Pulses(point("pulse", full), point("backward", backward))


class Bench(Model, tick_s="125e-6"):
    """One channel on the test bench: true wheel and set wheel may differ, the word is free."""

    axle: Axle
    a: Channel

    def step(
        self, word: U8, speed: Speed, true_wheel: U8, wheel: U8, lowered: Bit, backward: Bit
    ) -> tuple[Bench, Demand]:
        """One frame at a true speed."""
        axle, seen = self.axle.step(speed, backward, true_wheel)
        a, demand = self.a.step(word, wheel, lowered, seen.pulse, seen.backward)
        return type(self)(axle=axle, a=a), demand
