"""The column of bits: each operation on words as gates, a term for each bit of the result, the lowest first.

An entry takes the term and the bits of its arguments.  A number has the least bits that hold its sort: two's complement
where the sort goes below zero, else unsigned.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from safety.terms.gates import Bits, and_, below, choose, known, not_, number, or_, same, total
from safety.terms.graph import Sort, Term

Entry = Callable[..., Bits]


def size_of(*sorts: Sort) -> int:
    """Bits that hold all values of the sorts, 1 at least."""
    low, high = min(s.bounds[0] for s in sorts), max(s.bounds[1] for s in sorts)
    return max(high.bit_length() if low >= 0 else 1 + max(high.bit_length(), (-1 - low).bit_length()), 1)


def extended(x: Bits, sort: Sort, size: int) -> Bits:
    """A number of a sort with more bits, by its sign or zeros; or its lowest."""
    above = x[-1] if sort.bounds[0] < 0 else known(False)
    return (x + (above,) * size)[:size]


def _sized(t: Any, args: Iterable[Bits]) -> list[Bits]:
    """The arguments with as many bits as the result."""
    return [extended(x, a.sort, size_of(t.sort)) for x, a in zip(args, t.args, strict=True)]


def _ordered(t: Any, x: Bits, y: Bits) -> tuple[Bits, Bits]:
    """Two numbers as unsigned ones of as many bits in the same order."""
    sorts = [a.sort for a in t.args]
    size = size_of(*sorts)
    found = [extended(v, s, size) for v, s in zip((x, y), sorts, strict=True)]
    if min(s.bounds[0] for s in sorts) < 0:
        found = [(*v[:-1], not_(v[-1])) for v in found]
    return found[0], found[1]


def bits_const(t: Any) -> Bits:
    """A constant."""
    return number(int(t.attr), size_of(t.sort))


def bits_same(t: Any, x: Bits) -> Bits:
    """The value itself."""
    return x


def bits_not(t: Any, x: Bits) -> Bits:
    """Inverted."""
    return (not_(x[0]),)


def bits_gate(gate: Callable[[Term, Term], Term]) -> Entry:
    """A gate of two bits, or the same bit by bit on words."""
    return lambda t, x, y: tuple(map(gate, x, y))


def bits_implies(t: Any, x: Bits, y: Bits) -> Bits:
    """Not the first, or the second."""
    return (or_(not_(x[0]), y[0]),)


def bits_add(t: Any, x: Bits, y: Bits) -> Bits:
    """Exact, since the result's bits hold it."""
    x, y = _sized(t, (x, y))
    return total(x, y, known(False))


def bits_sub(t: Any, x: Bits, y: Bits) -> Bits:
    """The one and the complement of the other, and 1."""
    x, y = _sized(t, (x, y))
    return total(x, tuple(map(not_, y)), known(True))


def bits_mul(t: Any, x: Bits, y: Bits) -> Bits:
    """A sum of one factor for each bit of the other, each a place higher."""
    size = size_of(t.sort)
    x, y = _sized(t, (x, y))
    found = number(0, size)
    for place, bit in enumerate(y):
        addend = number(0, place) + tuple(and_(bit, a) for a in x[: size - place])
        found = total(found, addend, known(False))
    return found


def bits_eq(t: Any, x: Bits, y: Bits) -> Bits:
    """Whether two are equal."""
    return (same(*_ordered(t, x, y)),)


def bits_order(equal: bool) -> Entry:
    """Whether the first is less; `equal`: or the same."""
    return lambda t, x, y: (below(*_ordered(t, x, y), known(equal)),)


def bits_select(t: Any, c: Bits, x: Bits, y: Bits) -> Bits:
    """A choice, bit by bit."""
    size = size_of(t.sort)
    x, y = (extended(v, a.sort, size) for v, a in zip((x, y), t.args[1:], strict=True))
    return tuple(choose(c[0], a, b) for a, b in zip(x, y, strict=True))


def bits_cast(t: Any, x: Bits) -> Bits:
    """The same value with the bits of another sort."""
    return _sized(t, (x,))[0]


def bits_clip(t: Any, x: Bits) -> Bits:
    """The value clamped into the result's range."""
    source, size = t.args[0].sort, size_of(t.sort)
    (low, high), (least, greatest) = source.bounds, t.sort.bounds
    wide = size_of(source, t.sort)
    whole = extended(x, source, wide)
    turned = (*whole[:-1], not_(whole[-1])) if min(low, least) < 0 else whole
    shift = 1 << wide - 1 if min(low, least) < 0 else 0
    found = whole[:size]
    if low < least:
        under = below(turned, number(least + shift, wide), known(False))
        found = tuple(choose(under, a, b) for a, b in zip(number(least, size), found, strict=True))
    if high > greatest:
        over = below(number(greatest + shift, wide), turned, known(False))
        found = tuple(choose(over, a, b) for a, b in zip(number(greatest, size), found, strict=True))
    return found


def bits_slice(t: Any, x: Bits) -> Bits:
    """Some bits, of an integer those of its two's complement."""
    start, count = t.attr
    return extended(x, t.args[0].sort, start + count)[start:]


def bits_bit(t: Any, x: Bits) -> Bits:
    """One bit of a word."""
    return (x[t.attr],)


def bits_concat(t: Any, x: Bits, y: Bits) -> Bits:
    """The upper word above the lower."""
    return y + x


def _divided(t: Any, x: Bits) -> tuple[Bits, Bits]:
    """Quotient and remainder of a word by a constant, by hand: from the highest bit down."""
    size = t.attr.bit_length()
    left, quotient = number(0, size), list[Term]()
    divisor = number(t.attr, size + 1)
    for bit in reversed(x):
        whole = (bit, *left)
        fits = below(divisor, whole, known(True))
        less = total(whole, tuple(map(not_, divisor)), known(True))
        left = tuple(choose(fits, a, b) for a, b in zip(less, whole, strict=True))[:size]
        quotient.insert(0, fits)
    return tuple(quotient), left


def bits_div(t: Any, x: Bits) -> Bits:
    """Division of a word by a constant."""
    return extended(_divided(t, x)[0], t.args[0].sort, size_of(t.sort))


def bits_mod(t: Any, x: Bits) -> Bits:
    """Remainder of a word by a constant."""
    return extended(_divided(t, x)[1], t.args[0].sort, size_of(t.sort))
