"""Induction of growing depth over the problem's lemmas, each obligation put to z3 and cvc5."""

from __future__ import annotations

import time

from safety.prove.claims import PROVED
from safety.prove.engines.engine import BOTH, Budget, Engine, Result, in_integers, without_z3
from safety.prove.induction import by_induction
from safety.prove.problem import Problem

NAME = "induction"
DEEPEST = 20
SHARES = 4  # of the time; a question has one, and after two no deeper one is begun


def run(problem: Problem, budget: Budget) -> Result:
    """Try depth 0, 1, ... up to 20, or to the claim's own depth where that is more."""
    depth = max(DEEPEST, problem.claim.induction)
    share = budget.left / SHARES
    answer = by_induction(problem, depth, in_integers(problem), share, BOTH, time.monotonic() + share * (SHARES - 2))
    if not answer.proved:
        return Result(NAME, why=f"induction of depth {answer.depth} fails: {answer.failed}")
    invariant = dict(problem.lemmas) if answer.depth == 0 else None
    silent = "; ".join(f"{name} left open {what}" for name, what in answer.silent.items())
    return Result(NAME, PROVED, invariant, agreed_by=tuple(answer.agreed_by), why=silent, steps=answer.depth)


ENGINE = Engine(NAME, without_z3, run)
