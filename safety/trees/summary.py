"""What a results document says of one fault tree: the entry of "trees", with plain numbers, lists and texts only."""

from __future__ import annotations

import itertools
import math
import time
from fractions import Fraction

from safety.trees.collector import paused
from safety.trees.formats.json_form import to_document
from safety.trees.importance.events import plain
from safety.trees.module_diagrams import TooLarge
from safety.trees.solve import Solution, solve
from safety.trees.tree import FaultTree

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Any

    from safety.trees.cut_sets.truncated import OfDiagram, Truncated

EXACT_NODES = 20_000  # largest diagram whose exact rational is computed unasked
EXACT_BITS = 13_000  # longest denominator written out, about 3,900 digits
LISTED = 200  # minimal cut sets listed


def summary(tree: FaultTree, *, source: str = "", read_s: float | None = None, listed: int = LISTED) -> dict[str, Any]:
    """Solve `tree` and give its entry for the "trees" of a results document (see `entry_of`). Raises TooLarge."""
    started = time.perf_counter()
    solution = solve(tree)
    return entry_of(solution, source=source, read_s=read_s, solve_s=time.perf_counter() - started, listed=listed)


@paused()
def entry_of(
    solution: Solution,
    *,
    source: str = "",
    read_s: float | None = None,
    solve_s: float = 0.0,
    listed: int = LISTED,
    likeliest: bool = False,
    exact_nodes: float = EXACT_NODES,
    limited: Truncated | OfDiagram | None = None,
) -> dict[str, Any]:
    """The entry of a solved tree for the "trees" of a results document.

    `source` says where the tree came from (a file, a model), `read_s` and `solve_s` how many seconds reading it and
    building its diagrams took. Probabilities that are not known are None; "exact" is the probability as "p/q" where all
    are rational, the diagram has at most `exact_nodes` nodes and the denominator at most EXACT_BITS bits. The
    probability lies between "probability_low" and "probability_high" whatever the rounding. `listed` cut sets are
    listed, the smallest or the `likeliest`, of all or of those within limits (`limited`). Where the diagram of all
    does not fit its budget those up to the largest order that is quickly had are, and "note" says so.
    """
    started, tree = time.perf_counter(), solution.tree
    _ = solution.probability
    sets: Solution | Truncated | OfDiagram | None = limited or solution
    note = {}
    try:
        _ = limited or solution.counts
    except TooLarge as why:
        sets = _quickly_had(tree)
        if sets is None or not sets.complete:
            note = {"note": str(why)}
    solve_s += time.perf_counter() - started
    exact = solution.exact if solution.nodes <= exact_nodes else None
    probability, low, high = _enclosed(solution, exact)
    importance = sorted(
        solution.importance().values(), key=lambda measures: (-(measures.criticality or 0), measures.event)
    )
    sources = {event.name: event.source for event in tree.events}
    return {
        "id": tree.name,
        "description": tree.description,
        "source": source,
        "gates": sum(not gate.inside for gate in tree.gates),
        "basic_events": len(tree.events),
        "probability": probability,
        "probability_low": low,
        "probability_high": high,
        "exact": None if exact is None or exact.denominator.bit_length() > EXACT_BITS else str(exact),
        "minimal_cut_sets": None if sets is None else cut_set_rows(sets, listed, likeliest),
        "importance": [plain(measures) | {"source": sources[measures.event]} for measures in importance],
        "structure": to_document(tree),
        "diagram_nodes": solution.nodes,
        "seconds": {"read": read_s, "solve": solve_s, "total": solve_s + (read_s or 0)},
    } | note


def _quickly_had(tree: FaultTree) -> Truncated | None:
    """The cut sets up to the largest order that takes little; None of a tree with not or xor."""
    if not tree.is_monotone:
        return None
    from safety.trees.cut_sets.truncated import largest_order

    return largest_order(tree)


def _enclosed(solution: Solution, exact: Fraction | None) -> tuple[float | None, float | None, float | None]:
    """The probability and the doubles around it: next to it when it is known exactly."""
    if exact is None:
        return (solution.probability, *(solution.bounds or (None, None)))
    nearest = float(exact)
    low = nearest if nearest <= exact else math.nextafter(nearest, 0)
    return nearest, low, nearest if nearest >= exact else math.nextafter(nearest, 1)


def cut_set_rows(solution: Solution | Truncated | OfDiagram, listed: int, likeliest: bool = False) -> dict[str, Any]:
    """Counts by order, and the smallest (or likeliest) sets with their probabilities; how many are left out is said.

    Where there are limits, and sets beyond them, "limits" holds what the count is of.
    """
    chances = {event.name: event.chance for event in solution.tree.events}
    if likeliest:
        sets = [one for _, one in itertools.islice(solution.likeliest_cut_sets(), listed)]
    else:
        sets = sorted(itertools.islice(solution.cut_sets(), listed), key=lambda cut_set: (len(cut_set), cut_set))
    rows = []
    for cut_set in sets:
        known = [chance[0] for name in cut_set if (chance := chances[name])]
        rows.append({"events": list(cut_set), "probability": math.prod(known) if len(known) == len(cut_set) else None})
    count = sum(solution.counts)
    limits = {}
    if not isinstance(solution, Solution) and not solution.complete:
        limits = {"limits": {"order": solution.order, "probability": solution.above}}
    return limits | {
        "count": count,
        "by_order": {str(order): number for order, number in enumerate(solution.counts) if number},
        "sets": rows,
        "not_listed": count - len(rows),
    }
