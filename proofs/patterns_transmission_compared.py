"""Point, continuous, and point and continuous transmission on one set of scenarios: who stops the train, and where.

The equipments are those of `models.patterns.equipment`, the train comes at 100 km/h, a cycle is 0.1 s.  A yes says that
the equipment does what is asked in that scenario; behind each is a claim, proved for every driver and for ever, or
refuted by the run of the table.  Each proved one has a twin without what it assumes, refuted by a run.

Results: a point system is blind to what changes between points, to a broken rail and to its own missing coil; a
continuous system sees these, but an acknowledged red and a wrong code take the train past the signal; of the three,
point and continuous has only the wrong code left (5 FIT), beside what all share.
Source: the three methods [P]; distances, speeds and rates [A].
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from models.kinematics import CYCLE
from models.patterns.equipment import PATIENCE, CombinedEquipment, ContinuousEquipment, Equipment, PointEquipment
from models.patterns.failures import TABLE, component_faults
from models.patterns.stored_pattern import POINT
from models.patterns.vehicle import LINE_SPEED
from proofs.patterns_hazards import (
    COIL,
    HIGHER,
    AcknowledgedProtection,
    PatternProtection,
    Protection,
    approaching,
)
from proofs.patterns_rides import STEPS, approach, inputs, start
from proofs.ts7_formulas import Formula, named
from safety import PROVED, REFUTED, Bit, Fault, Scenario, Seen, at_most, claim, implies, run
from safety.exhibits import Column, Row, table
from safety.faults import instrument, schedule
from safety.tracing import trace

TOO_CLOSE = Fraction(100)  # m before the point, at the line speed
NEAR = 900  # m: what the signal or the rail does from here on, it does in time
METHODS: Mapping[str, type[Equipment]] = {
    "point": PointEquipment, "continuous": ContinuousEquipment, "point and continuous": CombinedEquipment,
}  # fmt: skip


class NearPattern(PatternProtection):
    """Point and continuous, where the stop comes only `NEAR` metres before the point."""

    def lemmas(self) -> list[Formula]:
        """From there on a pattern has been started, or the missing current has braked for good."""
        return [
            *Protection.lemmas(self),
            self.lemma("the speed read is that of the train or more", lambda s: s.speed.before >= 0),
            self.lemma("a pattern thinks the point no farther away",
                       lambda s: self.nearer(s) | (s.beyond & ~self.told(s))),
            self.lemma("the pattern starts at the point", lambda s: self.told(s) | (s.pattern.left == POINT)),
            self.lemma("near the point it was told",
                       lambda s: self.told(s) | s.failed | (s.vehicle.x > NEAR - LINE_SPEED * CYCLE)),
        ]  # fmt: skip


class NearAcknowledged(AcknowledgedProtection):
    """Continuous, where the stop comes only `NEAR` metres before the point."""

    def lemmas(self) -> list[Formula]:
        """The way while it is waited for the driver ends in time even so."""
        return [
            *super().lemmas()[:-1],
            self.lemma("only so far while waiting", lambda s: (s.vehicle.x > NEAR - LINE_SPEED * (s.red.waited + CYCLE))
                       | (s.red.waited >= PATIENCE)),
        ]  # fmt: skip


@dataclass(frozen=True)
class Case:
    """What happens, as the proof assumes it and as the run has it, and whether each of the three does what is right."""

    happens: str
    otherwise: str  # what may happen where that is not assumed
    given: Callable[[Any], Bit]
    inputs: Mapping[str, Any]
    unless: Mapping[str, Any]  # the inputs of a run against it
    right: tuple[bool | None, bool | None, bool | None]  # point, continuous, both; None: it has no such component
    fault: str = ""
    near: bool = False  # only from `NEAR` on
    alone: bool = True  # nobody acknowledges


def late(cycle: int) -> bool:
    """In the runs the train, coasting, is `NEAR` metres before the point from this cycle on."""
    return cycle >= 288


def too_late(cycle: int) -> bool:
    """In the runs it is 300 m before the point."""
    return cycle >= 504


def at_stop(s: Any) -> Bit:
    """All along."""
    holds: Bit = s.stop
    return holds


def stop_when_near(s: Any) -> Bit:
    """Farther away the signal does as it likes."""
    return implies(s.vehicle.x <= NEAR, s.stop)


def no_current_when_near(s: Any) -> Bit:
    """Farther away it comes and goes; the signal is at proceed."""
    holds: Bit = implies(s.vehicle.x <= NEAR, ~s.current) & ~s.stop
    return holds


PROCEED = {"stop": False}
CASES = {
    "at_stop": Case("Signal at stop", "Signal as it likes", at_stop, {}, PROCEED, (True, True, True)),
    "returns_to_stop": Case(
        "Signal returns to stop between points", "Signal returns to stop at any place", stop_when_near, {"stop": late},
        {"stop": too_late}, (False, True, True), near=True),
    "broken_rail": Case(
        "Rail breaks, signal at proceed", "Rail breaks at any place", no_current_when_near,
        {"stop": False, "current": lambda k: not late(k)}, {"stop": False, "current": lambda k: not too_late(k)},
        (False, True, True), near=True),
    "missing_coil": Case(
        "Track coil missing, signal at stop", "Track coil missing, signal as it likes", at_stop, {}, PROCEED,
        (False, None, True), COIL),
    "wrong_code": Case(
        "Receiver decodes a higher code, signal at stop", "Receiver decodes a higher code, signal as it likes", at_stop,
        {}, PROCEED, (None, False, False), HIGHER),
    "acknowledged": Case(
        "Driver acknowledges the stop and goes on", "Driver acknowledges, signal as it likes", at_stop,
        {"button": True}, {"button": True, **PROCEED}, (True, False, True), alone=False),
}  # fmt: skip


def given(case: Case, equipment: type[Equipment]) -> Formula:
    """What the proof assumes of the surroundings; a point system has no current to lose."""
    if case.given is no_current_when_near and equipment is PointEquipment:
        return lambda s: ~s.stop
    if case.alone and equipment is ContinuousEquipment:
        return lambda s: case.given(s) & ~s.button
    return case.given


def protection(method: str, case: Case) -> Protection:
    """Lemmas for a method in a case."""
    equipment = METHODS[method]
    if equipment is ContinuousEquipment:
        return NearAcknowledged(equipment, ()) if case.near else AcknowledgedProtection(equipment, ())
    return (NearPattern if case.near else PatternProtection)(equipment, ())


def ride(method: str, case: Case, given: Mapping[str, Any], **begins: Fraction) -> Scenario:
    """A run: from 1700 m unless it begins elsewhere, the fault from the start."""
    present = [case.fault] if case.fault else []
    begin = start(ContinuousEquipment) | {f"vehicle.{name}": value for name, value in begins.items()}
    return Scenario(STEPS, inputs(METHODS[method], **given), start=begin, present=present)


def faults_of(method: str, case: Case) -> list[Fault]:
    """The fault of a case."""
    return component_faults(METHODS[method], [row for row in TABLE if row.name == case.fault])


def stops(what: str, name: str, case: Case, method: str, **how: Any) -> Formula:
    """Claim that the train does not pass the point when something happens."""

    def formula(s: Seen) -> Bit:
        holds: Bit = ~s.passed
        return holds

    formula.__doc__ = f"{what}: with {method} transmission the train stops before the point."
    return claim(
        METHODS[method], requirement=REQUIREMENTS.get(name.split("_without")[0], "SP-X1"),
        source="[D] transmission methods compared",
        faults=at_most(1, faults_of(method, case)) if case.fault else None, **how,
    )(named(f"{name}_{METHODS[method].__name__}", formula))  # fmt: skip


def stops_before(name: str, case: Case, method: str, right: bool) -> None:
    """Claim that the train does not pass the point in a case, with twins that assume less; or show that it does."""
    assumed = {"given": given(case, METHODS[method]), "start": approaching(protection(method, case))}
    if not right:
        run_of_it = ride(method, case, case.inputs)
        stops(case.happens, name, case, method, expect=REFUTED, defeat=True, scenario=run_of_it, **assumed)
        return
    held = stops(case.happens, name, case, method, expect=PROVED, lemmas=protection(method, case).lemmas(), **assumed)
    stops(case.otherwise, f"{name}_without_premise", case, method, expect=REFUTED, twin_of=held,
          start=assumed["start"], scenario=ride(method, case, case.unless))  # fmt: skip
    in_the_end = {word: value(STEPS) if callable(value) else value for word, value in case.inputs.items()}
    stops(f"{case.happens}, from any place on", f"{name}_without_start", case, method, expect=REFUTED, twin_of=held,
          given=assumed["given"], scenario=ride(method, case, in_the_end, x=TOO_CLOSE))  # fmt: skip


def told(case: Case) -> Iterator[tuple[str, bool | None]]:
    """Each method, and whether it does what is right."""
    return zip(METHODS, case.right, strict=True)


REQUIREMENTS = {"missing_coil": "SP-X2", "acknowledged": "SP-X3", "broken_rail": "SP-H1", "at_stop": "SP-F1",
                "wrong_code": "SP-F1"}  # fmt: skip
for _name, _case in CASES.items():
    for _method, _right in told(_case):
        if _right is not None:
            stops_before(_name, _case, _method, _right)


# --- the table -------------------------------------------------------------------------------------------------------


def outcome(method: str, case: Case) -> tuple[bool, Fraction]:
    """Whether the train of a run stays before the point, and where it is at the end, m before the point."""
    faulted = instrument(trace(METHODS[method]), faults_of(method, case))
    acts, row = schedule(faulted), approach(METHODS[method], **case.inputs)
    found = run(faulted.system, lambda cycle: {**row(cycle), **acts(cycle)}, STEPS, start=start(ContinuousEquipment),
                keep=("passed", "vehicle.x"))  # fmt: skip
    return not any(found["passed"]), found["vehicle.x"][-1]


COLUMNS = (
    Column("what happens"),
    *(column for name in METHODS for column in (Column(name), Column(f"{name}: rests before the point", "m", 1))),
)
NOT_STOPPED = (
    "Signal returns to stop between points: point",
    "Rail breaks, signal at proceed: point",
    "Track coil missing, signal at stop: point",
    "Receiver decodes a higher code, signal at stop: continuous",
    "Receiver decodes a higher code, signal at stop: point and continuous",
    "Driver acknowledges the stop and goes on: continuous",
)


@table(
    id="patterns.transmission", title="Three ways of telling a train the stop: who stops, and where",
    source="[D] runs, each with its claim; 100 km/h, distances [A]", columns=COLUMNS, says_no=NOT_STOPPED,
)  # fmt: skip
def transmission() -> Iterator[Row]:
    """A scenario a row; where the train is not stopped no place is given, and no method without the component."""
    for case in CASES.values():
        found = [(None, None) if right is None else outcome(name, case) for name, right in told(case)]
        yield case.happens, *(cell for stopped, where in found for cell in (stopped, where if stopped else None))
