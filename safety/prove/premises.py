"""Whether a claim says anything: its premises can happen, its assumptions can be kept, another model would break it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from safety.prove import search
from safety.prove.claims import BOUNDED, VACUOUS
from safety.prove.engines.engine import in_integers, uses_reals
from safety.prove.induction import Answer, by_induction
from safety.prove.outcome import Limits, Outcome, who_is_silent
from safety.prove.problem import Problem, premise_name, without_model
from safety.prove.solve import UNSAT, Solver
from safety.prove.vacuity import ends_after
from safety.system import ModelError
from safety.terms import Bit
from safety.terms.graph import describe
from safety.terms.smt import Encoder
from safety.trace import Trace

QUICK = 10.0  # seconds at most for a question whose answer is only a note


def says_less(problem: Problem, limits: Limits, known: Trace | None) -> Iterator[str]:
    """In what a claim that holds says less than it seems to; `known` is a run that keeps its assumptions."""
    timeout = min(limits.timeout, QUICK)
    if _holds_of_any_model(problem, timeout):
        yield "it holds whatever the model does: it says nothing about this one"
    last = ends_after(problem, problem.claim.steps, uses_reals(problem), timeout, known)
    if last is not None:
        yield f"no run keeps what is assumed for more than {last} steps: it says nothing of later ones"


def _holds_of_any_model(problem: Problem, timeout: float) -> bool:
    encoder = Encoder("z3", in_integers(problem))
    claimed = encoder([without_model(problem)])[0]
    solver = Solver("z3", encoder.k, timeout)
    solver.add(*encoder.ranges, encoder.k.Not(claimed))
    return solver.check() == UNSAT


def show_premises(problem: Problem, outcome: Outcome, limits: Limits) -> Trace | None:
    """Show that each premise (with the assumptions) can happen; a claim that never says anything is vacuous.

    Gives a run in which the last of them does; None where a witness shows it, or nothing does.  Raises `ModelError` for
    a witness that shows no premise.
    """
    met, run = _witnessed(problem), None
    for i, premise in enumerate(problem.premises):
        too_late = i in met and outcome.verdict == BOUNDED and met[i] >= (outcome.steps or 0)
        if too_late and _bounded(problem, premise, limits).run is None:
            _too_short(outcome, met[i])
            return None
        if i not in met:
            found = _bounded(problem, premise, limits)
            if found.run is None and (never := _never(problem, premise, limits)) is not None:
                _vacuous(outcome, premise, never)
                return None
            if found.run is None and limits.simulation > 0:
                from safety.prove.falsify import DEEPEST, reach

                found.run = reach(problem, premise, DEEPEST, limits.simulation)
            if found.run is None:
                _unmet(outcome, premise, found)
                return None
            run = found.run
            met[i] = len(run) - 1
            if outcome.verdict == BOUNDED and met[i] >= (outcome.steps or 0):
                _too_short(outcome, met[i])
                return None
    outcome.premise_at = max(met.values())
    return run


def _bounded(problem: Problem, target: Bit, limits: Limits) -> search.Found:
    return search.bounded(problem, target, problem.claim.steps, uses_reals(problem), limits.timeout)


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
    outcome.because(
        f"the search of {outcome.steps} steps ends before the premise can happen "
        f"(it was seen at step {met}), so it says nothing"
    )
    outcome.undecided()


def _vacuous(outcome: Outcome, premise: Bit, never: Answer) -> None:
    """No run says anything, for ever: this is proved, whatever became of the property."""
    if premise.is_const and premise.attr:
        what, shown = "the assumptions contradict one another: no run starts", "no run starts"
    else:
        what, shown = f"the premise{_named(premise)} can never happen", "no run meets the premise"
    outcome.verdict, outcome.agreed_by, outcome.steps, outcome.candidate = VACUOUS, never.agreed_by, None, {}
    outcome.method = f"induction of depth {never.depth}, {shown}"
    outcome.why = "; ".join(filter(None, [what, who_is_silent(never)]))


def _unmet(outcome: Outcome, premise: Bit, found: search.Found) -> None:
    """A premise that neither happens nor is impossible, as far as is known, says nothing of either kind."""
    outcome.because(
        f"the premise{_named(premise)} was not reached within {found.searched} steps; "
        "give the claim a witness (a scenario in which it happens)",
        found.why,
    )
    outcome.undecided()


def _named(premise: Bit) -> str:
    return "" if premise.is_const else f" {describe(premise)}"


def _never(problem: Problem, premise: Bit, limits: Limits) -> Answer | None:
    """The proof that a premise is impossible, by the same induction; without the lemmas where these do not hold."""
    depth = max(1, problem.claim.induction)  # that no run starts takes a step
    for lemmas in [problem.lemmas, {}] if problem.lemmas else [{}]:
        asked = replace(problem, holds=~premise, lemmas=lemmas)
        answer = by_induction(asked, depth, in_integers(problem), limits.timeout, limits.solvers)
        if answer.proved:
            return answer
    return None
