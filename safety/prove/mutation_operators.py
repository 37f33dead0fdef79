"""Mutation operators: for a term, the small changes that a slip of the pen would make of it.

Each change keeps the term's sort, so that the mutant is a well-formed model in every reading.
Source: the operators of R. A. DeMillo, R. J. Lipton, F. G. Sayward (1978), with those of stuck lines in circuits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from safety.terms.construct import add, build, cast_to, clamp, const, cut, subtract
from safety.terms.graph import BIT, REAL, Sort, Term, integer

Edit = Callable[[tuple[Term, ...]], Term]  # from the term's arguments to what stands in its place
Edits = Iterator[tuple[str, Edit]]

TRANSPARENT = {"const", "point", "cast"}  # a constant is changed where it is used, the other two only carry a value
COMPARISONS = {"eq", "lt", "le"}
SWAPS = {
    **{"and": ("or", "xor"), "or": ("and", "xor"), "xor": ("and", "or"), "implies": ("and",)},
    **{"band": ("bor", "bxor"), "bor": ("band", "bxor"), "bxor": ("band", "bor")},
    **{"lt": ("le",), "le": ("lt",), "eq": ("le",), "add": ("sub",), "sub": ("add",), "mul": ("add",)},
}
WORDS = {
    **{"and": "&", "or": "|", "xor": "^", "band": "&", "bor": "|", "bxor": "^", "implies": "->"},
    **{"lt": "<", "le": "<=", "eq": "==", "add": "+", "sub": "-", "mul": "*", "bit": "bit", "slice": "start"},
    **{"div": "//", "mod": "%"},
}


def edits(term: Term) -> Edits:
    """What can be changed at a term: a text that says what, and the change."""
    if term.op in TRANSPARENT:
        return
    yield from _swapped(term)
    yield from _dropped(term)
    yield from _moved(term)
    yield from _counted(term)
    yield from _stuck(term)


def fitted(term: Term, sort: Sort) -> Term:
    """A result brought back to the sort that is expected there: words wrap, bounded integers stop at their ends."""
    if term.sort == sort or REAL in (term.sort, sort):
        return cast_to(term, sort)
    return cut(term, 0, sort.width) if sort.kind == "uint" else clamp(term, sort)


def _swapped(term: Term) -> Edits:
    for other in SWAPS.get(term.op, ()):
        yield f"{WORDS[other]} for {WORDS[term.op]}", _operation(other, term.sort)
    if term.op in COMPARISONS:
        yield "negated", lambda args: build("not", (build(term.op, args, None, BIT),), None, BIT)
        if term.op == "eq" and term.args[0].sort != BIT:
            yield ">= for ==", lambda args: build("le", args[::-1], None, BIT)
    if term.op == "select":
        yield "branches swapped", lambda args: build("select", (args[0], args[2], args[1]), None, term.sort)
    if term.op == "concat":
        yield "halves swapped", lambda args: build("concat", args[::-1], None, term.sort)


def _operation(op: str, sort: Sort) -> Edit:
    if op in ("add", "sub"):
        combine = add if op == "add" else subtract
        return lambda args: fitted(combine(*args), sort)
    return lambda args: build(op, args, None, sort)


def _dropped(term: Term) -> Edits:
    """An operand, a guard, a negation or a saturation left out."""
    if term.op == "not":
        yield "~ left out", lambda args: args[0]
    elif term.op == "clip" and term.sort.kind == "uint":
        yield "wraps", lambda args: fitted(args[0], term.sort)
    elif term.op == "select":
        yield "always the first", lambda args: args[1]
        yield "always the second", lambda args: args[2]
    elif term.op in SWAPS and term.op not in COMPARISONS:
        yield "first operand only", lambda args: fitted(args[0], term.sort)
        yield "second operand only", lambda args: fitted(args[1], term.sort)


def _moved(term: Term) -> Edits:
    """Another bit, other bits, another divisor."""
    attr: Any = term.attr
    if term.op == "bit" and term.args[0].sort.kind == "uint":
        near = [n for n in (attr - 1, attr + 1) if 0 <= n < term.args[0].sort.width]
    elif term.op == "slice" and term.args[0].sort.kind == "uint":
        start, count = attr
        near = [(n, count) for n in (start - 1, start + 1) if 0 <= n <= term.args[0].sort.width - count]
    elif term.op in ("div", "mod"):
        near = [n for n in (attr - 1, attr + 1) if n > 0]
    else:
        return
    for other in near:
        yield f"{WORDS[term.op]} {other} for {attr}", _with_attribute(term, other)


def _with_attribute(term: Term, attr: Any) -> Edit:
    wide = term.sort if term.op in ("bit", "slice") else term.args[0].sort
    return lambda args: fitted(build(term.op, args, attr, wide), term.sort)


def _counted(term: Term) -> Edits:
    """A constant one more or one less, where it is used."""
    for i, constant in enumerate(term.args):
        if constant.is_const and constant.sort != BIT:
            for value in (constant.attr - 1, constant.attr + 1):
                changed = _constant(term, constant, value)
                if changed is not None:
                    yield f"{value} for {constant.attr}", _with_argument(term, i, changed)


def _constant(term: Term, old: Term, value: Any) -> Term | None:
    """The other constant, in the sort of the old; a comparison takes one of any sort."""
    if old.sort.admits(value):
        return const(value, old.sort)
    return const(value, integer(value, value)) if term.op in COMPARISONS else None


def _with_argument(term: Term, place: int, other: Term) -> Edit:
    def edit(args: tuple[Term, ...]) -> Term:
        return build(term.op, (*args[:place], other, *args[place + 1 :]), term.attr, term.sort)

    return edit


def _stuck(term: Term) -> Edits:
    values: tuple[Any, ...] = (0,) if term.sort == REAL else term.sort.bounds
    for value in values:
        stands = const(bool(value) if term.sort == BIT else value, term.sort)
        yield f"stuck at {int(value)}", lambda args, stands=stands: stands  # type: ignore[misc]
