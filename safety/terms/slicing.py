"""A term graph taken apart into bits: the same values, each bit of a word a term of gates."""

from __future__ import annotations

from collections.abc import Callable

from safety.terms.column_bits import size_of
from safety.terms.column_native import width
from safety.terms.gates import Bits
from safety.terms.graph import BIT, Term, node, postorder
from safety.terms.table import OPERATIONS


def leaves(term: Term) -> Bits:
    """Variables for the bits of a variable or a point; points of one name are two where their values differ."""
    size = 1 if term.sort == BIT else size_of(term.sort)
    value = term.args[0].uid if term.op == "point" else None
    return tuple(node("var", (), (term.op, term.attr, value, i), BIT) for i in range(size))


class Slices:
    """The bits of terms; `cut` says which points stand for themselves, as variables do."""

    def __init__(self, cut: Callable[[Term], bool] = lambda point: False) -> None:
        self._cut = cut
        self._found: dict[int, Bits] = {}
        self.points: dict[int, Term] = {}  # those that stand for themselves, by the uid of each of their bits

    def of(self, term: Term) -> Bits:
        """The bits of a term, the lowest first; an integer below zero as two's complement.

        Raises `TermError` for a real, and beyond 64 bits.
        """
        for t in postorder([term], self._found):
            width(t)
            if t.op == "var" or (t.op == "point" and self._cut(t)):
                self._found[t.uid] = leaves(t)
                self.points |= {bit.uid: t for bit in self._found[t.uid] if t.op == "point"}
            else:
                self._found[t.uid] = OPERATIONS[t.op].bits(t, *(self._found[a.uid] for a in t.args))
        return self._found[term.uid]
