"""Sampled steps and runs of a problem's system, many at once: what lemmas are guessed from, never what they rest on.

Rows are NumPy lanes: one array a register (bool, int64, or objects beyond that), one entry a sample.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from safety.prove.problem import Problem
from safety.prove.solve import SAT, Solver, Unrolling
from safety.system import ANY
from safety.terms import Bit
from safety.terms.graph import Term, postorder, variables
from safety.terms.texts import compile_lanes, lane_type

if TYPE_CHECKING:
    import numpy.typing as npt

    Lanes = npt.NDArray[Any]

Rows = dict[int, Any]  # lanes by uid of the variable

HELD = 0.9  # share of the inputs that stay from one step to the next
COPIES = 64  # lanes that begin at the one power-up state that a solver gave
START_QUESTION = 5.0  # seconds
TRIES = 24  # draws of inputs for a lane, until the assumptions admit one


def conjuncts(condition: Term) -> list[Term]:
    """The parts of a conjunction."""
    if condition.op == "and":
        return [part for a in condition.args for part in conjuncts(a)]
    if condition.op == "point":
        return conjuncts(condition.args[0])
    return [condition]


def plain(term: Term) -> Term:
    """The term under casts and points, whose value is the same."""
    while term.op in ("cast", "point"):
        term = term.args[0]
    return term


def constants_of(roots: Iterable[Term]) -> dict[int, set[int]]:
    """For each variable the constants that it is compared with."""
    found: dict[int, set[int]] = {}
    for term in postorder(roots):
        if term.op in ("eq", "lt", "le"):
            x, y = (plain(a) for a in term.args)
            for v, c in ((x, y), (y, x)):
                if v.op == "var" and c.is_const and not isinstance(c.attr, bool) and isinstance(c.attr, int):
                    found.setdefault(v.uid, set()).add(c.attr)
    return found


class Draws:
    """Draws values of variables: uniform, at the ends, near constants that matter; with what `condition` says of
    single variables and of equal ones built in.
    """

    def __init__(self, leaves: Sequence[Term], roots: Sequence[Term], condition: Sequence[Bit], seed: int) -> None:
        import numpy as np

        self.random = np.random.default_rng(seed)
        self.leaves = list(leaves)
        self.constants = constants_of(roots)
        self.range = {v.uid: list(v.sort.bounds) for v in leaves if v.sort.kind in ("uint", "int")}
        self.same: dict[int, int] = {}
        self.fixed: dict[int, bool] = {}
        for part in (p for c in condition for p in conjuncts(c)):
            self._learn(part)

    def _learn(self, part: Term) -> None:
        inner = part.args[0] if part.op == "not" else part
        if inner.op == "var" and inner.sort.kind == "bit":
            self.fixed[inner.uid] = part is inner
        if part.op not in ("eq", "lt", "le"):
            return
        x, y = (plain(a) for a in part.args)
        if part.op == "eq" and x.uid in self.range and y.uid in self.range:
            self.same[x.uid] = y.uid
        strict = part.op == "lt"
        if x.uid in self.range and y.is_const:
            self.range[x.uid][1] = min(self.range[x.uid][1], int(y.attr) - strict)
            if part.op == "eq":
                self.range[x.uid][0] = max(self.range[x.uid][0], int(y.attr))
        if y.uid in self.range and x.is_const:
            self.range[y.uid][0] = max(self.range[y.uid][0], int(x.attr) + strict)
            if part.op == "eq":
                self.range[y.uid][1] = min(self.range[y.uid][1], int(x.attr))

    def __call__(self, n: int, share: float = 0.4) -> Rows:
        """One value a lane for each variable; a share of them at the ends of the range or near a constant."""
        rows = {v.uid: self._one(v, n, share) for v in self.leaves}
        for x, y in self.same.items():
            if x in rows and y in rows:
                rows[x] = rows[y].astype(rows[x].dtype)
        return rows

    def _one(self, v: Term, n: int, share: float) -> Lanes:
        import numpy as np

        if v.sort.kind == "bit":
            if v.uid in self.fixed:
                return np.full(n, self.fixed[v.uid])
            wires: Lanes = self.random.random(n) < self.random.choice([0.03, 0.5, 0.97])
            return wires
        if v.sort.kind == "real":
            quarters = self.random.integers(-200, 201, n)
            return np.array([Fraction(int(k), 4) for k in quarters], dtype=object)
        low, high = self.range[v.uid]
        if low > high:
            low, high = v.sort.bounds
        near = [c for k in self.constants.get(v.uid, ()) for c in (k - 1, k, k + 1)] + [low, low + 1, high - 1, high]
        pool = np.array(sorted({c for c in near if low <= c <= high}), dtype=object)
        uniform = np.array(self._uniform(low, high, n), dtype=object)
        chosen = pool[self.random.integers(0, len(pool), n)]
        drawn: Lanes = np.where(self.random.random(n) < share, chosen, uniform).astype(lane_type(v))
        return drawn

    def _uniform(self, low: int, high: int, n: int) -> Any:
        if high - low < 2**62:
            return self.random.integers(low, high + 1, n)
        return [low + int(x * (high - low)) for x in self.random.random(n)]


@dataclass
class Steps:
    """Steps that the assumptions admit: registers before, inputs and whole-number points, registers after."""

    before: Rows
    inputs: Rows
    after: Rows

    def __len__(self) -> int:
        return len(next(iter(self.before.values()), []))


class Sampler:
    """Draws steps from arbitrary states and runs from power-up, within the assumptions of a problem."""

    def __init__(self, problem: Problem, seed: int = 1) -> None:
        system = problem.system
        self.problem, self.states = problem, list(system.states)
        self.registers = [s.var for s in self.states]
        self.inputs = list(system.inputs.values())
        roots = [problem.holds, problem.given, problem.start, *(s.next for s in self.states)]
        self.draw_inputs = Draws(self.inputs, roots, [problem.given], seed)
        self.draw_states = Draws(self.registers, roots, [problem.given], seed + 1)
        self.draw_starts = Draws(self.registers, roots, [problem.given, problem.start], seed + 2)
        leaves = [*self.registers, *self.inputs]
        self.points = [p for p in system.points.values() if p.sort.kind in ("uint", "int")]
        self._step = compile_lanes(leaves, [problem.given, *(s.next for s in self.states)])
        self._points = compile_lanes(leaves, self.points)
        self._start = compile_lanes(leaves, [problem.start]) if leaves else None

    def _advance(self, state: Rows, inputs: Rows) -> tuple[Lanes, Rows]:
        given, *after = self._step(*(state[v.uid] for v in self.registers), *(inputs[v.uid] for v in self.inputs))
        return given, {v.uid: a for v, a in zip(self.registers, after, strict=True)}

    def steps(self, n: int, rounds: int = 40, share: float = 0.4, until: float = math.inf) -> Steps:
        """At least `n` admitted steps from arbitrary register contents, or as many as some rounds of draws give.

        No further round begins once the monotonic clock shows `until`.
        """
        kept: list[Steps] = []
        count = 0
        for _ in range(rounds):
            state, inputs = self.draw_states(2048, share), self.draw_inputs(2048)
            for x, y in self.draw_states.same.items():  # a register said to equal an input, or the other way round
                if x in state and y in inputs:
                    state[x] = inputs[y].astype(state[x].dtype)
                elif x in inputs and y in state:
                    inputs[x] = state[y].astype(inputs[x].dtype)
            given, after = self._advance(state, inputs)
            state, inputs, after = _where(state, given), _where(inputs, given), _where(after, given)
            leaves = (state[v.uid] for v in self.registers), (inputs[v.uid] for v in self.inputs)
            points = self._points(*leaves[0], *leaves[1])
            inputs |= {p.uid: values for p, values in zip(self.points, points, strict=True)}
            kept.append(Steps(state, inputs, after))
            count += int(given.sum())
            if count >= n or time.monotonic() > until:
                break
        return _joined(kept)

    def starts(self, n: int) -> Rows:
        """Power-up states within what the problem says of them; maybe none."""
        import numpy as np

        state = self.draw_starts(n)
        for s in self.states:
            if s.power_up is not ANY:
                state[s.var.uid] = np.full(n, s.power_up, dtype=lane_type(s.var))
        if self._start is None:
            return state
        inputs = self.draw_inputs(n)
        (admitted,) = self._start(*(state[v.uid] for v in self.registers), *(inputs[v.uid] for v in self.inputs))
        return _where(state, admitted) if admitted.any() else self._solved_start()

    def _solved_start(self) -> Rows:
        """One power-up state from the solver, where drawing finds none; no rows when it finds none either."""
        import numpy as np

        unrolling = Unrolling(self.problem.system, "z3", True)
        solver = Solver("z3", unrolling.k, START_QUESTION)
        solver.add(*unrolling.at(0, [self.problem.start, self.problem.given]))
        values = unrolling.at(0, self.registers)
        solver.add_ranges(unrolling)
        if solver.check() != SAT:
            return {v.uid: np.zeros(0, dtype=lane_type(v)) for v in self.registers}
        model, read = solver.model(), unrolling.encoder.value
        return {
            v.uid: np.full(COPIES, read(model, x, v.sort), dtype=lane_type(v))
            for v, x in zip(self.registers, values, strict=True)
        }

    def run(self, state: Rows, ticks: int, every: int = 1, until: float = math.inf) -> list[Rows]:
        """States met from given ones on, in which a step is admitted; the inputs are drawn anew now and then.

        A lane ends where no draw is admitted.
        """
        import numpy as np

        met: list[Rows] = []
        n = len(next(iter(state.values()), []))
        held: Rows | None = None
        for k in range(ticks):
            if n == 0 or time.monotonic() > until:
                break
            fresh = self.draw_inputs(n)
            if held is not None:
                keep = self.draw_inputs.random.random(n) < HELD
                fresh = {u: np.where(keep, held[u], fresh[u]) for u in fresh}
            given, after = self._advance(state, fresh)
            for _ in range(TRIES):
                if given.all():
                    break
                again = self.draw_inputs(n)
                fresh = {u: np.where(given, fresh[u], again[u]) for u in fresh}
                given, after = self._advance(state, fresh)
            if k % every == 0:
                met.append(_where(state, given))
            state, held = _where(after, given), _where(fresh, given)
            n = int(given.sum())
        return met


def _where(rows: Rows, condition: Lanes) -> Rows:
    return {uid: a[condition] for uid, a in rows.items()}


def joined(parts: Sequence[Rows]) -> Rows:
    """Rows of several samples in one."""
    import numpy as np

    return {uid: np.concatenate([p[uid] for p in parts]) for uid in parts[0]} if parts else {}


def _joined(parts: Sequence[Steps]) -> Steps:
    return Steps(*(joined([getattr(p, name) for p in parts]) for name in ("before", "inputs", "after")))


def evaluate(terms: Sequence[Term], rows: Rows) -> list[Lanes]:
    """The terms on rows that hold all their variables."""
    leaves = variables(terms)
    if not terms:
        return []
    if not leaves:  # constants only
        import numpy as np

        n = len(next(iter(rows.values()), []))
        return [np.full(n, value) for value in compile_lanes([], terms)()]
    return list(compile_lanes(leaves, terms)(*(rows[v.uid] for v in leaves)))
