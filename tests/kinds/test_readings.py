"""Any faults at once, of every kind: the readings agree, the lanes see what a run sees, and a proof allows it."""

from __future__ import annotations

import random
from dataclasses import replace
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
from safety.inject.engine import NEVER, NONE, Batch, Task, Timing
from safety.inject.lanes import LaneEngine
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
    """Points of every sort within logic that feeds back, two parts, and registers of the whole."""

    left: Wheel
    right: Wheel
    lit: Bit = power_up(False)
    level: Whole = power_up(0)
    way: Real = power_up(0)

    def step(self, w: Bit, x: U2) -> Works:
        wire, word = point("wire", w ^ self.lit), point("word", x)
        left, round_ = self.left.step(select(wire, word, 1))
        right, other = self.right.step(point("byte", self.left.n))
        line = point("line", round_ | other)
        whole = point("whole", (self.level + select(line, 1, word.int() - 2)).clip(-3, 3))
        real = point("real", self.way + whole.real() / 2)
        return Works(
            left=left,
            right=right,
            lit=~line & point("lamp", self.lit | x.bit(1)),
            level=whole,
            way=select(real > 9, 0, real),
        )


WORKS = trace(Works)
PARTS = ["left", "right", "left.n", "right.kept", "Works"]
BY_SORT = {kind: [p for p, t in WORKS.points.items() if t.sort.kind == kind] for kind in ("bit", "uint", "int", "real")}
KINDS = [case.kind for case in CASES]


def somewhere(kind: Kind, rng: random.Random) -> list[str]:
    """Places for a kind, drawn."""
    if kind.place == "part":
        parts = ["left.n", "right.kept"] if "stored" in kind.name else PARTS
        return [rng.choice(parts)]
    sort = rng.choice([s for s in kind.sorts if len(BY_SORT[s]) >= (2 if kind.place == "points" else 1)])
    return rng.sample(BY_SORT[sort], 2 if kind.place == "points" else rng.choice([1, len(BY_SORT[sort])]))


def at_random(rng: random.Random, kind: Kind | None = None, onset: str | None = None) -> Fault:
    """A fault that can be built into the works by itself, drawn; one kind in ten is a common cause of two."""
    onset = onset or rng.choice(ONSETS)
    when: dict[str, Any] = {} if onset == FROM_START else {"onset": onset, "at": rng.randrange(4)}
    if onset == TRANSIENT:
        when["ticks"] = rng.randrange(1, 4)
    for _ in range(100):
        chosen = kind or rng.choice(KINDS)
        fault = Fault(chosen, somewhere(chosen, rng), **when)
        if kind is None and rng.random() < 0.1:
            members = [rng.choice(KINDS) for _ in range(2)]
            fault = common_cause("cause", {"+".join(somewhere(k, rng)): k for k in members}, **when)
        try:
            instrument(WORKS, [fault])
        except ModelError as error:
            assert any(said in str(error) for said in ("depend on each other", "two kinds at", "has bits", "no bits",
                                                       "not a value", "whole numbers only")), error  # fmt: skip
        else:
            return fault
    raise AssertionError(f"{kind} fits nowhere in the works")


def together(rng: random.Random, *first: Fault) -> list[Fault]:
    """Up to four faults that can be built in at once."""
    for _ in range(100):
        faults = [*first, *(at_random(rng) for _ in range(rng.choice([0, 1, 2, 3])))]
        rng.shuffle(faults)
        try:
            instrument(WORKS, faults)
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
    from fractions import Fraction

    return Fraction(rng.randrange(9), 4)


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_readings_agree_whatever_else_is_broken(kind: Kind) -> None:
    rng = random.Random(str(kind))
    for onset in (FROM_START, rng.choice([ANY_TIME, TRANSIENT, INTERMITTENT])):
        system = instrument(WORKS, together(rng, at_random(rng, kind, onset)), present=None).system
        state = [any_value(s.var.sort, rng) if s.power_up is ANY else s.power_up for s in system.states]
        for _ in range(4):
            row = [*state, *(any_value(term.sort, rng) for term in system.inputs.values())]
            state = list(reading(system, row)[: len(state)])


# --- a run is one of those that a proof allows ---------------------------------------------------------------------


def stimulus(rng: random.Random, steps: int) -> list[dict[str, Any]]:
    return [{"w": bool(rng.randrange(2)), "x": rng.randrange(4)} for _ in range(steps)]


def possible(system: System, rows: list[dict[str, Any]], seen: list[dict[str, Any]]) -> bool:
    """Whether the solver finds choices with which these inputs show this; it is told nothing of schedules."""
    unrolling = Unrolling(system, "z3", integers=True)
    solver = Solver("z3", unrolling.k, 30)
    for k, row in enumerate(rows):
        values = {name: (system.lookup(name), value) for name, value in {**row, **seen[k]}.items()}
        facts = [build("eq", (term, const(value, term.sort)), None, BIT) for term, value in values.values()]
        solver.add(*unrolling.at(k, facts))
    solver.add_ranges(unrolling)
    answer = solver.check()
    assert answer in (SAT, UNSAT)
    return answer == SAT


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_what_a_run_shows_a_proof_allows(kind: Kind) -> None:
    rng = random.Random(str(kind))
    faults = together(rng, at_random(rng, kind))
    built, rows = instrument(WORKS, faults), stimulus(rng, 3)
    choose = schedule(built)
    free = instrument(WORKS, faults, present=None).system
    points = [p for p in WORKS.points if p not in WORKS.state]
    found = run(built.system, lambda k: rows[k] | choose(k), 3)
    seen = [{p: found[p][k] for p in points} | {s.path: found[s.path][k] for s in WORKS.states} for k in range(3)]
    assert possible(free, rows, seen)
    k = rng.randrange(3)
    strange = [*seen[:k], seen[k] | {"level": 2 if seen[k]["level"] < 1 else -2}, *seen[k + 1 :]]
    without = instrument(WORKS, []).system
    assert possible(without, rows, seen) == (seen == healthy(rows))
    assert not possible(without, rows, strange)


def healthy(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    found = run(WORKS, rows)
    points = [p for p in WORKS.points if p not in WORKS.state]
    return [{p: found[p][k] for p in (*points, *WORKS.state)} for k in range(len(rows))]


# --- lanes ---------------------------------------------------------------------------------------------------------

WATCHED: dict[str, Any] = {
    "wire": lambda s: s.lookup("wire"),
    "line": lambda s: s.lookup("line"),
    "sum": lambda s: s.lookup("right.sum").bit(0),
    "high": lambda s: s.lookup("whole") > 0,
    "far": lambda s: s.lookup("real") > 1,
    "kept": lambda s: s.lookup("left.kept").bit(1),
}
OBSERVED = replace(WORKS, signals={**WORKS.signals, **{f"is {n}": term(WORKS) for n, term in WATCHED.items()}})
WIRES = tuple(f"is {name}" for name in WATCHED)


def counted_in_runs(task: Task, atoms: list[tuple[int, int, int]]) -> list[int]:
    """True frames of each wire with these atoms on the Python reading: (atom, first step, step behind the last)."""
    faults = [
        replace(task.atoms[i], onset=INTERMITTENT, at=first, ticks=None if end == NEVER else end - first, name=str(row))
        for row, (i, first, end) in enumerate(atoms)
        if i != NONE
    ]
    built = instrument(task.system, faults)
    choose = schedule(built)
    found = run(built.system, lambda k: {**task.inputs(k), **choose(k)}, task.timing.frames)
    return [sum(found[wire]) for wire in WIRES]


def task_of(atoms: list[Fault], rows: list[dict[str, Any]]) -> Task:
    timing = Timing(0, len(rows), len(rows), 1)
    return Task(OBSERVED, tuple(atoms), WIRES, (), timing, lambda frame: rows[frame], {})


def batch_of(runs: list[list[tuple[int, int, int]]]) -> Batch:
    return Batch(*(np.array([[row[what] for row in one] for one in runs], dtype=np.int32).T for what in range(3)))


@pytest.mark.parametrize("seed", range(4))
def test_lanes_count_what_a_run_shows(seed: int) -> None:
    """Every kind alone and beside another, at any times, side by side on the lanes."""
    rng = random.Random(seed)
    task = task_of([at_random(rng, kind, FROM_START) for kind in KINDS], stimulus(rng, 10))
    runs = []
    for i in range(len(KINDS)):
        first = rng.choice([0, 0, 3])
        other = rng.choice([NONE, rng.randrange(len(KINDS))])
        runs.append([(i, first, rng.choice([NEVER, first + 3])), (other, 2, rng.choice([NEVER, 4]))])
    runs = [one for one in runs if fits(task, one)]
    outcome = LaneEngine(task).run(batch_of(runs))
    for column, one in enumerate(runs):
        counted = [int(outcome.counts[wire][0, column]) for wire in WIRES]
        assert counted == counted_in_runs(task, one), [str(task.atoms[i]) for i, *_ in one if i != NONE]


def fits(task: Task, one: list[tuple[int, int, int]]) -> bool:
    """Whether these faults can be there at once: not two that join points in opposite directions."""
    try:
        instrument(task.system, [task.atoms[i] for i, *_ in one if i != NONE])
    except ModelError as error:
        assert "depend on each other" in str(error)
        return False
    return True


def test_a_common_cause_with_a_part_is_no_mask() -> None:
    """A point and a register of one name: the fault of the point has a mask, that of the register has none."""
    cause = common_cause("both", {"left.sum": stuck(1), "left": power_dip()})
    rows = stimulus(random.Random(1), 8)
    task = task_of([cause, Fault(flip(), ["wire"]), Fault(clock_fast(), ["left"]), Fault(frozen(), ["left.sum"])], rows)
    runs = [[(a, 0, NEVER), (b, 0, NEVER)] for a in range(4) for b in range(4) if a != b]
    outcome = LaneEngine(task).run(batch_of(runs))
    for column, one in enumerate(runs):
        assert [int(outcome.counts[w][0, column]) for w in WIRES] == counted_in_runs(task, one)


def test_a_duty_of_any_kind_leaves_its_other_steps_alone() -> None:
    rows = stimulus(random.Random(2), 12)
    for kind in KINDS:
        rng = random.Random(str(kind))
        fault = at_random(rng, kind, FROM_START)
        built = instrument(WORKS, [replace(fault, kind=intermittent(fault.kind, 1, 12))])
        now = instrument(WORKS, [replace(fault, onset=TRANSIENT, at=0, ticks=1)])
        shown = [run(b.system, [row | schedule(b)(k) for k, row in enumerate(rows)]) for b in (built, now)]
        assert all(shown[0][p] == shown[1][p] for p in (*WORKS.points, *WORKS.state)), kind
