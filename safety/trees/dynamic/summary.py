"""What a results document says of a dynamic tree: the entry of "trees", with plain numbers, lists and texts only."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from safety.rates.enclosure import INFINITE, Enclosure, Extended
from safety.rates.exceptions import NumericsFailed
from safety.trees.as_written import Rational
from safety.trees.dynamic.mean import bounded_mean_time
from safety.trees.dynamic.sequences import LONGEST, cut_sequences
from safety.trees.dynamic.solve import DynamicSolution, checked_time, joined_tree, solve_dynamic
from safety.trees.dynamic.tree import DynamicTree
from safety.trees.formats.draft import at
from safety.trees.formats.galileo import to_galileo
from safety.trees.importance.events import plain
from safety.trees.module_diagrams import TooLarge
from safety.trees.solve import solve
from safety.trees.summary import LISTED, cut_set_rows

POINTS = 20  # of the curve, evenly spread over the mission time
MEAN_BUDGET = 20_000  # states of the whole tree as one chain, for the mean time
SHOWN = 10  # cut sequences of a part, in the text
NO_TAGS: Mapping[str, str] = {}
EXACT_DIGITS = 200  # longest exact rational written out


def dynamic_summary(
    tree: DynamicTree,
    mission_time_h: Rational | None = None,
    *,
    source: str = "",
    read_s: float | None = None,
    ties: str = "refuse",
    solution: DynamicSolution | None = None,
    tags: Mapping[str, str] = NO_TAGS,
) -> dict[str, Any]:
    """Solve `tree`, unless its `solution` is given, and give its entry for the "trees" of a results document.

    "probability" is that of the top by `mission_time_h` (None without). Where parts were solved apart, cut sets and
    importance are those of the static tree that joins them, in which a dynamic part stands as one event of its name.
    "dynamic" holds mean time to failure, probability of ever failing, the parts and the curve. `tags` are the source
    tags of basic events. Raises TreeError where the order of simultaneous failures would change the result and
    ties="refuse", TooLarge, NumericsFailed.
    """
    started = time.perf_counter()
    with at(source):
        solution = solution or solve_dynamic(tree, ties=ties)
    end = None if mission_time_h is None else checked_time(mission_time_h, "mission_time_h")
    times = [] if end is None else [end * at / POINTS for at in range(POINTS + 1)]
    curves = solution.curves(times)
    top = _figure(curves[tree.top][-1] if times else None)
    joined = None if end is None else _joined(solution, end)
    entry = {
        "id": tree.name,
        "description": "",
        "source": source,
        "gates": len(tree.gates),
        "basic_events": len(tree.events),
        "probability": top["value"],
        "probability_low": top["low"],
        "probability_high": top["high"],
        "exact": None,
        "minimal_cut_sets": None if joined is None else cut_set_rows(joined, LISTED),
        "importance": [] if joined is None else _importance(joined, _with_parts(solution, tags)),
        "structure": _structure(tree, tags),
        "dynamic": {
            "elements": list(tree.dynamic_elements),
            "ties": ties,
            "mission_time_h": None if end is None else float(end),
            "mean_time_h": _mean_time(solution),
            "ever": _figure(solution.ever),
            "parts": [_part(solution, name, curves[name], bool(times)) for name in solution.chains],
            "curve": {
                "hours": [float(at) for at in times],
                "probability": [float(one.middle) for one in curves[tree.top]],
            },
            "galileo": to_galileo(tree),
        },
    }
    solved = time.perf_counter() - started
    return entry | {"seconds": {"read": read_s, "solve": solved, "total": solved + (read_s or 0)}}


def _structure(tree: DynamicTree, tags: Mapping[str, str]) -> dict[str, Any]:
    """What the picture shows: gates and events, and beside them what depends on a trigger and what is restricted."""
    gates = [{"name": one.name, "kind": one.kind, "inputs": list(one.inputs), "k": one.k} for one in tree.gates]
    numbers = ("rate_per_hour", "probability")
    events = [
        {"name": one.name}
        | {key: str(getattr(one, key)) for key in numbers if getattr(one, key) is not None}
        | ({"source": tags[one.name]} if tags.get(one.name) else {})
        for one in tree.events
    ]
    return {
        "name": tree.name,
        "top": tree.top,
        "gates": [{key: value for key, value in gate.items() if value is not None} for gate in gates],
        "basic_events": events,
        "dependencies": [
            {
                "name": one.name,
                "kind": "fdep" if one.probability == 1 else "pdep",
                "inputs": [one.trigger, *one.dependents],
            }
            for one in tree.dependencies
        ],
        "restrictions": [{"name": one.name, "kind": one.kind, "inputs": list(one.inputs)} for one in tree.restrictions],
    }


def _joined(solution: DynamicSolution, end: Fraction) -> Any:
    tree = joined_tree(solution, end)
    return None if tree is None else solve(tree)


def _with_parts(solution: DynamicSolution, tags: Mapping[str, str]) -> dict[str, str]:
    """The tags of events, and of the parts that rest on an assumed one."""
    chains = solution.states.items()
    parts = {name: "A" for name, states in chains if any(tags.get(event.name) == "A" for event in states.tree.events)}
    return {**tags, **parts}


def _importance(joined: Any, tags: Mapping[str, str]) -> list[dict[str, Any]]:
    rows = sorted(joined.importance().values(), key=lambda row: (-(row.criticality or 0), row.event))
    return [plain(row) | {"source": tags.get(row.event, "")} for row in rows]


def _part(solution: DynamicSolution, name: str, curve: list[Enclosure], timed: bool) -> dict[str, Any]:
    chain = solution.chains[name]
    return {
        "gate": name,
        "states": chain.states.count,
        "transitions": len(chain.source),
        "probability": _figure(curve[-1] if timed else None),
        "mean_time_h": _figure(chain.mean_time),
        "ever": _figure(chain.ever),
        "cut_sequences": _sequences(chain.states.tree),
    }


def _sequences(tree: DynamicTree) -> dict[str, Any]:
    """Minimal cut sequences of up to "longest" events, those with few events first."""
    try:
        rows = cut_sequences(tree)
    except TooLarge as error:
        return {"longest": LONGEST, "sets": None, "not_listed": None, "why_not": str(error)}
    sets = [
        {"events": list(row.events), "any_order": row.any_order, "orders": [list(order) for order in row.orders]}
        for row in rows[:LISTED]
    ]
    return {"longest": LONGEST, "sets": sets, "not_listed": len(rows) - len(sets)}


def _mean_time(solution: DynamicSolution) -> dict[str, Any]:
    try:
        return _figure(solution.mean_time(MEAN_BUDGET))
    except TooLarge as error:
        why_not = {"why_not": str(error)}
    try:
        return _figure(bounded_mean_time(solution)) | {"value": None} | why_not
    except NumericsFailed:
        return _figure(None) | why_not


def _figure(found: Enclosure | None) -> dict[str, Any]:
    """The middle, the doubles around it, and the exact rational where it is known and short."""
    if found is None:
        return {"value": None, "low": None, "high": None, "exact": None}
    written = str(found.low) if found.exact and found.low != INFINITE else None
    low, high = _double(found.low, 0.0), _double(found.high, math.inf)
    middle = "inf" if found.middle == INFINITE else float(found.middle)
    return {
        "value": middle,
        "low": low,
        "high": high,
        "exact": written if written and len(written) <= EXACT_DIGITS else None,
    }


def _double(value: Extended, towards: float) -> float | str:
    """The nearest double on the side of `towards`."""
    if value == INFINITE:
        return "inf"
    nearest = float(value)
    beyond = nearest > value if towards == 0.0 else nearest < value
    return math.nextafter(nearest, towards) if beyond else nearest


def dynamic_lines(entry: dict[str, Any]) -> list[str]:
    """What the entry says of dynamics, for people to read."""
    dynamic = entry["dynamic"]
    mean, ever = dynamic["mean_time_h"], dynamic["ever"]
    lines = [f"dynamic: {', '.join(dynamic['elements']) or 'nothing'}"]
    lines.append("mean time to failure: " + _told(mean))
    lines.append(f"ever fails with probability {ever['value']:.6g}")
    for part in dynamic["parts"]:
        chance = part["probability"]["value"]
        told = "" if chance is None else f", probability {chance:.6g}"
        lines.append(f"part {part['gate']}: Markov chain of {part['states']} states{told}")
        sequences = part["cut_sequences"]
        lines += [f"  {_order(one)}" for one in (sequences["sets"] or [])[:SHOWN]]
        if sequences.get("why_not"):
            lines.append(f"  cut sequences not listed: {sequences['why_not']}")
        elif more := sequences["not_listed"] + max(0, len(sequences["sets"]) - SHOWN):
            lines.append(f"  and {more} more; --json lists them")
    return lines


def _told(mean: dict[str, Any]) -> str:
    if mean["value"] == "inf":
        return "infinite, as the top may never fail"
    if mean["value"] is not None:
        return f"{mean['value']:.6g} h" + (f" (exactly {mean['exact']})" if mean["exact"] else "")
    known = "not known" if mean["low"] is None else f"between {mean['low']:.6g} and {mean['high']:.6g} h"
    return f"{known} ({mean['why_not']})"


def _order(one: dict[str, Any]) -> str:
    """In words: which events, and which orders of them, make the part fail."""
    if len(one["events"]) < 2:
        return one["events"][0] if one["events"] else "(no failure needed)"
    if one["any_order"]:
        return " & ".join(one["events"])
    return "; or ".join(", then ".join(order) for order in one["orders"])
