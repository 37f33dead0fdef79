"""Relations between symbols, for all positive values: decided by solvers, and looked at in exact points.

A quotient is carried as numerator and denominator, a root as a variable with its square; so every question is one of
polynomials.  A relation must have a meaning, and hold, wherever its conditions and the theory have one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice
from typing import TYPE_CHECKING, NamedTuple, cast

from safety.audit.exceptions import AuditError
from safety.audit.formula import Formula, Reading, Relation
from safety.audit.spans import NUMBERS, Span
from safety.terms import Bit, Real, real
from safety.terms.graph import REAL, variable
from safety.terms.values import all_of

if TYPE_CHECKING:
    from safety.prove.bounds.routes import Reply

SECONDS = 20.0  # for each route
POINTS, TRIES = 8, 2000
EXACTLY, NO_MEANING = "exact evaluation", "it has no meaning there"
ZERO, BELOW = "0", "below 0"


class Answer(NamedTuple):
    """Whether a relation holds always (None: not decided), who says so, and a point at which it does not hold."""

    holds: bool | None
    agreed_by: tuple[str, ...] = ()
    point: Mapping[str, Fraction] | None = None
    why: str = ""


@dataclass(frozen=True)
class Ratio:
    """A quotient of polynomials."""

    top: Real
    bottom: Real

    def __add__(self, other: Ratio) -> Ratio:
        return Ratio(self.top * other.bottom + other.top * self.bottom, self.bottom * other.bottom)

    def __sub__(self, other: Ratio) -> Ratio:
        return self + -other

    def __mul__(self, other: Ratio) -> Ratio:
        return Ratio(self.top * other.top, self.bottom * other.bottom)

    def __truediv__(self, other: Ratio) -> Ratio:
        return Ratio(self.top * other.bottom, self.bottom * other.top)

    def __neg__(self) -> Ratio:
        return Ratio(-self.top, self.bottom)


class Question:
    """Relations over variables; `roots` are those met so far, with what holds of them."""

    def __init__(self, signed: frozenset[str]) -> None:
        self.signed = signed
        self.variables: dict[str, Ratio] = {}
        self.given: list[Bit] = []
        self.reading = Reading(lambda number: Ratio(real(number), real(1)), self._root)

    def _root(self, under: Ratio) -> Ratio:
        y = cast(Real, variable(f"root {len(self.given)}", REAL))
        self.given.append((y >= 0) & (y * y * under.bottom == under.top) & ~(under.bottom == 0))
        return Ratio(y, real(1))

    def over(self, each: Formula) -> Ratio:
        """The formula over the variables; that it has a meaning goes to what is given."""
        for name in sorted(each.names - self.variables.keys()):
            v = cast(Real, variable(name, REAL))
            self.variables[name] = Ratio(v, real(1))
            if name not in self.signed:
                self.given.append(v > 0)
        found: Ratio = each.over(self.reading, self.variables)
        self.given.append(~(found.bottom == 0))
        return found

    def missing(self, need: Need) -> Bit:
        """That a need is not met."""
        part = self.over(need.of)
        return part.top == 0 if need.bad == ZERO else part.top * part.bottom < 0

    def holds(self, each: Relation) -> Bit:
        """The relation as a formula."""
        sides = [self.over(side) for side in each.sides]
        return all_of(*(_compared(a, sign, b) for a, sign, b in zip(sides, each.signs, sides[1:], strict=False)))


def _compared(a: Ratio, sign: str, b: Ratio) -> Bit:
    if sign == "=":
        return a.top * b.bottom == b.top * a.bottom
    difference = a - b
    product = difference.top * difference.bottom  # has the sign of the quotient
    return {"<=": product <= 0, ">=": product >= 0, "<": product < 0, ">": product > 0}[sign]


def decide(
    each: Relation, when: Sequence[Relation] = (), signed: frozenset[str] = frozenset(), theory: Iterable[Formula] = ()
) -> Answer:
    """Whether a relation holds for all positive values of its symbols (any value of those `signed`) that meet `when`.

    `theory`: formulas without whose meaning nothing is said; wherever they have one, the relation has to have one.
    Raises AuditError when no point is found to be spoken of, Disagreement when exact points, or two solvers,
    contradict one another.
    """
    from safety.prove.solve import UNSAT, Disagreement

    about = tuple(theory)
    tried = list(points(each, when, signed, about))
    if not tried:
        raise AuditError(f"no point was found at which all holds that {each} is said to hold for")
    for one in tried:
        if not meaningful(each, one):
            return Answer(False, (EXACTLY,), one, NO_MEANING)
    point = next((at for at in tried if true_at(each, at) is False), None)
    if point is not None:
        return Answer(False, (EXACTLY,), point)
    granted = list(about)
    for need in needs(each, signed):
        question = Question(signed)
        reply = _asked(question, [*granted, need.of], when, question.missing(need))
        if reply.answer != UNSAT:
            at = _point_of(question, reply)[0]
            return Answer(None, why=reply.why) if at is None else Answer(False, ("z3 nlsat",), at, NO_MEANING)
    question = Question(signed)
    reply = _asked(question, about, when, ~question.holds(each))
    if reply.answer == UNSAT:
        exactly = sum(true_at(each, at) is True for at in tried)
        return Answer(True, (*reply.agreed_by, *([f"{exactly} exact points"] if exactly else [])))
    at, exact = _point_of(question, reply)
    if at is None:
        return Answer(None, why=reply.why)
    if exact and true_at(each, at) is not False:
        raise Disagreement(f"a solver says that {each} fails at {at}, but there it holds")
    return Answer(False, ("z3 nlsat",), at)


def _asked(question: Question, theory: Iterable[Formula], when: Sequence[Relation], wrong: Bit) -> Reply:
    """Whether what is wrong can be, where the theory has a meaning and the conditions hold."""
    from safety.prove.bounds.routes import Limits
    from safety.prove.bounds.routes import Question as Asked

    for each in theory:
        question.over(each)
    conditions = [question.holds(condition) for condition in when]
    return Asked(all_of(*question.given, *conditions, wrong), (), Limits(SECONDS, 200)).ask()


def _point_of(question: Question, reply: Reply) -> tuple[Mapping[str, Fraction] | None, bool]:
    """The point that a solver gives, and whether it is one and not an enclosure."""
    if reply.witness is None:
        return None, False
    found = {str(v.attr): (low + high) / 2 for v, (low, high) in reply.witness.items()}
    exact = all(low == high for low, high in reply.witness.values())
    return {name: found[name] for name in question.variables if name in found}, exact


class Need(NamedTuple):
    """A part of a formula that must not be `bad`, 0 or below 0, for the whole to have a meaning."""

    of: Formula
    bad: str


def needs(each: Relation, signed: frozenset[str]) -> Iterator[Need]:
    """Divisors and what roots are taken of, inner ones first, but for those that are above 0 by their form."""
    for side in each.sides:
        for op, part in _under(side):
            if not _above_zero(part, signed):
                yield Need(part, BELOW if op == "sqrt" else ZERO)


def _under(each: Formula) -> Iterator[tuple[str, Formula]]:
    for part in each.parts:
        yield from _under(part)
    if each.op in ("/", "sqrt") or (each.op == "^" and each.number < 0):
        yield each.op, each.parts[1] if each.op == "/" else each.parts[0]


def _above_zero(each: Formula, signed: frozenset[str]) -> bool:
    if each.op == "name":
        return each.name not in signed
    if each.op == "number":
        return each.number > 0
    return each.op in ("+", "*", "/", "^", "sqrt") and all(_above_zero(part, signed) for part in each.parts)


def points(
    each: Relation, when: Sequence[Relation], signed: frozenset[str], theory: Sequence[Formula] = ()
) -> Iterator[Mapping[str, Fraction]]:
    """A few points, always the same, with small fractions as values, at which all of `when` holds."""
    about = (*each.sides, *(side for one in when for side in one.sides), *theory)
    names = sorted(set().union(*(side.names for side in about)))
    drawn = (_point(names, signed, n) for n in range(TRIES))
    spoken_of = Relation(tuple(theory), ())
    fit = (at for at in drawn if all(true_at(one, at) for one in when) and meaningful(spoken_of, at))
    yield from islice(fit, POINTS)


def _point(names: Sequence[str], signed: frozenset[str], n: int) -> dict[str, Fraction]:
    """The n-th point: the first has 1 everywhere, where relations that exclude equality fail."""
    at, state = {}, 2 * n + 1
    for name in names if n else ():
        state = (state * 1103515245 + 12345) % 2**31
        value = Fraction(1 + state // 2**16 % 24, (1, 3, 8, 64)[state // 2**24 % 4])
        at[name] = -value if name in signed and state % 3 == 0 else value
    return at or dict.fromkeys(names, Fraction(1))


def meaningful(each: Relation, at: Mapping[str, Fraction]) -> bool:
    """Whether no side divides by 0 or takes the root of a negative at a point."""
    try:
        _sides(each, at)
    except ArithmeticError:
        return False
    return True


def true_at(each: Relation, at: Mapping[str, Fraction]) -> bool | None:
    """Whether a relation holds at a point; None where a side has no meaning, or roots leave it open."""
    try:
        sides = _sides(each, at)
    except ArithmeticError:
        return None
    told = [_true(a - b, sign) for a, sign, b in zip(sides, each.signs, sides[1:], strict=False)]
    return False if False in told else None if None in told else True


def _sides(each: Relation, at: Mapping[str, Fraction]) -> list[Span]:
    values = {name: Span(at[name]) for side in each.sides for name in side.names}
    return [side.over(NUMBERS, values) for side in each.sides]


def _true(difference: Span, sign: str) -> bool | None:
    below, above, zero = difference.high < 0, difference.low > 0, difference.low == 0 == difference.high
    if zero:
        return sign in ("=", "<=", ">=")
    if below or above:
        return (below and sign in ("<", "<=")) or (above and sign in (">", ">="))
    return None
