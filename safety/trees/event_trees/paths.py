"""Walking event trees: every path from an initiating event to a sequence, with what is collected on it.

A house event set on a path holds for the formulas collected after it, not for those before; a sequence with a link
goes on in the linked event tree with what has been collected and set so far (Open-PSA Model Exchange Format 2.0d).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from safety.trees.as_written import TreeError
from safety.trees.event_trees.definitions import (
    Block,
    Branch,
    Choice,
    CollectExpression,
    CollectFormula,
    Combined,
    Condition,
    EventTree,
    Fork,
    FunctionalEventIs,
    InitiatingEvent,
    InitiatingEventIs,
    Instruction,
    Link,
    Rule,
    Sequence,
    SetHouseEvent,
    ToBranch,
)

if TYPE_CHECKING:
    from safety.trees.event_trees.definitions import Factor

MOST_PATHS = 100_000  # of one initiating event
House = tuple[tuple[str, bool], ...]  # house events that were set, and to what, by name


@dataclass(frozen=True)
class Collected:
    """A formula as collected: the gate or event, under the house events set by then."""

    name: str
    house: House = ()


@dataclass(frozen=True)
class Course:
    """One way through the event tree: what it collected by the time it reached `sequence`."""

    initiating_event: str
    sequence: str = ""
    states: tuple[tuple[str, str], ...] = ()  # functional events and their states, in the order of the forks
    formulas: tuple[Collected, ...] = ()
    expressions: tuple[Factor, ...] = ()
    house: House = ()
    link: str = ""  # the event tree that the sequence goes on in


def courses(initiating: InitiatingEvent, event_trees: Iterable[EventTree]) -> tuple[Course, ...]:
    """Every way from `initiating` through its event tree, and those linked to it, in the order written.

    Raises TreeError: no such event tree, an undefined sequence, one defined twice, links in a cycle, more than
    MOST_PATHS paths.
    """
    walk = _Walk(event_trees)
    start = walk.after(initiating.instructions, Course(initiating.name))
    result: list[Course] = []
    for course in walk.tree(initiating.event_tree, start, (), f'initiating event "{initiating.name}"'):
        result.append(course)
        if len(result) > MOST_PATHS:
            raise TreeError(
                f'initiating event "{initiating.name}" leads to more than {MOST_PATHS} paths; split its event tree',
                initiating.name,
            )
    return tuple(result)


class _Walk:
    def __init__(self, event_trees: Iterable[EventTree]) -> None:
        self.trees: dict[str, EventTree] = {}
        self.sequences: dict[str, Sequence] = {}  # of all event trees: each may end in those of another
        rules: dict[str, Rule] = {}
        for tree in event_trees:
            if tree.name in self.trees:
                raise TreeError(f'two event trees are called "{tree.name}"; rename one', tree.name)
            self.trees[tree.name] = tree
            for name, rule in tree.rules.items():
                if rules.setdefault(name, rule) != rule:
                    raise TreeError(f'two rules "{name}" say different things; rename one', tree.name)
            for sequence in tree.sequences:
                if sequence.name in self.sequences:
                    raise TreeError(
                        f'sequence "{sequence.name}" is defined twice, once in event tree "{tree.name}"; rename it',
                        tree.name,
                    )
                self.sequences[sequence.name] = sequence

    def tree(self, name: str, course: Course, entered: tuple[str, ...], origin: str) -> Iterator[Course]:
        if name in entered:
            raise TreeError(f"event trees linked in a cycle: {' -> '.join([*entered, name])}; end one of them", name)
        if name not in self.trees:
            raise TreeError(
                f'{origin} leads to the event tree "{name}", which is not defined; define it or read the file that '
                "does as well",
                name,
            )
        tree = self.trees[name]
        yield from self.branch(tree, tree.initial, course, (*entered, name))

    def branch(self, tree: EventTree, branch: Branch, course: Course, entered: tuple[str, ...]) -> Iterator[Course]:
        course = self.after(branch.instructions, course)
        target = branch.target
        if isinstance(target, Fork):
            for path in target.paths:
                states = (*course.states, (target.functional_event, path.state))
                yield from self.branch(tree, path.branch, replace(course, states=states), entered)
        elif isinstance(target, ToBranch):
            yield from self.branch(tree, tree.branch_named[target.name], course, entered)
        else:
            yield from self.end(tree, target.name, course, entered)

    def end(self, tree: EventTree, name: str, course: Course, entered: tuple[str, ...]) -> Iterator[Course]:
        if name not in self.sequences:
            raise TreeError(
                f'event tree "{tree.name}" ends in the sequence "{name}", which is not defined; define it or correct '
                "the name",
                tree.name,
            )
        course = self.after(self.sequences[name].instructions, replace(course, sequence=name))
        if course.link:
            yield from self.tree(course.link, replace(course, link=""), entered, f'the sequence "{name}"')
        else:
            yield course

    def after(self, instructions: Iterable[Instruction], course: Course) -> Course:
        """The course once the instructions are carried out."""
        for instruction in instructions:
            match instruction:
                case CollectFormula(name):
                    one = Collected(name, course.house)
                    course = replace(course, formulas=(*course.formulas, one))
                case CollectExpression(expression):
                    course = replace(course, expressions=(*course.expressions, expression))
                case SetHouseEvent(name, state):
                    house = dict(course.house) | {name: state}
                    course = replace(course, house=tuple(sorted(house.items())))
                case Block(inner) | Rule(_, inner):
                    course = self.after(inner, course)
                case Choice(test, then, otherwise):
                    chosen = then if holds(test, course) else otherwise
                    course = course if chosen is None else self.after((chosen,), course)
                case Link(event_tree):
                    if course.link:
                        raise TreeError(
                            f'the sequence "{course.sequence}" goes on in two event trees, "{course.link}" and '
                            f'"{event_tree}"; keep one link, or choose by a test'
                        )
                    course = replace(course, link=event_tree)
        return course


def holds(test: Condition, course: Course) -> bool:
    """Whether `test` is true at the end of `course`."""
    match test:
        case InitiatingEventIs(name):
            return course.initiating_event == name
        case FunctionalEventIs(name, state):
            return dict(course.states).get(name) == state
        case Combined(kind, parts):
            values = [holds(part, course) for part in parts]
            return not values[0] if kind == "not" else all(values) if kind == "and" else any(values)


def by_sequence(walked: Iterable[Course]) -> Mapping[str, tuple[Course, ...]]:
    """The courses that end in each sequence, in the order in which the sequences are first met."""
    result: dict[str, list[Course]] = {}
    for course in walked:
        result.setdefault(course.sequence, []).append(course)
    return {name: tuple(found) for name, found in result.items()}
