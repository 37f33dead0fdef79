"""Laws: sentences about real numbers alone, which hold for all of them; no model, no bounds.

    @law(expect=PROVED, requirement="SP-P1", source="[D] constant deceleration")
    def stop_fits(v: Real, t: Real, b: Real, x: Real) -> Bit:
        \"\"\"Who is below the ceiling stops before the point.\"\"\"
        return implies((v >= 0) & (b > 0) & (t >= 0) & permits(v, x, b, t), 2 * b * v * t + v * v <= 2 * b * x)

The parameters of the function are the variables.  There is no root and no quotient: a root r of y is a variable with
`r * r == y` and `r >= 0`, a quotient is multiplied out.  A law is proved where z3's nlsat and cvc5 agree that nothing
contradicts it (or one of them and a search of boxes, where all variables are bounded), and refuted at an exact point.
Its premises, those of `implies`, are shown to be possible; else it is vacuous.
"""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar, cast

from safety.prove.bounds.claims import RealClaim, register
from safety.prove.bounds.statement import Stated, reals
from safety.prove.claims import PROVED, REFUTED, UNDECIDED, VACUOUS, claim_id, premises_of
from safety.system import ModelError
from safety.terms import Bit
from safety.terms.graph import variables

Sentence = TypeVar("Sentence", bound=Callable[..., Bit])


@dataclass(frozen=True, eq=False)
class Law(Stated):
    """A sentence in words and as a formula over reals."""

    id: str
    statement: str
    formula: Bit
    requirement: str = ""
    source: str = ""
    assumed: tuple[str, ...] = ()
    method = "law over all reals"


@dataclass(frozen=True, eq=False, kw_only=True)
class LawClaim(RealClaim):
    """A law that is claimed."""

    law: Law

    @property
    def statement(self) -> str:
        """The sentence in words."""
        return self.law.statement

    @property
    def about(self) -> Stated:
        """The law."""
        return self.law

    def violation(self) -> Bit:
        """Where it does not hold."""
        return _against(self.law.formula)

    def found(self, seconds: float) -> dict[str, Any]:
        """The verdict, with who agreed or the point that contradicts.

        Raises `TermError` for what is not arithmetic of reals, `Disagreement` when two routes contradict each other.
        """
        from safety.prove.bounds.routes import Limits, Question
        from safety.prove.bounds.verdict import entry, one_step

        began, limits = time.perf_counter(), Limits(seconds)
        reply = Question(self.violation(), (), limits).ask()
        verdict, agreed, why = UNDECIDED, list(reply.agreed_by), reply.why
        if reply.witness is not None:
            verdict, agreed, why = REFUTED, [], ""
        elif agreed:
            verdict, why = PROVED, reply.alone
            for premise in premises_of(self.law.formula):
                possible = Question(premise, (), limits).ask() if variables([premise]) else None
                if possible is not None and possible.witness is None:
                    never = bool(possible.agreed_by)
                    verdict, agreed = (VACUOUS if never else UNDECIDED), possible.agreed_by
                    why = "its premise cannot happen" if never else f"premise not shown to be possible: {possible.why}"
        told = entry(self.law, verdict, self.expect, agreed, why, time.perf_counter() - began)
        witness = reply.witness and one_step(reply.witness) | {"violated_at": 0}
        return told | {"statement": self.statement, "counterexample": witness}


def _against(formula: Bit) -> Bit:
    """The negation, with the equalities of a premise as they stand: at such a point a root is known in a range only."""
    if formula.op != "implies":
        return ~formula
    premise, conclusion = (cast(Bit, side) for side in formula.args)
    return premise & _against(conclusion)


def law(
    *,
    expect: str,
    requirement: str = "",
    source: str = "",
    assumed: Sequence[str] = (),
    id: str = "",
    twin_of: Callable[..., Bit] | None = None,
    defeat: bool = False,
) -> Callable[[Sentence], Sentence]:
    """Claim the sentence that the decorated function states, for all real values of its parameters.

    Raises `ModelError` for a sentence without words, variables or a Bit, and for a verdict that no law can have.
    """

    def declare(sentence: Sentence) -> Sentence:
        name = id or claim_id(sentence)
        possible = (PROVED, REFUTED, VACUOUS, UNDECIDED)
        if expect not in possible:
            raise ModelError(f"{name}: expect={expect!r}; of a law it is one of {', '.join(possible)}")
        said = " ".join((sentence.__doc__ or "").split())
        if not said:
            raise ModelError(f"{name} says nothing: give it a docstring in plain words")
        formula = sentence(*reals(" ".join(inspect.signature(sentence).parameters)))
        if not isinstance(formula, Bit):
            raise ModelError(f"{name} gives {formula!r}; a law is a Bit, such as implies(x > 0, x * x > 0)")
        if not variables([formula]):
            raise ModelError(f"{name} reads no variable: it is true or false whatever happens")
        register(
            LawClaim(
                id=name, expect=expect, role="defeat" if defeat else "twin" if twin_of else "claim",
                twin_of=claim_id(twin_of) if twin_of else None, module=sentence.__module__,
                file=sentence.__code__.co_filename, line=sentence.__code__.co_firstlineno,
                namespace=sentence.__globals__, law=Law(name, said, formula, requirement, source, tuple(assumed)),
            )
        )  # fmt: skip
        return sentence

    return declare
