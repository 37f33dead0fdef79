"""Reading event trees, initiating events and rules of Open-PSA MEF (`event_trees` has their meaning).

The instructions are collect-formula, collect-expression, set-house-event (forward), if, block, rule and event-tree; the
tests of an if are test-initiating-event, test-functional-event, and, or, not. An initiating event may hold its
frequency, as an expression or in <collect-expression>, and further instructions. All else is refused by name.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from safety.trees.event_trees import definitions as et
from safety.trees.formats.draft import at
from safety.trees.formats.mef import REFERENCES
from safety.trees.formats.mef_elements import ANNOTATIONS, description, only
from safety.trees.formats.xml_elements import Element

if TYPE_CHECKING:
    from safety.trees.formats.mef import MefReader

INSTRUCTIONS = ("collect-formula", "collect-expression", "set-house-event", "if", "block", "rule", "event-tree")
ENDS = ("fork", "sequence", "branch")


def read_event_trees(
    elements: Sequence[Element], reader: MefReader
) -> tuple[tuple[et.InitiatingEvent, ...], tuple[et.EventTree, ...]]:
    """What <define-initiating-event>, <define-event-tree> and <define-rule> say, in their order.

    Raises TreeError with file and line.
    """
    made = _EventTrees(elements, reader)
    starts, trees = [], []
    for element in elements:
        with at(element.place):
            match element.tag:
                case "define-initiating-event":
                    starts.append(made.initiating_event(element))
                case "define-event-tree":
                    trees.append(made.event_tree(element))
                case _:
                    made.rule(element)
    return tuple(starts), tuple(trees)


class _EventTrees:
    def __init__(self, elements: Sequence[Element], reader: MefReader) -> None:
        self.reader = reader
        self.rules = {element.get("name"): element for element in elements if element.tag == "define-rule"}
        self.made: dict[str, et.Rule] = {}
        self.open: list[str] = []  # rules whose instructions are being read
        self.formulas: dict[object, str] = {}  # gates by what their formulas say, each made once
        self.names: set[str] = set()
        self.where = ""  # the path, sequence or rule being read

    def initiating_event(self, element: Element) -> et.InitiatingEvent:
        instructions: list[et.Instruction] = []
        frequencies: list[Element] = []
        self.where = element.get("name")
        for part in _parts(element):
            if part.tag == "collect-expression":
                frequencies.append(only(part, "an expression"))
            elif part.tag in INSTRUCTIONS:
                instructions.append(self.instruction(part))
            elif part.tag in REFERENCES:
                instructions.append(et.CollectFormula(self.reader.formula(part, "")))
            else:
                frequencies.append(part)
        if len(frequencies) > 1:
            raise frequencies[1].error(
                f'the initiating event "{element.get("name")}" has {len(frequencies)} frequencies; give one'
            )
        frequency = self.reader.expressions.read(frequencies[0], "") if frequencies else None
        return et.InitiatingEvent(
            element.get("name"), element.attributes.get("event-tree", ""), frequency, tuple(instructions),
            description(element),
        )  # fmt: skip

    def event_tree(self, element: Element) -> et.EventTree:
        name = element.get("name")
        functional: list[et.FunctionalEvent] = []
        sequences: list[et.Sequence] = []
        branches: list[et.NamedBranch] = []
        initial: et.Branch | None = None
        for part in _parts(element):
            match part.tag:
                case "define-functional-event":
                    functional.append(et.FunctionalEvent(part.get("name"), description(part)))
                case "define-sequence":
                    self.where = part.get("name")
                    inner = self.instructions(_parts(part))
                    sequences.append(et.Sequence(part.get("name"), inner, description(part)))
                case "define-branch":
                    self.where = part.get("name")
                    branches.append(et.NamedBranch(part.get("name"), self.branch(part), description(part)))
                case "initial-state" if initial is None:
                    self.where = name
                    initial = self.branch(part)
                case "initial-state":
                    raise part.error(f'event tree "{name}" has a second <initial-state>; keep one')
                case _:
                    raise part.error(f"<{part.tag}> is not known in <define-event-tree>; remove it")
        if initial is None:
            raise element.error(f'event tree "{name}" has no <initial-state>; add it')
        return et.EventTree(name, tuple(functional), tuple(sequences), tuple(branches), initial, description(element))

    def branch(self, parent: Element) -> et.Branch:
        """The instructions of `parent`, and the fork, sequence or branch that they end in."""
        parts = _parts(parent)
        if not parts or parts[-1].tag not in ENDS:
            raise parent.error(f"<{parent.tag}> does not end in <fork>, <sequence> or <branch>; add one of them")
        instructions = self.instructions(parts[:-1])
        end = parts[-1]
        if end.tag == "sequence":
            return et.Branch(instructions, et.ToSequence(end.get("name")))
        if end.tag == "branch":
            return et.Branch(instructions, et.ToBranch(end.get("name")))
        paths = []
        for path in _parts(end):
            if path.tag != "path":
                raise path.error(f"<{path.tag}> is not known in <fork>, expected <path>; correct it")
            self.where = f"{end.get('functional-event')} = {path.get('state')}"
            paths.append(et.Path(path.get("state"), self.branch(path)))
        with at(end.place):
            return et.Branch(instructions, et.Fork(end.get("functional-event"), tuple(paths)))

    def instructions(self, elements: Iterable[Element]) -> tuple[et.Instruction, ...]:
        return tuple(self.instruction(element) for element in elements)

    def instruction(self, element: Element) -> et.Instruction:
        match element.tag:
            case "collect-formula":
                return et.CollectFormula(self.formula(only(element, "a formula")))
            case "collect-expression":
                return et.CollectExpression(self.reader.expressions.read(only(element, "an expression"), ""))
            case "set-house-event":
                direction = element.attributes.get("direction", "forward")
                if direction != "forward":
                    raise element.error(
                        f'direction="{direction}" is not supported, as it changes what was collected before; set the '
                        "house event before the first <collect-formula> that it concerns"
                    )
                return et.SetHouseEvent(*self.reader.house(element))
            case "block":
                return et.Block(self.instructions(_parts(element)))
            case "event-tree":
                return et.Link(element.get("name"))
            case "rule":
                return self.rule(element)
            case "if":
                parts = _parts(element)
                if len(parts) not in (2, 3):
                    raise element.error(
                        f"<if> holds {len(parts)} elements, expected a test and one or two instructions; put several "
                        "instructions into a <block>"
                    )
                return et.Choice(self.condition(parts[0]), *self.instructions(parts[1:]))
        raise element.error(
            f"<{element.tag}> is no instruction known here, expected one of {', '.join(INSTRUCTIONS)}; rewrite it with "
            "these"
        )

    def condition(self, element: Element) -> et.Condition:
        match element.tag:
            case "test-initiating-event":
                return et.InitiatingEventIs(element.get("name"))
            case "test-functional-event":
                return et.FunctionalEventIs(element.get("name"), element.get("state"))
            case "and" | "or" | "not":
                with at(element.place):
                    return et.Combined(element.tag, tuple(self.condition(part) for part in _parts(element)))
        raise element.error(
            f"<{element.tag}> is no test known here, expected test-initiating-event, test-functional-event, and, or, "
            "not; rewrite it with these"
        )

    def rule(self, element: Element) -> et.Rule:
        """The rule that `element`, its definition or a reference to it, names."""
        name = element.get("name")
        if name not in self.rules:
            raise element.error(f'rule "{name}" is not defined; define it or read the file that does as well')
        if name in self.open:
            raise element.error(f"rules in a cycle: {' -> '.join([*self.open, name])}; end one of them")
        if name not in self.made:
            definition, where, self.where = self.rules[name], self.where, name
            self.open.append(name)
            self.made[name] = et.Rule(name, self.instructions(_parts(definition)), description(definition))
            self.open.pop()
            self.where = where
        return self.made[name]

    def formula(self, element: Element) -> str:
        """The gate or event that a formula stands for: one gate for all formulas that say the same."""
        key = _said(element)
        if key not in self.formulas:
            inner = element.children[0] if element.tag == "not" and len(element.children) == 1 else None
            wanted = f"not {inner.get('name')}" if inner and inner.tag in REFERENCES else self.where
            name, number = wanted, 1
            while name in self.names or name in self.reader.names.known:
                number += 1
                name = f"{wanted} ({number})"
            self.formulas[key] = self.reader.formula(element, name)
            self.names.add(name)
        return self.formulas[key]


def _parts(element: Element) -> list[Element]:
    return [child for child in element.children if child.tag not in ANNOTATIONS]


def _said(element: Element) -> object:
    """A formula without its place: equal for equal ones."""
    return element.tag, tuple(sorted(element.attributes.items())), tuple(_said(child) for child in element.children)
