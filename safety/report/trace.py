"""A counterexample as something to look at: which ticks to show, which cells changed, each value as a word.

The timing diagram, the HTML table and the terminal table are all drawn from here, so that they agree.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any, Literal, NamedTuple

from safety.report.schema import Entry

Value = bool | int | float | str | None


class Lane(NamedTuple):
    """A signal over all ticks."""

    path: str
    bit: bool
    unit: str
    values: tuple[Value, ...]


class Column(NamedTuple):
    """One tick, or a stretch of ticks left out: unchanged throughout, or changing but too long to draw."""

    tick: int
    ticks: int = 1
    kind: Literal["tick", "unchanged", "left out"] = "tick"


class Cell(NamedTuple):
    """A signal at a tick."""

    tick: int
    text: str
    changed: bool  # against the column before


class Row(NamedTuple):
    """A signal at the ticks of the table."""

    lane: Lane
    cells: list[Cell]


class Table(NamedTuple):
    """The ticks that tell the story."""

    ticks: list[int]
    left_out: int  # eventful ticks without a column; they lie after the first one
    violated: int | None
    rows: list[Row]
    ms: str  # of the violated tick; empty when the clock is an event


class Trace:
    """The signals of a counterexample by tick; a tick outside of a signal has no value."""

    def __init__(self, counterexample: Entry) -> None:
        signals = counterexample["signals"]
        self.first: int = counterexample.get("first_tick", 0)
        steps = counterexample["steps"]
        self.lanes = [Lane(s["path"], s.get("kind") == "bit", s.get("unit", ""), _values(s, steps)) for s in signals]
        length = max((len(lane.values) for lane in self.lanes), default=0)
        self.last = self.first + length - 1
        self.violated: int | None = counterexample["violated_at"]
        self.onset: int | None = counterexample.get("fault_onset")
        tick_s = counterexample.get("tick_s")
        self.tick_s = Fraction(tick_s) if tick_s else None

    def value(self, lane: Lane, tick: int) -> Value:
        """What a signal holds at a tick; None is any value."""
        place = tick - self.first
        return lane.values[place] if 0 <= place < len(lane.values) else None

    def changed(self, lane: Lane, tick: int) -> bool:
        """Against the tick before."""
        return tick > self.first and self.value(lane, tick) != self.value(lane, tick - 1)

    def eventful(self) -> list[int]:
        """The ticks at which something changes, begins or is violated."""
        marked = {self.first, self.last, self.violated, self.onset}
        return [
            t
            for t in range(self.first, self.last + 1)
            if t in marked or any(self.changed(lane, t) for lane in self.lanes)
        ]

    def columns(self, room: int = 64, calm: int = 5) -> list[Column]:
        """What to draw in about `room` columns: calm stretches shrink to one; if need be, an early part is left out."""
        events = self.eventful()
        shown = sorted({t for e in events for t in (e - 1, e) if t >= self.first})
        columns: list[Column] = []
        for tick in shown:
            after = columns[-1].tick + 1 if columns else tick
            if tick - after >= calm:
                columns.append(Column(after, tick - after, "unchanged"))
            else:
                columns += [Column(t) for t in range(after, tick)]
            columns.append(Column(tick))
        if len(columns) <= room:
            return columns
        focus = next((n for n, c in enumerate(columns) if c.tick == self.violated), len(columns) - 1)
        head, end = room // 8, min(len(columns), max(room, focus + 1 + room // 8))
        start = max(head, end - (room - head - 1))
        return [*columns[:head], *_left_out(columns[head:start]), *columns[start:end], *_left_out(columns[end:])]

    def table(self, room: int) -> Table:
        """The eventful ticks up to the violation, at most `room`: the first one, then those next to the violation."""
        ticks = [t for t in self.eventful() if self.violated is None or t <= self.violated]
        left_out = max(0, len(ticks) - room)
        ticks = [ticks[0], *ticks[left_out + 1 :]] if ticks else []
        rows = []
        for lane in self.lanes:
            values = [self.value(lane, tick) for tick in ticks]
            changed = [n > 0 and value != values[n - 1] for n, value in enumerate(values)]
            rows.append(
                Row(lane, [Cell(t, word(v, lane.bit), c) for t, v, c in zip(ticks, values, changed, strict=True)])
            )
        return Table(ticks, left_out, self.violated, rows, "" if self.violated is None else self.time_ms(self.violated))

    def time_ms(self, tick: int) -> str:
        """The time of a tick; empty when the clock is an event."""
        return "" if self.tick_s is None else decimal(tick * self.tick_s * 1000)


def _values(signal: Entry, steps: int) -> tuple[Value, ...]:
    """A value a tick, from all values or from the changes alone."""
    if "values" in signal:
        return tuple(signal["values"])
    changes = signal["changes"]
    ends = [*(tick for tick, _ in changes[1:]), steps]
    return tuple(v for (tick, v), end in zip(changes, ends, strict=True) for _ in range(tick, end))


def _left_out(columns: list[Column]) -> list[Column]:
    return [Column(columns[0].tick, sum(c.ticks for c in columns), "left out")] if columns else []


def decimal(value: Fraction, digits: int = 3) -> str:
    """Rounded to so many places, without trailing zeros."""
    return f"{float(value):.{digits}f}".rstrip("0").rstrip(".") or "0"


def word(value: Any, bit: bool) -> str:
    """A value as it stands in a cell."""
    if value is None:
        return "any"
    if bit:
        return "1" if value else "0"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
