"""The decision diagrams of the modules of a graph, each under the best order that was found within the budgets."""

from __future__ import annotations

import itertools
from array import array
from collections.abc import Iterable, Sequence

from safety.trees import kernel
from safety.trees.kernel.flat import FlatGraph
from safety.trees.record import Record
from safety.trees.tree import FaultTree

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Any

BUDGETS = (20_000, 200_000, 2_000_000, 25_000_000)  # nodes; orders are tried with each before the next
KEPT = (None, None, 6, 2)  # orders tried with each budget: those that got furthest with the one before, and the first


class TooLarge(RuntimeError):
    """No order kept a diagram within the largest budget; the tree has no result, not even an approximate one."""

    exit_code = 3


def pulse() -> None:
    """Called by compiled code now and then: on the way here the interpreter looks at signals."""


class Part(Record):
    """One module: its number, the numbers of its variables by level (events, inner modules), and its diagram."""

    number: int
    order: Sequence[int]
    diagram: Any


class Parts:
    """The diagrams of the modules of one graph, inner ones first."""

    def __init__(self, tree: FaultTree, graph: FlatGraph, budgets: Sequence[int], interpreted: bool) -> None:
        self.tree, self.graph, self.budgets, self.interpreted = tree, graph, budgets, interpreted
        self.modules, self.members, self.orders, self.builder, self.diagrams = (
            kernel.load(name, interpreted) for name in ("modules", "members", "orders", "builder", "diagram")
        )
        self.numbers = graph.variables + len(graph) + 1
        self.constants: dict[int, int] = {0: 0}

    def all(self) -> list[Part]:
        """One for each module, inner ones first, the top last. Raises TooLarge."""
        top = self.graph.root >> 1
        if top <= self.graph.variables:
            return [self.literal(self.graph.root)]
        modules, _ = self.modules.modules(self.graph, True)
        is_module = bytearray(self.numbers)
        for number in modules:
            is_module[number] = 1
        parts = []
        for number in modules:
            part = self.module(number, is_module, self.graph.root & 1 if number == top else 0)
            if part.diagram.root < 2:
                self.constants[number] = part.diagram.root
            parts.append(part)
        return parts

    def literal(self, literal: int) -> Part:
        """A top event that is a basic event, its opposite or a constant."""
        order = [literal >> 1] if literal > 1 else []
        builder = self.builder.Builder(len(order), 2)
        root = builder.variable(0) ^ (literal & 1) if order else literal
        return Part(self.numbers, order, self.diagrams.Diagram(*builder.finish(root)))

    def module(self, number: int, is_module: bytearray, flip: int) -> Part:
        """The diagram of the module at gate `number`, of its opposite where `flip` is 1. Raises TooLarge."""
        gates, variables = self.members.members(self.graph, number, is_module)
        # of one gate every order is as good
        orders: Iterable[array[int]] = (
            iter([variables]) if len(gates) == 1 else self.orders.orders(self.graph, number, is_module)
        )
        usual = None
        for budget, kept in itertools.zip_longest(self.budgets, KEPT[: len(self.budgets)], fillvalue=KEPT[-1]):
            tried: list[tuple[int, array[int]]] = []
            for order in itertools.islice(orders, kept):
                builder, root = self._built(gates, order, budget)
                if root >= 0:
                    return Part(number, order, self.diagrams.Diagram(*builder.finish(root ^ flip)))
                tried.append((builder.done, order))
            usual = usual or tried[0][1]
            best = [order for _, order in sorted(tried, key=lambda one: (-one[0], one[1] is not usual))]
            best.insert(1, best.pop(next(i for i, order in enumerate(best) if order is usual)))
            orders = best
        if usual is not None and len(gates) > 1 and (grown := self._sifted(gates, usual)) is not None:
            order, builder, root = grown
            return Part(number, order, self.diagrams.Diagram(*builder.finish(root ^ flip)))
        raise TooLarge(
            f'fault tree "{self.tree.name}": a module of {len(gates)} gates over {len(variables)} variables '
            f"needs more than {self.budgets[-1]} nodes in every order tried; split the tree, or pass larger budgets "
            "to solve()"
        )

    def _sifted(self, gates: array[int], order: array[int]) -> tuple[array[int], Any, int] | None:
        """As the last resort: an order improved while the diagram is built, a builder and the root in it."""
        from safety.trees.sifted import Growing

        sifting = kernel.load("sifting", self.interpreted)
        growing = Growing(self.builder, sifting, self.graph, gates, self.constants, pulse)
        return growing.built(order, self.budgets[-1])

    def _built(self, gates: array[int], order: Sequence[int], budget: int) -> tuple[Any, int]:
        """A builder and the root of the module in it, below 0 where it needs more than the budget."""
        builder = self.builder.Builder(len(order), budget)
        edge_of = array("i", bytes(4 * self.numbers))
        for level, number in enumerate(order):
            edge_of[number] = builder.variable(level)
            if edge_of[number] < 0:
                return builder, -1
        for number, constant in self.constants.items():
            edge_of[number] = constant
        return builder, builder.build(self.graph, gates, edge_of, pulse)
