"""Position from axle pulses, with slip and slide detection and an interval that holds the train.

One step is one cycle.  Way and speed of the wheel are those that the pulses give; the true ones differ by the factor
1 + scale error, |scale error| <= eps, as long as the wheel grips.  Speeds are means over a cycle: the true mean of a
cycle differs from that of the cycle before by at most a_hi (b_hi) times the cycle, so nothing is lost by that.

    NORMAL  the wheel's speed counts; v_0 is the last one counted
    SLIP    the wheel turns faster than the train: from v_0 - b_hi t to v_0 + a_hi t
    SLIDE   the wheel turns slower than the train, which brakes: from the larger of the wheel's speed and v_0 - b_hi t
            to the larger of the wheel's speed and v_0

A fix puts the train to a place at the beginning of a cycle (`step`), or at its end (`put`).  Speeds in pulses need the
time between pulses: a pulse more or less in a cycle of 0.1 s would be 0.45 m/s, thrice what slip detection takes for a
slip.  Pulses have no sign: the benches assume it of them, for the odometer cannot, where faults reach them.
Source: integration of axle pulses, slip and slide corrected, balises at most about 1 km apart [P]; all numbers [A].
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple, Self

from models.kinematics import CYCLE, KMH
from safety import Bit, Model, Real, assume, parameter, point, power_up, real, select

PI = Fraction(355, 113)  # as stored on board; its error of 8.5e-8 is part of the scale error
PULSES = 60  # a revolution [A]


def step_s(cycle: Fraction = CYCLE) -> Fraction:
    """Seconds of a step."""
    return cycle


def larger(a: Real, b: Real) -> Real:
    """The larger of two reals."""
    return select(a >= b, a, b)


def smaller(a: Real, b: Real) -> Real:
    """The smaller of two reals."""
    return select(a <= b, a, b)


class Fix(NamedTuple):
    """What is known before a cycle, if `given`: the train is at `place`, surely between `low` and `high`, m."""

    given: Bit
    low: Real
    place: Real
    high: Real


def ordered(fix: Fix) -> Bit:
    """Whether a fix, if given, lies in its interval."""
    return ~fix.given | ((fix.low <= fix.place) & (fix.place <= fix.high))


class Mode(NamedTuple):
    """What the odometer takes the wheel to do in this cycle."""

    slipping: Bit
    sliding: Bit
    fallen: Bit  # in SLIP: the wheel has slowed down as in a slide


class Speeds(NamedTuple):
    """Mean speed over the cycle, m/s."""

    low: Real
    high: Real


class Position(NamedTuple):
    """Where the train is at the end of the cycle, m, and how fast, m/s; for supervision `high` and `fastest`."""

    low: Real
    guess: Real
    high: Real
    slowest: Real
    fastest: Real


class SpeedGenerator(Model, tick_s=step_s):
    """Axle pulses to the speed of the wheel's tread, for the diameter that is set."""

    diameter: Real = parameter(Fraction("0.86"), unit="m", within=(Fraction("0.7"), 1), source="[A] as set")

    def step(self, pulses: Real) -> tuple[SpeedGenerator, Real]:
        """Pulses a second, by the time between pulses; m/s."""
        return type(self)(), point("pulses", pulses) * self.diameter * (PI / PULSES)


class Thresholds(Model):
    """What detection and recovery go by."""

    a_slip: Real = parameter(Fraction("1.2"), unit="m/s^2", within=(0, 10), source="[A] above it the wheel slips")
    a_slide: Real = parameter(Fraction("-1.5"), unit="m/s^2", within=(-10, 0), source="[A] below it the wheel slides")
    agrees: Real = parameter(KMH, unit="m/s", within=(0, 10), source="[A] 1 km/h")
    recovery: Real = parameter(Fraction("0.5"), unit="s", within=(0, 10), source="[A] agreement before NORMAL")


class WheelWatch(Thresholds, tick_s=step_s):
    """Slip and slide detection from the wheel's speed alone, and the estimated speed."""

    slip: Bit = power_up(False)
    slide: Bit = power_up(False)
    fell: Bit = power_up(False)
    wheel: Real = power_up(0)  # m/s, of the last cycle
    guess: Real = power_up(0)  # v_est, m/s
    trend: Real = power_up(0)  # m/s gained in the last normal cycle
    near: Real = power_up(0)  # s for which wheel and guess have agreed

    def step(self, speed: Real, cycle: Real, b_hi: Real) -> tuple[WheelWatch, Mode]:
        """One cycle: the wheel's mean speed, m/s; the cycle, s; the hardest braking, m/s^2."""
        gained, was_normal, loss = speed - self.wheel, ~self.slip & ~self.slide, b_hi * cycle
        drops, guess = gained < self.a_slide * cycle, carried(self.guess, self.trend, self.slide, loss)
        close = (speed - guess < self.agrees) & (guess - speed < self.agrees)
        near = select(~was_normal & close, self.near + cycle, 0)
        caught = drops & select(self.slip, speed <= guess, was_normal)
        again = ~was_normal & (near >= self.recovery) & ~caught
        slip = point("slip", (self.slip & ~caught & ~again) | (was_normal & (gained > self.a_slip * cycle)))
        slide = point("slide", caught | (self.slide & ~again))
        normal, fell = ~slip & ~slide, slip & (self.fell | (self.slip & drops))
        following = type(self)(
            slip=slip, slide=slide, fell=fell, wheel=speed, near=select(normal | caught, 0, near),
            guess=select(normal, speed, carried(self.guess, self.trend, slide, loss)),
            trend=select(normal, gained, self.trend),
        )  # fmt: skip
        return following, Mode(slip, slide, fell)


def carried(guess: Real, trend: Real, slide: Bit, loss: Real) -> Real:
    """The estimate a cycle later: as in the last normal cycle, in a slide losing no more than is possible."""
    braking = larger(-loss, smaller(trend, real(0)))
    return larger(guess + select(slide, braking, trend), real(0))


class SpeedBounds(Model, tick_s=step_s):
    """Bounds of the true mean speed: `floor` is v_0 - b_hi t, `top` is v_0 + a_hi t in SLIP and stays in SLIDE."""

    floor: Real = power_up(0)
    top: Real = power_up(0)

    def step(self, wheel: Real, mode: Mode, eps: Real, gain: Real, loss: Real) -> tuple[Self, Speeds]:
        """One cycle: the wheel's speed, the most that a cycle gains and loses, m/s."""
        least, most = wheel - eps * wheel, wheel + eps * wheel
        normal, floor = ~mode.slipping & ~mode.sliding, self.floor - loss
        top = select(normal, most, select(mode.slipping, self.top + gain, self.carried(most)))
        low = select(normal, least, larger(real(0), select(mode.sliding, larger(least, floor), floor)))
        slipping = select(mode.fallen, top, smaller(most, top))
        sure = select(mode.sliding, larger(most, self.sliding(top, gain)), slipping)
        following = type(self)(floor=select(normal, least, floor), top=top)
        return following, Speeds(low, select(normal, most, sure))

    def carried(self, most: Real) -> Real:
        """`top` a cycle later in a slide."""
        return self.top

    def sliding(self, top: Real, gain: Real) -> Real:
        """The most that the train runs in a slide."""
        return top


class HighestSeen(SpeedBounds, tick_s=step_s):
    """A variant [A] that keeps the highest speed that the wheel shows in a slide, and allows for gains before it.

    Then a train that has gripped and gained speed before NORMAL is declared, and slides again, is still within.  A
    slide begins within a cycle: the speed at that instant can be above the mean of the cycle before by 1.5 a_hi T.
    """

    def carried(self, most: Real) -> Real:
        """`top`, or the wheel's speed where that is higher."""
        return larger(most, self.top)

    def sliding(self, top: Real, gain: Real) -> Real:
        """Two cycles of gain more."""
        return top + 2 * gain


class Odometer(Model, tick_s=step_s):
    """The position as one number (trapezoids of v_est in a slip or slide) and as an interval."""

    watch: WheelWatch
    bounds: SpeedBounds
    s: Real = power_up(0)
    s_lo: Real = power_up(0)
    s_hi: Real = power_up(0)
    cycle: Real = parameter(CYCLE, unit="s", within=(Fraction(1, 1000), 1), source="[A] control cycle")
    eps: Real = parameter(Fraction("0.01"), unit="1", within=(0, Fraction("0.1")), source="[A] scale error")
    a_hi: Real = parameter(1, unit="m/s^2", within=(0, 2), source="[A] the train gains no more")
    b_hi: Real = parameter(Fraction("1.3"), unit="m/s^2", within=(0, 3), source="[A] the train loses no more")

    def step(self, wheel: Real, fix: Fix) -> tuple[Self, Position]:
        """One cycle: the wheel's mean speed over it, m/s, without sign, and a fix at its beginning."""
        assume("a fix lies in its interval", ordered(fix))
        cycle, gain, loss = self.cycle, self.a_hi * self.cycle, self.b_hi * self.cycle
        watch, mode = self.watch.step(wheel, cycle, self.b_hi)
        bounds, speeds = self.bounds.step(wheel, mode, self.eps, gain, loss)
        mean = select(mode.slipping | mode.sliding, (self.watch.guess + watch.guess) / 2, wheel)
        s = select(fix.given, fix.place, self.s) + mean * cycle
        s_lo = select(fix.given, fix.low, self.s_lo) + speeds.low * cycle
        s_hi = select(fix.given, fix.high, self.s_hi) + speeds.high * cycle
        following = type(self)(watch=watch, bounds=bounds, s=s, s_lo=s_lo, s_hi=s_hi)
        return following, Position(s_lo, s, s_hi, larger(real(0), speeds.low - loss), speeds.high + gain)

    def put(self, fix: Fix) -> Self:
        """The position moved to what is known at the end of the cycle."""
        s, low = select(fix.given, fix.place, self.s), select(fix.given, fix.low, self.s_lo)
        return self.replaced(s=s, s_lo=low, s_hi=select(fix.given, fix.high, self.s_hi))


class RememberingOdometer(Odometer, tick_s=step_s):
    """The odometer with the variant of the bounds."""

    bounds: HighestSeen
