"""Terms as expressions of SMT-LIB, kept as a graph that formats write out.

`Expressions` stands in for a solver's interface in the solver columns of the table of operations, and only notes what
is asked of it.  So a file says what the solvers are told, and there is no other account of the operations to go wrong.
An expression is named by its operation in SMT-LIB; its sort is `Bool`, `Int`, `Real`, or a number of bits.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from safety.terms.graph import REAL, Sort, Term, TermError, describe, postorder
from safety.terms.table import OPERATIONS, vector_bits

BOOL, INT, REAL_SORT = "Bool", "Int", "Real"
Width = int | str

_NAMED = {
    **{"Not": "not", "And": "and", "Or": "or", "Xor": "xor", "Implies": "=>", "If": "ite", "Concat": "concat"},
    **{"ULT": "bvult", "ULE": "bvule", "UDiv": "bvudiv", "URem": "bvurem", "ToReal": "to_real"},
}
_ON_BITS = {
    "+": "bvadd",
    "-": "bvsub",
    "*": "bvmul",
    "<": "bvslt",
    "<=": "bvsle",
    "&": "bvand",
    "|": "bvor",
    "^": "bvxor",
}
_TRUTHS = {"=", "<", "<=", "bvult", "bvule", "bvslt", "bvsle"}


class Expression:
    """A node: operation, arguments, attribute (a constant, a name, bit numbers, a count of bits), sort."""

    __slots__ = ("args", "attr", "home", "number", "op", "sort")
    __hash__ = object.__hash__

    def __init__(self, home: Expressions, op: str, args: tuple[Expression, ...], attr: Any, sort: Width) -> None:
        self.home, self.op, self.args, self.attr, self.sort = home, op, args, attr, sort
        self.number = len(home)

    @property
    def is_true(self) -> bool:
        """Whether it is the constant true."""
        return self.op == "const" and self.attr is True

    def _with(self, op: str, other: Expression | int) -> Expression:
        y = self.home.IntVal(other) if isinstance(other, int) else other
        return self.home.made(_ON_BITS.get(op, op) if isinstance(self.sort, int) else op, self, y)

    def __add__(self, other: Expression | int) -> Expression:
        return self._with("+", other)

    def __sub__(self, other: Expression | int) -> Expression:
        return self._with("-", other)

    def __mul__(self, other: Expression | int) -> Expression:
        return self._with("*", other)

    def __truediv__(self, other: int) -> Expression:  # of whole numbers, as in the solvers' interface
        return self._with("div", other)

    def __mod__(self, other: int) -> Expression:
        return self._with("mod", other)

    def __and__(self, other: Expression) -> Expression:
        return self._with("&", other)

    def __or__(self, other: Expression) -> Expression:
        return self._with("|", other)

    def __xor__(self, other: Expression) -> Expression:
        return self._with("^", other)

    def __eq__(self, other: Expression | int) -> Expression:  # type: ignore[override]
        return self._with("=", other)

    def __lt__(self, other: Expression | int) -> Expression:
        return self._with("<", other)

    def __le__(self, other: Expression | int) -> Expression:
        return self._with("<=", other)

    def __gt__(self, other: Expression | int) -> Expression:
        return (self.home.IntVal(other) if isinstance(other, int) else other)._with("<", self)

    def __ge__(self, other: Expression | int) -> Expression:
        return (self.home.IntVal(other) if isinstance(other, int) else other)._with("<=", self)


class Expressions:
    """Makes expressions, each of a structure once, under the names of a solver's interface."""

    def __init__(self) -> None:
        self._made: dict[tuple[Any, ...], Expression] = {}

    def __len__(self) -> int:
        return len(self._made)

    def _node(self, op: str, args: tuple[Expression, ...], attr: Any, sort: Width) -> Expression:
        key = (op, tuple(a.number for a in args), attr, sort)
        if key not in self._made:
            self._made[key] = Expression(self, op, args, attr, sort)
        return self._made[key]

    def made(self, op: str, *args: Expression) -> Expression:
        """An operation on expressions."""
        sort: Width = args[0].sort
        if op in _TRUTHS:
            sort = BOOL
        elif op == "ite":
            sort = args[1].sort
        elif op == "concat":
            sort = sum(a.sort for a in args if isinstance(a.sort, int))
        elif op == "to_real":
            sort = REAL_SORT
        return self._node(op, args, None, sort)

    def __getattr__(self, name: str) -> Any:
        if name not in _NAMED:
            raise AttributeError(name)
        return lambda *args: self.made(_NAMED[name], *args)

    def variable(self, name: str, sort: Width) -> Expression:
        """A free constant."""
        return self._node("var", (), name, sort)

    def constant(self, value: int, sort: Width) -> Expression:
        """A truth value or a bit-vector."""
        return self.BitVecVal(value, sort) if isinstance(sort, int) else self.BoolVal(bool(value))

    def BoolVal(self, value: bool) -> Expression:
        """True or false."""
        return self._node("const", (), bool(value), BOOL)

    def BitVecVal(self, value: int, bits: int) -> Expression:
        """A constant of so many bits, in two's complement."""
        return self._node("const", (), value % (1 << bits), bits)

    def IntVal(self, value: int) -> Expression:
        """A whole number."""
        return self._node("const", (), value, INT)

    def RealVal(self, text: str) -> Expression:
        """A real constant, `n` or `n/d`."""
        return self._node("const", (), text, REAL_SORT)

    def Extract(self, high: int, low: int, x: Expression) -> Expression:
        """Bits `high` to `low`, both included."""
        if x.op == "const":
            return self.BitVecVal(x.attr >> low, high - low + 1)
        return x if (low, high + 1) == (0, x.sort) else self._node("extract", (x,), (high, low), high - low + 1)

    def ZeroExt(self, bits: int, x: Expression) -> Expression:
        """So many zeros above."""
        return self._extended("zero_extend", bits, x, 0)

    def SignExt(self, bits: int, x: Expression) -> Expression:
        """So many copies of the highest bit above it."""
        return self._extended("sign_extend", bits, x, -1)

    def _extended(self, op: str, bits: int, x: Expression, above: int) -> Expression:
        assert isinstance(x.sort, int), "only bit-vectors are extended"
        if x.op == "const":
            return self.BitVecVal(x.attr + (above << x.sort if x.attr >> x.sort - 1 else 0), x.sort + bits)
        return self._node(op, (x,), bits, x.sort + bits)


class Reading:
    """Reads terms as expressions, words as integers or as bit-vectors; every variable is bound first.

    Raises `TermError` for a real among bit-vectors.
    """

    def __init__(self, integers: bool) -> None:
        self.k = Expressions()
        self.integers = integers
        self.known: dict[int, Expression] = {}

    def sort(self, sort: Sort) -> Width:
        """The sort that a variable has."""
        if sort.kind == "bit":
            return BOOL
        if self.integers:
            return REAL_SORT if sort == REAL else INT
        return vector_bits(sort)

    def bind(self, term: Term, name: str) -> Expression:
        """A variable by this name, used wherever `term` stands."""
        self._check(term)
        self.known[term.uid] = self.k.variable(name, self.sort(term.sort))
        return self.known[term.uid]

    def __call__(self, terms: Iterable[Term]) -> list[Expression]:
        """The terms as expressions."""
        terms = list(terms)
        column = "integer" if self.integers else "vector"
        for term in postorder(terms, self.known):
            self._check(term)
            arguments = (self.known[a.uid] for a in term.args)
            self.known[term.uid] = getattr(OPERATIONS[term.op], column)(self.k, term, *arguments)
        return [self.known[t.uid] for t in terms]

    def _check(self, term: Term) -> None:
        if term.sort == REAL and not self.integers:
            raise TermError(f"{describe(term)} is a real: it has no bits; write SMT-LIB or VMT over integers")


def below(roots: Iterable[Expression]) -> list[Expression]:
    """Every expression under the roots, arguments before users, each once."""
    seen: dict[int, Expression] = {}
    stack = list(roots)
    while stack:
        x = stack.pop()
        if x.number not in seen:
            seen[x.number] = x
            stack += x.args
    return [seen[number] for number in sorted(seen)]


class Names:
    """Names as a format can have them: without some signs (`_` for them), and no two alike."""

    def __init__(self, unwanted: str) -> None:
        self._clean = str.maketrans(dict.fromkeys(unwanted, "_"))
        self._taken: set[str] = set()

    def new(self, name: str) -> str:
        """The name, or one like it that is not taken; taken from now on."""
        found = plain = name.translate(self._clean)
        n = 1
        while found in self._taken:
            n += 1
            found = f"{plain}_{n}"
        self._taken.add(found)
        return found
