"""Event trees: what may follow an initiating event, fork by fork, down to the sequences that end it.

Words and meaning are those of the Open-PSA Model Exchange Format 2.0d, "Event Tree Layer". A fork asks for the state of
a functional event (a safety function); each of its paths collects formulas (gates that hold on this path, the
success of a system as the negation of its failure), or expressions (split fractions that multiply the probability),
and may set house events for what is collected after it. Probabilities are without unit, the frequency of an initiating
event is in its own unit (per hour, per year, per demand) and hands it to the sequences.

What stands here is the description, checked when made; `paths` walks it and `answers` gives probabilities.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from safety.trees.as_written import Rational, TreeError

if TYPE_CHECKING:
    from safety.trees.expressions.expression import Expression

    Factor = Expression | Rational

COMBINATIONS = ("and", "or", "not")  # kinds of Combined


@dataclass(frozen=True)
class InitiatingEvent:
    """What starts a course of events; `frequency` None: all answers are per occurrence of it."""

    name: str
    event_tree: str = ""  # "": it starts none
    frequency: Factor | None = None
    instructions: tuple[Instruction, ...] = ()  # carried out before the tree is entered
    description: str = ""


@dataclass(frozen=True)
class FunctionalEvent:
    """A safety function whose state a fork asks for: a column of the event tree."""

    name: str
    description: str = ""


@dataclass(frozen=True)
class CollectFormula:
    """The gate or event `name` occurs on this path, under the house events as set by then."""

    name: str


@dataclass(frozen=True)
class CollectExpression:
    """The probability of this path is multiplied by `expression`."""

    expression: Factor


@dataclass(frozen=True)
class SetHouseEvent:
    """The house event has this state in all that is collected after this."""

    name: str
    state: bool


@dataclass(frozen=True)
class Choice:
    """`then` where the test is true, else `otherwise`, which may be absent."""

    test: Condition
    then: Instruction
    otherwise: Instruction | None = None


@dataclass(frozen=True)
class Block:
    """Several instructions, one after the other."""

    instructions: tuple[Instruction, ...]


@dataclass(frozen=True)
class Rule:
    """Several instructions under a name, used in several places."""

    name: str
    instructions: tuple[Instruction, ...]
    description: str = ""


@dataclass(frozen=True)
class Link:
    """The course of events goes on in another event tree; only at the end of a sequence."""

    event_tree: str


Instruction = CollectFormula | CollectExpression | SetHouseEvent | Choice | Block | Rule | Link


@dataclass(frozen=True)
class InitiatingEventIs:
    """True where the course of events began with `name`."""

    name: str


@dataclass(frozen=True)
class FunctionalEventIs:
    """True where the path taken at the fork of the functional event `name` was `state`; false before that fork."""

    name: str
    state: str


@dataclass(frozen=True)
class Combined:
    """Tests combined by `and`, `or`, `not`. Raises TreeError: unknown kind, wrong number of parts."""

    kind: str
    parts: tuple[Condition, ...]

    def __post_init__(self) -> None:
        if self.kind not in COMBINATIONS or not self.parts or (self.kind == "not" and len(self.parts) != 1):
            raise TreeError(
                f"a test is {self.kind!r} of {len(self.parts)} parts, expected and, or of one or more, or not of "
                "one; rewrite it with these"
            )


Condition = InitiatingEventIs | FunctionalEventIs | Combined


@dataclass(frozen=True)
class ToSequence:
    """A path ends in the sequence `name`."""

    name: str


@dataclass(frozen=True)
class ToBranch:
    """A path goes on as the named branch `name` says."""

    name: str


@dataclass(frozen=True)
class Path:
    """One alternative at a fork."""

    state: str
    branch: Branch


@dataclass(frozen=True)
class Fork:
    """The alternatives for one functional event. Raises TreeError: no path, two for the same state."""

    functional_event: str
    paths: tuple[Path, ...]

    def __post_init__(self) -> None:
        if not self.paths:
            raise TreeError(f'the fork of "{self.functional_event}" has no path; give it one for each state')
        for state in _repeated(path.state for path in self.paths):
            raise TreeError(f'the fork of "{self.functional_event}" has two paths for the state "{state}"; rename one')


@dataclass(frozen=True)
class Branch:
    """Instructions, then a fork or an end."""

    instructions: tuple[Instruction, ...]
    target: Fork | ToSequence | ToBranch


@dataclass(frozen=True)
class NamedBranch:
    """A branch that several paths go on with."""

    name: str
    branch: Branch
    description: str = ""


@dataclass(frozen=True)
class Sequence:
    """An end of the event tree; its instructions are carried out there, and a link among them goes on elsewhere."""

    name: str
    instructions: tuple[Instruction, ...] = ()
    description: str = ""


@dataclass(frozen=True)
class EventTree:
    """An event tree, checked when made: its names, and that no path asks twice for the same functional event.

    Sequences may also be those of other event trees, so that they are checked when the tree is walked. Raises
    TreeError.
    """

    name: str
    functional_events: tuple[FunctionalEvent, ...]
    sequences: tuple[Sequence, ...]
    branches: tuple[NamedBranch, ...]
    initial: Branch
    description: str = ""

    def __post_init__(self) -> None:
        for what, named in (
            ("functional events", self.functional_events),
            ("sequences", self.sequences),
            ("branches", self.branches),
        ):
            for name in _repeated(one.name for one in named):
                raise self._error(f'has two {what} "{name}"; rename one')
        done: set[tuple[str, frozenset[str]]] = set()
        for branch in (self.initial, *(named.branch for named in self.branches)):
            self._check(branch, frozenset(), (), done)

    @cached_property
    def branch_named(self) -> Mapping[str, Branch]:
        """The named branches."""
        return {named.name: named.branch for named in self.branches}

    @cached_property
    def rules(self) -> Mapping[str, Rule]:
        """The rules used in it. Raises TreeError when a name stands for two of them."""
        branches = [self.initial, *(named.branch for named in self.branches)]
        instructions = [one.instructions for one in self.sequences]
        while branches:
            branch = branches.pop()
            instructions.append(branch.instructions)
            if isinstance(branch.target, Fork):
                branches += (path.branch for path in branch.target.paths)
        found: dict[str, Rule] = {}
        for rule in flat(one for row in instructions for one in row):
            if isinstance(rule, Rule) and found.setdefault(rule.name, rule) != rule:
                raise self._error(f'uses two rules "{rule.name}" that say different things; rename one')
        return found

    def _check(
        self,
        branch: Branch,
        asked: frozenset[str],
        entered: tuple[str, ...],
        done: set[tuple[str, frozenset[str]]],
    ) -> None:
        """Check what follows after the functional events `asked`, inside the named branches `entered`."""
        for instruction in flat(branch.instructions):
            if isinstance(instruction, Link):
                raise self._error(
                    f'goes on in the event tree "{instruction.event_tree}" in the middle of a branch; end it in '
                    "a sequence with this link"
                )
        match branch.target:
            case Fork(name, paths):
                if all(event.name != name for event in self.functional_events):
                    raise self._error(f'has a fork of "{name}", which is no functional event of it; define it')
                if name in asked:
                    raise self._error(f'has a path with two forks of "{name}"; keep one of them')
                for path in paths:
                    self._check(path.branch, asked | {name}, entered, done)
            case ToBranch(name):
                if name in entered:
                    raise self._error(f"has branches in a cycle: {' -> '.join([*entered, name])}; end one of them")
                if name not in self.branch_named:
                    raise self._error(f'goes on with the branch "{name}", which it does not have; define it')
                if (name, asked) not in done:
                    self._check(self.branch_named[name], asked, (*entered, name), done)
                    done.add((name, asked))

    def _error(self, what: str) -> TreeError:
        return TreeError(f'event tree "{self.name}" {what}', self.name)


def flat(instructions: Iterable[Instruction]) -> Iterator[Instruction]:
    """All instructions, also those inside blocks, rules and choices, whatever the tests say."""
    for instruction in instructions:
        yield instruction
        match instruction:
            case Block(inner) | Rule(_, inner):
                yield from flat(inner)
            case Choice(_, then, otherwise):
                yield from flat((then,) if otherwise is None else (then, otherwise))


def _repeated(names: Iterable[str]) -> list[str]:
    return [name for name, times in Counter(names).items() if times > 1]
