"""The on-board set of ATS-SP: from coil, axle pulses, track current and timetable to the brake lines.

    coil ----- reading of a balise ------+--> locator --> position --+
    speed generator --- pulses ----------+                           +--> supervision --> service, emergency line
    receiver -- phase of the section ------------------------------> |                --> "stopping" to the loop
    timetable -- station stop -------------------------------------> |

Both brake lines hold the brake off: dead lines brake, so loss of supply or of the program's cycle brakes at once.  A
balise whose shift is neither that of stop nor that of proceed is read as stop.  The line data have the target of each
balise: one of the home signal makes and ends its pattern, one of the turnout that of the turnout.  A balise at stop, or
of a diverging route, that cannot be assigned to either, because the position is not sure, or the line data do not have
it or have it for another target, and the loss of a sure position, make the pattern for the shortest distance on the
line.  A balise may be passed anywhere in a cycle: the way since then is counted from the time stamp of its detection.
Source: architecture, pattern set [P]; line data of one home signal and one turnout, rules in detail [A].
"""

from __future__ import annotations

from typing import NamedTuple, Self

from models.ats.overrun import StationStop
from models.ats.phase import Phase, PhaseReceiver, Told
from models.ats.supervision import PLACES, Events, Orders, Supervision
from models.ats.variants import BlindAtAPlace
from models.kinematics import at_most, nearest
from models.position.correction import BRANCH, REFERENCE, RELEASE, SIGNAL, Entry, Matched
from models.position.locator import Locator, Sighted
from models.position.odometer import Fix, step_s
from safety import U2, Bit, Model, Real, any_of, bit, parameter, point, power_up, require


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


class Counted(NamedTuple):
    """Axle pulses: those of a second, and the way, m, that they count since the time stamp of the cycle's balise."""

    pulses: Real
    since: Real


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


class Home(Supervision, tick_s=step_s):
    """Supervision on the stretch that is assumed here."""

    signal_at: Real = parameter(1600, unit="m", within=PLACES, source="[A] line data: home signal")
    switch_at: Real = parameter(1700, unit="m", within=PLACES, source="[A] line data: first facing switch")
    switch_clear: Real = parameter(1800, unit="m", within=PLACES, source="[A] line data: end of the turnout")
    mark_at: Real = parameter(3000, unit="m", within=PLACES, source="[A] line data: stop mark")


class HomeSection(PhaseReceiver, tick_s=step_s):
    """The receiver of the section before that signal."""

    begins: Real = parameter(1000, unit="m", within=PLACES, source="[A] line data: entry joint")
    ends: Real = parameter(1600, unit="m", within=PLACES, source="[A] line data: joint at the signal")


TARGET = "[A] line data: place of the signal, or first facing switch, that the balise is for"


class Targeted(Model, tick_s=step_s):
    """The balises, each with the signal or turnout that it is for."""

    locator: Locator
    sp: Home
    target_a: Real = parameter(1600, unit="m", within=PLACES, source=TARGET)
    target_b: Real = parameter(2600, unit="m", within=PLACES, source=TARGET)
    target_c: Real = parameter(3600, unit="m", within=PLACES, source=TARGET)
    target_d: Real = parameter(4600, unit="m", within=PLACES, source=TARGET)

    def lines(self) -> dict[str, tuple[Entry, Real]]:
        """Each balise of the line data with its target."""
        targets = (self.target_a, self.target_b, self.target_c, self.target_d)
        return {n: (e, t) for n, e, t in zip("abcd", self.locator.correction.data.stored(), targets, strict=True)}

    def check(self) -> None:
        """Refuse line data in which a balise is no farther from its target than the shortest distance says."""
        for name, (balise, target) in self.lines().items():
            far = (balise.kind == REFERENCE) | (target - balise.place >= self.sp.shortest)
            turnout = (balise.kind != BRANCH) | (target != self.sp.signal_at)
            require(f"balise {name} is at the shortest distance from its target, or farther out", far,
                    nearest(f"target_{name}", balise.place + self.sp.shortest, "m"))  # fmt: skip
            require(f"branch balise {name} is for a turnout", turnout,
                    nearest(f"target_{name}", self.sp.switch_at, "m"))  # fmt: skip
        ours = any_of(*((e.kind == SIGNAL) & (target == self.sp.signal_at) for e, target in self.lines().values()))
        require("a signal balise is for the home signal", ours, lambda: closest(self.lines(), self.sp.signal_at))


def closest(lines: dict[str, tuple[Entry, Real]], signal: Real) -> str:
    """What to say of a home signal that no signal balise is for."""
    signals = [target for balise, target in lines.values() if balise.kind.attr == SIGNAL]
    if not signals:
        return f"the nearest admissible kind_a is {SIGNAL}, a signal balise"
    return nearest("signal_at", min(signals, key=lambda target: abs(target.attr - signal.attr)), "m")()


class Assigned(Targeted, tick_s=step_s):
    """Which readings are those of the home signal and of the turnout."""

    def told(self, read: Reading, matched: Matched, phase: Told) -> Events:
        """A reading assigned to the targets."""
        off, announces = bit(False), (read.kind == SIGNAL) | (read.kind == RELEASE)
        home = read.seen & announces & self.is_for(self.sp.signal_at, matched)
        branch = read.seen & (read.kind == BRANCH) & self.is_for(self.sp.switch_at, matched)
        return Events(
            stop_read=(home & read.stop) | phase.stop, clear_read=home & (read.kind == SIGNAL) & ~read.stop,
            release_read=home & (read.kind == RELEASE) & ~read.stop, phase_released=phase.proceed,
            branch_read=branch & read.stop, station_made=off, station_ended=off, reset=off,
            stray_stop=read.seen & (read.kind != REFERENCE) & read.stop & ~home & ~branch,
        )  # fmt: skip

    def is_for(self, place: Real, matched: Matched) -> Bit:
        """Whether the balise that was matched is for the target there."""
        return matched.adopted & any_of(
            *((matched.fix.place == e.place) & (target == place) for e, target in self.lines().values())
        )


class AnySignal(Assigned, tick_s=step_s):
    """The variant to be refuted: each balise that is matched is one of these targets'."""

    def is_for(self, place: Real, matched: Matched) -> Bit:
        """Whatever the line data say."""
        return matched.adopted


class AtsSp(Assigned, tick_s=step_s):
    """The set for one home signal and one station."""

    coil: Coil
    receiver: HomeSection
    station: StationStop
    crossing_at: Real = parameter(3100, unit="m", within=PLACES, source="[A] line data: level crossing")
    sure: Bit = power_up(False)  # the position was reliable at the last cycle

    def step(self, shift: Shift, axle: Counted, code: Fix, phase: Phase, inputs: Inputs) -> tuple[Self, Outputs]:
        """One cycle: a balise, what the axle counts, what a code told, the phase, and the rest."""
        require("the stop mark lies before the crossing", self.sp.mark_at < self.crossing_at,
                nearest("mark_at", self.crossing_at, "m", at_most, "any below"))  # fmt: skip
        require("the section ends at the signal, or before", self.receiver.ends <= self.sp.signal_at,
                nearest("receiver.ends", self.sp.signal_at, "m", at_most))  # fmt: skip
        self.check()
        coil, read = self.coil.step(shift)
        locator, located = self.locator.step(axle.pulses, Sighted(read.seen, read.kind, axle.since), code)
        where, sure = located.position, located.matched.reliable
        receiver, heard = self.receiver.step(phase, where)
        station, stop = self.station.step(inputs.timetable_stop, sure, where, self.sp.mark_at)
        told = self.told(read, located.matched, Told(heard.proceed & sure, heard.stop & sure))
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


class AnySignalCounts(AnySignal, AtsSp, tick_s=step_s):
    """The set that takes each balise that it matches for one of its targets'."""


class HomeAtAPlace(BlindAtAPlace, Home, tick_s=step_s):
    """Supervision with the blind target that is kept as a place."""


class KeepsAPlace(AtsSp, tick_s=step_s):
    """The set with that supervision."""

    sp: HomeAtAPlace


class UnknownProceeds(AtsSp, tick_s=step_s):
    """The set with the coil that takes a reading it does not understand for proceed."""

    coil: UnknownIsProceed
