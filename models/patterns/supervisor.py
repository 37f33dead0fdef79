"""Discrete-time supervisor of a pattern: interval inputs, ceiling, warning, hysteresis, service and emergency brake.

One step is one cycle of 0.1 s [A]: read, compare, drop or hold the lines.  The train is somewhere in [v_lo, v_hi] and
[x_lo, x_hi]; compared is the unsafe combination, v_hi with the ceiling at x_lo.  The ceiling is the conservative one:
the train may accelerate by `a` until the brake acts; with a = 0 it is the plain one.
The four states are two registers: neither (FREE; WARN where a warning is given), `braking` (BRAKE), `latched`
(LATCHED).
Source: speed patterns, discrete-time supervisor [A]; parameters [A].

Main result: under the conservative ceiling with a budget of 3 cycles and the build-up, either brake alone keeps the
train before the protected point; the plain ceiling does so only without traction.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple, Self

from models.kinematics import (
    ACCELERATION,
    B_EMERGENCY,
    B_SERVICE,
    HYSTERESIS,
    T_EMERGENCY,
    T_SERVICE,
    T_WARNING,
    intervenes_accelerating,
    permits_accelerating,
)
from models.patterns.train import TICK
from safety import Bit, Model, Real, parameter, point, power_up

BRAKES = (Fraction("0.3"), Fraction("1.5"))  # m/s^2
TIMES = (Fraction("0.3"), Fraction(10))  # s


class Seen(NamedTuple):
    """What the supervisor knows of the train: intervals that contain the truth, and the driver's button."""

    v_lo: Real
    v_hi: Real
    x_lo: Real
    x_hi: Real
    acknowledged: Bit


class Lines(NamedTuple):
    """Lines that are dropped, and the warning."""

    service: Bit
    emergency: Bit
    warning: Bit


class Supervisor(Model, tick_s=TICK):
    """The four-state supervisor of a stopping pattern."""

    braking: Bit = power_up(False)
    latched: Bit = power_up(False)
    b_s: Real = parameter(B_SERVICE, unit="m/s^2", within=BRAKES, source="[A] service, on this gradient")
    b_e: Real = parameter(B_EMERGENCY, unit="m/s^2", within=BRAKES, source="[A] emergency, on this gradient")
    t_s: Real = parameter(T_SERVICE, unit="s", within=TIMES, source="[A] reaction budget, service")
    t_e: Real = parameter(T_EMERGENCY, unit="s", within=TIMES, source="[A] reaction budget, emergency")
    t_w: Real = parameter(T_WARNING, unit="s", within=(0, 20), source="[A] warning time")
    a: Real = parameter(ACCELERATION, unit="m/s^2", within=(0, 2), source="[A] most acceleration in the budget")
    h: Real = parameter(HYSTERESIS, unit="m/s", within=(0, 3), source="[A] below the ceiling before release")

    def step(self, seen: Seen) -> tuple[Self, Lines]:
        """One cycle."""
        v, x = self.compared(seen)
        over = point("over", self.above(v, x, self.b_s, self.t_s))
        braking = over | (self.braking & ~self.releases(v, x))
        freed = (seen.v_hi == 0) & seen.acknowledged
        latched = point("over_emergency", self.above(v, x, self.b_e, self.t_e)) | (self.latched & ~freed)
        warning = self.above(v, x, self.b_s, self.t_s + self.t_w)
        return type(self)(braking=braking, latched=latched), Lines(braking, latched, warning)

    def compared(self, seen: Seen) -> tuple[Real, Real]:
        """The end of each interval that is compared: the faster, the nearer."""
        return seen.v_hi, seen.x_lo

    def above(self, v: Real, x: Real, b: Real, t: Real) -> Bit:
        """Whether the ceiling is exceeded."""
        return intervenes_accelerating(v, x, b, t, self.a)

    def releases(self, v: Real, x: Real) -> Bit:
        """Whether the service brake may be released."""
        return permits_accelerating(v + self.h, x, self.b_s, self.t_s, self.a)
