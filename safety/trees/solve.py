"""Solving a fault tree: `solve(tree)` builds one decision diagram a module; its `Solution` reads every figure off."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cached_property

from safety.trees import kernel
from safety.trees.as_written import TreeError
from safety.trees.cut_sets.listing import Families
from safety.trees.flatten import flatten
from safety.trees.importance.events import Importance, measures
from safety.trees.kernel.flat import FlatGraph
from safety.trees.module_diagrams import BUDGETS, Part, Parts, TooLarge, pulse
from safety.trees.record import Record
from safety.trees.recursion import deeply
from safety.trees.tree import HALF_ULP, FaultTree

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Any, TypeVar

    from safety.trees.exact import Exact

    T = TypeVar("T", bound=Any)  # a number of any arithmetic

SMALLEST = 5e-324  # the least positive double
WIDE = 1e-13  # relative error of a chance that is carried as an interval
FAMILY_BUDGET = 40_000_000  # nodes of the diagram of cut sets
CHUNK = 2048  # samples evaluated at once, a multiple of the kernel's block


class Solution:
    """What is known of a fault tree once its diagrams are built.

    Figures are computed when first asked for, and kept.
    """

    def __init__(self, tree: FaultTree, graph: FlatGraph, parts: Sequence[Part], interpreted: bool = False) -> None:
        self.tree = tree
        self.events = tuple(event.name for event in tree.events)
        self.parts = parts  # inner modules first, the top last; event number i is events[i - 1]
        self.graph = graph  # as simplified
        self._numbers = max(graph.variables + len(graph), parts[-1].number) + 1
        self._interpreted = interpreted

    @cached_property
    def nodes(self) -> int:
        """Size of the diagrams: the number of decision nodes of all modules."""
        return sum(part.diagram.nodes - 1 for part in self.parts)

    @cached_property
    def probability(self) -> float | None:
        """Probability of the top event in doubles (see `bounds`); None if an event below the top has none."""
        return None if self._chances is None else self._chances.occurs[self.parts[-1].number]

    @cached_property
    def exact(self) -> Fraction | None:
        """The same as a rational; None unless all events below the top have one. Slow on large diagrams (`nodes`)."""
        return self._exact.probability

    @cached_property
    def bounds(self) -> tuple[float, float] | None:
        """Doubles that enclose the probability, whatever the rounding in `probability`.

        Nothing is subtracted, so relative errors add up along a path: per level half an ulp for the product, half for
        the sum, and the error of the event's own chance. An event of which only an interval is known has the chances
        of its ends: all is sums of products, which grow with every chance.
        """
        if self._chances is None:
            return None
        errors = {i: self.tree.events[i - 1].chance_error for i in self._below}
        wide = {i for i, error in errors.items() if error > WIDE}
        levels = sum(len(part.order) for part in self.parts)
        known = sum(error for i, error in errors.items() if i not in wide)
        error = math.expm1(1.01 * (levels * 2 * HALF_ULP + known))
        low = high = self._chances.occurs[self.parts[-1].number]
        if wide:
            low, high = (self._top(wide, side) for side in (0, 1))
        if self.nodes:  # what falls below the smallest doubles
            slack = 4 * (self.nodes + levels) * SMALLEST
            low, high = low - slack, high + slack
        return max(0.0, low * (1 - error)), min(1.0, high * (1 + error))

    def _top(self, wide: set[int], side: int) -> float:
        """The chance of the top where the events in `wide` have the lower (or upper) ends of theirs."""
        assert self._chances is not None
        occurs, fails = array("d", self._chances.occurs), array("d", self._chances.fails)
        for i in wide:
            low, high = self.tree.events[i - 1].enclosure
            rest = math.nextafter(1 - high, 0.0) if side == 0 else math.nextafter(1 - low, 1.0)
            occurs[i], fails[i] = (low, high)[side], rest
        self._upwards(occurs, fails)
        return occurs[self.parts[-1].number]

    @property
    def _below(self) -> list[int]:
        """The numbers of the events that the diagrams ask for."""
        return [number for part in self.parts for number in part.order if number <= len(self.events)]

    @cached_property
    def counts(self) -> tuple[int, ...]:
        """The number of minimal cut sets with 0, 1, 2, ... events.

        (1,) is a top event that needs none, () one that cannot occur. Raises TooLarge.
        """
        return self._families.counts()

    def cut_sets(self) -> Iterator[tuple[str, ...]]:
        """The minimal cut sets by increasing order, made one by one; within an order, as the diagram has them.

        Names within a set are sorted. Raises TooLarge.
        """
        for one in self._families.smallest_first():
            yield tuple(sorted([self.events[number - 1] for number in one]))

    def likeliest_cut_sets(self) -> Iterator[tuple[float, tuple[str, ...]]]:
        """The minimal cut sets by decreasing product of the probabilities of their events, each with that product.

        Those with an event of probability 0 are left out; none without probabilities. Raises TooLarge.
        """
        if self._chances is not None:
            chance = {number: self._chances.occurs[number] for part in self.parts for number in part.order}
            for product, one in self._families.likeliest_first(chance):
                yield product, tuple(sorted([self.events[number - 1] for number in one]))

    def importance(self) -> dict[str, Importance]:
        """Importance of each basic event with a probability, in doubles; empty if `probability` is None."""
        if self._chances is None:
            return {}
        top, occurs = self._chances.occurs[self.parts[-1].number], self._chances.occurs
        given = self._conditionals()
        return {
            event.name: measures(event.name, occurs[i], top, *given.get(i, (top, top, 0.0)))
            for i, event in enumerate(self.tree.events, 1)
            if not math.isnan(occurs[i])
        }

    def exact_importance(self) -> dict[str, Importance]:
        """The same in rational arithmetic; empty if `exact` is None."""
        return self._exact.importance()

    def evaluate(self, chances: Mapping[str, tuple[T, T]], zero: T, one: T) -> tuple[T, T]:
        """The chance of the top and of its opposite in any arithmetic, from those of each event; all is sums."""
        value = {i: chances[name] for i, name in enumerate(self.events, 1) if name in chances}
        for part in self.parts:
            diagram, edge = part.diagram, [one, zero]
            level, high, low = list(diagram.level), list(diagram.high), list(diagram.low)
            for i in range(1, diagram.nodes):
                yes, no = value[part.order[level[i]]]
                for side in (0, 1):
                    edge.append(yes * edge[high[i] ^ side] + no * edge[low[i] ^ side])
            value[part.number] = edge[diagram.root], edge[diagram.root ^ 1]
        return value[self.parts[-1].number]

    def many(self, columns: Any) -> array[float]:
        """The probability of the top for each of n samples of the events' probabilities.

        `columns` is a C-contiguous buffer of doubles of shape (number of events, n), rows as in `events`. Raises
        TreeError for a value outside 0..1 or a size that does not fit.
        """
        result = array("d")
        for chunk in self._chunks(columns):
            row = 2 * chunk.width * self.parts[-1].number
            result.extend(chunk.chance[row : row + chunk.samples])
        return result

    def many_derivatives(self, columns: Any) -> array[float]:
        """The derivative of the top by the probability of each event, for each sample: shape (number of events, n)."""
        total = len(_doubles(columns)) // max(1, len(self.events))
        result = array("d", bytes(8 * total * len(self.events)))
        for chunk in self._chunks(columns):
            width = chunk.width
            slope = array("d", bytes(8 * width * self._numbers))
            top = self.parts[-1].number
            slope[width * top : width * (top + 1)] = array("d", [1.0]) * width
            for part, rows in zip(reversed(self.parts), reversed(self._rows), strict=True):
                part.diagram.slopes(rows, chunk.chance, width, part.number, slope)
            for i in range(len(self.events)):
                first = width * (i + 1)
                result[i * total + chunk.first : i * total + chunk.first + chunk.samples] = slope[
                    first : first + chunk.samples
                ]
        return result

    @cached_property
    def _rows(self) -> list[array[int]]:
        return [array("i", part.order) for part in self.parts]

    def _chunks(self, columns: Any) -> Iterator[_Chunk]:
        """The probabilities of all modules, so many samples at a time."""
        diagram, values = kernel.load("diagram", self._interpreted), _doubles(columns)
        total, left = divmod(len(values), max(1, len(self.events)))
        if left:
            raise TreeError(
                f"{len(values)} probabilities were given for samples of {len(self.events)} events; give as many of each"
            )
        block = diagram.block()
        events = array("i", range(1, len(self.events) + 1))
        for first in range(0, total, CHUNK):
            count = min(CHUNK, total - first)
            width = -(-count // block) * block
            chance = array("d", bytes(16 * width * self._numbers))
            wrong = diagram.load(values, total, first, count, width, events, chance)
            if wrong:
                event, sample = wrong
                raise TreeError(
                    f'sample {sample} gives basic event "{self.events[event]}" the probability '
                    f"{values[event * total + sample]}, expected 0 to 1; correct its distribution",
                    self.events[event],
                )
            for part, rows in zip(self.parts, self._rows, strict=True):
                part.diagram.many(rows, chance, width, part.number)
            yield _Chunk(first, count, width, chance)

    @cached_property
    def _chances(self) -> _Chances | None:
        """Of events and modules by number, and of the edges of each diagram; None where an event below has none."""
        occurs = array("d", [math.nan]) * self._numbers
        fails = array("d", occurs)
        for i, event in enumerate(self.tree.events, 1):
            chance = event.chance
            if chance is not None:
                occurs[i], fails[i] = chance
        edges = self._upwards(occurs, fails)
        return None if any(math.isnan(occurs[i]) for i in self._below) else _Chances(occurs, fails, edges)

    def _upwards(self, occurs: array[float], fails: array[float]) -> list[tuple[array[float], ...]]:
        """Fill in the chances of the modules by those of the events; see `_Chances.edges`."""
        edges = []
        for part in self.parts:
            levels = [array("d", [row[number] for number in part.order]) for row in (occurs, fails)]
            edge = array("d", bytes(16 * part.diagram.nodes))
            part.diagram.chances(*levels, edge)
            occurs[part.number], fails[part.number] = edge[part.diagram.root], edge[part.diagram.root ^ 1]
            edges.append((*levels, edge))
        return edges

    def _conditionals(self) -> dict[int, tuple[float, float, float]]:
        """The chance of the top when an event or module is true, when it is false, and the difference of the two.

        From the top module inwards; both sides of an inner module are worked out, so that nothing is subtracted.
        """
        assert self._chances is not None
        given = {self.parts[-1].number: (1.0, 0.0, 1.0)}
        for part, (occurs, fails, edge) in zip(reversed(self.parts), reversed(self._chances.edges), strict=True):
            outer_true, outer_false, outer_slope = given[part.number]
            diagram, levels = part.diagram, len(part.order)
            sides = []
            for root in (diagram.root, diagram.root ^ 1):
                rows = [array("d", bytes(8 * levels)) for _ in range(3)]
                diagram.conditionals(occurs, fails, edge, root, *rows)
                sides.append(rows)
                if part is self.parts[-1]:  # its opposite counts for nothing
                    sides.append([array("d", bytes(8 * levels)) for _ in range(3)])
                    break
            (true, false, slope), (not_true, not_false, _) = sides
            for v, number in enumerate(part.order):
                given[number] = (
                    true[v] * outer_true + not_true[v] * outer_false,
                    false[v] * outer_true + not_false[v] * outer_false,
                    slope[v] * outer_slope,
                )
        return given

    @cached_property
    def _families(self) -> Families:
        families, members = kernel.load("families", self._interpreted), {}
        for part in self.parts:
            diagram = part.diagram
            family = deeply(
                len(part.order),
                lambda d=diagram: families.Family(d.level, d.high, d.low, d.root, FAMILY_BUDGET, pulse),  # type: ignore[misc]
            )
            if family.full:
                raise TooLarge(
                    f'fault tree "{self.tree.name}": the diagram of its minimal cut sets needs more than '
                    f"{FAMILY_BUDGET} nodes; ask for those up to an order or above a probability"
                )
            members[part.number] = (family, part.order)
        return Families(members, self.parts[-1].number)

    @cached_property
    def _exact(self) -> Exact:
        from safety.trees.exact import Exact

        return Exact(self.tree, self.parts)


class _Chances(Record):
    occurs: array[float]
    fails: array[float]
    edges: list[tuple[array[float], ...]]  # of each diagram: by level that the variable is true, false; of its edges


class _Chunk(Record):
    first: int
    samples: int
    width: int
    chance: array[float]


def _doubles(columns: Any) -> memoryview[float]:
    """The values of a buffer of doubles in one row."""
    view = memoryview(columns)
    if view.format != "d" or not view.c_contiguous:
        raise TreeError("samples are no C-contiguous buffer of doubles; pass numpy.ascontiguousarray(x, float)")
    return view.cast("B").cast("d")


def solve(tree: FaultTree, budgets: Sequence[int] = BUDGETS, *, interpreted: bool = False) -> Solution:
    """Build the diagrams of `tree`; `interpreted` runs the kernel without its compiled form.

    Raises TooLarge when a module fits into none of the `budgets` (nodes) under any order tried.
    """

    def work() -> Solution:
        graph = kernel.load("graph", interpreted).reduce(flatten(tree))
        return Solution(tree, graph, Parts(tree, graph, budgets, interpreted).all(), interpreted)

    return deeply(len(tree.events) + len(tree.gates), work)
