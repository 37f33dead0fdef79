"""The SMT readings: terms as z3 or cvc5 terms, words as integers with a range or as bit-vectors.

Integers suit relational arithmetic (counters against accumulators), bit-vectors suit control, bounded search and
everything that is later checked bit by bit.  Both solvers are driven through one Python interface, so the table has
one column for both.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable
from fractions import Fraction
from types import ModuleType
from typing import Any

from safety.terms.graph import REAL, Sort, Term, TermError, describe, postorder
from safety.terms.table import OPERATIONS, vector_bits

SOLVERS = {"z3": ("z3", "z3-solver"), "cvc5": ("cvc5.pythonic", "cvc5")}  # module, distribution


class SolverMissingError(ImportError):
    """A solver cannot be loaded; what needs it stays undecided."""

    exit_code = 3


def solver_module(name: str) -> ModuleType:
    """The Python interface of a solver: `z3`, or cvc5 under the same names.

    Raises `TermError` for another name, `SolverMissingError` when it is not installed or cannot be loaded.
    """
    if name not in SOLVERS:
        raise TermError(f"{name!r} is not a solver with a reading of terms; write one of {', '.join(SOLVERS)}")
    module, distribution = SOLVERS[name]
    try:
        return importlib.import_module(module)
    except Exception as error:  # also a library of the wrong kind, or one that lacks another
        raise SolverMissingError(
            f"the solver {name} cannot be loaded ({error}); `python3 -m pip install {distribution}` installs it"
        ) from error


class Encoder:
    """Turns terms into solver terms; `ranges` collects what the sorts of new variables promise.

    A variable is made once per name; `bind` gives a term a solver term of its own (a state at a tick).  With
    `integers` words are integers, otherwise bit-vectors; the bit-vector reading refuses reals with a `TermError`.
    """

    def __init__(self, solver: str, integers: bool) -> None:
        self.k: Any = solver_module(solver)
        self.integers = integers
        self.known: dict[int, Any] = {}
        self.ranges: list[Any] = []
        self._made: dict[str, tuple[Sort, Any]] = {}

    def variable(self, name: str, sort: Sort) -> Any:
        """The solver constant of a name, its range noted; `TermError` when the name has another sort already."""
        if name not in self._made:
            self._made[name] = sort, self._constant(name, sort)
        before, constant = self._made[name]
        if before != sort:
            raise TermError(f"two variables are named {name}, a {before} and a {sort}; give one another name")
        return constant

    @property
    def reals_only(self) -> bool:
        """Whether the variables made so far are reals, and bits at most."""
        kinds = {sort.kind for sort, _ in self._made.values()}
        return "real" in kinds and kinds <= {"real", "bit"}

    def _constant(self, name: str, sort: Sort) -> Any:
        k = self.k
        if sort.kind == "bit":
            return k.Bool(name)
        if not self.integers:
            bits = vector_bits(sort)
            x = k.BitVec(name, bits)
            if sort.kind == "int" and sort.bounds != (-(1 << bits - 1), (1 << bits - 1) - 1):
                low, high = (k.BitVecVal(b, bits) for b in sort.bounds)
                self.ranges += [x >= low, x <= high]
            return x
        if sort.kind == "real":
            return k.Real(name)
        x = k.Int(name)
        self.ranges += [x >= sort.bounds[0], x <= sort.bounds[1]]
        return x

    def bind(self, term: Term, value: Any) -> None:
        """Use `value` (a solver term) wherever `term` stands."""
        self.known[term.uid] = value

    def __call__(self, terms: Iterable[Term]) -> list[Any]:
        """Solver terms of the given terms: Bool, and Int, Real or bit-vectors of `vector_bits` bits."""
        terms = list(terms)
        column = "integer" if self.integers else "vector"
        for term in postorder(terms, self.known):
            if term.sort == REAL and not self.integers:
                raise TermError(f"{describe(term)} is a real: it has no bit-vector reading; prove it in integers")
            if term.op == "var":
                self.known[term.uid] = self.variable(str(term.attr), term.sort)
            else:
                arguments = (self.known[a.uid] for a in term.args)
                self.known[term.uid] = getattr(OPERATIONS[term.op], column)(self.k, term, *arguments)
        return [self.known[t.uid] for t in terms]

    def step_context(self) -> Encoder:
        """An encoder with nothing bound that shares variables and ranges (for another tick of the same problem)."""
        other = Encoder.__new__(Encoder)
        other.k, other.integers, other.known = self.k, self.integers, {}
        other.ranges, other._made = self.ranges, self._made
        return other

    def value(self, model: Any, expression: Any, sort: Sort) -> bool | int | Fraction:
        """The exact Python value of an expression of a sort in a solver's model.

        Raises `TermError` when the solver's value is irrational, or not a value of the sort.
        """
        k = self.k
        x = model.eval(expression, model_completion=True) if k.__name__ == "z3" else model[expression]
        if sort.kind == "bit" and (k.is_true(x) or k.is_false(x)):
            return bool(k.is_true(x))
        if sort.kind == "real" and k.is_rational_value(x):
            return Fraction(x.as_fraction())
        if sort.kind == "real":
            raise TermError(
                f"{expression} is {x} in the solver's answer, which no fraction is; "
                "state the claim on squares, or ask for a value within rational bounds"
            )
        if sort.kind in ("uint", "int") and (k.is_int_value(x) or k.is_bv_value(x)):
            number = int(x.as_long())
            if k.is_bv_value(x) and sort.kind == "int" and number >= 1 << vector_bits(sort) - 1:
                number -= 1 << vector_bits(sort)
            if sort.admits(number):
                return number
        raise TermError(f"{expression} is {x} in the solver's answer, not a value of {sort}; assert the `ranges` too")
