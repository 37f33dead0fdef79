"""Prove or refute one claim: induction over its lemmas, bounded search, scenarios, and the reachability of its premise."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import Any

from safety.prove import search
from safety.prove.claims import BOUNDED, INTEGERS, PROVED, REFUTED, UNDECIDED, VACUOUS, Claim
from safety.prove.induction import Answer, by_induction
from safety.prove.problem import Problem, build_problem
from safety.prove.refinement import build_refinement
from safety.system import ModelError
from safety.terms.graph import postorder
from safety.trace import Trace


@dataclass
class Limits:
    """Seconds for one solver question, and which solvers are asked."""

    timeout: float = 60.0
    solvers: tuple[str, ...] = ("z3", "cvc5")


@dataclass
class Outcome:
    """What was found out about a claim.

    `steps` is the length of a counterexample or the depth of a bounded verdict; `why` explains anything but success.
    """

    claim: Claim
    verdict: str
    problem: Problem | None = None
    method: str = ""
    steps: int | None = None
    agreed_by: list[str] = field(default_factory=list)
    counterexample: Trace | None = None
    premise_at: int | None = None
    candidate: dict[str, Any] = field(default_factory=dict)
    why: str = ""
    seconds: float = 0.0
    questions: int = 0

    @property
    def as_expected(self) -> bool:
        """Whether the verdict is the one that the claim states."""
        return self.verdict == self.claim.expect


def prove(claim: Claim, limits: Limits | None = None, settings: dict[str, Any] | None = None) -> Outcome:
    """The verdict on a claim.  Raises `ModelError` for a claim that is not well formed, `Disagreement` when solvers differ."""
    limits = limits or Limits()
    began = time.perf_counter()
    problem = build_refinement(claim) if claim.refinement is not None else build_problem(claim, settings)
    outcome = _decide(problem, limits)
    outcome.seconds = time.perf_counter() - began
    return outcome


def _decide(problem: Problem, limits: Limits) -> Outcome:
    claim = problem.claim
    outcome = Outcome(claim, UNDECIDED, problem)
    if claim.scenario is not None:
        broken = search.cut_at(search.scripted(problem, claim.scenario), "claim.holds", False)
        if broken is not None:
            return _refuted(outcome, broken, "scripted scenario, replayed")
    if claim.expect == REFUTED:  # the search is the quicker way to what is expected
        if not _search(problem, outcome, limits):
            _induct(problem, outcome, limits)
    elif not _induct(problem, outcome, limits):
        _search(problem, outcome, limits)
    if outcome.verdict in (PROVED, BOUNDED):
        _premise(problem, outcome, limits)
    return outcome


def _refuted(outcome: Outcome, trace: Trace, method: str) -> Outcome:
    outcome.verdict, outcome.counterexample, outcome.method = REFUTED, trace, method
    outcome.steps = len(trace)
    outcome.why = ""
    return outcome


def _uses_reals(problem: Problem) -> bool:
    return any(t.sort.kind == "real" for t in postorder([problem.holds, *problem.system.roots()]))


def _integers(problem: Problem) -> bool:
    return problem.claim.arithmetic == INTEGERS or _uses_reals(problem)


def _induct(problem: Problem, outcome: Outcome, limits: Limits) -> bool:
    answer: Answer = by_induction(problem, problem.claim.induction, _integers(problem), limits.timeout, limits.solvers)
    outcome.questions += answer.questions
    if not answer.proved:
        outcome.candidate, outcome.why = answer.candidate, f"induction fails: {answer.failed}"
        return False
    used = f"{len(problem.lemmas)} lemmas" if problem.lemmas else "no lemmas"
    form = "integers" if _integers(problem) else "bits"
    outcome.verdict, outcome.agreed_by = PROVED, answer.agreed_by
    outcome.method = f"induction of depth {answer.depth}, {used}, {form}"
    outcome.why = ""
    return True


def _search(problem: Problem, outcome: Outcome, limits: Limits) -> bool:
    """Bounded search; leaves a bounded verdict when nothing is found."""
    bad = ~problem.holds
    found = search.bounded(problem, bad, problem.claim.steps, _uses_reals(problem), limits.timeout)
    if found.run is not None:
        _refuted(outcome, found.run, "bounded search, replayed")
        return True
    if found.searched == 0:
        outcome.why = outcome.why or "the solver gave no answer for a single step"
        return False
    outcome.verdict, outcome.steps = BOUNDED, found.searched
    outcome.method = f"bounded search of {found.searched} steps"
    return False


def _premise(problem: Problem, outcome: Outcome, limits: Limits) -> None:
    """Show that the premise (with the assumptions) can happen; a claim that never says anything is vacuous."""
    witness = problem.claim.witness
    if witness is not None:
        run = search.cut_at(search.scripted(problem, witness), "claim.premise", True)
        if run is None:
            raise ModelError(f"{problem.claim.id}: its witness never reaches the premise in {witness.steps} steps; mend the witness")
        outcome.premise_at = len(run) - 1
        return
    found = search.bounded(problem, problem.premise, problem.claim.steps, _uses_reals(problem), limits.timeout)
    if found.run is not None:
        outcome.premise_at = len(found.run) - 1
        return
    if _never(problem, limits):
        outcome.verdict, outcome.why = VACUOUS, "the premise can never happen"
    else:
        outcome.verdict = UNDECIDED
        outcome.why = f"the premise was not reached within {found.searched} steps; give the claim a witness (a scenario in which it happens)"


def _never(problem: Problem, limits: Limits) -> bool:
    """Whether the premise is impossible: proved by the same induction, or nothing can start at all."""
    never = replace(problem, holds=~problem.premise)
    return by_induction(never, problem.claim.induction, _integers(problem), limits.timeout, limits.solvers).proved
