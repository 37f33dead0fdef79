"""American code control: cab signals from coded current, a B point before the stop signal, acknowledgement of red.

One step is one cycle of 0.1 s; timers run on time stamps.  At the B point, a braking distance before the stop signal,
the current ends and the cab signal falls to red: a limit of 15 mph, and an emergency brake unless the driver presses
the button within the acknowledgement time.  The button counts when it is pressed while red shows, not while it is held.
Every line that prevents braking is held: de-energised brakes.
Source: aspects, limits, acknowledgement [P]; cycle, time of 6 s, edge, latch to standstill, braking 0.6 m/s^2 after a
free run of 3 s [A].
Main results: who does not acknowledge is braked by the emergency brake in time, for ever; who does may creep past the
signal (SP-X3).
"""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, NamedTuple

from models.kinematics import KMH
from safety import Bit, Int, Model, Real, bit, parameter, point, power_up, real, select

MPH = Fraction(1609344, 1000000) * KMH  # m/s, exactly
RED, APPROACH, APPROACH_MEDIUM, CLEAR = range(4)
LIMITS = (15 * MPH, 25 * MPH, 45 * MPH, 90 * MPH)  # m/s [P]
DECELERATION, FREE_RUN = Fraction("0.6"), Fraction(3)  # m/s^2, s [A]
Aspect = Annotated[Int, (RED, CLEAR)]


class Cab(NamedTuple):
    """What the driver sees, and the brakes."""

    aspect: Int
    limit: Real  # m/s
    acknowledged: Bit
    brake: Bit
    emergency: Bit


class Answers:
    """The two rules of acknowledgement, which the variants change."""

    def acknowledges(self, pushed: Bit, before: Bit) -> Bit:
        """The button counts as it goes down."""
        return pushed & ~before

    def expired(self, waited: Real, patience: Real) -> Bit:
        """Red has been left unanswered for the acknowledgement time."""
        return waited >= patience


class CodeControl(Answers, Model, tick_s="0.1"):
    """Cab signal with acknowledgement; stamps count from power-up, at which it shows red."""

    shown: Aspect = power_up(RED)
    since: Real = power_up(0)  # stamp at which red has come
    stamp: Real = power_up(0)  # of the last cycle
    pressed: Bit = power_up(True)  # at power-up as if held: it has to be released first
    agreed: Bit = power_up(False)
    latched: Bit = power_up(False)
    patience: Real = parameter(6, unit="s", within=(Fraction(1, 10), 60), source="[A] T_ack")

    def step(self, code: Aspect, button: Bit, v: Real, now: Real) -> tuple[CodeControl, Cab]:
        """One cycle: code in the rails, button, speed in m/s, time stamp in s."""
        stamp = point("clock", now)
        aspect, pushed = point("receiver", code), point("ack_button", button)
        red = aspect == RED
        comes = red & (self.shown != RED)
        since = select(comes, stamp, self.since)
        agreed = red & ~comes & (self.agreed | self.acknowledges(pushed, self.pressed))
        late = red & ~agreed & self.expired(stamp - since, self.patience)
        emergency = ~point("emergency_valve", ~(late | (self.latched & (v > 0))))
        limit = limit_of(aspect)
        brake = emergency | ~point("valve", v <= limit)
        after = type(self)(
            shown=aspect, since=since, stamp=stamp, pressed=pushed, agreed=agreed, latched=emergency
        )  # fmt: skip
        return after, Cab(aspect, limit, agreed, brake, emergency)


class HeldButton(CodeControl, tick_s="0.1"):
    """The variant to be refuted: a button that is held, or stuck closed, acknowledges every red."""

    def acknowledges(self, pushed: Bit, before: Bit) -> Bit:
        """The button counts as long as it is down."""
        return pushed


class SilenceAccepted(CodeControl, tick_s="0.1"):
    """The variant to be refuted: a missing acknowledgement is accepted."""

    def expired(self, waited: Real, patience: Real) -> Bit:
        """Never: silence counts as an answer."""
        return bit(False)


def limit_of(aspect: Int) -> Real:
    """The limit of a cab signal, m/s."""
    limit = real(LIMITS[RED])
    for step in (APPROACH, APPROACH_MEDIUM, CLEAR):
        limit = select(aspect == step, LIMITS[step], limit)
    return limit
