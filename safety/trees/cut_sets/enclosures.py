"""Certified bounds of the probability of a tree of which no diagram fits: what was left out is inside the bounds.

Modules that fit are exact. Of each other one there are a function that implies it and one that it implies (see
`kernel/enclosure.py`), and they are brought nearer round by round: what is kept is what matters where the two differ.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from typing import Any, NamedTuple

from safety.trees import kernel
from safety.trees.flatten import flatten
from safety.trees.kernel.flat import AND, OR, XOR, FlatGraph
from safety.trees.module_diagrams import Part, Parts, TooLarge
from safety.trees.recursion import deeply
from safety.trees.tree import HALF_ULP, FaultTree

BUDGETS = (20_000, 200_000)  # nodes of a module's diagram, every order tried with each, before it is left open
KEEP = (300, 300, 300, 1000, 1000, 1000, 3000, 3000)  # nodes of a gate's functions in the rounds
ROOM = 1 << 21  # nodes of an open module in all, about 200 MB; small ones get less


class Enclosed(NamedTuple):
    """The probability of the top event lies between `lower` and `upper`, rounding included.

    `open_modules` are those without a diagram of their own, brought nearer in `rounds`; without any, the two differ by
    rounding alone.
    """

    lower: float
    upper: float
    open_modules: int
    rounds: int


class _Open(NamedTuple):
    number: int
    order: Sequence[int]
    gates: Sequence[int]
    enclosure: Any
    seen: list[array[float]]  # by round, what was a measure of the variables


def enclose(
    tree: FaultTree, enough: float = 1.01, budgets: Sequence[int] = BUDGETS, *, interpreted: bool = False
) -> Enclosed | None:
    """Bounds of the probability of the top event of `tree`, a ratio of `enough` apart where the rounds suffice.

    They are the same on every run. None if an event below the top has no probability.
    """

    def work() -> Enclosed | None:
        graph = kernel.load("graph", interpreted).reduce(flatten(tree))
        return _Enclosing(tree, graph, budgets, interpreted).bounds(enough)

    return deeply(len(tree.events) + len(tree.gates), work)


class _Enclosing:
    def __init__(self, tree: FaultTree, graph: FlatGraph, budgets: Sequence[int], interpreted: bool) -> None:
        self.tree, self.graph, self.budgets = tree, without_xor(graph), budgets
        self.parts = Parts(tree, self.graph, budgets, interpreted)
        self.kernel = kernel.load("enclosure", interpreted)
        self.top = self.graph.root >> 1
        self.flip = self.graph.root & 1
        self.modules: list[Part | _Open] = []
        self.monotone = True

    def bounds(self, enough: float) -> Enclosed | None:
        if self.top <= self.graph.variables:
            self.modules = [self.parts.literal(self.graph.root)]
        else:
            self._split()
        lower, upper = array("d", bytes(16 * (self.parts.numbers + 1))), array("d")
        error = 0.0
        for number in {n for module in self.modules for n in module.order if n <= self.graph.variables}:
            event = self.tree.events[number - 1]
            if event.chance is None:
                return None
            lower[2 * number : 2 * number + 2] = array("d", event.chance)
            error = max(error, event.chance_error)
        upper.extend(lower)
        error = 1.01 * (2 * HALF_ULP + error) * sum(len(module.order) for module in self.modules)
        unknown = [module for module in self.modules if isinstance(module, _Open)]
        rounds = 0
        for keep in KEEP if unknown else (0,):
            for module in self.modules:
                if isinstance(module, _Open):
                    self._round(module, upper, keep)
                for side, chances in enumerate((lower, upper)):
                    self._evaluate(module, side, chances)
            rounds += bool(unknown)
            last = 2 * self.modules[-1].number
            if upper[last] <= enough * lower[last]:
                break
        return Enclosed(max(0.0, lower[last] * (1 - error)), min(1.0, upper[last] * (1 + error)), len(unknown), rounds)

    def _split(self) -> None:
        """The modules, inner ones first. A top that is not monotone takes in those that are not exact."""
        numbers, plain = self.parts.modules.modules(self.graph, True)
        is_module = bytearray(self.parts.numbers)
        unknown: set[int] = set()
        for number, monotone in zip(numbers, plain, strict=True):
            if not monotone:
                self.monotone = False
                self.modules = [module for module in self.modules if module.number not in unknown]
                for inner in unknown:
                    is_module[inner] = 0
            is_module[number] = 1
            try:
                part = self.parts.module(number, is_module, self.flip if number == self.top else 0)
            except TooLarge:
                self.modules.append(self._opened(number, is_module))
                unknown.add(number)
                continue
            if part.diagram.root < 2:
                self.parts.constants[number] = part.diagram.root
            self.modules.append(part)
            if unknown.intersection(part.order):
                unknown.add(number)

    def _opened(self, number: int, is_module: bytearray) -> _Open:
        gates, _ = self.parts.members.members(self.graph, number, is_module)
        order = next(iter(self.parts.orders.orders(self.graph, number, is_module)))
        monotone = self.monotone or number != self.top
        room = min(ROOM, max(1 << 12, 64 * len(order) * len(gates)))
        return _Open(number, order, gates, self.kernel.Enclosure(len(order), monotone, room), [])

    def _round(self, module: _Open, chances: array[float], keep: int) -> None:
        """One more round: what was left out so far, and the variables' own chances, say what is to be kept."""
        own = array("d", [chances[2 * number] for number in module.order])
        seen = module.seen
        if not seen:
            seen.append(own)
        else:
            (mass, joint), (less, part) = (self._joint(module, side, chances) for side in (1, 0))
            gap = mass - less
            if gap <= 0:
                return
            seen.append(array("d", [min(1.0, max(0.0, (j - p) / gap)) for j, p in zip(joint, part, strict=True)]))
        measure = array("d", [sum(column) / len(seen) for column in zip(*seen, strict=True)])
        module.enclosure.round(self.graph, module.gates, module.order, measure, keep)

    def _joint(self, module: _Open, side: int, chances: array[float]) -> tuple[float, list[float]]:
        """The chance of one of its functions, and by level that of function and variable together."""
        diagram = self.parts.diagrams.Diagram(*module.enclosure.function(side))
        occurs, fails, edge = self._levels(module, diagram, chances)
        given, *others = (array("d", bytes(8 * len(occurs))) for _ in range(3))
        diagram.conditionals(occurs, fails, edge, diagram.root, given, *others)
        return edge[diagram.root], [o * g for o, g in zip(occurs, given, strict=True)]

    def _evaluate(self, module: Part | _Open, side: int, chances: array[float]) -> None:
        """Enter the chance that the module's function on that side is true, and that it is not."""
        if isinstance(module, Part):
            diagram, root = module.diagram, module.diagram.root
        else:
            flip = self.flip if module.number == self.top else 0
            diagram = self.parts.diagrams.Diagram(*module.enclosure.function(side ^ flip))
            root = diagram.root ^ flip
        _, _, edge = self._levels(module, diagram, chances)
        chances[2 * module.number], chances[2 * module.number + 1] = edge[root], edge[root ^ 1]

    def _levels(
        self, module: Part | _Open, diagram: Any, chances: array[float]
    ) -> tuple[array[float], array[float], array[float]]:
        occurs = array("d", [chances[2 * number] for number in module.order])
        fails = array("d", [chances[2 * number + 1] for number in module.order])
        edge = array("d", bytes(16 * diagram.nodes))
        diagram.chances(occurs, fails, edge)
        return occurs, fails, edge


def without_xor(graph: FlatGraph) -> FlatGraph:
    """The same function with every exclusive or written with ands and ors."""
    if XOR not in graph.kind:
        return graph
    gates: list[tuple[int, int, list[int]]] = []
    literal = list(range(0, 2 * (graph.variables + 1), 2))
    for index in range(graph.variables + 1, graph.variables + 1 + len(graph)):
        kind, k, inputs = graph.gate(index)
        inputs = [literal[i >> 1] ^ (i & 1) for i in inputs]
        if kind == XOR:
            odd = inputs[0]
            for other in inputs[1:]:
                both = 2 * (graph.variables + 1 + len(gates))
                gates += [(AND, 0, [odd, other ^ 1]), (AND, 0, [odd ^ 1, other]), (OR, 0, [both, both + 2])]
                odd = both + 4
            literal.append(odd)
        else:
            literal.append(2 * (graph.variables + 1 + len(gates)))
            gates.append((kind, k, inputs))
    return FlatGraph.of(graph.variables, gates, literal[graph.root >> 1] ^ (graph.root & 1))
