"""Stepped high-speed limiter: each speed step has its own brake force, the brake comes above it with a dead band.

Continuous induction gives the step; the brake goes on above V_k + h_on and off at V_k - h_off.  No signal is step 0,
where the brake is on at any speed: with a dead band there a train might creep.
`SteppedLimiter` is the equipment, `Sections` a train with it; one step of `Sections` is the way through a section.
The line that prevents braking is held: de-energised brakes.
Source: principle, a force for each step [P]; ladder, forces, dead band, free run 2 s [A].

Main results: sections of 1829.63, 1026.39, 477.78, 237.30, 61.31 m, together 3632.41 m (3310.19 without free run), are
too short: with the dead band a train may enter a section at V_(k-1) + h_on, and needs more.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from models.kinematics import KMH, distance, need
from safety import Bit, Model, Real, any_of, assume, bit, parameter, point, power_up, real, require, select

LADDER = tuple(kmh * KMH for kmh in (210, 160, 110, 70, 30, 0))  # m/s [A]
FORCES = tuple(Fraction(text) * KMH for text in ("1.5", "2.0", "2.4", "2.8", "2.8"))  # m/s^2, to each next step [A]
EMERGENCY = Fraction(7, 5)  # of the service force of the step [A]
FREE_RUN = Fraction(2)  # s [A]
H_ON, H_OFF = 2 * KMH, 1 * KMH  # m/s [A]
DEAD_BAND = "[A] dead band, 2 and 1 km/h"
NEXT_SECTION = "entry of a section"


class Limited(NamedTuple):
    """What the equipment decides."""

    brake: Bit
    force: Real  # m/s^2, service brake of the step
    emergency: Real  # m/s^2, emergency brake of the step


class Limiter(Model, event=NEXT_SECTION):
    """Receiver, speed check, force table."""

    on: Bit = power_up(True)
    h_on: Real = parameter(H_ON, unit="m/s", within=(0, 5), source=DEAD_BAND)
    h_off: Real = parameter(H_OFF, unit="m/s", within=(0, 5), source=DEAD_BAND)

    def step(self, signal: Real, v: Real) -> tuple[Limiter, Limited]:
        """The limit that the code in the rails stands for, 0 without one, and the speed; m/s."""
        assume("a code of the ladder", any_of(*(signal == step for step in LADDER)))
        assume("runs forward", v >= 0)
        limit = select(point("track_current", bit(True)), point("receiver", signal), 0)
        speed = point("speed_generator", v)
        above, released = speed > limit + self.h_on, speed <= limit - self.h_off
        on = point("speed_check", self.at_zero(limit, above) | above | (self.on & ~released))
        brake = ~point("valve", ~on)
        force = point("force_table", force_to(limit))
        return type(self)(on=brake), Limited(brake, force, EMERGENCY * force)

    def at_zero(self, limit: Real, above: Bit) -> Bit:
        """At step 0 the brake is on at any speed."""
        return limit <= 0


class SteppedLimiter(Limiter, tick_s="0.1"):
    """The equipment by itself, looking every 0.1 s."""


class DeadBandAtZero(SteppedLimiter, tick_s="0.1"):
    """The variant to be refuted: at step 0 the brake has the dead band of the other steps."""

    def at_zero(self, limit: Real, above: Bit) -> Bit:
        """As at any step."""
        return (limit <= 0) & above


def force_to(limit: Real) -> Real:
    """The service deceleration of a step: with it the train is slowed to the step's limit, m/s^2."""
    force = real(FORCES[-1])
    for step, b in zip(LADDER[1:-1], FORCES, strict=False):
        force = select(limit == step, b, force)
    return select(limit >= LADDER[0], FORCES[0], force)


# --- sections --------------------------------------------------------------------------------------------------------


def length(number: int, dead_band: Fraction = H_ON, free_run: Fraction = FREE_RUN) -> Fraction:
    """Length of a section (0 the first): from the limit before, by `dead_band` too fast, to its own limit, m."""
    return Fraction(distance(LADDER[number] + dead_band, FORCES[number], free_run, LADDER[number + 1]))


LENGTHS = tuple(length(k) for k in range(len(FORCES)))  # from V_(k-1) + h_on
PRINTED = tuple(length(k, Fraction(0)) for k in range(len(FORCES)))  # from V_(k-1)
LONG, SHORT = "[A] from V_(k-1) + h_on to V_k", "[A] from V_(k-1) to V_k"


def _length(number: int, lengths: tuple[Fraction, ...] = LENGTHS, source: str = LONG) -> Real:
    found: Real = parameter(lengths[number], unit="m", within=(1, 10000), source=source)
    return found


class Entry(NamedTuple):
    """What was passed through, and what holds from here on."""

    way: Real  # m, of the section that is left
    was: Real  # its limit, m/s
    left_last: Bit  # it was the section in which the train has to stop
    limit: Real
    brake: Bit


class Ladder(Model, event=NEXT_SECTION):
    """The lengths of the sections."""

    l1: Real = _length(0)
    l2: Real = _length(1)
    l3: Real = _length(2)
    l4: Real = _length(3)
    l5: Real = _length(4)

    def lengths(self) -> tuple[Real, ...]:
        """In running order, m."""
        return self.l1, self.l2, self.l3, self.l4, self.l5

    def long_enough(self) -> None:
        """From V_(k-1) + h_on each section leaves room to come down to V_k + h_on, the last one to 0."""
        for number, (own, b) in enumerate(zip(self.lengths(), FORCES, strict=True)):
            reached = LADDER[number + 1] + H_ON if LADDER[number + 1] else Fraction(0)
            fits = need(LADDER[number] + H_ON, b, FREE_RUN, reached) <= 2 * b * own
            nearest = f"the nearest admissible length is {float(_least(number)):.3f} m"
            require(f"section {number + 1} is too short for the dead band", fits, nearest)


class Sections(Ladder, event=NEXT_SECTION):
    """A train that comes at 210 km/h and goes down the ladder, section by section, again and again."""

    limiter: Limiter
    in_1: Bit = power_up(False)
    in_2: Bit = power_up(False)
    in_3: Bit = power_up(False)
    in_4: Bit = power_up(False)
    in_5: Bit = power_up(False)
    before: Real = power_up(0)  # speed at the last entry, m/s

    def step(self, v: Real) -> tuple[Sections, Entry]:
        """The next section is entered at a speed, m/s; after the fifth another train comes."""
        self.long_enough()
        inside = (self.in_1, self.in_2, self.in_3, self.in_4, self.in_5)
        way, was, limit = real(0), real(LADDER[0]), real(LADDER[1])
        for here, length_, own, following in zip(
            inside, self.lengths(), LADDER[1:], (*LADDER[2:], LADDER[-1]), strict=True
        ):
            way, was, limit = select(here, length_, way), select(here, own, was), select(here, following, limit)
        limiter, seen = self.limiter.step(limit, v)
        after = type(self)(
            limiter=limiter, in_1=~any_of(*inside), in_2=self.in_1, in_3=self.in_2, in_4=self.in_3, in_5=self.in_4,
            before=v,
        )  # fmt: skip
        return after, Entry(way, was, self.in_5, limit, seen.brake)


class PrintedSections(Sections, event=NEXT_SECTION):
    """Sections as long as from V_(k-1) to V_k, without the dead band.  To be refuted."""

    l1: Real = _length(0, PRINTED, SHORT)
    l2: Real = _length(1, PRINTED, SHORT)
    l3: Real = _length(2, PRINTED, SHORT)
    l4: Real = _length(3, PRINTED, SHORT)
    l5: Real = _length(4, PRINTED, SHORT)

    def long_enough(self) -> None:
        """Nothing is required of them."""


def _least(number: int) -> Fraction:
    """The least length that the dead band leaves, m."""
    reached = LADDER[number + 1] + H_ON if LADDER[number + 1] else Fraction(0)
    return Fraction(distance(LADDER[number] + H_ON, FORCES[number], FREE_RUN, reached))


def longer_by_reading(error: Fraction, number: int = 0) -> Fraction:
    """How much longer the braking of a section gets, free run apart, if the speed reads low by a share, m."""
    fast = LADDER[number] * (1 + error)
    return Fraction(distance(fast, FORCES[number], 0) - distance(LADDER[number], FORCES[number], 0))
