"""Independent parts of a fault tree: gates that share nothing below them with the rest of the tree.

A module may be analysed alone and stand as a single variable in the tree above it.

Source: Y. Dutuit and A. Rauzy, "A Linear-Time Algorithm to Find Modules of Fault Trees", IEEE Trans. Reliability 45
(1996).
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from safety.trees.tree import FaultTree, Gate, HouseEvent

MONOTONE = ("and", "or", "vote")


@dataclass(frozen=True)
class Module:
    """`gates`, inputs first and the module's own last, over `variables`: basic events and modules below it."""

    gates: tuple[Gate, ...]
    variables: tuple[str, ...]  # as a depth-first walk from the module's gate meets them

    @property
    def top(self) -> str:
        """The name of the gate whose function this is."""
        return self.gates[-1].name


def find_modules(tree: FaultTree) -> list[Module]:
    """The modules of `tree`, each after those it uses; the last is the whole tree.

    Below the top only monotone modules (and, or, vote throughout) are split off: a negated part contributes no cut
    sets of its own.
    """
    tops = _module_gates(tree)
    return [_between(tree, gate.name, tops) for gate in tree.inputs_first if gate.name in tops]


@dataclass
class _Visits:
    """When a depth-first walk that enters each gate once came by a node."""

    entered: int
    last: int
    left: int = 0


def _walk(tree: FaultTree) -> dict[str, _Visits]:
    """Visits to everything but house events, which as constants tie nothing together."""
    visits: dict[str, _Visits] = {}
    agenda = [(tree.top, False)]
    date = 0
    while agenda:
        date += 1
        name, leaving = agenda.pop()
        if leaving:
            visits[name].left = date
        elif name in visits:
            visits[name].last = date
        elif not isinstance(node := tree.nodes[name], HouseEvent):
            visits[name] = _Visits(date, date)
            if isinstance(node, Gate):
                agenda.append((name, True))
                agenda.extend((below, False) for below in reversed(node.inputs))
    return visits


def _module_gates(tree: FaultTree) -> set[str]:
    """The top, and each monotone gate with all visits to what is below it between entering and leaving it."""
    visits = _walk(tree)
    span: dict[str, tuple[int, int]] = {name: (seen.entered, seen.last) for name, seen in visits.items()}
    monotone: set[str] = set()
    modules = {tree.top}
    for gate in tree.inputs_first:
        below = [span[name] for name in gate.inputs if name in span]
        if gate.kind in MONOTONE and all(
            name in monotone or not isinstance(tree.nodes[name], Gate) for name in gate.inputs
        ):
            monotone.add(gate.name)
            own = visits[gate.name]
            if all(own.entered < earliest and latest < own.left for earliest, latest in below):
                modules.add(gate.name)
        earliest, latest = span[gate.name]
        span[gate.name] = min([earliest, *(e for e, _ in below)]), max([latest, *(late for _, late in below)])
    return modules


def _between(tree: FaultTree, top: str, modules: Collection[str]) -> Module:
    """The gates from `top` down to the modules and basic events below it."""
    gates: dict[str, Gate] = {}
    variables: dict[str, None] = {}
    agenda = [(top, False)]
    while agenda:
        name, leaving = agenda.pop()
        node = tree.nodes[name]
        if isinstance(node, HouseEvent) or name in gates:
            continue
        if not isinstance(node, Gate) or (name in modules and name != top):
            variables[name] = None
        elif leaving:
            gates[name] = node
        else:
            agenda.append((name, True))
            agenda.extend((below, False) for below in reversed(node.inputs))
    return Module(tuple(gates.values()), tuple(variables))
