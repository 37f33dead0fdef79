"""What an engine is: its interface, its result, and what it may use up."""

from __future__ import annotations

import importlib
import importlib.util
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from safety.prove.claims import BITS, BOUNDED, PROVED, REFUTED
from safety.prove.induction import by_induction, lemma_obligations
from safety.prove.problem import Problem
from safety.prove.search import replay
from safety.prove.solve import UNKNOWN
from safety.system import ModelError, nearest
from safety.terms import Bit
from safety.terms.graph import REAL, postorder
from safety.terms.values import all_of
from safety.trace import Trace

BOTH = ("z3", "cvc5")
NAMES = {  # those that prove most come first
    "spacer": "Spacer, property-directed reachability over integers (z3)",
    "pdr": "pdr, property-directed reachability over bits (ABC)",
    "bounded": "bounded search, bit by bit",
    "induction": "k-induction over the problem's lemmas",
    "smtbmc": "temporal induction over bits (yosys-smtbmc)",
}


@dataclass
class Result:
    """What an engine found out: `proved`, `refuted`, `bounded` (no violation in the first `steps` steps) or `unknown`.

    `trace` is a counterexample, replayed.  `invariant` is an inductive invariant, by name, that with the assumptions
    implies the property; `agreed_by` names everyone who has confirmed the proof, the engine itself last.
    """

    engine: str
    verdict: str = UNKNOWN
    invariant: dict[str, Bit] | None = None
    trace: Trace | None = None
    steps: int | None = None
    agreed_by: tuple[str, ...] = ()
    why: str = ""
    seconds: float = 0.0

    @property
    def conclusive(self) -> bool:
        """Whether it ends the question: nothing that another engine says can add to it."""
        return self.verdict in (PROVED, REFUTED)

    def contradicts(self, other: Result) -> bool:
        """Whether the two cannot both be right."""
        if self.verdict != REFUTED or self.trace is None:
            return other.verdict == REFUTED and other.contradicts(self)
        return other.verdict == PROVED or (other.verdict == BOUNDED and len(self.trace) <= (other.steps or 0))


def _silent(_: Result) -> None:
    pass


@dataclass
class Budget:
    """What an engine may use: seconds of wall clock from now on, and a folder that its caller empties.

    `tell` takes results on the way (a bounded search that got so far): what is told survives the engine's end.
    """

    seconds: float
    scratch: Path
    tell: Callable[[Result], None] = _silent
    began: float = field(default_factory=time.monotonic)

    @property
    def left(self) -> float:
        """Seconds that remain; never less than a tenth, so that it can be given to a solver as a limit."""
        return max(self.seconds - (time.monotonic() - self.began), 0.1)


@dataclass(frozen=True)
class Engine:
    """A name, why it cannot run here (None when it can), and the function that runs it.

    Both functions stand in a module, not in another function: they are called in another process.  Of the problem's
    lemmas only `induction` makes use, after proving them; for the others see `with_lemmas_given`.
    """

    name: str
    unavailable: Callable[[], str | None]
    run: Callable[[Problem, Budget], Result]


def engine(name: str) -> Engine:
    """The engine of a name; `ModelError` for another name."""
    if name not in NAMES:
        raise ModelError(f"there is no engine {name!r}; {nearest(name, NAMES)}")
    module = importlib.import_module(f"safety.prove.engines.{name}")
    found: Engine = module.ENGINE
    return found


def without_z3() -> str | None:
    """What to say where z3 is not installed; it is not loaded to find out."""
    return None if importlib.util.find_spec("z3") else "z3 is not installed: python3 -m pip install z3-solver"


def uses_reals(problem: Problem) -> bool:
    """Whether the problem has reals, which no reading in bits can take."""
    formulas = [problem.holds, problem.given, problem.start, *problem.premises, *problem.lemmas.values()]
    return any(t.sort == REAL for t in postorder([*formulas, *problem.system.roots()]))


def in_integers(problem: Problem) -> bool:
    """Whether its questions are put to solvers in integers rather than in bit-vectors."""
    return problem.claim.arithmetic != BITS or uses_reals(problem)


def with_lemmas_given(problem: Problem, timeout: float) -> Problem | None:
    """The problem with its lemmas, proved here, as assumptions of every step; None when they are not proved.

    An invariant found for it is one of the problem itself together with the lemmas.
    """
    if not lemma_obligations(problem, in_integers(problem), timeout, BOTH).proved:
        return None
    return replace(problem, given=all_of(problem.given, *problem.lemmas.values()), lemmas={})


def proved_by(
    name: str, problem: Problem, invariants: Sequence[dict[str, Bit]], integers: bool, budget: Budget, why: str = ""
) -> Result:
    """The result of an engine that says `proved`: the first of the invariants it gave that both solvers confirm.

    Where none is confirmed (`why`: none was given), the engine stands alone, and the result says so.
    """

    def alone(why: str) -> Result:
        return Result(name, PROVED, agreed_by=(name,), why=f"rests on {name} alone: {why}")

    budget.tell(alone("time was up before its invariant was confirmed"))
    for invariant in invariants:
        claimed = replace(problem, lemmas={f"invariant of {name}": all_of(*invariant.values())})
        answer = by_induction(claimed, 0, integers, budget.left, BOTH)
        if answer.proved:
            silent = "; ".join(f"{solver} left open {what}" for solver, what in answer.silent.items())
            return Result(name, PROVED, invariant, agreed_by=(*answer.agreed_by, name), why=silent)
        why = f"its invariant was not confirmed: {answer.failed}"
    return alone(why)


def refuted_by(name: str, problem: Problem, values: dict[tuple[str, int], Any], steps: int) -> Result:
    """The result of an engine that gave values of inputs by step, and of open registers at step 0, for a violation.

    Raises `Disagreement` when the run with these values does not end in one.
    """
    run = replay(problem, values, steps, ~problem.holds)
    return Result(name, REFUTED, trace=run, steps=steps, agreed_by=(name,))
