"""A fault tree drawn from minimal cut sets, with what they have in common shown once."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import takewhile
from math import comb

from safety.trees.tree import BasicEvent, FaultTree, Gate, HouseEvent, TreeError

CutSet = frozenset[str]
MANY = 8  # gates of one order; from here on they stand under a gate of their own


def from_cut_sets(
    name: str, cut_sets: Iterable[Collection[str]], events: Iterable[BasicEvent], *, description: str = ""
) -> FaultTree:
    """The tree whose top event, the gate `name`, has exactly the minimal cut sets `cut_sets` over `events`.

    Single events stand directly under the top, larger sets after them by order. Within an order, events that can
    replace one another in every set become one "any of" gate, and sets that are all the k-subsets of such groups
    become one vote, so that the three channels of a two-out-of-three system show as three channels, named by what their
    events' dotted names share. The order of `events` fixes that of the tree.

    No cut set at all makes a top event that cannot occur, an empty one a top event that always does (a house event
    under the top).

    Raises TreeError: a cut set with an undefined event, or one that contains another.
    """
    events = tuple(events)
    rank = {event.name: i for i, event in enumerate(events)}
    sets = {frozenset(cut_set) for cut_set in cut_sets}
    _check(name, sets, rank)
    if not sets or frozenset() in sets:
        house = HouseEvent(f"{name}: {'no failure needed' if sets else 'no cut set'}", bool(sets))
        return FaultTree(name, name, (Gate(name, "or", (house.name,), description=description),), events, (house,))
    drawing = _Drawing(name, rank)
    inputs: list[str] = []
    for order in sorted({len(cut_set) for cut_set in sets}):
        inputs += drawing.of_order(order, [cut_set for cut_set in sets if len(cut_set) == order])
    gates = drawing.gates
    if len(inputs) == 1 and inputs[0] in gates:  # a top over one gate says no more than that gate
        only = gates.pop(inputs[0])
        top = Gate(name, only.kind, only.inputs, only.k, description)
    else:
        top = Gate(name, "or", tuple(inputs), description=description)
    return FaultTree(name, name, (top, *gates.values()), events)


def _check(name: str, sets: Collection[CutSet], rank: Mapping[str, int]) -> None:
    using: dict[str, list[CutSet]] = defaultdict(list)
    for cut_set in sorted(sets, key=sorted):
        for event in sorted(cut_set):
            if event not in rank:
                raise TreeError(f'a cut set of "{name}" has the undefined event "{event}"; add it to events', event)
            using[event].append(cut_set)
    for cut_set in sorted(sets, key=sorted):
        candidates = min((using[event] for event in cut_set), key=len, default=list(sets))
        larger = next((other for other in candidates if cut_set < other), None)
        if larger is not None:
            raise TreeError(
                f'the cut set {sorted(larger)} of "{name}" contains the cut set {sorted(cut_set)}; '
                "give minimal cut sets only"
            )


class _Drawing:
    """The gates made so far, by name; names and orders follow the rank of the events."""

    def __init__(self, top: str, rank: Mapping[str, int]) -> None:
        self.rank = rank
        self.taken = {top, *rank}
        self.gates: dict[str, Gate] = {}
        self.groups: dict[tuple[str, ...], str] = {}

    def of_order(self, order: int, sets: Sequence[CutSet]) -> list[str]:
        """The inputs of the top that stand for all of `sets`, which have `order` events each."""
        if order == 1:
            return sorted((event for cut_set in sets for event in cut_set), key=self.rank.__getitem__)
        group_of = self._interchangeable(sets)
        groups = sorted(set(group_of.values()), key=lambda group: self.rank[group[0]])
        parts = {group: self._any_of(group) for group in groups}
        combinations = {frozenset(group_of[event] for event in cut_set) for cut_set in sets}
        if len(combinations) == comb(len(groups), order):
            inputs = tuple(parts.values())
            kind, k = ("and", None) if order == len(inputs) else ("vote", order)
            name = f"all {order} together" if kind == "and" else f"any {order} of {len(inputs)} together"
            return [self._add(name, Gate("", kind, inputs, k))]
        place = {group: i for i, group in enumerate(groups)}
        rows = sorted(sorted(place[group] for group in combination) for combination in combinations)
        ands = []
        for number, row in enumerate(rows, 1):
            word = "cut set" if all(len(groups[i]) == 1 for i in row) else "combination"
            ands.append(self._add(f"{word} {order}.{number}", Gate("", "and", tuple(parts[groups[i]] for i in row))))
        return ands if len(ands) < MANY else [self._add(f"{order} failures together", Gate("", "or", tuple(ands)))]

    def _interchangeable(self, sets: Sequence[CutSet]) -> dict[str, tuple[str, ...]]:
        """For each event, those that occur in the same company, itself included: each may stand for any other."""
        company: dict[str, set[CutSet]] = defaultdict(set)
        for cut_set in sets:
            for event in cut_set:
                company[event].add(cut_set - {event})
        alike: dict[frozenset[CutSet], list[str]] = defaultdict(list)
        for event in sorted(company, key=self.rank.__getitem__):
            alike[frozenset(company[event])].append(event)
        return {event: tuple(group) for group in alike.values() for event in group}

    def _any_of(self, group: tuple[str, ...]) -> str:
        if len(group) == 1:
            return group[0]
        if group not in self.groups:
            paths = [name.split(".")[:-1] for name in group]
            shared = [parts[0] for parts in takewhile(lambda parts: len(set(parts)) == 1, zip(*paths, strict=False))]
            name = f"any of {'.'.join(shared)}" if shared else f"any of group {len(self.groups) + 1}"
            self.groups[group] = self._add(name, Gate("", "or", group))
        return self.groups[group]

    def _add(self, name: str, gate: Gate) -> str:
        number, free = 1, name
        while free in self.taken:
            number += 1
            free = f"{name} ({number})"
        self.taken.add(free)
        self.gates[free] = replace(gate, name=free)
        return free
