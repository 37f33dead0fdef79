"""ATS-S: a stop alarm that the driver has to answer within 5 s, and no supervision of the speed.

    IDLE --stop read--> ALARM --brake operated before 5 s--> CONFIRMED --stop read--> ALARM
    ALARM --5 s over--> EMERGENCY (until standstill and reset)      CONFIRMED --proceed read--> IDLE
    any state --fault of supply, cycle or coil--> EMERGENCY

A step is a time stamp: the inputs hold from it to the next, `elapsed` is the time since the last one (s).  The brake
counts as operated when the handle stands in a braking position at some instant of [t0, t0 + 5 s), a level, no edge [A];
at t0 + 5.000 s it is late.  A further stop reading in ALARM leaves the timer alone, a proceed reading there changes
nothing [A].
Source: 5 s [P]; state machine [R]; free run 1.5 s, emergency brake 3.5 km/h/s [A].
Main results: unanswered, the emergency brake comes at 5.000 s, whatever else happens; a passive driver is stopped
before the signal from the warning distance v (5 + t_e) + v^2 / (2 b_e) on; who operates the brake and lets go is not
stopped.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from models.kinematics import B_EMERGENCY, T_EMERGENCY, Interval, ceiling, distance, not_negative
from safety import ANY, U2, Bit, Model, Real, UInt, assume, bit, parameter, point, power_up, select, word

IDLE, ALARM, CONFIRMED, EMERGENCY = range(4)
ALARM_S = Fraction(5)


def warning_distance(v: Fraction, b: Fraction = B_EMERGENCY, t: Fraction = T_EMERGENCY) -> Fraction:
    """D_req, m: where a driver who does nothing has to be warned, at v m/s; `ModelError` unless b > 0."""
    return Fraction(distance(v, b, ALARM_S + t))


def fastest_warned(
    at: Fraction, b: Fraction = B_EMERGENCY, t: Fraction = T_EMERGENCY, alarm: Fraction = ALARM_S
) -> Interval:
    """The speed, m/s, up to which a warning so many metres before the signal is enough.

    Raises ModelError for a place behind the signal, or a brake that stops no train.
    """
    not_negative("warning distance", at, "m")
    return ceiling(at, b, alarm + t)


class Warned(NamedTuple):
    """What ATS-S gives out."""

    bell: Bit
    emergency: Bit  # the line that holds the emergency brake off is dead
    confirmed: Bit


class AtsS(Model, event="a change of its inputs, or a cycle"):
    """The state machine; it powers up with the emergency brake on."""

    state: U2 = power_up(EMERGENCY)
    waited: Real = power_up(0)  # s since the alarm began
    alarm_s: Real = parameter(ALARM_S, unit="s", within=(1, 10), source="[P] 5 s alarm")

    def step(
        self, elapsed: Real, stop_read: Bit, proceed_read: Bit, braking: Bit, healthy: Bit, standing: Bit, reset: Bit
    ) -> tuple[AtsS, Warned]:
        """One time stamp: what the coil reads, the handle, the supervised supply, cycle and coil, and the reset."""
        assume("time does not run backwards", elapsed >= 0)
        stop_read, proceed_read = point("stop_read", stop_read), point("proceed_read", proceed_read)
        braking, healthy = point("braking", braking), point("healthy", healthy)
        ends = (self.state == EMERGENCY) & standing & reset
        begins = stop_read & ((self.state == IDLE) | (self.state == CONFIRMED) | ends)
        alarm = begins | (self.state == ALARM)
        waited = point("waited", select(begins, 0, select(self.state == ALARM, self.waited + elapsed, self.waited)))
        answer = self.answer(waited, braking)
        calm = ends | ((self.state == CONFIRMED) & proceed_read & ~stop_read)
        normal = select(alarm, answer, select(calm, word(IDLE, 2), self.state))
        state = point("state", select(healthy, normal, word(EMERGENCY, 2)))
        emergency = point("emergency", state == EMERGENCY)
        return type(self)(state=state, waited=waited), Warned(state == ALARM, emergency, state == CONFIRMED)

    def answer(self, waited: Real, braking: Bit) -> UInt:
        """The state that an alarm goes over to: too late first, then the level of the handle."""
        return select(waited >= self.alarm_s, word(EMERGENCY, 2), select(braking, word(CONFIRMED, 2), word(ALARM, 2)))


class AnswerFirst(AtsS, event="a change of its inputs, or a cycle"):
    """The variant to be refuted: the handle is looked at before the time is."""

    def answer(self, waited: Real, braking: Bit) -> UInt:
        """An answer at 5.000 s counts."""
        return select(braking, word(CONFIRMED, 2), select(waited >= self.alarm_s, word(EMERGENCY, 2), word(ALARM, 2)))


class Bench(Model, event="a change of its inputs, or a cycle"):
    """ATS-S beside a stop-watch that knows nothing of its states: how long a stop reading has been unanswered."""

    ats: AtsS
    open: Bit = power_up(False)  # a stop reading that neither the brake nor a reset has answered
    clock: Real = power_up(0)  # s since then

    def step(
        self, elapsed: Real, stop_read: Bit, proceed_read: Bit, braking: Bit, healthy: Bit, standing: Bit, reset: Bit
    ) -> tuple[Bench, Bit]:
        """One time stamp; `overdue`: a stop reading has been unanswered for 5 s."""
        was_reset = (self.ats.state == EMERGENCY) & standing & reset
        held = self.open & ~was_reset
        clock = select(held, self.clock + elapsed, 0)
        unanswered = stop_read | held
        ats, _ = self.ats.step(elapsed, stop_read, proceed_read, braking, healthy, standing, reset)
        following = type(self)(ats=ats, open=unanswered & ~braking, clock=clock)
        return following, point("overdue", unanswered & (clock >= self.ats.alarm_s))


class LateBench(Bench, event="a change of its inputs, or a cycle"):
    """The same with the variant that takes a late answer."""

    ats: AnswerFirst


class Motion(NamedTuple):
    """What train and driver do from one time stamp to the next."""

    gone: Real  # m, of these
    braked: Real  # m with the emergency brake in effect
    free: Real  # s without it
    speed: Real  # m/s at the end


class Braked(Model, event="a change of its inputs, or a cycle"):
    """A train without traction under an emergency brake, `to_go` metres before the signal."""

    to_go: Real = power_up(ANY)
    speed: Real = power_up(ANY)
    ordered: Real = power_up(0)  # s since the emergency brake was ordered
    t_e: Real = parameter(T_EMERGENCY, unit="s", within=(0, 5), source="[A] free run 1.5 s")
    b_e: Real = parameter(B_EMERGENCY, unit="m/s^2", within=(Fraction(1, 10), 3), source="[A] 3.5 km/h/s")

    def allowed(self, elapsed: Real, motion: Motion, order: Bit) -> None:
        """Assume what the train and its emergency brake keep to."""
        gone, braked, free, speed = motion
        assume("no traction, no way back", (speed >= 0) & (speed <= self.speed) & (braked >= 0) & (gone >= 0))
        assume("free run", (free >= 0) & (free <= elapsed) & (~order | (free == 0) | (free <= self.t_e - self.ordered)))
        assume("no farther than the speed takes it", gone <= self.speed * free + braked)
        assume("the brake acts after t_e", (order & (self.ordered + elapsed > self.t_e)) | (braked == 0))
        assume("deceleration at least b_e", speed * speed + 2 * self.b_e * braked <= self.speed * self.speed)


class Approach(Braked, event="a change of its inputs, or a cycle"):
    """A train with ATS-S that reads a stop balise at the first step, `to_go` metres before the signal.

    From one time stamp to the next it goes at most as far as its speed takes it: no traction.  The emergency brake acts
    `t_e` after it was ordered and then takes at least `b_e` from the speed every second, written as energy:
    speed^2 falls by 2 b_e for each metre.  The driver's own braking is any loss of speed.
    """

    ats: AtsS
    reading: Bit = power_up(True)
    warned_at: Real = power_up(ANY)  # ghost: the speed at the balise
    way: Real = power_up(ANY)  # ghost: what the emergency brake takes from that speed, less what it has taken, m

    def step(self, elapsed: Real, motion: Motion, braking: Bit, healthy: Bit) -> tuple[Approach, Warned]:
        """Move since the last time stamp, under the order given then; then ATS-S sees the handle as it is now."""
        order = self.ats.state == EMERGENCY
        assume("the first time stamp is that of the balise", ~self.reading | (elapsed == 0))
        self.allowed(elapsed, motion, order)
        no = bit(False)
        ats, warned = self.ats.step(elapsed, self.reading, no, braking, healthy, no, no)
        following = type(self)(
            ats=ats, reading=no, to_go=self.to_go - motion.gone, speed=motion.speed, warned_at=self.warned_at,
            ordered=select(order, self.ordered + elapsed, 0), way=self.way - motion.braked,
        )  # fmt: skip
        return following, warned
