"""Minimal cut sets up to an order, or above a probability, of a coherent tree, without a diagram of its top event.

What is found is exact: every minimal cut set within the limits, and no other. It bounds the probability from below.
"""

from __future__ import annotations

import itertools
from array import array
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from safety.trees import kernel
from safety.trees.as_written import TreeError
from safety.trees.cut_sets.listing import EMPTY, Families
from safety.trees.flatten import flatten
from safety.trees.kernel.flat import AND, OR, FlatGraph
from safety.trees.module_diagrams import TooLarge
from safety.trees.recursion import deeply
from safety.trees.solve import FAMILY_BUDGET, Solution
from safety.trees.tree import HALF_ULP, FaultTree

BUDGET = 8_000_000  # nodes of all families, about 0.5 GB
STEP_BUDGET = 2_000_000  # of those of an order that is tried unasked
UNION_BUDGET = 200_000  # nodes of the diagram of the sets found
LIKELIEST = (10_000, 1000, 100, 10, 1)  # sets whose union is tried where that of all does not fit
FINE = 100  # weights by factor of ten: how finely products of chances are told apart from below
SAME = 1e-12  # a product that equals the limit but for rounding is within it


class Truncated(NamedTuple):
    """The minimal cut sets of `tree` with at most `order` events and a product of chances of `above` or more.

    `complete` tells that nothing was beyond the limits: there are no other ones.
    """

    tree: FaultTree
    order: int | None
    above: float | None
    complete: bool
    families: Families

    @property
    def counts(self) -> tuple[int, ...]:
        """The number of sets found with 0, 1, 2, ... events; exact up to `order` where `above` is None."""
        return self.families.counts()

    def cut_sets(self) -> Iterator[tuple[str, ...]]:
        """The sets found, by increasing order; names within a set are sorted."""
        for one in self.families.smallest_first():
            yield self._names(one)

    def likeliest_cut_sets(self) -> Iterator[tuple[float, tuple[str, ...]]]:
        """The sets found by decreasing product of the chances of their events; none where an event has no chance."""
        chance = self._chances()
        if chance is not None:
            for product, one in self.families.likeliest_first(chance):
                yield product, self._names(one)

    def sum(self) -> float | None:
        """The sum of the products of chances of the sets found, in doubles; None where an event has no chance."""
        chance = self._chances()
        if chance is None:
            return None
        family, variables = self.families.members[self.families.top]
        total: list[float] = [0.0, 1.0]
        for i in range(2, family.count):
            level, high, low, _ = family.node[4 * i : 4 * i + 4]
            total.append(chance[variables[level]] * total[high] + total[low])
        result: float = total[family.root]
        return result

    def lower(self) -> float | None:
        """A certified lower bound of the probability of the top event: that of the union of sets found.

        Of all of them where their diagram fits into UNION_BUDGET nodes, else of the likeliest. Rounding is inside.
        None where an event has no chance.
        """
        chance = self._chances()
        if chance is None:
            return None
        family, variables = self.families.members[self.families.top]
        found = _chance(_graph(family), variables, self.tree)
        for many in () if found is not None else LIKELIEST:
            sets = list(itertools.islice(self.families.likeliest_first(chance), many))
            found = _chance(_graph_of([one for _, one in sets], variables), variables, self.tree)
            if found is not None:
                break
        return found or 0.0

    def _names(self, numbers: Sequence[int]) -> tuple[str, ...]:
        return tuple(sorted([self.tree.events[number - 1].name for number in numbers]))

    def _chances(self) -> dict[int, float] | None:
        _, variables = self.families.members[self.families.top]
        chance = {number: known[0] for number in variables if (known := self.tree.events[number - 1].chance)}
        return chance if len(chance) == len(variables) else None


def truncated(
    tree: FaultTree,
    order: int | None = None,
    above: float | None = None,
    budget: int = BUDGET,
    *,
    interpreted: bool = False,
) -> Truncated:
    """All minimal cut sets of `tree` with at most `order` events, and a product of chances of `above` or more.

    Raises TreeError where the tree has not or xor below its top (a part of one of its cut sets within the limits may be
    beyond them), where `above` is asked for and an event has no chance, and for limits that make no sense; TooLarge
    when more than `budget` nodes are needed.
    """
    _check(order, above)

    def work() -> Truncated:
        graph = kernel.load("graph", interpreted).reduce(flatten(tree))
        return _Search(tree, graph, interpreted).found(order, above, budget)

    return deeply(4 * (len(tree.events) + len(tree.gates)), work)


def largest_order(tree: FaultTree, budget: int = STEP_BUDGET) -> Truncated | None:
    """The minimal cut sets up to the largest order that needs no more than `budget` nodes.

    None where not even order 1 does; raises TreeError as `truncated`.
    """
    found: Truncated | None = None

    def work() -> Truncated | None:
        nonlocal found
        search = _Search(tree, kernel.load("graph").reduce(flatten(tree)), False)
        for order in range(1, len(tree.events) + 1):
            try:
                found = search.found(order, None, budget)
            except TooLarge:
                break
            if found.complete:
                break
        return found

    return deeply(4 * (len(tree.events) + len(tree.gates)), work)


class OfDiagram(NamedTuple):
    """The same of a tree that is solved, coherent or not: out of the diagrams of all its cut sets."""

    solution: Solution
    order: int | None
    above: float | None

    @property
    def tree(self) -> FaultTree:
        """The tree that was solved."""
        return self.solution.tree

    @property
    def complete(self) -> bool:
        """Whether there are no other cut sets."""
        return self.counts == self.solution.counts

    @property
    def counts(self) -> tuple[int, ...]:
        """As of Truncated; above a probability the sets are made one by one."""
        if self.above is None:
            most = len(self.tree.events) if self.order is None else self.order
            counts = list(self.solution.counts[: most + 1])
        else:
            sizes = [len(one) for _, one in self.likeliest_cut_sets()]
            counts = [sizes.count(order) for order in range(max(sizes, default=-1) + 1)]
        while counts and not counts[-1]:
            counts.pop()
        return tuple(counts)

    def cut_sets(self) -> Iterator[tuple[str, ...]]:
        """As of Truncated."""
        if self.above is None:
            return itertools.takewhile(self._short, self.solution.cut_sets())
        return iter(sorted((one for _, one in self.likeliest_cut_sets()), key=lambda one: (len(one), one)))

    def likeliest_cut_sets(self) -> Iterator[tuple[float, tuple[str, ...]]]:
        """As of Truncated."""
        least = 0.0 if self.above is None else self.above * (1 - SAME)
        likely = itertools.takewhile(lambda found: found[0] >= least, self.solution.likeliest_cut_sets())
        return (found for found in likely if self._short(found[1]))

    def _short(self, one: tuple[str, ...]) -> bool:
        return self.order is None or len(one) <= self.order


def limited(solution: Solution, order: int | None, above: float | None) -> Truncated | OfDiagram:
    """The minimal cut sets of a solved tree within the limits, whichever way they are to be had.

    Raises TreeError as `truncated`, but for a tree that is not coherent; TooLarge.
    """
    tree = solution.tree
    _check(order, above)
    if not tree.is_monotone:
        if above is not None:
            _chances_of(tree, [n for part in solution.parts for n in part.order if n <= len(tree.events)])
        return OfDiagram(solution, order, above)
    try:
        return truncated(tree, order, above)
    except TooLarge:
        return OfDiagram(solution, order, above)


def _check(order: int | None, above: float | None) -> None:
    if order is not None and order < 0:
        raise TreeError(f"order {order} of cut sets, expected 0 or more")
    if above is not None and not 0 < above <= 1:
        raise TreeError(f"probability {above} of cut sets, expected above 0 and up to 1")


def _chances_of(tree: FaultTree, numbers: Sequence[int]) -> array[float]:
    """The chances of these events; raises TreeError where one has none."""
    chances = array("d")
    for number in numbers:
        event = tree.events[number - 1]
        if event.chance is None:
            raise TreeError(
                f'basic event "{event.name}" has no probability, so cut sets above one cannot be told; give it one',
                event.name,
            )
        chances.append(event.chance[0])
    return chances


class _Search:
    """A coherent graph, its gates and its variables in the order of the levels."""

    def __init__(self, tree: FaultTree, graph: FlatGraph, interpreted: bool) -> None:
        self.tree, self.graph, self.interpreted = tree, graph, interpreted
        self.gates, self.order = array("i"), array("i")
        top = graph.root >> 1
        if top > graph.variables:
            _, coherent = kernel.load("modules", interpreted).modules(graph, False)
            if not coherent[-1] or graph.root & 1:
                self._refuse()
            none = bytearray(graph.variables + len(graph) + 1)
            self.gates, _ = kernel.load("members", interpreted).members(graph, top, none)
            self.order = next(iter(kernel.load("orders", interpreted).orders(graph, top, none)))
        elif top:
            if graph.root & 1:
                self._refuse()
            self.order = array("i", [top])

    def _refuse(self) -> None:
        raise TreeError(
            f'fault tree "{self.tree.name}" is not coherent (not, xor): its cut sets cannot be cut off gate by gate; '
            "ask for all of them, or pass larger budgets to solve()"
        )

    def found(self, order: int | None, above: float | None, budget: int) -> Truncated:
        chances, weight, heaviest = array("d"), array("i", bytes(4 * len(self.order))), 0
        if above is not None:
            chances = _chances_of(self.tree, self.order)
            weight, heaviest = _weights(chances, above)
        most = len(self.order) if order is None else order
        table = kernel.load("truncated", self.interpreted).Truncating(weight, budget)
        family_of = array("i", bytes(4 * (self.graph.variables + len(self.graph) + 1)))
        for level, number in enumerate(self.order):
            family_of[number] = table.event(level, most, heaviest)
        family_of[0] = EMPTY
        root = family_of[self.graph.root >> 1] if self.graph.root != 1 else 0
        if self.gates:
            root = table.build(self.graph, self.gates, family_of, most, heaviest)
        if above is not None and root >= 0:
            root = table.above(root, chances, above * (1 - SAME))
        families = kernel.load("families", self.interpreted)
        family = None if root < 0 else families.Family(*table.finish(root), FAMILY_BUDGET)
        if family is None or family.full:
            limits = [f"order {order}"] * (order is not None) + [f"probability {above}"] * (above is not None)
            raise TooLarge(
                f'fault tree "{self.tree.name}": its minimal cut sets within {" and ".join(limits) or "no limit"} need '
                f"more than {budget} nodes; ask for a lower order or a higher probability"
            )
        number = self.graph.variables + len(self.graph) + 1
        return Truncated(self.tree, order, above, not table.cut, Families({number: (family, self.order)}, number))


def _weights(chance: Sequence[float], above: float) -> tuple[array[int], int]:
    """Whole weights, rounded down, and their limit, rounded up: no set whose product is `above` or more exceeds it."""
    from math import ceil, floor, log10

    limit = ceil(-FINE * log10(above)) + 1
    return array("i", [floor(min(-FINE * log10(q), limit + 1)) if q > 0 else limit + 1 for q in chance]), limit


def _graph(family: Any) -> FlatGraph:
    """The union of the sets of a family as gates over its levels, two a node."""
    variables = family.node[0]
    literal = [1, 0]
    gates: list[tuple[int, int, list[int]]] = []
    for i in range(2, family.count):
        level, high, low, _ = family.node[4 * i : 4 * i + 4]
        both = 2 * (variables + 1 + len(gates))
        gates += [(AND, 0, [2 * (level + 1), literal[high]]), (OR, 0, [both, literal[low]])]
        literal.append(both + 2)
    return FlatGraph.of(variables, gates, literal[family.root])


def _graph_of(sets: Sequence[Sequence[int]], variables: Sequence[int]) -> FlatGraph:
    """The union of listed sets, as gates over the levels of their variables."""
    level = {number: i for i, number in enumerate(variables, 1)}
    gates: list[tuple[int, int, list[int]]] = [(AND, 0, [2 * level[number] for number in one]) for one in sets]
    first = 2 * (len(variables) + 1)
    gates.append((OR, 0, list(range(first, first + 2 * len(sets), 2))))
    return FlatGraph.of(len(variables), gates, first + 2 * len(sets))


def _chance(graph: FlatGraph, variables: Sequence[int], tree: FaultTree) -> float | None:
    """The probability of the function of a graph over levels, rounded down; None where its diagram is too large."""
    builder = kernel.load("builder").Builder(graph.variables, UNION_BUDGET)
    edge_of = array("i", [0]) * (graph.variables + len(graph) + 1)
    for level in range(graph.variables):
        edge_of[level + 1] = builder.variable(level)
        if edge_of[level + 1] < 0:
            return None
    root = graph.root if graph.root < 2 else -1
    if root < 0:
        gates = array("i", range(graph.variables + 1, graph.variables + 1 + len(graph)))
        root = builder.build(graph, gates, edge_of)
        if root < 0:
            return None
    diagram = kernel.load("diagram").Diagram(*builder.finish(root))
    occurs = _chances_of(tree, variables)
    fails = array("d", [known[1] for n in variables if (known := tree.events[n - 1].chance)])
    edge = array("d", bytes(16 * diagram.nodes))
    diagram.chances(occurs, fails, edge)
    widest = max((tree.events[n - 1].chance_error for n in variables), default=0.0)
    probability: float = edge[diagram.root]
    return max(0.0, probability * (1 - 1.01 * (2 * HALF_ULP + widest) * len(variables)))
