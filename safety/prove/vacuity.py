"""For how long what a claim assumes can be kept: of steps that no run reaches, a claim says nothing."""

from __future__ import annotations

from safety.prove.problem import Problem, observed
from safety.prove.solve import SAT, UNSAT, Solver, Unrolling
from safety.system import ModelError
from safety.terms.graph import variables
from safety.trace import Trace, run


def ends_after(problem: Problem, steps: int, integers: bool, timeout: float, known: Trace | None = None) -> int | None:
    """The number of steps, below `steps`, for which a run can keep the assumptions; None where no such end is found.

    Assumptions that read no changing register can be kept for ever if they can at all, and a witness keeps them as long
    as it runs.  Nothing is asked where a run that is `known` to keep them for some steps does so for all, its inputs
    left as they are at its end.  `timeout` in seconds is for a question; one that stays open finds no end.
    """
    moving = {s.var.uid for s in problem.system.states if s.next is not s.var}
    witness = problem.claim.witness
    if (witness is not None and witness.steps >= steps) or not any(v.uid in moving for v in variables([problem.given])):
        return None
    if known is not None and _goes_on(problem, known, steps):
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


def _goes_on(problem: Problem, known: Trace, steps: int) -> bool:
    def row(k: int) -> dict[str, object]:
        return {path: known[path][min(k, len(known) - 1)] for path in problem.system.inputs}

    try:
        kept = run(observed(problem), row, steps, start=known.chosen, keep=["claim.given"])
    except ModelError:
        return False
    return all(kept["claim.given"])
