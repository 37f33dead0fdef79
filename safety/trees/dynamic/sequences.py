"""Minimal cut sequences: which events, failing in which order and no others, make the top of a dynamic tree fail."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

from safety.trees.dynamic.states import States, explore
from safety.trees.dynamic.tree import DynamicTree
from safety.trees.module_diagrams import TooLarge

LONGEST = 4  # events
MOST = 200_000  # orders looked at
BUDGET = 50_000  # states


@dataclass(frozen=True)
class CutSequences:
    """Events that suffice in each of `orders`, and in no part of it; those that follow from a trigger are not named."""

    events: tuple[str, ...]
    orders: tuple[tuple[str, ...], ...]

    @property
    def any_order(self) -> bool:
        """Whether every order suffices: the events are a minimal cut set as in a static tree."""
        return len(self.orders) == math.factorial(len(self.events))


def cut_sequences(tree: DynamicTree, longest: int = LONGEST, budget: int = BUDGET) -> list[CutSequences]:
    """All minimal cut sequences of `tree` of up to `longest` events, by size and name.

    A dependency with a probability may act or not, and an event with a fixed probability may be there or not: what
    suffices together with them is listed, without them. Where simultaneous failures tie, they follow in the order
    written. Raises TooLarge above `budget` states or MOST orders.
    """
    found: set[tuple[str, ...]] = set()
    for order in _orders(explore(tree, ties="as written", budget=budget), longest):
        if not any(part in found for size in range(len(order)) for part in combinations(order, size)):
            found.add(order)
    by_events: dict[tuple[str, ...], list[tuple[str, ...]]] = defaultdict(list)
    for order in found:
        by_events[tuple(sorted(order))].append(order)
    rows = [CutSequences(events, tuple(sorted(orders))) for events, orders in by_events.items()]
    return sorted(rows, key=lambda row: (len(row.events), row.events))


def _orders(states: States, longest: int) -> Iterator[tuple[str, ...]]:
    """Orders of failures that lead from the start to the failure of the top, the shortest first."""
    names = [event.name for event in states.tree.events]
    out: dict[int, dict[str, set[int]]] = defaultdict(lambda: defaultdict(set))
    for source, target, cause in zip(
        states.source.tolist(), states.target.tolist(), states.cause.tolist(), strict=True
    ):
        out[source][names[states.causes[cause].event]].add(target)
    reached: dict[tuple[str, ...], frozenset[int]] = {(): frozenset(states.start)}
    seen = 0
    for _ in range(longest + 1):
        onward: dict[tuple[str, ...], set[int]] = defaultdict(set)
        for order, places in reached.items():
            if states.failed in places:
                yield order
                continue
            for place in places:
                for name, targets in out[place].items():
                    onward[*order, name] |= targets
        seen += len(onward)
        if seen > MOST:
            raise TooLarge(
                f'dynamic tree "{states.tree.name}" has more than {MOST} orders of up to {longest} failures; ask for '
                "shorter sequences"
            )
        reached = {order: frozenset(places) for order, places in onward.items()}
