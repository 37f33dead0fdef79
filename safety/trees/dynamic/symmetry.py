"""Equal parts of a dynamic tree that may change places: states that differ only in that are one state.

Two inputs of an and, or or vote gate are interchangeable when exchanging them, with all below and what triggers it,
gives the same tree back (the same gates, rates, dependencies, restrictions). Sorting such parts in every state keeps
the chain exact, as long as events that may change places have the same rate.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from safety.trees.dynamic.rules import Columns, Rules
from safety.trees.dynamic.tree import STATIC, DynamicGate, DynamicTree, TimedEvent

Block = tuple[str, ...]  # the elements of a part, in the same order as in the parts it may change places with


class Symmetry:
    """The groups of interchangeable parts of a tree, inner ones first, as rows of its states."""

    def __init__(self, rules: Rules) -> None:
        self.groups = groups(rules.tree)
        self.rows = [np.array([_rows(rules, block) for block in group], np.intp) for group in self.groups]

    @property
    def equal_events(self) -> tuple[frozenset[str], ...]:
        """Events that must have the same rate for the states to be right."""
        return tuple(frozenset(alike) for group in self.groups for alike in zip(*group, strict=True))

    def sort(self, columns: Columns) -> Columns:
        """The same states with interchangeable parts in order, in place."""
        for rows in self.rows:
            count, height = rows.shape
            parts = np.ascontiguousarray(columns[rows.ravel()].T).reshape(-1, count, height)
            order = np.argsort(parts.view(f"S{height}")[:, :, 0], axis=1, kind="stable")
            columns[rows.ravel()] = np.take_along_axis(parts, order[:, :, None], 1).reshape(-1, count * height).T
        return columns


def _rows(rules: Rules, block: Block) -> list[int]:
    elements = [rules.row[name] for name in block]
    used = {rule.row: rule.used for rule in rules.spares}
    return [
        *elements,
        *(used[row] for row in elements if row in used),
        *(rules.on[row] for row in elements if row in rules.on),
        *(rules.due[row] for row in elements if row in rules.due),
    ]


def groups(tree: DynamicTree) -> list[list[Block]]:
    """Groups of interchangeable parts, those below a gate before those above."""
    described = _described(tree, {})
    found: list[list[Block]] = []
    for gate in tree.inputs_first:
        if gate.kind not in STATIC:
            continue
        left = list(gate.inputs)
        while left:
            first, *rest = left
            blocks: list[Block] = []
            for other in rest:
                pairs = _matched(tree, first, other)
                if pairs is not None and _described(tree, pairs | {b: a for a, b in pairs.items()}) == described:
                    blocks = blocks or [tuple(pairs)]
                    if tuple(pairs) == blocks[0]:
                        blocks.append(tuple(pairs.values()))
                        left.remove(other)
            left.remove(first)
            if blocks:
                found.append(blocks)
    return found


def _matched(tree: DynamicTree, one: str, other: str) -> dict[str, str] | None:
    """What takes whose place when `one` and `other` are exchanged; None where they have another form."""
    pairs: dict[str, str] = {}
    agenda = [(one, other)]
    while agenda:
        a, b = agenda.pop()
        if a == b or pairs.get(a) == b:
            continue
        if a in pairs or b in pairs or b in pairs.values() or a in pairs.values():
            return None
        here, there = tree.nodes[a], tree.nodes[b]
        if isinstance(here, DynamicGate) and isinstance(there, DynamicGate):
            if (here.kind, here.k, len(here.inputs)) != (there.kind, there.k, len(there.inputs)):
                return None
            agenda += zip(reversed(_in_order(tree, here)), reversed(_in_order(tree, there)), strict=True)
        elif isinstance(here, DynamicGate) or isinstance(there, DynamicGate) or _figures(here) != _figures(there):
            return None
        pairs[a] = b
        around = _tied(tree, a), _tied(tree, b)
        if len(around[0]) != len(around[1]):
            return None
        agenda += zip(*around, strict=True)
    return pairs


def _tied(tree: DynamicTree, name: str) -> list[str]:
    """What triggers `name`, and what it triggers, in the order written."""
    triggers = [d.trigger for d in tree.dependencies if name in d.dependents]
    return triggers + [one for d in tree.dependencies if d.trigger == name for one in d.dependents]


def _in_order(tree: DynamicTree, gate: DynamicGate) -> list[str]:
    """The inputs; where their order is free, alike ones by size and figures."""
    return sorted(gate.inputs, key=lambda name: _form(tree, name)) if gate.kind in STATIC else list(gate.inputs)


def _form(tree: DynamicTree, name: str) -> tuple[Any, ...]:
    node = tree.nodes[name]
    if isinstance(node, TimedEvent):
        return "", 1, *_figures(node)
    return node.kind, len(tree.below[name])


def _figures(event: TimedEvent) -> tuple[Any, ...]:
    rate, chance = event.rate_per_hour, event.probability
    return -1 if rate is None else rate, -1 if chance is None else chance, event.dormancy


def _described(tree: DynamicTree, place: Mapping[str, str]) -> set[Any]:
    """The tree as a set of facts, each name replaced by the one whose place it takes."""

    def at(name: str) -> str:
        return place.get(name, name)

    facts: set[Any] = {(at(event.name), _figures(event)) for event in tree.events}
    for gate in tree.gates:
        inputs = [at(name) for name in gate.inputs]
        ordered = frozenset(inputs) if gate.kind in STATIC else tuple(inputs)
        facts.add((at(gate.name), gate.kind, gate.k, gate.exclusive, ordered))
    for dependency in tree.dependencies:
        for dependent in dependency.dependents:
            together = frozenset(map(at, dependency.dependents)) if dependency.probability != 1 else None
            facts.add(("dependency", at(dependency.trigger), at(dependent), dependency.probability, together))
    for restriction in tree.restrictions:
        inputs = [at(name) for name in restriction.inputs]
        facts.add((restriction.kind, frozenset(inputs) if restriction.kind == "mutex" else tuple(inputs)))
    return facts
