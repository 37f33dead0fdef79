"""Parts of a dynamic tree that can be solved apart (J. B. Dugan and others: modules by Markov chain, the rest by BDD).

A gate may be cut out, and stand as one event with a probability at each time, when nothing but its own failure links it
to the rest and only the fact of its failure counts there, not the order:

1. only static gates lie between it and the top, so that it is active from the start and its order is not asked;
2. whatever lies below it, every trigger of a dependent of it, and every seq or mutex over part of it with all inputs,
   has all its gates (but for the gate itself) in that same set: no event and no spare unit is shared with the rest;
3. every dependency that touches the set lies in it whole.

A static gate whose inputs fall into groups without a link between them is solved group by group.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

from safety.trees.dynamic.tree import STATIC, DynamicGate, DynamicTree
from safety.trees.tree import BasicEvent, FaultTree, Gate


@dataclass(frozen=True)
class Part:
    """What gate `name` comes from: a `static` tree, whose events may be parts before it, or a `dynamic` one."""

    name: str
    static: FaultTree | None = None
    dynamic: DynamicTree | None = None


def parts(tree: DynamicTree) -> tuple[Part, ...]:
    """The parts of `tree`, each after those it uses; the last is the top."""
    return tuple(_parts(whole(tree)))


def _parts(tree: DynamicTree) -> list[Part]:
    links = _Links(tree)
    fate = links.fates
    if fate[tree.top] == "inside":
        return _static(tree, links, fate)
    gate = tree.nodes[tree.top]
    assert isinstance(gate, DynamicGate)
    free = gate.kind in ("and", "or", "inhibit") and not any(gate.name in restricted for restricted in links.restricted)
    groups = links.groups(gate) if free else []
    if len(groups) < 2:
        return [Part(tree.top, dynamic=tree)]
    found: list[Part] = []
    inputs = []
    for at, group in enumerate(groups, 1):
        mine = [name for name in gate.inputs if name in group]
        node = tree.nodes[mine[0]]
        if len(mine) == 1 and (isinstance(node, DynamicGate) or mine[0] not in links.tied):
            inputs.append(mine[0])
        else:
            name = f"{gate.name}/{at}"
            while name in tree.nodes:
                name += "'"
            inputs.append(name)
            group = group | {name}
            kind = gate.kind if len(mine) > 1 else "or"
            tree = replace(tree, gates=(*tree.gates, DynamicGate(name, kind, tuple(mine))))
        if isinstance(tree.nodes[inputs[-1]], DynamicGate):
            found += _parts(_only(tree, inputs[-1], group))
    return [*found, _diagram(gate.name, [replace(gate, inputs=tuple(inputs))], inputs)]


def _static(tree: DynamicTree, links: _Links, fate: dict[str, str]) -> list[Part]:
    """The static gates from the top down to events and to gates that are parts of their own."""
    seen: dict[str, None] = {}
    agenda = [tree.top]
    while agenda:
        name = agenda.pop()
        if name in seen:
            continue
        seen[name] = None
        node = tree.nodes[name]
        if isinstance(node, DynamicGate) and fate[name] == "inside":
            agenda += reversed(node.inputs)
    modules = [name for name in seen if fate[name] == "module"]
    found = [part for name in modules for part in _parts(_only(tree, name, links.set_of(name)))]
    inside = [g for g in tree.inputs_first if g.name in seen and fate[g.name] == "inside"]
    names = {gate.name for gate in inside}
    return [*found, _diagram(tree.top, inside, [name for name in seen if name not in names])]


def _diagram(top: str, gates: Iterable[DynamicGate], variables: Iterable[str]) -> Part:
    """A static part; the probability of a variable follows from the time, or from the part of the same name."""
    plain = tuple(Gate(g.name, "and" if g.kind == "inhibit" else g.kind, g.inputs, g.k) for g in gates)
    return Part(top, static=FaultTree(top, top, plain, tuple(BasicEvent(name) for name in variables)))


def _only(tree: DynamicTree, top: str, names: Iterable[str]) -> DynamicTree:
    """The tree of these elements alone."""
    keep = set(names)
    return DynamicTree(
        top,
        top,
        tuple(gate for gate in tree.gates if gate.name in keep),
        tuple(event for event in tree.events if event.name in keep),
        tuple(d for d in tree.dependencies if d.trigger in keep),
        tuple(r for r in tree.restrictions if r.inputs[0] in keep),
    )


def whole(tree: DynamicTree) -> DynamicTree:
    """`tree` without what has no link to its top at all."""
    links = _Links(tree)
    return _only(tree, tree.top, links.component(tree.top, without=""))


class _Links:
    def __init__(self, tree: DynamicTree) -> None:
        self.tree = tree
        self.users: dict[str, set[str]] = {name: set() for name in tree.nodes}
        for gate in tree.gates:
            for name in gate.inputs:
                self.users[name].add(gate.name)
        self.restricted = [frozenset().union(*(tree.below[name] for name in r.inputs)) for r in tree.restrictions]

    @cached_property
    def tied(self) -> set[str]:
        """Events whose failure others can bring about or hold back."""
        dependents = {name for dependency in self.tree.dependencies for name in dependency.dependents}
        return dependents.union(*self.restricted)

    @cached_property
    def fates(self) -> dict[str, str]:
        """Of every event and gate as an input of static gates: a variable or gate "inside" their diagram, a "module" to
        be solved apart, or "outside" of what a diagram can hold."""
        fate = {event.name: "outside" if event.name in self.tied else "inside" for event in self.tree.events}
        for gate in self.tree.inputs_first:
            if gate.kind in STATIC and all(fate[name] != "outside" for name in gate.inputs):
                fate[gate.name] = "inside"
            else:
                fate[gate.name] = "module" if self.is_module(gate.name) else "outside"
        return fate

    def set_of(self, name: str) -> frozenset[str]:
        """All that the time of failure of `name` can hang on."""
        found = set(self.tree.below[name])
        while True:
            size = len(found)
            for dependency in self.tree.dependencies:
                if not found.isdisjoint(dependency.dependents):
                    found |= self.tree.below[dependency.trigger]
            for restricted in self.restricted:
                if not found.isdisjoint(restricted):
                    found |= restricted
            if len(found) == size:
                return frozenset(found)

    def is_module(self, name: str) -> bool:
        """Conditions 2 and 3; the caller sees to the first."""
        mine = self.set_of(name)
        return (
            mine.isdisjoint(self.users[name])
            and all(self.users[one] <= mine for one in mine if one != name)
            and all(
                mine.issuperset(touched) or mine.isdisjoint(touched)
                for touched in ({d.trigger, *d.dependents} for d in self.tree.dependencies)
            )
        )

    def groups(self, gate: DynamicGate) -> list[set[str]]:
        """The elements other than `gate`, in groups without a link; those only that hold an input of it."""
        found: list[set[str]] = []
        for name in gate.inputs:
            if not any(name in group for group in found):
                found.append(self.component(name, without=gate.name))
        return found

    def component(self, start: str, without: str) -> set[str]:
        """All that is linked to `start`, directly or not, other than by way of the gate `without`."""
        ties = [{d.trigger, *d.dependents} for d in self.tree.dependencies] + [
            {*r.inputs} for r in self.tree.restrictions
        ]
        found: set[str] = set()
        agenda = [start]
        while agenda:
            name = agenda.pop()
            if name in found or name == without:
                continue
            found.add(name)
            node = self.tree.nodes[name]
            agenda += self.users[name]
            agenda += node.inputs if isinstance(node, DynamicGate) else ()
            agenda += [other for tie in ties if name in tie for other in tie]
        return found
