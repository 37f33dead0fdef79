"""An event tree as a picture: functional events as columns, forks with their states, a row for each path.

Drawn from the plain fields of a results document: the paths with their states, in the order of the columns. At the
right stand the sequence that a path ends in and its probability and frequency, which are those of all its paths
together and so are written once. Rows beyond ROWS are left out, and the picture says how many.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from itertools import groupby
from typing import Any

from safety.report.assumed import mark
from safety.report.numbers import clean, number
from safety.report.svg import element, text
from safety.report.tree_text import clipped, text_width

COLUMN, ROW, HEAD, FOOT, SIDE = 128, 30, 58, 22, 12  # px: of a functional event, a path, above, below, at the sides
GAP = 10  # px between words and lines
ENDS = 96, 110, 110  # px: of the columns of sequence, probability, frequency, at least
LINES = 3  # of the name of a functional event
ROWS = 200
STYLE = """
.et text { font: 11.5px system-ui, "Segoe UI", "DejaVu Sans", "Noto Sans CJK JP", Arial, sans-serif;
  fill: var(--ink, #1b1f24); }
.et .head { font-weight: 600; } .et .dim { fill: var(--dim, #57606a); }
.et path { fill: none; stroke: var(--ink, #1b1f24); } .et .rule { stroke: var(--dim, #57606a); }
"""
Entry = Mapping[str, Any]
Row = tuple[tuple[str, ...], Entry]  # the states, "" where the functional event is not asked for, and the sequence


def event_trees_svg(entries: Sequence[Entry]) -> str:
    """The pictures of entries of "event_trees" below one another, as one SVG."""
    if len(entries) == 1:
        return event_tree_svg(entries[0])
    parts, y, wide = [], 0, 0
    for entry in entries:
        content, width, height = _drawn(entry)
        parts.append(element("g", content, transform=f"translate(0 {y})"))
        y, wide = y + height + 2 * SIDE, max(wide, width)
    return _svg("".join(parts), wide, y, f"Event trees after {', '.join(str(entry['id']) for entry in entries)}")


def event_tree_svg(entry: Entry) -> str:
    """The picture of one entry of "event_trees"; the same entry always gives the same text."""
    content, width, height = _drawn(entry)
    ends = ", ".join(f"{one['id']} {number(one['probability'])}" for one in entry["sequences"][:ROWS])
    return _svg(content, width, height, f"Event tree {entry['event_tree']} after {entry['id']}: {ends}")


def _svg(content: str, width: int, height: int, label: str) -> str:
    return clean(
        element(
            "svg",
            element("style", STYLE),
            content,
            class_="et",
            xmlns="http://www.w3.org/2000/svg",
            viewBox=f"0 0 {width} {height}",
            width=width,
            height=height,
            role="img",
            aria_label=label,
        )
    )


def _drawn(entry: Entry) -> tuple[str, int, int]:
    """The picture with its width and height."""
    columns = _columns(entry)
    every = _rows(entry, columns)
    rows = every[:ROWS]
    picture = _Picture(entry, columns, rows)
    left_out = len(every) - len(rows)
    picture.end(f"{left_out} more paths are not shown" if left_out else "")
    return "".join(picture.parts), picture.width, picture.height


def _columns(entry: Entry) -> list[tuple[str, str]]:
    """Names and descriptions of the functional events that paths ask for, those of linked event trees last."""
    asked = dict.fromkeys(name for one in entry["sequences"] for path in one["paths"] for name in path)
    own = {one["id"]: one.get("description", "") for one in entry["functional_events"] if one["id"] in asked}
    return [*own.items(), *((name, "") for name in asked if name not in own)]


def _rows(entry: Entry, columns: Sequence[tuple[str, str]]) -> list[Row]:
    """The paths in such an order that those with the same states so far stand together."""
    rows = [
        (tuple(path.get(name, "") for name, _ in columns), one) for one in entry["sequences"] for path in one["paths"]
    ]
    for depth in reversed(range(len(columns))):
        first = {states[: depth + 1]: place for place, (states, _) in reversed(list(enumerate(rows)))}
        rows.sort(key=lambda row, first=first, depth=depth: first[row[0][: depth + 1]])  # type: ignore[misc]
    return rows


class _Picture:
    """The parts of one picture, from the right to the left and from above."""

    def __init__(self, entry: Entry, columns: Sequence[tuple[str, str]], rows: Sequence[Row]) -> None:
        self.entry, self.rows = entry, rows
        self.parts: list[str] = []
        self.start = SIDE + max(COLUMN, int(text_width(str(entry["id"]), bold=True)) + 2 * GAP)
        self.right = self.start + COLUMN * len(columns)
        names = [str(one["id"]) for _, one in rows]
        self.ends = [
            max(ENDS[0], int(max(map(text_width, names), default=0)) + 2 * GAP),
            *(ENDS[1:] if self._has_frequencies else ENDS[1:2]),
        ]
        self.width, self.height = self.right + sum(self.ends) + SIDE, HEAD + ROW * len(rows) + FOOT
        self._heads(columns)
        self._initiating(self._branch(0, range(len(rows)), len(columns)))
        self._sequences()

    @property
    def _has_frequencies(self) -> bool:
        return any(one.get("frequency") is not None for _, one in self.rows)

    def _heads(self, columns: Sequence[tuple[str, str]]) -> None:
        place = self.start
        for name, description in columns:
            lines = clipped(name, COLUMN - GAP, LINES, bold=True)
            row = [text(line, place + GAP / 2, 16 + 14 * n, class_="head") for n, line in enumerate(lines)]
            self.parts.append(element("g", element("title", escape(f"{name} {description}".strip())), *row))
            place += COLUMN
        for words, room in zip(("sequence", "probability", "frequency"), self.ends, strict=False):
            self.parts.append(text(words, place + GAP, 16, class_="head"))
            place += room
        self.parts.append(element("path", class_="rule", d=f"M{SIDE} {HEAD - 8}H{self.width - SIDE}"))

    def _initiating(self, y: float) -> None:
        frequency = self.entry.get("frequency")
        self.parts.append(text(self.entry["id"], SIDE, y - 5, class_="head"))
        if frequency is not None:
            self.parts.append(
                text(number(frequency) + mark(bool(self.entry.get("assumed"))), SIDE, y + 14, class_="dim")
            )
        self.parts.append(element("path", d=f"M{SIDE} {y:.1f}H{self.start}"))

    def _branch(self, depth: int, places: range, depths: int) -> float:
        """Draw what paths do from a column on, all of one course so far; the height at which they come in."""
        left = self.start + COLUMN * depth
        if depth == depths:
            first, last = (HEAD + ROW * (place + 0.5) for place in (places[0], places[-1]))
            if last > first:  # paths that the columns do not tell apart
                self.parts.append(element("path", d=f"M{left} {first:.1f}V{last:.1f}"))
            return first
        heights, states = [], []
        for state, group in groupby(places, key=lambda place: self.rows[place][0][depth]):
            own = list(group)
            heights.append(self._branch(depth + 1, range(own[0], own[-1] + 1), depths))
            states.append(state)
        middle = (heights[0] + heights[-1]) / 2
        fork = left + GAP / 2
        for state, y in zip(states, heights, strict=True):
            begin = left if len(heights) == 1 else fork
            self.parts.append(element("path", d=f"M{begin:.1f} {y:.1f}H{left + COLUMN}"))
            if state:
                (words,) = clipped(state, COLUMN - 2 * GAP, 1) or ("",)
                self.parts.append(text(words, fork + GAP / 2, y - 4, class_="dim"))
        if len(heights) > 1:
            self.parts.append(element("path", d=f"M{left} {middle:.1f}H{fork:.1f}"))
            self.parts.append(element("path", d=f"M{fork:.1f} {heights[0]:.1f}V{heights[-1]:.1f}"))
        return middle

    def _sequences(self) -> None:
        told: set[str] = set()
        for place, (_, one) in enumerate(self.rows):
            y, x = HEAD + ROW * (place + 0.5) + 4, self.right + GAP
            self.parts.append(text(one["id"], x, y))
            figures = [one.get("probability"), one.get("frequency")] if one["id"] not in told else []
            for room, figure in zip(self.ends[: len(self.ends) - 1], figures, strict=False):
                x += room
                self.parts.append(text(number(figure) + mark(figure is not None and one["assumed"]), x, y))
            told.add(one["id"])

    def end(self, words: str) -> None:
        """A line below."""
        if words:
            self.parts.append(text(words, SIDE, self.height - 6, class_="dim"))
