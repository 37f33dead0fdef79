"""Pruning candidates to a set that is inductive together: whatever the solver's counterexample excludes gives way.

The state before a failing step satisfies all candidates, hence every inductive subset of them; so what is violated
after it, or later in runs from there, is in no such subset.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from typing import Any

from safety.prove.problem import Problem
from safety.prove.solve import SAT, UNSAT, Solver, Unrolling
from safety.prove.synthesis.candidates import MOST_RETREATS, Candidate
from safety.terms import Bit
from safety.terms.graph import Term

QUESTION = 3.0  # seconds for one question


class OutOfTime(RuntimeError):
    """The time given to synthesis is used up."""


class Pruner:
    """One z3 instance for the step of a problem, and one for its start."""

    def __init__(self, problem: Problem) -> None:
        self.problem, self.deadline = problem, math.inf
        self.step, self.start = (Unrolling(problem.system, "z3", True, anywhere) for anywhere in (True, False))
        self.k = self.step.k

    def prune(self, candidates: Sequence[Candidate], settled: Sequence[Bit] = ()) -> list[Candidate]:
        """The candidates, bounds lowered, that together hold at power-up and are kept by every step."""
        kept = self._at_start(list(candidates))
        return self._kept_by_step(kept, settled)

    # --- power-up ------------------------------------------------------------------------------------------------

    def _at_start(self, kept: list[Candidate]) -> list[Candidate]:
        base = self.start.at(0, [self.problem.start, self.problem.given])
        while True:
            fails = self._one_fails(self.start, 0, kept)
            solver = self._solver(self.start, [*base, fails])
            if not kept or (answer := solver.check()) == UNSAT:
                return kept
            if answer != SAT:
                raise OutOfTime(f"no answer at power-up: {solver.why}")
            kept = self._give_way(self.start, 0, kept, solver.model(), base)

    # --- step ----------------------------------------------------------------------------------------------------

    def _kept_by_step(self, kept: list[Candidate], settled: Sequence[Bit]) -> list[Candidate]:
        base = self.step.at(0, [self.problem.given, *settled])
        while kept:
            assumed = base + self._hold(self.step, 0, kept)
            fails = self._one_fails(self.step, 1, kept)
            solver = self._solver(self.step, [*assumed, fails])
            answer = solver.check()
            if answer == UNSAT:
                return kept
            if answer != SAT:
                simpler = [c for c in kept if not c.product]
                if len(simpler) == len(kept):
                    raise OutOfTime(f"no answer about a step: {solver.why}")
                kept = simpler
                continue
            kept = self._give_way(self.step, 1, kept, solver.model(), assumed)
        return kept

    def _solver(self, unrolling: Unrolling, formulas: Sequence[Any]) -> Solver:
        left = self.deadline - time.monotonic()
        if left <= 0:
            raise OutOfTime("the time for synthesis is used up")
        solver = Solver("z3", self.k, min(QUESTION, left))
        solver.add(*unrolling.ranges(), *formulas)
        return solver

    def _parts(self, unrolling: Unrolling, at: int, c: Candidate) -> tuple[Any, Any]:
        guard, shown = unrolling.at(at, [c.guard, c.shown])
        return guard, shown

    def _hold(self, unrolling: Unrolling, at: int, candidates: Sequence[Candidate]) -> list[Any]:
        return [self._formula(*self._parts(unrolling, at, c), c) for c in candidates]

    def _formula(self, guard: Any, shown: Any, c: Candidate) -> Any:
        return self.k.Implies(guard, shown if c.bound is None else shown >= c.bound)

    def _one_fails(self, unrolling: Unrolling, at: int, candidates: Sequence[Candidate]) -> Any:
        fails = [self.k.Not(f) for f in self._hold(unrolling, at, candidates)]
        return self.k.Or(*fails) if len(fails) > 1 else fails[0] if fails else self.k.BoolVal(False)

    def _give_way(
        self, unrolling: Unrolling, at: int, kept: list[Candidate], model: Any, assumed: Sequence[Any]
    ) -> list[Candidate]:
        """What the model shows not to hold is dropped, or its bound lowered to the least value there is."""
        failing = [c for c in kept if not self._holds(unrolling, at, c, model)]
        bounded = [c for c in failing if c.bound is not None and c.retreats < MOST_RETREATS]
        parts = [self._parts(unrolling, at, c) for c in bounded]
        values = [self.least(unrolling, shown, [*assumed, guard]) for guard, shown in parts]
        dropped = {id(c) for c in failing} - {
            id(c) for c, value in zip(bounded, values, strict=True) if c.retreat(value)
        }
        return [c for c in kept if id(c) not in dropped]

    def _holds(self, unrolling: Unrolling, at: int, c: Candidate, model: Any) -> bool:
        value = model.eval(self._formula(*self._parts(unrolling, at, c), c), model_completion=True)
        return bool(self.k.is_true(value))

    def least(self, unrolling: Unrolling, shown: Any, assumed: Sequence[Any]) -> int | None:
        """The least value of an expression; None when there is none to be found."""
        optimum = self.k.Optimize()
        optimum.set("timeout", int(QUESTION * 1000))
        optimum.add(*unrolling.ranges(), *assumed)
        handle = optimum.minimize(shown)
        if str(optimum.check()) == SAT and self.k.is_int_value(value := optimum.lower(handle)):
            return int(value.as_long())
        return self._least_by_halving(unrolling, shown, assumed)

    def _least_by_halving(self, unrolling: Unrolling, shown: Any, assumed: Sequence[Any]) -> int | None:
        """The same by plain questions: doubling steps down to a value that is too low, then halving."""
        solver = self._solver(unrolling, assumed)
        value, step, too_low = self._below(solver, shown, None), 1, None
        while value is not None and (too_low is None or value - too_low > 1):
            middle = value - step if too_low is None else (value + too_low) // 2
            lower = self._below(solver, shown, middle)
            step *= 2
            value, too_low = (value, middle) if lower is None else (lower, too_low)
        return value

    def _below(self, solver: Solver, shown: Any, limit: int | None) -> int | None:
        """A value of an expression that is at most a limit; None when there is none."""
        solver.push()
        if limit is not None:
            solver.add(shown <= limit)
        answer = solver.check()
        value = solver.model().eval(shown, model_completion=True) if answer == SAT else None
        solver.pop()
        if answer not in (SAT, UNSAT):
            raise OutOfTime(f"no answer about a least value: {solver.why}")
        return None if value is None else int(value.as_long())

    def least_change(self, shown: Term, over: Term, settled: Sequence[Bit], after: Bit) -> int | None:
        """The least change of `shown` over the steps at which `over` holds and after which `after` does."""
        before, following = self.step.at(0, [shown])[0], self.step.at(1, [shown])[0]
        assumed = [*self.step.at(0, [self.problem.given, over, *settled]), *self.step.at(1, [after])]
        return self.least(self.step, following - before, assumed)

    def least_value(self, shown: Term, guard: Bit, settled: Sequence[Bit]) -> int | None:
        """The least value of `shown` at states that the settled lemmas and a guard admit."""
        assumed = self.step.at(0, [self.problem.given, guard, *settled])
        return self.least(self.step, self.step.at(0, [shown])[0], assumed)

    def least_at_entry(self, shown: Term, flag: Bit, settled: Sequence[Bit]) -> int | None:
        """The least value of `shown` right after a step that makes `flag` true."""
        assumed = self.step.at(0, [self.problem.given, ~flag, *settled])
        return self.least(self.step, self.step.at(1, [shown])[0], [*assumed, self.step.at(1, [flag])[0]])
