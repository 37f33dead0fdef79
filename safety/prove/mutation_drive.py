"""Mutants driven to where times run out and bounds are met: a lane is a mutant on a course of inputs.

A course holds each input for a while and then changes some: for as long as a limit of the model, a step more or less,
or any time; by itself or so long after an earlier change.  It begins as a known run, as one of a swarm that keeps what
is given, or with inputs that stand still.  A mutant that breaks the claim on a lane is run again by itself on the
Python reading before it counts (`mutation_runs.confirmed`).
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from safety.prove import search
from safety.prove.mutation import Mutant
from safety.prove.mutation_runs import FEW, Course, Lanes, single
from safety.prove.problem import Problem
from safety.prove.swarm import DENSITIES, Row, Swarm, Values, compared
from safety.system import ANY
from safety.terms.graph import REAL, postorder
from safety.terms.table import is_object
from safety.terms.texts import compile_lanes, lane_type
from safety.terms.values import bit
from safety.trace import least

Array = npt.NDArray[Any]
Begun = tuple[Row, list[Array], list[int]]  # a start, a column for each input, steps at which wires change
Known = tuple[Sequence[str], Course]  # names of the inputs, and a run

LANES = 8192
COURSES = (16, 256)  # at least and at most
SHORT = (60, 600)  # steps
DEEPEST = 20_000
LONGEST = 8000  # a greater constant is no number of steps
CHANGES = 0.25  # of a course: the chance that the last change was the last
SWARM_SECONDS = 5.0
FROM_SWARM = 24  # courses
FROM_POOL, AS_IT_WAS = 0.8, 0.1  # shares of courses: that vary an earlier one, that leave it as it was
NEW, LARGEST = 32, 160  # courses that a round adds to earlier ones, and how many are kept


class Drive:
    """Courses of inputs for a claim's problem, that of all mutants; `known` are runs to begin with."""

    def __init__(self, problem: Problem, known: Sequence[Known], seed: int = 0) -> None:
        self.problem, self.known = problem, known
        self.as_written = single(problem, None)
        self.rng = np.random.default_rng(seed)
        self.inputs = list(self.as_written.system.inputs.values())
        self.free = [s for s in self.as_written.system.states if s.power_up is ANY]
        self.roused = False  # whether swarms are among what courses begin with, and all is watched to its end
        plain = self.as_written
        constants = compared([plain.holds, plain.given, plain.start, *plain.system.roots()])
        self.values = [] if self.reals else [Values(v, constants) for v in self.inputs]
        self.lengths = [c for c in constants if 1 < c <= LONGEST]
        self.depth = int(min(DEEPEST, max(SHORT[-1], *(2.5 * n for n in self._limits()))))

    def _limits(self) -> list[int]:
        """Numbers of steps that the problem speaks of: constants, and the ends of parameters that are left open."""
        rigid = [s.var for s in self.free if s.next is s.var and s.var.sort.kind == "uint"]
        return [0, *self.lengths, *(n for v in rigid for n in v.sort.bounds if n <= LONGEST)]

    @cached_property
    def reals(self) -> bool:
        """Whether there are numbers for which lanes are no help."""
        roots = [self.as_written.holds, self.as_written.given, *self.as_written.system.roots()]
        return any(t.sort == REAL for t in postorder(roots)) or any(is_object(v.sort) for v in self.inputs)

    def broken(self, mutants: Sequence[Mutant], seconds: float, patience: int) -> Iterator[tuple[int, Course, int]]:
        """Mutants that break the claim, each with the course and the step.

        For about so many seconds of computing: on short courses; with some patience also on known ones, and on courses
        at full depth, those of swarms too, until so many rounds in a row find nothing.
        """
        if self.reals or not self.starts:
            return
        if patience and not self.roused:
            self.roused = True
            known = [(start, columns) for start, columns, _ in self.pool]
            self.pool = [*self._watched(known, DEEPEST), *self._of_swarms()]
        until, left, fruitless = time.process_time() + seconds, list(mutants), 0
        rounds = [*([None] if patience else []), *SHORT[::-1], *SHORT[::-1]]
        while left and (rounds or fruitless < patience) and time.process_time() < until:
            deep = not rounds
            found = self._round(left, self._courses(self.depth if deep else rounds.pop(0), len(left)), until)
            fruitless = 0 if found else fruitless + deep
            left = [m for m in left if m.number not in found]
            for number, (course, step) in found.items():
                yield number, course, step

    def _courses(self, steps: int | None, mutants: int) -> list[tuple[Row, list[Array]]]:
        """Courses for a round of so many mutants; the known ones where no number of steps is given."""
        if steps is None:
            return self._known()
        return [self.course(min(steps, self.depth)) for _ in range(max(COURSES[0], min(COURSES[1], LANES // mutants)))]

    # --- courses -----------------------------------------------------------------------------------------------------

    @cached_property
    def starts(self) -> list[Row]:
        """Contents of the free registers that the start admits."""
        found = [start for _, course in self.known if (start := self._start_of(course)) is not None]
        constants = compared([self.as_written.start, *self.as_written.system.roots()])
        many = COURSES[1] * 4
        density = self.rng.choice(DENSITIES, many)
        at_ends = self.rng.random(many) < 0.7
        drawn = {s.path: Values(s.var, constants).draw(self.rng, density, at_ends) for s in self.free}
        states = [
            drawn.get(s.path, np.full(many, 0 if s.power_up is ANY else s.power_up, dtype=lane_type(s.var)))
            for s in self.as_written.system.states
        ]
        if states:
            ready = compile_lanes([s.var for s in self.as_written.system.states], [self.as_written.start])(*states)[0]
            chosen = np.flatnonzero(ready)[: COURSES[1]]
            found += [{path: column[i].item() for path, column in drawn.items()} for i in chosen]
        if not found:
            run = search.bounded(self.as_written, bit(True), 1, False, SWARM_SECONDS).run
            found += [{s.path: run[s.path][0] for s in self.free}] if run is not None else []
        return found

    def _start_of(self, course: Course) -> Row | None:
        """What the free registers hold at the start of a run; None where it does not say all of it."""
        named = all(s.path in course.start for s in self.free)
        return {s.path: course.start[s.path] for s in self.free} if named else None

    @cached_property
    def pool(self) -> list[Begun]:
        """Where courses begin: known runs."""
        found = []
        for names, course in self.known:
            by_name = dict(zip(names, zip(*course.rows, strict=True), strict=True)) if names else {}
            columns = [by_name.get(v.attr, [least(v.sort)] * len(course.rows)) for v in self.inputs]
            start = self._start_of(course) or self.starts[0]
            arrays = [np.array(c, dtype=lane_type(v)) for c, v in zip(columns, self.inputs, strict=True)]
            found.append((start, arrays))
        return self._watched(found, SHORT[-1])

    def _of_swarms(self) -> list[Begun]:
        """Runs of swarms, short and deep, where something is given that courses may break."""
        if not self.inputs or self.as_written.given.is_const:
            return []
        found = [begun for horizon in (*SHORT, self.depth) for begun in self._of_a_swarm(horizon)]
        return self._watched(found, DEEPEST)

    def _of_a_swarm(self, horizon: int) -> list[tuple[Row, list[Array]]]:
        swarm = Swarm(self.as_written, ~self.as_written.holds, (), int(self.rng.integers(1 << 30)))
        until = time.process_time() + SWARM_SECONDS
        swarm.run(horizon, lambda: time.process_time() > until)
        if not swarm.course:
            return []
        found = []
        for lane in self.rng.choice(swarm.lanes, FROM_SWARM, replace=False):
            start, rows = swarm.history(len(swarm.course) - 1, int(lane))
            columns = [np.array([row[v.attr] for row in rows], dtype=lane_type(v)) for v in self.inputs]
            found.append((start, columns))
        return found

    def course(self, steps: int) -> tuple[Row, list[Array]]:
        """One course: a start, and a column of so many steps for each input."""
        rng = self.rng
        start, columns, events = self.starts[rng.integers(len(self.starts))], None, [0]
        if self.pool and rng.random() < FROM_POOL:
            start, known, met = self.pool[rng.integers(len(self.pool))]
            columns = [_filled(c, steps) for c in known]
            events += [t for t in met if t < steps]
        if columns is None:
            columns = [np.full(steps, self._value(i), dtype=v.kind) for i, v in enumerate(self.values)]
        elif rng.random() < AS_IT_WAS:
            return start, columns
        lengths = [*self.lengths, *(n for n in start.values() if type(n) is int and 1 < n <= LONGEST)]
        while self.inputs:
            first = events[rng.integers(len(events))] + int(rng.integers(-2, 4))
            if lengths and rng.random() < 0.3:
                first += lengths[rng.integers(len(lengths))]
            elif rng.random() < 0.3:
                first = self._any_length(steps)
            exact = lengths and rng.random() < 0.4
            last = first + (lengths[rng.integers(len(lengths))] if exact else self._any_length(2 * steps))
            for i in rng.choice(len(columns), min(len(columns), int(rng.geometric(0.6))), replace=False):
                columns[i][max(0, first) : max(0, last)] = self._value(i)
            events += [t for t in (first, last) if 0 < t < steps]
            if rng.random() < CHANGES:
                break
        return start, columns

    def _watched(self, courses: Sequence[tuple[Row, list[Array]]], most: int) -> list[Begun]:
        """Courses with the steps, of so many, at which a wire of the model as it is changes in them."""
        if not courses:
            return []
        system = self.as_written.system
        step = compile_lanes([*(s.var for s in system.states), *self.inputs], [s.next for s in system.states])
        wires = [i for i, s in enumerate(system.states) if s.var.sort.kind == "bit" and s.next is not s.var]
        state = [
            np.array([start.get(s.path, s.power_up) for start, _ in courses], dtype=lane_type(s.var))
            for s in system.states
        ]
        steps = min(most, max(len(columns[0]) if columns else 0 for _, columns in courses))
        table = [
            np.stack([_filled(columns[i], steps) for _, columns in courses], axis=1) for i in range(len(self.inputs))
        ]
        met: list[list[int]] = [[] for _ in courses]
        changed = np.zeros(len(courses), dtype=np.bool_)
        for k in range(steps):
            result = step(*state, *(column[k] for column in table))
            following = [x if x.shape == changed.shape else np.broadcast_to(x, changed.shape) for x in result]
            changed[:] = False
            for i in wires:
                changed |= following[i] != state[i]
            for j in map(int, np.flatnonzero(changed)):
                met[j].append(k)
            state = following
        return [(start, columns, steps) for (start, columns), steps in zip(courses, met, strict=True)]

    def _value(self, i: int) -> Any:
        return self.values[i].draw(self.rng, self.rng.choice(DENSITIES, 1))[0]

    def _any_length(self, most: int) -> int:
        return math.ceil(math.exp(self.rng.random() * math.log(most + 1)))

    # --- lanes -------------------------------------------------------------------------------------------------------

    def _known(self) -> list[tuple[Row, list[Array]]]:
        """The known runs as they are, all as long as the longest."""
        some = self.pool[: len(self.known)]
        steps = min(DEEPEST, max((len(c) for _, columns, _ in some for c in columns), default=1))
        return [(start, [_filled(c, steps) for c in columns]) for start, columns, _ in some]

    def _round(
        self, mutants: Sequence[Mutant], courses: Sequence[tuple[Row, list[Array]]], until: float
    ) -> dict[int, tuple[Course, int]]:
        """The mutants that break the claim on one of some courses, and where."""
        if not courses:
            return {}
        count, steps = len(courses), max((len(c) for _, columns in courses for c in columns), default=self.depth)
        table = [np.stack([columns[i] for _, columns in courses], axis=1) for i in range(len(self.inputs))]
        lanes, numbers = Lanes(self.problem, mutants), np.array([m.number for m in mutants])
        of_mutant, of_course = np.repeat(np.arange(len(mutants)), count), np.tile(np.arange(count), len(mutants))
        state = self._power_up(lanes, [start for start, _ in courses])
        chosen = [of_mutant == i for i in range(len(mutants))]
        alive = np.ones(len(of_mutant), dtype=np.bool_)
        inputs = [column[0][of_course] for column in table]
        found: dict[int, tuple[Course, int]] = {}
        for k in range(steps):
            if k % 64 == 63 and time.process_time() > until:
                break
            for i, column in enumerate(table):
                if k and (column[k] != column[k - 1]).any():
                    inputs[i] = column[k][of_course]
            result = lanes.step(*state, *inputs, *chosen)
            holds, given = result[len(state)], result[len(state) + 1]
            alive &= given
            for lane in map(int, np.flatnonzero(alive & ~holds)):
                number = mutants[of_mutant[lane]].number
                if number not in found:
                    start, columns = courses[of_course[lane]]
                    rows = tuple(zip(*(c[: k + 1].tolist() for c in columns), strict=True)) or ((),) * (k + 1)
                    found[number] = Course(rows, start, ()), k
                    alive &= mutants[of_mutant[lane]].number != numbers[of_mutant]
            state = [x if x.shape == alive.shape else np.broadcast_to(x, alive.shape) for x in result[: len(state)]]
            if not alive.any():
                break
            if alive.sum() < FEW * len(alive):
                of_mutant, of_course = of_mutant[alive], of_course[alive]
                state, chosen, inputs = ([x[alive] for x in some] for some in (state, chosen, inputs))
                alive = alive[alive]
        self._keep(courses)
        return found

    def _keep(self, courses: Sequence[tuple[Row, list[Array]]]) -> None:
        """Some new courses to begin with from now on, in place of as many earlier ones."""
        self.pool[len(self.known) :] = [*self._watched(courses[:NEW], DEEPEST), *self.pool[len(self.known) :]][:LARGEST]

    @staticmethod
    def _power_up(lanes: Lanes, starts: Sequence[Row]) -> list[Array]:
        """Registers at power-up, those of a mutant on all courses side by side."""
        each = [lanes.power_up(start) for start in starts]
        return [np.stack(columns, axis=1).reshape(-1) for columns in zip(*each, strict=True)]


def _filled(column: Array, steps: int) -> Array:
    """A new column of so many steps, the last value of a shorter one kept on."""
    return np.concatenate([column[:steps], np.full(max(0, steps - len(column)), column[-1], column.dtype)])
