"""Point and continuous transmission of a stop to the train: magnet, resonant coil, trip arm, coded track current.

One step is one cycle of 0.1 s.  `proceed` is the signal as it is now, `passing` says that the train's coil (or cock) is
over the point in this cycle.  The brake of a point system latches; it is reset at standstill only.
Every line that prevents braking is held: de-energised brakes.
Source: the principles and their failures [P]; cycle, working speed of the arm, number of codes and detection time [A].
Main results: a point system is blind between points, and a failed track coil reads as proceed; the coded current has
neither fault, its loss is the most restrictive aspect.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from models.kinematics import KMH
from safety import Bit, Int, Model, Real, UInt, bit, parameter, point, power_up, real, select

CYCLE_S = "0.1"  # s [A]
STOP, SLOW, MEDIUM, CLEAR = range(4)  # codes of the track current; none is STOP
LIMITS = (0 * KMH, 25 * KMH, 45 * KMH, 100 * KMH)  # m/s that each allows [A]
Code = Annotated[Int, (STOP, CLEAR)]
U6 = Annotated[UInt, 6]


class Point(Model, tick_s=CYCLE_S):
    """What the point systems share: the brake latches when the held line drops, and is reset at standstill."""

    tripped: Bit = power_up(False)

    def latched(self, held: Bit, reset: Bit, standing: Bit) -> Bit:
        """The brake, given whether the line that prevents it is energised."""
        vented = ~point("valve", held)
        return vented | (self.tripped & ~(reset & standing))


class MagnetPoint(Point, tick_s=CYCLE_S):
    """Permanent magnet on the track, with a clearing coil that cancels it while energised (proceed)."""

    def step(self, proceed: Bit, passing: Bit, reset: Bit, standing: Bit) -> tuple[MagnetPoint, Bit]:
        """The magnet acts unless the clearing coil does; the second result is the brake."""
        magnet, cleared = point("magnet", bit(True)), point("clearing_coil", proceed)
        brake = self.latched(~(passing & magnet & ~cleared), reset, standing)
        return type(self)(tripped=brake), brake


class ResonantPoint(Point, tick_s=CYCLE_S):
    """Resonant track coil: at stop it absorbs energy of the oscillator on board, and the impulse relay drops.

    At proceed a contact short-circuits the capacitor, and the coil does not resonate: nor does one that is missing.
    """

    def step(self, proceed: Bit, passing: Bit, reset: Bit, standing: Bit) -> tuple[ResonantPoint, Bit]:
        """The relay is up while the oscillator swings freely; the second result is the brake."""
        tuned, shorted = point("track_coil", bit(True)), point("contact", proceed)
        absorbed = point("coupling", passing & tuned & ~shorted)
        relay = point("relay", point("oscillator", bit(True)) & ~absorbed)
        brake = self.latched(relay, reset, standing)
        return type(self)(tripped=brake), brake


class TripStop(Point, tick_s=CYCLE_S):
    """Mechanical trip stop: at stop an arm stands up and strikes the cock of the train pipe; too fast, it does not."""

    works_to: Real = parameter(20, unit="m/s", within=(0, 100), source="[A] it cannot work at high speed [P]")

    def step(self, proceed: Bit, passing: Bit, reset: Bit, standing: Bit, v: Real) -> tuple[TripStop, Bit]:
        """The cock stays closed unless the arm strikes it; the second result is the brake."""
        struck = passing & point("arm", ~proceed) & (v <= self.works_to)
        brake = self.latched(~point("cock", struck), reset, standing)
        return type(self)(tripped=brake), brake


class Shown(NamedTuple):
    """What the continuous channel gives."""

    limit: Real  # m/s
    decoded: Int
    brake: Bit


class ContinuousCode(Model, tick_s=CYCLE_S):
    """Coded track current: another code is taken once it has been there for the detection time, none at once.

    With codes that come and go the one held falls no later, since what counts is how long it has not been received.
    """

    held: Code = power_up(STOP)
    below: U6 = power_up(0)  # cycles for which less than the held code has been received
    above: U6 = power_up(0)
    detection: U6 = parameter(5, unit="cycle", within=(1, 40), source="[A] detection time 0.5 s")

    def step(self, code: Code, v: Real) -> tuple[ContinuousCode, Shown]:
        """One cycle: the code in the rails, and the speed that is compared with its limit."""
        current = point("track_current", bit(True))
        received = point("receiver", select(current, code, STOP).clip(STOP, CLEAR))
        less, more = received < self.held, received > self.held
        below, above = select(less, self.below + 1, 0).sat(6), select(more, self.above + 1, 0).sat(6)
        taken = (received == STOP) | (below >= self.detection) | (above >= self.detection)
        held = select(taken, received, self.held).clip(STOP, CLEAR)
        limit = allowed(held)
        brake = ~point("valve", (v <= limit) & (held != STOP))
        counts = {"below": select(taken, 0, below), "above": select(taken, 0, above)}
        return type(self)(held=held, **counts), Shown(limit, held, brake)


def allowed(code: Int) -> Real:
    """The limit of a code, m/s."""
    limit = real(LIMITS[STOP])
    for step in (SLOW, MEDIUM, CLEAR):
        limit = select(code == step, LIMITS[step], limit)
    return limit
