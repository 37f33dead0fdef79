"""The supervised train with one slip each, or in a world that lacks one promise: each is refuted by a named claim.

Slips are of the equipment (the wrong end of an interval, a free run left out, a ceiling cut off at 0, a release without
hysteresis, the plain ceiling under traction); the others are of the surroundings.
"""

from __future__ import annotations

from models.kinematics import intervenes_accelerating, permits_accelerating
from models.patterns.supervised import EmergencyRun, Errors, Promised, ServiceRun
from models.patterns.supervisor import Seen, Supervisor
from models.patterns.train import TICK, T
from safety import Bit, Real, select


class LowerSpeed(Supervisor, tick_s=TICK):
    """Slip: the lower end of the speed's interval is compared."""

    def compared(self, seen: Seen) -> tuple[Real, Real]:
        """The slower end."""
        return seen.v_lo, seen.x_lo


class FartherPoint(Supervisor, tick_s=TICK):
    """Slip: the upper end of the distance's interval is compared."""

    def compared(self, seen: Seen) -> tuple[Real, Real]:
        """The farther end."""
        return seen.v_hi, seen.x_hi


class NoFreeRun(Supervisor, tick_s=TICK):
    """Slip: the ceiling leaves the free run out."""

    def above(self, v: Real, x: Real, b: Real, t: Real) -> Bit:
        """As if the brake came at once."""
        found: Bit = intervenes_accelerating(v, x, b, t * 0, self.a)
        return found


class Clamped(Supervisor, tick_s=TICK):
    """Slip: a conservative ceiling below 0 is taken as 0, so that a standing train may start."""

    def above(self, v: Real, x: Real, b: Real, t: Real) -> Bit:
        """Never at standstill."""
        return super().above(v, x, b, t) & (v > 0)


class Plain(Supervisor, tick_s=TICK):
    """The plain ceiling, which says nothing of traction in the reaction time."""

    def above(self, v: Real, x: Real, b: Real, t: Real) -> Bit:
        """Speed constant until the brake acts."""
        found: Bit = intervenes_accelerating(v, x, b, t, self.a * 0)
        return found


class NoHysteresis(Supervisor, tick_s=TICK):
    """Slip: the brake is released as soon as the ceiling is kept."""

    def releases(self, v: Real, x: Real) -> Bit:
        """At the ceiling itself."""
        found: Bit = permits_accelerating(v, x, self.b_s, self.t_s, self.a)
        return found


class LowerSpeedRun(ServiceRun, tick_s=TICK):
    """The train under that slip."""

    guard: LowerSpeed


class FartherPointRun(ServiceRun, tick_s=TICK):
    """The train under that slip."""

    guard: FartherPoint


class NoFreeRunRun(ServiceRun, tick_s=TICK):
    """The train under that slip."""

    guard: NoFreeRun


class ClampedRun(ServiceRun, tick_s=TICK):
    """The train under that slip."""

    guard: Clamped


class PlainRun(ServiceRun, tick_s=TICK):
    """The train under the plain ceiling, with traction."""

    guard: Plain


class WithoutTraction(PlainRun, tick_s=TICK):
    """The train under the plain ceiling, which has no traction."""

    def promised(self) -> Promised:
        """No acceleration."""
        return Promised(self.guard.b_s, self.guard.t_s, self.guard.a * 0)


class WeakBrake(ServiceRun, tick_s=TICK):
    """The brake gives nine tenths of what is guaranteed."""

    def push(self, acts: Bit, b: Real, a: Real) -> Real:
        """A tenth less."""
        return select(acts, -b * 9 / 10, a)


class WeakEmergencyBrake(EmergencyRun, tick_s=TICK):
    """The emergency brake gives nine tenths of what is guaranteed."""

    def push(self, acts: Bit, b: Real, a: Real) -> Real:
        """A tenth less."""
        return select(acts, -b * 9 / 10, a)


class NoFreeRunEmergency(EmergencyRun, tick_s=TICK):
    """The train under its emergency brake, the free run left out of the ceiling."""

    guard: NoFreeRun


class StrongTraction(ServiceRun, tick_s=TICK):
    """The train accelerates by a tenth more than is assumed."""

    def push(self, acts: Bit, b: Real, a: Real) -> Real:
        """A tenth more."""
        return select(acts, -b, a * 11 / 10)


class SlowBrake(ServiceRun, tick_s=TICK):
    """The brake takes two cycles longer than the budget of the supervisor."""

    def promised(self) -> Promised:
        """Two cycles more."""
        return Promised(self.guard.b_s, self.guard.t_s + 2 * T, self.guard.a)


class TruthOutside(ServiceRun, tick_s=TICK):
    """The intervals need not contain the truth."""

    def containing(self, errors: Errors) -> None:
        """Nothing is promised."""
