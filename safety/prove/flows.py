"""The next value of a register read as a sum: what flows in, and the pulses by which it is carried on.

    phase' = phase + speed - 65536 * [pulse, wheel]          [bits, number]: the number while all the bits are true
    count' = count + [carry in] - 16 * [carry out]

A wrap is its carry times the modulus, a selection its condition times the difference of its branches; bits multiply
as 0 and 1, so a combination of bits becomes a sum of products of them.  A clip is read as if it never cut: whether the
sum is right, or bounds the register from one side, is for solvers to say (`safety.prove.closed_form`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import cast

from safety.terms import Bit, Int
from safety.terms.construct import build, cast_to, const
from safety.terms.graph import BIT, REAL, Term, integer, postorder
from safety.terms.values import all_of, select

Product = tuple[frozenset[int], int | None]
"""Bits (by uid) times a number (by uid) or times 1."""
Sum = dict[Product, int]
ONE: Product = (frozenset(), None)
MOST = 64  # products of a sum; a longer one is taken as it stands, by its own name


class TooMixed(ValueError):
    """A product of two numbers, or a sum of too many products."""


def added(x: Sum, y: Sum, times: int = 1) -> Sum:
    """`x + times * y`."""
    total = dict(x)
    for product, c in y.items():
        total[product] = total.get(product, 0) + times * c
    return {product: c for product, c in total.items() if c}


def multiplied(x: Sum, y: Sum) -> Sum:
    """`x * y`; `TooMixed` where two numbers would be multiplied."""
    total: Sum = {}
    for (bits, number), c in x.items():
        for (others, other), d in y.items():
            if number is not None and other is not None:
                raise TooMixed
            product = (bits | others, other if number is None else number)
            total[product] = total.get(product, 0) + c * d
    if len(total) > MOST:
        raise TooMixed
    return {product: c for product, c in total.items() if c}


class Reader:
    """Reads terms as sums over registers, inputs and bits; `names` gives the term of each uid that stands in them.

    Of inputs that are `same` (uid to input) one stands for all; what is computed from inputs alone is a number of its
    own, unless it is a sum of them.
    """

    def __init__(self, registers: Iterable[Term], same: Mapping[int, Term]) -> None:
        self.names: dict[int, Term] = {v.uid: v for v in same.values()}
        self._registers = {v.uid for v in registers}
        self._same = same
        self._sums: dict[int, Sum] = {}
        self._inner: set[int] = set()  # terms that depend on a register

    def __call__(self, term: Term) -> Sum:
        """The sum that a number (or a bit, as 0 or 1) is."""
        for t in postorder([term], self._sums):
            if t.uid in self._registers or any(a.uid in self._inner for a in t.args):
                self._inner.add(t.uid)
            self.names[t.uid] = t
            self._sums[t.uid] = self._read(t)
        return self._sums[term.uid]

    def term(self, total: Sum) -> Int:
        """The sum as a term."""
        result = whole(0)
        for (bits, number), c in total.items():
            part = whole(1) if number is None else as_int(self.names[number])
            if bits:
                part = select(all_of(*(cast(Bit, self.names[b]) for b in sorted(bits))), part, 0)
            result = result + part * c
        return result

    def inner(self, uid: int) -> bool:
        """Whether a term of this uid depends on a register."""
        return uid in self._inner

    def _read(self, t: Term) -> Sum:
        try:
            found = self._sum(t)
            of_inputs = t.sort != BIT and t.uid not in self._inner
            if len(found) <= MOST and not (of_inputs and any(bits for bits, _ in found)):
                return found
        except TooMixed:
            pass
        return {(frozenset([t.uid]), None) if t.sort == BIT else (frozenset(), t.uid): 1}

    def _sum(self, t: Term) -> Sum:
        if t.is_const and t.sort != REAL:
            return {ONE: int(t.attr)} if t.attr else {}
        if t.op == "var" and t.sort != BIT:
            return {(frozenset(), self._same.get(t.uid, t).uid): 1}
        if t.op == "clip" and t.uid not in self._inner:
            raise TooMixed
        rule = _RULES.get(t.op)
        if rule is None or any(a.sort == REAL for a in t.args):
            raise TooMixed
        return rule(self, t, *(self._sums[a.uid] for a in t.args))

    def wrapped(self, t: Term, x: Sum) -> Sum:
        """The lowest bits of a word: the word less its higher bits."""
        (word,), (start, count) = t.args, t.attr
        if start or word.sort.kind != "uint":
            raise TooMixed
        for k in range(count, word.sort.width):
            carry = build("bit", (word,), k, BIT)
            self.names[carry.uid] = carry
            x = added(x, {(frozenset([carry.uid]), None): 1}, -(1 << k))
        return x


def as_int(t: Term) -> Int:
    """A word or bounded integer as an integer."""
    return cast(Int, t if t.sort.kind == "int" else cast_to(t, integer(*t.sort.bounds)))


def is_whole(t: Term) -> bool:
    """Whether a term is a whole number."""
    return t.sort.kind in ("uint", "int")


def whole(n: int) -> Int:
    """A constant integer."""
    return cast(Int, const(n, integer(n, n)))


def _select(_: Reader, t: Term, c: Sum, x: Sum, y: Sum) -> Sum:
    return added(y, multiplied(c, added(x, y, -1)))


_RULES: dict[str, Callable[..., Sum]] = {
    "point": lambda r, t, x: x,
    "cast": lambda r, t, x: x,
    "clip": lambda r, t, x: x,
    "not": lambda r, t, x: added({ONE: 1}, x, -1),
    "and": lambda r, t, x, y: multiplied(x, y),
    "or": lambda r, t, x, y: added(added(x, y), multiplied(x, y), -1),
    "xor": lambda r, t, x, y: added(added(x, y), multiplied(x, y), -2),
    "implies": lambda r, t, x, y: added({ONE: 1}, multiplied(x, added({ONE: 1}, y, -1)), -1),
    "add": lambda r, t, x, y: added(x, y),
    "sub": lambda r, t, x, y: added(x, y, -1),
    "mul": lambda r, t, x, y: multiplied(x, y),
    "select": _select,
    "slice": lambda r, t, x: r.wrapped(t, x),
}
