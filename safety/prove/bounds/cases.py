"""A formula over reals as cases: each a list of polynomials that have to be above, at or from zero.

The polynomials are exact and in normal form (FLINT, rational coefficients), so that what cancels is gone.  Only sums,
products, `select`, comparisons and connectives have such a form; every other operation is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import product
from operator import add, mul, sub
from typing import NamedTuple

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from safety.prove.bounds.polynomials import Polynomial
from safety.terms.graph import BIT, REAL, Term, TermError, describe, variables

ABOVE, FROM, AT = "> 0", ">= 0", "== 0"
MOST_CASES = 256


_ARITHMETIC: dict[str, Callable[[Polynomial, Polynomial], Polynomial]] = {"add": add, "sub": sub, "mul": mul}


class TooManyCases(RuntimeError):
    """The formula falls into more cases than are worth going through one by one."""


class Atom(NamedTuple):
    """A polynomial and how it stands to zero: `ABOVE` (> 0), `FROM` (>= 0) or `AT` (== 0)."""

    polynomial: Polynomial
    relation: str


Case = tuple[Atom, ...]  # all of them hold
Values = list[tuple[Case, Polynomial]]


def real_variables(terms: Iterable[Term]) -> list[Term]:
    """The variables under the terms, in order of first use; `TermError` for one that is no real."""
    found = variables(terms)
    for v in found:
        if v.sort != REAL:
            raise TermError(
                f"{describe(v)} is a {v.sort}: bounds range over reals; declare it with reals(...), "
                "and name it in whole= where it takes whole values only"
            )
    return found


def cases_of(formula: Term, order: list[Term]) -> list[Case]:
    """The cases of which one holds wherever the formula does; `order` numbers the variables.

    None at all for a formula that is false whatever the variables are.
    Raises `TermError` for an operation without a polynomial form, `TooManyCases` above MOST_CASES.
    """
    return _Reader(order).bits(formula, True)


class _Reader:
    """Reads terms as polynomials; both polarities of a bit are read on demand, each once."""

    def __init__(self, order: list[Term]) -> None:
        self.context = fmpq_mpoly_ctx.get([f"x{i}" for i in range(len(order))] or ["x0"], Ordering.lex)
        self.generators = {v.uid: Polynomial(self.context.gen(i)) for i, v in enumerate(order)}
        self._numbers: dict[int, Values] = {}
        self._bits: dict[tuple[int, bool], list[Case]] = {}

    def bits(self, term: Term, wanted: bool) -> list[Case]:
        """The cases in which a bit has the wanted value."""
        key = term.uid, wanted
        if key not in self._bits:
            self._bits[key] = self._read_bit(term, wanted)
        return self._bits[key]

    def _read_bit(self, term: Term, wanted: bool) -> list[Case]:
        op, args = term.op, term.args
        if op == "const":
            return [()] if term.attr is wanted else []
        if op == "point":
            return self.bits(args[0], wanted)
        if op == "not":
            return self.bits(args[0], not wanted)
        if op in ("and", "or"):
            sides = [self.bits(a, wanted) for a in args]
            return _both(*sides) if (op == "and") is wanted else _either(*sides)
        if op == "implies":
            sides = [self.bits(args[0], not wanted), self.bits(args[1], wanted)]
            return _either(*sides) if wanted else _both(*sides)
        if op == "select":
            ways = zip((True, False), args[1:], strict=True)
            return _either(*(_both(self.bits(args[0], c), self.bits(a, wanted)) for c, a in ways))
        if op == "xor" or (op == "eq" and args[0].sort == BIT):
            same = (op == "eq") is wanted
            return _either(*(_both(self.bits(args[0], b), self.bits(args[1], b is same)) for b in (True, False)))
        if op in ("eq", "lt", "le") and args[0].sort == REAL:
            return self._comparison(op, args[0], args[1], wanted)
        raise _no_polynomial(term)

    def _comparison(self, op: str, left: Term, right: Term, wanted: bool) -> list[Case]:
        found: list[list[Case]] = []
        for (when, x), (also, y) in product(self.numbers(left), self.numbers(right)):
            less = y - x
            if op == "eq":
                atoms = [Atom(less, AT)] if wanted else [Atom(less, ABOVE), Atom(-less, ABOVE)]
            elif wanted:
                atoms = [Atom(less, ABOVE if op == "lt" else FROM)]
            else:
                atoms = [Atom(-less, FROM if op == "lt" else ABOVE)]
            found.append(_both([when], [also], _either(*(_single(a) for a in atoms))))
        return _either(*found)

    def numbers(self, term: Term) -> Values:
        """The polynomials that a real may be, each with the case in which it is."""
        if term.uid not in self._numbers:
            self._numbers[term.uid] = self._read_number(term)
        return self._numbers[term.uid]

    def _read_number(self, term: Term) -> Values:
        op, args = term.op, term.args
        if op == "var":
            return [((), self.generators[term.uid])]
        if op == "const":
            return [((), Polynomial(self.context.constant(fmpq(term.attr.numerator, term.attr.denominator))))]
        if op == "point":
            return self.numbers(args[0])
        if op == "select":
            return [
                (case, x)
                for c, branch in zip((True, False), args[1:], strict=True)
                for when, x in self.numbers(branch)
                for case in _both(self.bits(args[0], c), [when])
            ]
        if op in ("add", "sub", "mul") and term.sort == REAL:
            meaning = _ARITHMETIC[op]
            return [
                (case, meaning(x, y))
                for (when, x), (also, y) in product(self.numbers(args[0]), self.numbers(args[1]))
                for case in _both([when], [also])
            ]
        raise _no_polynomial(term)


def _no_polynomial(term: Term) -> TermError:
    return TermError(
        f"{describe(term)} ({term.op}) has no polynomial form: a bound is stated with reals, + - *, select and "
        "comparisons; write a quotient q = x / y as q * y == x, a root as y * y == x with y >= 0"
    )


def _single(atom: Atom) -> list[Case]:
    """A comparison as cases: none, or the empty one, where it says nothing about any variable."""
    value = atom.polynomial.constant
    if value is None:
        return [(atom,)]
    holds = {ABOVE: value > 0, FROM: value >= 0, AT: value == 0}[atom.relation]
    return [()] if holds else []


def _either(*sides: list[Case]) -> list[Case]:
    return _few(list(dict.fromkeys(case for side in sides for case in side)))


def _both(*sides: list[Case]) -> list[Case]:
    found: list[Case] = [()]
    for side in sides:
        joined = (tuple(dict.fromkeys(one + other)) for one, other in product(found, side))
        found = _few(list(dict.fromkeys(case for case in joined if not _contradicts(case))))
    return found


def _contradicts(case: Case) -> bool:
    """Whether an atom and its opposite both stand in the case."""
    return any(a.relation == ABOVE and Atom(-a.polynomial, FROM) in case for a in case)


def _few(cases: list[Case]) -> list[Case]:
    if len(cases) > MOST_CASES:
        raise TooManyCases(f"the formula falls into more than {MOST_CASES} cases")
    return cases
