"""Every entry of the table matters: a plausible wrong one in any row and column turns the agreement check red."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import pytest

from safety.terms.column_solvers import resize, vector_arithmetic, vector_bits
from safety.terms.column_texts import form, python_clip, python_slice
from safety.terms.graph import Sort, integer, uint
from safety.terms.table import OPERATIONS
from tests.terms.agreement import COLUMNS, VECTORS, Disagreement, check, has_reals
from tests.terms.graphs import edge_graphs

Entry = Callable[..., Any]
SOLVED = ("integer", "vector", "native")  # columns whose entries are given an interface too


@dataclass(frozen=True)
class Bug:
    row: str
    column: str
    what: str
    entry: Entry

    def __str__(self) -> str:
        return f"{self.row}-{self.column}-{self.what}"


def seen(t: Any, **changes: Any) -> Any:
    """A term as an entry sees it, with something changed."""
    shown = {"args": t.args, "attr": t.attr, "sort": t.sort, "op": t.op, "is_const": t.is_const}
    return SimpleNamespace(**{**shown, **changes})


def entry(row: str, column: str) -> Entry:
    return getattr(OPERATIONS[row], column)


def altered(row: str, column: str, change: Callable[[Any], Any]) -> Entry:
    """The right entry, given a wrong term."""
    right = entry(row, column)
    if column in SOLVED:
        return lambda k, t, *args: right(k, change(t), *args)
    return lambda t, *args: right(change(t), *args)


def reordered(row: str, column: str, order: tuple[int, ...]) -> Entry:
    """The right entry with its operands in another order."""
    right = entry(row, column)

    def wrong(*given: Any) -> Any:
        leading, t, args = given[: -len(order) - 1], given[-len(order) - 1], given[-len(order) :]
        return right(*leading, seen(t, args=tuple(t.args[i] for i in order)), *(args[i] for i in order))

    return wrong


def cut_first(row: str, column: str, bits: Callable[[Any], int]) -> Entry:
    """The lowest bits of what the entry gives (or, for a row of one operand, is given), in the sort it should have."""
    right, slice_, cast = entry(row, column), entry("slice", column), entry("cast", column)

    def wrong(*given: Any) -> Any:
        leading, t, args = (given[:1], given[1], given[2:]) if column in SOLVED else ((), given[0], given[1:])
        count = bits(t)
        if count < 1 or "real" in (t.sort.kind, t.args[0].sort.kind):
            return right(*given)
        before, sort = (args[0], t.args[0].sort) if len(args) == 1 else (right(*given), t.sort)
        low = slice_(*leading, seen(t, args=(SimpleNamespace(sort=sort),), attr=(0, count), sort=uint(count)), before)
        return cast(*leading, seen(t, args=(SimpleNamespace(sort=uint(count)),)), low)

    return wrong


def other_value(t: Any) -> Any:
    if t.sort.kind == "bit":
        return seen(t, attr=not t.attr)
    return seen(t, attr=t.attr + (1 if t.sort.kind == "real" or t.attr < t.sort.bounds[1] else -1))


def signed(sort: Sort) -> Sort:
    """A word taken for two's complement."""
    return integer(-(1 << sort.width - 1), (1 << sort.width - 1) - 1) if sort.kind == "uint" else sort


def with_signed_words(t: Any) -> Any:
    return seen(t, args=tuple(SimpleNamespace(sort=signed(a.sort)) for a in t.args))


def unsigned(sort: Sort) -> Sort:
    """Two's complement taken for a word."""
    return uint(vector_bits(sort)) if sort.kind == "int" else sort


def with_unsigned_integers(t: Any) -> Any:
    return seen(t, args=tuple(SimpleNamespace(sort=unsigned(a.sort)) for a in t.args))


def everywhere() -> Iterator[Bug]:
    """Mistakes that any column can have."""
    for column in COLUMNS:
        for row, taken_for in TAKEN_FOR.items():
            yield Bug(row, column, f"is {taken_for}", entry(taken_for, column))
        for row, order in (("sub", (1, 0)), ("implies", (1, 0)), ("concat", (1, 0)), ("select", (0, 2, 1))):
            yield Bug(row, column, "operands change places", reordered(row, column, order))
        for row, what, change in (
            ("const", "another value", other_value),
            ("slice", "one bit too high", lambda t: seen(t, attr=(t.attr[0] + 1, t.attr[1]))),
            ("slice", "one bit too few", lambda t: seen(t, attr=(t.attr[0], max(t.attr[1] - 1, 1)))),
            ("bit", "one bit too low", lambda t: seen(t, attr=max(t.attr - 1, 0))),
            ("div", "divisor off by one", lambda t: seen(t, attr=t.attr + 1)),
            ("mod", "divisor off by one", lambda t: seen(t, attr=t.attr + 1)),
        ):
            yield Bug(row, column, what, altered(row, column, change))
        for row, what, bits in (
            ("add", "carry lost", lambda t: max(vector_bits(a.sort) for a in t.args)),
            ("mul", "wraps", lambda t: max(vector_bits(a.sort) for a in t.args)),
            ("cast", "highest bit lost", lambda t: vector_bits(t.args[0].sort) - 1),
            ("clip", "wraps", lambda t: vector_bits(t.sort)),
        ):
            yield Bug(row, column, what, cut_first(row, column, bits))
        yield Bug("point", column, "inverts", inverting(column))


TAKEN_FOR = {
    **{"not": "point", "and": "or", "or": "xor", "xor": "or", "implies": "or", "sub": "add", "mul": "add"},
    **{"eq": "le", "lt": "le", "le": "lt", "div": "mod", "mod": "div", "band": "bor", "bor": "bxor", "bxor": "bor"},
}


def inverting(column: str) -> Entry:
    not_, same = entry("not", column), entry("point", column)
    if column in SOLVED:
        return lambda k, t, x: not_(k, t, x) if t.sort.kind == "bit" else same(k, t, x)
    return lambda t, x: not_(t, x) if t.sort.kind == "bit" else same(t, x)


def _narrow(f: Callable[[Any, Any], Any]) -> Entry:
    """At the width of the wider operand, then extended: the silent wrap of bit-vectors."""

    def row(k: Any, t: Any, x: Any, y: Any) -> Any:
        a, b = t.args[0].sort, t.args[1].sort
        bits = max(vector_bits(a), vector_bits(b))
        return resize(k, f(resize(k, x, a, bits), resize(k, y, b, bits)), unsigned(uint(bits)), vector_bits(t.sort))

    return row


def _compared(f: Callable[[Any, Any, Any], Any]) -> Entry:
    """Compared after an extension by each operand's own rule, but all by one order."""

    def row(k: Any, t: Any, x: Any, y: Any) -> Any:
        a, b = t.args[0].sort, t.args[1].sort
        bits = max(vector_bits(a), vector_bits(b))
        return f(k, resize(k, x, a, bits), resize(k, y, b, bits))

    return row


def _clip_unsigned(k: Any, t: Any, x: Any) -> Any:
    bits = max(vector_bits(t.args[0].sort), vector_bits(t.sort)) + 1
    low, high = (k.BitVecVal(b, bits) for b in t.sort.bounds)
    x = resize(k, x, t.args[0].sort, bits)
    return k.Extract(vector_bits(t.sort) - 1, 0, k.If(k.ULT(x, low), low, k.If(k.UGT(x, high), high, x)))


def _divided(f: Callable[[Any, Any, Any], Any]) -> Entry:
    """Divided at the width of the word, whatever the divisor needs."""

    def row(k: Any, t: Any, x: Any) -> Any:
        source = t.args[0].sort
        return resize(k, f(k, x, k.BitVecVal(t.attr, source.width)), source, t.sort.width)

    return row


def _without_highest(t: Any) -> Any:
    return seen(t, sort=uint(t.sort.width - 1))


PARTICULAR = [
    # bit-vectors: sign and width
    *(
        Bug(row, "bits", "no zero-extension", altered(row, "bits", with_signed_words))
        for row in ("add", "sub", "mul", "eq", "lt", "le", "cast", "clip")
    ),
    *(
        Bug(row, "bits", "no sign-extension", altered(row, "bits", with_unsigned_integers))
        for row in ("add", "sub", "mul", "eq", "lt", "le", "clip", "slice")
    ),
    Bug("lt", "vector", "compares words signed", _compared(lambda k, x, y: x < y)),
    Bug("le", "vector", "compares words signed", _compared(lambda k, x, y: x <= y)),
    Bug("lt", "vector", "compares integers unsigned", _compared(lambda k, x, y: k.ULT(x, y))),
    Bug("le", "vector", "compares integers unsigned", _compared(lambda k, x, y: k.ULE(x, y))),
    Bug("eq", "vector", "compares a word and an integer at one width", _compared(lambda k, x, y: x == y)),
    *(
        Bug(row, "vector", "no zero-extension", altered(row, "vector", with_signed_words))
        for row in ("add", "sub", "mul", "eq", "lt", "le", "cast", "clip")
    ),
    *(
        Bug(row, "vector", "no sign-extension", altered(row, "vector", with_unsigned_integers))
        for row in ("add", "sub", "mul", "eq", "lt", "le", "clip", "slice")
    ),
    Bug("add", "vector", "wraps", _narrow(lambda x, y: x + y)),
    Bug("sub", "vector", "wraps", _narrow(lambda x, y: x - y)),
    Bug("mul", "vector", "wraps", _narrow(lambda x, y: x * y)),
    Bug("mul", "vector", "adds", vector_arithmetic(lambda x, y: x + y)),
    Bug("clip", "vector", "compares unsigned", _clip_unsigned),
    Bug("div", "vector", "wraps the divisor", _divided(lambda k, x, n: k.UDiv(x, n))),
    Bug("mod", "vector", "wraps the divisor", _divided(lambda k, x, n: k.URem(x, n))),
    Bug("div", "vector", "divides signed", _divided(lambda k, x, n: x / n)),
    Bug("mod", "vector", "divides signed", _divided(lambda k, x, n: x % n)),
    Bug("bit", "vector", "tests for zero", lambda k, t, x: k.Extract(t.attr, t.attr, x) == k.BitVecVal(0, 1)),
    # integers: shortcuts taken too far
    Bug("slice", "integer", "at most one carry", lambda k, t, x: k.If(x >= 1 << t.attr[1], x - (1 << t.attr[1]), x)),
    Bug("slice", "integer", "no wrap", lambda k, t, x: x / (1 << t.attr[0])),
    Bug("bit", "integer", "every bit is the highest", lambda k, t, x: x >= 1 << t.attr),
    Bug("clip", "integer", "no lower bound", lambda k, t, x: k.If(x > t.sort.bounds[1], k.IntVal(t.sort.bounds[1]), x)),
    Bug(
        "clip", "integer", "off by one", lambda k, t, x: k.If(x >= t.sort.bounds[1], k.IntVal(t.sort.bounds[1] - 1), x)
    ),
    Bug("concat", "integer", "shifted by the wrong part", lambda k, t, x, y: x * (1 << t.args[0].sort.width) + y),
    *(
        Bug(row, "integer", "highest bit forgotten", altered(row, "integer", _without_highest))
        for row in ("band", "bor", "bxor")
    ),
    # lanes: 64 bits, and NumPy's own types
    *(
        Bug(row, "lanes", "overflows", form(f"({{0}} {s} {{1}})"))
        for row, s in (("add", "+"), ("sub", "-"), ("mul", "*"))
    ),
    Bug("select", "lanes", "floats", form("np.where({0}, {1}, {2})")),
    Bug("not", "lanes", "is for one value", form("(not {0})")),
    Bug("implies", "lanes", "inverts the number of a literal", form("(~{0} | {1})")),
    Bug("bit", "lanes", "a number", form("({0} >> {attr} & 1)")),
    Bug("clip", "lanes", "overflows", lambda t, x: "np.minimum(np.maximum({}, {}), {})".format(x, *t.sort.bounds)),
    Bug("slice", "lanes", "overflows", python_slice),
    Bug("concat", "lanes", "overflows", lambda t, x, y: f"({x} << {t.args[1].sort.width} | {y})"),
    Bug("cast", "lanes", "not converted", form("{0}")),
    Bug("div", "lanes", "overflows", form("({0} // {attr})")),
    Bug("mod", "lanes", "overflows", form("({0} % {attr})")),
    # Python
    Bug("clip", "python", "no lower bound", lambda t, x: f"min({x}, {t.sort.bounds[1]})"),
    Bug(
        "clip",
        "python",
        "bounds off by one",
        lambda t, x: python_clip(seen(t, sort=integer(0, t.sort.bounds[1] + 1)), x),
    ),
    Bug("cast", "python", "a whole number for a real", form("{0}")),
    Bug("bit", "python", "a number", form("({0} >> {attr} & 1)")),
    Bug("not", "python", "inverts a number", form("(~{0})")),
    Bug("div", "python", "a float", form("({0} / {attr})")),
    # direct
    Bug("slice", "direct", "no wrap", lambda t, x: x >> t.attr[0]),
    Bug("clip", "direct", "no upper bound", lambda t, x: max(x, t.sort.bounds[0])),
    Bug("cast", "direct", "a whole number for a real", lambda t, x: x),
    Bug("div", "direct", "rounds to the nearest", lambda t, x: (x + t.attr // 2) // t.attr),
]

BUGS = [*everywhere(), *PARTICULAR]


@pytest.mark.parametrize("bug", BUGS, ids=str)
def test_a_planted_bug_is_found(bug: Bug, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(OPERATIONS, bug.row, replace(OPERATIONS[bug.row], **{bug.column: bug.entry}))
    for reading in COLUMNS[bug.column]:
        with pytest.raises(Disagreement):
            for outputs, rows in edge_graphs(bug.row):
                if reading not in VECTORS or not has_reals(outputs):
                    check(reading, outputs, rows)


def test_a_bug_is_planted_in_every_entry() -> None:
    assert {(b.row, b.column) for b in BUGS} == {
        (row, column) for row in OPERATIONS if row != "var" for column in COLUMNS
    }
