"""Relations between symbols, for all positive values: decided by solvers, and looked at in exact points.

A quotient is carried as numerator and denominator, a root as a variable with its square; so every question is one of
polynomials.  A relation is about the points at which both sides have a meaning.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice
from typing import TYPE_CHECKING, NamedTuple, cast

from safety.audit.exceptions import AuditError
from safety.audit.formula import Reading, Relation
from safety.audit.spans import NUMBERS, Span
from safety.terms import Bit, Real, real
from safety.terms.graph import REAL, variable
from safety.terms.values import all_of

if TYPE_CHECKING:
    from safety.prove.bounds.routes import Reply

SECONDS = 20.0  # for each route
POINTS, TRIES = 8, 2000


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

    def holds(self, each: Relation) -> Bit:
        """The relation as a formula; that its sides have a meaning goes to what is given."""
        for name in sorted(set().union(*(side.names for side in each.sides)) - self.variables.keys()):
            v = cast(Real, variable(name, REAL))
            self.variables[name] = Ratio(v, real(1))
            if name not in self.signed:
                self.given.append(v > 0)
        sides = [side.over(self.reading, self.variables) for side in each.sides]
        self.given += [~(side.bottom == 0) for side in sides]
        return all_of(*(_compared(a, sign, b) for a, sign, b in zip(sides, each.signs, sides[1:], strict=False)))


def _compared(a: Ratio, sign: str, b: Ratio) -> Bit:
    if sign == "=":
        return a.top * b.bottom == b.top * a.bottom
    difference = a - b
    product = difference.top * difference.bottom  # has the sign of the quotient
    return {"<=": product <= 0, ">=": product >= 0, "<": product < 0, ">": product > 0}[sign]


def decide(each: Relation, when: Sequence[Relation] = (), signed: frozenset[str] = frozenset()) -> Answer:
    """Whether a relation holds for all positive values of its symbols (any value of those `signed`) that meet `when`.

    Raises Disagreement when exact points, or two solvers, contradict one another.
    """
    from safety.prove.bounds.routes import Limits
    from safety.prove.bounds.routes import Question as Asked
    from safety.prove.solve import UNSAT, Disagreement

    tried = list(points(each, when, signed))
    if not any(meaningful(each, at) for at in tried):
        raise AuditError(f"no point was found at which {each} has a meaning, and all that it is said to hold for")
    point = next((at for at in tried if true_at(each, at) is False), None)
    if point is not None:
        return Answer(False, ("exact evaluation",), point)
    question = Question(signed)
    conditions = [question.holds(condition) for condition in when]
    wrong = ~question.holds(each)
    reply: Reply = Asked(all_of(*question.given, *conditions, wrong), (), Limits(SECONDS, 200)).ask()
    if reply.answer == UNSAT:
        exactly = sum(true_at(each, at) is True for at in tried)
        return Answer(True, (*reply.agreed_by, *([f"{exactly} exact points"] if exactly else [])))
    if reply.witness is None:
        return Answer(None, why=reply.why)
    found = {str(v.attr): (low + high) / 2 for v, (low, high) in reply.witness.items()}
    at = {name: found[name] for name in question.variables if name in found}
    if all(low == high for low, high in reply.witness.values()) and true_at(each, at) is not False:
        raise Disagreement(f"a solver says that {each} fails at {at}, but there it holds")
    return Answer(False, ("z3 nlsat",), at)


def points(each: Relation, when: Sequence[Relation], signed: frozenset[str]) -> Iterator[Mapping[str, Fraction]]:
    """A few points, always the same, with small fractions as values, at which all of `when` holds."""
    names = sorted(set().union(*(side.names for relation in (each, *when) for side in relation.sides)))
    drawn = (_point(names, signed, n) for n in range(TRIES))
    yield from islice((at for at in drawn if all(true_at(condition, at) for condition in when)), POINTS)


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
