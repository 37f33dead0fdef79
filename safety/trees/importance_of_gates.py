"""Importance of gates: what holding a gate true or false does to the top event, and how often it occurs with it.

With P the probability of the top event and q that of the gate, P1 and P0 are the probabilities of the top event when
the gate's output is held true and held false, whatever its inputs do; the events below the gate keep their own
influence by other ways:

    birnbaum                 P1 - P0
    criticality              q (P1 - P0) / P
    fussell_vesely           (P - P0) / P, the fraction of P that vanishes with the gate
    diagnostic               P(gate | top) = P(gate and top) / P
    risk_achievement_worth   P1 / P
    risk_reduction_worth     P / P0, infinite when the top event cannot occur without the gate
    top_given_gate           P(top | gate) = P(gate and top) / q

For a gate that shares no event with the rest of the tree these are the measures of `importance` with the gate for a
basic event. For any other P is not q P1 + (1-q) P0, so that criticality and Fussell-Vesely differ, as do P1 and
P(top | gate).

Source: Y. Dutuit and A. Rauzy, "Efficient algorithms to assess component and gate importance in fault tree analysis",
Reliability Engineering and System Safety 72 (2001).
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from fractions import Fraction
from typing import Any

from safety.trees.solve import solve
from safety.trees.tree import BasicEvent, FaultTree, Gate, TreeError


@dataclass(frozen=True)
class GateImportance:
    """The measures of one gate (no unit; see the module). None where 0/0 leaves one without meaning."""

    gate: str
    probability: float
    birnbaum: float
    criticality: float | None
    fussell_vesely: float | None
    diagnostic: float | None
    risk_achievement_worth: float | None
    risk_reduction_worth: float | None
    top_given_gate: float | None


def importance_of_gates(tree: FaultTree, gates: Iterable[str] | None = None) -> dict[str, GateImportance]:
    """The measures of `gates`, by default of all that were given a name and that the top reaches.

    Two or three diagrams are built for each. Raises TreeError (a name that is no gate, an event below the top without
    a probability) and TooLarge.
    """
    reached = {gate.name: gate for gate in tree.inputs_first}
    wanted = [name for name, gate in reached.items() if not gate.inside] if gates is None else list(gates)
    for name in wanted:
        if not isinstance(tree.nodes.get(name), Gate):
            raise TreeError(f'fault tree "{tree.name}" has no gate "{name}"; name one of its gates', name)
    top = _probability(tree)
    return {name: _measures(tree, name, top) for name in wanted}


def plain(measures: GateImportance) -> dict[str, Any]:
    """The row of one gate in a results document."""
    return {key: "inf" if value == math.inf else value for key, value in asdict(measures).items()}


def _measures(tree: FaultTree, gate: str, top: float) -> GateImportance:
    q = _probability(_below(tree, gate))
    if gate == tree.top:
        held_true, held_false, both = 1.0, 0.0, q
    else:
        rest = _without(tree, gate)
        held_true, held_false = _held(rest, gate)
        both = q * held_true if _alone(tree, gate, rest) else _probability(_conjunction(tree, gate))
    birnbaum = held_true - held_false
    given = both / q if q else None
    if top == 0:
        return GateImportance(gate, q, birnbaum, None, None, None, None, None, given)
    return GateImportance(
        gate,
        q,
        birnbaum,
        criticality=q * birnbaum / top,
        fussell_vesely=(top - held_false) / top,
        diagnostic=both / top,
        risk_achievement_worth=held_true / top,
        risk_reduction_worth=top / held_false if held_false else math.inf,
        top_given_gate=given,
    )


def _probability(tree: FaultTree) -> float:
    probability = solve(tree).probability
    if probability is None:
        unknown = next(event.name for event in tree.events if event.chance is None)
        raise TreeError(
            f'basic event "{unknown}" has no probability, so gates have no importance; give it one', unknown
        )
    return probability


def _below(tree: FaultTree, top: str) -> FaultTree:
    """The tree with another top, and only what that reaches."""
    other = replace(tree, top=top)
    reached = other.inputs_first
    used = {name for gate in reached for name in gate.inputs}
    return replace(
        other,
        gates=reached,
        events=tuple(event for event in tree.events if event.name in used),
        house_events=tuple(house for house in tree.house_events if house.name in used),
    )


def _without(tree: FaultTree, gate: str) -> FaultTree:
    """The tree with a basic event in place of the gate."""
    return _below(
        replace(
            tree,
            gates=tuple(other for other in tree.gates if other.name != gate),
            events=(*tree.events, BasicEvent(gate, Fraction(1, 2))),
        ),
        tree.top,
    )


def _held(rest: FaultTree, gate: str) -> tuple[float, float]:
    """The probability of the top when the event that stands for the gate is true, and when it is false."""
    columns = array("d")
    for event in rest.events:
        chance = event.chance
        assert chance is not None, "the tree has a probability, so all of its events have"
        columns.extend((1.0, 0.0) if event.name == gate else (chance[0], chance[0]))
    held_true, held_false = solve(rest).many(columns)
    return held_true, held_false


def _alone(tree: FaultTree, gate: str, rest: FaultTree) -> bool:
    """Whether no event below the gate is one of the rest of the tree."""
    return {event.name for event in _below(tree, gate).events}.isdisjoint(event.name for event in rest.events)


def _conjunction(tree: FaultTree, gate: str) -> FaultTree:
    """The tree whose top is "gate and top"."""
    both = "both"
    while both in tree.nodes:
        both += "'"
    return replace(tree, gates=(*tree.gates, Gate(both, "and", (gate, tree.top))), top=both)
