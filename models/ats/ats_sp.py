"""The on-board set of ATS-SP: from coil, axle pulses, track current and timetable to the brake lines.

    coil ----- reading of a balise ------+--> locator --> position --+
    speed generator --- pulses ----------+                           +--> supervision --> service, emergency line
    receiver -- phase of the section ------------------------------> |                --> "stopping" to the loop
    timetable -- station stop -------------------------------------> |

Both brake lines hold the brake off: dead lines brake, so loss of supply or of the program's cycle brakes at once.  A
balise whose shift is neither that of stop nor that of proceed is read as stop.  A stop balise that cannot be assigned,
because the position is not sure or the line data do not have it, and the loss of a sure position, make the pattern for
the shortest distance on the line.  A balise passed in a cycle counts as at that cycle's beginning.
Source: architecture, pattern set [P]; line data of one home signal, rules in detail [A].
"""

from __future__ import annotations

from typing import NamedTuple, Self

from models.ats.overrun import StationStop
from models.ats.phase import Phase, PhaseReceiver
from models.ats.supervision import PLACES, Events, Orders, Supervision
from models.position.correction import BRANCH, RELEASE, SIGNAL, Matched
from models.position.locator import Locator
from models.position.odometer import Fix, step_s
from safety import U2, Bit, Model, Real, bit, parameter, point, power_up, require


class Shift(NamedTuple):
    """What the oscillation unit makes of a balise: its kind, and which of the two states its frequency is shifted
    to."""

    seen: Bit
    kind: U2
    stop: Bit
    proceed: Bit


class Reading(NamedTuple):
    """A balise as understood."""

    seen: Bit
    kind: U2
    stop: Bit


class Coil(Model, tick_s=step_s):
    """On-board coil and oscillation unit."""

    def step(self, shift: Shift) -> tuple[Self, Reading]:
        """One cycle."""
        seen = point("seen", shift.seen)
        stop, proceed = point("shows_stop", shift.stop), point("shows_proceed", shift.proceed)
        return type(self)(), Reading(seen, shift.kind, self.understood(stop, proceed))

    def understood(self, stop: Bit, proceed: Bit) -> Bit:
        """Everything but a clear proceed is stop."""
        return stop | ~proceed


class UnknownIsProceed(Coil, tick_s=step_s):
    """The variant to be refuted."""

    def understood(self, stop: Bit, proceed: Bit) -> Bit:
        """Only a clear stop is stop."""
        return stop & ~proceed


class Inputs(NamedTuple):
    """What comes in from outside the set."""

    timetable_stop: Bit
    departing: Bit  # departure announced to the crossing
    reset: Bit
    supply: Bit
    cycle: Bit  # the program runs its cycles


class Outputs(NamedTuple):
    """What goes out."""

    service_line: Bit  # holds the service brake off
    emergency_line: Bit  # holds the emergency brake off
    stopping: Bit  # message to the loop before a crossing
    display: Bit  # a pattern acts


class Assigned(Model, tick_s=step_s):
    """The line data of one home signal, its release and branch balises: which target a balise is for."""

    crossing_at: Real = parameter(1100, unit="m", within=PLACES, source="[A] line data: level crossing")

    def told(self, read: Reading, matched: Matched, released: Bit) -> Events:
        """A reading assigned to the targets."""
        mine, off = read.seen & matched.adopted, bit(False)
        signal = read.seen & (read.kind == SIGNAL)
        return Events(
            stop_read=mine & signal & read.stop, clear_read=mine & signal & ~read.stop,
            release_read=mine & (read.kind == RELEASE) & ~read.stop, phase_released=released,
            branch_read=mine & (read.kind == BRANCH) & read.stop,
            stray_stop=signal & read.stop & ~matched.adopted, station_made=off, station_ended=off, reset=off,
        )  # fmt: skip


class AtsSp(Assigned, tick_s=step_s):
    """The set for one home signal and one station."""

    coil: Coil
    locator: Locator
    receiver: PhaseReceiver
    station: StationStop
    sp: Supervision
    sure: Bit = power_up(False)  # the position was reliable at the last cycle

    def step(self, shift: Shift, pulses: Real, code: Fix, phase: Phase, inputs: Inputs) -> tuple[Self, Outputs]:
        """One cycle: a balise, pulses a second, what a code told, the phase, and the rest."""
        require("the stop mark lies before the crossing", self.sp.mark_at < self.crossing_at,
                nearest="a mark before crossing_at")  # fmt: skip
        coil, read = self.coil.step(shift)
        locator, located = self.locator.step(pulses, read.seen, read.kind, code)
        where, sure = located.position, located.matched.reliable
        receiver, released = self.receiver.step(phase, where)
        station, stop = self.station.step(inputs.timetable_stop, sure, where, self.sp.mark_at)
        told = self.told(read, located.matched, released & sure)
        stray = told.stray_stop | (self.sure & ~sure)
        events = told._replace(stray_stop=stray, station_made=stop.made, station_ended=stop.ended, reset=inputs.reset)
        sp, orders = self.sp.step(events, where)
        following = type(self)(coil=coil, locator=locator, receiver=receiver, station=station, sp=sp, sure=sure)
        return following, outputs(orders, inputs, sp, sure)


def outputs(orders: Orders, inputs: Inputs, sp: Supervision, sure: Bit) -> Outputs:
    """The lines of the set, each with its point."""
    alive = point("supply", inputs.supply) & point("cycle", inputs.cycle)
    patterns = sp.home.target.active | sp.turnout.target.active | sp.blind.target.active
    return Outputs(
        point("service_line", alive & ~orders.service), point("emergency_line", alive & ~orders.emergency),
        point("loop", sp.station.target.active & ~inputs.departing & sure), point("display", patterns),
    )  # fmt: skip


class UnknownProceeds(AtsSp, tick_s=step_s):
    """The set with the coil that takes a reading it does not understand for proceed."""

    coil: UnknownIsProceed
