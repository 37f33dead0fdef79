"""Exhibits: the tables and plots that a proof file has in the report, worked out with it.

    @table(
        id="counter.response", title="Response by check speed", source="[D] runs of the model",
        columns=(Column("check speed", "km/h"), Column("computed", "s", decimals=3), Column("agrees")),
        says_no=("5: agrees",),
    )
    def response() -> Iterator[Row]:
        yield 250, Fraction("0.6265"), True
        yield 5, Fraction("0.7"), False

    @plot(id="counter.choice", title="f1 by n", source="[P] figure 4", x=Axis("n", log=True), y=Axis("f1", "Hz"))
    def choice() -> Iterator[Mark]:
        yield Curve("0.25 %", [(900, 4000), (1000, 4100)])
        yield Rule("asymptote", x=400)

A yes or no in a row is a check: the cells that say no, by the first cell of their row and their column, have to be
those in `says_no`, or the exhibit is not as asked; nothing else of it is judged.  Cells are text, yes or no, None, or
numbers, best exact ones.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from types import FrameType
from typing import Any

from safety.exhibits.parts import Axis, Band, Cell, Column, Curve, Mark, Note, Number, Point, Points, Row, Rule

__all__ = [
    "Axis",
    "Band",
    "Column",
    "Curve",
    "Exhibit",
    "ExhibitError",
    "Mark",
    "Note",
    "Points",
    "Row",
    "Rule",
    "declared",
    "plot",
    "table",
]
_declared: dict[str, Exhibit] = {}


class ExhibitError(Exception):
    """A table or plot that cannot be shown as it is declared; the message names it and what to do."""

    exit_code = 2


@dataclass(frozen=True, eq=False)
class Exhibit:
    """A table (`columns`) or a plot (`x` and `y`) and what makes its rows or marks."""

    id: str
    title: str
    source: str
    make: Callable[[], Iterable[Any]]
    columns: tuple[Column, ...] = ()
    says_no: tuple[str, ...] = ()
    axes: tuple[Axis, ...] = ()
    requirement: str = ""
    note: str = ""
    assumed: tuple[str, ...] = ()
    file: str = ""
    line: int = 1

    @property
    def kind(self) -> str:
        """What it is shown as."""
        return "table" if self.columns else "plot"

    def evaluate(self) -> dict[str, Any]:
        """The entry under "exhibits" of the results document.

        Raises `ExhibitError` for rows that do not fit the columns, and marks that do not fit the axes.
        """
        entry: dict[str, Any] = {
            "id": self.id,
            "kind": self.kind,
            "title": self.title,
            "source": self.source,
            "requirement": self.requirement or None,
            "caption": self.note or None,
            "assumed": list(self.assumed),
        }
        return entry | (self._table() if self.columns else self._plot())

    def _table(self) -> dict[str, Any]:
        rows = self._made()
        for row in rows:
            if not isinstance(row, list | tuple):
                raise ExhibitError(f"{self.id}: a row is {row!r}; it is a list or tuple, with a cell for each column")
            if len(row) != len(self.columns):
                raise ExhibitError(f"{self.id}: a row of {len(row)} cells, {row!r}, in {len(self.columns)} columns")
        no = [
            f"{row[0]}: {column.name}"
            for row in rows
            for column, cell in zip(self.columns, row, strict=True)
            if cell is False
        ]
        found: dict[str, Any] = {
            "columns": [
                {"name": c.name, "unit": c.unit, "decimals": c.decimals, "assumed": c.assumed} for c in self.columns
            ],
            "rows": [[self._cell(cell) for cell in row] for row in rows],
            "as_expected": sorted(no) == sorted(self.says_no),
        }
        if not found["as_expected"]:
            found["note"] = f"no in {', '.join(no) or 'none'}; expected in {', '.join(self.says_no) or 'none'}"
        return found

    def _made(self) -> list[Any]:
        found = self.make()
        if not isinstance(found, Iterable):
            raise ExhibitError(f"{self.id}: its function gives {found!r}; let it yield one after the other")
        made = list(found)
        if not made:
            raise ExhibitError(f"{self.id} is empty: its function gives nothing")
        return made

    def _plot(self) -> dict[str, Any]:
        x, y = self.axes
        marks = [self._mark(mark) for mark in self._made()]
        if not any(mark["kind"] in ("curve", "points") for mark in marks):
            raise ExhibitError(f"{self.id} has neither a curve nor a point; yield one, or declare a table")
        return {"x": self._axis(x), "y": self._axis(y), "marks": marks}

    def _axis(self, axis: Axis) -> dict[str, Any]:
        low, high = (None if end is None else self._number(end, axis) for end in (axis.low, axis.high))
        if low is not None and high is not None and not low < high:
            raise ExhibitError(f"{self.id}: axis {axis.name!r} from {low} to {high}; its low end comes first")
        found = {"name": axis.name, "unit": axis.unit, "log": axis.log, "low": low, "high": high}
        return found | ({"falling": True} if axis.falling else {})

    def _mark(self, mark: Mark) -> dict[str, Any]:
        x, y = self.axes
        if not isinstance(mark, Mark):
            raise ExhibitError(f"{self.id}: a mark is {mark!r}; it is a Curve, Points, Rule, Band or Note")
        if isinstance(mark, Note):
            return {"kind": mark.kind, "text": mark.text, "at": self._point(mark.at)}
        shown: dict[str, Any] = {"kind": mark.kind, "label": mark.label}
        if isinstance(mark, Curve | Points):
            names = getattr(mark, "names", ())
            if names and len(names) != len(mark.points):
                raise ExhibitError(f"{self.id}: {len(names)} names for the {len(mark.points)} points of {mark.label!r}")
            named: dict[str, Any] = {"names": list(names)} if isinstance(mark, Points) else {}
            named |= {} if getattr(mark, "marked", True) else {"marked": False}
            return shown | {"points": [self._point(point) for point in mark.points]} | named
        if (mark.x is None) == (mark.y is None):
            raise ExhibitError(f"{self.id}: {mark.label!r} stands at an x or at a y; give one of both")
        name, axis, at = ("x", x, mark.x) if mark.x is not None else ("y", y, mark.y)
        ends = at if isinstance(at, tuple) else (at,)
        values = [self._number(end, axis) for end in ends if end is not None]
        if values != sorted(values):
            raise ExhibitError(f"{self.id}: {mark.label!r} from {values[0]} to {values[1]}; its low end comes first")
        return shown | {"axis": name, "at": values}

    def _point(self, point: Point) -> list[float]:
        if not isinstance(point, list | tuple) or len(point) != len(self.axes):
            raise ExhibitError(f"{self.id}: a point is {point!r}; it is an x and a y")
        return [self._number(value, axis) for value, axis in zip(point, self.axes, strict=True)]

    def _number(self, value: Number, axis: Axis) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float | Fraction):
            raise ExhibitError(f"{self.id}: {axis.name} = {value!r} is no number")
        try:
            found = float(value)
        except OverflowError:
            found = math.inf
        if not math.isfinite(found) or (axis.log and found <= 0):
            above = " above 0, since its axis is logarithmic" if axis.log else ""
            raise ExhibitError(f"{self.id}: {axis.name} = {value}; a place on a plot is a finite number{above}")
        return found

    def _cell(self, cell: Cell) -> Any:
        if isinstance(cell, Fraction):
            return {"value": float(cell), "exact": str(cell)}
        if isinstance(cell, float) and not math.isfinite(cell):
            raise ExhibitError(f"{self.id}: a cell is {cell}; write what that means in words")
        if cell is None or isinstance(cell, str | bool | int | float):
            return cell
        raise ExhibitError(f"{self.id}: a cell is {cell!r}; it is text, a number, yes or no, or None")


Make = Callable[[], Iterable[Any]]


def table(
    *,
    id: str,
    title: str,
    source: str,
    columns: Sequence[Column],
    says_no: Sequence[str] = (),
    requirement: str = "",
    note: str = "",
    assumed: Sequence[str] = (),
) -> Callable[[Make], Make]:
    """Declare a table; the function below gives its rows.

    `source` has the tags of what is shown, `assumed` the inputs that no source gives, `note` stands below the title.
    Raises `ExhibitError` for no column, and for an id that another line has taken.
    """
    if not columns:
        raise ExhibitError(f"{id} has no columns; name them in columns=")
    more = {"columns": tuple(columns), "says_no": tuple(says_no)}
    return _declare(id, title, source, requirement, note, assumed, more)


def plot(
    *,
    id: str,
    title: str,
    source: str,
    x: Axis,
    y: Axis,
    requirement: str = "",
    note: str = "",
    assumed: Sequence[str] = (),
) -> Callable[[Make], Make]:
    """Declare a plot; the function below gives its marks, those that come first lie below.  Else as `table`."""
    return _declare(id, title, source, requirement, note, assumed, {"axes": (x, y)})


def declared() -> list[Exhibit]:
    """All exhibits that imported proof files have declared, in order.  A file that is read again replaces its own."""
    return list(_declared.values())


def _declare(
    id: str, title: str, source: str, requirement: str, note: str, assumed: Sequence[str], more: Mapping[str, Any]
) -> Callable[[Make], Make]:
    caller: FrameType = sys._getframe(2)
    place: dict[str, Any] = {"file": caller.f_code.co_filename, "line": caller.f_lineno}

    def keep(make: Make) -> Make:
        new = Exhibit(
            id, title, source, make, requirement=requirement, note=note, assumed=tuple(assumed), **more, **place
        )
        old = _declared.get(id)
        if old is not None and (old.file, old.line) != (new.file, new.line):
            raise ExhibitError(
                f"{id} is declared twice, at {old.file}:{old.line} and {new.file}:{new.line}; ids are unique"
            )
        _declared[id] = new
        return make

    return keep
