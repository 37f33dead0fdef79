"""Reals on the native engine: outcomes are those of the exact readings, whatever doubles make of the numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any, cast

import numpy as np
import pytest

from safety import kinds
from safety.faults import INTERMITTENT, Fault, instrument, schedule
from safety.inject.engine import NEVER, NONE, Batch, Task, Timing, engine_for
from safety.inject.lanes import LaneEngine
from safety.inject.native import reals, scales, sweep
from safety.inject.native.enclosing import EnclosingEngine
from safety.inject.native.reals import HELD, HIGH, LOW, EnclosureError, Lowering, scales_of
from safety.inject.space import CampaignError
from safety.system import Clock, State, System
from safety.terms import real, select
from safety.terms.column_doubles import encloses
from safety.terms.graph import BIT, REAL, node, variable
from safety.trace import run
from tests.inject.native_systems import apart_from_python, differences, random_batch
from tests.inject.real_systems import braking_train, random_real_task
from tests.terms.agreement import targets

TARGETS = targets()
RUNS = 40
SHORT = Timing(8, 24, 8, 1)
EACH: list[tuple[int, str]] = [(seed, list(TARGETS)[seed % len(TARGETS)]) for seed in range(60)]
FEW = EACH[:2]
THIRD = Fraction(1, 3)


@pytest.fixture(autouse=True)
def nothing_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


def point(name: str, term: Any) -> Any:
    return node("point", (term,), name, term.sort)


@pytest.fixture
def unscaled(monkeypatch: pytest.MonkeyPatch) -> None:
    """All reals in the unit in which they are written, so that few of them are doubles."""
    monkeypatch.setattr(scales, "GREATEST", 1)


def thirds(timing: Timing = SHORT, ahead: Fraction = Fraction(1, 7)) -> Task:
    """A sum of thirds, seen a little `ahead`: a fault that takes this back meets every limit exactly.

    Step 7 is within the run-in, so that only a mark that stays is seen of what happens there.
    """
    total: Any = variable("total", REAL)
    latch: Any = variable("latch", BIT)
    kept: Any = variable("kept", REAL)
    seen = point("seen", total + ahead)
    factor = point("factor", select(latch, real(-3), real(Fraction(-1, 5))))
    states = (
        State(total, total + THIRD, Fraction(0)),
        State(latch, latch | (seen == 2), False),
        State(kept, select(seen == Fraction(7, 3), real(1), kept), Fraction(0)),
    )
    wires = {
        "latched": latch, "taken": kept > THIRD, "at 9": seen <= 9, "below 10": seen < 10,
        "product": seen * factor < -total, "signs": (seen - 4) * factor > (total - 4) * factor,
    }  # fmt: skip
    points = {"seen": seen, "factor": factor}
    system = System("thirds", Clock(event="tick"), states, {}, wires, points, {}, {})
    atoms = (
        Fault(kinds.offset(-ahead), ["seen"]),
        Fault(kinds.offset(Fraction(-8, 21)), ["seen"]),
        Fault(kinds.drift(Fraction(-1, 10)), ["seen"]),
        Fault(kinds.reads(Fraction(2, 3)), ["factor"]),
        Fault(kinds.frozen(), ["seen"]),
        Fault(kinds.byzantine(), ["seen"], values={"seen": [Fraction(1, 10), THIRD, Fraction(-7, 9), Fraction(2)]}),
    )
    return Task(system, atoms, tuple(wires), tuple(wires), timing, lambda frame: {}, {})


def singles(task: Task, first: int = 0) -> Batch:
    """Each fault alone, and none."""
    atoms = np.append(np.arange(len(task.atoms)), NONE)[None].astype(np.int32)
    return Batch(atoms, np.full_like(atoms, first), np.full_like(atoms, NEVER))


# --- outcomes --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("seed", "processor"), [pytest.param(*one, marks=[] if one in FEW else pytest.mark.slow) for one in EACH]
)
def test_outcome_is_that_of_the_exact_readings(seed: int, processor: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scales, "GREATEST", scales.GREATEST if seed % 3 else 1)
    task = random_real_task(seed)
    batch = random_batch(task, seed, RUNS)
    engine = EnclosingEngine(task, target=replace(TARGETS[processor], lanes=16))
    found = engine.run(batch)
    assert differences(found, LaneEngine(task).run(batch)) == []
    assert apart_from_python(task, batch, found, range(0, RUNS, 8)) == []
    assert outside(engine, batch, task.timing.frames - 5) == []


@pytest.mark.parametrize("stretches", [False, True])
def test_what_is_left_out_changes_nothing(stretches: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if stretches:
        for name, number in (("NEW_RUNS", 1), ("SHORTEST", 5), ("MOST", 1000), ("WORTH_WHILE", -1)):
            monkeypatch.setattr(sweep, name, number)
    task = random_real_task(2, Timing(5, 40, 10, 1), atoms=5)
    batch = random_batch(task, 2, 300)
    whole = EnclosingEngine(task, prune=False).run(batch)
    assert differences(EnclosingEngine(task).run(batch), whole) == []


def test_numbers_that_meet_exactly_are_redone(unscaled: None) -> None:
    task = thirds()
    engine = EnclosingEngine(task)
    batch = singles(task)
    found = engine.run(batch)
    assert apart_from_python(task, batch, found, range(batch.runs)) == []
    assert found.first["latched"][0] == 0 and found.first["latched"][-1] == NEVER
    assert (engine.redone, engine.asked) == (3, 7)
    assert engine.note == "reals as enclosing doubles; 3 of 7 runs redone on exact lanes"


def test_numbers_that_meet_exactly_are_decided_in_the_right_unit() -> None:
    some = ("latched", "taken", "at 9", "below 10")  # the others are products compared with a factor of theirs
    task = replace(thirds(), count=some, watch=some)
    engine = EnclosingEngine(task)
    assert apart_from_python(task, singles(task), engine.run(singles(task)), range(7)) == []
    assert engine.redone == 0


def test_a_fault_free_run_that_meets_a_limit_is_redone_whole(unscaled: None) -> None:
    task = thirds(ahead=Fraction(2, 3))
    engine = EnclosingEngine(task)
    found = engine.run(singles(task))
    assert apart_from_python(task, singles(task), found, range(7)) == []
    assert differences(engine.golden, LaneEngine(task).golden) == []
    assert engine.redone == 5  # two faults keep what is seen away from it


def test_doubles_are_met_without_redoing() -> None:
    """Limits reached exactly by numbers that are doubles: every comparison is decided."""
    speed: Any = variable("speed", REAL)
    seen = point("seen", speed)
    after = seen + Fraction(3, 8)
    states = (State(speed, select(after > 6, real(6), after), Fraction(0)),)
    wires = {"top": seen == 6, "three": seen * seen == 9, "not yet": seen * Fraction(-1, 2) > -3}
    system = System("steps", Clock(event="tick"), states, {}, wires, {"seen": seen}, {}, {})
    atoms = tuple(Fault(kinds.offset(Fraction(by, 8)), ["seen"]) for by in (-3, 5, 24))
    task = Task(system, atoms, tuple(wires), tuple(wires), Timing(0, 20, 20, 1), lambda frame: {}, {})
    engine = EnclosingEngine(task)
    batch = singles(task)
    assert apart_from_python(task, batch, engine.run(batch), range(4)) == []
    assert engine.redone == 0


def test_sums_over_8000_steps_stay_enclosed() -> None:
    task = thirds(Timing(0, 8000, 8000, 1))
    engine, batch = EnclosingEngine(task), singles(task, 100)
    chosen = Batch(*(a[:, 2:5] for a in (batch.atoms, batch.first, batch.end)))
    found = engine.run(chosen)
    assert apart_from_python(task, chosen, found, range(3)) == []
    assert outside(engine, chosen, 7999) == [] and engine.redone == 0


def test_numbers_beyond_the_doubles_are_redone() -> None:
    x: Any = variable("x", REAL)
    seen = point("seen", x)
    states = (State(x, seen * 10**50, Fraction(1)),)
    signals = {"large": seen * seen > 10**300, "less": seen < seen * seen - seen * seen * 2}
    system = System("large", Clock(event="tick"), states, {}, signals, {"seen": seen}, {}, {})
    atoms = (Fault(kinds.reads(0), ["seen"]), Fault(kinds.reads(10**400), ["seen"]))
    task = Task(system, atoms, tuple(signals), tuple(signals), Timing(0, 12, 12, 1), lambda frame: {}, {})
    engine = EnclosingEngine(task)
    assert apart_from_python(task, singles(task), engine.run(singles(task)), range(3)) == []
    assert engine.redone == 2  # one stays at 0


def test_the_engine_is_chosen_for_reals_and_says_so() -> None:
    engine = engine_for(braking_train(20), "native")
    assert isinstance(engine, EnclosingEngine) and engine_for(braking_train(20)).note == engine.note


def test_a_braking_train() -> None:
    task = braking_train(300)
    batch = random_batch(task, 1, 12, order=1)
    engine = EnclosingEngine(task)
    assert apart_from_python(task, batch, engine.run(batch), range(12)) == []
    assert engine.redone < engine.asked


def test_a_broken_assumption_is_refused_at_its_step() -> None:
    task = thirds()
    total: Any = task.system.states[0].var
    system = replace(task.system, assumptions={"short": total < 4})
    with pytest.raises(CampaignError, match="step 12 of thirds breaks the assumption 'short'"):
        _ = EnclosingEngine(replace(task, system=system)).golden


def outside(engine: EnclosingEngine, batch: Batch, stop: int) -> list[str]:
    """Registers of unmarked runs that before a step do not enclose, or equal, those of the Python run."""
    task, wrong = engine._given, []
    for program, columns, atoms in engine._parts(batch, np.ones(batch.runs, np.bool_)):
        part = Batch(atoms, batch.first[:, columns], batch.end[:, columns])
        records = program.stretch(part, 0, stop, keep=True, prune=False).records
        fields = np.ascontiguousarray(records).view(program.kernel.kept.type)[:, 0]
        units = scales_of(program)
        place = {s.path: fields[f"v{i}"] for i, s in enumerate(program.kernel.registers)}
        for i in [j for j in range(0, len(columns), 5) if not place[HELD][j]]:
            trace = python_registers(task, batch, int(columns[i]), stop + 1)
            for path in task.system.state:
                exact = trace[path][stop]
                if path + LOW in place:
                    if not encloses(int(place[path + LOW][i]), int(place[path + HIGH][i]), exact * units[path]):
                        wrong.append(path)
                elif path in place and bool(place[path][i]) != exact and int(place[path][i]) != exact:
                    wrong.append(path)
    return wrong


def python_registers(task: Task, batch: Batch, column: int, steps: int) -> Any:
    """The registers of a run on the Python reading."""
    faults = [
        replace(task.atoms[atom], onset=INTERMITTENT, at=first, ticks=None if end == NEVER else max(end - first, 0))
        for atom, first, end in zip(
            *(a[:, column].tolist() for a in (batch.atoms, batch.first, batch.end)), strict=True
        )
        if atom != NONE
    ]
    faulted = instrument(task.system, faults)
    choose = schedule(faulted)
    inputs = lambda step: {**task.inputs(step // task.timing.steps), **choose(step)}  # noqa: E731
    return run(faulted.system, inputs, steps, start=task.start, keep=list(task.system.state))


# --- mistakes --------------------------------------------------------------------------------------------------------

Plant = Callable[[pytest.MonkeyPatch], None]
MISTAKES: dict[str, Plant] = {}


def mistake(plant: Plant) -> Plant:
    MISTAKES[plant.__name__.replace("_", " ")] = plant
    return plant


def lowering(method: str, change: Callable[[Any, Lowering, Any, Any], Any]) -> Plant:
    """A method of the lowering whose result is changed."""

    def plant(monkeypatch: pytest.MonkeyPatch) -> None:
        right = getattr(Lowering, method)
        monkeypatch.setattr(Lowering, method, lambda self, *args: change(right(self, *args), self, args, right))

    return plant


@mistake
def a_mark_is_not_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    right = reals.any_of
    monkeypatch.setattr(reals, "any_of", lambda held, *marks: right(held & ~held, *marks))


@mistake
def a_mark_is_lost_in_a_select(monkeypatch: pytest.MonkeyPatch) -> None:
    def without(found: Any, self: Lowering, args: Any, right: Any) -> Any:
        if args[0].op == "select":
            condition = self.new[args[0].args[0].uid]
            self.marks = [m for m in self.marks if m.args[0].args[0] is not condition]
        return found

    lowering("_real", without)(monkeypatch)


def unmarked(op: str) -> Plant:
    def without(found: Any, self: Lowering, args: Any, right: Any) -> Any:
        if args[0] == op:
            self.marks.pop()
        return found

    return lowering("_compared", without)


MISTAKES["equal is not marked"] = unmarked("eq")
MISTAKES["at most is not marked"] = unmarked("le")


@mistake
def runs_are_not_redone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        EnclosingEngine, "run", lambda self, batch: self._shown(super(EnclosingEngine, self).run(batch))
    )


@mistake
def a_constant_is_the_nearest_double(monkeypatch: pytest.MonkeyPatch) -> None:
    right = reals.constants
    monkeypatch.setattr(reals, "constants", lambda value: (right(value)[0], right(value)[0]))


@mistake
def a_difference_takes_the_bounds_of_a_sum(monkeypatch: pytest.MonkeyPatch) -> None:
    def swapped(found: Any, self: Lowering, args: Any, right: Any) -> Any:
        if args[0].op != "sub":
            return found
        (low, high), (least, greatest) = (self.at(a, self.scales.of(args[0])) for a in args[0].args)
        return reals.apply("sub_down", high, least), reals.apply("sub_up", low, greatest)

    lowering("_real", swapped)(monkeypatch)


@mistake
def the_sign_of_a_factor_is_not_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    def positive(x: Any, y: Any) -> Any:
        return reals.apply("mul_down", x[0], x[0], y[0], y[0]), reals.apply("mul_up", x[1], x[1], y[1], y[1])

    monkeypatch.setattr(reals, "_product", positive)


@mistake
def power_up_is_the_lower_double(monkeypatch: pytest.MonkeyPatch) -> None:
    right = reals.enclosure
    monkeypatch.setattr(reals, "enclosure", lambda value: (right(value)[0],) * 2)


def unit(method: str, change: Callable[[Lowering, Any, Any], Any]) -> Plant:
    return lambda monkeypatch: monkeypatch.setattr(Lowering, method, change)


def scale_of_choices(value: Any, var: Any, scales: Any) -> Any:
    return value


UNITS: dict[str, Plant] = {
    "constants in no unit": unit(
        "at", lambda self, t, scale: reals.constants(t.attr) if t.is_const else self.pairs[t.uid]
    ),
    "products in no unit": lambda monkeypatch: monkeypatch.setattr(reals, "_times", lambda x, factor: x),
    "what is given is in no unit": lambda monkeypatch: monkeypatch.setattr(reals, "_scaled", scale_of_choices),
    "what is added has units of its own": lambda monkeypatch: monkeypatch.setattr(
        scales.Scales, "_join", lambda self, group: [self._raise(t, 3 + i) for i, t in enumerate(group)]
    ),
}


def samples() -> list[Task]:
    """The thirds, a wire at a time, and a sum that begins at no double, with products of both signs."""
    task = thirds()
    total = cast(Any, task.system.states[0].var)
    signed: Any = variable("signed", REAL)
    states = (
        State(total, total + point("more", signed * Fraction(-1, 7)) - (signed - THIRD) * signed, Fraction(1, 10)),
        State(signed, real(Fraction(-2, 3)) - signed, Fraction(2, 9)),
    )
    system = System("signs", Clock(event="tick"), states, {}, {"up": total > 1}, {}, {}, {})
    signs = replace(task, system=system, atoms=(), count=("up",), watch=("up",))
    return [signs, *(replace(task, count=(name,), watch=(name,)) for name in task.count if name != "below 10")]


def found() -> bool:
    """Whether some outcome, or an enclosure, is wrong."""
    for task in samples():
        batch = singles(task)
        try:
            seen = EnclosingEngine(task, target=replace(TARGETS["plain"], lanes=16)).run(batch)
        except EnclosureError:
            return True
        if apart_from_python(task, batch, seen, range(batch.runs)):
            return True
    return False


@pytest.mark.parametrize("greatest", [1, 1 << 32])
def test_without_a_mistake_nothing_is_found(greatest: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scales, "GREATEST", greatest)
    assert not found()


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_found(name: str, unscaled: None, monkeypatch: pytest.MonkeyPatch) -> None:
    MISTAKES[name](monkeypatch)
    assert found()


@pytest.mark.parametrize("name", UNITS)
def test_a_mistake_in_a_unit_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    UNITS[name](monkeypatch)
    assert found()


def test_an_enclosure_that_is_left_is_named(unscaled: None, monkeypatch: pytest.MonkeyPatch) -> None:
    a_constant_is_the_nearest_double(monkeypatch)
    with pytest.raises(EnclosureError, match=r"total = .* at step .* lies outside its doubles"):
        _ = EnclosingEngine(thirds()).golden
