"""Gates gathered into functions of up to three bits, each one instruction of a processor that has them.

A node's cuts are the sets of at most three nodes that it is a function of; the cheapest cut is chosen by what it and
what it reads cost, shared by all that read it (area flow, as in the mapping of look-up tables).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

from safety.terms.graph import Term, postorder

COLUMNS = (0xF0, 0xCC, 0xAA)  # the inputs of a table of three, first to last
MOST_CUTS = 6

Cut = tuple[Term, ...]


@dataclass(frozen=True)
class Function:
    """A bit as a function of others; `table` gives its value for each of theirs, 8 bits."""

    term: Term
    inputs: Cut

    @cached_property
    def table(self) -> int:
        """Bit `4a + 2b + c` is the value where the inputs are a, b and c; those that are not there do not matter."""
        values = {x.uid: column for x, column in zip(self.inputs, COLUMNS, strict=False)}
        for t in postorder([self.term], set(values)):
            args = [values[a.uid] for a in t.args]
            values[t.uid] = -int(t.attr) & 255 if t.is_const else GATES[t.op](*args) & 255
        return values[self.term.uid]


GATES: dict[str, Callable[..., int]] = {
    "not": lambda x: ~x,
    "and": lambda x, y: x & y,
    "or": lambda x, y: x | y,
    "xor": lambda x, y: x ^ y,
    "select": lambda c, x, y: c & x | ~c & y,
}


def cover(roots: Iterable[Term]) -> dict[int, Function]:
    """Functions for the gates that are worth one, by uid, the roots among them; the others are within these."""
    roots = list(roots)
    order = postorder(roots)
    readers = Counter(a.uid for t in order for a in t.args)
    readers.update(r.uid for r in roots)
    cuts: dict[int, list[Cut]] = {}
    flow: dict[int, float] = {}
    for t in order:
        cuts[t.uid] = _cuts(t, cuts, flow)
        flow[t.uid] = (1 + _cost(cuts[t.uid][0], flow)) / readers[t.uid] if t.args else 0.0
    chosen: dict[int, Function] = {}
    wanted = list(roots)
    while wanted:
        t = wanted.pop()
        if t.args and t.uid not in chosen:
            chosen[t.uid] = Function(t, cuts[t.uid][0])
            wanted += chosen[t.uid].inputs
    return chosen


def _cost(cut: Cut, flow: Mapping[int, float]) -> float:
    return sum(flow[v.uid] for v in cut)


def _cuts(t: Term, cuts: Mapping[int, list[Cut]], flow: Mapping[int, float]) -> list[Cut]:
    """The cheapest cuts of a term, the best first; it has one of each of its arguments, or that itself, in each."""
    found: list[Cut] = [()]
    for a in t.args:
        wider: dict[frozenset[int], Cut] = {}
        for x in found:
            for y in ((a,), *cuts[a.uid]):
                both = {v.uid: v for v in (*x, *y)}
                if len(both) <= len(COLUMNS):
                    wider[frozenset(both)] = tuple(both.values())
        found = list(wider.values())
    return sorted(found, key=lambda cut: _cost(cut, flow))[:MOST_CUTS] if t.args else []
