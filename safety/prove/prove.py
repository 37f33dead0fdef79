"""Prove or refute one claim: induction over its lemmas, bounded search, scenarios, reachable premises."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

from safety.prove import search
from safety.prove.claims import BOUNDED, PROVED, REFUTED, UNDECIDED, VACUOUS, Claim
from safety.prove.engines.engine import in_integers, uses_reals
from safety.prove.falsify import falsify, reach
from safety.prove.induction import Answer, by_induction
from safety.prove.problem import Problem, build_problem, premise_name, without_model
from safety.prove.refinement import build_refinement
from safety.prove.solve import UNSAT, Solver
from safety.prove.vacuity import ends_after
from safety.system import ModelError
from safety.terms import Bit
from safety.terms.graph import describe
from safety.terms.smt import Encoder
from safety.trace import Trace

DEEPEST = 100_000  # steps that directed simulation goes at most


@dataclass
class Limits:
    """Seconds for one solver question, for finding lemmas and for simulation, and which solvers are asked."""

    timeout: float = 60.0
    solvers: tuple[str, ...] = ("z3", "cvc5")
    synthesis: float = 30.0
    simulation: float = 4.0


@dataclass
class Outcome:
    """What was found out about a claim.

    `problem` has the lemmas that the proof rests on; `found` names those that the tool found itself.  `steps` is the
    length of a counterexample or the depth of a bounded verdict; `why` explains anything but success.
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
    found: tuple[str, ...] = ()

    @property
    def as_expected(self) -> bool:
        """Whether the verdict is the one that the claim states; a bounded one has to reach as far as was asked."""
        short = self.verdict == BOUNDED and (self.steps or 0) < self.claim.steps
        return self.verdict == self.claim.expect and not short


def prove(claim: Claim, limits: Limits | None = None, settings: dict[str, Any] | None = None) -> Outcome:
    """The verdict on a claim.

    Raises `ModelError` for a claim that is not well formed, `Disagreement` when solvers differ.
    """
    began = time.perf_counter()
    outcome = decide(stated(claim, settings), limits)
    outcome.seconds = time.perf_counter() - began
    return outcome


def stated(claim: Claim, settings: dict[str, Any] | None = None) -> Problem:
    """What a claim asks.  Raises `ModelError` for a claim that is not well formed."""
    return build_refinement(claim, settings) if claim.refinement is not None else build_problem(claim, settings)


def decide(problem: Problem, limits: Limits | None = None) -> Outcome:
    """The verdict on a problem.  Raises `Disagreement` when solvers differ."""
    began = time.perf_counter()
    outcome = _decide(problem, limits or Limits())
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
        if not _search(problem, outcome, limits) and not _simulate(problem, outcome, limits):
            _proof(problem, outcome, limits)
    elif not _proof(problem, outcome, limits) and not _search(problem, outcome, limits):
        _simulate(problem, outcome, limits)
    if outcome.verdict in (PROVED, BOUNDED):
        _premises(outcome.problem or problem, outcome, limits)
    if outcome.verdict == PROVED:
        outcome.why = "; ".join(filter(None, [outcome.why, *_says_less(problem, limits)]))
    return outcome


def _says_less(problem: Problem, limits: Limits) -> Iterator[str]:
    """In what a proved claim says less than it seems to."""
    if _holds_of_any_model(problem, limits):
        yield "it holds whatever the model does: it says nothing about this one"
    last = ends_after(problem, problem.claim.steps, uses_reals(problem), limits.timeout)
    if last is not None:
        yield f"no run keeps what is assumed for more than {last} steps: it says nothing of later ones"


def _holds_of_any_model(problem: Problem, limits: Limits) -> bool:
    encoder = Encoder("z3", in_integers(problem))
    claimed = encoder([without_model(problem)])[0]
    solver = Solver("z3", encoder.k, limits.timeout)
    solver.add(*encoder.ranges, encoder.k.Not(claimed))
    return solver.check() == UNSAT


def _refuted(outcome: Outcome, trace: Trace, method: str) -> Outcome:
    outcome.verdict, outcome.counterexample, outcome.method = REFUTED, trace, method
    outcome.steps, outcome.candidate, outcome.why = len(trace), {}, ""
    return outcome


def _by_induction(problem: Problem, limits: Limits) -> Answer:
    return by_induction(problem, problem.claim.induction, in_integers(problem), limits.timeout, limits.solvers)


def _bounded(problem: Problem, target: Bit, limits: Limits) -> search.Found:
    return search.bounded(problem, target, problem.claim.steps, uses_reals(problem), limits.timeout)


def _proof(problem: Problem, outcome: Outcome, limits: Limits) -> bool:
    """Induction with the claim's own lemmas, or with lemmas that are found."""
    return _induct(problem, outcome, limits) or (not problem.lemmas and _with_found_lemmas(problem, outcome, limits))


def _with_found_lemmas(problem: Problem, outcome: Outcome, limits: Limits) -> bool:
    """Find lemmas, then prove them and the property as if a user had written them: nothing rests on the finding."""
    if limits.synthesis <= 0 or not in_integers(problem):
        return False
    from safety.prove.synthesis.synthesise import synthesise

    found = synthesise(problem, limits.synthesis)
    if found.depth is None:
        outcome.why = "; ".join(filter(None, [outcome.why, found.why]))
        return False
    whole = replace(problem, lemmas=found.lemmas)
    failed, outcome.why = outcome.why, ""
    if not _induct(whole, outcome, limits):
        outcome.why = "; ".join(filter(None, [failed, f"with lemmas that were found: {outcome.why}"]))
        return False
    outcome.problem, outcome.found = whole, tuple(found.lemmas)
    outcome.method = outcome.method.replace("lemmas", "found lemmas")
    return True


def _induct(problem: Problem, outcome: Outcome, limits: Limits) -> bool:
    answer = _by_induction(problem, limits)
    outcome.questions += answer.questions
    if not answer.proved:
        outcome.candidate = answer.candidate
        outcome.why = "; ".join(filter(None, [f"induction fails: {answer.failed}", outcome.why]))
        return False
    used = f"{len(problem.lemmas)} lemmas" if problem.lemmas else "no lemmas"
    form = "integers" if in_integers(problem) else "bits"
    outcome.verdict, outcome.agreed_by, outcome.steps = PROVED, answer.agreed_by, None
    outcome.method = f"induction of depth {answer.depth}, {used}, {form}"
    outcome.why = _who_is_silent(answer)
    return True


def _who_is_silent(answer: Answer) -> str:
    """What to say of a proof that not all solvers have confirmed; nothing where two have."""
    if len(answer.agreed_by) > 1:
        return ""
    told = [f"{name} left open {what}" for name, what in answer.silent.items()]
    who = f"one solver only, {answer.agreed_by[0]}" if answer.agreed_by else "no single solver for all obligations"
    return "; ".join([f"confirmed by {who}", *told])


def _search(problem: Problem, outcome: Outcome, limits: Limits) -> bool:
    """Bounded search; leaves a bounded verdict when nothing is found."""
    found = _bounded(problem, ~problem.holds, limits)
    if found.run is not None:
        _refuted(outcome, found.run, "bounded search, replayed")
        return True
    outcome.why = "; ".join(filter(None, [outcome.why, found.why]))
    if found.searched:
        outcome.verdict, outcome.steps, outcome.agreed_by = BOUNDED, found.searched, ["z3"]
        outcome.method = f"bounded search of {found.searched} steps"
    return False


def _simulate(problem: Problem, outcome: Outcome, limits: Limits) -> bool:
    """Directed simulation, for what lies deeper than the search goes."""
    found = falsify(problem, DEEPEST, limits.simulation) if limits.simulation > 0 else None
    if found is not None:
        _refuted(outcome, found, "directed simulation, replayed")
    return found is not None


def _premises(problem: Problem, outcome: Outcome, limits: Limits) -> None:
    """Show that each premise (with the assumptions) can happen; a claim that never says anything is vacuous."""
    met = _witnessed(problem)
    for i, premise in enumerate(problem.premises):
        too_late = i in met and outcome.verdict == BOUNDED and met[i] >= (outcome.steps or 0)
        if too_late and _bounded(problem, premise, limits).run is None:
            _too_short(outcome, met[i])
            return
        if i not in met:
            found = _bounded(problem, premise, limits)
            if found.run is None and limits.simulation > 0:
                found.run = reach(problem, premise, DEEPEST, limits.simulation)
            if found.run is None:
                _unmet(problem, outcome, premise, found, limits)
                return
            met[i] = len(found.run) - 1
    outcome.premise_at = max(met.values())


def _witnessed(problem: Problem) -> dict[int, int]:
    """The premises that the claim's witness meets, with the step at which it does."""
    witness = problem.claim.witness
    if witness is None:
        return {}
    run = search.scripted(problem, witness)
    first = [search.first(run, premise_name(problem, i)) for i in range(len(problem.premises))]
    met = {i: step for i, step in enumerate(first) if step is not None}
    if not met:
        raise ModelError(
            f"{problem.claim.id}: its witness never reaches the premise in {witness.steps} steps; mend the witness"
        )
    return met


def _too_short(outcome: Outcome, met: int) -> None:
    """A search that ends before the premise can happen bounds nothing."""
    outcome.why = (
        f"{outcome.why}; the search of {outcome.steps} steps ends before the premise can happen "
        f"(it was seen at step {met}), so it says nothing"
    ).removeprefix("; ")
    outcome.verdict, outcome.steps, outcome.agreed_by, outcome.method = UNDECIDED, None, [], ""


def _unmet(problem: Problem, outcome: Outcome, premise: Bit, found: search.Found, limits: Limits) -> None:
    text = "" if premise.is_const else f" {describe(premise)}"
    outcome.agreed_by = []
    if (never := _never(problem, premise, limits)) is not None:
        outcome.verdict, outcome.agreed_by, outcome.steps = VACUOUS, never.agreed_by, None
        contradiction = premise.is_const and premise.attr
        outcome.why = (
            "the assumptions contradict one another: no run starts"
            if contradiction
            else f"the premise{text} can never happen"
        )
    else:
        outcome.verdict = UNDECIDED
        outcome.why = (
            f"the premise{text} was not reached within {found.searched} steps; "
            "give the claim a witness (a scenario in which it happens)"
        )
        outcome.why += f"; {found.why}" if found.why else ""


def _never(problem: Problem, premise: Bit, limits: Limits) -> Answer | None:
    """The proof that a premise is impossible, by the same induction; without the lemmas where these do not hold."""
    for lemmas in [problem.lemmas, {}] if problem.lemmas else [{}]:
        answer = _by_induction(replace(problem, holds=~premise, lemmas=lemmas), limits)
        if answer.proved:
            return answer
    return None
