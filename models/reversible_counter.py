"""The rival of the two-counter device: a reversible counter with feedback, in both readings of its printed equation.

Speed pulses f2 count up; a pulse divider lets k n f1 pulses of the oscillator through, which count down; the count n is
compared with nE.  Printed is n = f2/(k f1 + 1).  A counter that keeps its count settles at f2/(k f1), with the time
constant 1/(k f1): `ReversibleCounter`.  The printed sum comes out only if the count starts anew in each unit of time
and the divider follows the count of the unit before: `PeriodicSum`.

`ReversibleCounter`: one step is an oscillator pulse, 1/f1; k is 1/2048.  Speeds are V = f2/(6.4156 Hz per km/h) as for
the two-counter device, in 1/6415 km/h, so that one unit a step is 1.0001 km/h/s, and V/1000 pulses come in a step.
Source: up/down counter, pulse divider, n >= nE brakes, accuracy by the number of pulses [P]; same generator and
oscillator as the two-counter device, k, divider as an accumulator with carry, relay, unit of time [A].
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from safety import ANY, U2, U10, Bit, Int, Model, UInt, bit, parameter, point, power_up, select

U11 = Annotated[UInt, 11]

PER_KMH = 6415  # speed input for each km/h; a step longer by one unit is an acceleration of 1.0001 km/h/s
PULSE = 1000 * PER_KMH  # phase of one generator pulse
DIVISOR = 2048  # 1/k: oscillator pulses for each pulse down at a count of 1; the time constant in steps
FULL = 1023  # greatest count
Speed = Annotated[Int, (0, 400 * PER_KMH)]
Phase = Annotated[Int, (0, PULSE - 1)]


class Generator(Model, tick_s="155.8695e-6"):
    """Axle and speed generator."""

    phase: Phase = power_up(ANY)

    def step(self, speed: Speed) -> tuple[Generator, Bit]:
        """Turn for one step; a pulse when the phase completes a period."""
        turned = self.phase + speed
        full = turned >= PULSE
        return type(self)(phase=select(full, turned - PULSE, turned).clip(0, PULSE - 1)), point("pulse", full)


class PulseDivider(Model, tick_s="155.8695e-6"):
    """Lets n of every 2048 oscillator pulses through, evenly: n is added to an accumulator, its carry is the pulse."""

    rest: U11 = power_up(ANY)

    def step(self, n: U10, pulse: Bit) -> tuple[PulseDivider, Bit]:
        """One oscillator pulse, if it comes."""
        total = point("rest", self.rest) + select(pulse, n, 0)
        return type(self)(rest=total.low(11)), point("carry", total.bit(11))


class UpDownCounter(Model, tick_s="155.8695e-6"):
    """Counts up and down and stops at its ends; pulses that come together cancel each other."""

    n: U10 = power_up(ANY)

    def step(self, n: U10, up: Bit, down: Bit) -> UpDownCounter:
        """Count on from `n`, what its stages show."""
        return type(self)(n=select(up & ~down, (n + 1).sat(10), select(down & ~up, n.sat_sub(1), n)))


class Decision(NamedTuple):
    """The relay contact, true = brake, and the count."""

    brake: Bit
    count: UInt


class CheckSpeed(Model):
    """The count nE of the check speed."""

    limit: U10 = parameter(
        530, unit="pulse", within=(30, 1000), source="[A] 2048 oscillator pulses at f2E: 250 km/h; 30 is 5 km/h"
    )


class ReversibleCounter(CheckSpeed, tick_s="155.8695e-6"):
    """Reading with a count that is kept: dn/dt = f2 - k n f1; n >= nE brakes."""

    axle: Generator
    divider: PulseDivider
    counter: UpDownCounter

    def step(self, speed: Speed) -> tuple[ReversibleCounter, Decision]:
        """One oscillator pulse at a true speed."""
        axle, pulse = self.axle.step(speed)
        n = point("n", self.counter.n)
        divider, carry = self.divider.step(point("fed_back", n), point("f1", bit(True)))
        counter = self.counter.step(n, up=point("up", pulse), down=point("down", carry))
        over = point("over", n >= point("limit", self.limit))
        coil = point("coil", ~over & point("supply", bit(True)))
        following = type(self)(axle=axle, divider=divider, counter=counter)
        return following, Decision(brake=~point("contact", coil), count=n)


class PeriodicSum(CheckSpeed, tick_s="0.319219968"):
    """Reading with a sum over one unit of time: n = f2 - k f1 n', with n' of the unit before; k f1 is 1/4.

    One step is one unit of time, 2048 oscillator pulses; `pulses` is f2, the number of speed pulses in it.
    """

    n: U10 = power_up(ANY)
    rest: U2 = power_up(ANY)  # of the pulse divider

    def step(self, pulses: U10) -> tuple[PeriodicSum, Decision]:
        """Count up f2 from 0, and down what the divider lets through."""
        total = self.rest + self.fed_back()
        n = pulses.sat_sub(total >> 2)
        return type(self)(n=n, rest=total.low(2)), Decision(brake=n >= self.limit, count=n)

    def fed_back(self) -> UInt:
        """k f1 n' in quarters of a pulse."""
        return self.n


class StrongFeedback(PeriodicSum, tick_s="0.319219968"):
    """The same with k f1 = 1: to be refuted."""

    def fed_back(self) -> UInt:
        """k f1 n' in quarters of a pulse."""
        return 4 * self.n
