"""Minimal cut sets as a zero-suppressed decision diagram: counted by order and listed without ever holding them all.

A minimal cut set is a smallest set of basic events whose occurrence alone, all others absent, makes the top event
occur. For a tree with not or xor these are the minimal positive parts of its prime implicants ("minimal p-cuts").

Source: A. Rauzy, "New Algorithms for Fault Trees Analysis", Reliability Engineering and System Safety 40 (1993),
minimal solutions.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Optional

from safety.trees.bdd import FALSE, TRUE, Bdd

NONE, EMPTY = FALSE, TRUE  # the family without a set, and the family of just the empty set
Counts = tuple[int, ...]  # how many sets there are with 0, 1, 2, ... events; no zero at the end
_Todo = tuple[str, int, int, Optional["_Todo"]]  # module, node, number of events, what comes after


class CutSets:
    """The minimal solutions of one BDD function.

    A node stands for the sets of `low`, and those of `high` each with its variable.
    """

    def __init__(self, bdd: Bdd, root: int) -> None:
        self.level = [bdd.levels, bdd.levels]
        self.low = [NONE, EMPTY]
        self.high = [NONE, EMPTY]
        self._unique: dict[tuple[int, int, int], int] = {}
        self._without: dict[tuple[int, int], int] = {}
        self._minimal = {FALSE: NONE, TRUE: EMPTY}
        self.root = self._minimal_solutions(bdd, root)

    def _node(self, level: int, high: int, low: int) -> int:
        if high == NONE:
            return low
        key = (level, high, low)
        found = self._unique.get(key)
        if found is None:
            found = self._unique[key] = len(self.level)
            self.level.append(level)
            self.high.append(high)
            self.low.append(low)
        return found

    def _minimal_solutions(self, bdd: Bdd, f: int) -> int:
        result = self._minimal.get(f)
        if result is None:
            absent = self._minimal_solutions(bdd, bdd.low[f])
            present = self._minimal_solutions(bdd, bdd.high[f])
            result = self._minimal[f] = self._node(bdd.level[f], self.without(present, absent), absent)
        return result

    def without(self, sets: int, smaller: int) -> int:
        """The sets of `sets` that contain no set of `smaller`."""
        if smaller == NONE or sets == NONE:
            return sets
        if smaller == EMPTY or sets == smaller:
            return NONE
        if sets == EMPTY:
            return NONE if self._has_empty(smaller) else EMPTY
        key = (sets, smaller)
        result = self._without.get(key)
        if result is None:
            level, other = self.level[sets], self.level[smaller]
            if level > other:
                result = self.without(sets, self.low[smaller])
            elif level < other:
                result = self._node(
                    level, self.without(self.high[sets], smaller), self.without(self.low[sets], smaller)
                )
            else:
                high = self.without(self.without(self.high[sets], self.high[smaller]), self.low[smaller])
                result = self._node(level, high, self.without(self.low[sets], self.low[smaller]))
            self._without[key] = result
        return result

    def _has_empty(self, sets: int) -> bool:
        while sets > EMPTY:
            sets = self.low[sets]
        return sets == EMPTY

    def counts(self, variables: Sequence[Counts]) -> list[Counts]:
        """For every node, the number of sets by order; the counts of an event as a variable are (0, 1)."""
        counts: list[Counts] = [(), (1,)]
        for node in range(2, len(self.level)):
            high = _product(variables[self.level[node]], counts[self.high[node]])
            counts.append(_sum(high, counts[self.low[node]]))
        return counts


def _sum(a: Counts, b: Counts) -> Counts:
    if len(a) < len(b):
        a, b = b, a
    return tuple(x + y for x, y in zip(a, b, strict=False)) + a[len(b) :]


def _product(a: Counts, b: Counts) -> Counts:
    if a == (0, 1):
        return (0, *b) if b else b
    result = [0] * (len(a) + len(b) - 1 if a and b else 0)
    for i, x in enumerate(a):
        if x:
            for j, y in enumerate(b):
                result[i + j] += x * y
    return tuple(result)


@dataclass(frozen=True)
class Family:
    """The minimal cut sets of one module: the diagram, what its variables are, and the counts of every node."""

    sets: CutSets
    variables: tuple[str, ...]  # basic events, and modules that are families themselves
    counts: list[Counts]


def smallest_first(families: Mapping[str, Family], top: str) -> Iterator[tuple[str, ...]]:
    """The minimal cut sets of the module `top` in basic events, by increasing order; the names of each are sorted.

    No branch is entered that does not end in a cut set, so the first sets cost little however many there are.
    """
    whole = families[top]
    for order in range(len(whole.counts[whole.sets.root])):
        yield from _of_order(families, top, order)


def _of_order(families: Mapping[str, Family], top: str, order: int) -> Iterator[tuple[str, ...]]:
    """The search state: a chain of nodes to resolve, each with the events it must add, and the events chosen."""
    agenda: list[tuple[_Todo | None, tuple[str, ...]]] = [((top, families[top].sets.root, order, None), ())]
    while agenda:
        todo, chosen = agenda.pop()
        if todo is None:
            yield tuple(sorted(chosen))
            continue
        module, node, events, rest = todo
        family = families[module]
        if events >= len(family.counts[node]) or not family.counts[node][events]:
            continue
        if node == EMPTY:
            agenda.append((rest, chosen))
            continue
        low, high = family.sets.low[node], family.sets.high[node]
        name = family.variables[family.sets.level[node]]
        agenda.append(((module, low, events, rest), chosen))
        if name not in families:
            if events:
                agenda.append(((module, high, events - 1, rest), (*chosen, name)))
            continue
        inner = families[name]
        for inside in range(min(events, len(inner.counts[inner.sets.root]) - 1) + 1):
            outside = (module, high, events - inside, rest)
            if events - inside < len(family.counts[high]) and family.counts[high][events - inside]:
                agenda.append(((name, inner.sets.root, inside, outside), chosen))
