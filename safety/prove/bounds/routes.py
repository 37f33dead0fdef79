"""One question, several routes: can a formula over reals hold?  And a point where it does, exact and replayed.

The solvers (z3's nlsat, cvc5 where a second opinion is wanting) read the terms; the search of boxes reads polynomials.
No float enters a question.  A "yes" counts with a point only; a "no" names the routes that say so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property

from flint import fmpq

from safety.prove.bounds.boxes import search
from safety.prove.bounds.cases import Case, TooManyCases, cases_of, real_variables
from safety.prove.bounds.points import Point, settle
from safety.prove.bounds.replay import Witness, holds, shown
from safety.prove.solve import SAT, UNKNOWN, UNSAT, Disagreement, Solver
from safety.terms import Bit, Real
from safety.terms.direct import evaluate
from safety.terms.graph import Term
from safety.terms.smt import Encoder

NLSAT, Z3, BOXES, CVC5 = "z3 nlsat", "z3", "exact boxes", "cvc5"
CLOSE = 30  # decimals to which an irrational answer of the solver is looked at


@dataclass(frozen=True)
class Limits:
    """How much a question may cost: seconds for each route, boxes for the search."""

    seconds: float = 60.0
    boxes: int = 20_000


@dataclass
class Reply:
    """The answer to a question: `agreed_by` says no (unsat); `witness` says yes (sat); `why` explains the rest."""

    answer: str
    agreed_by: list[str] = field(default_factory=list)
    witness: Witness | None = None
    why: str = ""

    @property
    def alone(self) -> str:
        """What is to be said of a "no" of one route only; nothing where two agree."""
        return f"confirmed by one route only, {self.agreed_by[0]}; {self.why}" if len(self.agreed_by) == 1 else ""


class Question:
    """Whether a formula over reals can hold, the variables in `whole` having whole values.

    Raises `TermError` for a variable or an operation that is none of reals.
    """

    def __init__(self, formula: Bit, whole: Sequence[Real], limits: Limits) -> None:
        self.formula, self.limits = formula, limits
        self.order = real_variables([formula])
        self.numbers = [i for i, v in enumerate(self.order) if any(v is w for w in whole)]
        self.whole = [self.order[i] for i in self.numbers]

    @cached_property
    def cases(self) -> list[Case]:
        """The formula in polynomials."""
        return cases_of(self.formula, self.order)

    def ask(self) -> Reply:
        """The answer of both routes, and of cvc5 where one of them has none.

        Raises `Disagreement` when one route says yes and another no.
        """
        first = self.nlsat()
        if first.witness is not None:
            return first
        return self._settled([first, self.boxes()])

    def quickly(self) -> Reply:
        """The answer of one route: the other is asked only where the first has none."""
        first = self.nlsat()
        return first if first.agreed_by or first.witness is not None else self._settled([first, self.boxes()])

    def _settled(self, replies: list[Reply]) -> Reply:
        if sum(r.answer == UNSAT for r in replies) < 2 and not any(r.witness for r in replies):
            replies = [*replies, self.cvc5()]
        noes = [name for r in replies for name in r.agreed_by]
        yes = next((r for r in replies if r.answer == SAT), None)
        if noes and yes is not None:
            raise Disagreement(f"{', '.join(noes)}: the formula cannot hold; but {yes.why}")
        silent = "; ".join(r.why for r in replies if r.answer == UNKNOWN)
        if noes:
            return Reply(UNSAT, noes, why=silent if len(noes) < 2 else "")
        return next((r for r in replies if r.witness), Reply(UNKNOWN, why="; ".join(r.why for r in replies if r.why)))

    # --- the routes ----------------------------------------------------------------------------------------------

    def boxes(self) -> Reply:
        """The search of boxes, over the cases of the formula."""
        try:
            cases = self.cases
        except TooManyCases as error:
            return Reply(UNKNOWN, why=f"{BOXES}: {error}")
        found = search(cases, len(self.order), self.numbers, self.limits.boxes, self.limits.seconds)
        if found.point is not None:
            return self._shown(found.point, BOXES)
        if found.answer == UNSAT:
            return Reply(UNSAT, [BOXES])
        unbounded = "" if found.unbounded is None else f"{self.order[found.unbounded].attr} "
        return Reply(UNKNOWN, why=f"{BOXES}: {unbounded}{found.why}")

    def nlsat(self) -> Reply:
        """z3 over the reals; where whole values are wanted and reals do not tell, with whole values."""
        reply = self._solver("z3", NLSAT, [])
        return self._solver("z3", Z3, self.whole) if self.whole and reply.answer == UNKNOWN else reply

    def cvc5(self) -> Reply:
        """cvc5: yes or no only."""
        return self._solver("cvc5", CVC5, self.whole)

    def _solver(self, name: str, by: str, whole: list[Term]) -> Reply:
        encoder = Encoder(name, integers=True)
        solver = Solver(name, encoder.k, self.limits.seconds, real=not whole, alone=True)
        solver.add(encoder([self.formula])[0])
        for v in whole:
            solver.add(encoder.k.IsInt(encoder.variable(v.attr, v.sort)))
        answer = solver.check()
        if answer == UNSAT:
            return Reply(UNSAT, [by])
        if answer == UNKNOWN:
            return Reply(UNKNOWN, why=f"{by}: {solver.why}")
        found = self._near(encoder, solver) if name == "z3" else None
        if found is not None:
            return found
        if self.whole and not whole:
            return Reply(UNKNOWN, why=f"{by}: it can hold where the variables in whole= are any reals")
        return Reply(SAT, why=f"{by} says that it can hold, without an exact point")

    def _near(self, encoder: Encoder, solver: Solver) -> Reply | None:
        """An exact point at the model of z3, or near it where it is irrational; None where there is none."""
        model = solver.model()
        guess: list[fmpq] = []
        irrational: list[int] = []
        for i, v in enumerate(self.order):
            value = model.eval(solver.translated(encoder.variable(v.attr, v.sort)), model_completion=True)
            if encoder.k.is_algebraic_value(value):
                irrational.append(i)
                value = value.approx(CLOSE)
            x = Fraction(value.as_fraction())
            guess.append(fmpq(round(x)) if i in self.numbers else fmpq(x.numerator, x.denominator))
        if not irrational:
            point = Point(tuple((x, x) for x in guess))
            return self._shown(point, NLSAT) if self._met_at(point) else None
        try:
            points = (settle(case, guess, irrational, self.numbers) for case in self.cases)
        except TooManyCases:
            return None
        found = next((p for p in points if p is not None), None)
        return None if found is None else self._shown(found, NLSAT)

    def _met_at(self, point: Point) -> bool:
        values = zip(self.order, point.box, strict=True)
        return bool(evaluate([self.formula], {v: _fraction(low) for v, (low, _) in values})[0])

    def _shown(self, point: Point, by: str) -> Reply:
        """A point as a witness, replayed on the terms themselves."""
        witness = {v: (_fraction(low), _fraction(high)) for v, (low, high) in zip(self.order, point.box, strict=True)}
        exact = all(low == high for low, high in point.box)
        if not holds(self.formula, witness) or (exact and not self._met_at(point)):
            raise Disagreement(f"a point of {by} does not meet the formula when replayed: {shown(witness)}")
        return Reply(SAT, witness=witness, why=f"a point of {by}")


def _fraction(x: fmpq) -> Fraction:
    return Fraction(int(x.p), int(x.q))
