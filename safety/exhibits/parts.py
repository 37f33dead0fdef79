"""What tables and plots are made of: columns and cells, axes and marks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, TypeAlias

Number: TypeAlias = int | float | Fraction
Cell: TypeAlias = str | bool | Number | None
Row: TypeAlias = Sequence[Cell]
Point: TypeAlias = tuple[Number, Number]


@dataclass(frozen=True)
class Column:
    """A column of a table; numbers with so many decimals, by size where none are said.  `assumed`: marked [A]."""

    name: str
    unit: str = ""
    decimals: int | None = None
    assumed: bool = False


@dataclass(frozen=True)
class Axis:
    """An axis of a plot, from `low` to `high`; where these are not given, as far as curves and points go.

    `falling`: the high end is on the left or below, as of a distance that is still to go.
    """

    name: str
    unit: str = ""
    log: bool = False
    low: Number | None = None
    high: Number | None = None
    falling: bool = False


@dataclass(frozen=True)
class Curve:
    """A line through points, in their order; what lies outside the axes is cut off.

    Few points have a marker each, unless it is not `marked`.
    """

    label: str
    points: Sequence[Point]
    marked: bool = True
    kind: Literal["curve"] = field(default="curve", init=False)


@dataclass(frozen=True)
class Points:
    """Single points, each with a marker; `names` are written beside them."""

    label: str
    points: Sequence[Point]
    names: Sequence[str] = ()
    kind: Literal["points"] = field(default="points", init=False)


@dataclass(frozen=True)
class Rule:
    """A line across the plot, at one x or one y."""

    label: str
    x: Number | None = None
    y: Number | None = None
    kind: Literal["rule"] = field(default="rule", init=False)


@dataclass(frozen=True)
class Band:
    """A shaded range of x or of y."""

    label: str
    x: tuple[Number, Number] | None = None
    y: tuple[Number, Number] | None = None
    kind: Literal["band"] = field(default="band", init=False)


@dataclass(frozen=True)
class Note:
    """Words at a point."""

    text: str
    at: Point
    kind: Literal["note"] = field(default="note", init=False)


Mark: TypeAlias = Curve | Points | Rule | Band | Note
