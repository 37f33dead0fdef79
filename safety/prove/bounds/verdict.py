"""Whether a bound holds, with who says so or the point at which it does not; and its entry in the results."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from safety.prove.bounds.replay import Witness, shown
from safety.prove.bounds.routes import Limits, Question, Reply
from safety.prove.bounds.statement import Bound, Exact, Stated
from safety.prove.claims import PROVED, REFUTED, UNDECIDED, VACUOUS
from safety.prove.solve import UNSAT
from safety.system import ModelError
from safety.terms import Bit
from safety.terms.graph import describe


@dataclass(frozen=True, eq=False)
class Finding:
    """The verdict on `quantity / per <= limit` (`<` where strict).

    Proved and vacuous name the routes in `agreed_by`; `why` then says what a single one lacked.  Refuted has an exact
    witness and the value there, as an interval of no width where all values are fractions.
    """

    bound: Bound
    limit: Fraction
    strict: bool
    verdict: str
    agreed_by: list[str] = field(default_factory=list)
    witness: Witness | None = None
    value: tuple[Fraction, Fraction] | None = None
    why: str = ""
    seconds: float = 0.0

    def to_json(self, expect: str = PROVED) -> dict[str, Any]:
        """An entry for the "claims" of the results document; certificates of this kind are "real"."""
        found = None
        if self.witness is not None and self.value is not None:
            found = one_step(self.witness) | {"value": exact(self.value[0]), "violated_at": 0}
        return {
            **entry(self.bound, self.verdict, expect, self.agreed_by, self.why, self.seconds),
            "statement": self.bound.sentence(self.limit, self.strict),
            "limit": exact(self.limit) | {"unit": self.bound.unit},
            "counterexample": found,
        }


def check(bound: Bound, limit: Exact, strict: bool = False, limits: Limits | None = None) -> Finding:
    """Whether the quantity stays at or below a limit (below it, if strict) wherever the bound's `given` hold.

    Raises `ModelError` where `per` can be zero or less, `TermError` for what is not arithmetic of reals, and
    `Disagreement` when two routes contradict each other.
    """
    began, limit, limits = time.perf_counter(), Fraction(limit), limits or Limits()
    found = ask(bound, bound.beyond(limit, reached=strict), limits)
    verdict, value, agreed, why = UNDECIDED, None, list(found.agreed_by), found.why
    if found.witness is not None:
        verdict, value, agreed, why = REFUTED, bound.at(found.witness), [], ""
    elif found.answer == UNSAT:
        verdict, agreed, why = _unless_vacuous(bound, found, limits)
    return Finding(bound, limit, strict, verdict, agreed, found.witness, value, why, time.perf_counter() - began)


def _unless_vacuous(bound: Bound, found: Reply, limits: Limits) -> tuple[str, list[str], str]:
    """Proved, if what is given can happen at all; with who agreed, and what is to be said of it."""
    possible = ask(bound, bound.situation, limits)
    if possible.witness is not None:
        return PROVED, found.agreed_by, found.alone
    if possible.answer == UNSAT:
        return VACUOUS, possible.agreed_by, "what is given cannot happen"
    return UNDECIDED, [], f"never exceeded, but what is given was not shown to be possible: {possible.why}"


def ask(bound: Bound, formula: Bit, limits: Limits, thorough: bool = True) -> Reply:
    """Whether a formula about a bound can hold: of both routes, or of the first that knows.  Raises as `check`."""
    question = Question(formula, bound.whole, limits)
    reply = question.ask() if thorough else question.quickly()
    if reply.witness is not None and bound.at(reply.witness) is None:
        raise ModelError(
            f"{bound.id}: per={describe(bound.per)} is not above zero at {shown(reply.witness)}; "
            "give what keeps it above zero, or bound the quantity without it"
        )
    return reply


def exact(x: Fraction) -> dict[str, Any]:
    """A fraction in the results: the double, and the exact value beside it."""
    return {"value": float(x), "exact": str(x)}


def one_step(witness: Witness) -> dict[str, Any]:
    """A point as a run of one step, as results show it; its values are exact, a root's is `[low, high]`."""
    values = shown(witness)
    signals = [{"path": name, "kind": "number", "values": [value]} for name, value in values.items()]
    return {"steps": 1, "tick_s": None, "replayed": True, "faults": [], "signals": signals, "values": values}


def entry(about: Stated, verdict: str, expect: str, agreed: Sequence[str], why: str, seconds: float) -> dict[str, Any]:
    """What every claim over reals has under "claims" (keys: the results document)."""
    return {
        "id": about.id,
        "model": None,
        "requirement": about.requirement or None,
        "source": about.source or None,
        "expect": expect,
        "verdict": verdict,
        "as_expected": verdict == expect,
        "strength": {"kind": verdict, "steps": None},
        "faults": None,
        "method": about.method,
        "why": why or None,
        "user_lemmas": 0,
        "agreed_by": list(agreed),
        "certificate": {"kind": "real", "routes": list(agreed)} if verdict == PROVED else None,
        "seconds": round(seconds, 3),
        "counterexample": None,
        "assumptions": about.assumptions(),
    }
