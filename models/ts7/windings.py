"""TS-7 speed generator with its two windings: the sense of rotation as the circuit finds it, from their phase.

Both windings give one square wave a pulse, B a quarter of a period behind A while the axle turns forward.  Each rising
edge of A is a speed pulse f_s, and the level of B at that edge is the sense: low forward, high backward.  One step is
one frame, 125 us: levels are sampled once a frame, so a quarter period has to last for a frame (f_s below 2 kHz).

    forward    A  __----____----      backward   A  __----____----
               B  ____----____--                 B  ----____----__

The three channels sample the same levels at the same time, so their circuits are drawn once, at the axle; what fails in
one of them alone acts at its points `f_s` and `backward`.
Source: two windings, direction from their phase difference, by two ICs [P]; square waves, edges, sampling [A].
"""

from __future__ import annotations

from models.ts7.system import Ts7
from models.ts7.train import GREATEST_WHEEL, SCALE, Axle, Pulses, Speed
from models.ts7.wheel_bench import WheelBench
from safety import ANY, U8, Bit, assume, point, power_up, select


class Windings(Axle, tick_s="125e-6"):
    """Axle, generator with two windings, and the direction circuit."""

    was_high: Bit = power_up(ANY)  # level of A one frame before
    reverse: Bit = power_up(ANY)  # level of B at the last rising edge of A

    def step(self, speed: Speed, backward: Bit, wheel: U8) -> tuple[Windings, Pulses]:
        """Turn for one frame, then look at both windings."""
        period, quarter = SCALE * wheel, SCALE // 4 * wheel
        assume("wheel from 152 to 176 (760 to 880 mm)", (wheel >= 152) & (wheel <= GREATEST_WHEEL))
        assume("f_s below 2 kHz: a quarter period lasts for a frame", speed < quarter)
        assume("phase within one period", self.phase < period)
        on, back = self.phase + speed, self.phase - speed
        turned = select(backward, select(back < 0, back + period, back), select(on >= period, on - period, on))
        a = point("winding_a", turned < 2 * quarter)
        b = point("winding_b", (turned >= quarter) & (turned < 3 * quarter))
        pulse = point("pulse", a & ~self.was_high)
        reverse = point("backward", select(pulse, b, self.reverse))
        phase = turned.clip(0, SCALE * GREATEST_WHEEL - 1)
        return type(self)(phase=phase, was_high=a, reverse=reverse), Pulses(pulse, reverse)


class WoundBench(WheelBench, tick_s="125e-6"):
    """One channel on the test bench, the sense of rotation found by the circuit."""

    axle: Windings


class WoundTs7(Ts7, tick_s="125e-6"):
    """The whole equipment, the sense of rotation found by the circuit."""

    axle: Windings
