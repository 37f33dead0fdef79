"""The probability and the importance of a solved fault tree in rational arithmetic, in passes over its diagrams."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from safety.trees.importance.events import Importance, measures
from safety.trees.tree import FaultTree

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from safety.trees.module_diagrams import Part

ZERO, ONE = Fraction(0), Fraction(1)


class Exact:
    """`probability` of the top, None unless every event below it has a rational one."""

    def __init__(self, tree: FaultTree, parts: Sequence[Part]) -> None:
        self.tree, self.parts = tree, parts
        self.chance: dict[int, Fraction] = {}  # of events and modules by number
        for i, event in enumerate(tree.events, 1):
            if event.exact_chance is not None:
                self.chance[i] = event.exact_chance[0]
        self.edges: list[list[Fraction]] = []
        self.probability = self._upwards()

    def _upwards(self) -> Fraction | None:
        for part in self.parts:
            if any(number not in self.chance for number in part.order):
                return None
            diagram = part.diagram
            level, high, low = list(diagram.level), list(diagram.high), list(diagram.low)
            edge = [ONE, ZERO]
            for i in range(1, diagram.nodes):
                q = self.chance[part.order[level[i]]]
                value = q * edge[high[i]] + (1 - q) * edge[low[i]]
                edge += [value, 1 - value]
            self.chance[part.number] = edge[diagram.root]
            self.edges.append(edge)
        return self.chance[self.parts[-1].number]

    def importance(self) -> dict[str, Importance]:
        """The measures of each event that has a rational probability; empty if `probability` is None."""
        if self.probability is None:
            return {}
        top, slopes = self.probability, self._slopes()
        result = {}
        for i, event in enumerate(self.tree.events, 1):
            if i in self.chance:
                q, slope = self.chance[i], slopes.get(i, ZERO)  # the top is linear in each chance
                result[event.name] = measures(event.name, q, top, top + (1 - q) * slope, top - q * slope)
        return result

    def _slopes(self) -> dict[int, Fraction]:
        """The derivative of the top by the chance of each event and module, by the chain rule."""
        slopes = {self.parts[-1].number: ONE}
        for part, edge in zip(reversed(self.parts), reversed(self.edges), strict=True):
            diagram, reach = part.diagram, [ZERO] * part.diagram.nodes
            level, high, low = list(diagram.level), list(diagram.high), list(diagram.low)
            own = [ZERO] * len(part.order)
            reach[diagram.root >> 1] = slopes[part.number] * (-1 if diagram.root & 1 else 1)
            for i in range(diagram.nodes - 1, 0, -1):
                q = self.chance[part.order[level[i]]]
                own[level[i]] += reach[i] * (edge[high[i]] - edge[low[i]])
                reach[high[i] >> 1] += reach[i] * q
                reach[low[i] >> 1] += reach[i] * (1 - q) * (-1 if low[i] & 1 else 1)
            slopes.update(zip(part.order, own, strict=True))
        return slopes
