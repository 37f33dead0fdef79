"""Following the signal: release balises between the first balise and the signal, and what they cannot follow.

All balises of a signal show the same state.  A change to proceed is read at the next release balise: after the rest of
the spacing.  A change back to stop is read there, too, or by the phase in the approach section (extension): the pattern
is made again.  Behind the last balise, and without the extension, nothing reads it.
Source: release balises [P]; spacing, extension [A].
Main results: 200 m are 16.0 s at 45 km/h and 28.8 s at 25 km/h; a signal that returns to stop has its pattern from the
next release balise on, or at once by the phase; behind the last one, without the phase, none (AV-4).
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple, Self

from models.ats.phase import Phase, PhaseReceiver, Told
from models.ats.supervision import Events, Orders, Supervision
from models.kinematics import at_most, positive, refuse
from models.position.odometer import Position, step_s
from safety import Bit, Model, assume, bit, point, power_up


def detection_delay(rest: Fraction, speed: Fraction) -> Fraction:
    """Seconds until a change to proceed is read, `rest` m before the next release balise, at a speed in m/s.

    Raises ModelError for a train that stands: it never gets there.
    """
    positive("speed", speed, "m/s")
    return rest / speed


def balises(first: Fraction, signal: Fraction, spacing: Fraction) -> list[Fraction]:
    """Places of release balises, m, at most `spacing` apart, from the first balise to the last before the signal.

    Raises ModelError for a spacing that the stretch does not have, with the nearest admissible one.
    """
    positive("spacing", spacing, "m")
    stretch = signal - first
    if spacing >= stretch:
        refuse("spacing", spacing, "m", f"it leaves no release balise in {float(stretch):g} m",
               f"any below {at_most(stretch)} m")  # fmt: skip
    count = -(-stretch // spacing) - 1
    return [first + spacing * k for k in range(1, int(count) + 1)]


class Passed(NamedTuple):
    """Which balises of the signal the train passes in this cycle."""

    signal: Bit
    release: Bit


class Following(Model, tick_s=step_s):
    """Supervision of a train that comes up to a signal; `stop` is the truth, all balises and the phase show it."""

    sp: Supervision
    receiver: PhaseReceiver
    inside: Bit = power_up(False)  # between the signal balise and the signal
    read: Bit = power_up(False)  # ghost: a balise was passed at stop, and the signal has been at stop since

    def step(self, stop: Bit, passed: Passed, phase: Phase, where: Position, reset: Bit) -> tuple[Self, Orders]:
        """One cycle."""
        assume("the phase shows the signal", ~(phase.n & stop))
        receiver, told = self.receiver.step(phase, where)
        no, stopped = bit(False), (passed.signal & stop) | self.again(passed, stop, told)
        events = Events(stopped, passed.signal & ~stop, passed.release & ~stop, told.proceed, no, no, no, no, reset)
        sp, orders = self.sp.step(events, where)
        inside = point("approaching", (passed.signal | self.inside) & (where.low < self.sp.signal_at))
        read = point("known_at_stop", stop & (self.read | passed.signal | passed.release))
        return type(self)(sp=sp, receiver=receiver, inside=inside, read=read), orders

    def again(self, passed: Passed, stop: Bit, told: Told) -> Bit:
        """What makes the pattern again."""
        return (passed.release & stop) | told.stop


class OnlyByPhase(Following, tick_s=step_s):
    """The variant to be refuted: a release balise at stop does not make the pattern again."""

    def again(self, passed: Passed, stop: Bit, told: Told) -> Bit:
        """The phase does."""
        return told.stop


class OnlyByBalise(Following, tick_s=step_s):
    """The variant to be refuted, without the extension: the phase back to stop does not make the pattern again."""

    def again(self, passed: Passed, stop: Bit, told: Told) -> Bit:
        """A release balise does."""
        return passed.release & stop
