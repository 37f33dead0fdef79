"""The fault trees behind an event tree: gates for what its paths collected, house events set as on the path.

A formula collected under changed house events is a copy of its gates, as far as they depend on these; what does not
depend on them stays shared, so that sequences are solved with all they have in common.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from safety.trees.as_written import TreeError
from safety.trees.event_trees.paths import Collected, Course, House
from safety.trees.tree import FaultTree, Gate, HouseEvent, Node

if TYPE_CHECKING:
    from safety.trees.study import Study

CERTAIN, IMPOSSIBLE = "nothing has to fail", "no failure leads here"  # house events


class Formulas:
    """Gates over those of a study, each made once. `house` are states that differ from those written, as in a phase."""

    def __init__(self, study: Study, house: Mapping[str, bool] | None = None) -> None:
        self.study = study
        self.house = dict(house or {})
        self.gates: dict[str, Gate] = {}
        self._states = {one.name: self.house.get(one.name, one.state) for one in study.house_events}
        self._written = {gate.name: gate for gate in study.gates}
        nodes: tuple[Node, ...] = (*study.gates, *study.events, *study.house_events)
        self._taken = {node.name for node in nodes}
        self._copies: dict[tuple[str, House], str] = {}

    def tree(self, name: str, courses: Sequence[Course], description: str = "") -> FaultTree:
        """The fault tree "one of `courses` is taken", for quantification (see Study.quantified). Raises TreeError."""
        paths = [self.inputs(course) for course in courses]
        if not all(paths):
            return _constant(name, True, description)
        gates = dict(self.gates)
        top = self._free(name, gates)
        if len(paths) == 1:
            gates[top] = Gate(top, "and", paths[0], description=description)
        else:
            parts = [self._path(top, number, inputs, gates) for number, inputs in enumerate(paths, 1)]
            gates[top] = Gate(top, "or", tuple(dict.fromkeys(parts)), description=description)
        tree = self.study.quantified(top, gates=gates.values(), house=self.house)
        return replace(tree, name=name, description=description)

    def whole(self) -> FaultTree | None:
        """The fault tree "anything at all", where substitutions take cases out of it; None if there are none."""
        if not any(one.declarative for one in self.study.substitutions):
            return None
        event = self.study.events[0].name
        other, top = self._free(f"not {event}", self.gates), self._free("anything", self.gates)
        gates = (*self.gates.values(), Gate(other, "not", (event,)), Gate(top, "or", (event, other)))
        return self.study.quantified(top, gates=gates, house=self.house)

    def overlap(self, courses: Sequence[Course]) -> FaultTree:
        """The fault tree "two of `courses` at once", from the formulas alone: no substitution, no common cause."""
        bound = [inputs for course in courses if (inputs := self.inputs(course))]
        left = 2 - (len(courses) - len(bound))  # a path that collected nothing is always taken
        if left <= 0:
            return _constant("two paths at once", True)
        if len(bound) < left:
            return _constant("two paths at once", False)
        return self._logic("two paths at once", bound, "vote", left)

    def gap(self, courses: Sequence[Course]) -> FaultTree:
        """The fault tree "none of `courses`", likewise."""
        bound = [self.inputs(course) for course in courses]
        return self._logic("no path", bound, "not") if all(bound) else _constant("no path", False)

    def _logic(self, name: str, bound: Sequence[tuple[str, ...]], kind: str, k: int | None = None) -> FaultTree:
        """The gate of this kind over the paths, over all that the study has."""
        gates = dict(self.gates)
        ways = []
        for number, inputs in enumerate(bound, 1):
            ways.append(self._free(f"path {number}", gates))
            gates[ways[-1]] = Gate(ways[-1], "and", inputs)
        top = self._free(name, gates)
        if kind == "not":
            some = self._free("some path", gates)
            gates[some] = Gate(some, "or", tuple(ways))
            ways = [some]
        gates[top] = Gate(top, kind, tuple(ways), k)
        study = self.study
        houses = tuple(replace(one, state=self._states[one.name]) for one in study.house_events)
        every = (*study.gates, *gates.values())
        return FaultTree(name, top, every, study.events, houses, mission_time_h=study.mission_time_h)

    def inputs(self, course: Course) -> tuple[str, ...]:
        """The gates and events that must all occur on a course. Raises TreeError for one that is not defined."""
        return tuple(dict.fromkeys(self._collected(one, course) for one in course.formulas))

    def _collected(self, one: Collected, course: Course) -> str:
        for kind, names, known in (
            ("collects", (one.name,), self._taken),
            ("sets the house event", (name for name, _ in one.house), self._states),
        ):
            for name in names:
                if name not in known:
                    raise TreeError(
                        f'the path to the sequence "{course.sequence}" {kind} "{name}", which is not defined; '
                        "define it or read the file that does as well",
                        name,
                    )
        changed = tuple((name, state) for name, state in one.house if state != self._states[name])
        return self._copy(one.name, changed) if changed else one.name

    def _copy(self, root: str, house: House) -> str:
        """`root` with the house events in `house` turned over: itself where it does not depend on them."""
        agenda = [root]
        while agenda:
            name = agenda[-1]
            if (name, house) in self._copies:
                agenda.pop()
                continue
            gate = self._written.get(name)
            missing = [i for i in gate.inputs if (i, house) not in self._copies] if gate else []
            if missing:
                agenda.extend(missing)
                continue
            self._copies[name, house] = self._with_copies(name, gate, house)
            agenda.pop()
        return self._copies[root, house]

    def _with_copies(self, name: str, gate: Gate | None, house: House) -> str:
        turned = dict(house)
        if gate is None:
            if name not in turned:
                return name
            return self._add(Gate(self._words(name, turned[name]), "not", (name,)))
        inputs = tuple(self._copies[i, house] for i in gate.inputs)
        if inputs == gate.inputs:
            return name
        words = ", ".join(self._words(*one) for one in house)
        return self._add(replace(gate, name=f"{name} [{words}]", inputs=inputs, inside=""))

    def _words(self, name: str, state: bool) -> str:
        return f"{name} = {str(state).lower()}"

    def _add(self, gate: Gate) -> str:
        if self.gates.get(gate.name) == gate:
            return gate.name
        name = self._free(gate.name, self.gates)
        self.gates[name] = replace(gate, name=name)
        return name

    def _path(self, top: str, number: int, inputs: tuple[str, ...], gates: dict[str, Gate]) -> str:
        if len(inputs) == 1:
            return inputs[0]
        name = self._free(f"{top}, path {number}", gates)
        gates[name] = Gate(name, "and", inputs)
        return name

    def _free(self, wanted: str, also: Collection[str]) -> str:
        name, number = wanted, 1
        while name in self._taken or name in also:
            number += 1
            name = f"{wanted} ({number})"
        return name


def _constant(name: str, state: bool, description: str = "") -> FaultTree:
    """A top event that always occurs, or never does."""
    house = HouseEvent(CERTAIN if state else IMPOSSIBLE, state)
    return FaultTree(name, name, (Gate(name, "or", (house.name,), description=description),), (), (house,), description)
