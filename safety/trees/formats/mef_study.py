"""Reading what Open-PSA MEF says beside fault trees: common cause groups, substitutions, alignments, event trees."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from safety.trees.as_written import exact
from safety.trees.formats.draft import at
from safety.trees.formats.mef_elements import attributes, content, description, only, parts, truth, whole
from safety.trees.formats.xml_elements import Element
from safety.trees.study import Alignment, Phase
from safety.trees.substitutions import Substitution
from safety.trees.tree import BasicEvent

if TYPE_CHECKING:
    from safety.trees.common_cause import CcfGroup
    from safety.trees.expressions.expression import Expression
    from safety.trees.formats.mef import MefReader

EVENT_TREES = ("define-event-tree", "define-initiating-event", "define-rule")


def read_study_elements(elements: Sequence[tuple[Element, str]], reader: MefReader) -> dict[str, Any]:
    """The fields of a Study that these elements (each with its scope) define. Raises TreeError with file and line."""
    found: dict[str, Any] = {}
    seen: dict[tuple[str, str], Element] = {}
    for element, scope in elements:
        key = element.tag, element.get("name")
        if key in seen:
            raise element.error(f'<{key[0]}> "{key[1]}" is already defined at {seen[key].place}; rename or remove one')
        seen[key] = element
        reader.draft.places.setdefault(key[1], element.place)
        with at(element.place):
            match element.tag:
                case "define-CCF-group":
                    found["ccf_groups"] = (*found.get("ccf_groups", ()), _ccf_group(element, scope, reader))
                case "define-substitution":
                    found["substitutions"] = (*found.get("substitutions", ()), _substitution(element, reader))
                case "define-alignment":
                    found["alignments"] = (*found.get("alignments", ()), _alignment(element, reader))
    if trees := [element for element, _ in elements if element.tag in EVENT_TREES]:
        from safety.trees.formats.mef_event_trees import read_event_trees

        found["initiating_events"], found["event_trees"] = read_event_trees(trees, reader)
    return found


def _ccf_group(element: Element, scope: str, reader: MefReader) -> CcfGroup:
    from safety.trees.common_cause import TESTING, CcfGroup

    model = element.get("model")
    fields = parts(element, ("members", "distribution", "factors", "factor"), 2)
    members = tuple(reader.reference(member, scope, "basic-event") for member in fields["members"].children)
    written = fields["factors"].children if "factors" in fields else [fields["factor"]] if "factor" in fields else []
    factors: dict[int, Fraction | Expression] = {}
    first = 1 if model in ("alpha-factor", "phi-factor") else 2
    for place, factor in enumerate(written, len(members) if model == "beta-factor" else first):
        if factor.tag != "factor":
            raise factor.error(f"<{factor.tag}> is not known in <factors>, expected <factor>; correct it")
        level = whole(factor, "level") if "level" in factor.attributes else place
        if level in factors:
            raise factor.error(f"a factor of level {level} is given twice; remove one")
        factors[level] = _number(reader.expressions.read(only(factor, "an expression"), scope))
    total = only(fields["distribution"], "an expression")
    _define_members(members, total, scope, reader)
    return CcfGroup(
        element.get("name"),
        model,
        members,
        factors,
        _number(reader.expressions.probability(total, scope)),
        dict(attributes(element)).get("testing", TESTING[0]) if model == "alpha-factor" else TESTING[0],
        description(element),
    )


def _define_members(members: Sequence[str], total: Element, scope: str, reader: MefReader) -> None:
    """Members without a probability of their own take that of the group, so that the tree is whole without it."""
    draft = reader.draft
    places = {event.name: place for place, event in enumerate(draft.events)}
    for name in members:
        place = places.get(name)
        if place is not None:
            event = draft.events[place]
            if event.probability is None and event.rate_per_hour is None and event.expression is None:
                draft.events[place] = replace(event, **reader.quantity(total, scope))
        elif name not in reader.names.known:
            draft.add(BasicEvent(name, **reader.quantity(total, scope)), total.place)


def _number(expression: Expression) -> Fraction | Expression:
    from safety.trees.formats.mef_expressions import plain

    number = plain(expression)
    return expression if number is None else number


def _substitution(element: Element, reader: MefReader) -> Substitution:
    name = element.get("name")
    fields = parts(element, ("hypothesis", "target", "source"), 2)
    target = only(fields["target"], "a basic event or a constant")
    sources = fields["source"].children if "source" in fields else []
    return Substitution(
        name,
        reader.formula(only(fields["hypothesis"], "a formula"), f"{name}, hypothesis"),
        truth(target) if target.tag == "constant" else reader.reference(target, "", "basic-event"),
        element.attributes.get("type", ""),
        tuple(reader.reference(event, "", "basic-event") for event in sources),
        description(element),
    )


def _alignment(element: Element, reader: MefReader) -> Alignment:
    phases = []
    for child in content(element)[2]:
        if child.tag != "define-phase":
            raise child.error(f"<{child.tag}> is not known in <define-alignment>, expected <define-phase>; correct it")
        house = tuple(reader.house(part) for part in content(child)[2])
        fraction = exact(child.get("time-fraction"), f'time-fraction of phase "{child.get("name")}"')
        with at(child.place):
            phases.append(Phase(child.get("name"), fraction, house, description(child)))
    return Alignment(element.get("name"), tuple(phases), description(element))
