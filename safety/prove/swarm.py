"""A swarm: many runs of a problem side by side on NumPy lanes, each with a course of inputs of its own.

An input stands at a value for a while and then at another; values are the ends of the range, the constants that the
problem compares with, corners that a solver gives, and any.  A run that breaks what is given gets other inputs for the
step; where that fails, a run that keeps it is continued twice.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from safety.prove.problem import Problem
from safety.prove.search import bounded
from safety.system import ANY, State
from safety.terms import Bit
from safety.terms.graph import BIT, Term, postorder
from safety.terms.table import is_object
from safety.terms.texts import compile_lanes, lane_type
from safety.terms.values import bit

Lanes = npt.NDArray[Any]
Row = dict[str, Any]

LANES = 256
RETRIES = 6
TIES = 6
OUTERMOST = 0.5  # share of lanes that start from ends of ranges only
RESCUE_SECONDS = 2.0
STEADY = 0.4  # share of lanes whose inputs stand still as long as they keep what is given
DENSITIES = (0.02, 0.2, 0.5, 0.8, 0.98)  # how often a wire is true, one for each lane
ANY_VALUE = 0.2  # share of values drawn from the whole range


@dataclass
class Nearest:
    """Lanes at a step, and how far they are from the target."""

    distance: float
    step: int
    lanes: list[int]


class Values:
    """Draws values of one variable: its ends, the constants the problem compares with, and any."""

    def __init__(self, var: Term, constants: Sequence[int]) -> None:
        self.bit, self.kind = var.sort == BIT, lane_type(var)
        self.low, self.high = var.sort.bounds
        near = [c for c in constants if self.low < c < self.high]
        self.pool = np.array([self.low, self.high] * max(1, len(near)) + near, dtype=self.kind)

    def draw(self, rng: np.random.Generator, density: Lanes, outermost: Lanes | None = None) -> Lanes:
        """A value for each lane; an end of the range for those that are `outermost`."""
        n = len(density)
        if self.bit:
            return rng.random(n) < density
        if self.kind.hasobject:
            anything = np.array([self.low + int(x * (self.high - self.low)) for x in rng.random(n)], dtype=object)
        else:
            anything = rng.integers(self.low, self.high, n, dtype=np.int64, endpoint=True)
        drawn = np.where(rng.random(n) < ANY_VALUE, anything, self.pool[rng.integers(0, len(self.pool), n)])
        if outermost is not None:
            drawn[outermost] = rng.choice(self.pool[:2], int(outermost.sum()))
        return drawn


def compared(terms: Sequence[Term]) -> list[int]:
    """The constants in comparisons, each with its neighbours."""
    found: dict[int, None] = {}
    for t in postorder(terms):
        if t.op in ("lt", "le", "eq"):
            found |= {
                a.attr + d: None for a in t.args if a.is_const and a.sort.kind in ("uint", "int") for d in (0, -1, 1)
            }
    return list(found)


def wishes(problem: Problem, target: Bit) -> list[Bit]:
    """What must last for the target to be met: the conditions whose ages it reads."""
    following = {s.var.uid: s.next for s in problem.system.states if s.path.startswith("watch.age")}
    return [
        cast(Bit, following[t.uid].args[0])
        for t in postorder([target])
        if t.uid in following and following[t.uid].op == "select"  # else its condition is constant
    ]


Away = Callable[[Sequence[Lanes]], Lanes]


def distance(target: Bit) -> tuple[list[Term], list[Away]]:
    """How far lanes are from each part of a conjunction, 0 where it holds: terms to evaluate, and the distances."""
    atoms: list[Term] = []

    def away(t: Term, wanted: bool) -> Away:
        if t.op == "not":
            return away(t.args[0], not wanted)
        if t.op in ("and", "or", "implies"):
            first, second = away(t.args[0], wanted != (t.op == "implies")), away(t.args[1], wanted)
            if (t.op == "and") == wanted:
                return lambda v: first(v) + second(v)
            return lambda v: np.minimum(first(v), second(v))
        if t.op in ("lt", "le", "eq") and not any(is_object(a.sort) for a in t.args):
            atoms.extend(t.args)
            i = len(atoms) - 2
            return lambda v: np.log2(1.0 + _short(t.op, v[i], v[i + 1], wanted))
        atoms.append(t)
        j = len(atoms) - 1
        return lambda v: (v[j] != wanted).astype(float)

    return atoms, [away(t, wanted) for t, wanted in parts(target, True)]


def parts(t: Term, wanted: bool) -> list[tuple[Term, bool]]:
    """What has to hold at once, each with the value it has to have."""
    if t.op == "not":
        return parts(t.args[0], not wanted)
    if t.op == "implies" and not wanted:
        return [*parts(t.args[0], True), *parts(t.args[1], False)]
    if t.op == ("and" if wanted else "or"):
        return [part for a in t.args for part in parts(a, wanted)]
    return [(t, wanted)]


def _short(op: str, x: Lanes, y: Lanes, wanted: bool) -> Lanes:
    """By how much two numbers fail a comparison, or its opposite."""
    if op == "eq":
        off: Lanes = np.abs(x - y) if wanted else (x == y).astype(np.int64)
        return off
    over: Lanes = x - y + (op == "lt") if wanted else y - x + (op == "le")
    short: Lanes = np.maximum(over, 0)
    return short


def _plain(value: Any) -> Any:
    """A lane's value as Python has it."""
    return value.item() if isinstance(value, np.generic) else value


def _compact(low: int, high: int, kind: npt.DTypeLike) -> npt.DTypeLike:
    """The narrowest type that keeps the values."""
    return np.min_scalar_type(high) if kind == np.int64 and low >= 0 else kind


class Swarm:
    """Lanes of a problem, from power-up; `run` moves them on until one meets the target."""

    def __init__(self, problem: Problem, target: Bit, corners: Sequence[Row], seed: int, whole: bool = True) -> None:
        system = problem.system
        self.problem, self.rng, self.lanes = problem, np.random.default_rng(seed), LANES
        self.registers, self.inputs = list(system.states), list(system.inputs.items())
        constants = compared([target, problem.given, problem.start, *system.roots()])
        self.values = [Values(var, constants) for _, var in self.inputs]
        self.starts = {s.path: Values(s.var, constants) for s in self.registers if s.power_up is ANY}
        wanted = wishes(problem, target)
        atoms, self.distances = distance(target)
        variables = [*(s.var for s in self.registers), *(v for _, v in self.inputs)]
        self.look = compile_lanes(variables, [problem.given, target, *wanted, *atoms])
        self.step = compile_lanes(variables, [s.next for s in self.registers])
        self.ready = compile_lanes([s.var for s in self.registers], [problem.start])
        self.wanted, self.whole = len(wanted), whole
        self.corners = (
            [np.array([c[p] for c in corners], dtype=lane_type(v)) for p, v in self.inputs] if corners else []
        )
        self.compact = [_compact(v.low, v.high, v.kind) for v in self.values]
        self.course: list[list[Lanes]] = []
        self.parents: list[Lanes | None] = []
        self.steps = 0
        self.nearest: dict[int, Nearest] = {}  # by part of the target

    # --- drawing -----------------------------------------------------------------------------------------------------

    def _power_up(self) -> list[Lanes] | None:
        """Register contents that the start admits, a lane each; None when there are none."""
        for _ in range(4 * RETRIES):
            outermost = self.rng.random(self.lanes) < OUTERMOST
            state = [
                self.starts[s.path].draw(self.rng, self.density, outermost)
                if s.power_up is ANY
                else self._full(s, s.power_up)
                for s in self.registers
            ]
            good = np.flatnonzero(self.ready(*state)[0])
            if len(good):
                chosen = self.rng.choice(good, self.lanes)
                chosen[good] = good
                return [column[chosen] for column in state]
        run = bounded(self.problem, bit(True), 1, False, RESCUE_SECONDS).run
        return None if run is None else [self._full(s, run[s.path][0]) for s in self.registers]

    def _full(self, s: State, value: Any) -> Lanes:
        return np.full(self.lanes, value, dtype=lane_type(s.var))

    def _rescued(self, x: list[Lanes]) -> bool:
        """Inputs by the solver that keep what is given, for the first lane; whether there are any."""
        here = tuple(replace(s, power_up=_plain(c[0])) for s, c in zip(self.registers, self.state, strict=True))
        problem = replace(self.problem, system=replace(self.problem.system, states=here), start=bit(True))
        run = bounded(problem, bit(True), 1, False, RESCUE_SECONDS).run
        for (path, _), column in zip(self.inputs, x, strict=True):
            column[0] = run[path][0] if run else column[0]
        return run is not None

    def _fresh(self, lanes: Lanes) -> list[Lanes]:
        """New inputs for some lanes: a corner, or each input by itself."""
        drawn = [v.draw(self.rng, self.density[lanes]) for v in self.values]
        if self.corners:
            pick, corner = self.rng.integers(0, len(self.corners[0]), len(lanes)), self.rng.random(len(lanes)) < 0.5
            drawn = [np.where(corner, c[pick], d) for c, d in zip(self.corners, drawn, strict=True)]
        return drawn

    def _lengths(self, shape: tuple[int, ...], horizon: int) -> Lanes:
        """How long inputs stand: any order of magnitude up to the horizon."""
        return np.ceil(np.exp(self.rng.random(shape) * math.log(2 * horizon + 1))).astype(np.int64)

    # --- running -----------------------------------------------------------------------------------------------------

    def run(self, horizon: int, late: Callable[[], bool]) -> tuple[int, int] | None:
        """Move the lanes on for up to `horizon` steps; the step and lane that meet the target first, None without."""
        rng, everyone = self.rng, np.arange(self.lanes)
        self.density = rng.choice(DENSITIES, self.lanes)
        self.guided_from = np.zeros(self.lanes, dtype=np.int64)
        if self.whole:
            self.guided_from[: self.lanes // 3] = self._lengths((self.lanes // 3,), 16)
            self.guided_from[: self.lanes // 8] = horizon
        started = self._power_up()
        self.course, self.parents, self.nearest, self.steps = [], [], {}, horizon
        if started is None:
            return None
        self.state = self.first = started
        x, brief = self._fresh(everyone), rng.random((len(self.inputs), self.lanes)) < 0.2
        left = self._lengths(brief.shape, horizon)
        steady = rng.random(self.lanes) < STEADY
        brief[:, steady], left[:, steady] = False, horizon
        for k in range(horizon):
            if k % 64 == 63 and late():
                return None
            x = [c.copy() for c in x]  # a register may hold the very array of the step before
            for i, values in enumerate(self.values):
                due = np.flatnonzero(brief[i] | (left[i] <= k))
                if k and len(due):
                    x[i][due] = values.draw(rng, self.density[due])
                    left[i][due] = k + self._lengths((len(due),), horizon)
            seen = self._repaired(k, x)
            if seen is None:
                return None
            self.course.append([c.astype(kind) for c, kind in zip(x, self.compact, strict=True)])
            hit = seen[0] & seen[1]
            if hit.any():
                return k, int(np.flatnonzero(hit)[0])
            self._note(k, seen)
            self.state = list(self.step(*self.state, *x))
        return None

    def _look(self, state: Sequence[Lanes], x: Sequence[Lanes]) -> list[Lanes]:
        return list(self.look(*state, *x))

    def _score(self, seen: Sequence[Lanes], guided: Lanes) -> Lanes:
        """2 for keeping what is given, 1 for doing what the target waits for."""
        wish = ~guided | np.logical_and.reduce(seen[2 : 2 + self.wanted]) if self.wanted else True
        return 2 * seen[0].astype(np.int64) + wish

    def _repaired(self, k: int, x: list[Lanes]) -> list[Lanes] | None:
        """Other inputs for the lanes that need them; what is then seen.  None when no lane can go on."""
        guided = k >= self.guided_from
        seen = self._look(self.state, x)
        for _ in range(RETRIES):
            score = self._score(seen, guided)
            poor = np.flatnonzero(score < 3)
            if not len(poor) or not self.inputs:
                break
            fresh, here = self._fresh(poor), [c[poor] for c in self.state]
            better = self._score(self._look(here, fresh), guided[poor]) > score[poor]
            if better.any():
                for column, new in zip(x, fresh, strict=True):
                    column[poor[better]] = new[better]
                seen = self._look(self.state, x)
        alive = np.flatnonzero(seen[0])
        if len(alive) == self.lanes:
            self.parents.append(None)
            return seen
        if not len(alive):
            if not self._rescued(x):
                return None
            seen, alive = self._look(self.state, x), np.array([0])
        parent = np.arange(self.lanes)
        dead = np.setdiff1d(parent, alive)
        parent[dead] = self.rng.choice(alive, len(dead))
        self.parents.append(parent)
        self.state = [c[parent] for c in self.state]
        for i, column in enumerate(x):
            x[i] = column[parent]
        return [s[parent] for s in seen]

    def _note(self, k: int, seen: Sequence[Lanes]) -> None:
        """For each part of the target, the lane that has it and lacks least of the others."""
        apart = [away(seen[2 + self.wanted :]) for away in self.distances]
        whole = np.add.reduce(apart)
        for i, part in enumerate(apart):
            lacking = np.where(part == 0, whole, np.inf) if len(apart) > 1 else whole
            least = float(lacking.min())
            if least < np.inf and (i not in self.nearest or least <= self.nearest[i].distance):
                self.nearest[i] = Nearest(least, k, self._extremes(np.flatnonzero(lacking == least)))

    def _extremes(self, ties: Lanes) -> list[int]:
        """Of lanes that are equally near, those with the least and the greatest value of each register."""
        moving = [c[ties] for c in self.state if c.dtype != np.bool_ and c[ties].min() != c[ties].max()]
        ends = [int(ties[end]) for c in moving for end in (c.argmax(), c.argmin())]
        return list(dict.fromkeys([*ends, int(ties[0])]))[:TIES]

    def history(self, step: int, lane: int) -> tuple[Row, list[Row]]:
        """The power-up values that were free, and the inputs of each step, of the run that a lane was at a step."""
        rows: list[Row] = []
        for k in range(step, -1, -1):
            parent = self.parents[k]
            rows.append({p: _plain(c[lane]) for (p, _), c in zip(self.inputs, self.course[k], strict=True)})
            lane = lane if parent is None else int(parent[lane])
        free = {s.path: c[lane] for s, c in zip(self.registers, self.first, strict=True) if s.power_up is ANY}
        return {p: _plain(v) for p, v in free.items()}, rows[::-1]
