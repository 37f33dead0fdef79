"""What a results document says of one fault tree: the entry of "trees", with plain numbers, lists and texts only."""

from __future__ import annotations

import itertools
import math
import time
from dataclasses import asdict
from fractions import Fraction
from typing import Any

from safety.trees.importance import Importance
from safety.trees.json_form import to_document
from safety.trees.solve import Solution, solve
from safety.trees.tree import FaultTree

EXACT_NODES = 20_000  # largest diagram whose exact rational is computed unasked
EXACT_BITS = 13_000  # longest denominator written out, about 3,900 digits
LISTED = 200  # minimal cut sets listed, the smallest first


def summary(tree: FaultTree, *, source: str = "", read_s: float | None = None, listed: int = LISTED) -> dict[str, Any]:
    """Solve `tree` and give its entry for the "trees" of a results document.

    `source` says where the tree came from (a file, a model) and `read_s` how many seconds reading took. Probabilities
    that are not known are None; "exact" is the probability as "p/q" where all are rational, the diagram has at most
    EXACT_NODES nodes and the denominator at most EXACT_BITS bits. The probability lies between "probability_low" and
    "probability_high" whatever the rounding. Raises TooLarge.
    """
    started = time.perf_counter()
    solution = solve(tree)
    exact = solution.exact if solution.nodes <= EXACT_NODES else None
    probability, low, high = _enclosed(solution, exact)
    importance = sorted(
        solution.importance().values(), key=lambda measures: (-(measures.criticality or 0), measures.event)
    )
    cut_sets = _cut_sets(solution, listed)
    solved = time.perf_counter() - started
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
        "minimal_cut_sets": cut_sets,
        "importance": [_plain(measures) | {"source": sources[measures.event]} for measures in importance],
        "structure": to_document(tree),
        "diagram_nodes": solution.nodes,
        "seconds": {"read": read_s, "solve": solved, "total": solved + (read_s or 0)},
    }


def _enclosed(solution: Solution, exact: Fraction | None) -> tuple[float | None, float | None, float | None]:
    """The probability and the doubles around it: next to it when it is known exactly."""
    if exact is None:
        return (solution.probability, *(solution.bounds or (None, None)))
    nearest = float(exact)
    low = nearest if nearest <= exact else math.nextafter(nearest, 0)
    return nearest, low, nearest if nearest >= exact else math.nextafter(nearest, 1)


def _cut_sets(solution: Solution, listed: int) -> dict[str, Any]:
    """Counts by order, and the smallest sets with their probabilities; how many are left out is said."""
    chances = {event.name: event.chance for event in solution.tree.events}
    sets = sorted(itertools.islice(solution.cut_sets(), listed), key=lambda cut_set: (len(cut_set), cut_set))
    rows = []
    for cut_set in sets:
        known = [chance[0] for name in cut_set if (chance := chances[name])]
        rows.append({"events": list(cut_set), "probability": math.prod(known) if len(known) == len(cut_set) else None})
    count = sum(solution.counts)
    return {
        "count": count,
        "by_order": {str(order): number for order, number in enumerate(solution.counts) if number},
        "sets": rows,
        "not_listed": count - len(rows),
    }


def _plain(measures: Importance[float]) -> dict[str, Any]:
    return {key: "inf" if value == math.inf else value for key, value in asdict(measures).items()}
