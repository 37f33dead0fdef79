"""Reading Open-PSA Model Exchange Format XML (MEF 2.0d): the layer of fault trees.

Read here are gates (and, or, not, xor, atleast, nand, nor, iff, imply, cardinality, constants, nested formulas), basic
and house events, fault trees, components and model data; labels as descriptions; `<attribute name="source" value="P"/>`
as the source tag of a basic event, other attributes as they stand. Expressions richer than a number or an exponential
of two are read by `mef_expressions`; common cause groups, substitutions, alignments and event trees by `mef_study`.
What is unknown is refused by name, never skipped.

A public definition is known by its name everywhere; a private one by its path "Tree.Component.name", and inside its
container by its name or the rest of its path.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from safety.trees.as_written import TreeError, exact
from safety.trees.formats.draft import Draft, at, roots
from safety.trees.formats.mef_elements import (
    ANNOTATIONS,
    NUMBERS,
    Attributes,
    content,
    description,
    only,
    parts,
    truth,
    whole,
)
from safety.trees.formats.xml_elements import Element
from safety.trees.tree import TAGS, BasicEvent, Gate, HouseEvent

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Any

    from safety.trees.expressions.expression import Expression
    from safety.trees.formats.mef_expressions import Expressions

CONTAINERS = ("define-fault-tree", "define-component", "model-data")
EVENTS = ("define-gate", "define-basic-event", "define-house-event")
STUDY = tuple(
    f"define-{what}" for what in ("CCF-group", "substitution", "alignment", "event-tree", "initiating-event", "rule")
)
REFERENCES = {"gate": Gate, "basic-event": BasicEvent, "house-event": HouseEvent, "event": None}
KINDS = {
    "and": "and",
    "or": "or",
    "not": "not",
    "xor": "xor",
    "atleast": "vote",
    "nand": "and",
    "nor": "or",
    "iff": "xor",
    "imply": "or",
    "cardinality": "and",
}
NEGATED = ("nand", "nor", "iff")
OF_TWO = ("xor", "iff", "imply")  # programs disagree on what these mean over more
LIMITS = {"atleast": {"min"}, "cardinality": {"min", "max"}}
MORE = {"define-fault-tree": {"name"}, "define-parameter": {"name", "role", "unit"}}  # attributes of definitions
ROLES = {"public": False, "private": True}


def read_mef(documents: Sequence[Element], mission_time_h: Fraction | None) -> Draft:
    """The definitions of one or more MEF documents, which may share out trees and data.

    Raises TreeError with file and line.
    """
    return MefReader(documents, mission_time_h).draft


class Names:
    """The definitions of one kind by full path, the public ones also by plain name."""

    def __init__(self) -> None:
        self.known: dict[str, str] = {}
        self.any_private = False

    def define(self, element: Element, scope: str, private: bool) -> str:
        """The name that a definition inside `scope` ("Tree.Component.") is known by from now on."""
        plain = element.get("name")
        path = scope + plain
        name = path if private else plain
        if self.known.setdefault(path, name) != name:
            raise element.error(f'"{path}" is defined as public and as private; rename or remove one')
        self.known[name] = name
        self.any_private |= private
        return name

    def find(self, reference: str, scope: str, element: Element) -> str:
        """The definition that `reference` means inside `scope`; the reference itself if there is none."""
        if not self.any_private and reference in self.known:
            return self.known[reference]
        found = {}
        for end in [0, *(place + 1 for place, letter in enumerate(scope) if letter == ".")]:
            if scope[:end] + reference in self.known:
                found[scope[:end]] = self.known[scope[:end] + reference]
        if scope not in found and len(set(found.values())) > 1:
            raise element.error(
                f'"{reference}" may mean {" or ".join(sorted(set(found.values())))}; write its full path'
            )
        return found.get(scope) or next(iter(found.values()), reference)


class MefReader:
    """One or more documents being read; `draft` is what they say."""

    def __init__(self, documents: Sequence[Element], mission_time_h: Fraction | None) -> None:
        self.draft = Draft(documents[0].place, mission_time_h=mission_time_h)
        self.names, self.parameter_names = Names(), Names()
        self.parameters: dict[str, tuple[Element, str]] = {}  # definition and scope
        self._events: list[tuple[Element, str, str]] = []  # definition, name, scope
        self._study: list[tuple[Element, str]] = []
        self._meant: dict[str, dict[str, Element]] = {tag: {} for tag in REFERENCES}  # by kind, name: where it stands
        self._numbers: dict[str, Fraction] = {}
        self._constants: set[str] = set()
        self._expressions: Expressions | None = None
        for root in documents:
            if root.tag != "opsa-mef":
                hint = (
                    "give the files that its <input-files> lists"
                    if root.tag == "scram"
                    else "give an Open-PSA MEF file"
                )
                raise root.error(f"the root element is <{root.tag}>, expected <opsa-mef>; {hint}")
            self.draft.name = self.draft.name or root.attributes.get("name", "")
            self.draft.description = self.draft.description or description(root)
            self._find_definitions(root, "", False)
        for element, name, scope in self._events:
            try:
                match element.tag:
                    case "define-gate":
                        self._gate(element, name, scope)
                    case "define-basic-event":
                        self._basic_event(element, name, scope)
                    case _:
                        self._house_event(element, name)
            except TreeError as error:
                raise error.at(element.place) from None
        if self.parameters or self._expressions:
            self.draft.parts["parameters"] = self.expressions.all()
        if self._study:
            self.draft.tops = tuple(roots(self.draft.gates))  # before gates for formulas outside of trees are added
            from safety.trees.formats.mef_study import read_study_elements

            self.draft.parts |= read_study_elements(self._study, self)
        self._check_references()

    def _find_definitions(self, parent: Element, scope: str, private: bool) -> None:
        for element in parent.children:
            tag = element.tag
            hidden = private
            if len(element.attributes) > 1 and tag not in STUDY:
                hidden = _is_private(element, private)
            if tag in EVENTS:
                name = self.names.define(element, scope, hidden)
                self._events.append((element, name, scope))
            elif tag in CONTAINERS:
                self._container(element, scope, hidden)
            elif tag == "define-parameter":
                name = self.parameter_names.define(element, scope, hidden)
                if name in self.parameters:
                    first = self.parameters[name][0].place
                    raise element.error(f'parameter "{name}" is already defined at {first}; rename or remove one')
                self.parameters[name] = element, scope
            elif tag in STUDY:
                self._study.append((element, scope))
            elif tag not in ANNOTATIONS:
                raise element.error(
                    f"<{tag}> is not known in <{parent.tag}>; remove it or express it by gates and events"
                )

    def _container(self, element: Element, scope: str, private: bool) -> None:
        if element.tag == "model-data":
            self._find_definitions(element, scope, private)
            return
        name = element.get("name")
        if element.tag == "define-fault-tree":
            self.draft.name = self.draft.name or name
            self.draft.description = self.draft.description or description(element)
        known = len(self._events)
        self._find_definitions(element, f"{scope}{name}.", private)
        if element.tag == "define-fault-tree":
            self.draft.tree_names |= dict.fromkeys(
                (n for e, n, _ in self._events[known:] if e.tag == "define-gate"), name
            )

    def _gate(self, element: Element, name: str, scope: str) -> None:
        label, attributes, _ = content(element)
        formula = only(element, "a formula")
        if formula.tag in REFERENCES or formula.tag == "constant":
            formula = formula.made("or", formula)
        self._formula(formula, name, scope, label, attributes=attributes)

    def formula(self, element: Element, name: str, scope: str = "") -> str:
        """The gate or event that stands for a formula: the one referred to, or a new gate called `name`."""
        if element.tag in REFERENCES:
            return self._reference(element, scope)
        if element.tag == "constant":
            return self._constant(element)
        self._formula(element, name, scope)
        return name

    def reference(self, element: Element, scope: str, tag: str) -> str:
        """The event that <tag> or <event> refers to."""
        if element.tag not in (tag, "event"):
            raise element.error(f"<{element.tag}> stands where <{tag}> is expected; correct it")
        self._meant[tag].setdefault(name := self._reference(element, scope), element)
        return name

    def expression(self, element: Element) -> Expression:
        """The expression that an element outside of all fault trees is."""
        return self.expressions.read(element, "")

    def house(self, element: Element) -> tuple[str, bool]:
        """The house event that <set-house-event> sets, and its state."""
        if element.tag != "set-house-event":
            raise element.error(f"<{element.tag}> stands where <set-house-event> is expected; correct it")
        name = self.names.find(element.get("name"), "", element)
        self._meant["house-event"].setdefault(name, element)
        return name, truth(only(element, "a constant"))

    def _formula(
        self,
        formula: Element,
        name: str,
        scope: str,
        label: str = "",
        inside: str = "",
        attributes: Attributes = (),
    ) -> None:
        """Add the gate `name` for `formula`, and one named after it for each formula inside."""
        tag = formula.tag
        kind = KINDS.get(tag)
        if kind is None:
            raise formula.error(
                f"<{tag}> is no formula known here, expected one of {', '.join(KINDS)}; rewrite it with these"
            )
        if formula.attributes and (unknown := formula.attributes.keys() - LIMITS.get(tag, set())):
            raise formula.error(f'<{tag}> has the unknown attribute "{min(unknown)}"; remove it or correct its name')
        parts = formula.children
        if tag in OF_TWO and len(parts) != 2:
            raise formula.error(f"<{tag}> has {len(parts)} arguments, expected 2; nest them in pairs")
        if tag == "imply":
            parts = [formula.made("not", parts[0]), parts[1]]
        elif tag in NEGATED:
            parts, kind = [formula.made(kind, *parts)], "not"
        elif tag == "cardinality":
            parts = _cardinality(formula, name)
        inputs = []
        for part in parts:
            if part.tag in REFERENCES:
                inputs.append(self._reference(part, scope))
            elif part.tag == "constant":
                inputs.append(self._constant(part))
            else:
                inputs.append(f"{name}/{len(inputs) + 1}")
                self._formula(part, inputs[-1], scope, inside=inside or name)
        k = whole(formula, "min") if kind == "vote" else None
        try:
            self.draft.add(Gate(name, kind, tuple(inputs), k, label, inside, attributes), formula.place)
        except TreeError as error:
            raise error.at(formula.place) from None

    def _reference(self, element: Element, scope: str) -> str:
        name = self.names.known.get(element.attributes.get("name", ""))
        if name is None or self.names.any_private:
            name = self.names.find(element.get("name"), scope, element)
        tag = element.tag
        if len(element.attributes) > 1:
            extra = dict(element.attributes)
            del extra["name"]
            kind = extra.pop("type", tag) if tag == "event" else tag
            if kind not in REFERENCES:
                raise element.error(f'type="{kind}" of <event> is unknown, expected {", ".join(list(REFERENCES)[:3])}')
            if extra:
                raise element.error(f'<{tag}> has the unknown attribute "{min(extra)}"; remove it or correct its name')
            tag = kind
        self._meant[tag].setdefault(name, element)
        return name

    def _check_references(self) -> None:
        """That what is referred to as a gate or event of a kind is one."""
        draft = self.draft
        defined = {
            "gate": {gate.name for gate in draft.gates},
            "basic-event": {event.name for event in draft.events},
            "house-event": {house.name for house in draft.house_events},
        }
        for kind in defined:
            for name, element in self._meant[kind].items():
                for other, names in defined.items():
                    if other != kind and name in names:
                        raise element.error(f'"{name}" is no {kind} but a {other}; refer to it by <{other}>')

    def _constant(self, element: Element) -> str:
        """The house event that stands for a constant in a formula."""
        state = truth(element)
        name = str(state).lower()
        while name in self.names.known:
            name = f"constant {name}"
        if name not in self._constants:
            self._constants.add(name)
            self.draft.add(HouseEvent(name, state), element.place)
        return name

    def _basic_event(self, element: Element, name: str, scope: str) -> None:
        label, attributes, expressions = content(element)
        source = dict(attributes).get("source", "") if attributes else ""
        if source in TAGS:
            attributes = tuple(pair for pair in attributes if pair[0] != "source")
        else:
            source = ""
        values = self.quantity(only(element, "an expression"), scope) if expressions else {}
        if "expression" in values and values["expression"].is_assumed:
            source = "A"
        event = BasicEvent(name, description=label, source=source, attributes=attributes, **values)
        self.draft.add(event, element.place)

    def quantity(self, expression: Element, scope: str) -> dict[str, Any]:
        """The fields of a basic event that has this probability: plain numbers where that is all it takes."""
        tag, parts = expression.tag, expression.children
        if tag in NUMBERS and not parts:
            return {"probability": self.number(expression)}
        if tag == "exponential" and len(parts) == 2 and parts[0].tag in NUMBERS:
            if parts[1].tag in NUMBERS:
                return {"rate_per_hour": self.number(parts[0]), "mission_time_h": self.number(parts[1])}
            if parts[1].tag == "system-mission-time" and not parts[1].attributes:
                return {"rate_per_hour": self.number(parts[0])}
        return self.expressions.fields(expression, scope)

    def _house_event(self, element: Element, name: str) -> None:
        label, attributes, _ = content(element)
        constant = parts(element, ("constant",), 0).get("constant")
        state = constant is not None and truth(constant)
        self.draft.add(HouseEvent(name, state, label, attributes), element.place)

    def number(self, element: Element) -> Fraction:
        """The value of <float> or <int>, exactly as written."""
        text = element.get("value")
        if text not in self._numbers:
            with at(element.place):
                self._numbers[text] = exact(text, f"<{element.tag}>")
        number = self._numbers[text]
        if element.tag == "int" and number.denominator > 1:
            raise element.error(f"<int> is {text}, expected a whole number; write <float>")
        return number

    @property
    def expressions(self) -> Expressions:
        """The reader of expressions, made when first needed."""
        if self._expressions is None:
            from safety.trees.formats.mef_expressions import Expressions

            self._expressions = Expressions(self)
        return self._expressions


def _is_private(element: Element, inherited: bool) -> bool:
    """Whether a definition is known in its container only."""
    tag = element.tag
    known = MORE.get(tag, {"name", "role"})
    if unknown := element.attributes.keys() - known:
        raise element.error(f'<{tag}> has the unknown attribute "{min(unknown)}"; remove it or correct its name')
    if "role" not in element.attributes:
        return inherited
    role = element.attributes["role"]
    if role not in ROLES:
        raise element.error(f'role="{role}" of <{tag}> is unknown, expected public or private; correct it')
    return ROLES[role]


def _cardinality(formula: Element, name: str) -> list[Element]:
    """Between min and max of the arguments: at least min of them, and not at least one more than max.

    Formulas inside stand in the first of these only; the second refers to the gates that they become there.
    """
    low, high, count = whole(formula, "min"), whole(formula, "max"), len(formula.children)
    if not low <= high <= count:
        raise formula.error(f'<cardinality> has min="{low}" and max="{high}" of {count} arguments; correct the limits')
    parts = []
    if low > 0:
        parts.append(formula.made("atleast", *formula.children))
        parts[-1].attributes = {"min": str(low)}
    if high < count:
        more = formula.made("atleast", *formula.children)
        more.attributes = {"min": str(high + 1)}
        for place, child in enumerate(formula.children if parts else (), 1):
            if child.tag not in REFERENCES and child.tag != "constant":
                more.children[place - 1] = child.made("gate")
                more.children[place - 1].attributes = {"name": f"{name}/1/{place}"}
        parts.append(formula.made("not", more))
    if not parts:
        parts = [formula.made("constant")]
        parts[0].attributes = {"value": "true"}
    return parts
