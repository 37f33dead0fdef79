"""Speed patterns: minimal cut sets of "the train passes the protected point", for each way of telling it the stop.

Component faults of the fault table at any time, the signal at stop all along, the driver as he likes but that he does
not acknowledge.  Complete at every order, each set replayed.  For a plain equipment the singles are the wrong-side
modes of the table; with detectors fitted what remains are the modes that nothing on board finds, and pairs.

Results, singles: 9 by a resonant point, 7 by a magnet, 4 by continuous current, 7 by both, 4 by a ground program.  With
detectors 2, 2, 0, 1 and 1, with 5, 4, 2, 5 and 3 pairs and, by point, a triple.  Two rows differ from what the table
suggests: a clock that stops is dangerous where it times the acknowledgement, and a weak brake does no harm behind a
B point, since the brake acts while red waits for its answer.

Failure rates are those of the fault table [A].  One step is a cycle of 0.1 s.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from models.kinematics import ACCELERATION, B_SERVICE, CYCLE, MARGIN, T_SERVICE, stops_accelerating
from models.patterns.equipment import (
    B_POINT,
    PATIENCE,
    CheckedCombined,
    CheckedContinuous,
    CheckedMagnet,
    CheckedPoint,
    CheckedProgram,
    CombinedEquipment,
    ContinuousEquipment,
    Equipment,
    MagnetEquipment,
    PointEquipment,
    ProgramEquipment,
)
from models.patterns.failures import ADDED, ASSUMED_RATES, SHORT, TABLE, component_faults
from models.patterns.stored_pattern import POINT
from models.patterns.vehicle import LINE_SPEED
from proofs.patterns_rides import first_word, to_the_stop
from proofs.ts7_formulas import Formula, named
from safety import Bit, Seen, all_of, any_of, bit, hazard, implies, struck

COIL, WELDED, DEAF = (
    "track coil: missing or detuned",
    "track coil contact: welded",
    "on-board coil and oscillator: frequency stuck",
)
MAGNET = "permanent magnet: lost or demagnetised"
PATTERN = ("speed generator: zero output", "function generator: value high", "gradient selector: wrong bin")
BELOW, VALVE, FORCE = "comparator: stuck below", "brake valve: fails to vent", "brake force: less than guaranteed"
HIGHER, BUTTON = "code receiver: decodes a higher code", "acknowledgement button: stuck closed"
FAST, STOPS = "program clock: fast", "program clock: stops"
Sets = Sequence[tuple[str, ...]]
WEAK = B_SERVICE + SHORT  # m/s^2: what is left of a brake that gives less than guaranteed
AT_REST = Fraction(1, 100)  # m: more than the cycle of the stop is too long


@dataclass(frozen=True)
class Protection:
    """An equipment, and the sets of faults that defeat it."""

    equipment: type[Equipment]
    cut_sets: Sets
    deceleration: Fraction = B_SERVICE  # m/s^2, that the brake has at least

    def defeated(self, s: Any) -> Bit:
        """All faults of one of the sets have struck."""
        return any_of(bit(False), *(all_of(*(struck(s, name) for name in one)) for one in self.cut_sets))

    def lemma(self, name: str, formula: Callable[[Any], Bit]) -> Formula:
        """An invariant that holds until then."""
        return named(name, lambda s: self.defeated(s) | formula(s))

    def fits(self, s: Any, reaction: Any) -> Bit:
        """Free run and braking end before the point, with the margin; or the train has come to rest in it."""
        v = s.vehicle
        left = v.x - MARGIN
        rest = (v.v == 0) & (v.building >= T_SERVICE) & (left >= -AT_REST)
        holds: Bit = stops_accelerating(v.v, left, self.deceleration, reaction, ACCELERATION) | rest
        return holds

    def lemmas(self) -> list[Formula]:
        """The invariants from which the hazard does not happen."""
        return [bounds, self.lemma("the brake comes in time", lambda s: self.fits(s, T_SERVICE - s.vehicle.building))]


def bounds(s: Any) -> Bit:
    """Lemma: what speed and free run can be."""
    v = s.vehicle
    holds: Bit = (v.v >= 0) & (v.v <= LINE_SPEED) & (v.building >= 0) & (v.building <= T_SERVICE)
    return holds


class PatternProtection(Protection):
    """Where a point starts a stored pattern; `told` says that it did."""

    def told(self, s: Any) -> Bit:
        """A stop was read."""
        holds: Bit = s.magnet.tripped if issubclass(self.equipment, MagnetEquipment) else s.inductor.tripped
        return holds

    def nearer(self, s: Any) -> Bit:
        """After the way of this cycle the pattern thinks the point at most as far away as it is."""
        holds: Bit = s.pattern.left - (s.speed.before + s.vehicle.v) * CYCLE / 2 <= s.vehicle.x
        return holds

    def lemmas(self) -> list[Formula]:
        """The pattern thinks the point no farther away than it is, and there is one behind the coil."""
        return [
            *super().lemmas(),
            self.lemma("the speed read is that of the train or more", lambda s: s.speed.before >= 0),
            self.lemma("the point is not thought farther away", lambda s: self.nearer(s) | s.failed),
            self.lemma("the pattern starts at the point", lambda s: self.told(s) | (s.pattern.left == POINT)),
            self.lemma("what is passed was told", lambda s: implies(s.beyond, self.told(s) | s.failed)),
        ]


class AcknowledgedProtection(Protection):
    """Where red has to be acknowledged, and it is not."""

    def lemmas(self) -> list[Formula]:
        """The way that the train can run while it is waited for the driver is bounded."""
        return [
            *super().lemmas(),
            self.lemma("nobody acknowledges", lambda s: ~s.red.agreed & (~s.released.down | self.stuck(s))),
            self.lemma("no longer is waited", lambda s: (s.red.waited >= 0) & (s.red.waited < PATIENCE + 2 * CYCLE)),
            self.lemma("only so far while waiting",
                       lambda s: (s.vehicle.x > B_POINT - LINE_SPEED * (s.red.waited + CYCLE))
                       | (s.red.waited >= PATIENCE) | s.failed),
        ]  # fmt: skip

    def stuck(self, s: Any) -> Bit:
        """The button is; without faults it is not."""
        return struck(s, BUTTON) if self.cut_sets else bit(False)


def approaching(protection: Protection) -> Formula:
    """At power-up the train is before all that speaks of the point."""
    far = first_word(protection.equipment)
    return lambda s: (s.vehicle.x > far) & (s.vehicle.v >= 0) & (s.vehicle.v <= LINE_SPEED)


def at_stop(protection: Protection) -> Formula:
    """The signal is at stop, and nobody acknowledges."""
    answered = issubclass(protection.equipment, ContinuousEquipment)
    return lambda s: s.stop & ~s.button if answered else s.stop


def passes(protection: Protection, by: str, **more: Any) -> Formula:
    """Declare the hazard for an equipment."""
    equipment = protection.equipment
    rows = (*TABLE, *ADDED) if equipment.checked else TABLE
    faults = component_faults(equipment, rows)
    names = {fault.name for fault in faults}

    def formula(s: Seen) -> Bit:
        holds: Bit = s.passed
        return holds

    formula.__doc__ = f"With {by}, the signal at stop and nobody acknowledging, the train passes the protected point."
    orders = [len(one) for one in protection.cut_sets]
    return hazard(
        equipment, faults=faults, scenarios=to_the_stop(equipment),
        lemmas=protection.lemmas(), given=at_stop(protection), start=approaching(protection),
        requirement="SP-F1", source="[A] fault table, section 6", hours="10000",
        rates={row.name: (row.rate, ASSUMED_RATES) for row in rows if row.name in names},
        expect={n: orders.count(n) for n in sorted(set(orders))}, **more,
    )(named(f"passes_by_{equipment.__name__}", formula))  # fmt: skip


GEAR = ((VALVE,), (FORCE,))
PLAIN = (*((name,) for name in PATTERN), (BELOW,), *GEAR)
VALVES, TESTED = (VALVE, "second brake valve: fails to vent"), (BELOW, "dynamic test: always passed")
UNANNOUNCED, ANSWERED = "second point coil: not announced", "test coil: always answered"
DOUBLED = (
    ("speed generator: zero output", "second speed generator: zero output"),
    ("function generator: value high", "second function generator: value high"),
    TESTED,
    VALVES,
)
RECEIVERS = (HIGHER, "second code receiver: decodes a higher code")

point = PatternProtection(PointEquipment, ((COIL,), (WELDED,), (DEAF,), *PLAIN))
magnet = PatternProtection(MagnetEquipment, ((MAGNET,), *PLAIN))
code = AcknowledgedProtection(ContinuousEquipment, ((HIGHER,), (BUTTON,), (STOPS,), (VALVE,)), WEAK)
both = PatternProtection(CombinedEquipment, ((HIGHER,), *PLAIN))
program = Protection(ProgramEquipment, ((FAST,), (BELOW,), *GEAR))
checked_point = PatternProtection(
    CheckedPoint, ((WELDED,), (FORCE,), *DOUBLED, (COIL, UNANNOUNCED), (DEAF, UNANNOUNCED, ANSWERED))
)
checked_magnet = PatternProtection(CheckedMagnet, ((MAGNET,), (FORCE,), *DOUBLED))
checked_code = AcknowledgedProtection(CheckedContinuous, (RECEIVERS, VALVES), WEAK)
checked_both = PatternProtection(CheckedCombined, ((FORCE,), RECEIVERS, *DOUBLED))
checked_program = Protection(CheckedProgram, ((FORCE,), (FAST, "second clock: fast"), TESTED, VALVES))
PLAIN_ONES = {"point": point, "magnet": magnet, "continuous": code, "combined": both, "program": program}
CHECKED = {
    "point": checked_point, "magnet": checked_magnet, "continuous": checked_code, "combined": checked_both,
    "program": checked_program,
}  # fmt: skip

passes_by_point = passes(point, "a resonant point and a stored pattern")
passes_by_magnet = passes(magnet, "a magnet and a stored pattern")
passes_by_code = passes(code, "coded current and acknowledgement")
passes_by_both = passes(both, "point and continuous transmission")
passes_by_program = passes(program, "a ground program")
passes_by_checked_point = passes(checked_point, "a resonant point and a stored pattern, detectors fitted")
passes_by_checked_magnet = passes(checked_magnet, "a magnet and a stored pattern, detectors fitted")
passes_by_checked_code = passes(checked_code, "coded current and acknowledgement, detectors fitted")
passes_by_checked_both = passes(checked_both, "point and continuous transmission, detectors fitted")
passes_by_checked_program = passes(checked_program, "a ground program, detectors fitted")
