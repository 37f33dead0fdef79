"""The SMT readings: terms as z3 or cvc5 terms, words as integers with a range or as bit-vectors.

Integers suit relational arithmetic (counters against accumulators), bit-vectors suit control, bounded search and
everything that is later checked bit by bit.  Both solvers are driven through one Python interface, so the table has
one column for both.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from types import ModuleType
from typing import Any

from safety.terms.graph import Sort, Term, postorder
from safety.terms.table import OPERATIONS, vector_bits

SOLVERS = ("z3", "cvc5")


def solver_module(name: str) -> ModuleType:
    """The Python interface of a solver: `z3`, or cvc5 under the same names."""
    if name == "z3":
        import z3

        return z3  # type: ignore[no-any-return]
    import cvc5.pythonic

    return cvc5.pythonic  # type: ignore[no-any-return]


class Encoder:
    """Turns terms into solver terms; `ranges` collects what the sorts of new variables promise.

    A variable is made once per name; `bind` gives a term a solver term of its own (a state at a tick).
    """

    def __init__(self, solver: str, integers: bool) -> None:
        self.k = solver_module(solver)
        self.integers = integers
        self.known: dict[int, Any] = {}
        self.ranges: list[Any] = []

    def variable(self, name: str, sort: Sort) -> Any:
        """A fresh solver constant of a sort, its range noted."""
        k = self.k
        if sort.kind == "bit":
            return k.Bool(name)
        if sort.kind == "real":
            vector_bits(sort) if not self.integers else None
            return k.Real(name)
        low, high = sort.bounds
        if self.integers:
            x = k.Int(name)
            self.ranges += [x >= low, x <= high]
            return x
        x = k.BitVec(name, vector_bits(sort))
        if sort.kind == "int" and (low, high) != (-(1 << vector_bits(sort) - 1), (1 << vector_bits(sort) - 1) - 1):
            bits = vector_bits(sort)
            self.ranges += [x >= k.BitVecVal(low, bits), x <= k.BitVecVal(high, bits)]
        return x

    def bind(self, term: Term, value: Any) -> None:
        """Use `value` (a solver term) wherever `term` stands."""
        self.known[term.uid] = value

    def __call__(self, terms: Iterable[Term]) -> list[Any]:
        """Solver terms of the given terms."""
        terms = list(terms)
        column = "integer" if self.integers else "vector"
        for term in postorder(t for t in terms if t.uid not in self.known):
            if term.uid in self.known:
                continue
            if term.op == "var":
                self.known[term.uid] = self.variable(str(term.attr), term.sort)
            else:
                arguments = (self.known[a.uid] for a in term.args)
                self.known[term.uid] = getattr(OPERATIONS[term.op], column)(self.k, term, *arguments)
        return [self.known[t.uid] for t in terms]

    def step_context(self) -> Encoder:
        """An encoder with nothing bound that shares the range list (for another tick of the same problem)."""
        other = Encoder.__new__(Encoder)
        other.k, other.integers, other.known, other.ranges = self.k, self.integers, {}, self.ranges
        return other

    def value(self, model: Any, expression: Any, sort: Sort) -> Any:
        """The Python value of an expression in a solver's model."""
        x = model.eval(expression, model_completion=True) if self.k.__name__ == "z3" else model[expression]
        if sort.kind == "bit":
            return bool(x)
        if sort.kind == "real":
            text = str(x.as_fraction() if hasattr(x, "as_fraction") else x)
            return Fraction(text)
        number = int(x.as_long())
        if self.integers or sort.kind == "uint":
            return number
        bits = vector_bits(sort)
        return number - (1 << bits) if number >= 1 << bits - 1 else number
