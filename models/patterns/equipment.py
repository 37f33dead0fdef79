"""Five equipments that protect one point, with every component of the fault table: by what means the stop is told.

One step is one cycle of 0.1 s; lengths in m before the protected point, speeds in m/s.

    PointEquipment       resonant track coil, a braking distance before the point; the train then follows a pattern
    MagnetEquipment      the same with a permanent magnet and its clearing coil
    ContinuousEquipment  coded current, cab signal and acknowledgement; red from the B point on
    CombinedEquipment    resonant coil for the distance, coded current for what changes later
    ProgramEquipment     ground program: the spacing of crossings says the speed, a clock on board measures the interval

`Checked...` are the same with the detectors of the table fitted: whatever one of them finds brakes for good.
The pattern is the conservative ceiling, each of the five gradient bins being taken at its steepest end.
Source: principles and failures [P]; composition, distances and detectors [A].
"""

from __future__ import annotations

from typing import Any, ClassVar, NamedTuple

from models.kinematics import ACCELERATION, CYCLE, MARGIN, permits_accelerating
from models.patterns.code_control import LIMITS, RED
from models.patterns.detectors import Found
from models.patterns.stored_pattern import POINT, REACTION, StoredPattern
from models.patterns.transmission import MagnetPoint, ResonantPoint
from models.patterns.vehicle import Brake, Reading, Speedometer, Vehicle
from safety import Bit, Model, Real, bit, parameter, point, power_up, real, select

PATIENCE = 6  # s to acknowledge [A]
RED_LIMIT = LIMITS[RED]  # m/s: 15 mph [P]
B_POINT = 1400  # m, where the code ends [A]: braking distance from the line speed and the time to acknowledge


class Outcome(NamedTuple):
    """What a cycle shows."""

    passed: Bit  # the train is beyond the protected point, or faster there than permitted
    brake: Brake
    found: Found


class Equipment(Model, tick_s="0.1"):
    """What the five have in common: train, speed generator, brake gear, and the memory of what a detector found."""

    vehicle: Vehicle
    speed: Speedometer
    failed: Bit = power_up(False)
    target: Real = parameter(0, unit="m/s", within=(0, 25), source="[A] speed to be held from the point; 0: a stop")
    checked: ClassVar[bool] = False

    def finish(self, below: Bit, read: Reading, found: Found, drive: Real, test: Bit) -> tuple[dict[str, Any], Outcome]:
        """Hold the brake off while the speed is `below`, and run; the common parts after it."""
        found = found._replace(two_speeds=read.differ) if self.checked else found
        held_off = below & ~self.failed & ~found.on_board & ~test
        after, brake = self.vehicle.step(held_off, drive, read, self.speed.before, bit(self.checked))
        if self.checked:
            found = found._replace(valve_test=brake.valve_fails, brake_test=brake.weak)
        passed = (self.vehicle.x < 0) & ((self.target == 0) | (self.vehicle.v > self.target))
        return {"vehicle": after, "failed": self.failed | found.on_board}, Outcome(passed, brake, found)


class PointEquipment(Equipment, tick_s="0.1"):
    """Resonant coil and stored pattern: the pattern stays once a stop was read."""

    inductor: ResonantPoint
    pattern: StoredPattern
    beyond: Bit = power_up(False)  # of the track coil

    def step(self, stop: Bit, drive: Real, test: Bit) -> tuple[PointEquipment, Outcome]:
        """A cycle: what the signal says, the driver's acceleration in m/s^2, whether the brake is tested."""
        speed, read = self.speed.step(self.vehicle.v, bit(self.checked))
        contact, beyond = point("contact", ~stop), self.vehicle.x <= POINT
        passing = beyond & ~self.beyond
        inductor, told = self.inductor.step(contact, passing, bit(False), bit(False))
        pattern, checks = self.pattern.step(told, read, self.target, self.vehicle.gradient, bit(self.checked))
        found = checks.found._replace(**coil_checks(stop, contact, passing, told)) if self.checked else Found()
        common, outcome = self.finish(checks.below, read, found, drive, test)
        return type(self)(speed=speed, inductor=inductor, pattern=pattern, beyond=beyond, **common), outcome


class MagnetEquipment(Equipment, tick_s="0.1"):
    """Permanent magnet and stored pattern."""

    magnet: MagnetPoint
    pattern: StoredPattern
    beyond: Bit = power_up(False)

    def step(self, stop: Bit, drive: Real, test: Bit) -> tuple[MagnetEquipment, Outcome]:
        """A cycle: what the signal says, the driver's acceleration in m/s^2, whether the brake is tested."""
        speed, read = self.speed.step(self.vehicle.v, bit(self.checked))
        beyond = self.vehicle.x <= POINT
        magnet, told = self.magnet.step(~stop, beyond & ~self.beyond, bit(False), bit(False))
        pattern, checks = self.pattern.step(told, read, self.target, self.vehicle.gradient, bit(self.checked))
        common, outcome = self.finish(checks.below, read, checks.found if self.checked else Found(), drive, test)
        return type(self)(speed=speed, magnet=magnet, pattern=pattern, beyond=beyond, **common), outcome


class CombinedEquipment(Equipment, tick_s="0.1"):
    """Resonant coil and stored pattern, which the coded current releases; red without a point read brakes for good."""

    inductor: ResonantPoint
    pattern: StoredPattern
    beyond: Bit = power_up(False)

    def step(self, stop: Bit, current: Bit, drive: Real, test: Bit) -> tuple[CombinedEquipment, Outcome]:
        """A cycle: the signal, whether coded current reaches the train, the driver's acceleration, brake test."""
        speed, read = self.speed.step(self.vehicle.v, bit(self.checked))
        contact, beyond = point("contact", ~stop), self.vehicle.x <= POINT
        passing = beyond & ~self.beyond
        clear, differ = reception(current & ~(stop & beyond), self.checked)
        inductor, told = self.inductor.step(contact, passing, clear, bit(True))
        pattern, checks = self.pattern.step(told, read, self.target, self.vehicle.gradient, bit(self.checked))
        found = Found(unread=~told & ~clear)
        if self.checked:
            found = checks.found._replace(
                unread=found.unread, two_codes=differ, **coil_checks(stop, contact, passing, told)
            )
        common, outcome = self.finish(checks.below, read, found, drive, test)
        return type(self)(speed=speed, inductor=inductor, pattern=pattern, beyond=beyond, **common), outcome


class ContinuousEquipment(Equipment, tick_s="0.1"):
    """Coded current: red from the B point on, which brakes unless the driver acknowledges; he may then creep on."""

    red: Acknowledgement
    released: PressAndRelease

    def step(self, stop: Bit, current: Bit, button: Bit, drive: Real, test: Bit) -> tuple[ContinuousEquipment, Outcome]:
        """A cycle: signal, whether coded current reaches the train, acknowledgement, acceleration, brake test."""
        speed, read = self.speed.step(self.vehicle.v, bit(self.checked))
        clear, codes_differ = reception(current & ~(stop & (self.vehicle.x <= B_POINT)), self.checked)
        pressed = point("pressed", button)
        released, pulse = self.released.step(pressed)
        ticks, clocks_differ = clock(self.checked)
        red, brake = self.red.step(~clear, pulse if self.checked else pressed, ticks, read.v)
        found = Found(two_codes=codes_differ, watchdog=clocks_differ) if self.checked else Found()
        common, outcome = self.finish(~brake, read, found, drive, test)
        return type(self)(speed=speed, red=red, released=released, **common), outcome


class Acknowledgement(Model, tick_s="0.1"):
    """A red cab signal: its limit is 15 mph, and who does not acknowledge it in time is braked to a stand."""

    waited: Real = power_up(0)  # s since red came unacknowledged, as the clock on board has it
    agreed: Bit = power_up(False)

    def step(self, red: Bit, pressed: Bit, ticks: Real, v: Real) -> tuple[Acknowledgement, Bit]:
        """Whether to brake."""
        over = self.waited >= PATIENCE
        agreed = red & (self.agreed | (pressed & ~over))
        unanswered = red & ~agreed
        late = unanswered & over
        waited = select(unanswered, select(late, self.waited, self.waited + ticks * CYCLE), real(0))
        return type(self)(waited=waited, agreed=agreed), red & (late | (v > RED_LIMIT))


class PressAndRelease(Model, tick_s="0.1"):
    """An acknowledgement counts when the button is let go: one that is stuck never is."""

    down: Bit = power_up(False)

    def step(self, pressed: Bit) -> tuple[PressAndRelease, Bit]:
        """Whether it has just been let go."""
        return type(self)(down=pressed), self.down & ~pressed


class ProgramEquipment(Equipment, tick_s="0.1"):
    """Ground program: at the speed of the program the crossings come at the base interval; slower is permitted."""

    def step(self, stop: Bit, current: Bit, drive: Real, test: Bit) -> tuple[ProgramEquipment, Outcome]:
        """A cycle: signal, whether the conductor is fed, the driver's acceleration in m/s^2, brake test."""
        speed, read = self.speed.step(self.vehicle.v, bit(self.checked))
        ticks, differ = clock(self.checked)
        left, reaction = (self.vehicle.x - MARGIN) * ticks * ticks, ticks * REACTION
        v, b, target = self.vehicle.v, self.vehicle.guaranteed, self.target * ticks
        kept = permits_accelerating(v, left, b, reaction, ACCELERATION, target)  # of v / ticks
        below = point("comparator", current & (ticks > 0) & (~stop | kept))  # the clock's ticks hold the brake off
        found = Found()
        if self.checked:
            found = Found(watchdog=differ, dynamic_test=point("comparator_test", bit(False)))
        common, outcome = self.finish(below, read, found, drive, test)
        return type(self)(speed=speed, **common), outcome


# --- what several of them use ----------------------------------------------------------------------------------------


def coil_checks(stop: Bit, contact: Bit, passing: Bit, told: Bit) -> dict[str, Bit]:
    """The detectors of the resonant coil, by name: contact, pair code with announced points, test coil."""
    announced, proceed = point("announcement", passing), point("proceed_coil", contact)
    unanswered = ~point("test_coil", bit(True))
    return {"contact": contact == stop, "pair": announced & ~told & ~proceed, "test_coil": unanswered}


def reception(clear: Bit, double: bool) -> tuple[Bit, Bit]:
    """Whether the code for proceed is received, and whether two receivers differ, of which each may deny it."""
    first = point("receiver", clear)
    if not double:
        return first, bit(False)
    second = point("second_receiver", clear)
    return first & second, first != second


def clock(double: bool) -> tuple[Real, Bit]:
    """Ticks of the program clock for each one due, and whether a second clock differs from it."""
    ticks = point("ticks", real(1))
    return ticks, (ticks != point("second_ticks", real(1)) if double else bit(False))


class CheckedPoint(PointEquipment, tick_s="0.1"):
    """Resonant coil and stored pattern, with detectors."""

    checked = True


class CheckedMagnet(MagnetEquipment, tick_s="0.1"):
    """Permanent magnet and stored pattern, with detectors."""

    checked = True


class CheckedContinuous(ContinuousEquipment, tick_s="0.1"):
    """Coded current, with detectors."""

    checked = True


class CheckedCombined(CombinedEquipment, tick_s="0.1"):
    """Point and continuous, with detectors."""

    checked = True


class CheckedProgram(ProgramEquipment, tick_s="0.1"):
    """Ground program, with detectors."""

    checked = True
