"""Minimal cut sets one by one out of their diagrams: the smallest first, or the likeliest first.

No branch is entered that does not end in a cut set, so the first ones cost little however many there are.
"""

from __future__ import annotations

import heapq
import itertools
import math
from array import array
from collections.abc import Iterator, Mapping, Sequence

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Any

    _Todo = tuple[int, int, int, "_Todo" | None]  # module, node, number of events, what comes after
    _Chosen = tuple[int, "_Chosen" | None]  # an event, those chosen before

EMPTY = 1  # the node of the family of just the empty set
DIGITS = 9  # of logarithms that are compared: what is left is rounding, and would lead the search astray
WORD = 64  # orders below it have a bit each in the kernel's masks
LARGEST_PRIMES = (1, 19, 61, 69, 85, 99, 105, 151, 159, 171, 225, 249, 295, 325, 379, 399)  # 2^31 less these
PRIMES = tuple([(1 << 31) - less for less in LARGEST_PRIMES])
CutSet = tuple[int, ...]


class Families:
    """The minimal cut sets of a tree, one family a module: `members[module]` is the family and its variables.

    Variables and modules are numbers; one that is no module is an event. `top` is the module of the whole tree.
    """

    def __init__(self, members: Mapping[int, tuple[Any, Sequence[int]]], top: int) -> None:
        self.members = members
        self.top = top

    def counts(self) -> tuple[int, ...]:
        """The number of cut sets with 0, 1, 2, ... events, exact at any size; no zero at the end."""
        counts: dict[int, tuple[int, ...]] = {}
        for module, (family, variables) in self.members.items():
            weights = [counts.get(variable, (0, 1)) for variable in variables]
            row = _counts(family, weights)
            while row and not row[-1]:
                row.pop()
            counts[module] = tuple(row)
        return counts[self.top]

    def smallest_first(self) -> Iterator[CutSet]:
        """The cut sets by increasing order; within an order, as the diagrams have them."""
        masks = self._masks()
        root = self.members[self.top][0].root
        nodes = {module: family.node for module, (family, _) in self.members.items()}
        whole = masks[self.top][root]
        for order in range(whole.bit_length()):
            if whole >> order & 1:
                yield from self._of_order(masks, nodes, order)

    def _of_order(self, masks: Mapping[int, Sequence[int]], nodes: Mapping[int, Any], order: int) -> Iterator[CutSet]:
        """The search state: a chain of nodes to resolve, each with the events it must add, and those chosen."""
        agenda: list[tuple[_Todo | None, _Chosen | None]] = [
            ((self.top, self.members[self.top][0].root, order, None), None)
        ]
        while agenda:
            todo, chosen = agenda.pop()
            if todo is None:
                yield _listed(chosen)
                continue
            module, node, events, rest = todo
            mask = masks[module]
            if not mask[node] >> events & 1:
                continue
            if node == EMPTY:
                agenda.append((rest, chosen))
                continue
            level, high, low, _ = nodes[module][4 * node : 4 * node + 4]
            variable = self.members[module][1][level]
            agenda.append(((module, low, events, rest), chosen))
            if variable not in self.members:
                if events:
                    agenda.append(((module, high, events - 1, rest), (variable, chosen)))
                continue
            root = self.members[variable][0].root
            for inside in _splits(events, masks[variable][root], mask[high]):
                agenda.append(((variable, root, inside, (module, high, events - inside, rest)), chosen))

    def likeliest_first(self, chance: Mapping[int, float]) -> Iterator[tuple[float, CutSet]]:
        """The cut sets by decreasing product of the chances of their events, each with that product.

        Sets of chance 0 are left out; products that agree to nine digits count as equal. Best-first search; what is
        still open is bounded by the best that it leads to.
        """
        best: dict[int, Sequence[float]] = {}  # logarithms, which no number of events brings down to 0
        worth = {number: math.log(one) if one > 0 else -math.inf for number, one in chance.items()}
        for module, (family, variables) in self.members.items():
            best[module] = family.best(array("d", [worth[variable] for variable in variables]))
            worth[module] = best[module][family.root]
        root = self.members[self.top][0].root
        ties = itertools.count(0, -1)  # of equal ones the last found first: it is the nearest to its end
        heap: list[tuple[float, int, float, float, Any, CutSet]] = []

        def push(bound: float, sure: float, todo: Any, chosen: CutSet) -> None:
            if bound > -math.inf:
                heapq.heappush(heap, (round(-bound, DIGITS), next(ties), bound, sure, todo, chosen))

        push(best[self.top][root], 1.0, (self.top, root, None), ())
        while heap:
            _, _, bound, sure, todo, chosen = heapq.heappop(heap)
            if todo is None:
                yield sure, chosen
                continue
            module, node, rest = todo
            if node == EMPTY:
                push(bound, sure, rest, chosen)
                continue
            family, variables = self.members[module]
            level, high, low, _ = family.node[4 * node : 4 * node + 4]
            variable = variables[level]
            outside = bound - best[module][node]
            push(outside + best[module][low], sure, (module, low, rest), chosen)
            bound = outside + best[module][high] + worth[variable]
            if variable in self.members:
                push(bound, sure, (variable, self.members[variable][0].root, (module, high, rest)), chosen)
            else:
                push(bound, sure * chance[variable], (module, high, rest), (*chosen, variable))

    def _masks(self) -> dict[int, Sequence[int]]:
        """For each module and node, bit n set where it has a set of n events."""
        masks: dict[int, Sequence[int]] = {}
        for module, (family, variables) in self.members.items():
            inner = [masks[v][self.members[v][0].root] if v in masks else 2 for v in variables]
            longest = array("i", [mask.bit_length() - 1 for mask in inner])
            if max(family.orders(longest)) < WORD:
                masks[module] = family.reachable_orders(array("Q", inner))
            else:
                masks[module] = _masks(family, inner)
        return masks


def _masks(family: Any, inner: Sequence[int]) -> list[int]:
    """The same as `reachable_orders`, for orders of any size."""
    masks, node = [0, 1], family.node
    for i in range(2, family.count):
        level, high, low, _ = node[4 * i : 4 * i + 4]
        masks.append(masks[low] | _sums(inner[level], masks[high]))
    return masks


def _listed(chosen: _Chosen | None) -> CutSet:
    """The events of a chain."""
    events = []
    while chosen is not None:
        event, chosen = chosen
        events.append(event)
    return tuple(reversed(events))


def _splits(total: int, inside: int, outside: int) -> Iterator[int]:
    """Each number of the bits `inside` that a number of `outside` makes up to `total`, by increasing size."""
    if inside.bit_count() <= outside.bit_count():
        yield from (n for n in _members(inside) if n <= total and outside >> (total - n) & 1)
    else:
        numbers = [total - n for n in _members(outside) if n <= total and inside >> (total - n) & 1]
        yield from reversed(numbers)


def _members(bits: int) -> Iterator[int]:
    """The numbers of the bits that are set."""
    while bits:
        lowest = bits & -bits
        yield lowest.bit_length() - 1
        bits ^= lowest


def _sums(a: int, b: int) -> int:
    """As bits, the sums of a number of `a` and one of `b`."""
    few, many = sorted((a, b), key=int.bit_count)
    sums = 0
    for n in _members(few):
        sums |= many << n
    return sums


def _counts(family: Any, weights: Sequence[Sequence[int]]) -> list[int]:
    """The number of sets of a family by order, from those of the variable of each level, at any size.

    The kernel counts modulo primes, as many as tell all numbers up to the size of the family apart; where that takes
    more than there are here, counting in whole numbers is as quick.
    """
    try:
        bits = math.log2(2 + family.size(array("d", [float(sum(row)) for row in weights]))) + 1
    except OverflowError:
        bits = math.inf
    if not bits < 30 * len(PRIMES):
        return _large_counts(family, weights)
    row: list[int] = family.counts(weights, PRIMES[0])
    modulus = PRIMES[0]
    for prime in PRIMES[1:]:
        if modulus.bit_length() > bits + 1:
            break
        inverse = pow(modulus, -1, prime)
        others = family.counts(weights, prime)
        row = [one + modulus * ((other - one) * inverse % prime) for one, other in zip(row, others, strict=True)]
        modulus *= prime
    return row


def _large_counts(family: Any, weights: Sequence[Sequence[int]]) -> list[int]:
    """The same in whole numbers."""
    counts: list[list[int]] = [[], [1]]
    node = family.node
    for i in range(2, family.count):
        level, high, low, _ = node[4 * i : 4 * i + 4]
        weight, above = weights[level], counts[high]
        row = [0] * max(len(counts[low]), len(weight) + len(above) - 1 if above else 0)
        row[: len(counts[low])] = counts[low]
        for n, many in enumerate(weight):
            if many:
                for j, number in enumerate(above):
                    row[n + j] += many * number
        counts.append(row)
    return counts[family.root]
