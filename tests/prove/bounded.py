"""Bounds as the tests state them, and what a good bracket is."""

from __future__ import annotations

from fractions import Fraction as F

from safety.prove.bounds import Bound, Bracket
from safety.prove.bounds.routes import BOXES, NLSAT
from safety.prove.claims import PROVED
from safety.terms import Bit, Real, real

ONE = real(1)


def bound(quantity: Real, *given: Bit, per: Real = ONE, whole: tuple[Real, ...] = ()) -> Bound:
    return Bound("b", "a quantity", quantity, given, per, whole)


def narrow(found: Bracket, around: F) -> bool:
    """Proved by both routes, no wider than asked for, with the value in it."""
    assert (found.verdict, found.agreed_by) == (PROVED, [NLSAT, BOXES]), found.why
    assert found.low is not None and found.high is not None and found.width is not None
    return found.width <= F(1, 10_000) and found.low <= around <= found.high
