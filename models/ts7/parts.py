"""Parts of a TS-7 speed-check channel: divider, comparator, check window, output drive.

One step is one frame, 125 us.
Source: functions (a)-(f) of a speed-check part [P]; the circuits are not published, these are the reference [A].
"""

from __future__ import annotations

from typing import Self

from safety import ANY, U2, U4, U8, Bit, Model, UInt, point, power_up, select


class Divider(Model, tick_s="125e-6"):
    """Post-divider: one pulse out for 16 in [A]; without it one word unit would be 7.54 km/h."""

    n: U4 = power_up(ANY)  # pulses since the last one out

    def step(self, pulse: Bit) -> tuple[Divider, Bit]:
        """Count; the pulse out comes with the sixteenth pulse in."""
        counted = point("n", self.n) + pulse.word()
        return type(self)(n=counted.low(4)), counted.bit(4)


class Comparator(Model, tick_s="125e-6"):
    """Which of two pulse trains is faster: a counter 0..3 that stops at its ends, and a latch [A].

    The latch sets at 3 (the upper train is three pulses ahead), clears at 0, and holds in between.
    """

    u: U2 = power_up(3)
    latch: Bit = power_up(True)

    def step(self, up: Bit, down: Bit) -> tuple[Self, Bit]:
        """Count `up` and `down`, neither when both come in one frame; the latch follows in the same frame."""
        rise, fall = up & ~down, down & ~up
        u = point("u", select(rise, (self.u + 1).sat(2), select(fall, self.u.sat_sub(1), self.u)))
        latch = point("latch", (u == 3) | (self.latch & (u != 0)))
        return type(self)(u=u, latch=latch), latch


class RollBackComparator(Comparator, tick_s="125e-6"):
    """The comparator of roll-back detection: at power-up it says not reverse [A]."""

    u: U2 = power_up(0)
    latch: Bit = power_up(False)


QUARTER, HALF = 64, 128  # overflows in 256 frames at 1/4 and 1/2 of the word frequency 8 kHz


class CheckWindow(Model, tick_s="125e-6"):
    """Fault detection: the ring-made 1/3 of the word frequency must lie between 1/4 and 1/2 [R].

    Overflows of the check word are counted over blocks of 256 frames (32 ms); the fault stays for ever.  All three
    rates come from one oscillator: its drift is not seen here.
    """

    frame: U8 = power_up(0)
    count: U8 = power_up(0)  # overflows in this block so far
    faulty: Bit = power_up(False)

    def step(self, overflow: Bit) -> tuple[CheckWindow, Bit]:
        """Count one frame; judge at the last one of a block."""
        counted, last = self.count + overflow.word(), self.frame == 255
        faulty = point("faulty", self.faulty | (last & ~self.normal(counted)))
        count = select(last, 0, counted.low(8))
        return type(self)(frame=(self.frame + 1).low(8), count=count, faulty=faulty), faulty

    def normal(self, counted: UInt) -> Bit:
        """Strictly between both ends."""
        return (counted > QUARTER) & (counted < HALF)


class Drive(Model, tick_s="125e-6"):
    """Output amplifier with AC drive: it toggles while the channel permits the train to run [P].

    The relay hangs on a transformer and a rectifier: an output that stands still, high or low, drops it.
    """

    level: Bit = power_up(False)

    def step(self, run: Bit) -> tuple[Drive, Bit]:
        """Toggle once a frame (4 kHz [A]) while `run`; the second result says whether there is AC."""
        level = point("level", self.level ^ point("toggle", run))
        return type(self)(level=level), level ^ self.level
