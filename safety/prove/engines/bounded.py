"""Bounded search, bit by bit: finds the shortest counterexample, proves nothing beyond the claim's bound."""

from __future__ import annotations

from safety.prove import search
from safety.prove.claims import BOUNDED, REFUTED
from safety.prove.engines.engine import Budget, Engine, Result, uses_reals, without_z3
from safety.prove.problem import Problem
from safety.prove.solve import UNKNOWN

NAME = "bounded"


def run(problem: Problem, budget: Budget) -> Result:
    """Search up to the claim's bound; each step that is done is told."""

    def done(steps: int) -> None:
        budget.tell(Result(NAME, BOUNDED, steps=steps, agreed_by=("z3",)))

    steps = problem.claim.steps
    found = search.bounded(problem, ~problem.holds, steps, uses_reals(problem), budget.left, done)
    if found.run is not None:
        return Result(NAME, REFUTED, trace=found.run, steps=len(found.run), agreed_by=("z3",))
    verdict = BOUNDED if found.searched else UNKNOWN
    return Result(NAME, verdict, steps=found.searched or None, agreed_by=("z3",), why=found.why)


ENGINE = Engine(NAME, without_z3, run)
