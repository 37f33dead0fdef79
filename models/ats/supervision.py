"""ATS-SP supervision: a finite number of targets, each with its own pattern; the most restrictive one counts.

    target     made by                                                ended by
    home       signal or release balise at stop, or read but not      not-stop balise of that signal, release, phase,
               understood; the phase of its section back to stop      stop and reset, passing
    turnout    branch balise: the diverging route is set              rear clear of the turnout
    station    see `overrun`: the timetable says stop                 standstill within the window, stop and reset,
                                                                      passing
    blind      a stop or diverging balise while the position is       stop and reset
               unknown, or that is none of these targets': the
               shortest distance on the line from here on

    service    the speed is above v_p(x - m, v1) of some target; held until it is h below that of all
    emergency  the speed is above that of the emergency brake; latched until standstill and reset

Distances are taken from the far end of the position interval, speed is the upper one.  A target that is made in a cycle
counts in that cycle; making goes before ending.  Of the blind target no place is known but the way that is left to it:
it is counted down with the upper speed, whatever the position is set to meanwhile, and another one never lengthens it.
Source: pattern set, service first, kinds of balises [P]; rules in detail [A]; t, b, m, h [A].
Main results: with the train within the interval, made in time, without traction and with b, the signal is never passed
(AV-1); what else ends a pattern (AV-2); the signal's return to stop behind the last release balise makes none (AV-4).
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple, Self

from models.kinematics import (
    ACCELERATION,
    B_EMERGENCY,
    B_SERVICE,
    CYCLE,
    HYSTERESIS,
    KMH,
    MARGIN,
    T_EMERGENCY,
    T_SERVICE,
    intervenes,
    intervenes_accelerating,
    nearest,
    permits,
)
from models.position.odometer import Position, step_s
from safety import Bit, Model, Real, all_of, any_of, parameter, point, power_up, real, require, select

PLACES = (-10_000, 10_000)  # m


class Target(Model, tick_s=step_s):
    """One target: none, or active at a place."""

    active: Bit = power_up(False)
    place: Real = power_up(0)  # m

    def step(self, made: Bit, place: Real, ended: Bit) -> tuple[Target, Demand]:
        """One cycle: made anew at a place, or ended; what it demands in this cycle."""
        on = point("pattern", made | (self.active & ~ended))
        at = point("target", select(made, place, self.place))
        return type(self)(active=on, place=at), Demand(on, at)


class Demand(NamedTuple):
    """An active target and its place, m."""

    on: Bit
    at: Real


class Braking(NamedTuple):
    """What the patterns reckon with."""

    b_s: Real  # m/s^2
    t_s: Real  # s
    b_e: Real
    t_e: Real
    h: Real  # m/s below a pattern before the service brake is released


class Asked(NamedTuple):
    """What one target asks for."""

    over: Bit  # above its pattern
    kept: Bit  # `h` below it, or no target
    far_over: Bit  # above the emergency pattern


class Aim(NamedTuple):
    """What becomes of a target in a cycle."""

    made: Bit
    place: Real  # m, where it is made
    ended: Bit
    limit: Real  # m/s to be held from there
    margin: Real  # m before it


class Patterns(Model, tick_s=step_s):
    """How a speed compares with the patterns of a target."""

    def compared(self, on: Bit, left: Real, v: Real, limit: Real, braking: Braking) -> Asked:
        """What an active target asks for, with so much way left to it."""
        over = on & self.above(v, left, braking.b_s, braking.t_s, limit)
        kept = ~on | permits(v + braking.h, left, braking.b_s, braking.t_s, limit)
        far_over = on & self.above(v, left, braking.b_e, braking.t_e, limit)
        return Asked(point("over", over), kept, point("far_over", far_over))

    def above(self, v: Real, left: Real, b: Real, t: Real, limit: Real) -> Bit:
        """Whether the speed is above a pattern."""
        above: Bit = intervenes(v, left, b, t, limit)
        return above


class Guard(Patterns, tick_s=step_s):
    """One target with its patterns."""

    target: Target

    def step(self, aim: Aim, where: Position, braking: Braking) -> tuple[Self, Asked]:
        """One cycle: how the speed compares with the patterns of the target as it now is."""
        target, demand = self.target.step(aim.made, aim.place, aim.ended)
        left = demand.at - aim.margin - self.far(where)
        return type(self)(target=target), self.compared(demand.on, left, where.fastest, aim.limit, braking)

    def far(self, where: Position) -> Real:
        """The place from which distances are taken."""
        return where.high


class NearEnd(Guard, tick_s=step_s):
    """The variant to be refuted: distances from the near end of the interval."""

    def far(self, where: Position) -> Real:
        """Where the train is at least."""
        return where.low


class NoFreeRun(Guard, tick_s=step_s):
    """The variant to be refuted: the free run is left out."""

    def above(self, v: Real, left: Real, b: Real, t: Real, limit: Real) -> Bit:
        """As if the brake acted at once."""
        above: Bit = intervenes(v, left, b, 0, limit)
        return above


class Accelerating(Guard, tick_s=step_s):
    """The conservative pattern v_pc: traction may go on during the free run."""

    a_max: Real = parameter(ACCELERATION, unit="m/s^2", within=(0, 3), source="[A] traction, or a downgrade")

    def above(self, v: Real, left: Real, b: Real, t: Real, limit: Real) -> Bit:
        """Whether the speed is above v_pc."""
        above: Bit = intervenes_accelerating(v, left, b, t, self.a_max, limit)
        return above


class WayLeft(Model, tick_s=step_s):
    """A target whose place is not known: none, or active with so much way left to it."""

    active: Bit = power_up(False)
    rest: Real = power_up(0)  # m
    cycle: Real = parameter(CYCLE, unit="s", within=(Fraction(1, 1000), 1), source="[A] control cycle")

    def step(self, made: Bit, shortest: Real, ended: Bit, where: Position) -> tuple[Self, Demand]:
        """One cycle, in which it may be made so far ahead; what is left at its end, at the upper speed throughout."""
        on = point("pattern", made | (self.active & ~ended))
        rest = select(made & self.counts(shortest), shortest, self.rest) - where.fastest * self.cycle
        left = point("left", rest)
        return type(self)(active=on, rest=left), Demand(on, left)

    def counts(self, shortest: Real) -> Bit:
        """Whether one that is made now is nearer than what there is."""
        return ~self.active | (shortest < self.rest)


class BlindGuard(Patterns, tick_s=step_s):
    """The target whose place is not known, with its patterns; its aim's place is the way to it."""

    target: WayLeft

    def step(self, aim: Aim, where: Position, braking: Braking) -> tuple[Self, Asked]:
        """One cycle."""
        target, demand = self.target.step(aim.made, aim.place, aim.ended, where)
        asked = self.compared(demand.on, demand.at - aim.margin, where.fastest, aim.limit, braking)
        return type(self)(target=target), asked


class Events(NamedTuple):
    """What balises and receiver tell in a cycle, already assigned to the targets by the line data."""

    stop_read: Bit  # balise of the home signal: stop, or not understood; or the phase back to stop
    clear_read: Bit  # signal balise of the home signal: not stop
    release_read: Bit  # release balise of the home signal: not stop
    phase_released: Bit
    branch_read: Bit  # branch balise: the route over the turnout is set
    stray_stop: Bit  # a balise at stop, or of a diverging route, that cannot be assigned to a target
    station_made: Bit
    station_ended: Bit
    reset: Bit  # the driver's reset; counts at standstill


class Orders(NamedTuple):
    """The brakes; either cuts traction."""

    service: Bit
    emergency: Bit


class Brakes(Model, tick_s=step_s):
    """Service brake held down to h below all patterns; emergency brake latched, and on at power-up."""

    held: Bit = power_up(False)
    latched: Bit = power_up(True)

    def step(self, asked: Asked, freed: Bit) -> tuple[Brakes, Orders]:
        """One cycle: what the targets ask for together; whether the train stands and is reset."""
        service = asked.over | (self.held & ~asked.kept)
        emergency = asked.far_over | (self.latched & ~freed)
        return type(self)(held=service, latched=emergency), Orders(service, emergency)


class LineData(Model, tick_s=step_s):
    """The stretch of line as stored: where the targets are, and what ends them."""

    signal_at: Real = parameter(600, unit="m", within=PLACES, source="[A] line data: home signal")
    switch_at: Real = parameter(700, unit="m", within=PLACES, source="[A] line data: first facing switch")
    switch_clear: Real = parameter(800, unit="m", within=PLACES, source="[A] line data: end of the turnout")
    switch_limit: Real = parameter(45 * KMH, unit="m/s", within=(0, 50), source="[A] line data: 45 km/h")
    mark_at: Real = parameter(1000, unit="m", within=PLACES, source="[A] line data: stop mark")
    shortest: Real = parameter(180, unit="m", within=(0, 2000), source="[A] shortest balise to signal on the line")
    length: Real = parameter(200, unit="m", within=(0, 1000), source="[A] train length")
    margin: Real = parameter(MARGIN, unit="m", within=(0, 100), source="[A] m")

    def aims(self, events: Events, where: Position, freed: Bit) -> Aims:
        """What becomes of each target in a cycle; `freed`: stop and reset."""
        require("the switch lies before the end of the turnout", self.switch_at <= self.switch_clear,
                nearest("switch_clear", self.switch_at, "m"))  # fmt: skip
        told, m, stop = events.clear_read | events.release_read | events.phase_released, self.margin, real(0)
        home_ends = told | freed | (where.low >= self.signal_at)
        clear = where.low - self.length >= self.switch_clear
        left = events.station_ended | freed | (where.low >= self.mark_at)
        return Aims(
            home=Aim(events.stop_read, point("signal_at", self.signal_at), home_ends, stop, m),
            turnout=Aim(events.branch_read, self.held_from(where), clear, self.switch_limit, m),
            station=Aim(events.station_made, self.mark_at, left, stop, stop),
            blind=Aim(events.stray_stop, self.shortest, freed, stop, m),
        )

    def held_from(self, where: Position) -> Real:
        """Where the turnout's limit is to be held."""
        return point("switch_at", self.switch_at)


class Aims(NamedTuple):
    """What becomes of the targets."""

    home: Aim
    turnout: Aim
    station: Aim
    blind: Aim


class Supervision(LineData, tick_s=step_s):
    """The targets of one stretch of line, their patterns, and the brakes."""

    home: Guard
    turnout: Guard
    station: Guard
    blind: BlindGuard
    brakes: Brakes
    b_s: Real = parameter(B_SERVICE, unit="m/s^2", within=(Fraction(1, 10), 3), source="[A] 2.5 km/h/s")
    t_s: Real = parameter(T_SERVICE, unit="s", within=(0, 10), source="[A] free run and processing, service")
    b_e: Real = parameter(B_EMERGENCY, unit="m/s^2", within=(Fraction(1, 10), 3), source="[A] 3.5 km/h/s")
    t_e: Real = parameter(T_EMERGENCY, unit="s", within=(0, 10), source="[A] free run and processing, emergency")
    hysteresis: Real = parameter(HYSTERESIS, unit="m/s", within=(0, 5), source="[A] h 2 km/h")
    standstill: Real = parameter(KMH, unit="m/s", within=(0, 1), source="[A] below 1 km/h the train stands")

    def step(self, events: Events, where: Position) -> tuple[Self, Orders]:
        """One cycle: what was read, and where the train is at its beginning."""
        require("the emergency brake is the stronger one", self.b_s <= self.b_e, nearest("b_e", self.b_s, "m/s^2"))
        require("the service brake comes first", self.t_e <= self.t_s, nearest("t_s", self.t_e, "s"))
        freed = point("freed", (where.fastest <= self.standstill) & events.reset)
        aims = self.aims(events, where, freed)
        braking = Braking(self.b_s, self.t_s, self.b_e, self.t_e, self.hysteresis)
        guards = (self.home, self.turnout, self.station, self.blind)
        stepped, asked = zip(*(g.step(aim, where, braking) for g, aim in zip(guards, aims, strict=True)), strict=True)
        brakes, orders = self.brakes.step(strictest(*asked), freed)
        following = type(self)(**dict(zip(Aims._fields, stepped, strict=True)), brakes=brakes)
        return following, Orders(point("service", orders.service), point("emergency", orders.emergency))


def strictest(*asked: Asked) -> Asked:
    """What several targets ask for together."""
    over, kept, far_over = zip(*asked, strict=True)
    return Asked(any_of(*over), all_of(*kept), any_of(*far_over))
