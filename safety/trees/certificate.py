"""The certificate of a solved fault tree: all that it takes to see without us that the result is right.

One JSON document: the tree, the order of its events, the simplified gates, the nodes of the diagrams, the bounds of the
probability, the minimal cut sets by order. `check_tree.py`, which imports nothing of ours, describes and checks it.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from safety.trees.check_tree import FORMAT
from safety.trees.solve import Solution
from safety.trees.tree import BasicEvent, FaultTree

KINDS = ("and", "or", "vote", "xor")  # of the kernel's gates, by number


def certificate(solution: Solution) -> dict[str, Any]:
    """The document; of the order of the diagram's nodes in size.

    The probability is None where an event has none; an event whose probability is an expression stands with the double
    that this comes to. Raises TooLarge.
    """
    order = _order(solution)
    tree, reduced = _tree(solution.tree), _reduced(solution, order)
    return {
        "format": FORMAT,
        "sha256": {"tree": _sha256(tree), "reduced": _sha256(reduced)},
        "order": [solution.events[number - 1] for number in order],
        "tree": tree,
        "reduced": reduced,
        "diagram": _diagram(solution, order),
        "probability": solution.bounds,
        "cut_sets_by_order": solution.counts,
    }


def write(solution: Solution, path: Path) -> None:
    """Write the certificate. Raises TooLarge."""
    path.write_text(json.dumps(certificate(solution), separators=(",", ":")), encoding="utf-8")


def _sha256(part: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(part, sort_keys=True).encode()).hexdigest()


def _order(solution: Solution) -> Mapping[int, int]:
    """The reference of each event by its number: first those of the diagrams, a module's in its place."""
    inside: dict[int, list[int]] = {}
    for part in solution.parts:
        inside[part.number] = [event for number in part.order for event in inside.get(number, [number])]
    every = range(1, len(solution.events) + 1)
    order = dict.fromkeys([*inside[solution.parts[-1].number], *every])
    return {number: 2 * place for place, number in enumerate(order, 1)}


def _tree(tree: FaultTree) -> dict[str, Any]:
    return {
        "name": tree.name,
        "gates": [[gate.name, gate.kind, list(gate.inputs), gate.k] for gate in tree.inputs_first],
        "top": tree.top,
        "events": [[event.name, _chance(event)] for event in tree.events],
        "house_events": [[house.name, house.state] for house in tree.house_events],
    }


def _chance(event: BasicEvent) -> str | None:
    if event.exact_chance is not None:
        return str(event.exact_chance[0])
    if event.rate_per_hour is not None and event.mission_time_h is not None:
        return f"1-exp(-{event.rate_per_hour * event.mission_time_h})"
    return None if event.chance is None else repr(event.chance[0])


def _reduced(solution: Solution, order: Mapping[int, int]) -> dict[str, Any]:
    graph = solution.graph

    def reference(literal: int) -> int:
        return order.get(literal >> 1, literal & ~1) | literal & 1

    gates = []
    for index in range(graph.variables + 1, graph.variables + 1 + len(graph)):
        kind, k, inputs = graph.gate(index)
        gates.append([KINDS[kind], k, [reference(literal) for literal in inputs]])
    return {"gates": gates, "root": reference(graph.root)}


def _diagram(solution: Solution, order: Mapping[int, int]) -> dict[str, Any]:
    reference = dict(order)  # of events and modules
    nodes: list[tuple[int, int, int]] = []
    for part in solution.parts:
        shift = 2 * (len(order) + len(nodes))
        diagram, variables = part.diagram, [reference[number] for number in part.order]
        edges = [*range(2), *range(shift + 2, shift + 2 * diagram.nodes)]
        rows = zip(diagram.level[1:], diagram.high[1:], diagram.low[1:], strict=True)
        nodes += [(variables[level], edges[high], edges[low]) for level, high, low in rows]
        reference[part.number] = edges[diagram.root]
    return {"nodes": nodes, "root": reference[solution.parts[-1].number]}
