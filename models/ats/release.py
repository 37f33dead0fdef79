"""Following the signal: release balises between the first balise and the signal, and what they cannot follow.

All balises of a signal show the same state.  A change to proceed is read at the next release balise: after the rest of
the spacing.  A change back to stop is read by nothing once the last one is passed.
Source: release balises [P]; spacing [A].
Main results: 200 m are 16.0 s at 45 km/h and 28.8 s at 25 km/h; a signal that returns to stop after a release leaves no
pattern (AV-4).
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple, Self

from models.ats.phase import Phase, PhaseReceiver
from models.ats.supervision import Events, Orders, Supervision
from models.kinematics import positive, refuse
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
               f"any below {float(stretch):g} m")  # fmt: skip
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

    def step(self, stop: Bit, passed: Passed, phase: Phase, where: Position, reset: Bit) -> tuple[Self, Orders]:
        """One cycle."""
        assume("the phase shows the signal", ~(phase.n & stop))
        receiver, released = self.receiver.step(phase, where)
        no = bit(False)
        events = Events(
            passed.signal & stop, passed.signal & ~stop, passed.release & ~stop, released, no, no, no, no, reset
        )
        sp, orders = self.sp.step(events, where)
        inside = point("approaching", (passed.signal | self.inside) & (where.low < self.sp.signal_at))
        return type(self)(sp=sp, receiver=receiver, inside=inside), orders
