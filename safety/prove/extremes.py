"""Greatest and least values of a number under assumptions: looked up with one solver, for others to confirm."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

from safety.prove.problem import Problem
from safety.prove.solve import SAT, UNSAT, Solver, Unrolling
from safety.terms import Bit, Int


class NotFound(Exception):
    """What was looked for is not there, or the solver did not say; the message is the reason."""


class Extremes:
    """One z3 instance with the assumptions: formulas by step, from any register content."""

    def __init__(self, problem: Problem, assumed: Sequence[tuple[int, Sequence[Bit]]], timeout: float) -> None:
        self.unrolling = Unrolling(problem.system, "z3", integers=True, anywhere=True)
        self.solver = Solver("z3", self.unrolling.k, timeout)
        for step, formulas in assumed:
            self.solver.add(*self.unrolling.at(step, formulas))

    @property
    def possible(self) -> bool:
        """Whether the assumptions can hold at all."""
        return self._met(True) is not None

    def holds(self, condition: Bit, step: int = 0) -> bool:
        """Whether the assumptions entail a condition."""
        return self._met(self.unrolling.k.Not(self.unrolling.at(step, [condition])[0])) is None

    def greatest(self, number: Int, step: int = 0) -> int:
        """The greatest value of a number; `NotFound` where the assumptions cannot hold."""
        x = self.unrolling.at(step, [number])[0]
        high = number.sort.bounds[1]
        model = self._met(x == high)
        if model is not None:
            return high
        model = self._met(True)
        if model is None:
            raise NotFound("the assumptions contradict one another")
        low = self._value(model, x, number)
        high -= 1
        while low < high:
            middle = (low + high + 1) // 2
            model = self._met(x >= middle)
            if model is None:
                high = middle - 1
            else:
                low = self._value(model, x, number)
        return low

    def least(self, number: Int, step: int = 0) -> int:
        """The least value of a number; `NotFound` where the assumptions cannot hold."""
        return -self.greatest(0 - number, step)

    def _met(self, condition: Any) -> Any:
        """A model that satisfies the condition too, or None."""
        self.solver.add_ranges(self.unrolling)
        self.solver.push()
        self.solver.add(condition)
        answer = self.solver.check()
        model = self.solver.model() if answer == SAT else None
        self.solver.pop()
        if answer not in (SAT, UNSAT):
            raise NotFound(f"no answer: {self.solver.why}")
        return model

    def _value(self, model: Any, x: Any, number: Int) -> int:
        return cast(int, self.unrolling.encoder.value(model, x, number.sort))
