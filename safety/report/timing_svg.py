"""Timing diagram of a counterexample: waveforms for bits, value lanes for numbers, an axis in ticks and milliseconds.

Calm stretches shrink to one column with a break mark that says how many ticks it stands for. The tick that violates the
claim is marked, so is the first tick with a fault. Looks are in templates/timing.css.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from html import escape
from typing import NamedTuple

from safety.report.schema import Entry
from safety.report.svg import element, text
from safety.report.trace import Column, Lane, Trace, Value, word

LANES = 20
ROW, HIGH, TOP = 26, 15, 56  # px: lane pitch, wave height, height of axis and marks
MARKS = TOP - 18  # px: where the marks begin
LABEL, DRAWN, GAP = 210, 900, 72  # px: label column, width to share among ticks, width of a break
MARGIN = 30  # px at the right, for the last label
NARROW, WIDE = 15, 46  # px: limits of a tick's width
LETTER = 6.7  # px of one letter
LETTERS = 29  # of a signal's path; the end is kept, it says more


class Place(NamedTuple):
    """A column and where it is drawn."""

    column: Column
    x: float
    wide: float


class Run(NamedTuple):
    """A stretch of equal value, in pixels."""

    start: float
    end: float
    value: Value


def timing_svg(counterexample: Entry, title: str, ident: str = "td") -> str:
    """The diagram as an SVG element, empty when there is no signal; `ident` must be unique in the page."""
    trace = Trace(counterexample)
    lanes = trace.lanes[:LANES]
    if not lanes:
        return ""
    places = _places(trace.columns())
    width = round(places[-1].x + places[-1].wide + MARGIN)
    bottom = TOP + ROW * len(lanes)
    parts = [element("title", escape(title), id=f"{ident}-t"), element("desc", escape(_told(trace)), id=f"{ident}-d")]
    parts += _ground(trace, places, bottom)
    for n, lane in enumerate(lanes):
        parts += _lane(trace, lane, places, TOP + ROW * n + (ROW - HIGH) // 2)
    parts += _marks(trace, places, bottom)
    rest = len(trace.lanes) - len(lanes)
    if rest:
        parts.append(
            text(f"{rest} more signals are not drawn; results.json has them all", 8, bottom + 20, class_="dim")
        )
    height = bottom + (28 if rest else 10)
    return element(
        "svg",
        *(f"\n{part}" for part in parts),
        class_="td",
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {width} {height}",
        width=width,
        height=height,
        role="img",
        aria_labelledby=f"{ident}-t {ident}-d",
    )


def _places(columns: list[Column]) -> list[Place]:
    drawn = sum(c.kind == "tick" for c in columns)
    each = min(WIDE, max(NARROW, (DRAWN - GAP * (len(columns) - drawn)) / max(drawn, 1)))
    places, x = [], float(LABEL)
    for column in columns:
        places.append(Place(column, x, each if column.kind == "tick" else GAP))
        x += places[-1].wide
    return places


def _ground(trace: Trace, places: list[Place], bottom: int) -> Iterator[str]:
    """Axis, grid and the grey bands of the breaks."""
    yield text("tick", 8, 12, class_="dim") + text("ms" if trace.tick_s else "clock: events", 8, 27, class_="dim")
    labelled = _labelled(trace, places)
    for column, x, wide in places:
        if column.kind == "tick":
            yield element("path", class_="grid", d=f"M{x:.1f} {TOP - 4}V{bottom}")
            if column.tick in labelled:
                yield text(column.tick, x + 2, 12, class_="dim") + text(
                    trace.time_ms(column.tick), x + 2, 27, class_="dim"
                )
        else:
            yield element("rect", class_="gap", x=x, y=TOP - 4, width=wide, height=bottom - TOP + 4)
            words = "unchanged" if column.kind == "unchanged" else "not drawn"
            for line, y in ((column.ticks, 12), (words, 27)):
                yield text(line, x + wide / 2, y, class_="dim", text_anchor="middle")


def _labelled(trace: Trace, places: list[Place]) -> set[int]:
    """The ticks whose labels find room: the marked ones first, then from the left."""
    right = places[-1].x + places[-1].wide + MARGIN
    taken = [(p.x, p.x + p.wide) for p in places if p.column.kind != "tick"]
    ticks = [(p.column.tick, p.x) for p in places if p.column.kind == "tick"]
    chosen = set()
    for tick, x in sorted(ticks, key=lambda it: (it[0] not in (trace.violated, trace.onset), it[0])):
        end = x + 8 + LETTER * max(len(trace.time_ms(tick)), len(str(tick)))
        if tick == trace.violated or (end <= right and all(end <= a or x >= b for a, b in taken)):
            chosen.add(tick)
            taken.append((x, end))
    return chosen


def _lane(trace: Trace, lane: Lane, places: list[Place], y: int) -> Iterator[str]:
    name = lane.path + (f" [{lane.unit}]" if lane.unit else "")
    yield element("g", element("title", escape(name)), text(_end_of(name), 8, y + 12))
    stop = next((x for column, x, _ in places if column.tick == trace.violated), math.inf)
    before: Run | None = None
    for run in _runs(trace, lane, places):
        if run.value is None:
            yield element("rect", class_="any", x=run.start, y=y, width=run.end - run.start, height=HIGH)
        elif lane.bit:
            rises = before is not None and before.end == run.start and before.value is not None
            level = y if run.value else y + HIGH
            start = 2 * y + HIGH - level if rises else level
            yield element("path", class_="wave", d=f"M{run.start:.1f} {start}V{level}H{run.end:.1f}")
        else:
            yield _word(run, stop, y)
        before = run
    yield from (_break(p.x + p.wide / 2, y) for p in places if p.column.kind != "tick")


def _runs(trace: Trace, lane: Lane, places: list[Place]) -> list[Run]:
    """Nothing is drawn over what is left out."""
    runs: list[Run] = []
    for column, x, wide in places:
        if column.kind == "left out":
            continue
        value = trace.value(lane, column.tick)
        if runs and runs[-1].end == x and runs[-1].value == value:
            runs[-1] = runs[-1]._replace(end=x + wide)
        else:
            runs.append(Run(x, x + wide, value))
    return runs


def _word(run: Run, stop: float, y: int) -> str:
    """A value lane; its text keeps clear of the violation's line at `stop`."""
    start, end, words = run.start, run.end, word(run.value, False)
    tip, half = min(3.0, (end - start) / 2), HIGH / 2
    edge = f"l{tip:.1f} {half}l{-tip:.1f} {half}"
    outline = f"M{start:.1f} {y + half}l{tip:.1f} {-half}H{end - tip:.1f}{edge}H{start + tip:.1f}z"
    lane = element("path", element("title", escape(words)), class_="lane", d=outline)
    if start < stop < end:
        start, end = (start, stop) if stop - start >= end - stop else (stop, end)
    if len(words) * LETTER + 3 > end - start:
        return lane
    return lane + text(words, (start + end) / 2, y + 12, text_anchor="middle")


def _break(x: float, y: int) -> str:
    """Two slanted strokes: here ticks are left out."""
    return element("path", class_="mark", d=f"M{x - 5:.1f} {y + HIGH + 3}l6 {-HIGH - 6}m4 0l-6 {HIGH + 6}")


def _marks(trace: Trace, places: list[Place], bottom: int) -> Iterator[str]:
    for x, wide, tick in ((p.x, p.wide, p.column.tick) for p in places if p.column.kind == "tick"):
        if tick == trace.onset:
            yield element("path", class_="onset", d=f"M{x:.1f} {MARKS}V{bottom}")
            yield text("fault", x + 4, TOP - 8, class_="onsetword")
        if tick == trace.violated:
            yield element("rect", class_="bad", x=x, y=MARKS, width=wide, height=bottom - MARKS)
            yield element("path", class_="badline", d=f"M{x:.1f} {MARKS}V{bottom}")
            yield text("violated", x - 4, TOP - 8, class_="badword", text_anchor="end")


def _end_of(name: str) -> str:
    return name if len(name) <= LETTERS else "…" + name[1 - LETTERS :]


def _told(trace: Trace) -> str:
    parts = [f"{len(trace.lanes)} signals from tick {trace.first} to tick {trace.last}"]
    if trace.onset is not None:
        parts.append(f"first fault at tick {trace.onset}")
    if trace.violated is not None:
        parts.append(f"the claim is violated at tick {trace.violated}")
    return "; ".join(parts) + "."
