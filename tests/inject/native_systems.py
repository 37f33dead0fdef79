"""Random systems with registers and points, random faults of all kinds in them, and what a Python run of one shows."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from safety import kinds
from safety.faults import INTERMITTENT, Fault, instrument, schedule
from safety.inject.engine import NEVER, NONE, Batch, Outcome, Task, Timing
from safety.model import ANY
from safety.system import Clock, State, System
from safety.terms import implies, select
from safety.terms.graph import BIT, Sort, Term, integer, node, uint, variable
from safety.trace import run

SHORT = Timing(3, 24, 8, 1)
RANGES = ((-9, -2), (-128, 127), (-7, 300), (3, 9), (0, 11534335), (-40000, 40000))


def random_sort(pick: random.Random, kind: str | None = None) -> Sort:
    kind = kind or pick.choice(["bit", "bit", "uint", "uint", "uint", "int"])
    if kind == "bit":
        return BIT
    if kind == "uint":
        return uint(pick.choice([1, 2, 4, 7, 8, 8, 8, 9, 10, 13, 16, 20]))
    return integer(*pick.choice(RANGES))


class Pool:
    """Terms that grow from each other, all of them of 60 bits at most."""

    def __init__(self, pick: random.Random, terms: Sequence[Any]) -> None:
        self.pick, self.terms = pick, list(terms)
        self.points: dict[str, Term] = {}

    def any(self, *kinds: str) -> Any:
        return self.pick.choice([t for t in self.terms if t.sort.kind in kinds])

    def fitted(self, term: Any, sort: Sort) -> Any:
        """A term brought to a sort."""
        if sort == BIT:
            return term if term.sort == BIT else term.low(1).bit(0)
        if term.sort == BIT:
            term = term.word()
        if sort.kind == "uint":
            return term.low(sort.width) if self.pick.random() < 0.7 else term.sat(sort.width)
        return term.int().clip(*sort.bounds) if term.sort.kind == "uint" else term.clip(*sort.bounds)

    def grow(self) -> None:
        pick, bit, number = self.pick, self.any("bit"), self.any("uint", "int")
        other, word = self.any("uint", "int"), self.any("uint")
        like = self.fitted(self.any("uint", "int", "bit"), word.sort)
        made = pick.choice([
            lambda: ~bit, lambda: bit & self.any("bit"), lambda: bit | self.any("bit"), lambda: bit ^ self.any("bit"),
            lambda: implies(bit, self.any("bit")), lambda: bit == self.any("bit"), lambda: bit.word(),
            lambda: number + other, lambda: number - other, lambda: number * other, lambda: number + pick.randrange(9),
            lambda: number == other, lambda: number < other, lambda: number <= other, lambda: number > 7,
            lambda: select(bit, word, like), lambda: word & like, lambda: word | like, lambda: word ^ like,
            lambda: word // pick.choice([1, 3, 7, 10, 256]), lambda: word % pick.choice([1, 3, 7, 10, 256]),
            lambda: word.concat(like), lambda: word.bit(pick.randrange(word.width)), lambda: ~word,
            lambda: number.low(pick.randint(1, 20)), lambda: word.sat(pick.randint(1, 12)),
            lambda: word.slice(0, word.width), lambda: (word + like).bit(word.width),
            lambda: (word + like).low(word.width), lambda: (word + like).sat(word.width),
            lambda: select(bit, self.any("bit"), self.any("bit")),
        ])()  # fmt: skip
        if made.sort.kind == "bit" or all(abs(b) < 1 << 60 for b in made.sort.bounds):
            self.terms.append(self._pointed(made))

    def _pointed(self, term: Any) -> Any:
        if self.pick.random() < 0.4:
            name = f"p{len(self.points)}"
            term = self.points[name] = node("point", (term,), name, term.sort)
        return term


def random_system(seed: int, size: int = 40) -> System:
    """A system with some registers, inputs and points; signals `w0`, `w1`, ... are bits."""
    pick = random.Random(seed)
    sorts = [BIT, BIT, uint(8), uint(8), *(random_sort(pick) for _ in range(5))]
    held = [variable(f"part{i % 2}.r{i}", sort) for i, sort in enumerate(sorts)]
    inputs = {f"x{i}": variable(f"x{i}", random_sort(pick, kind)) for i, kind in enumerate(["bit", "uint", "int"])}
    pool = Pool(pick, [*held, *inputs.values()])
    while len(pool.terms) < size:
        pool.grow()
    states = []
    for var in held:
        following = pool.fitted(pick.choice(pool.terms[-size // 2 :]), var.sort)
        low = False if var.sort == BIT else var.sort.bounds[0]
        states.append(State(var, following, pick.choice([low, ANY])))
    wires = {f"w{i}": pool.fitted(pick.choice(pool.terms[-10:]), BIT) for i in range(4)}
    parts = {"part0": "Part", "part1": "Part"}
    return System("random", Clock(event="tick"), tuple(states), inputs, wires, pool.points, {}, parts)


def random_atoms(system: System, seed: int, number: int, *, masks_only: bool = False) -> list[Fault]:
    """Faults at random places of a system; a kind that needs more than a mask one time in two."""
    pick = random.Random(seed)
    by_sort: dict[Sort, list[str]] = {}
    for name, point in system.points.items():
        by_sort.setdefault(point.sort, []).append(name)
    found: list[Fault] = []
    for i in range(number):
        name = pick.choice(list(system.points))
        sort = system.points[name].sort
        if masks_only or pick.random() < 0.5:
            if sort.kind not in ("bit", "uint"):
                continue
            bit = None if sort == BIT or pick.random() < 0.3 else pick.randrange(sort.width)
            kind = pick.choice([kinds.stuck(0, bit), kinds.stuck(1, bit), kinds.flip(bit)])
            found.append(Fault(kind, [name], name=f"{i}"))
        else:
            found.append(_memory_fault(pick, name, sort, by_sort[sort], str(i)))
    return found


def _memory_fault(pick: random.Random, name: str, sort: Sort, same: list[str], label: str) -> Fault:
    """A fault with memory, choices, arithmetic, several points, or at registers."""
    low, high = sort.bounds
    some = [kinds.frozen(), kinds.delayed(pick.randint(1, 3)), kinds.byzantine(), kinds.dead()]
    some += [kinds.reads(bool(high) if sort == BIT else pick.randint(low, high))]
    if sort == BIT:
        some += [kinds.missing(2), kinds.missing(1, every=3), kinds.extra(), kinds.extra(every=3)]
        some += [kinds.oscillating(2), kinds.slow_to_operate(2), kinds.slow_to_release(3)]
        some += [kinds.intermittent(kinds.stuck(1), 1, 2)]
    else:
        some += [kinds.offset(1), kinds.drift(1), kinds.noise(1)]
    other = pick.choice(same)
    special = pick.random()
    if special < 0.15 and other != name:
        joined = [kinds.swapped(late=True)]
        joined += [kinds.wired_and(late=True), kinds.bridge(late=True)] if sort.kind != "int" else []
        return Fault(pick.choice(joined), [name, other], name=label)
    if special < 0.3:
        at_part = [
            kinds.clock_stop(),
            kinds.clock_slow(3),
            kinds.clock_fast(2),
            kinds.clock_glitch(0),
            kinds.power_dip(),
        ]
        return Fault(pick.choice(at_part), [pick.choice(["part0", "part1"])], name=label)
    kind = pick.choice(some)
    if special < 0.4:
        return Fault(kind, list(dict.fromkeys([name, other])), name=label)
    values = None
    if kind.name == "byzantine":
        values = {name: [bool(v % 2) if sort == BIT else low + v % (high - low + 1) for v in (5, 1, 8, 2)]}
    return Fault(kind, [name], name=label, values=values)


def random_batch(task: Task, seed: int, runs: int, order: int = 2) -> Batch:
    """Runs with up to `order` faults each, some for ever, some not."""
    rng = np.random.default_rng(seed)
    shape, steps = (order, runs), task.timing.frames * task.timing.steps
    atoms = rng.integers(NONE, len(task.atoms), shape)
    atoms[0] = np.maximum(atoms[0], 0)
    first = rng.integers(0, task.timing.frames, shape) * task.timing.steps
    length = rng.integers(1, 6, shape) * task.timing.steps
    end = np.where(rng.random(shape) < 0.4, NEVER, np.minimum(first + length, steps))
    first = np.where(rng.random(shape) < 0.2, 0, first)
    return Batch(atoms.astype(np.int32), first.astype(np.int32), end.astype(np.int32))


def random_task(seed: int, timing: Timing = SHORT, atoms: int = 24, **how: Any) -> Task:
    """A task on a random system: its stimulus changes from frame to frame."""
    system = random_system(seed)
    pick = random.Random(seed)
    rows = []
    for _ in range(timing.frames):
        row: dict[str, Any] = {}
        for name, term in system.inputs.items():
            row[name] = pick.random() < 0.5 if term.sort == BIT else pick.randint(*term.sort.bounds)
        rows.append(row)
    found = tuple(random_atoms(system, seed, atoms, **how))
    return Task(system, found, ("w0", "w1"), ("w1", "w2"), timing, rows.__getitem__, {})


def python_outcome(task: Task, batch: Batch, column: int) -> tuple[dict[str, list[int]], dict[str, int]]:
    """Counts by block and first true frames of one run on the Python reading."""
    t = task.timing
    faults = []
    for atom, first, end in zip(*(a[:, column].tolist() for a in (batch.atoms, batch.first, batch.end)), strict=True):
        if atom != NONE:
            ticks = None if end == NEVER else max(end - first, 0)
            faults.append(replace(task.atoms[atom], onset=INTERMITTENT, at=first, ticks=ticks))
    faulted = instrument(task.system, faults)
    choose = schedule(faulted)
    wires = list(dict.fromkeys((*task.count, *task.watch)))
    trace = run(
        replace(faulted.system, assumptions={}),
        lambda step: {**task.inputs(step // t.steps), **choose(step)},
        t.frames * t.steps,
        start=task.start,
        keep=wires,
    )
    ends = {name: trace[name][t.steps - 1 :: t.steps][t.run_in :] for name in wires}
    counts = {name: [sum(ends[name][k : k + t.block]) for k in range(0, t.measured, t.block)] for name in task.count}
    return counts, {name: ends[name].index(True) if True in ends[name] else NEVER for name in task.watch}


def differences(one: Outcome, other: Outcome) -> list[str]:
    """Wires on which two outcomes differ."""
    found = [name for name in other.counts if not np.array_equal(one.counts[name], other.counts[name])]
    return found + [f"first {name}" for name in other.first if not np.array_equal(one.first[name], other.first[name])]


def apart_from_python(task: Task, batch: Batch, found: Outcome, columns: Sequence[int]) -> list[int]:
    """The columns whose outcome is not that of the Python run."""
    return [
        c
        for c in columns
        if python_outcome(task, batch, c)
        != (
            {name: array[:, c].tolist() for name, array in found.counts.items()},
            {name: int(array[c]) for name, array in found.first.items()},
        )
    ]
