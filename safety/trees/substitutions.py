"""Substitutions of Open-PSA MEF: what an analyst knows of combinations of events that the gates do not say.

A substitution without sources is a statement: whenever its hypothesis holds, its target does. `stated` applies these
exactly, as conditions on the top event: top and (not hypothesis or target). One with sources is a rule on cut sets: in
every cut set that fulfils its hypothesis the target takes the place of the sources. `exchanged` applies these, in the
order given; their result is defined for coherent trees only and depends on the cut sets, not on the function.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from safety.trees.as_written import TreeError
from safety.trees.tree import FaultTree, Gate, HouseEvent

MOST = 100_000  # cut sets to which substitutions with sources are applied
KINDS = ("", "delete-terms", "recovery-rule", "exchange-event")


@dataclass(frozen=True)
class Substitution:
    """`hypothesis` names a gate or event, `target` a basic event or a truth value, `sources` basic events.

    Raises TreeError: unknown kind, sources missing or superfluous, a target that does not fit the kind.
    """

    name: str
    hypothesis: str
    target: str | bool
    kind: str = ""
    sources: tuple[str, ...] = ()
    description: str = ""

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise self._error(f'is of type "{self.kind}", expected {", ".join(KINDS[1:])} or none')
        if self.kind == "delete-terms" and (self.target is not False or self.sources):
            raise self._error("deletes terms, so its target is false and it has no source; correct it")
        if self.kind == "exchange-event" and not self.sources:
            raise self._error("exchanges events and has no source; name the events to be replaced")
        if self.kind in ("recovery-rule", "exchange-event") and not isinstance(self.target, str):
            raise self._error("has a truth value as target, expected a basic event; name one")

    def _error(self, what: str) -> TreeError:
        return TreeError(f'substitution "{self.name}" {what}', self.name)

    @property
    def declarative(self) -> bool:
        """Whether it is a statement on events, not a rule on cut sets."""
        return not self.sources


def stated(tree: FaultTree, substitutions: Iterable[Substitution]) -> FaultTree:
    """`tree` under the substitutions that are statements; its top is then "NAME, substituted"."""
    every = [one for one in substitutions if one.declarative]
    if not every:
        return tree
    gates, houses = list(tree.gates), list(tree.house_events)
    top = _free(f"{tree.top}, substituted", tree)
    conditions = []
    for one in every:
        conditions.append(_free(f"{one.name}, substitution", tree))
        denied = f"{conditions[-1]}/1"
        gates.append(Gate(denied, "not", (one.hypothesis,), inside=conditions[-1]))
        target = one.target
        if isinstance(target, bool):
            target = f"{conditions[-1]}/2"
            houses.append(HouseEvent(target, one.target is True))
        gates.append(Gate(conditions[-1], "or", (denied, target), description=one.description))
    gates.append(Gate(top, "and", (tree.top, *conditions)))
    return replace(tree, top=top, gates=tuple(gates), house_events=tuple(houses))


def exchanged(tree: FaultTree, substitutions: Iterable[Substitution]) -> FaultTree:
    """The tree of the cut sets of `tree` after the substitutions with sources.

    Raises TreeError for a tree with negations, whose cut sets do not determine its function.
    """
    from safety.trees.drawn.from_cut_sets import from_cut_sets
    from safety.trees.solve import solve

    if negated := [gate.name for gate in tree.inputs_first if gate.kind in ("not", "xor")]:
        raise TreeError(
            f'gate "{negated[0]}" negates; substitutions with sources are rules on the cut sets of coherent trees only',
            negated[0],
        )
    solution = solve(tree)
    if sum(solution.counts) > MOST:
        raise TreeError(
            f'fault tree "{tree.name}" has {sum(solution.counts)} minimal cut sets, substitutions with sources are '
            f"applied to at most {MOST}; state them without sources"
        )
    sets = {frozenset(cut_set) for cut_set in solution.cut_sets()}
    for one in substitutions:
        if not one.declarative:
            hypothesis = _condition(tree, one.hypothesis)
            sets = {_changed(cut_set, one) if hypothesis.occurs(cut_set) else cut_set for cut_set in sets}
    minimal = _minimal(sets)
    used = set().union(*minimal)
    drawn = from_cut_sets(tree.top, minimal, [event for event in tree.events if event.name in used])
    return replace(drawn, name=tree.name, description=tree.description, mission_time_h=tree.mission_time_h)


def _minimal(sets: Iterable[frozenset[str]]) -> list[frozenset[str]]:
    """The sets that contain no other."""
    kept: list[frozenset[str]] = []
    beginning: dict[str, list[frozenset[str]]] = {}  # kept ones by their first event
    for one in sorted(sets, key=lambda one: (len(one), sorted(one))):
        if not one:
            return [one]
        if not any(other <= one for event in one for other in beginning.get(event, ())):
            kept.append(one)
            beginning.setdefault(min(one), []).append(one)
    return kept


def _changed(cut_set: frozenset[str], one: Substitution) -> frozenset[str]:
    assert isinstance(one.target, str)
    return cut_set - set(one.sources) | {one.target}


def _condition(tree: FaultTree, name: str) -> FaultTree:
    """The tree whose top occurs when the gate or event `name` does."""
    top = _free("hypothesis", tree)
    return replace(tree, top=top, gates=(*tree.gates, Gate(top, "or", (name,))))


def _free(name: str, tree: FaultTree) -> str:
    while name in tree.nodes:
        name += "'"
    return name
