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
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from safety.trees.as_written import TreeError
from safety.trees.module_diagrams import BUDGETS, TooLarge
from safety.trees.solve import solve
from safety.trees.tree import BasicEvent, FaultTree, Gate

AT_ONCE = 16  # gates that share a diagram, unless it grows too large
SHARED_BUDGETS = (20_000, 200_000, 1_000_000)  # nodes


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

    For each few gates three diagrams are built, with events that choose a gate and hold it. Raises TreeError (a name
    that is no gate, an event below the top without a probability) and TooLarge.
    """
    wanted = [gate.name for gate in tree.inputs_first if not gate.inside] if gates is None else list(gates)
    for name in wanted:
        if not isinstance(tree.nodes.get(name), Gate):
            raise TreeError(f'fault tree "{tree.name}" has no gate "{name}"; name one of its gates', name)
    top = solve(tree).probability
    if top is None:
        unknown = next(event.name for event in tree.events if event.chance is None)
        raise TreeError(
            f'basic event "{unknown}" has no probability, so gates have no importance; give it one', unknown
        )
    others = [name for name in wanted if name != tree.top]
    held: dict[str, Sequence[float]] = {tree.top: (1.0, 0.0)}
    seen: dict[str, Sequence[float]] = {tree.top: (top, top)}
    for first in range(0, len(others), AT_ONCE):
        some = others[first : first + AT_ONCE]
        held |= _together(_held, tree, some)
        seen |= _together(_seen, tree, some)
    return {name: _measures(name, top, *held[name], *seen[name]) for name in wanted}


def _measures(
    gate: str, top: float, held_true: float, held_false: float, probability: float, both: float
) -> GateImportance:
    birnbaum = held_true - held_false
    given = both / probability if probability else None
    if top == 0:
        return GateImportance(gate, probability, birnbaum, None, None, None, None, None, given)
    return GateImportance(
        gate,
        probability,
        birnbaum,
        criticality=probability * birnbaum / top,
        fussell_vesely=(top - held_false) / top,
        diagnostic=both / top,
        risk_achievement_worth=held_true / top,
        risk_reduction_worth=top / held_false if held_false else math.inf,
        top_given_gate=given,
    )


Pairs = dict[str, Sequence[float]]  # two figures for each gate


def _together(
    ask: Callable[[FaultTree, Sequence[str], Sequence[int]], Pairs], tree: FaultTree, gates: Sequence[str]
) -> Pairs:
    """What is asked of all gates in one diagram, or in more where that would be too large. Raises TooLarge."""
    if len(gates) == 1:
        return ask(tree, gates, BUDGETS)
    try:
        return ask(tree, gates, SHARED_BUDGETS)
    except TooLarge:
        middle = len(gates) // 2
        return _together(ask, tree, gates[:middle]) | _together(ask, tree, gates[middle:])


def _held(tree: FaultTree, gates: Sequence[str], budgets: Sequence[int]) -> Pairs:
    """P1 and P0: each gate becomes "(itself or one event) and another event", which are false and true unless held."""
    own, either, yes, no = (_fresh(tree, mark) for mark in ("own ", "either ", "true ", "not false "))
    changed: list[Gate] = []
    for gate in tree.gates:
        name = gate.name
        if name in gates:
            changed += [
                replace(gate, name=own + name),
                Gate(either + name, "or", (own + name, yes + name)),
                Gate(name, "and", (either + name, no + name)),
            ]
        else:
            changed.append(gate)
    choices = {mark + name: (mark == yes, name) for name in gates for mark in (yes, no)}
    columns = [(state, name) for name in gates for state in (True, False)]

    def chosen(event: str, column: tuple[bool, str]) -> bool:
        state, name = column
        holds, of = choices[event]
        return (state and name == of) if holds else (state or name != of)

    more = replace(tree, gates=tuple(changed), events=(*tree.events, *map(_choice, choices)))
    found = _asked(more, choices, columns, chosen, budgets)
    return {name: found[2 * n : 2 * n + 2] for n, name in enumerate(gates)}


def _seen(tree: FaultTree, gates: Sequence[str], budgets: Sequence[int]) -> Pairs:
    """P(gate) and P(gate and top): the gate is chosen by an event."""
    chosen, this, one, both = (_fresh(tree, mark) for mark in ("chosen ", "this ", "one", "both"))
    choosing = [Gate(this + name, "and", (chosen + name, name)) for name in gates]
    chosen_gate = Gate(one, "or", tuple(gate.name for gate in choosing))
    choices = {chosen + name: name for name in gates}
    more = replace(
        tree,
        gates=(*tree.gates, *choosing, chosen_gate, Gate(both, "and", (one, tree.top))),
        events=(*tree.events, *map(_choice, choices)),
    )
    alone, with_top = (
        _asked(replace(more, top=top), choices, gates, lambda event, name: choices[event] == name, budgets)
        for top in (one, both)
    )
    return {name: pair for name, *pair in zip(gates, alone, with_top, strict=True)}


def _asked(
    tree: FaultTree,
    choices: Collection[str],
    columns: Sequence[Any],
    chosen: Callable[[str, Any], bool],
    budgets: Sequence[int],
) -> list[float]:
    """The probability of the top by column, where the events in `choices` are true or false."""
    values = array("d")
    for event in tree.events:
        if event.name in choices:
            values.extend(float(chosen(event.name, column)) for column in columns)
        else:
            chance = event.chance or (0.0, 1.0)  # unknown only where the top does not reach
            values.extend([chance[0]] * len(columns))
    return list(solve(tree, budgets).many(values))


def _choice(name: str) -> BasicEvent:
    return BasicEvent(name, Fraction(1, 2))


def _fresh(tree: FaultTree, mark: str) -> str:
    """The mark, or one like it, with which no name of the tree begins."""
    while any(name.startswith(mark) for name in tree.nodes):
        mark = "another " + mark
    return mark
