"""The verdict on one claim: what is tried for it, in which order, and what counts as an answer.

    induction, response time, a glance at short runs, lemmas that are found, bounded search, simulation, other engines

Cheap means come first, and what the claim expects comes before its opposite.  Nothing rests on how an answer was found:
runs are replayed on the Python reading, lemmas and invariants proved like a user's.
"""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from safety.prove import search
from safety.prove.claims import BOUNDED, PROVED, REFUTED, UNDECIDED, VACUOUS, Claim
from safety.prove.engines.engine import Result, in_integers, uses_reals
from safety.prove.induction import by_induction
from safety.prove.outcome import Limits, Outcome, who_is_silent
from safety.prove.premises import says_less, show_premises
from safety.prove.problem import Problem, Progress, build_problem
from safety.prove.refinement import build_refinement
from safety.system import ModelError
from safety.terms import Bit
from safety.trace import Trace

__all__ = ["Limits", "Outcome", "decide", "prove", "stated"]

GLANCE = 1.0  # seconds for a look at short runs, or for simulation, before lemmas are looked for
SHORTEN, LONG = 5.0, 300  # seconds to look for a shorter run than one found without a search, where that is not longer
PROGRAMS = ("spacer", "pdr")
BROKEN = (KeyError, IndexError, ValueError, ArithmeticError)  # guessing lemmas broke down: it costs no verdict
PLANS = {
    PROVED: ("induction", "response", "glance", "lemmas", "bounded_search", "simulation", "engines"),
    REFUTED: ("bounded_search", "simulation", "induction", "response", "lemmas", "engines"),
    BOUNDED: ("induction", "response", "glance", "lemmas", "bounded_search"),
    UNDECIDED: ("induction", "response", "glance", "first_simulation", "lemmas", "bounded_search", "simulation"),
    VACUOUS: ("induction", "response", "glance", "first_simulation", "lemmas", "bounded_search", "simulation"),
}


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


def decide(problem: Problem, limits: Limits | None = None, say: Progress | None = None) -> Outcome:
    """The verdict on a problem; `say` is told what is being tried.  Raises `Disagreement` when solvers differ."""
    began = time.perf_counter()
    outcome = _decide(problem, limits or Limits(), say or _quiet)
    outcome.seconds = time.perf_counter() - began
    return outcome


def _quiet(_: str) -> None:
    pass


def _decide(problem: Problem, limits: Limits, say: Progress) -> Outcome:
    outcome = Outcome(problem.claim, UNDECIDED, problem)
    attempt = _Attempt(problem, outcome, limits, say)
    plan: list[Callable[[], bool]] = [getattr(attempt, name) for name in ("scenario", *PLANS[problem.claim.expect])]
    any(means() for means in plan)
    if outcome.verdict in (PROVED, BOUNDED):
        run = show_premises(outcome.problem or problem, outcome, limits)
    if outcome.verdict in (PROVED, BOUNDED):
        outcome.because(*says_less(problem, limits, run))
    return outcome


@dataclass
class _Attempt:
    """The means by which a problem may be decided; each says whether it has decided it, and adds its reason if not."""

    problem: Problem
    outcome: Outcome
    limits: Limits
    say: Progress
    seen: search.Found | None = None

    def scenario(self) -> bool:
        """The scripted run of the claim."""
        script = self.problem.claim.scenario
        broken = search.cut_at(search.scripted(self.problem, script), "claim.holds", False) if script else None
        if broken is not None:
            self.outcome.refuted(broken, "scripted scenario, replayed")
        return broken is not None

    # --- proofs ------------------------------------------------------------------------------------------------------

    def induction(self) -> bool:
        """Induction with the claim's own lemmas."""
        self.say("induction")
        return self._induct(self.problem, "lemmas")

    def response(self) -> bool:
        """The closed form of a response time."""
        from safety.prove.response import by_response

        self.say("response time")
        found = by_response(self.problem, self.limits.timeout, self.limits.solvers)
        if found is None:
            return False
        problem = self.problem
        if not found[0].proved and not problem.lemmas and self.limits.synthesis > 0:
            from safety.prove.synthesis.synthesise import clause_lemmas

            with contextlib.suppress(*BROKEN):  # then what was found without lemmas stands
                problem = replace(problem, lemmas=clause_lemmas(problem, self.limits.synthesis))
                found = by_response(problem, self.limits.timeout, self.limits.solvers) or found
        answer, method = found
        self.outcome.questions += answer.questions
        if answer.proved:
            self.outcome.proved(method, answer.agreed_by, who_is_silent(answer))
            if problem is not self.problem:
                self.outcome.problem, self.outcome.found = problem, tuple(problem.lemmas)
        else:
            self.outcome.because(answer.failed)
        return answer.proved

    def lemmas(self) -> bool:
        """Induction with lemmas that are found; not for a claim that has its own."""
        if self.limits.synthesis <= 0 or self.problem.lemmas or not in_integers(self.problem):
            return False
        from safety.prove.synthesis.synthesise import synthesise

        try:
            found = synthesise(self.problem, self.limits.synthesis, lambda text: self.say(f"lemmas: {text}"))
        except BROKEN as error:  # the other means still have their turn
            self.outcome.because(f"lemma synthesis broke down: {type(error).__name__}: {error}")
            return False
        if found.depth is None:
            self.outcome.because(found.why)
            return False
        whole = replace(self.problem, lemmas=found.lemmas)
        read = replace(whole, claim=replace(self.problem.claim, arithmetic=found.arithmetic))
        if self._induct(read, "found lemmas"):
            self.outcome.problem, self.outcome.found = whole, tuple(found.lemmas)
        return self.outcome.verdict == PROVED

    def _induct(self, problem: Problem, kind: str) -> bool:
        integers, limits = in_integers(problem), self.limits
        answer = by_induction(problem, problem.claim.induction, integers, limits.timeout, limits.solvers)
        self.outcome.questions += answer.questions
        used = f"{len(problem.lemmas) or 'no'} {kind}"
        if answer.proved:
            form = "integers" if integers else "bits"
            method = f"induction of depth {answer.depth}, {used}, {form}"
            self.outcome.proved(method, answer.agreed_by, who_is_silent(answer))
        else:
            self.outcome.candidate = self.outcome.candidate or answer.candidate
            self.outcome.because(f"induction{'' if kind == 'lemmas' else f' with {used}'} fails: {answer.failed}")
        return answer.proved

    # --- runs --------------------------------------------------------------------------------------------------------

    def glance(self) -> bool:
        """A short bounded search, before anything that takes long."""
        self.say("short runs")
        found = self._briefly(self.problem.claim.steps, GLANCE)
        if found.run is not None:
            self.outcome.refuted(found.run, "bounded search, replayed")
        self.seen = found
        return found.run is not None

    def bounded_search(self) -> bool:
        """Bounded search in full; leaves a bounded verdict when nothing is found."""
        self.say("bounded search")
        found = self.seen
        if found is None or not found.complete:
            longer = self._bounded(self.problem.claim.steps, self.limits.timeout)
            if found is None or longer.run is not None or longer.searched > found.searched:
                found = longer
        if found.run is not None:
            self.outcome.refuted(found.run, "bounded search, replayed")
            return True
        self.outcome.because(found.why)
        if found.searched:
            self.outcome.verdict, self.outcome.steps, self.outcome.agreed_by = BOUNDED, found.searched, ["z3"]
            self.outcome.method = f"bounded search of {found.searched} steps"
        return False

    def first_simulation(self) -> bool:
        """A short directed simulation."""
        return self._simulate(min(GLANCE, self.limits.simulation))

    def simulation(self) -> bool:
        """Directed simulation, for what lies deeper than the search goes."""
        return self._simulate(self.limits.simulation)

    def _simulate(self, seconds: float) -> bool:
        if seconds <= 0:
            return False
        from safety.prove.falsify import DEEPEST, falsify

        self.say("directed simulation")
        run = falsify(self.problem, DEEPEST, seconds)
        if run is not None:
            self._broken_by(run, "directed simulation")
        return run is not None

    def _bounded(self, steps: int, timeout: float, until: float = math.inf) -> search.Found:
        return search.bounded(self.problem, ~self.problem.holds, steps, uses_reals(self.problem), timeout, until=until)

    def _briefly(self, steps: int, seconds: float) -> search.Found:
        return self._bounded(steps, min(seconds, self.limits.timeout), time.monotonic() + seconds)

    def _broken_by(self, run: Trace, method: str) -> None:
        """Take a run, or the shortest and smallest one where that is soon found."""
        shorter = self._briefly(len(run), SHORTEN).run if len(run) <= LONG else None
        if shorter is None:
            self.outcome.refuted(run, f"{method}, replayed")
        else:
            self.outcome.refuted(shorter, f"{method}, made shortest by bounded search, replayed")

    # --- other engines -----------------------------------------------------------------------------------------------

    def engines(self) -> bool:
        """Engines with strategies of their own, for what is left open."""
        if self.limits.portfolio <= 0:
            return False
        from safety.prove.engines.portfolio import portfolio

        asked = PROGRAMS[:1] if uses_reals(self.problem) else PROGRAMS
        self.say(" and ".join(asked))
        plain = replace(self.problem, lemmas={})
        try:
            results = portfolio(plain, asked, seconds=self.limits.portfolio, progress=self.say)
        except ModelError as error:  # no room to run one
            self.outcome.because(str(error))
            return False
        for answer in results:
            if answer.trace is not None:
                self._broken_by(search.again(self.problem, answer.trace), answer.engine)
            elif answer.verdict == PROVED and answer.invariant is not None:
                self._proved_with(answer.invariant, answer)
            elif answer.verdict == PROVED:
                self.outcome.because(f"{answer.engine} says that it is proved, which is not confirmed: {answer.why}")
        if self.outcome.verdict in (PROVED, REFUTED):
            return True
        self.outcome.because(f"{' and '.join(asked)} do not decide it in {self.limits.portfolio:g} s")
        return False

    def _proved_with(self, invariant: dict[str, Bit], answer: Result) -> None:
        """Take the invariant of an engine, which z3 and cvc5 have proved: it is theirs, not the engine's word."""
        solvers = [name for name in answer.agreed_by if name != answer.engine]
        self.outcome.proved(
            f"induction of depth 0, {len(invariant)} lemmas found by {answer.engine}", solvers, answer.why
        )
        self.outcome.problem, self.outcome.found = replace(self.problem, lemmas=invariant), tuple(invariant)
