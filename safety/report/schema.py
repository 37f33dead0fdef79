"""The shape of a results document, "rightside/1": what every command writes with --json and every report reads.

A document is plain dicts and lists; the classes below say what the keys hold, for the type checker and for
`msgspec.convert`. Keys may be added freely and are kept; none is ever renamed. Integers are exact at any size, "inf" is
infinity, None is unknown, and an "exact" key holds a rational "p/q" beside the double. Tags say where a value comes
from: P printed in the source, D derived, A assumed, R reconstructed.
"""

from __future__ import annotations

from typing import Any, Literal, Required, TypedDict

from safety.report.exhibit_schema import Exhibit
from safety.report.tree_schema import EventTree, Tree
from safety.report.value_schema import Bracket, Exact, Number, Seconds, Synthesis, Tag

SCHEMA = "rightside/1"
JUDGED = (
    "claims",
    "syntheses",
    "campaigns",
    "trees",
    "rates",
    "figures",
    "exhibits",
    "event_trees",
)  # entries are as asked or not
SECTIONS = (*JUDGED, "parameters", "requirements", "models")  # all sections: lists of entries, each with an id

Verdict = Literal["proved", "bounded", "vacuous", "refuted", "undecided"]
FigureVerdict = Literal["confirmed", "rounding", "misprint", "inconsistent", "not derivable", "assumed"]
Entry = dict[str, Any]  # one result, as read


class Signal(TypedDict, total=False):
    """One named point of the model over the ticks of a trace."""

    path: Required[str]
    kind: Literal["bit", "number"]
    unit: str
    values: list[bool | int | float | str | None]  # from first_tick on; None: any value; a str: an exact rational
    changes: list[list[bool | int | float | str | None]]  # instead of values: [tick, value] at tick 0 and each change


class Counterexample(TypedDict, total=False):
    """A trace on which a claim is false; for a bound over reals one step, with its point in `values`."""

    steps: Required[int]
    tick_s: Seconds | None  # None: the clock is an event
    violated_at: Required[int | None]
    replayed: Required[bool]
    faults: list[str]
    fault_onset: int | None  # the first tick with a fault; absent: not said
    first_tick: int  # the tick of the first value of each signal
    signals: Required[list[Signal]]
    replay: str  # the command that shows it again
    vcd: str | None  # relative to the report folder
    values: dict[str, str]  # the point at which a bound is exceeded: exact; a root is "[low, high]"
    value: Exact  # of the quantity there


class Strength(TypedDict, total=False):
    """How far a verdict reaches: {"kind": "bounded", "steps": 4096}."""

    kind: str | None
    steps: int | None


class Reached(TypedDict):
    """Where a claim's premise first holds; None where it was not seen to hold."""

    premise_reached_at: int | None


class Budget(TypedDict):
    """How many faults at most, of which."""

    most: int
    of: list[str]


class Setting(TypedDict, total=False):
    """A parameter as a claim used it; its source begins with the tag."""

    name: Required[str]
    value: Any
    unit: str
    low: Any
    high: Any
    source: str


class Claim(TypedDict, total=False):
    """A sentence about a model, the verdict its author expects and the one it got."""

    id: Required[str]
    model: Required[str | None]  # None: a bound over reals
    statement: str
    role: Literal["claim", "twin", "defeat", "lemma", "refinement", "cover"]
    twin_of: str | None
    requirement: str | None
    source: str | None
    expect: Required[Verdict]
    verdict: Required[Verdict]
    as_expected: bool
    strength: Strength | None
    why: str | None  # the verdict is not the one hoped for
    faults: str | Budget | None
    method: str | None
    user_lemmas: int | list[str] | None
    certificate: str | dict[str, Any] | None  # file, sha256, kind, complete; or kind "real" and the routes that agree
    limit: Exact  # of a bound
    bracket: Bracket
    agreed_by: list[str] | None
    disagreed_by: list[str] | None  # engines with another verdict
    tags: list[Tag]
    parameters: list[Setting]
    assumptions: list[str]
    clock: dict[str, str] | None  # {"tick_s": "1/8000"} or {"event": "..."}
    power_up: str | None
    vacuity: Reached | None  # None: the claim has no premise
    counterexample: Counterexample | None
    cached: bool  # of an earlier run, for the same problem
    rechecked: bool  # proved again, with the same outcome
    seconds: Number
    error: str | None  # an internal error met while working on it


class Mode(TypedDict, total=False):
    """One row of a failure-mode table: what became of the faults of one mode of one part."""

    part: Required[str]
    mode: Required[str]
    faults: int
    rate_per_h: Number
    safe: int
    detected: int
    dangerous_undetected: int
    no_effect: int
    tag: Tag
    bounds: dict[str, tuple[Number, Number]]  # of the figures of the row, such as "lambda_du"


class Group(TypedDict):
    """Counts by group of faults, under free headings such as "safe/yes"."""

    group: str
    counts: dict[str, int]


class Classes(TypedDict):
    """How many injections ended in each class."""

    safe: int
    detected: int
    dangerous_undetected: int
    no_effect: int


class Interval(TypedDict, total=False):
    """An estimate; low and high are the limits of its confidence interval."""

    value: Number
    low: Number
    high: Number
    exact: str


class Latency(TypedDict, total=False):
    """How long it took from the onset to the detection."""

    min: Required[int]
    max: Required[int]
    mean: Required[Number]
    unit: Required[str]
    histogram: Required[list[tuple[int, int]]]  # up to 0, 1, 2, 5, 10, ..., and how many took as long, but not shorter


class Detected(TypedDict, total=False):
    """What one detector was the first to find."""

    count: Required[int]
    latency: Latency | None


class Compared(TypedDict, total=False):
    """What is otherwise than in a baseline; injections by id."""

    file: Required[str]
    new: Required[dict[str, str]]  # dangerous undetected, and what each was
    lost: Required[dict[str, str]]  # no longer detected, and what each is
    unclear: Required[dict[str, str]]  # what changed of a fault, and one of its injections
    told: Required[list[str]]
    better: Required[list[str]]


class Reproducer(TypedDict, total=False):
    """The smallest injection that does the same harm as another."""

    of: Required[str]
    injection: Required[str]
    faults: int
    runs: int


class Aim(TypedDict, total=False):
    """A target of the diagnostic coverage, an exact share, and whether its lower bound reaches it.

    `met` is None for a sample without a dangerous injection, which says nothing of the coverage.
    """

    target: Required[str]
    met: Required[bool | None]
    told: Required[str]


class Place(TypedDict):
    """Where something is declared; the file is relative to the project."""

    file: str
    line: int


class Campaign(TypedDict, total=False):
    """A set of injected faults and what became of them."""

    id: Required[str]
    model: str
    faults: str | None
    injections: Required[int]
    exhaustive: Required[bool]
    expect: dict[str, Any]  # {"exhaustive": false} where a sample was asked for
    as_expected: bool
    classes: Required[Classes]
    diagnostic_coverage: Interval | None
    dangerous_undetected_of_all: Interval | None
    confidence: Number  # of the intervals; None where nothing was drawn
    safe_failure_fraction: Number | Interval
    fmeda: list[Mode]
    groups: list[Group]
    latency: Any
    detected_by: dict[str, Detected]
    target_coverage: Aim | None
    baseline: Compared | None
    closure: dict[str, Any] | None  # single faults by what settles them, see `safety.report.closing`
    reproducers: list[Reproducer]
    declared: Place | None
    replay: list[str]  # dangerous undetected injections, CAMPAIGN::INJECTION; the first of `replay_of`
    replay_of: int
    surprises: list[str]
    engine: str | None
    engine_note: str
    seconds: Number
    injections_per_second: Number
    error: str | None


class Rate(TypedDict, total=False):
    """A rate, a mean time or another reliability figure, against its target."""

    id: Required[str]
    quantity: Required[str]
    value: Number
    low: Number
    high: Number
    exact: str
    unit: str | None
    method: str | None
    source: str | None
    target: Number | str  # a number, or in words: "at most 1e-9 /h"
    met: bool | None
    assumed: list[str]  # the inputs tagged A
    agree: bool | None  # False: two independent routes differ
    as_expected: bool
    error: str | None


class Figure(TypedDict, total=False):
    """A figure or sentence printed in a source, recomputed."""

    id: Required[str]
    paper: str | None
    published: bool  # absent: it stands in the paper; False: worked out from it here
    where: str | None
    kind: str  # number, statement, equation, wording, name, claim
    requirement: str | None
    printed: Any
    recomputed: Any
    unit: str | None
    how: str  # the relation
    claim: str  # whose verdict decides
    denies: bool  # the words say the contrary of that claim
    inputs: list[str]  # what entered, each with its tag
    verdict: Required[FigureVerdict | None]  # None: the claim that decides has no verdict to give
    waits: bool  # as it was not run
    value: dict[str, Any]  # recomputed: value and exact, or low and high where it is enclosed
    mended: str  # of a misprint: what was meant
    slip: str  # and how it was spoilt
    evidence: list[str]  # what else speaks for that
    assumed: list[str]  # the inputs tagged A
    agreed_by: list[str]  # solvers that proved it
    disagreed_by: list[str]
    counterexample: dict[str, str]  # values at which an equation is false
    note: str | None
    as_expected: bool
    error: str | None


class Parameter(TypedDict, total=False):
    """A value that a model was given."""

    id: Required[str]
    model: str
    value: Any
    unit: str
    low: Any
    high: Any
    tag: Tag
    note: str


class Named(TypedDict, total=False):
    """An entry of which only the id is required."""

    id: Required[str]


class Document(TypedDict, total=False):
    """The whole."""

    schema: Required[Literal["rightside/1"]]
    project: str
    tool: dict[str, Any]
    claims: list[Claim]
    syntheses: list[Synthesis]
    campaigns: list[Campaign]
    trees: list[Tree]
    event_trees: list[EventTree]
    rates: list[Rate]
    figures: list[Figure]
    exhibits: list[Exhibit]
    parameters: list[Parameter]
    requirements: list[Named]  # {"id", "text"}
    models: list[Named]  # {"id", "sha256", "source"}
    limits: list[str]  # what the tools could not do in this run
    runs: list[dict[str, Any]]  # what was run, where and how long: never part of a committed report
    interrupted: bool
