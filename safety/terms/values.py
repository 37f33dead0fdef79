"""The names a model is written with: the value classes, and the functions on them.

Every function gives a term; a use without a meaning in every reading raises `TermError`.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any, TypeVar, cast, overload

from safety.terms.construct import both_words, build, cast_to, const, show, wire
from safety.terms.graph import BIT, REAL, Term, TermError, describe, integer, uint
from safety.terms.kinds import Bit, Int, Number, Real, UInt, Value

__all__ = [
    "AnyTerm", "Bit", "Int", "Number", "Real", "UInt", "Value",
    "all_of", "any_of", "at_least", "bit", "build", "const", "count", "implies", "real", "select", "word",
]  # fmt: skip

AnyTerm = TypeVar("AnyTerm", Bit, UInt, Int, Real)


def word(value: int, width: int) -> UInt:
    """A constant word of `width` bits; `TermError` when the value does not fit."""
    return cast(UInt, const(value, uint(width)))


def bit(value: bool) -> Bit:
    """A constant wire; `TermError` unless the value is True or False."""
    return cast(Bit, const(value, BIT))


def real(value: int | Fraction | str) -> Real:
    """A constant real, e.g. `real("2.5")` or `real(Fraction(1, 3))`; `TermError` for floats and other texts."""
    if isinstance(value, str):
        try:
            value = Fraction(value)
        except (ValueError, ZeroDivisionError):
            raise TermError(f"{value!r} is not an exact number; write e.g. real('2.5') or real('1/3')") from None
    return cast(Real, const(value, REAL))


@overload
def select(condition: Bit, then: Bit | bool, otherwise: Bit) -> Bit: ...
@overload
def select(condition: Bit, then: Bit, otherwise: bool) -> Bit: ...
@overload
def select(condition: Bit, then: UInt | int, otherwise: UInt) -> UInt: ...
@overload
def select(condition: Bit, then: UInt, otherwise: int) -> UInt: ...
@overload
def select(condition: Bit, then: Int | UInt | int, otherwise: Int) -> Int: ...
@overload
def select(condition: Bit, then: Int, otherwise: UInt | int) -> Int: ...
@overload
def select(condition: Bit, then: Real, otherwise: Real | int | Fraction) -> Real: ...
@overload
def select(condition: Bit, then: int | Fraction, otherwise: Real) -> Real: ...
def select(condition: Bit, then: Any, otherwise: Any) -> Any:
    """`then` where `condition` holds, else `otherwise`; a literal takes the sort of the other branch.

    The result has the sort of the branches; integers of two ranges give the range over both, a real beside a number
    gives a real.  Raises `TermError` when two words differ in width, or a bit stands beside a number.
    """
    where = f"select({show(condition)}, {show(then)}, {show(otherwise)})"
    c = wire(condition, where)
    if not isinstance(then, Term) and not isinstance(otherwise, Term):
        remedy = f"bit({then!r})" if isinstance(then, bool) else f"word({then!r}, width)"
        raise TermError(f"{where}: one branch has to be a term; write {remedy}")
    x, y = _branch(then, otherwise, where), _branch(otherwise, then, where)
    if x.sort == y.sort:
        return build("select", (c, x, y), None, x.sort)
    if BIT in (x.sort, y.sort):
        raise TermError(f"{where}: a bit beside a number; write .word() on the bit, or a comparison on the number")
    if REAL in (x.sort, y.sort):
        return build("select", (c, cast_to(x, REAL), cast_to(y, REAL)), None, REAL)
    if both_words(x, y):
        raise TermError(f"{where}: width mismatch; bring both to one width with .low(n), .sat(n) or .widen(n)")
    (al, ah), (bl, bh) = x.sort.bounds, y.sort.bounds
    hull = integer(min(al, bl), max(ah, bh))
    return build("select", (c, cast_to(x, hull), cast_to(y, hull)), None, hull)


def _branch(x: Any, other: Any, where: str) -> Term:
    if isinstance(x, Term):
        return x
    sort = other.sort
    if sort.kind == "int" and type(x) is int:
        return const(x, integer(x, x))
    if not sort.admits(x):
        remedy = {"bit": "True or False", "real": "a Fraction"}.get(sort.kind, f"a term, or widen {describe(other)}")
        raise TermError(f"{where}: {x!r} is not a value of {sort}; write {remedy}")
    return const(x, sort)


def implies(premise: Bit, conclusion: Bit) -> Bit:
    """Where the premise holds, so does the conclusion (kept visible, so that the premise can be shown reachable)."""
    where = f"implies({show(premise)}, {show(conclusion)})"
    return cast(Bit, build("implies", (wire(premise, where), wire(conclusion, where)), None, BIT))


def all_of(*bits: Bit) -> Bit:
    """The conjunction; true of none."""
    total = bit(True)
    for b in _wires("all_of", bits):
        total = total & b
    return total


def any_of(*bits: Bit) -> Bit:
    """The disjunction; false of none."""
    total = bit(False)
    for b in _wires("any_of", bits):
        total = total | b
    return total


def count(*bits: Bit) -> UInt:
    """How many of the wires are true, in a word just wide enough; `TermError` for no wires."""
    if not bits:
        raise TermError("count() counts one bit or more; write word(0, 1) for none")
    first, *others = (b.word().int() for b in _wires("count", bits))
    return sum(others, first).sat(len(bits).bit_length())


def at_least(k: int, *bits: Bit) -> Bit:
    """Whether at least `k` of the wires are true (the k-out-of-n vote)."""
    return count(*bits) >= k


def _wires(name: str, bits: tuple[Any, ...]) -> list[Bit]:
    for b in bits:
        if isinstance(b, list | tuple | set | frozenset):
            raise TermError(f"{name}([{', '.join(map(show, b))}]): the bits are arguments; write {name}(*bits)")
    return [cast(Bit, wire(b, f"{name}(..., {show(b)}, ...)")) for b in bits]
