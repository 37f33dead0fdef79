"""Train, speed generator and standard oscillator of the two-counter ATC.

One step is one period of the standard oscillator as it is (nominally 155.8695 us).  Speed: thousandths of a generator
pulse per counting time Tc = 0.311739 s; 2000 are 1 km/h on the frequency scale V = f/k, k = 2/Tc.

The train turns by `speed` a step, an edge comes each time it has turned by `spacing`, nominally 500*n1F.  A fast
oscillator makes steps shorter and a large wheel turns less: both widen the spacing, so speed and step stay whole.
`phase` is p for a true phase in (p, p + 1]: an edge at the very instant of an oscillator pulse comes after it.  So
every continuous motion is run exactly by the steps ceil(P(k+1)) - ceil(P(k)) of its true position P.
Source: no pulses at standstill [P]; the wheel diameter is not corrected [P]; its size, drifts [A].
"""

from __future__ import annotations

from typing import Annotated

from models.two_counter import step_s
from models.two_counter.selection import Stages
from safety import ANY, U10, Bit, Int, Model, UInt, assume, bit, parameter, point, power_up, select

KMH = 2000  # speed units in 1 km/h
TURN = 500  # turning from edge to edge, for each of n1F
Speed = Annotated[Int, (0, 400 * KMH)]
Phase = Annotated[Int, (0, 2**21 - 1)]
Spacing = Annotated[UInt, 21]
PulseCount = Annotated[Int, (0, 2)]
Ppm = Annotated[Int, (-20_000, 20_000)]


class Train(Model, tick_s=step_s):
    """Axle and speed generator, two edges a pulse; `phase` is the way turned since the last edge."""

    phase: Phase = power_up(ANY)
    wheel: U10 = parameter(910, unit="mm", within=(840, 930), source="[A] true diameter; the equipment assumes 910")

    def step(self, speed: Speed, spacing: Spacing) -> tuple[Train, Bit]:
        """Turn for one step; whether an edge comes."""
        assume("phase within one edge", self.phase < spacing)
        turned = self.phase + point("f2", speed)
        full = turned >= spacing
        phase = select(full, turned - spacing, turned).clip(0, 2**21 - 1)
        return type(self)(phase=phase), point("edge", full)

    def spacing(self, n1f: Stages, error: Ppm) -> UInt:
        """Turning from edge to edge for an oscillator tuned to n1F, ppm off; rounded down, by less than 2.3 ppm.

        Rounded so the train seems to be that much faster, which is the safe side.
        """
        nominal = n1f * TURN * self.wheel // 910
        return (nominal * (error + 1_000_000).sat(21) // 1_000_000).low(21)


class Oscillator(Model, tick_s=step_s):
    """Standard oscillator f1: a pulse at the end of each step.

    On its second harmonic two come there, the first one half a period late: one count at most.
    """

    error: Ppm = parameter(0, unit="ppm", within=(-20_000, 20_000), source="[A] frequency above n1F/Tc")

    def step(self) -> tuple[Oscillator, PulseCount]:
        """Pulses in this step."""
        return type(self)(), (point("f1", bit(True)).word() + point("harmonic", bit(False)).word()).int().clip(0, 2)
