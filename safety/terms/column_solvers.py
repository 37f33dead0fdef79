"""The solver columns of the table: words as integers with a range, and words as bit-vectors.

An entry takes `k`, the solver's Python interface (z3, or cvc5 under the same names), the term, and the solver terms of
its arguments.  Nothing unsigned is ever compared signed: a bit-vector is extended by the rule of its own sort first.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from safety.terms.graph import Sort, Term, TermError

Solver = Callable[..., Any]


def either(f: Callable[..., Any]) -> Solver:
    """A function of the arguments alone."""
    return lambda k, t, *args: f(*args)


def named(name: str) -> Solver:
    """A function of the solver's interface on the arguments alone."""
    return lambda k, t, *args: getattr(k, name)(*args)


# --- words and ranges as bit-vectors -------------------------------------------------------------------------------


def vector_bits(sort: Sort) -> int:
    """Bits of a sort as a bit-vector: a word has its width, a bounded integer is two's complement.

    Raises `TermError` for a real.
    """
    if sort.kind == "uint":
        return sort.width
    if sort.kind == "real":
        raise TermError("a real has no bit-vector reading; prove this claim in the integer reading")
    return 1 + max((b if b >= 0 else -b - 1).bit_length() for b in sort.bounds)


def resize(k: Any, x: Any, sort: Sort, bits: int) -> Any:
    """The bit-vector of a value of `sort`, extended by its own sign rule (or cut) to `bits`."""
    have = vector_bits(sort)
    if bits == have:
        return x
    if bits < have:
        return k.Extract(bits - 1, 0, x)
    return (k.ZeroExt if sort.kind == "uint" else k.SignExt)(bits - have, x)


def _signed_bits(*sorts: Sort) -> int:
    return max(vector_bits(s) + (s.kind == "uint") for s in sorts)


def vector_const(k: Any, t: Term) -> Any:
    """A constant."""
    return k.BoolVal(t.attr) if t.sort.kind == "bit" else k.BitVecVal(t.attr, vector_bits(t.sort))


def vector_arithmetic(f: Callable[[Any, Any], Any]) -> Solver:
    """Both operands brought to the width of the result, which is wide enough for the exact value."""

    def row(k: Any, t: Term, x: Any, y: Any) -> Any:
        bits = vector_bits(t.sort)
        return f(resize(k, x, t.args[0].sort, bits), resize(k, y, t.args[1].sort, bits))

    return row


def vector_order(unsigned: str, signed: Callable[[Any, Any], Any]) -> Solver:
    """Words compare unsigned; anything beside an integer compares signed, one bit wider than its words."""

    def row(k: Any, t: Term, x: Any, y: Any) -> Any:
        a, b = t.args[0].sort, t.args[1].sort
        if a.kind == b.kind == "uint":
            bits = max(a.width, b.width)
            return getattr(k, unsigned)(resize(k, x, a, bits), resize(k, y, b, bits))
        bits = _signed_bits(a, b)
        return signed(resize(k, x, a, bits), resize(k, y, b, bits))

    return row


def vector_eq(k: Any, t: Term, x: Any, y: Any) -> Any:
    """Equality of the values, whatever the widths."""
    a, b = t.args[0].sort, t.args[1].sort
    if a.kind == "bit":
        return x == y
    bits = _signed_bits(a, b)
    return resize(k, x, a, bits) == resize(k, y, b, bits)


def vector_select(k: Any, t: Term, c: Any, x: Any, y: Any) -> Any:
    """A choice, both branches brought to the width of the result."""
    if t.sort.kind == "bit":
        return k.If(c, x, y)
    bits = vector_bits(t.sort)
    return k.If(c, resize(k, x, t.args[1].sort, bits), resize(k, y, t.args[2].sort, bits))


def vector_cast(k: Any, t: Term, x: Any) -> Any:
    """The same value at another width."""
    return resize(k, x, t.args[0].sort, vector_bits(t.sort))


def vector_clip(k: Any, t: Term, x: Any) -> Any:
    """The value clamped into the result's range, compared signed."""
    source = t.args[0].sort
    bits = _signed_bits(source, t.sort)
    low, high = (k.BitVecVal(b, bits) for b in t.sort.bounds)
    x = resize(k, x, source, bits)
    return k.Extract(vector_bits(t.sort) - 1, 0, k.If(x < low, low, k.If(x > high, high, x)))


def vector_slice(k: Any, t: Term, x: Any) -> Any:
    """Some bits, after extension where they lie above the operand."""
    start, count = t.attr
    source = t.args[0].sort
    return k.Extract(start + count - 1, start, resize(k, x, source, max(vector_bits(source), start + count)))


def vector_bit(k: Any, t: Term, x: Any) -> Any:
    """One bit as a truth value."""
    return k.Extract(t.attr, t.attr, x) == k.BitVecVal(1, 1)


def vector_divide(name: str) -> Solver:
    """Unsigned division at a width that holds the divisor too."""

    def row(k: Any, t: Term, x: Any) -> Any:
        bits = max(t.args[0].sort.width, t.attr.bit_length(), t.sort.width)
        result = getattr(k, name)(resize(k, x, t.args[0].sort, bits), k.BitVecVal(t.attr, bits))
        return k.Extract(t.sort.width - 1, 0, result)

    return row


# --- words as integers ---------------------------------------------------------------------------------------------


def integer_const(k: Any, t: Term) -> Any:
    """A constant."""
    if t.sort.kind == "bit":
        return k.BoolVal(t.attr)
    return k.RealVal(str(t.attr)) if t.sort.kind == "real" else k.IntVal(t.attr)


def integer_cast(k: Any, t: Term, x: Any) -> Any:
    """The same value; only a change to real needs a word in the solver's language."""
    return k.ToReal(x) if t.sort.kind == "real" and t.args[0].sort.kind != "real" else x


def integer_clip(k: Any, t: Term, x: Any) -> Any:
    """The value clamped into the result's range."""
    low, high = t.sort.bounds
    return k.If(x < low, k.IntVal(low), k.If(x > high, k.IntVal(high), x))


def integer_slice(k: Any, t: Term, x: Any) -> Any:
    """Some bits; one carry or one borrow at the most needs no division, which solvers find hard."""
    start, count = t.attr
    low, high = t.args[0].sort.bounds
    size = 1 << count
    if start == 0 and low >= 0 and high < size:
        return x
    if start == 0 and low >= 0 and high < 2 * size:
        return k.If(x >= size, x - size, x)
    if start == 0 and -size <= low and high < size:
        return k.If(x < 0, x + size, x)
    return (x / (1 << start)) % size


def integer_bit(k: Any, t: Term, x: Any) -> Any:
    """One bit as a truth value; the highest is a comparison."""
    low, high = t.args[0].sort.bounds
    if low >= 0 and high < 2 << t.attr:
        return x >= (1 << t.attr)
    return (x / (1 << t.attr)) % 2 == 1


def integer_concat(k: Any, t: Term, x: Any, y: Any) -> Any:
    """The upper word shifted by the width of the lower, plus the lower."""
    return x * (1 << t.args[1].sort.width) + y


def integer_bitwise(connective: str) -> Solver:
    """Bit by bit, each bit by division: right, and slow to reason about; control belongs in bit-vectors."""

    def row(k: Any, t: Term, x: Any, y: Any) -> Any:
        total = k.IntVal(0)
        for i in range(t.sort.width):
            a, b = (x / (1 << i)) % 2 == 1, (y / (1 << i)) % 2 == 1
            total = total + k.If(getattr(k, connective)(a, b), k.IntVal(1 << i), k.IntVal(0))
        return total

    return row


def integer_with_mask(k: Any, x: Any, mask: int, width: int) -> Any:
    """The bits of a word that a constant lets through: its runs of ones, or all but its runs of zeros."""
    ones, zeros = runs(mask, width), runs(~mask & (1 << width) - 1, width)
    if len(zeros) < len(ones):
        return x - _parts(k, x, zeros, width)
    return _parts(k, x, ones, width)


def _parts(k: Any, x: Any, chosen: list[tuple[int, int]], width: int) -> Any:
    """The bits of some runs, in their places."""
    total = k.IntVal(0)
    for low, high in chosen:
        above = x / (1 << low) if low else x
        part = above if high == width else above % (1 << high - low)
        total = total + part * (1 << low)
    return total


def runs(mask: int, width: int) -> list[tuple[int, int]]:
    """The runs of ones in a mask, each from its lowest bit to before its highest."""
    edges = [i for i in range(width + 1) if (mask >> i & 1 if i < width else 0) != (mask >> i - 1 & 1 if i else 0)]
    return list(zip(edges[::2], edges[1::2], strict=True))


def masked(connective: str) -> Solver:
    """And, or: a constant is a mask, and so is each of those among which a choice is made, as faults make it; else bit
    by bit."""

    def under(k: Any, x: Any, mask: Term, shown: Any, width: int) -> Any:
        if mask.is_const:
            through = integer_with_mask(k, x, int(mask.attr), width)
            return through if connective == "And" else x + int(mask.attr) - through
        return k.If(shown.arg(0), *(under(k, x, mask.args[i], shown.arg(i), width) for i in (1, 2)))

    def row(k: Any, t: Term, x: Any, y: Any) -> Any:
        for mask, shown, other in ((t.args[1], y, x), (t.args[0], x, y)):
            if of_constants(mask, shown):
                return under(k, other, mask, shown, t.sort.width)
        return integer_bitwise(connective)(k, t, x, y)

    return row


def of_constants(t: Term, shown: Any) -> bool:
    """Whether a word is a constant or chosen among constants, and the solver's term is that choice."""
    if t.is_const or t.op != "select":
        return t.is_const
    return shown.num_args() == 3 and all(of_constants(t.args[i], shown.arg(i)) for i in (1, 2))
