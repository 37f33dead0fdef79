"""Gates on bits, with what is known folded away: what words are made of when each of their bits is a term."""

from __future__ import annotations

from collections.abc import Sequence

from safety.terms.graph import BIT, Term, node

Bits = tuple[Term, ...]  # the lowest first


def known(value: object) -> Term:
    """A constant bit."""
    return node("const", (), bool(value), BIT)


def not_(x: Term) -> Term:
    """Not."""
    if x.is_const:
        return known(not x.attr)
    return x.args[0] if x.op == "not" else node("not", (x,), None, BIT)


def and_(x: Term, y: Term) -> Term:
    """And."""
    for a, b in ((x, y), (y, x)):
        if a.is_const:
            return b if a.attr else a
    return x if x is y else _gate("and", x, y)


def or_(x: Term, y: Term) -> Term:
    """Or."""
    for a, b in ((x, y), (y, x)):
        if a.is_const:
            return a if a.attr else b
    return x if x is y else _gate("or", x, y)


def xor(x: Term, y: Term) -> Term:
    """Exclusive or."""
    for a, b in ((x, y), (y, x)):
        if a.is_const:
            return not_(b) if a.attr else b
    return known(False) if x is y else _gate("xor", x, y)


def choose(c: Term, x: Term, y: Term) -> Term:
    """One of two."""
    if c.is_const:
        return x if c.attr else y
    if x is y:
        return x
    if x.is_const:
        return or_(c, y) if x.attr else and_(not_(c), y)
    if y.is_const:
        return or_(not_(c), x) if y.attr else and_(c, x)
    return node("select", (c, x, y), None, BIT)


def most(x: Term, y: Term, z: Term) -> Term:
    """Whether two of three are true; what it has in common with their sum is one term."""
    return or_(and_(x, y), and_(z, xor(x, y)))


def _gate(op: str, x: Term, y: Term) -> Term:
    return node(op, (x, y), None, BIT)


# --- numbers of bits -------------------------------------------------------------------------------------------------


def total(x: Sequence[Term], y: Sequence[Term], carry: Term) -> Bits:
    """The sum of two numbers of as many bits, modulo what these hold."""
    found = []
    for a, b in zip(x, y, strict=True):
        found.append(xor(xor(a, b), carry))
        carry = most(a, b, carry)
    return tuple(found)


def below(x: Sequence[Term], y: Sequence[Term], equal: Term) -> Term:
    """Whether one number is less than another; `equal` is the answer for two that are the same."""
    for a, b in zip(x, y, strict=True):
        equal = most(not_(a), b, equal)
    return equal


def same(x: Sequence[Term], y: Sequence[Term]) -> Term:
    """Whether two numbers are equal."""
    apart = known(False)
    for a, b in zip(x, y, strict=True):
        apart = or_(apart, xor(a, b))
    return not_(apart)


def number(value: int, size: int) -> Bits:
    """A constant, in two's complement."""
    return tuple(known(value >> i & 1) for i in range(size))
