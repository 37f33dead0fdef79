"""Falsification: directed simulation for violations that lie too deep for a bounded search.

Three means in turn: runs whose inputs stand still from the start on, tens of thousands of steps long; a swarm of runs
with all kinds of courses of inputs (`safety.prove.swarm`); and from the runs of the swarm that came nearest, the last
steps by the solver.  What is found is replayed on the Python reading; that nothing is found says nothing.
"""

from __future__ import annotations

import itertools
import math
import random
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

from safety.prove.problem import Problem
from safety.prove.search import bounded, replay
from safety.prove.solve import SAT, UNSAT, Solver, Unrolling
from safety.prove.swarm import Row, Swarm, compared, parts, wishes
from safety.system import ANY
from safety.terms import Bit, UInt
from safety.terms.graph import REAL, Term, postorder
from safety.terms.texts import compile_python
from safety.terms.values import all_of, bit
from safety.trace import Trace

DEEPEST = 100_000  # steps that a simulation goes at most
HORIZONS = (40, 400, 4000)  # of a swarm's runs; every so often all the steps that are allowed
LAST_STEPS = 3  # that the solver takes from a near miss, and as many beyond
LEGS = 6
CORNER_SECONDS = 0.5


def falsify(problem: Problem, steps: int, seconds: float, seed: int = 0) -> Trace | None:
    """A run of at most `steps` steps that breaks the claim at its last step and keeps what is given; None without.

    Looks for about `seconds`.  The run is one of the Python reading (`search.replay`).
    """
    return reach(problem, ~problem.holds, steps, seconds, seed)


def reach(problem: Problem, target: Bit, steps: int, seconds: float, seed: int = 0) -> Trace | None:
    """A run of at most `steps` steps whose last step meets `target`, e.g. a premise; None when none was found.

    Nothing is looked for where no run starts; problems with reals are left to the solver.  Raises `Disagreement` if a
    run found here is none on the Python reading.
    """
    terms = [target, problem.given, problem.start, *problem.system.roots()]
    if not problem.system.states or any(t.sort == REAL for t in postorder(terms)) or not _starts(problem):
        return None
    return _Hunt(problem, target, steps, time.perf_counter() + seconds, seed).run()


def _starts(problem: Problem) -> bool:
    """Whether any run keeps what is given at its first step; taken to be so where the solver does not know."""
    unrolling = Unrolling(problem.system, "z3", integers=False)
    asked = Solver("z3", unrolling.k, CORNER_SECONDS, finite=True)
    asked.add(*unrolling.at(0, [problem.start, problem.given]))
    asked.add_ranges(unrolling)
    return asked.check() != UNSAT


@dataclass
class _Hunt:
    problem: Problem
    target: Bit
    steps: int
    deadline: float
    seed: int

    def late(self) -> bool:
        return time.perf_counter() > self.deadline

    def run(self) -> Trace | None:
        corners = self._corners()
        found = self._standing(corners)
        for round_, horizon in enumerate(itertools.cycle((*HORIZONS * 4, self.steps))):
            if found is not None or self.late():
                return found
            found = self._swarm(corners, min(horizon, self.steps), round_)
            if not self.problem.system.inputs and not any(s.power_up is ANY for s in self.problem.system.states):
                return found  # one run is all there is
        return None

    def _replayed(self, start: Row, rows: Sequence[Row]) -> Trace:
        values: dict[tuple[str, int], Any] = {(path, 0): v for path, v in start.items()}
        values |= {(path, k): v for k, row in enumerate(rows) for path, v in row.items()}
        return replay(self.problem, values, len(rows), self.target)

    # --- inputs that stand still -------------------------------------------------------------------------------------

    def _standing(self, corners: Sequence[Row]) -> Trace | None:
        """Runs from extreme starts whose inputs stand still but for the first step; a quarter of the time at most."""
        system = self.problem.system
        read = [*(s.var for s in system.states), *system.inputs.values()]
        step = compile_python(read, [self.problem.given, self.target, *(s.next for s in system.states)])
        ready = compile_python([s.var for s in system.states], [self.problem.start])
        until = time.perf_counter() + (self.deadline - time.perf_counter()) / 4
        for start, first, then in self._choices(corners):
            state = tuple(start.get(s.path, s.power_up) for s in system.states)
            if not ready(*state)[0]:
                continue
            begun = set[Any]()
            for k in range(self.steps):
                given, hit, *following = step(*state, *(then if k else first).values())
                if not given:
                    break
                if hit:
                    return self._replayed(start, [first, *[then] * k])
                state = tuple(following)
                if k & (k - 1) == 0:  # Brent: a state that comes again comes for ever
                    begun = {state}
                elif k and state in begun:
                    break
            if time.perf_counter() > until:
                break
        return None

    def _choices(self, corners: Sequence[Row]) -> Iterator[tuple[Row, Row, Row]]:
        """Starts, inputs of the first step and of all others: extremes, corners and constants, at random."""
        system, rng = self.problem.system, random.Random(self.seed)
        constants = compared([self.target, self.problem.given, self.problem.start, *system.roots()])
        free = {s.path: s.var for s in system.states if s.power_up is ANY}

        def extremes(variables: dict[str, Term]) -> Row:
            share = rng.choice([0.0, 0.1, 0.5, 0.9, 1.0])
            return {p: _value(rng, v, constants, share) for p, v in variables.items()}

        seen = set()
        for _ in range(400):
            rows = [
                rng.choice(corners) if corners and rng.random() < 0.5 else extremes(dict(system.inputs)) for _ in "12"
            ]
            one = extremes(free), *((rows[1], rows[1]) if rng.random() < 0.5 else rows)
            key = str(one)
            if key not in seen:
                seen.add(key)
                yield one

    # --- the swarm ---------------------------------------------------------------------------------------------------

    def _swarm(self, corners: Sequence[Row], horizon: int, round_: int) -> Trace | None:
        """A swarm from power-up; where it falls short, another one from where the solver took its best lane on to."""
        start: Row = {}
        before: list[Row] = []
        here = self.problem
        for leg in range(LEGS):
            swarm = Swarm(here, self.target, corners, self.seed + 1000 * round_ + leg, whole=not before)
            hit = swarm.run(min(horizon, self.steps - len(before)), self.late)
            if hit is not None:
                first, rows = swarm.history(*hit)
                return self._replayed(start or first, [*before, *rows])
            further = None
            for near in swarm.nearest.values():
                for lane in near.lanes if near.step + 1 < swarm.steps else []:
                    if self.late():
                        return None
                    first, rows = swarm.history(near.step, lane)
                    found, taken = self._taken_on(start or first, [*before, *rows], near.distance)
                    if found is not None:
                        return found
                    if taken is not None and (further is None or len(taken) > len(further[1])):
                        further = start or first, taken
            if further is None or not len(before) < len(further[1]) < self.steps:
                return None
            start, before = further
            here = self._from(start, before)
        return None

    def _from(self, start: Row, rows: Sequence[Row]) -> Problem:
        """The problem with the registers as a run leaves them in place of power-up."""
        system = self.problem.system
        read = [*(s.var for s in system.states), *system.inputs.values()]
        step = compile_python(read, [s.next for s in system.states])
        state: tuple[Any, ...] = tuple(start.get(s.path, s.power_up) for s in system.states)
        for row in rows:
            state = step(*state, *row.values())
        here = tuple(replace(s, power_up=v) for s, v in zip(system.states, state, strict=True))
        return replace(self.problem, system=replace(system, states=here), start=bit(True))

    def _taken_on(self, start: Row, rows: list[Row], lacking: float) -> tuple[Trace | None, list[Row] | None]:
        """By the solver, from some steps before the end of a run that came near: a whole one, or one that lasts on."""
        kept = rows[: max(0, len(rows) - LAST_STEPS)]
        here = self._from(start, kept)
        if lacking <= math.log2(1 + 2 * LAST_STEPS):
            found = self._last(here, self.target, min(2 * LAST_STEPS, self.steps - len(kept)))
            if found is not None:
                return self._replayed(start, [*kept, *found]), None
        lasting = self._lasting(here, self._had(start, rows))
        return None, None if lasting is None else [*kept, *lasting]

    def _had(self, start: Row, rows: Sequence[Row]) -> list[Bit]:
        """The parts of the target that the last step of a run has."""
        end = self._from(start, rows[:-1]).system
        every = [cast(Bit, t) if wanted else ~cast(Bit, t) for t, wanted in parts(self.target, True)]
        read = compile_python([*(s.var for s in end.states), *end.inputs.values()], every)
        held = read(*(s.power_up for s in end.states), *rows[-1].values())
        return [part for part, now in zip(every, held, strict=True) if now]

    def _lasting(self, here: Problem, had: Sequence[Bit]) -> list[Row] | None:
        """Inputs by which all ages grow on, to where the target has these parts still."""
        ages = [
            cast(UInt, s.var) >= min(cast(int, s.power_up) + 2 * LAST_STEPS, s.var.sort.bounds[1])
            for s in here.system.states
            if s.path.startswith("watch.age") and s.power_up
        ]
        if not ages or not had:
            return None
        rows = self._last(here, all_of(*had, *ages), 2 * LAST_STEPS + 1)
        return rows[:-1] if rows else None

    def _last(self, here: Problem, target: Bit, steps: int) -> list[Row] | None:
        """Inputs, step by step, from some registers to a target."""
        seconds = max(0.1, min(0.5, self.deadline - time.perf_counter()))
        run = bounded(here, target, steps, False, seconds).run
        return None if run is None else [{p: run[p][k] for p in here.system.inputs} for k in range(len(run))]

    # --- corners -----------------------------------------------------------------------------------------------------

    def _corners(self) -> list[Row]:
        """Inputs that keep what is given and just do what the target waits for: each comparison in it an equality."""
        system, wanted = self.problem.system, wishes(self.problem, self.target)
        inputs = list(system.inputs.values())
        if not inputs:
            return []
        edges = [t for t in postorder([self.problem.given, *wanted]) if t.op in ("lt", "le")]
        unrolling = Unrolling(system, "z3", integers=True, anywhere=True)
        asked = Solver("z3", unrolling.k, CORNER_SECONDS)
        asked.add(*unrolling.at(0, [self.problem.given, *wanted]))
        names = unrolling.at(0, inputs)
        pairs = [(*unrolling.at(0, t.args), int(t.op == "lt")) for t in edges]
        asked.add_ranges(unrolling)
        found: list[Row] = []
        until = time.perf_counter() + CORNER_SECONDS
        for pair in [None, *pairs]:
            for var, name in zip(inputs, names, strict=True):
                for end in var.sort.bounds:
                    if time.perf_counter() > until:
                        return found
                    asked.push()
                    if pair is not None:
                        asked.add(pair[0] + pair[2] == pair[1])
                    asked.add(name == (bool(end) if var.sort.kind == "bit" else end))
                    if asked.check() == SAT:
                        model, known = asked.model(), unrolling.encoder
                        row = {
                            p: known.value(model, n, v.sort)
                            for (p, v), n in zip(system.inputs.items(), names, strict=True)
                        }
                        found += [row] if row not in found else []
                    asked.pop()
        return found


def _value(rng: random.Random, var: Term, constants: Sequence[int], share: float) -> Any:
    """The upper end with a share, else the lower one; now and then a constant, or any value."""
    low, high = var.sort.bounds
    if var.sort.kind == "bit":
        return rng.random() < share
    near = [c for c in constants if low < c < high]
    if near and rng.random() < 0.3:
        return rng.choice(near)
    return rng.randint(low, high) if rng.random() < 0.1 else high if rng.random() < share else low
