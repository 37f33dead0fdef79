"""The typed term graph: sorts, hash-consed nodes, traversal.

A term is immutable and exists once: equal structure is the same object, so identity is equality of structure and
a shared sub-expression is computed once in every reading.  Nothing here knows what an operation means; that is the
table's (`safety.terms.table`), and how a term is written is the values' (`safety.terms.values`).
"""

from __future__ import annotations

import contextlib
import itertools
import weakref
from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

Value = bool | int | Fraction


class TermError(TypeError):
    """A term was used in a way that has no meaning in every reading; the message says what to write instead."""

    exit_code = 2


@dataclass(frozen=True, slots=True)
class Sort:
    """What a term ranges over: `bit`, `uint` (n bits), `int` (a closed range) or `real` (exact).

    `low` and `high` are the least and the greatest value; both are None for a real.
    """

    kind: str
    low: int | None = None
    high: int | None = None

    @property
    def width(self) -> int:
        """Bits of an unsigned word (of no other sort)."""
        assert self.kind == "uint" and self.high is not None, f"{self} has no width"
        return self.high.bit_length()

    @property
    def bounds(self) -> tuple[int, int]:
        """Least and greatest value of a word, a bounded integer or a bit (0, 1)."""
        assert self.low is not None and self.high is not None, "a real has no bounds"
        return self.low, self.high

    @property
    def is_number(self) -> bool:
        """Whether arithmetic applies."""
        return self.kind != "bit"

    def admits(self, value: object) -> bool:
        """Whether a Python value is a value of this sort."""
        if self.kind == "bit":
            return isinstance(value, bool)
        if isinstance(value, bool):
            return False
        if self.kind == "real":
            return isinstance(value, int | Fraction)
        return isinstance(value, int) and self.bounds[0] <= value <= self.bounds[1]

    def __str__(self) -> str:
        if self.kind == "uint":
            return f"u{self.width}"
        return f"int[{self.low}, {self.high}]" if self.kind == "int" else self.kind


BIT = Sort("bit", 0, 1)
REAL = Sort("real")


def uint(width: int) -> Sort:
    """Sort of unsigned words of `width` bits; `TermError` unless the width is a whole number from 1 up."""
    if type(width) is not int or width < 1:
        raise TermError(f"a width is a whole number of bits from 1 up, not {width!r}")
    return Sort("uint", 0, (1 << width) - 1)


def integer(low: int, high: int) -> Sort:
    """Sort of the integers from `low` to `high`, both included; `TermError` unless both are whole and in order."""
    if type(low) is not int or type(high) is not int:
        raise TermError(f"the bounds of an integer range are whole numbers, not {low!r} and {high!r}")
    if low > high:
        raise TermError(f"an integer range runs from low to high, not from {low} to {high}")
    return Sort("int", low, high)


class Term:
    """A node: operation, arguments, attribute (a constant, a name, a bit number) and sort.

    Made by `node` only; a copy is the term itself, and a pickled term comes back as the one of its structure.
    """

    __slots__ = ("__weakref__", "args", "attr", "op", "sort", "uid")
    op: str
    args: tuple[Term, ...]
    attr: Any
    sort: Sort
    uid: int

    @property
    def is_const(self) -> bool:
        """Whether the term is a constant."""
        return self.op == "const"

    def __repr__(self) -> str:
        return f"<{describe(self)}: {self.sort}>"

    def __copy__(self) -> Term:
        return self

    def __deepcopy__(self, memo: object) -> Term:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return node, (self.op, self.args, self.attr, self.sort)


_nodes: weakref.WeakValueDictionary[tuple[Any, ...], Term] = weakref.WeakValueDictionary()
_uids = itertools.count()
_classes: dict[str, type[Term]] = {}


def register_class(kind: str, cls: type[Term]) -> None:
    """Say which value class terms of a sort kind are made of (called once, by `safety.terms.values`)."""
    _classes[kind] = cls


def node(op: str, args: tuple[Term, ...], attr: Any, sort: Sort) -> Term:
    """The one term of this structure; no simplification."""
    key = (op, tuple(a.uid for a in args), type(attr), attr, sort)
    found = _nodes.get(key)
    if found is None:
        found = object.__new__(_classes[sort.kind])
        found.op, found.args, found.attr, found.sort, found.uid = op, args, attr, sort, next(_uids)
        _nodes[key] = found
    return found


@contextlib.contextmanager
def noting(note: Callable[[Term], None]) -> Iterator[None]:
    """While within, `note` is told of each term that is made or found again: where it is written, for instance.

    `node` itself is exchanged, so that nothing is asked or paid for elsewhere; not for several threads at a time.
    """
    global node
    plain = node

    def told(op: str, args: tuple[Term, ...], attr: Any, sort: Sort) -> Term:
        term = plain(op, args, attr, sort)
        note(term)
        return term

    node = told
    try:
        yield
    finally:
        node = plain


def graph_size() -> int:
    """How many terms are alive."""
    return len(_nodes)


def variable(name: str, sort: Sort) -> Term:
    """A leaf that a reading binds: a state, an input or a parameter."""
    return node("var", (), name, sort)


def postorder(roots: Iterable[Term], known: Container[int] = ()) -> list[Term]:
    """Every term under the roots, arguments before users, each once (no recursion: graphs may be deep).

    Terms whose uid is in `known`, and what only they use, are left out.
    """
    order: list[Term] = []
    seen: set[int] = set()
    stack: list[tuple[Term, bool]] = [(r, False) for r in reversed(list(roots))]
    while stack:
        term, ready = stack.pop()
        if ready:
            order.append(term)
        elif term.uid not in seen and term.uid not in known:
            seen.add(term.uid)
            stack.append((term, True))
            stack.extend((a, False) for a in reversed(term.args) if a.uid not in seen)
    return order


def variables(roots: Iterable[Term]) -> list[Term]:
    """The leaves under the roots that a reading has to bind, in order of first use."""
    return [t for t in postorder(roots) if t.op == "var"]


def rewrite(roots: Iterable[Term], rule: Callable[[Term, tuple[Term, ...]], Term]) -> list[Term]:
    """Rebuild the graph bottom-up: `rule(old, new_args)` gives the replacement of each node."""
    roots = list(roots)
    new: dict[int, Term] = {}
    for term in postorder(roots):
        new[term.uid] = rule(term, tuple(new[a.uid] for a in term.args))
    return [new[r.uid] for r in roots]


_INFIX = {
    **{"and": "&", "or": "|", "xor": "^", "implies": "->", "band": "&", "bor": "|", "bxor": "^"},
    **{"add": "+", "sub": "-", "mul": "*", "eq": "==", "lt": "<", "le": "<="},
}


def describe(term: Term, depth: int = 3) -> str:
    """A short text of a term for messages, e.g. `(a.acc + k).bit(8)`; below `depth` it ends in `...`."""
    if term.op in ("const", "var", "point"):
        return str(term.attr)
    if term.op == "cast":
        return describe(term.args[0], depth)
    if depth == 0:
        return "..."
    first, *others = (describe(a, depth - 1) for a in term.args)
    if term.op in _INFIX:
        return f"({first} {_INFIX[term.op]} {others[0]})"
    if term.op == "not":
        return f"~{first}"
    if term.op == "bit":
        return f"{first}.bit({term.attr})"
    if term.op == "slice":
        start, count = term.attr
        return f"{first}.slice({start}, {count})" if start else f"{first}.low({count})"
    if term.op in ("div", "mod"):
        return f"({first} {'//' if term.op == 'div' else '%'} {term.attr})"
    if term.op == "clip":
        return f"{first}.clip{term.sort.bounds}" if term.sort.kind == "int" else f"{first}.sat({term.sort.width})"
    return f"{term.op}({', '.join([first, *others])})"


Bindings = Mapping[str, Value]
