"""Ground program by pulse spacing: the crossings of a conductor in the track are the speed program.

The spacing of the crossings is laid so that a train at program speed receives its pulses at a constant base interval:
longer intervals ask for power, shorter ones for the brake, with a dead band.  No pulse for two base intervals brakes.
One step is a look: a pulse, or the watchdog in between; time stamps in s.  The two lines that are held are that against
the brake and that for power: de-energised brakes, and gives no power.
Source: principle [P]; base interval 0.3 s, dead band 5 %, departure order [A].

Main results: a train more than 1/19 faster than the program is braked at each pulse, silence brakes in time.  As the
rules stand no train would ever start, since at standstill no pulse comes: hence the departure order.  A receiver that
misses every second pulse gives power to a train that is too fast.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from safety import Bit, Model, Real, parameter, point, power_up, select

BASE, BAND, SILENT = Fraction("0.3"), Fraction(5, 100), 2  # s [A], share [A], base intervals [P]


class Orders(NamedTuple):
    """What the train is to do; neither is coasting."""

    power: Bit
    brake: Bit


class GroundProgram(Model, event="look at the pulse receiver"):
    """Interval between pulses against the base interval; it keeps its order until the next pulse."""

    pulsed: Real = power_up(0)  # stamp of the last pulse, s
    powering: Bit = power_up(False)
    braking: Bit = power_up(True)
    base: Real = parameter(BASE, unit="s", within=(Fraction(1, 100), 10), source="[A] T0")
    band: Real = parameter(BAND, unit="1", within=(0, Fraction(1, 2)), source="[A] dead band, share of T0")

    def step(self, pulse: Bit, now: Real, departs: Bit) -> tuple[GroundProgram, Orders]:
        """Whether a pulse comes now, the time stamp, the departure order of the driver (at standstill)."""
        received, stamp = point("receiver", pulse), point("clock", now)
        interval = stamp - self.pulsed
        long, short = interval > self.base * (1 + self.band), interval < self.base * (1 - self.band)
        silent = (interval > SILENT * self.base) & ~departs
        asked = (received & long) | (~received & self.powering)
        slowing = (received & short) | (~received & self.braking)
        brake = ~point("valve", ~(silent | (slowing & ~departs)))
        power = point("contactor", (asked | departs) & ~brake)
        pulsed = select(received | departs, stamp, self.pulsed)
        return type(self)(pulsed=pulsed, powering=asked, braking=brake), Orders(power, brake)
