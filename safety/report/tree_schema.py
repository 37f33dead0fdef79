"""The shape of the entries under "trees" and "event_trees" of a results document."""

from __future__ import annotations

from typing import Any, Literal, Required, TypedDict

from safety.report.value_schema import Number, Tag


class Found(TypedDict, total=False):
    """A cut set found on a model: confirmed by replay, or a candidate."""

    faults: Required[list[str]]
    status: Required[Literal["confirmed", "candidate"]]
    steps: int | None


class Importance(TypedDict, total=False):
    """What one basic event does to the top event; further measures under their names."""

    event: Required[str]
    probability: Number
    source: Tag


class CutSet(TypedDict, total=False):
    """Events that together cause the top event."""

    events: Required[list[str]]
    probability: Number
    status: Literal["confirmed", "candidate"]  # replayed on the model, or not; absent where no model is behind the tree


class Limits(TypedDict):
    """What cut sets were asked for: at most so many events, at least that probability; None: any."""

    order: int | None
    probability: Number


class CutSets(TypedDict, total=False):
    """The minimal cut sets: all counted, the smallest listed."""

    limits: Limits  # those beyond them are not counted; absent where there are none
    count: int | None
    by_order: dict[str, int]
    sets: list[CutSet]
    not_listed: int


class Tree(TypedDict, total=False):
    """A fault tree, solved."""

    id: Required[str]
    source: str | None
    gates: int | None
    basic_events: int | None
    probability: Number
    probability_low: Number
    probability_high: Number
    target: Number
    met: bool | None
    minimal_cut_sets: CutSets | None
    importance: list[Importance]
    alignment: str  # in whose phase, with its part of the time
    phase: str
    time_fraction: Number
    mean_over_phases: Number
    gate_importance: list[dict[str, Any]]  # rows as those of events, each with its "gate"
    cut_sets: list[Found]  # as found on a model
    minimal_by: list[str]  # solvers that show that no proper part of a set suffices
    not_minimal: list[list[str]]  # sets of which a part may suffice
    cached: bool  # of an earlier run, from which nothing has changed
    complete_to_order: int | None  # of these
    complete_at_all_orders: bool
    faults_listed: int  # of the hazard: what "all orders" is about
    structure: dict[str, Any]  # the tree itself, in the fault-tree format of safety.trees.formats.json_form
    uncertainty: dict[str, Any]  # of the probability, sampled: see safety.trees.uncertainty.propagation.fields
    sensitivity: dict[str, Any]  # see safety.trees.uncertainty.sensitivity.fields
    errors: list[str]  # of options that could not be carried out
    as_expected: bool
    seconds: Any
    error: str | None


class FunctionalEvent(TypedDict, total=False):
    """A safety function whose states the forks of an event tree tell apart."""

    id: Required[str]
    description: str


class Sequence(TypedDict, total=False):
    """An end of an event tree; its probability is that given the initiating event."""

    id: Required[str]
    description: str
    probability: Number
    probability_low: Number
    probability_high: Number
    probability_exact: str | None
    frequency: Number  # in the unit of the initiating event; None where that has none
    frequency_low: Number
    frequency_high: Number
    frequency_exact: str | None
    frequency_of_all_initiating_events: Number
    uncertainty: dict[str, Any]  # of the probability, as that of a tree
    frequency_uncertainty: dict[str, Any]  # likewise
    frequency_of_all_initiating_events_uncertainty: dict[str, Any]
    assumed: Required[bool]  # whether the figures rest on an event with the source tag A
    assumed_over_all: bool  # likewise that of all initiating events, which may rest on more
    paths: Required[list[dict[str, str]]]  # the state of each functional event on the way
    minimal_cut_sets: CutSets | None
    importance: list[Importance]


class EventTree(TypedDict, total=False):
    """Everything that may follow one initiating event."""

    id: Required[str]  # of the initiating event
    description: str
    source: str | None
    event_tree: Required[str]
    frequency: Number
    assumed: bool  # whether the frequency is
    frequency_low: Number
    frequency_high: Number
    frequency_exact: str | None
    functional_events: Required[list[FunctionalEvent]]
    sequences: Required[list[Sequence]]
    alignment: str  # in whose phase, with its part of the time
    phase: str
    time_fraction: Number
    total: Number  # of the probabilities of the sequences
    total_low: Number
    total_high: Number
    total_exact: str | None
    whole: Number  # what they should add up to: 1, less where substitutions take cases out
    partition: bool | None  # whether the sequences share out all that can happen; None: not known
    wrong: list[str]  # what speaks against it
    errors: list[str]
    seconds: Any
    error: str | None
