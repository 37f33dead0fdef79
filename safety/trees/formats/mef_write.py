"""Writing Open-PSA MEF XML.

A name that is no MEF identifier is written by the rule of `mef_names`, and read back as it was. Where programs differ
in what they accept, the plainest form is written: a gate with one input as a reference, a vote for all or one of its
inputs as and or or, an exclusive or of many as nested pairs. A fraction that is no decimal is written as a quotient.
Labels have their white space evened out. The mission time is not part of MEF: `read` needs it again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING

from safety.trees.formats import mef_xml as xml
from safety.trees.formats.mef_xml import Lines
from safety.trees.formats.nested import nested
from safety.trees.tree import BasicEvent, FaultTree, Gate, HouseEvent, Node

if TYPE_CHECKING:
    from safety.trees.common_cause import CcfGroup
    from safety.trees.expressions.expression import Parameter
    from safety.trees.study import Alignment, Study
    from safety.trees.substitutions import Substitution

REFERENCES = {Gate: "gate", BasicEvent: "basic-event", HouseEvent: "house-event"}


def tree_to_mef(tree: FaultTree) -> str:
    """`tree` as a MEF document. Raises TreeError for what XML cannot hold."""
    writer = _Writer(tree.nodes, tree.mission_time_h, nested(tree.gates, (tree.top,)))
    parts = writer.definitions(tree.name, tree.description, list(tree.nodes))
    parameters: dict[str, Parameter] = {}
    for event in tree.events:
        if event.expression is not None:
            parameters |= event.expression.parameters
    return xml.document("", [*parts, *xml.parameters(parameters)])


def study_to_mef(study: Study) -> str:
    """`study` as a MEF document. Raises TreeError for what MEF or XML cannot hold."""
    members = {member for group in study.ccf_groups if group.total is not None for member in group.members}
    bare = {event.name for event in study.events if not (event.description or event.source or event.attributes)}
    inline = nested(study.gates, study.tops) | _formulas(study)
    writer = _Writer(study.nodes, study.mission_time_h, inline, frozenset(members & bare))
    homes: dict[str, list[str]] = {}
    for gate in study.gates:
        homes.setdefault(study.tree_names.get(gate.inside or gate.name, study.name or "study"), []).append(gate.name)
    first = next(iter(homes), study.name or "study")
    homes.setdefault(first, []).extend(list(study.nodes)[len(study.gates) :])
    lines = xml.label(study.description)
    for name, names in homes.items():
        if not writer.inline.issuperset(names):
            lines += writer.definitions(name, "", names)
    lines += [line for group in study.ccf_groups for line in writer.ccf_group(group)]
    lines += [line for one in study.substitutions for line in writer.substitution(one)]
    lines += [line for alignment in study.alignments for line in _alignment(alignment)]
    if study.event_trees or study.initiating_events:
        from safety.trees.formats.mef_write_event_trees import event_trees_to_mef

        lines += event_trees_to_mef(study, writer.argument)
    return xml.document(study.name, [*lines, *xml.parameters(study.parameters)])


def _formulas(study: Study) -> frozenset[str]:
    """The gates that are no part of a fault tree, but stand for a formula of a substitution or an event tree."""
    names = {one.hypothesis for one in study.substitutions}
    if study.event_trees or study.initiating_events:
        from safety.trees.formats.mef_write_event_trees import collected

        names |= collected(study)
    inside = {name for gate in study.gates for name in gate.inputs}
    return frozenset(gate.name for gate in study.gates if gate.name in names - inside - set(study.tops))


def _alignment(alignment: Alignment) -> Lines:
    inner = xml.label(alignment.description)
    for phase in alignment.phases:
        head = {"name": phase.name, "time-fraction": str(float(phase.fraction))}
        parts = xml.label(phase.description)
        for name, state in phase.house:
            parts += xml.element("set-house-event", {"name": name}, xml.constant(state))
        inner += xml.element("define-phase", head, parts)
    return xml.element("define-alignment", {"name": alignment.name}, inner)


class _Writer:
    def __init__(
        self,
        nodes: Mapping[str, Node],
        mission_time_h: Fraction | None,
        inline: frozenset[str],  # gates written inside of others, or where they are referred to
        by_group: frozenset[str] = frozenset(),  # events that a common cause group defines
    ) -> None:
        self.nodes, self.mission_time_h, self.inline, self.by_group = nodes, mission_time_h, inline, by_group

    def definitions(self, name: str, description: str, names: Iterable[str]) -> Lines:
        """A fault tree that defines the nodes in `names`."""
        write: Mapping[type, Callable[..., Lines]] = {Gate: self.gate, BasicEvent: self.event, HouseEvent: self.house}
        nodes = [self.nodes[one] for one in names if one not in self.inline and one not in self.by_group]
        inner = [line for node in nodes for line in write[type(node)](node)]
        return xml.element("define-fault-tree", {"name": name}, xml.label(description) + inner)

    def gate(self, gate: Gate) -> Lines:
        head = xml.label(gate.description) + xml.attributes(gate.attributes)
        return xml.element("define-gate", {"name": gate.name}, head + self.formula(gate))

    def formula(self, gate: Gate) -> Lines:
        """The formula of a gate, without its name."""
        inputs = [self.argument(name) for name in gate.inputs]
        if gate.kind == "not":
            return xml.element("not", {}, inputs[0])
        if len(inputs) == 1:
            return inputs[0]
        if gate.kind == "xor":
            formula = inputs[0]
            for argument in inputs[1:]:
                formula = xml.element("xor", {}, formula + argument)
            return formula
        inner = [line for argument in inputs for line in argument]
        if gate.kind == "vote" and gate.k not in (1, len(inputs)):
            return xml.element("atleast", {"min": str(gate.k)}, inner)
        return xml.element("or" if gate.kind == "or" or gate.k == 1 else "and", {}, inner)

    def argument(self, name: str) -> Lines:
        """A reference, or the formula of a gate that has no name of its own."""
        node = self.nodes[name]
        if isinstance(node, Gate) and name in self.inline:
            return self.formula(node)
        return xml.element(REFERENCES[type(node)], {"name": name})

    def event(self, event: BasicEvent) -> Lines:
        source = (("source", event.source),) if event.source else ()
        head = xml.label(event.description) + xml.attributes((*source, *event.attributes))
        return xml.element("define-basic-event", {"name": event.name}, head + self.quantity(event))

    def quantity(self, event: BasicEvent) -> Lines:
        """The expression of an event's probability, if it is known."""
        if event.probability is not None:
            return xml.number(event.probability)
        if event.rate_per_hour is not None:
            of_tree = event.mission_time_h == self.mission_time_h
            time = ["<system-mission-time/>"] if of_tree else xml.number(event.mission_time_h or Fraction(0))
            return xml.element("exponential", {}, xml.number(event.rate_per_hour) + time)
        return [] if event.expression is None else xml.expression(event.expression)

    def house(self, house: HouseEvent) -> Lines:
        head = xml.label(house.description) + xml.attributes(house.attributes)
        return xml.element("define-house-event", {"name": house.name}, head + xml.constant(house.state))

    def ccf_group(self, group: CcfGroup) -> Lines:
        testing = (("testing", group.testing),) if group.testing != "non-staggered" else ()
        total, factors = group.as_given
        inner: Lines = []
        for name in group.members:
            inner += xml.element("basic-event", {"name": name})
        parts = xml.label(group.description) + xml.attributes(testing) + xml.element("members", {}, inner)
        first = self.nodes[group.members[0]]
        assert isinstance(first, BasicEvent)
        parts += xml.element("distribution", {}, self.quantity(first) if total is None else xml.value(total))
        inner = []
        for level, factor in factors.items():
            inner += xml.element("factor", {"level": str(level)}, xml.value(factor))
        parts += xml.element("factors", {}, inner)
        return xml.element("define-CCF-group", {"name": group.name, "model": group.model}, parts)

    def substitution(self, one: Substitution) -> Lines:
        kind = {"type": one.kind} if one.kind else {}
        parts = xml.element("hypothesis", {}, self.argument(one.hypothesis))
        if one.sources:
            sources = [line for name in one.sources for line in xml.element("basic-event", {"name": name})]
            parts += xml.element("source", {}, sources)
        target = one.target
        shown = xml.constant(target) if isinstance(target, bool) else xml.element("basic-event", {"name": target})
        head = {"name": one.name} | kind
        return xml.element(
            "define-substitution", head, xml.label(one.description) + parts + xml.element("target", {}, shown)
        )
