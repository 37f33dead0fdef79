"""Any faults at once, of every kind: the readings agree, the lanes see what a run sees, and a proof allows it."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from safety.faults import (
    ANY_TIME,
    FROM_START,
    INTERMITTENT,
    ONSETS,
    TRANSIENT,
    Fault,
    common_cause,
    instrument,
    schedule,
)
from safety.inject.engine import NEVER, NONE, Batch, Engine, Task, Timing
from safety.inject.lanes import LaneEngine
from safety.inject.masks import masks
from safety.kinds import Kind, clock_fast, flip, frozen, intermittent, power_dip, stuck
from safety.model import Model, point, power_up
from safety.prove.solve import SAT, UNSAT, Solver, Unrolling
from safety.system import ANY, ModelError, System
from safety.terms import U2, Bit, Real, select
from safety.terms.graph import BIT, Sort
from safety.terms.values import build, const
from safety.trace import run
from safety.tracing import trace
from tests.kinds.by_hand import CASES, Whole
from tests.kinds.readings import reading


class Wheel(Model, event="tick"):
    """Counts, and says when it comes round."""

    n: U2 = power_up(1)
    kept: U2 = power_up(ANY)

    def step(self, add: U2) -> tuple[Wheel, Bit]:
        total = self.n + add
        return Wheel(n=point("sum", total.low(2)), kept=select(total.bit(2), add, self.kept)), total.bit(2)


class Works(Model, event="tick"):
    """Points within logic that feeds back, two parts, and registers of the whole."""

    left: Wheel
    right: Wheel
    lit: Bit = power_up(False)
    level: Whole = power_up(0)

    def step(self, w: Bit, x: U2) -> tuple[Works, Whole]:
        wire, word = point("wire", w ^ self.lit), point("word", x)
        left, round_ = self.left.step(select(wire, word, 1))
        right, other = self.right.step(point("byte", self.left.n))
        line = point("line", round_ | other)
        lamp = point("lamp", self.lit | x.bit(1))
        whole = point("whole", (self.level + select(line, 1, word.int() - 2)).clip(-3, 3))
        return Works(left=left, right=right, lit=~line & lamp, level=whole), whole


class Weighed(Model, event="tick"):
    """The works, and a weight that they move: a real number, which not every engine takes."""

    works: Works
    way: Real = power_up(0)

    def step(self, w: Bit, x: U2) -> Weighed:
        works, level = self.works.step(w, x)
        way = point("real", self.way + level.real() / 2)
        return Weighed(works=works, way=select(way > 9, 0, way))


class Plant:
    """A model to put faults into: its points by sort, its parts, and wires that show what happens in it."""

    def __init__(self, model: type[Model]) -> None:
        bare = trace(model)
        of = "works." if "works" in bare.parts else ""
        wires = {
            "wire": bare.lookup(f"{of}wire"),
            "line": bare.lookup(f"{of}line"),
            "sum": bare.lookup(f"{of}right.sum").bit(0),
            "high": bare.lookup(f"{of}whole") > 0,
            "kept": bare.lookup(f"{of}left.kept").bit(1),
        }
        if of:
            wires["far"] = bare.lookup("real") > 1
        self.wires = tuple(f"is {name}" for name in wires)
        self.system = replace(bare, signals={**bare.signals, **{f"is {name}": wire for name, wire in wires.items()}})
        self.registers = [s.path for s in bare.states]
        self.points = [p for p in bare.points if p not in self.registers]
        self.parts = [*bare.parts, f"{of}left.n", f"{of}right.kept", bare.name]
        self.words = [s.path for s in bare.states if s.var.sort.kind == "uint"]
        self.by_sort: dict[str, list[str]] = {}
        for name, term in bare.points.items():
            self.by_sort.setdefault(term.sort.kind, []).append(name)
        self.kinds = [case.kind for case in CASES if of or case.at != ("real",)]


WORKS, WEIGHED = Plant(Works), Plant(Weighed)
KINDS = WEIGHED.kinds


def somewhere(plant: Plant, kind: Kind, rng: random.Random) -> list[str]:
    """Places for a kind, drawn."""
    if kind.place == "part":
        return [rng.choice(plant.words if "stored" in kind.name else plant.parts)]
    least = 2 if kind.place == "points" else 1
    points = plant.by_sort[rng.choice([s for s in kind.sorts if len(plant.by_sort.get(s, ())) >= least])]
    return rng.sample(points, 2 if kind.place == "points" else rng.choice([1, len(points)]))


def at_random(plant: Plant, rng: random.Random, kind: Kind | None = None, onset: str | None = None) -> Fault:
    """A fault that can be built in by itself, drawn; without a kind, one in ten is a common cause of two."""
    onset = onset or rng.choice(ONSETS)
    when: dict[str, Any] = {} if onset == FROM_START else {"onset": onset, "at": rng.randrange(4)}
    if onset == TRANSIENT:
        when["ticks"] = rng.randrange(1, 4)
    for _ in range(100):
        chosen = kind or rng.choice(plant.kinds)
        fault = Fault(chosen, somewhere(plant, chosen, rng), **when)
        if kind is None and rng.random() < 0.1:
            members = [rng.choice(plant.kinds) for _ in range(2)]
            fault = common_cause("cause", {"+".join(somewhere(plant, k, rng)): k for k in members}, **when)
        try:
            instrument(plant.system, [fault])
        except ModelError as error:
            assert any(said in str(error) for said in ("depend on each other", "two kinds at", "has bits", "no bits",
                                                       "not a value", "whole numbers only")), error  # fmt: skip
        else:
            return fault
    raise AssertionError(f"{kind} fits nowhere")


def together(plant: Plant, rng: random.Random, *first: Fault) -> list[Fault]:
    """Up to four faults that can be built in at once."""
    for _ in range(100):
        faults = [*first, *(at_random(plant, rng) for _ in range(rng.choice([0, 1, 2, 3])))]
        rng.shuffle(faults)
        try:
            instrument(plant.system, faults)
        except ModelError as error:
            assert "depend on each other" in str(error)
        else:
            return faults
    raise AssertionError("no faults fit together")


def any_value(sort: Sort, rng: random.Random) -> Any:
    if sort.kind == "real":
        return rng.choice([0, 1, -2]) * any_real(rng)
    low, high = sort.bounds
    return bool(rng.randrange(2)) if sort == BIT else rng.randint(low, high)


def any_real(rng: random.Random) -> Any:
    return Fraction(rng.randrange(9), 4)


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_readings_agree_whatever_else_is_broken(kind: Kind) -> None:
    rng = random.Random(str(kind))
    for onset in (FROM_START, rng.choice([ANY_TIME, TRANSIENT, INTERMITTENT])):
        faults = together(WEIGHED, rng, at_random(WEIGHED, rng, kind, onset))
        system = instrument(WEIGHED.system, faults, present=None).system
        state = [any_value(s.var.sort, rng) if s.power_up is ANY else s.power_up for s in system.states]
        for _ in range(4):
            row = [*state, *(any_value(term.sort, rng) for term in system.inputs.values())]
            state = list(reading(system, row)[: len(state)])


# --- a run is one of those that a proof allows ---------------------------------------------------------------------

Rows = list[dict[str, Any]]


def stimulus(rng: random.Random, steps: int) -> Rows:
    return [{"w": bool(rng.randrange(2)), "x": rng.randrange(4)} for _ in range(steps)]


def possible(system: System, rows: Rows, seen: Rows) -> bool:
    """Whether the solver finds choices with which these inputs show this; it is told nothing of schedules."""
    unrolling = Unrolling(system, "z3", integers=True)
    solver = Solver("z3", unrolling.k, 30)
    for k, row in enumerate(rows):
        values = [(system.lookup(name), value) for name, value in {**row, **seen[k]}.items()]
        facts = [build("eq", (term, const(value, term.sort)), None, BIT) for term, value in values]
        solver.add(*unrolling.at(k, facts))
    solver.add_ranges(unrolling)
    answer = solver.check()
    assert answer in (SAT, UNSAT)
    return answer == SAT


def seen_in(plant: Plant, faults: list[Fault], rows: Rows) -> Rows:
    """What a run shows at all points and registers, row by row."""
    built = instrument(plant.system, faults)
    choose = schedule(built)
    found = run(built.system, lambda k: rows[k] | choose(k), len(rows))
    return [{name: found[name][k] for name in (*plant.points, *plant.registers)} for k in range(len(rows))]


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_what_a_run_shows_a_proof_allows(kind: Kind) -> None:
    rng = random.Random(str(kind))
    faults = together(WEIGHED, rng, at_random(WEIGHED, rng, kind))
    rows = stimulus(rng, 3)
    seen = seen_in(WEIGHED, faults, rows)
    assert possible(instrument(WEIGHED.system, faults, present=None).system, rows, seen)
    assert possible(WEIGHED.system, rows, seen) == (seen == seen_in(WEIGHED, [], rows))


# --- engines -------------------------------------------------------------------------------------------------------

Run = list[tuple[int, int, int]]  # each fault that is there: its atom, its first step, the step behind its last


def counted_in_run(plant: Plant, task: Task, one: Run) -> list[int]:
    """True frames of each wire on the Python reading."""
    faults = [
        replace(task.atoms[i], onset=INTERMITTENT, at=first, ticks=None if end == NEVER else end - first, name=str(row))
        for row, (i, first, end) in enumerate(one)
        if i != NONE
    ]
    built = instrument(task.system, faults)
    choose = schedule(built)
    found = run(built.system, lambda k: {**task.inputs(k), **choose(k)}, task.timing.frames)
    return [sum(found[wire]) for wire in plant.wires]


def task_of(plant: Plant, atoms: list[Fault], rows: Rows) -> Task:
    timing = Timing(0, len(rows), len(rows), 1)
    return Task(plant.system, tuple(atoms), plant.wires, (), timing, lambda frame: rows[frame], {})


def batch_of(runs: list[Run]) -> Batch:
    return Batch(*(np.array([[row[what] for row in one] for one in runs], dtype=np.int32).T for what in range(3)))


def check(plant: Plant, engine: Engine, task: Task, runs: list[Run]) -> None:
    outcome = engine.run(batch_of(runs))
    for column, one in enumerate(runs):
        counted = [int(outcome.counts[wire][0, column]) for wire in plant.wires]
        assert counted == counted_in_run(plant, task, one), [str(task.atoms[i]) for i, *_ in one if i != NONE]


def at_any_times(plant: Plant, rng: random.Random) -> tuple[Task, list[Run]]:
    """Every kind alone or beside another, at any times."""
    atoms = [at_random(plant, rng, kind, FROM_START) for kind in plant.kinds]
    task = task_of(plant, atoms, stimulus(rng, 10))
    runs: list[Run] = []
    for i in range(len(atoms)):
        first, other = rng.choice([0, 0, 3]), rng.choice([NONE, rng.randrange(len(atoms))])
        runs.append([(i, first, rng.choice([NEVER, first + 3])), (other, 2, rng.choice([NEVER, 4]))])
    return task, [one for one in runs if fits(task, one)]


def fits(task: Task, one: Run) -> bool:
    """Whether these faults can be there at once: not two that join points in opposite directions."""
    try:
        instrument(task.system, [task.atoms[i] for i, *_ in one if i != NONE])
    except ModelError as error:
        assert "depend on each other" in str(error)
        return False
    return True


@pytest.mark.parametrize("seed", range(3))
def test_lanes_count_what_a_run_shows(seed: int) -> None:
    task, runs = at_any_times(WEIGHED, random.Random(seed))
    check(WEIGHED, LaneEngine(task), task, runs)


def test_native_code_counts_what_a_run_shows() -> None:
    pytest.importorskip("llvmlite", reason="the native engine needs llvmlite")
    from safety.inject.native import NativeEngine

    task, runs = at_any_times(WORKS, random.Random(4))
    check(WORKS, NativeEngine(task), task, runs)


def test_an_engine_that_takes_another_kind_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fast clock that takes a step too many is seen in the counts."""
    rows = stimulus(random.Random(3), 10)
    task = task_of(WORKS, [Fault(clock_fast(2), ["left"])], rows)
    other = replace(task, atoms=(Fault(clock_fast(3), ["left"]),))
    with pytest.raises(AssertionError):
        check(WORKS, LaneEngine(other), task, [[(0, 0, NEVER)]])


def test_a_common_cause_with_a_part_is_no_mask() -> None:
    cause = common_cause("both", {"left.sum": stuck(1), "left": power_dip()})
    atoms = [cause, Fault(flip(), ["wire"]), Fault(clock_fast(), ["left"]), Fault(frozen(), ["left.sum"])]
    task = task_of(WORKS, atoms, stimulus(random.Random(1), 8))
    check(WORKS, LaneEngine(task), task, [[(a, 0, NEVER), (b, 0, NEVER)] for a in range(4) for b in range(4) if a != b])


def test_a_point_and_a_register_of_one_name_are_two_places() -> None:
    """A mask at the point does not stand for what happens to the register."""

    class Named(Model, event="tick"):
        """A register behind a point of its name."""

        n: Bit = power_up(False)

        def step(self, w: Bit, x: U2) -> tuple[Named, Bit]:
            shown = point("n", self.n)
            return Named(n=~shown), w

    system = trace(Named)
    cause = common_cause("both", {"n": flip(), "Named": power_dip()})
    assert masks(system, cause) is None and masks(system, Fault(flip(), ["n"])) is not None


def test_a_duty_of_any_kind_leaves_its_other_steps_alone() -> None:
    rows = stimulus(random.Random(2), 12)
    for kind in KINDS:
        fault = at_random(WEIGHED, random.Random(str(kind)), kind, FROM_START)
        duty = replace(fault, kind=intermittent(fault.kind, 1, 12))
        once = replace(fault, onset=TRANSIENT, at=0, ticks=1)
        assert seen_in(WEIGHED, [duty], rows) == seen_in(WEIGHED, [once], rows), kind
