"""A diagram whose order of variables is improved while it is built, where no order that was tried in advance fits."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence

from safety.trees.kernel.flat import FlatGraph
from safety.trees.record import Record

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any

FIRST = 50_000  # nodes at which the building stops to sift for the first time
SHARE = 8  # the largest budget by the most nodes that building may have here: sifting takes twice the room, and more
STEPS = 100_000_000  # of sifting in all: some ten seconds


class Growing(Record):
    """Builds the diagram of a module in pieces, between which the variables are sifted.

    Where the nodes are used up, all are dropped that no gate to come needs. What is left, and the parts of results that
    were ready when it stopped, is sifted; the gates done are done, and the one that was begun goes on.
    """

    builders: ModuleType  # the kernel's files
    sifting: ModuleType
    graph: FlatGraph
    gates: array[int]  # inputs first
    known: dict[int, int]  # edges of constants, by index
    pulse: Callable[[], None]

    def built(self, order: Sequence[int], largest: int) -> tuple[array[int], Any, int] | None:
        """The order that fits, a builder and the edge of the last gate; None where `largest` nodes or STEPS do not
        suffice."""
        order, budget, steps, done = array("i", order), min(FIRST, largest), STEPS, 0
        edge_of = array("i", bytes(4 * (self.graph.variables + len(self.graph) + 1)))
        for number, edge in self.known.items():
            edge_of[number] = edge
        builder, left = self.builders.Builder(len(order), budget), array("i")
        while True:
            for level, number in enumerate(order):
                edge_of[number] = builder.variable(level)
            if min(edge_of[number] for number in order) < 0:
                return None
            root = builder.build(self.graph, self.gates[done:], edge_of, self.pulse, left)
            if root >= 0:
                return order, builder, root
            stuck = builder.done == 0 and len(builder.left) >= len(left)
            done += builder.done
            needed = self.needed(done)
            keep, left = len(needed) + len(builder.left), builder.left
            roots = array("i", [edge_of[number] for number in needed]) + left + builder.begun
            shared = builder.shared(roots)
            del builder  # for the sake of memory, as below
            sifter = self.sifting.Sifter(*shared, 2 * budget)
            del shared
            sifter.sift(steps - sifter.steps, self.pulse)
            steps -= sifter.steps
            sifter.keep(keep)
            order = array("i", [order[variable] for variable in sifter.order()])
            more = 2 * budget <= largest // SHARE
            if (stuck and not more) or steps <= 0:
                return None
            if more and (stuck or 4 * sifter.nodes > budget):
                budget *= 2
            *shared, roots = sifter.finish()
            del sifter
            builder = self.builders.Builder(len(order), budget)
            builder.adopt(*shared)
            for number, edge in zip(needed, roots, strict=False):
                edge_of[number] = edge
            left = roots[len(needed) :]

    def needed(self, done: int) -> list[int]:
        """The gates among the first `done` that a later one has as an input."""
        first, inputs, start = self.graph.variables + 1, self.graph.inputs, self.graph.start
        asked = set()
        for gate in self.gates[done:]:
            asked.update([literal >> 1 for literal in inputs[start[gate - first] : start[gate - first + 1]]])
        return [gate for gate in self.gates[:done] if gate in asked]
