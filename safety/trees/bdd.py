"""Binary decision diagrams of one Boolean function over numbered variables, and what is read off them.

A variable is its level in the order, 0 nearest the root. A node is an index into three parallel lists; 0 and 1 are
the constants. Nodes are reduced and unique, so equal functions are the same number, and every node's number exceeds
its children's.

Sources: R. E. Bryant, "Graph-Based Algorithms for Boolean Function Manipulation", IEEE Trans. Comp. C-35 (1986); A.
Rauzy, "New Algorithms for Fault Trees Analysis", Reliability Engineering and System Safety 40 (1993).
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from typing import TypeVar

FALSE, TRUE = 0, 1
Number = TypeVar("Number", float, Fraction)
Chance = tuple[Number, Number]  # probability that a variable is true, and that it is false


class OutOfBudget(Exception):
    """The diagram grew past the number of nodes it was allowed; another order may be smaller."""


@contextmanager
def recursion_of(levels: int) -> Iterator[None]:
    """Room for a recursion that goes down one level a call; Python functions calling each other use no C stack."""
    old = sys.getrecursionlimit()
    sys.setrecursionlimit(max(old, 2 * levels + 2000))
    try:
        yield
    finally:
        sys.setrecursionlimit(old)


class Bdd:
    """A manager of nodes over `levels` variables; raises OutOfBudget when it would hold more than `budget` nodes."""

    def __init__(self, levels: int, budget: int | None = None) -> None:
        self.levels = levels
        self.budget = sys.maxsize if budget is None else budget
        self.level = [levels, levels]  # the constants lie below every variable
        self.low = [FALSE, TRUE]
        self.high = [FALSE, TRUE]
        self._unique: dict[tuple[int, int, int], int] = {}
        self._and: dict[tuple[int, int], int] = {}
        self._or: dict[tuple[int, int], int] = {}
        self._not: dict[int, int] = {FALSE: TRUE, TRUE: FALSE}

    def node(self, level: int, high: int, low: int) -> int:
        """The function `if variable then high else low`."""
        if high == low:
            return low
        key = (level, high, low)
        found = self._unique.get(key)
        if found is None:
            found = len(self.level)
            if found > self.budget:
                raise OutOfBudget(f"more than {self.budget} nodes")
            self._unique[key] = found
            self.level.append(level)
            self.high.append(high)
            self.low.append(low)
        return found

    def and_(self, f: int, g: int) -> int:
        """f and g."""
        if f in (g, FALSE) or g == TRUE:
            return f
        if g == FALSE or f == TRUE:
            return g
        key = (f, g) if f < g else (g, f)
        result = self._and.get(key)
        if result is None:
            level, (f1, f0), (g1, g0) = self._split(f, g)
            result = self._and[key] = self.node(level, self.and_(f1, g1), self.and_(f0, g0))
        return result

    def or_(self, f: int, g: int) -> int:
        """f or g."""
        if f in (g, TRUE) or g == FALSE:
            return f
        if g == TRUE or f == FALSE:
            return g
        key = (f, g) if f < g else (g, f)
        result = self._or.get(key)
        if result is None:
            level, (f1, f0), (g1, g0) = self._split(f, g)
            result = self._or[key] = self.node(level, self.or_(f1, g1), self.or_(f0, g0))
        return result

    def not_(self, f: int) -> int:
        """not f."""
        result = self._not.get(f)
        if result is None:
            result = self._not[f] = self.node(self.level[f], self.not_(self.high[f]), self.not_(self.low[f]))
        return result

    def _split(self, f: int, g: int) -> tuple[int, tuple[int, int], tuple[int, int]]:
        """The upper of the two levels, and both functions with that variable true and false."""
        f_level, g_level = self.level[f], self.level[g]
        level = min(f_level, g_level)
        return (
            level,
            (self.high[f], self.low[f]) if f_level == level else (f, f),
            (self.high[g], self.low[g]) if g_level == level else (g, g),
        )

    def gate(self, kind: str, inputs: Sequence[int], k: int | None = None) -> int:
        """The function of a gate (`kind` and `k` as in `tree.Gate`) over the functions of its inputs."""
        deepest_first = sorted(
            inputs, key=lambda f: -self.level[f]
        )  # grows the result upwards: the smallest intermediate diagrams
        match kind:
            case "and" | "or":
                result, combine = (TRUE, self.and_) if kind == "and" else (FALSE, self.or_)
                for f in deepest_first:
                    result = combine(result, f)
                return result
            case "vote":
                assert k is not None
                at_least = [TRUE] + [FALSE] * k
                for f in deepest_first:
                    for count in range(k, 0, -1):
                        at_least[count] = self.or_(at_least[count], self.and_(f, at_least[count - 1]))
                return at_least[k]
            case "not":
                return self.not_(inputs[0])
            case "xor":
                odd = FALSE
                for f in deepest_first:
                    odd = self.or_(self.and_(odd, self.not_(f)), self.and_(self.not_(odd), f))
                return odd
        raise ValueError(f"gate kind {kind!r}, expected one of tree.KINDS")

    def below(self, root: int) -> list[int]:
        """The nodes of `root` without the constants, each after its children."""
        seen, agenda = {FALSE, TRUE}, [root]
        while agenda:
            node = agenda.pop()
            if node not in seen:
                seen.add(node)
                agenda += (self.high[node], self.low[node])
        return sorted(seen - {FALSE, TRUE})

    def chances(
        self, root: int, variables: Sequence[Chance[Number]], zero: Number, one: Number
    ) -> dict[int, Chance[Number]]:
        """Probability that each node below `root` is true and that it is false, by Shannon's expansion.

        `variables[level]` are the chances of the variables; `zero` and `one` fix the arithmetic (Fraction: exact).
        Nothing is ever subtracted, so in doubles both are accurate to a few ulp per level.
        """
        chances = {FALSE: (zero, one), TRUE: (one, zero)}
        for node in self.below(root):
            yes, no = variables[self.level[node]]
            high, low = chances[self.high[node]], chances[self.low[node]]
            chances[node] = yes * high[0] + no * low[0], yes * high[1] + no * low[1]
        return chances
