"""Units in which the reals of a system are whole numbers, so that doubles hold most of them exactly.

What is added, compared or chosen among, or held by one register has one unit; a product may have another.  A unit is
one over a whole number, the scale.  It changes which doubles stand for a real, never what is enclosed: a scale that
would have to be too great is left smaller, and sums of such parts are rounded like others.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction

from safety.terms.graph import REAL, Term, postorder

GREATEST = 1 << 32
ROUNDS = 8  # products that follow each other, at most


class Scales:
    """The scale of each real among some terms; `registers` are variables with what follows them."""

    def __init__(self, roots: Iterable[Term], registers: Sequence[tuple[Term, Term]]) -> None:
        self._parent: dict[int, int] = {}
        self._scale: dict[int, int] = {}
        products: list[Term] = []
        alike = [pair for pair in registers if pair[0].sort == REAL]
        for term in postorder(roots):
            args = [a for a in term.args if a.sort == REAL]
            if term.op == "mul" and args:
                products.append(term)
            elif args:
                alike.append((term, *args) if term.sort == REAL else tuple(args))  # type: ignore[arg-type]
        for group in alike:
            self._join(group)
        for _ in range(ROUNDS):
            for product in products:
                self._raise(product, self._wanted(product))

    def of(self, term: Term) -> int:
        """The scale of a real that is no constant."""
        return self._scale.get(self._root(term.uid), 1)

    def _root(self, uid: int) -> int:
        while (parent := self._parent.get(uid, uid)) != uid:
            uid = parent
        return uid

    def _join(self, group: Sequence[Term]) -> None:
        """One unit for all of them; in it the constants among them are whole."""
        first, *others = (term for term in group if not term.is_const)
        for other in others:
            one, two = self._root(first.uid), self._root(other.uid)
            if one != two:
                scale = self._scale.get(two, 1)
                self._parent[two] = one
                self._raise(first, scale)
        for constant in (term for term in group if term.is_const):
            self._raise(first, constant.attr.denominator)

    def _raise(self, term: Term, factor: int) -> None:
        scale = math.lcm(self.of(term), factor)
        if scale <= GREATEST:
            self._scale[self._root(term.uid)] = scale

    def _wanted(self, product: Term) -> int:
        x, y = product.args
        if x.is_const:
            x, y = y, x
        if y.is_const:
            return (self.of(x) / Fraction(y.attr)).numerator if y.attr else 1
        return self.of(x) * self.of(y)
