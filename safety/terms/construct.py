"""How terms are made: constants, folding, and the sort of every result; operands are checked here.

The value classes (`safety.terms.kinds`) only name these functions after Python's operators.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from safety.terms import graph
from safety.terms.graph import BIT, REAL, Sort, Term, TermError, describe, integer, uint
from safety.terms.table import OPERATIONS


def build(op: str, args: tuple[Term, ...], attr: Any, sort: Sort) -> Term:
    """A term, folded when every argument is a constant, with the few rewrites that keep fault-free graphs small.

    A point stays a point whatever it carries: a fault may act there.
    """
    if op != "point" and args and all(a.is_const for a in args):
        probe = graph.node(op, args, attr, sort)
        return const(OPERATIONS[op].direct(probe, *(a.attr for a in args)), sort)
    simpler = _simplify(op, args)
    return graph.node(op, args, attr, sort) if simpler is None else simpler


def const(value: bool | int | Fraction, sort: Sort) -> Term:
    """A constant of a sort; `TermError` when the value is not one of it."""
    if not sort.admits(value):
        raise TermError(f"{show(value)} is not a value of {sort}{_hint(value, sort)}")
    return graph.node("const", (), Fraction(value) if sort.kind == "real" else value, sort)


def _hint(value: object, sort: Sort) -> str:
    if isinstance(value, Term):
        return "; it is a term already: use it as it is"
    if sort == BIT:
        return "; write True or False"
    if isinstance(value, bool):
        return "; write 1 or 0, or use a bit"
    if isinstance(value, float):
        return f"; floats are not exact: write {'Fraction' if sort == REAL else 'int'}({str(value)!r})"
    return "" if sort == REAL else "; its values are {}..{}".format(*sort.bounds)


def _simplify(op: str, args: tuple[Term, ...]) -> Term | None:
    if op == "not" and args[0].op == "not":
        return args[0].args[0]
    if op == "select":
        if args[0].is_const:
            return args[1] if args[0].attr else args[2]
        return args[1] if args[1] is args[2] else None
    if op in ("and", "or"):
        absorbing = op == "or"
        for x, y in (args, args[::-1]):
            if x.is_const:
                return x if x.attr is absorbing else y
        return args[0] if args[0] is args[1] else None
    return None


# --- operands ------------------------------------------------------------------------------------------------------


def show(x: object) -> str:
    """An operand in a message: `a.acc: u8`, or the Python value."""
    return f"{describe(x)}: {x.sort}" if isinstance(x, Term) else repr(x)


def whole(value: object, least: int, subject: Term, what: str) -> int:
    """A Python number that a width, a position or a divisor has to be; `TermError` otherwise."""
    if type(value) is not int or value < least:
        raise TermError(f"{show(subject)}: {what} is a whole constant from {least} up, not {show(value)}")
    return value


def lift(x: object, other: Term, symbol: str) -> Term:
    """A Python number beside a term, as a constant term; a term as it is."""
    if isinstance(x, Term):
        return x
    if isinstance(x, float):
        raise TermError(f"{show(other)} {symbol} {x!r}: floats are not exact; write Fraction({str(x)!r})")
    if isinstance(x, Fraction):
        return const(x, REAL)
    if isinstance(x, int) and not isinstance(x, bool):
        if other.sort == REAL:
            return const(x, REAL)
        return const(x, uint(max(x.bit_length(), 1)) if x >= 0 else integer(x, x))
    remedy = "1 or 0, or a bit's .word()" if isinstance(x, bool) else "a term, an int or a Fraction"
    raise TermError(f"{show(other)} {symbol} {x!r}: a number does not combine with {type(x).__name__}; write {remedy}")


def pair(x: Term, other: object, symbol: str) -> tuple[Term, Term]:
    """Two operands of one kind; words, integers and reals mix, bits do not: `TermError`."""
    if x.sort == BIT:
        return x, wire(other, f"{show(x)} {symbol} {show(other)}")
    y = lift(other, x, symbol)
    if y.sort == BIT:
        raise TermError(f"{show(x)} {symbol} {show(y)}: write {describe(y)}.word() to count the wire as 0 or 1")
    if REAL in (x.sort, y.sort):
        return cast_to(x, REAL), cast_to(y, REAL)
    return x, y


def wire(x: object, where: str) -> Term:
    """A bit, or True or False as one; anything else is a `TermError` that shows `where`."""
    if isinstance(x, Term) and x.sort == BIT:
        return x
    if isinstance(x, bool):
        return const(x, BIT)
    remedy = "a comparison or .bit(i)" if isinstance(x, Term) else "True or False" if x in (0, 1) else "a bit"
    raise TermError(f"{where}: a bit is needed here, not {show(x)}; write {remedy}")


def word_beside(x: Term, other: object, symbol: str) -> Term:
    """The other operand of a bitwise operation: a word of the same width, or a constant that fits it."""
    if type(other) is int and x.sort.admits(other):
        return const(other, x.sort)
    if isinstance(other, Term) and other.sort == x.sort:
        return other
    where = f"{show(x)} {symbol} {show(other)}"
    if isinstance(other, Term) and other.sort.kind == "uint":
        raise TermError(f"{where}: width mismatch; bring both to one width with .low(n) (cuts) or .widen(n) (zeros)")
    if isinstance(other, Term) and other.sort == BIT:
        raise TermError(f"{where}: a word and a bit; write select({describe(other)}, x, 0), or compare to get a bit")
    if isinstance(other, Term):
        raise TermError(f"{where}: {other.sort} has no bits; write .low({x.sort.width}) for its two's complement")
    if type(other) is int:
        raise TermError(f"{where}: the constant does not fit; widen the word, or write one in 0..{x.sort.high}")
    raise TermError(f"{where}: write a word of {x.sort.width} bits, or a whole constant in 0..{x.sort.high}")


# --- results -------------------------------------------------------------------------------------------------------


def cast_to(x: Term, sort: Sort) -> Term:
    """The same value in a sort that holds it."""
    return x if x.sort == sort else build("cast", (x,), None, sort)


def both_words(x: Term, y: Term) -> bool:
    """Whether both are unsigned words."""
    return x.sort.kind == y.sort.kind == "uint"


def _no_negative(x: Term, other: object, symbol: str, remedy: str) -> None:
    if x.sort.kind == "uint" and type(other) is int and other < 0:
        raise TermError(f"{show(x)} {symbol} {other}: a word is never negative; write {remedy}")


def add(a: Term, other: object) -> Term:
    """The exact sum: of words a word one bit wider than the wider, else an integer range or a real."""
    _no_negative(a, other, "+", f"{describe(a)} - {str(other).lstrip('-')}")
    x, y = pair(a, other, "+")
    if x.sort == REAL:
        return build("add", (x, y), None, REAL)
    if both_words(x, y):
        return build("add", (x, y), None, uint(max(x.sort.width, y.sort.width) + 1))
    (al, ah), (bl, bh) = x.sort.bounds, y.sort.bounds
    return build("add", (x, y), None, integer(al + bl, ah + bh))


def subtract(x: Term, y: Term) -> Term:
    """The exact difference: an integer range (also of words), or a real."""
    if x.sort == REAL:
        return build("sub", (x, y), None, REAL)
    (al, ah), (bl, bh) = x.sort.bounds, y.sort.bounds
    return build("sub", (x, y), None, integer(al - bh, ah - bl))


def multiply(a: Term, other: object) -> Term:
    """The exact product: of words a word as wide as both together, else an integer range or a real."""
    _no_negative(a, other, "*", f"0 - {describe(a)} * {str(other).lstrip('-')}")
    x, y = pair(a, other, "*")
    if x.sort == REAL:
        return build("mul", (x, y), None, REAL)
    if both_words(x, y):
        return build("mul", (x, y), None, uint(x.sort.width + y.sort.width))
    corners = [p * q for p in x.sort.bounds for q in y.sort.bounds]
    return build("mul", (x, y), None, integer(min(corners), max(corners)))


def cut(x: Term, start: int, count: int) -> Term:
    """`count` bits from bit `start` up, an integer being two's complement; a word cut above its top is widened."""
    if x.sort.kind == "uint" and start == 0 and count >= x.sort.width:
        return cast_to(x, uint(count))
    return build("slice", (x,), (start, count), uint(count))


def clamp(x: Term, sort: Sort) -> Term:
    """The value, or the nearest one that the sort has."""
    (low, high), (least, greatest) = x.sort.bounds, sort.bounds
    return cast_to(x, sort) if least <= low and high <= greatest else build("clip", (x,), None, sort)
