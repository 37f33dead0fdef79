"""Reading Open-PSA Model Exchange Format XML (MEF 2.0d).

Read are gates (and, or, not, xor, atleast, nand, nor, iff, imply, nested formulas), basic and house events,
parameters and components; the expressions float, int, parameter, exponential (rate per hour, hours) and
system-mission-time; labels as descriptions; and `<attribute name="source" value="P"/>` as the source tag of a basic
event. All else is refused by name, never skipped.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from safety.trees.draft import Draft, at
from safety.trees.tree import BasicEvent, Gate, HouseEvent, exact
from safety.trees.xml_elements import Element

CONTAINERS = ("define-fault-tree", "define-component", "model-data")
REFERENCES = ("gate", "basic-event", "house-event", "event")
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
}
NEGATED = ("nand", "nor", "iff")
OF_TWO = ("xor", "iff", "imply")  # programs disagree on what these mean over more
ANNOTATIONS = ("label", "attributes")


def read_mef(roots: Sequence[Element], mission_time_h: Fraction | None) -> Draft:
    """The definitions of one or more MEF documents, which may share out trees and data.

    Raises TreeError with file and line.
    """
    return _Reader(roots, mission_time_h).draft


class _Reader:
    def __init__(self, roots: Sequence[Element], mission_time_h: Fraction | None) -> None:
        self.draft = Draft(roots[0].place, mission_time_h=mission_time_h)
        self.parameters: dict[str, Element] = {}
        for root in roots:
            if root.tag != "opsa-mef":
                raise root.error(f"the root element is <{root.tag}>, expected <opsa-mef>; give an Open-PSA MEF file")
            self.find_parameters(root)
        for root in roots:
            self.container(root)

    def find_parameters(self, parent: Element) -> None:
        for element in parent.children:
            if element.tag == "define-parameter":
                name = element.get("name")
                if name in self.parameters:
                    raise element.error(
                        f'parameter "{name}" is already defined at {self.parameters[name].place}; rename or remove one'
                    )
                self.parameters[name] = element
            elif element.tag in CONTAINERS:
                self.find_parameters(element)

    def container(self, parent: Element) -> None:
        if parent.tag == "define-fault-tree" and not self.draft.name:
            self.draft.name = parent.get("name")
            self.draft.description = _description(parent)
        definitions = {
            "define-gate": self.gate,
            "define-basic-event": self.basic_event,
            "define-house-event": self.house_event,
        }
        for element in parent.children:
            if element.tag in CONTAINERS:
                self.container(element)
            elif element.tag in definitions:
                with at(element.place):
                    definitions[element.tag](element)
            elif element.tag not in ("define-parameter", *ANNOTATIONS):
                raise element.error(
                    f"<{element.tag}> is not supported; remove it or express it by gates and basic events"
                )

    def gate(self, element: Element) -> None:
        formula = _only(element, "a formula")
        name = element.get("name")
        if formula.tag in REFERENCES:
            self.draft.add(Gate(name, "or", (formula.get("name"),), description=_description(element)), element.place)
        else:
            self.formula(formula, name, _description(element))

    def formula(self, formula: Element, name: str, description: str = "", inside: str = "") -> None:
        """Add the gate `name` for `formula`, and one named after it for each formula inside."""
        if formula.tag not in KINDS:
            raise formula.error(
                f"<{formula.tag}> is no formula known here, expected one of {', '.join(KINDS)}; rewrite it with these"
            )
        parts = list(formula.children)
        if formula.tag in OF_TWO and len(parts) != 2:
            raise formula.error(f"<{formula.tag}> has {len(parts)} arguments, expected 2; nest them in pairs")
        if formula.tag == "imply":
            parts[0] = Element("not", {}, parts[0].place, [parts[0]])
        if formula.tag in NEGATED:
            parts = [Element(KINDS[formula.tag], {}, formula.place, parts)]
        inputs = []
        for number, part in enumerate(parts, 1):
            if part.tag in REFERENCES:
                inputs.append(part.get("name"))
            else:
                inputs.append(f"{name}/{number}")
                self.formula(part, inputs[-1], inside=inside or name)
        kind = "not" if formula.tag in NEGATED else KINDS[formula.tag]
        k = _whole(formula, "min") if kind == "vote" else None
        with at(formula.place):
            self.draft.add(Gate(name, kind, tuple(inputs), k, description, inside), formula.place)

    def basic_event(self, element: Element) -> None:
        name, source = element.get("name"), ""
        for attribute in (a for group in element.children if group.tag == "attributes" for a in group.children):
            if attribute.get("name") == "source":
                source = attribute.get("value")
        expressions = [child for child in element.children if child.tag not in ANNOTATIONS]
        probability = rate = time = None
        if expressions:
            expression = self.resolve(_only(element, "an expression"))
            if expression.tag == "exponential":
                if len(expression.children) != 2:
                    raise expression.error(
                        f"<exponential> has {len(expression.children)} parts, expected rate and hours; give both"
                    )
                rate, time = (self.number(part) for part in expression.children)
            else:
                probability = self.number(expression)
        self.draft.add(BasicEvent(name, probability, rate, time, _description(element), source), element.place)

    def house_event(self, element: Element) -> None:
        constant = element.child("constant")
        state = constant.get("value") if constant else "false"
        if state not in ("true", "false"):
            raise element.error(f'the constant is "{state}", expected true or false; correct it')
        self.draft.add(HouseEvent(element.get("name"), state == "true", _description(element)), element.place)

    def resolve(self, expression: Element) -> Element:
        """The expression itself, or what the parameter it names stands for."""
        met: list[str] = []
        while expression.tag == "parameter":
            name = expression.get("name")
            if name not in self.parameters:
                raise expression.error(
                    f'parameter "{name}" is not defined; define it or read the file that does as well'
                )
            if name in met:
                raise expression.error(f"parameters in a cycle: {' -> '.join([*met, name])}; give one of them a number")
            met.append(name)
            expression = _only(self.parameters[name], "an expression")
        return expression

    def number(self, expression: Element) -> Fraction:
        """The value of a constant expression, exactly as written."""
        expression = self.resolve(expression)
        match expression.tag:
            case "float" | "int":
                with at(expression.place):
                    return exact(expression.get("value"), f"<{expression.tag}>")
            case "system-mission-time":
                if self.draft.mission_time_h is None:
                    raise expression.error(
                        "<system-mission-time> has no value in the file; pass mission_time_h (hours)"
                    )
                return self.draft.mission_time_h
        raise expression.error(
            f"expression <{expression.tag}> is not supported, expected float, int, parameter, exponential of "
            "these or system-mission-time; write its value as a float"
        )


def _only(element: Element, what: str) -> Element:
    """The one child of a definition besides its annotations."""
    children = [child for child in element.children if child.tag not in ANNOTATIONS]
    if len(children) != 1:
        name = element.attributes.get("name", "")
        raise element.error(f'<{element.tag}> "{name}" holds {len(children)} elements, expected {what}; correct it')
    return children[0]


def _description(element: Element) -> str:
    label = element.child("label")
    return " ".join(label.text.split()) if label else ""


def _whole(element: Element, attribute: str) -> int:
    value = element.get(attribute)
    if not value.strip().isdecimal():
        raise element.error(f'{attribute}="{value}" of <{element.tag}> is not a whole number; correct it')
    return int(value)
