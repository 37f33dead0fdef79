"""Prime implicants: the shortest products of events, occurring and not occurring, that bring the top event about.

Of a coherent tree they are the minimal cut sets. Of another one they say as well what must not have happened.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from safety.trees import kernel
from safety.trees.module_diagrams import TooLarge, pulse
from safety.trees.recursion import deeply
from safety.trees.solve import Solution

BUDGET = 20_000_000  # nodes of a module's functions and families
Product = tuple[tuple[str, bool], ...]  # names, sorted, and whether the event occurs


class _Family(NamedTuple):
    order: Any  # number of the event or module of each level
    nodes: list[tuple[int, int, int, int]]  # level, products with the variable, with its opposite, without; from 2
    root: int


class PrimeImplicants:
    """Those of the tree of `solution`; kept as diagrams, so that they are counted without being listed.

    Raises TooLarge when a module needs more than `budget` nodes.
    """

    def __init__(self, solution: Solution, budget: int = BUDGET, *, interpreted: bool = False) -> None:
        self._events = solution.events
        self._families: dict[tuple[int, bool], _Family] = {}
        self._top = (solution.parts[-1].number, True)
        self._parts = {part.number: part for part in solution.parts}
        module = kernel.load("primes", interpreted)

        def work() -> None:
            self._make(self._top, module, budget)

        deeply(4 * sum(len(part.order) for part in solution.parts), work)

    def _make(self, key: tuple[int, bool], module: Any, budget: int) -> None:
        """The family of a module, or of its opposite, after those it needs."""
        number, plain = key
        part = self._parts[number]
        diagram = part.diagram
        primes = module.Primes(len(part.order), budget, pulse)
        root = primes.of(diagram.level, diagram.high, diagram.low, diagram.root ^ (not plain))
        if root < 0:
            raise TooLarge(
                f"the prime implicants of a module over {len(part.order)} variables need more than {budget} nodes; "
                "ask for the minimal cut sets instead, or pass a larger budget"
            )
        nodes, root = primes.family(root)
        for level, with_it, with_opposite, _ in nodes:
            for inner in ((part.order[level], True),) * bool(with_it) + ((part.order[level], False),) * bool(
                with_opposite
            ):
                if inner[0] in self._parts and inner not in self._families:
                    self._make(inner, module, budget)
        self._families[key] = _Family(part.order, nodes, root)

    def counts(self) -> tuple[int, ...]:
        """The number of prime implicants of 0, 1, 2, ... literals: (1,) of what is always true, () of what never is."""
        known: dict[tuple[int, bool], list[int]] = {}
        for key, family in self._families.items():  # inner ones first
            count: list[list[int]] = [[], [1]]
            for level, with_it, with_opposite, none in family.nodes:
                total = list(count[none])
                for plain, child in ((True, with_it), (False, with_opposite)):
                    _add(total, count[child], known.get((family.order[level], plain), [0, 1]))
                count.append(total)
            known[key] = count[family.root]
        return tuple(known[self._top])

    def __iter__(self) -> Iterator[Product]:
        """Every prime implicant, made one by one, those that need few literals of the first events last."""
        for product in self._products(self._top):
            yield tuple(sorted((self._events[number - 1], plain) for number, plain in product))

    def _products(self, key: tuple[int, bool]) -> Iterator[tuple[tuple[int, bool], ...]]:
        family = self._families[key]
        agenda: list[tuple[int, tuple[tuple[int, bool], ...]]] = [(family.root, ())]
        while agenda:
            node, literals = agenda.pop()
            if node == 1:
                yield from self._expanded(literals)
            elif node:
                level, with_it, with_opposite, none = family.nodes[node - 2]
                number = family.order[level]
                agenda += [(none, literals), (with_opposite, (*literals, (number, False)))]
                agenda.append((with_it, (*literals, (number, True))))

    def _expanded(self, literals: tuple[tuple[int, bool], ...]) -> Iterator[tuple[tuple[int, bool], ...]]:
        """The products of events of one whose literals may be modules."""
        at = next((i for i, (number, _) in enumerate(literals) if number in self._parts), None)
        if at is None:
            yield literals
            return
        for inner in self._products(literals[at]):
            yield from self._expanded((*literals[:at], *inner, *literals[at + 1 :]))


def _add(total: list[int], counts: list[int], others: list[int]) -> None:
    """Add the product of two histograms to `total`."""
    total += [0] * (len(counts) + len(others) - 1 - len(total) if counts and others else 0)
    for i, count in enumerate(counts):
        for j, other in enumerate(others):
            total[i + j] += count * other
