"""Unbounded proof by induction over lemmas, each obligation put to two solver families.

With lemmas L (invariants of the registers), assumptions A and property P:

    start:     power-up registers, A        =>  every lemma
    step:      every lemma, A, one step     =>  each lemma of the next registers
    property:  every lemma, A, P for k steps  =>  P at the next;  and P at the first k steps from power-up

All obligations unsatisfiable in their negation: P holds for ever.  A satisfiable one gives a *candidate* state, which
need not be reachable and is never shown as a counterexample.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from safety.prove.problem import Problem
from safety.prove.solve import SAT, UNSAT, Disagreement, Solver, Unrolling
from safety.terms import Bit


@dataclass
class Answer:
    """Outcome of an induction: which solvers agree on all obligations, or the obligation that failed."""

    proved: bool
    agreed_by: list[str] = field(default_factory=list)
    failed: str = ""
    candidate: dict[str, Any] = field(default_factory=dict)
    depth: int = 0
    questions: int = 0


def by_induction(problem: Problem, depth: int, integers: bool, timeout: float, solvers: tuple[str, ...]) -> Answer:
    """Try induction of depth 0 (lemmas alone), 1, ... `depth`; every obligation goes to every solver."""
    answer = lemma_obligations(problem, integers, timeout, solvers)
    if answer.failed:
        return answer
    questions = answer.questions
    for k in range(depth + 1):
        answer = _obligations(problem, lambda s, k=k: _property(problem, s, k, integers, timeout), solvers)  # type: ignore[misc]
        questions += answer.questions
        if not answer.failed:
            break
    answer.depth, answer.questions = k, questions
    return answer


def lemma_obligations(problem: Problem, integers: bool, timeout: float, solvers: tuple[str, ...]) -> Answer:
    """Start and step of every lemma, without the property."""
    return _obligations(problem, lambda s: _lemmas(problem, s, integers, timeout), solvers)


Question = tuple[str, Solver, Unrolling]


def _obligations(problem: Problem, questions: Callable[[str], Iterator[Question]], solvers: tuple[str, ...]) -> Answer:
    """Ask each solver; the first decides, each further one must not contradict."""
    verdicts: dict[str, dict[str, str]] = {}
    answer = Answer(proved=True)
    for name in solvers:
        for label, solver, unrolling in questions(name):
            result = solver.check()
            verdicts.setdefault(label, {})[name] = result
            answer.questions += 1
            if result == SAT and not answer.candidate:
                answer.candidate = _candidate(problem, solver, unrolling)
            if result != UNSAT and name == solvers[0] and len(solvers) == 1:
                break
    for label, by in verdicts.items():
        if SAT in by.values() and UNSAT in by.values():
            raise Disagreement(f"{problem.claim.id}: {label}: {', '.join(f'{n} says {r}' for n, r in by.items())}")
        if UNSAT not in by.values():
            answer.failed = answer.failed or label
            answer.proved = False
    answer.agreed_by = [n for n in solvers if all(by.get(n) == UNSAT for by in verdicts.values())]
    return answer


def _context(problem: Problem, solver: str, integers: bool, timeout: float, anywhere: bool) -> tuple[Solver, Unrolling]:
    unrolling = Unrolling(problem.system, solver, integers, anywhere)
    return Solver(solver, unrolling.k, timeout), unrolling


def _assert(solver: Solver, unrolling: Unrolling, step: int, *formulas: Bit, negated: Bit | None = None) -> None:
    solver.add(*unrolling.at(step, formulas))
    if negated is not None:
        solver.add(unrolling.k.Not(unrolling.at(step, [negated])[0]))
    solver.add_ranges(unrolling)


def _lemmas(problem: Problem, name: str, integers: bool, timeout: float) -> Iterator[Question]:
    for label, lemma in problem.lemmas.items():
        solver, unrolling = _context(problem, name, integers, timeout, anywhere=False)
        _assert(solver, unrolling, 0, problem.start, problem.given, negated=lemma)
        yield f"lemma '{label}' at power-up", solver, unrolling
    for label, lemma in problem.lemmas.items():
        solver, unrolling = _context(problem, name, integers, timeout, anywhere=True)
        _assert(solver, unrolling, 0, *problem.lemmas.values(), problem.given)
        _assert(solver, unrolling, 1, negated=lemma)
        yield f"lemma '{label}' is kept by a step", solver, unrolling


def _property(problem: Problem, name: str, depth: int, integers: bool, timeout: float) -> Iterator[Question]:
    solver, unrolling = _context(problem, name, integers, timeout, anywhere=True)
    _assert(solver, unrolling, 0, *problem.lemmas.values())
    for k in range(depth):
        _assert(solver, unrolling, k, problem.given, problem.holds)
    _assert(solver, unrolling, depth, problem.given, negated=problem.holds)
    yield "the property follows", solver, unrolling
    for k in range(depth):
        solver, unrolling = _context(problem, name, integers, timeout, anywhere=False)
        _assert(solver, unrolling, 0, problem.start)
        for j in range(k + 1):
            _assert(solver, unrolling, j, problem.given)
        _assert(solver, unrolling, k, negated=problem.holds)
        yield f"the property at step {k}", solver, unrolling


def _candidate(problem: Problem, solver: Solver, unrolling: Unrolling) -> dict[str, Any]:
    """The registers (those that matter) of a state that an obligation allows; perhaps not reachable."""
    model, context = solver.model(), unrolling.contexts[0]
    shown = [s for s in problem.system.states if s.var.uid in context.known]
    return {s.path: context.value(model, context.known[s.var.uid], s.var.sort) for s in shown}
