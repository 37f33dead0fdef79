"""The native column of the table: LLVM instructions on vectors, a lane each.

An entry takes the `Code` that is written, the term and the names of its arguments, and gives the name of its result.
A number is `<N x iW>` of the least W of 8, 16, 32, 64 that holds its sort: two's complement where the sort goes below
zero, else unsigned.  Narrow words matter, since a vector has as many lanes as they are narrow.  A bit is `<N x i1>`, or
where the processor has mask registers a whole number of N bits (`packed`): gates then are those of plain integers.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from safety.terms.graph import BIT, Sort, Term, TermError, describe

WIDTHS = (8, 16, 32, 64)


class Code(Protocol):
    """What is being written: instructions in order, each with a name of its own."""

    lanes: int
    packed: bool
    sliced: bool

    def op(self, text: str) -> str:
        """Write an instruction; the name of its result."""

    def call(self, intrinsic: str, kind: str, *args: str) -> str:
        """Write a call of an intrinsic whose arguments and result are of one type; the name of its result."""

    def of(self, term: Term) -> str:
        """The name of a term written before."""


Native = Callable[..., str]


def signed(sort: Sort) -> bool:
    """Whether a number of a sort is kept as two's complement."""
    return sort.bounds[0] < 0


def bits_for(*sorts: Sort, widths: tuple[int, ...] = (*WIDTHS, 128)) -> tuple[int, bool]:
    """The least width that holds all values of the sorts, and whether as two's complement."""
    low, high = min(s.bounds[0] for s in sorts), max(s.bounds[1] for s in sorts)
    need = high.bit_length() if low >= 0 else 1 + max(high.bit_length(), (-1 - low).bit_length())
    return next((w for w in widths if need <= w), 0), low < 0


def width(t: Any) -> int:
    """Bits in which the lanes of a number are kept; `TermError` for a real, and beyond 64."""
    if t.sort.kind == "real":
        raise TermError(f"{describe(t)} is a real: it has no native reading; use lanes")
    found, _ = bits_for(t.sort, widths=WIDTHS)
    if not found:
        raise TermError(f"{describe(t)} is {t.sort}, more than the 64 bits of a native word; use lanes")
    return found


def vector(k: Code, bits: int) -> str:
    """A vector type."""
    return f"<{k.lanes} x i{bits}>"


def lane_vector(k: Code, t: Any) -> str:
    """The type of a term."""
    return bit_type(k) if t.sort == BIT else vector(k, width(t))


def bit_type(k: Code) -> str:
    """The type of a bit."""
    if k.sliced:
        return f"<{k.lanes // 64} x i64>"
    return f"i{k.lanes}" if k.packed else vector(k, 1)


def truth(k: Code, value: bool) -> str:
    """A constant bit."""
    if k.sliced:
        return splat(64, -int(value))
    return str(-int(value)) if k.packed else splat(1, int(value))


def mask_of(k: Code, x: str) -> str:
    """A bit as the condition of a vector instruction."""
    return k.op(f"bitcast {bit_type(k)} {x} to {vector(k, 1)}") if k.packed else x


def bit_of(k: Code, mask: str) -> str:
    """What a vector comparison gives, as a bit."""
    return k.op(f"bitcast {vector(k, 1)} {mask} to {bit_type(k)}") if k.packed else mask


def splat(bits: int, value: int) -> str:
    """A constant in every lane, as an operand: its lowest bits."""
    return f"splat (i{bits} {value % (1 << bits)})"


def resized(k: Code, x: str, sort: Sort, bits: int) -> str:
    """A number of a sort at another width: extended by its sign or by zeros, or its lowest bits."""
    own, negative = bits_for(sort)
    if own == bits:
        return x
    how = "trunc" if own > bits else "sext" if negative else "zext"
    return k.op(f"{how} {vector(k, own)} {x} to {vector(k, bits)}")


def both(k: Code, t: Any, x: str, y: str) -> tuple[int, bool, str, str]:
    """The operands at a width that holds both."""
    a, b = t.args[0].sort, t.args[1].sort
    bits, negative = bits_for(a, b)
    return bits, negative, resized(k, x, a, bits), resized(k, y, b, bits)


def native_const(k: Code, t: Any) -> str:
    """A constant."""
    return truth(k, t.attr) if t.sort == BIT else splat(width(t), t.attr)


def native_gate(name: str) -> Native:
    """A gate of two bits, or the same bit by bit on words."""
    return lambda k, t, x, y: k.op(f"{name} {lane_vector(k, t)} {x}, {y}")


def native_same(k: Code, t: Any, x: str) -> str:
    """The value itself."""
    return x


def native_not(k: Code, t: Any, x: str) -> str:
    """Inverted."""
    return k.op(f"xor {bit_type(k)} {x}, {truth(k, True)}")


def native_implies(k: Code, t: Any, x: str, y: str) -> str:
    """Not the first, or the second."""
    return k.op(f"or {bit_type(k)} {native_not(k, t, x)}, {y}")


def native_arithmetic(name: str) -> Native:
    """Exact, since the result's own width holds it: modulo that width nothing is lost before either."""

    def entry(k: Code, t: Any, x: str, y: str) -> str:
        bits = width(t)
        x, y = (resized(k, v, a.sort, bits) for v, a in zip((x, y), t.args, strict=True))
        return k.op(f"{name} {vector(k, bits)} {x}, {y}")

    return entry


def native_order(unsigned: str, negative: str) -> Native:
    """A comparison, at a width that holds both operands; of bits there is only equality."""

    def entry(k: Code, t: Any, x: str, y: str) -> str:
        if t.args[0].sort == BIT:
            return native_not(k, t, k.op(f"xor {bit_type(k)} {x}, {y}"))
        bits, signs, x, y = both(k, t, x, y)
        return bit_of(k, k.op(f"icmp {negative if signs else unsigned} {vector(k, bits)} {x}, {y}"))

    return entry


def native_select(k: Code, t: Any, c: str, x: str, y: str) -> str:
    """A choice in each lane."""
    kind = lane_vector(k, t)
    if t.sort == BIT and (k.packed or k.sliced):
        then, otherwise = k.op(f"and {kind} {c}, {x}"), k.op(f"and {kind} {native_not(k, t, c)}, {y}")
        return k.op(f"or {kind} {then}, {otherwise}")
    return k.op(f"select {vector(k, 1)} {mask_of(k, c)}, {kind} {x}, {kind} {y}")


def native_cast(k: Code, t: Any, x: str) -> str:
    """The same value at the width of another sort."""
    return resized(k, x, t.args[0].sort, width(t))


def native_clip(k: Code, t: Any, x: str) -> str:
    """The value clamped into the result's range."""
    source = t.args[0].sort
    (low, high), (least, greatest) = source.bounds, t.sort.bounds
    if (full := full_sum(t.args[0])) is not None and t.sort == full[0].sort:
        return k.call("uadd.sat", lane_vector(k, t), *map(k.of, full))
    bits, negative = bits_for(source, t.sort)
    sign = "s" if negative else "u"
    x = resized(k, x, source, bits)
    if low < least:
        x = k.call(f"{sign}max", vector(k, bits), x, splat(bits, least))
    if high > greatest:
        x = k.call(f"{sign}min", vector(k, bits), x, splat(bits, greatest))
    return x if bits == width(t) else k.op(f"trunc {vector(k, bits)} {x} to {lane_vector(k, t)}")


def native_slice(k: Code, t: Any, x: str) -> str:
    """Some bits, of an integer those of its two's complement."""
    source, (start, count), bits = t.args[0].sort, t.attr, width(t)
    own, negative = bits_for(source)
    if start:
        x = k.op(f"{'ashr' if negative else 'lshr'} {vector(k, own)} {x}, {splat(own, start)}")
    x = resized(k, x, source, bits)
    beyond = negative or source.bounds[1] >> start >= 1 << count
    return k.op(f"and {vector(k, bits)} {x}, {splat(bits, (1 << count) - 1)}") if beyond and count < bits else x


def native_bit(k: Code, t: Any, x: str) -> str:
    """Whether a bit of a word is set; the carry of a sum of two full words needs no wider sum."""
    word = t.args[0]
    if (full := full_sum(word)) is not None and t.attr == word.sort.width - 1:
        kind = lane_vector(k, full[0])
        a, b = (k.of(v) for v in full)
        return bit_of(k, k.op(f"icmp ult {kind} {k.op(f'add {kind} {a}, {b}')}, {a}"))
    bits, _ = bits_for(word.sort)
    kind = vector(k, bits)
    chosen = k.op(f"and {kind} {x}, {splat(bits, 1 << t.attr)}")
    return bit_of(k, k.op(f"icmp ne {kind} {chosen}, zeroinitializer"))


def full_sum(t: Any) -> tuple[Any, Any] | None:
    """The operands of a sum of two words that fill their lanes, so that the sum alone needs wider ones."""
    if getattr(t, "op", "") != "add":
        return None
    x, y = t.args
    full = x.sort == y.sort and x.sort.kind == "uint" and x.sort.width in WIDTHS
    return (x, y) if full else None


def native_concat(k: Code, t: Any, x: str, y: str) -> str:
    """The upper word above the lower."""
    bits, (upper, lower) = width(t), (a.sort for a in t.args)
    x, y = resized(k, x, upper, bits), resized(k, y, lower, bits)
    shifted = k.op(f"shl {vector(k, bits)} {x}, {splat(bits, lower.width)}")
    return k.op(f"or {vector(k, bits)} {shifted}, {y}")


def native_div(k: Code, t: Any, x: str) -> str:
    """Division of a word by a constant; one beyond the word leaves nothing."""
    source = t.args[0].sort
    if t.attr > source.bounds[1]:
        return splat(width(t), 0)
    bits, _ = bits_for(source)
    return resized(k, k.op(f"udiv {vector(k, bits)} {x}, {splat(bits, t.attr)}"), source, width(t))


def native_mod(k: Code, t: Any, x: str) -> str:
    """Remainder of a word by a constant; one beyond the word leaves the word."""
    source = t.args[0].sort
    if t.attr > source.bounds[1]:
        return resized(k, x, source, width(t))
    bits, _ = bits_for(source)
    return resized(k, k.op(f"urem {vector(k, bits)} {x}, {splat(bits, t.attr)}"), source, width(t))
