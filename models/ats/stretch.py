"""One stretch of line with every component around ATS-SP, in a closed loop: the bench for the table of components.

    700 m  reference balise     900 m  signal balise     1100 m  branch balise     1300 m  release balise
    1000 to 1600 m  approach section (phase)     1600 m  home signal     1700 to 1800 m  turnout, 45 km/h diverging

The train is the truth: its axle turns the wheel, the wheel gives the pulses, and all that is known on board comes from
these, from the balises and from the track current.  It starts from standstill at 500 m, where the brakes have been
reset and a code of five balises has told the position.  One relay holds off the brake for both lines.

`Stretch` has the on-board set as it is, which gives up its position after two expected balises that were not seen.
`Mapped` takes each one that was not seen for a balise at stop, or of a diverging route.
Source: components [P]; places, one relay, one force of the brake [A].
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from models.ats.ats_sp import AtsSp, Counted, Inputs, Shift
from models.ats.ats_sp import Reading as BaliseReading
from models.ats.phase import Phase, Told
from models.ats.supervision import Events
from models.kinematics import KMH
from models.patterns.vehicle import Reading, Vehicle
from models.position.correction import BRANCH, REFERENCE, RELEASE, SIGNAL, Matched
from models.position.odometer import PI, PULSES, Fix, step_s
from safety import U2, Bit, Model, Real, UInt, any_of, bit, point, power_up, real, select, word

SIGNAL_AT, SWITCH_AT, SWITCH_CLEAR, START = 1600, 1700, 1800, 500  # m
PLACES = {REFERENCE: 700, SIGNAL: 900, BRANCH: 1100, RELEASE: 1300}  # m
LINE = {
    **{f"ats.locator.correction.data.place_{n}": place for n, place in zip("abcd", PLACES.values(), strict=True)},
    **{f"ats.locator.correction.data.kind_{n}": kind for n, kind in zip("abcd", PLACES, strict=True)},
    "ats.sp.signal_at": SIGNAL_AT, "ats.sp.switch_at": SWITCH_AT, "ats.sp.switch_clear": SWITCH_CLEAR,
    "ats.target_b": SIGNAL_AT, "ats.target_c": SWITCH_AT, "ats.target_d": SIGNAL_AT,
    "ats.receiver.begins": 1000, "ats.receiver.ends": SIGNAL_AT,
    "ats.sp.mark_at": 3000, "ats.crossing_at": 3100,
}  # fmt: skip
"""Settings: the line data of this stretch; the station lies beyond it."""
AT_REST = {"vehicle.v": 0, "vehicle.x": SIGNAL_AT - START}  # power-up
LENGTH = 200  # of the train, m
SLOWER = Fraction(1, 100)  # m/s, by which a wheel turns too slowly
LIMIT = 45 * KMH  # of the turnout, m/s
PULSES_A_METRE = Fraction(PULSES) / (PI * Fraction("0.86"))  # of a wheel as it is set


class Wayside(NamedTuple):
    """What the ground shows."""

    stop: Bit  # the home signal
    diverging: Bit  # the route over the turnout
    current: Bit  # the signal current is fed, so that its phase tells


class Balises(Model, tick_s=step_s):
    """The four balises, resonant circuits; a closed contact shows proceed (straight at the branch balise)."""

    def step(self, reached: Bit, kind: U2, stop: Bit, diverging: Bit) -> tuple[Balises, Shift]:
        """One cycle: whether one is passed, and of which kind."""
        names = {REFERENCE: "reference", SIGNAL: "signal", BRANCH: "branch", RELEASE: "release"}
        there = any_of(*((kind == k) & point(f"{name}_tuned", bit(True)) for k, name in names.items()))
        shown = {SIGNAL: stop, RELEASE: stop, BRANCH: diverging}
        closed = any_of(*((kind == k) & point(f"{names[k]}_closed", ~open_) for k, open_ in shown.items()))
        return type(self)(), Shift(reached & there, kind, ~closed, closed)


class FalseShift(Model, tick_s=step_s):
    """The oscillation unit shifts its frequency without a balise: as at a signal balise."""

    def step(self, passed: Shift) -> tuple[FalseShift, Shift]:
        """One cycle."""
        shifts = point("shifts", bit(False)) & ~passed.seen
        kind = select(shifts, word(SIGNAL, 2), passed.kind)
        return type(self)(), Shift(passed.seen | shifts, kind, passed.stop | shifts, passed.proceed & ~shifts)


class Shown(NamedTuple):
    """What a cycle brings from the track."""

    shift: Shift
    since: Real  # way since the balise that was passed in it, m


class Track(Model, tick_s=step_s):
    """Balises and oscillation unit, as the train passes."""

    balises: Balises
    unit: FalseShift

    def step(self, x: Real, left: Real, at: Wayside) -> tuple[Track, Shown]:
        """One cycle: metres to the signal now and a cycle ago."""
        passing = {kind: (left > SIGNAL_AT - place) & (x <= SIGNAL_AT - place) for kind, place in PLACES.items()}
        balises, shift = self.balises.step(any_of(*passing.values()), first(passing), at.stop, at.diverging)
        unit, shift = self.unit.step(shift)
        since = real(0)
        for kind, place in PLACES.items():
            since = select(passing[kind], SIGNAL_AT - place - x, since)
        return type(self)(balises=balises, unit=unit), Shown(shift, since)


class Axle(Model, tick_s=step_s):
    """Wheel and rail, wheel diameter, speed generator: pulses a second from the true mean speed."""

    def step(self, mean: Real, since: Real) -> tuple[Axle, Counted]:
        """One cycle; `grip` is the speed of the tread, `wear` the set over the true diameter, `counted` a share.

        Since a balise a wheel that turns too slowly shows no way at all: the worst that it can [A].
        """
        tread, shown = point("grip", mean), point("wear", real(1)) * point("counted", real(1))
        return type(self)(), Counted(tread * shown * PULSES_A_METRE, select(mean - tread > SLOWER, 0, since * shown))


class Train(Vehicle, tick_s=step_s):
    """The train of the speed patterns; its cycle is theirs."""


class Outcome(NamedTuple):
    """What a cycle shows."""

    passed: Bit  # the train is beyond the signal at stop, or too fast on the turnout
    ordered: Bit  # a brake line is dead
    braking: Bit
    head: Real  # m


class Stretch(Model, tick_s=step_s):
    """The train and its equipment."""

    track: Track
    axle: Axle
    ats: AtsSp
    vehicle: Train
    told: Bit = power_up(False)  # the code at the start has been read
    before: Real = power_up(0)  # m/s, true speed a cycle ago
    left: Real = power_up(SIGNAL_AT - START)  # m to the signal a cycle ago

    def step(self, at: Wayside, drive: Real) -> tuple[Stretch, Outcome]:
        """One cycle: what the ground shows, and the driver's acceleration in m/s^2."""
        v, x, mean = self.vehicle.v, self.vehicle.x, (self.before + self.vehicle.v) / 2
        track, shown = self.track.step(x, self.left, at)
        axle, counted = self.axle.step(mean, shown.since)
        start, off = real(START), bit(False)
        code, inputs = Fix(~self.told, start, start, start), Inputs(off, off, ~self.told, ~off, ~off)
        ats, lines = self.ats.step(shown.shift, counted, code, current(at), inputs)
        ordered = ~(lines.service_line & lines.emergency_line)
        held_off = point("io_unit", ~ordered)
        traction = select(held_off | (drive < 0), drive, real(0))
        read = Reading(v, mean * self.ats.locator.odometer.cycle, off)
        vehicle, brake = self.vehicle.step(held_off, traction, read, self.before, off)
        following = type(self)(track=track, axle=axle, ats=ats, vehicle=vehicle, told=True, before=v, left=x)
        return following, Outcome(too_far(x, at) | too_fast(x, v, at), ordered, brake.on, SIGNAL_AT - x)


def current(at: Wayside) -> Phase:
    """The phase of the signal current."""
    return Phase(at.current & ~at.stop, at.current & at.stop, bit(False), real(0))


def too_far(x: Real, at: Wayside) -> Bit:
    """Beyond the signal at stop."""
    return (x < 0) & at.stop


def too_fast(x: Real, v: Real, at: Wayside) -> Bit:
    """From the head on the turnout until the rear is clear of it, above its limit."""
    return (x <= SIGNAL_AT - SWITCH_AT) & (x >= SIGNAL_AT - SWITCH_CLEAR - LENGTH) & at.diverging & (v > LIMIT)


def first(passing: dict[int, Bit]) -> UInt:
    """The kind of the balise that is passed."""
    kind = word(REFERENCE, 2)
    for each, here in passing.items():
        kind = select(here, word(each, 2), kind)
    return kind


class OneMissedIsStop(AtsSp, tick_s=step_s):
    """The set that takes each balise that was expected and not seen for its most restrictive reading."""

    def told(self, read: BaliseReading, matched: Matched, phase: Told) -> Events:
        """The same, and what should have been there."""
        told = super().told(read, matched, phase)
        return told._replace(stop_read=told.stop_read | matched.absent, branch_read=told.branch_read | matched.absent)


class Mapped(Stretch, tick_s=step_s):
    """With the set that acts on one balise that was not seen."""

    ats: OneMissedIsStop
