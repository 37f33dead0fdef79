"""For how long what a claim assumes can be kept: of steps that no run reaches, a claim says nothing."""

from __future__ import annotations

from safety.prove.problem import Problem
from safety.prove.solve import SAT, UNSAT, Solver, Unrolling
from safety.terms.graph import variables


def ends_after(problem: Problem, steps: int, integers: bool, timeout: float) -> int | None:
    """The number of steps, below `steps`, for which a run can keep the assumptions; None where no such end is found.

    Assumptions that read no changing register can be kept for ever if they can at all, and a witness keeps them as long
    as it runs.  `timeout` in seconds is for a question; one that stays open finds no end.
    """
    moving = {s.var.uid for s in problem.system.states if s.next is not s.var}
    witness = problem.claim.witness
    if (witness is not None and witness.steps >= steps) or not any(v.uid in moving for v in variables([problem.given])):
        return None
    unrolling = Unrolling(problem.system, "z3", integers)

    def answer(length: int) -> str:
        asked = Solver("z3", unrolling.k, timeout, finite=not integers)
        asked.add(*unrolling.at(0, [problem.start]))
        for k in range(length):
            asked.add(*unrolling.at(k, [problem.given]))
        asked.add_ranges(unrolling)
        return asked.check()

    if answer(steps) != UNSAT:
        return None
    return next((k for k in reversed(range(steps)) if answer(k) == SAT), None)
