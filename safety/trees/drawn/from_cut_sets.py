"""A fault tree drawn from minimal cut sets: parts that act as one, votes and common parts show as gates with a name.

How the sets become a formula is said in `factoring`, how that is laid out in gates and what these are called in
`names`.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping
from itertools import combinations, product

from safety.trees.as_written import TreeError
from safety.trees.module_diagrams import TooLarge
from safety.trees.solve import solve
from safety.trees.tree import BasicEvent, FaultTree, Gate, HouseEvent

CutSet = frozenset[str]
BUDGETS = (20_000, 100_000)  # nodes of the diagram by which a tree is checked


class NotGivenBack(RuntimeError):
    """A tree does not have the cut sets that it was drawn from: an error of this program, and no tree is drawn."""

    exit_code = 70


def from_cut_sets(
    name: str,
    cut_sets: Iterable[Collection[str]],
    events: Iterable[BasicEvent],
    *,
    description: str = "",
    titles: Mapping[str, str] | None = None,
) -> FaultTree:
    """The tree whose top event, the gate `name`, has exactly the minimal cut sets `cut_sets` over `events`.

    That it has is found out by solving the tree before it is handed out. The tree depends on the sets and the order of
    `events` alone. It has no more gates than there are cut sets of two and more events, and the top, but for those that
    divide long lists. `titles` are better names of sub-systems than those in the events' names ("channel a" for the "a"
    of "a: no clock"). No cut set at all makes a top event that cannot occur, an empty one a top event that always does
    (a house event under the top).

    Raises TreeError: a cut set with an undefined event, or one that contains another. Raises NotGivenBack.
    """
    events = tuple(events)
    rank = {event.name: i for i, event in enumerate(events)}
    sets = {frozenset(cut_set) for cut_set in cut_sets}
    _check(name, sets, rank)
    if not sets or frozenset() in sets:
        house = HouseEvent(f"{name}: {'no failure needed' if sets else 'no cut set'}", bool(sets))
        return FaultTree(name, name, (Gate(name, "or", (house.name,), description=description),), events, (house,))
    from safety.trees.drawn.factoring import factored
    from safety.trees.drawn.names import drawn  # not to be imported by who only reads and solves

    formula = factored(frozenset(rank[event] for event in one) for one in sets)
    tree = FaultTree(name, name, drawn(name, formula, list(rank), description, titles), events)
    _check_given_back(tree, sets)
    return tree


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


def _check_given_back(tree: FaultTree, sets: Collection[CutSet]) -> None:
    """Raise NotGivenBack unless the tree has just these minimal cut sets, by solving it.

    Where its diagram is too large, the gates are multiplied out instead: sets of which none is in another, as those
    given are, are then the minimal ones.
    """
    try:
        solution = solve(tree, BUDGETS)
        given_back = sum(solution.counts) == len(sets) and all(frozenset(one) in sets for one in solution.cut_sets())
    except TooLarge:
        given_back = _multiplied_out(tree) == sets
    if not given_back:
        raise NotGivenBack(
            f'the tree drawn for "{tree.name}" has other minimal cut sets than the {len(sets)} that it was drawn from; '
            "please report it with these sets"
        )


def _multiplied_out(tree: FaultTree) -> set[CutSet]:
    families: dict[str, set[CutSet]] = {event.name: {frozenset({event.name})} for event in tree.events}
    for gate in tree.inputs_first:
        count = {"or": 1, "vote": gate.k}.get(gate.kind, len(gate.inputs))
        families[gate.name] = {
            frozenset[str]().union(*pieces)
            for chosen in combinations(gate.inputs, count or 1)
            for pieces in product(*(families[name] for name in chosen))
        }
    return families[tree.top]
