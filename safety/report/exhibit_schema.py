"""The shape of an entry under "exhibits" of a results document; see `safety.exhibits`."""

from __future__ import annotations

from typing import Literal, Required, TypedDict

from safety.report.value_schema import Exact

Value = int | float


class Column(TypedDict, total=False):
    """A column of a table; `assumed`: what stands in it rests on assumed inputs."""

    name: Required[str]
    unit: str
    decimals: int | None
    assumed: bool


class Axis(TypedDict, total=False):
    """An axis of a plot; an end that is None goes by the points."""

    name: Required[str]
    unit: Required[str]
    log: Required[bool]
    low: Required[Value | None]
    high: Required[Value | None]
    falling: bool  # the high end on the left or below


class Mark(TypedDict, total=False):
    """Something drawn: a curve or points, a rule or band at one or two values of an axis, or words at a point."""

    kind: Required[Literal["curve", "points", "rule", "band", "note"]]
    label: str
    points: list[tuple[Value, Value]]
    names: list[str]
    marked: bool  # absent: a curve of few points has markers
    axis: Literal["x", "y"]
    at: list[Value]
    text: str


class Exhibit(TypedDict, total=False):
    """A table (`columns`, `rows`) or a plot (`x`, `y`, `marks`)."""

    id: Required[str]
    kind: Literal["table", "plot"]
    title: Required[str]
    source: str
    requirement: str | None
    caption: str | None
    assumed: list[str]  # inputs that no source gives, each with its tag
    columns: list[Column]
    rows: list[list[str | bool | Value | Exact | None]]
    x: Axis
    y: Axis
    marks: list[Mark]
    as_expected: bool
    note: str | None  # why it is not
    seconds: float
    error: str | None
