"""Solving a fault tree: `solve(tree)` builds one decision diagram a module; its `Solution` reads every figure off."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Generic

from safety.trees.bdd import FALSE, TRUE, Bdd, Chance, Number, OutOfBudget, recursion_of
from safety.trees.cut_sets import Counts, CutSets, Family, smallest_first
from safety.trees.importance import Importance, conditionals, measures
from safety.trees.modules import Module, find_modules
from safety.trees.orders import candidate_orders
from safety.trees.tree import FaultTree

BUDGETS = (5_000, 50_000, 500_000)  # nodes; every order is tried with each before the next
HALF_ULP = 2.0**-53  # the largest relative error of one rounding


class TooLarge(RuntimeError):
    """No order kept a diagram within the largest budget; the tree has no result, not even an approximate one."""

    exit_code = 3


@dataclass(frozen=True)
class Diagram:
    """The function of one module: `root` in `bdd`, whose levels are `order`."""

    bdd: Bdd
    order: tuple[str, ...]
    root: int


class Solution:
    """What is known of a fault tree once its diagrams are built.

    Figures are computed when first asked for, and kept.
    """

    def __init__(self, tree: FaultTree, diagrams: Mapping[str, Diagram]) -> None:
        self.tree = tree
        self._diagrams = diagrams  # by the gate of the module, inner ones first, the top last

    @cached_property
    def nodes(self) -> int:
        """Size of the diagrams: the number of decision nodes of all modules."""
        return sum(len(d.bdd.below(d.root)) for d in self._diagrams.values())

    @cached_property
    def probability(self) -> float | None:
        """Probability of the top event in doubles (see `bounds`); None if an event below the top has none."""
        return None if self._doubles is None else self._doubles[self.tree.top].top[0]

    @cached_property
    def exact(self) -> Fraction | None:
        """The same as a rational; None unless all events below the top have one. Slow on large diagrams (`nodes`)."""
        return None if self._rationals is None else self._rationals[self.tree.top].top[0]

    @property
    def bounds(self) -> tuple[float, float] | None:
        """Doubles that enclose the probability, whatever the rounding in `probability` (not below 1e-300).

        Nothing is subtracted, so relative errors add up along a path: per level half an ulp for the product, half for
        the sum, and the error of the chance, at most 3 half ulps for 1 - exp(-x) and 3 + x for exp(-x) with a math
        library good to 1 ulp.
        """
        if self.probability is None:
            return None
        largest = max(
            (
                float(e.rate_per_hour * e.mission_time_h)
                for e in self.tree.events
                if e.rate_per_hour and e.mission_time_h
            ),
            default=0,
        )
        levels = sum(len(diagram.order) for diagram in self._diagrams.values())
        error = 1.01 * HALF_ULP * levels * (5 + largest)
        return self.probability * (1 - error), min(1.0, self.probability * (1 + error))

    @cached_property
    def counts(self) -> Counts:
        """The number of minimal cut sets with 0, 1, 2, ... events.

        (1,) is a top event that needs none, () one that cannot occur.
        """
        family = self._families[self.tree.top]
        return family.counts[family.sets.root]

    def cut_sets(self) -> Iterator[tuple[str, ...]]:
        """The minimal cut sets by increasing order, made one by one; within an order, as the diagram has them.

        Names within a set are sorted.
        """
        return smallest_first(self._families, self.tree.top)

    def importance(self) -> dict[str, Importance[float]]:
        """Importance of each basic event with a probability, in doubles; empty if `probability` is None."""
        events = {event.name: event.chance for event in self.tree.events}
        return {} if self._doubles is None else self._importance(self._doubles, events, 0.0, 1.0)

    def exact_importance(self) -> dict[str, Importance[Fraction]]:
        """The same in rational arithmetic; empty if `exact` is None."""
        events = {event.name: event.exact_chance for event in self.tree.events}
        return {} if self._rationals is None else self._importance(self._rationals, events, Fraction(0), Fraction(1))

    @cached_property
    def _families(self) -> dict[str, Family]:
        families: dict[str, Family] = {}
        for name, diagram in self._diagrams.items():
            with recursion_of(diagram.bdd.levels):
                sets = CutSets(diagram.bdd, diagram.root)
            weights = [families[v].counts[families[v].sets.root] if v in families else (0, 1) for v in diagram.order]
            families[name] = Family(sets, diagram.order, sets.counts(weights))
        return families

    @cached_property
    def _doubles(self) -> dict[str, _Chances[float]] | None:
        return self._evaluate({event.name: event.chance for event in self.tree.events}, 0.0, 1.0)

    @cached_property
    def _rationals(self) -> dict[str, _Chances[Fraction]] | None:
        return self._evaluate({event.name: event.exact_chance for event in self.tree.events}, Fraction(0), Fraction(1))

    def _evaluate(
        self, events: Mapping[str, Chance[Number] | None], zero: Number, one: Number
    ) -> dict[str, _Chances[Number]] | None:
        """The chances of every node of every diagram; None if the chance of an event below the top is not known."""
        result: dict[str, _Chances[Number]] = {}
        for name, diagram in self._diagrams.items():
            variables: list[Chance[Number]] = []
            for variable in diagram.order:
                chance = result[variable].top if variable in result else events[variable]
                if chance is None:
                    return None
                variables.append(chance)
            nodes = diagram.bdd.chances(diagram.root, variables, zero, one)
            result[name] = _Chances(variables, nodes, nodes[diagram.root])
        return result

    def _importance(
        self,
        chances: Mapping[str, _Chances[Number]],
        events: Mapping[str, Chance[Number] | None],
        zero: Number,
        one: Number,
    ) -> dict[str, Importance[Number]]:
        """P1 and P0 of a module's variables from those of the module itself, the top first."""
        top = chances[self.tree.top].top[0]
        given: dict[str, tuple[Number, Number]] = {self.tree.top: (one, zero)}
        for name, diagram in reversed(list(self._diagrams.items())):
            outer_true, outer_false = given.get(name, (top, top))
            own = chances[name]
            pairs = conditionals(diagram.bdd, diagram.root, own.variables, own.nodes, zero, one)
            for variable, inner in zip(diagram.order, pairs, strict=True):
                when_true, when_false = (p * outer_true + (one - p) * outer_false for p in inner)
                given[variable] = when_true, when_false
        return {
            name: measures(name, chance[0], top, *given.get(name, (top, top)))
            for name, chance in events.items()
            if chance is not None
        }


@dataclass(frozen=True)
class _Chances(Generic[Number]):
    """The chances of a module's variables, of its diagram's nodes, and of its function."""

    variables: list[Chance[Number]]
    nodes: dict[int, Chance[Number]]
    top: Chance[Number]


def solve(tree: FaultTree, budgets: Sequence[int] = BUDGETS) -> Solution:
    """Build the diagrams of `tree`.

    Raises TooLarge when a module fits into none of the `budgets` (nodes) under any order tried.
    """
    diagrams: dict[str, Diagram] = {}
    constants = {house.name: TRUE if house.state else FALSE for house in tree.house_events}
    for module in find_modules(tree):
        diagram = _smallest(tree, module, constants, budgets)
        diagrams[module.top] = diagram
        if diagram.root in (FALSE, TRUE):
            constants[module.top] = diagram.root
    return Solution(tree, diagrams)


def _smallest(tree: FaultTree, module: Module, constants: Mapping[str, int], budgets: Sequence[int]) -> Diagram:
    for budget in budgets:
        for order in candidate_orders(module):
            try:
                return build(module, order, constants, budget)
            except OutOfBudget:
                continue
    raise TooLarge(
        f'fault tree "{tree.name}": the module at gate "{module.top}" ({len(module.gates)} gates over '
        f"{len(module.variables)} variables) needs more than {budgets[-1]} nodes in every order tried; "
        "split the tree, or pass larger budgets to solve()"
    )


def build(module: Module, order: tuple[str, ...], constants: Mapping[str, int], budget: int | None = None) -> Diagram:
    """The diagram of `module` under `order`; house events and constant modules are `constants`. Raises OutOfBudget."""
    bdd = Bdd(len(order), budget)
    functions = {name: bdd.node(level, TRUE, FALSE) for level, name in enumerate(order)} | dict(constants)
    with recursion_of(len(order)):
        for gate in module.gates:
            functions[gate.name] = bdd.gate(gate.kind, [functions[name] for name in gate.inputs], gate.k)
    return Diagram(bdd, order, functions[module.top])
