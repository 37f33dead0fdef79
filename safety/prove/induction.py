"""Unbounded proof by induction over lemmas, each obligation put to two solver families.

With lemmas L (invariants of the registers), assumptions A and property P:

    start:     power-up registers, A        =>  every lemma
    step:      every lemma, A, one step     =>  each lemma of the next registers
    property:  every lemma, A, P for k steps  =>  P at the next;  and P at the first k steps from power-up

All obligations unsatisfiable in their negation: P holds for ever.  A satisfiable one gives a *candidate* state, which
need not be reachable and is never shown as a counterexample.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from safety.prove.problem import Problem
from safety.prove.solve import SAT, UNKNOWN, UNSAT, Disagreement, Solver, Unrolling
from safety.system import ModelError
from safety.terms import Bit, TermError
from safety.terms.graph import REAL

SECOND_OPINION = 5.0  # seconds for a further solver once one has refuted the obligation


@dataclass(frozen=True)
class Obligation:
    """One question: what holds at which step, and what must then hold; `anywhere`: from any register content."""

    label: str
    anywhere: bool
    assumed: tuple[tuple[int, tuple[Bit, ...]], ...]
    step: int
    shown: Bit


@dataclass(frozen=True)
class Reply:
    """A solver's answer to the negation of an obligation: `unsat` discharges it."""

    result: str
    candidate: dict[str, Any] = field(default_factory=dict)
    why: str = ""


@dataclass
class Answer:
    """Outcome of an induction: which solvers agree on all obligations, or the obligation that failed."""

    proved: bool
    agreed_by: list[str] = field(default_factory=list)
    failed: str = ""
    candidate: dict[str, Any] = field(default_factory=dict)
    depth: int = 0
    questions: int = 0
    silent: dict[str, str] = field(default_factory=dict)  # solver: what it left open, and why

    def after(self, first: Answer) -> Answer:
        """Both outcomes as one: a solver agrees only when it agrees on all obligations of both."""
        agreed = [name for name in first.agreed_by if name in self.agreed_by]
        return Answer(
            first.proved and self.proved, agreed, first.failed or self.failed, first.candidate or self.candidate,
            self.depth, first.questions + self.questions, self.silent | first.silent,
        )  # fmt: skip


def by_induction(
    problem: Problem, depth: int, integers: bool, timeout: float, solvers: tuple[str, ...], until: float = math.inf
) -> Answer:
    """Try induction of depth 0 (lemmas alone), 1, ... `depth`; every obligation goes to every solver.

    No further depth is tried once the monotonic clock shows `until`.
    """
    lemmas = lemma_obligations(problem, integers, timeout, solvers)
    if not lemmas.proved:
        return lemmas
    asked = 0
    for k in range(depth + 1):
        answer = discharge(problem, property_obligations(problem, k), integers, timeout, solvers)
        asked += answer.questions
        answer.depth, answer.questions = k, asked
        if answer.proved or time.monotonic() > until:
            break
    return answer.after(lemmas)


def lemma_obligations(problem: Problem, integers: bool, timeout: float, solvers: tuple[str, ...]) -> Answer:
    """Start and step of every lemma, without the property."""
    return discharge(problem, invariance(problem), integers, timeout, solvers)


def invariance(problem: Problem) -> list[Obligation]:
    """That every lemma holds at power-up, and that a step keeps each."""
    every = (*problem.lemmas.values(), problem.given)
    first = (problem.start, problem.given)
    lemmas = problem.lemmas.items()
    start = [Obligation(f"lemma '{name}' at power-up", False, ((0, first),), 0, lemma) for name, lemma in lemmas]
    return start + [
        Obligation(f"lemma '{name}' is kept by a step", True, ((0, every),), 1, lemma) for name, lemma in lemmas
    ]


def property_obligations(problem: Problem, depth: int) -> list[Obligation]:
    """That the property follows from the lemmas and `depth` steps of itself, and holds at the first `depth` steps."""
    held = tuple((k, (problem.given, problem.holds)) for k in range(depth))
    lemmas = (0, tuple(problem.lemmas.values()))
    follows = Obligation("the property follows", True, (lemmas, *held, (depth, (problem.given,))), depth, problem.holds)
    first = [
        Obligation(
            f"the property at step {k}", False,
            ((0, (problem.start,)), *((j, (problem.given,)) for j in range(k + 1))), k, problem.holds,
        )
        for k in range(depth)
    ]  # fmt: skip
    return [follows, *first]


def discharge(
    problem: Problem, obligations: Sequence[Obligation], integers: bool, timeout: float, solvers: tuple[str, ...]
) -> Answer:
    """Put each obligation to each solver, up to the first that none of them discharges."""
    answer = Answer(proved=True, agreed_by=list(solvers))
    for one in obligations:
        replies: dict[str, Reply] = {}
        results: dict[str, str] = {}
        for name in solvers:
            patience = min(timeout, SECOND_OPINION) if SAT in results.values() else timeout
            replies[name] = ask(problem, one, name, integers, patience)
            results[name] = replies[name].result
        answer.questions += len(replies)
        if SAT in results.values() and UNSAT in results.values():
            said = ", ".join(f"{name} says {result}" for name, result in results.items())
            raise Disagreement(f"{problem.claim.id}: {one.label}: {said}")
        for name, reply in replies.items():
            if reply.result == UNKNOWN:
                answer.silent.setdefault(name, f"{one.label} ({reply.why})")
        answer.agreed_by = [name for name in answer.agreed_by if results[name] == UNSAT]
        if UNSAT not in results.values():
            found = next((reply.candidate for reply in replies.values() if reply.candidate), {})
            return Answer(False, [], one.label, found, 0, answer.questions, answer.silent)
    return answer


def ask(problem: Problem, one: Obligation, solver: str, integers: bool, timeout: float) -> Reply:
    """Ask one solver for a counterexample to an obligation; a solver that is missing or breaks down says `unknown`."""
    try:
        unrolling = Unrolling(problem.system, solver, integers, one.anywhere)
        formulas = [f for step, held in one.assumed for f in unrolling.at(step, held)]
        formulas.append(unrolling.k.Not(unrolling.at(one.step, [one.shown])[0]))
        asked = Solver(solver, unrolling.k, timeout, finite=not integers, real=unrolling.encoder.reals_only)
        asked.add(*formulas)
        asked.add_ranges(unrolling)
        result = asked.check()
        told = result == SAT and not asked.apart
        return Reply(result, _candidate(problem, asked, unrolling) if told else {}, asked.why)
    except (TermError, ModelError):
        raise
    except Exception as error:
        return Reply(UNKNOWN, {}, f"{type(error).__name__}: {error}")


def _candidate(problem: Problem, solver: Solver, unrolling: Unrolling) -> dict[str, Any]:
    """The registers (those that matter) of a state that an obligation allows; perhaps not reachable."""
    model, context = solver.model(), unrolling.contexts[0]
    values: dict[str, Any] = {}
    for s in problem.system.states:
        if s.var.uid in context.known:
            try:
                values[s.path] = context.value(model, context.known[s.var.uid], s.var.sort)
            except TermError:
                if s.var.sort != REAL:
                    raise
                values[s.path] = "irrational"
    return values
