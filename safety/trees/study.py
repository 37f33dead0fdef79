"""A study: everything that one set of files says, of which each fault tree is a part.

Units: probabilities 0..1, rates per hour, times in hours. Vocabulary of the Open-PSA Model Exchange Format 2.0d.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, cast

from safety.trees.as_written import TreeError, exact
from safety.trees.formats.draft import only_root, roots
from safety.trees.substitutions import Substitution, exchanged, stated
from safety.trees.tree import BasicEvent, FaultTree, Gate, HouseEvent, Node

if TYPE_CHECKING:
    from safety.trees.common_cause import CcfGroup
    from safety.trees.event_trees.definitions import EventTree, InitiatingEvent
    from safety.trees.expressions.expression import Expression, Parameter


ROUNDING = Fraction(1, 10**9)  # by which time fractions as printed may miss 1


@dataclass(frozen=True)
class Phase:
    """A part of the operating time, in which house events have the states in `house`; `fraction` 0..1 of the time."""

    name: str
    fraction: Fraction
    house: tuple[tuple[str, bool], ...] = ()
    description: str = ""

    def __post_init__(self) -> None:
        fraction = exact(self.fraction, f'time fraction of phase "{self.name}"', self.name)
        if not 0 <= fraction <= 1:
            raise TreeError(
                f'time fraction of phase "{self.name}" is {self.fraction}, expected between 0 and 1; correct it',
                self.name,
            )
        object.__setattr__(self, "fraction", fraction)


@dataclass(frozen=True)
class Alignment:
    """The phases of operation; their fractions add up to 1."""

    name: str
    phases: tuple[Phase, ...]
    description: str = ""

    def __post_init__(self) -> None:
        total = sum((phase.fraction for phase in self.phases), Fraction(0))
        if abs(total - 1) > ROUNDING:
            raise TreeError(
                f'time fractions of alignment "{self.name}" add up to {float(total):g}, expected 1; correct them',
                self.name,
            )


@dataclass(frozen=True)
class Study:
    """Gates and events of all fault trees, and what is said of them.

    Raises TreeError: duplicate or undefined names, cycles, references to what is not there.
    """

    name: str
    gates: tuple[Gate, ...]
    events: tuple[BasicEvent, ...]
    house_events: tuple[HouseEvent, ...] = ()
    tops: tuple[str, ...] = ()  # the gates to analyse; if not given, those that no other gate uses
    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    ccf_groups: tuple[CcfGroup, ...] = ()
    initiating_events: tuple[InitiatingEvent, ...] = ()
    event_trees: tuple[EventTree, ...] = ()
    substitutions: tuple[Substitution, ...] = ()
    alignments: tuple[Alignment, ...] = ()
    description: str = ""
    mission_time_h: Fraction | None = None
    tree_names: Mapping[str, str] = field(default_factory=dict)  # of a gate, the fault tree it was written in

    def __post_init__(self) -> None:
        object.__setattr__(self, "tops", tuple(self.tops or roots(self.gates)))
        object.__setattr__(self, "parameters", self._all_parameters())
        if self.gates:
            self._pool(self.gates[0].name)  # checks names and cycles
        nodes = self.nodes
        for one in self.substitutions:
            for name in (*one.sources, *([one.target] if isinstance(one.target, str) else [])):
                _check(isinstance(nodes.get(name), BasicEvent), "substitution", one.name, name, "basic event")
            _check(one.hypothesis in nodes, "substitution", one.name, one.hypothesis, "gate or event")
        for phase in (phase for alignment in self.alignments for phase in alignment.phases):
            for name, _ in phase.house:
                _check(isinstance(nodes.get(name), HouseEvent), "phase", phase.name, name, "house event")

    def _all_parameters(self) -> dict[str, Parameter]:
        """Those given, and those that expressions hold."""
        found = dict(self.parameters)
        parts = (self.ccf_groups, self.initiating_events, self.event_trees)
        for expression in (*(event.expression for event in self.events), *expressions_in(parts)):
            for name, parameter in expression.parameters.items() if expression is not None else ():
                if found.setdefault(name, parameter) != parameter:
                    raise TreeError(
                        f'parameter "{name}" is defined in two ways ({found[name].definition} and '
                        f"{parameter.definition}); rename one of them",
                        name,
                    )
        return found

    @cached_property
    def nodes(self) -> Mapping[str, Node]:
        """Every gate, basic event and house event by name, in this order."""
        every: tuple[Node, ...] = (*self.gates, *self.events, *self.house_events)
        return {node.name: node for node in every}

    @cached_property
    def trees(self) -> tuple[FaultTree, ...]:
        """The fault tree below each of `tops`, as written."""
        return tuple(self.tree(top) for top in self.tops)

    def tree(self, top: str | None = None) -> FaultTree:
        """The gates and events below `top`, as written: no common cause, no substitution, no phase is applied.

        Without `top` it is the one gate that no other uses; then what the top does not reach is kept as well.
        Raises TreeError when there are several, or no such gate.
        """
        if top is None:
            return self._pool(only_root(self.tops, self.gates))
        return _reached(self._pool(top))

    def quantified(
        self,
        top: str | None = None,
        *,
        gates: Iterable[Gate] = (),
        house: Mapping[str, bool] | None = None,
        of_rates: bool = False,
    ) -> FaultTree:
        """The tree below `top` with substitutions and common cause groups applied, for quantification.

        `gates` are further gates (`top` may be one of them), `house` the states of house events that differ from those
        written, as in a phase. Substitutions with sources are applied to the cut sets (see `substitutions.exchanged`).
        With `of_rates` common causes share out failure rates, not probabilities, as the mean time to failure needs.
        Raises TreeError.
        """
        states = house or {}
        houses = tuple(replace(one, state=states.get(one.name, one.state)) for one in self.house_events)
        top = top or only_root(self.tops, self.gates)
        tree = replace(self._pool(top, tuple(gates)), house_events=houses)
        tree = stated(tree, self.substitutions)
        if any(not one.declarative for one in self.substitutions):
            tree = exchanged(tree, self.substitutions)
        tree = _reached(tree)
        if groups := [one for one in self.ccf_groups if set(one.members) & tree.nodes.keys()]:
            from safety.trees.common_cause import apply

            tree = apply(tree, groups, {event.name for event in self.events}, of_rates=of_rates)
        return tree

    def in_phases(self, top: str | None = None) -> tuple[tuple[Alignment, Phase, FaultTree], ...]:
        """The tree to quantify in each phase of each alignment; `quantified` once, if there is no alignment.

        The mean of what is found over the phases of an alignment, weighted by their fractions, is that over the time.
        """
        return tuple(
            (alignment, phase, self.quantified(top, house=dict(phase.house)))
            for alignment in self.alignments or (Alignment("", (Phase("", Fraction(1)),)),)
            for phase in alignment.phases
        )

    def only_tree(self, top: str | None = None) -> FaultTree:
        """`quantified`, for a study that one fault tree can hold.

        Raises TreeError when alignments or event trees say more than one tree can.
        """
        for what, names in (("alignment", self.alignments), ("event tree", self.event_trees)):
            if names:
                raise TreeError(
                    f'{what} "{names[0].name}" cannot be part of one fault tree; read the files with read_study'
                )
        return self.quantified(top)

    def _pool(self, top: str, gates: tuple[Gate, ...] = ()) -> FaultTree:
        name = self.tree_names.get(top) or self.name or top
        every = (*self.gates, *gates)
        return FaultTree(name, top, every, self.events, self.house_events, self.description, self.mission_time_h)


def _reached(tree: FaultTree) -> FaultTree:
    """`tree` without what its top does not reach."""
    used = {tree.top}.union(*(gate.inputs for gate in tree.inputs_first))
    return replace(
        tree,
        gates=tuple(gate for gate in tree.gates if gate.name in used),
        events=tuple(event for event in tree.events if event.name in used),
        house_events=tuple(house for house in tree.house_events if house.name in used),
    )


def expressions_in(part: object) -> Iterator[Expression]:
    """Every expression in a part of a study."""
    if isinstance(part, tuple):
        for one in part:
            yield from expressions_in(one)
    elif hasattr(part, "as_given"):
        total, factors = part.as_given
        yield from expressions_in((total, *factors.values()))
    elif is_dataclass(part):
        for one in fields(part):
            yield from expressions_in(getattr(part, one.name))
    elif hasattr(part, "arguments"):
        yield cast("Expression", part)


def _check(found: bool, what: str, user: str, name: str, kind: str) -> None:
    if not found:
        raise TreeError(
            f'{what} "{user}" names "{name}", which is no {kind} of the study; define it or correct the name', user
        )
