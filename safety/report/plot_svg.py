"""A plot as a picture: curves, points, rules, bands and notes over two axes with ticks, units and a legend.

Each series has a colour, a dash and a marker of its own, so that it is told apart without colour, too.  Colours follow
the page's custom properties where it has them; alone, the picture has its own, light or dark.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any, NamedTuple

from safety.report.assumed import MARK
from safety.report.numbers import number
from safety.report.scales import scale_of
from safety.report.svg import element, text
from safety.report.tree_text import text_width

WIDTH, HEIGHT = 780, 400  # px: of the area between the axes
LEFT, RIGHT, TOP, BELOW = 84, 26, 18, 58  # px around it
TICKS_X, TICKS_Y = 10, 8
MARKED = 24  # points of a curve up to which each has a marker
ROW, SAMPLE = 24, 40  # px: a row of the legend, a sample in it
LINE, LINES = 15, 6  # px from one line of words to the next; lines above and below a marker that are tried
SERIES = ("curve", "points", "rule", "band")  # in the legend, in this order
COLOURS = 10
DASHES = ("", "9 4", "2.5 3.5", "12 4 2.5 4", "5 3", "14 5")
MARKERS = (
    "M-4.2 0a4.2 4.2 0 1 0 8.4 0a4.2 4.2 0 1 0-8.4 0Z",
    "M-3.8-3.8H3.8V3.8H-3.8Z",
    "M0-5L4.8 3.6H-4.8Z",
    "M0-5.2L5.2 0L0 5.2L-5.2 0Z",
    "M0 5L4.8-3.6H-4.8Z",
    "M-4.6-1.5H-1.5V-4.6H1.5V-1.5H4.6V1.5H1.5V4.6H-1.5V1.5H-4.6Z",
)
STYLE = """
.plot { --p-ink: var(--ink, #1b1f24); --p-dim: var(--dim, #57606a); --p-line: var(--line, #d0d7de);
  --p-ground: var(--paper, #ffffff);
  --p0: #0b5c8f; --p1: #b3261e; --p2: #1a6b3c; --p3: #8a5200; --p4: #6a3d9a; --p5: #3d4650;
  --p6: #00777a; --p7: #a3246b; --p8: #5f6b00; --p9: #3f4fc4; }
@media screen and (prefers-color-scheme: dark) { .plot { --p-ink: var(--ink, #e4e8ec); --p-dim: var(--dim, #9ea8b3);
  --p-line: var(--line, #353d47); --p-ground: var(--paper, #14181d);
  --p0: #7ab8e6; --p1: #ff9389; --p2: #7fd09c; --p3: #efb55e; --p4: #c3a3ea; --p5: #b9c2cb;
  --p6: #5cc9cc; --p7: #f08cc0; --p8: #c6d15a; --p9: #9aa6ff; } }
.plot .ground { fill: var(--p-ground); } .plot .frame { fill: none; stroke: var(--p-dim); }
.plot .grid { stroke: var(--p-line); stroke-width: 1; fill: none; }
.plot text { font: 12.5px system-ui, "Segoe UI", "DejaVu Sans", "Noto Sans CJK JP", Arial, sans-serif;
  fill: var(--p-ink); }
.plot .over { paint-order: stroke; stroke: var(--p-ground); stroke-width: 4px; stroke-linejoin: round; }
.plot .curve { fill: none; stroke-width: 2; stroke-linejoin: round; } .plot .rule { fill: none; stroke-width: 1.5; }
.plot .mark { stroke: var(--p-ground); stroke-width: 1; } .plot .band { opacity: .16; }
""" + "".join(f".plot .s{n} {{ stroke: var(--p{n}); }} .plot .f{n} {{ fill: var(--p{n}); }}\n" for n in range(COLOURS))

Entry = Mapping[str, Any]


class _Look(NamedTuple):
    """How the n-th series looks."""

    n: int

    @property
    def stroke(self) -> str:
        return f"s{self.n % COLOURS}"

    @property
    def fill(self) -> str:
        return f"f{self.n % COLOURS}"

    @property
    def dash(self) -> dict[str, str]:
        pattern = DASHES[(self.n + self.n // len(DASHES)) % len(DASHES)]
        return {"stroke_dasharray": pattern} if pattern else {}

    def marker(self, x: float, y: float, *inside: str) -> str:
        shape = MARKERS[(self.n + self.n // len(MARKERS)) % len(MARKERS)]
        return element("path", *inside, class_=f"mark {self.fill}", d=shape, transform=f"translate({x:.1f} {y:.1f})")


def plot_svg(entry: Entry, ident: str) -> str:
    """The picture of a plot under "exhibits" in a results document; `ident` is unique in a page."""
    return _Picture(entry, ident).svg()


class _Picture:
    """The scales of a plot, and what is drawn over them."""

    def __init__(self, entry: Entry, ident: str) -> None:
        self.entry, self.ident = entry, ident
        places = [point for mark in entry["marks"] for point in mark.get("points", ())]
        self.x = scale_of(entry["x"], (p[0] for p in places), LEFT, LEFT + WIDTH)
        self.y = scale_of(entry["y"], (p[1] for p in places), TOP + HEIGHT, TOP)
        series = sorted((SERIES.index(m["kind"]), n) for n, m in enumerate(entry["marks"]) if m["kind"] in SERIES)
        self.looks = {n: _Look(order) for order, (_, n) in enumerate(series)}

    def svg(self) -> str:
        area = {"x": LEFT, "y": TOP, "width": WIDTH, "height": HEIGHT}
        legend, deep = self._legend(TOP + HEIGHT + BELOW)
        height = TOP + HEIGHT + BELOW + deep
        wide = LEFT + WIDTH + RIGHT
        clip = f"{self.ident}-area"
        drawn, written = self._marks()
        return element(
            "svg",
            element("style", STYLE),
            element("defs", element("clipPath", element("rect", **area), id=clip)),
            element("rect", class_="ground", x=0, y=0, width=wide, height=height),
            *self._grid(),
            element("g", *drawn, clip_path=f"url(#{clip})"),
            element("rect", class_="frame", **area),
            *written,
            *self._titles(),
            *legend,
            class_="plot",
            xmlns="http://www.w3.org/2000/svg",
            viewBox=f"0 0 {wide} {height}",
            width=wide,
            height=height,
            role="img",
            aria_label=self._said(),
        )

    # --- axes --------------------------------------------------------------------------------------------------------

    def _grid(self) -> list[str]:
        parts = []
        for value in self.x.ticks(TICKS_X):
            x = self.x.at(value)
            parts.append(element("path", class_="grid", d=f"M{x:.1f} {TOP}v{HEIGHT}"))
            parts.append(text(_tick(value), x, TOP + HEIGHT + 19, text_anchor="middle"))
        for value in self.y.ticks(TICKS_Y):
            y = self.y.at(value)
            parts.append(element("path", class_="grid", d=f"M{LEFT} {y:.1f}h{WIDTH}"))
            parts.append(text(_tick(value), LEFT - 8, y + 4.5, text_anchor="end"))
        return parts

    def _titles(self) -> list[str]:
        across, up = LEFT + WIDTH / 2, TOP + HEIGHT / 2
        turned = f"rotate(-90 18 {up:.1f})"
        return [
            text(_named(self.entry["x"]), across, TOP + HEIGHT + 42, text_anchor="middle"),
            text(_named(self.entry["y"]), 18, up, text_anchor="middle", transform=turned),
        ]

    # --- marks -------------------------------------------------------------------------------------------------------

    def _marks(self) -> tuple[list[str], list[str]]:
        """What is cut off at the axes, bands first; and what lies over it, words last."""
        drawn: dict[str, list[str]] = {"band": [], "rule": [], "curve": []}
        markers: list[str] = []
        words: list[str] = []
        self.taken: list[tuple[float, float, float]] = []
        for n, mark in enumerate(self.entry["marks"]):
            kind = mark["kind"]
            if kind == "note":
                words.append(self._words(mark["text"], *self._place(mark["at"])))
            elif kind in ("band", "rule"):
                drawn[kind].append(self._across(mark, self.looks[n]))
            else:
                if kind == "curve":
                    drawn[kind].append(self._line(mark, self.looks[n]))
                inside = [k for k, point in enumerate(mark["points"]) if self._within(point)]
                markers += [self._marker(mark, k, self.looks[n]) for k in inside if _has_markers(mark)]
                named = [k for k in inside if mark.get("names")]
                words += [self._words(mark["names"][k], *self._place(mark["points"][k]), beside=True) for k in named]
        return [part for parts in drawn.values() for part in parts], markers + words

    def _line(self, mark: Entry, look: _Look) -> str:
        places = [self._place(point) for point in mark["points"]]
        d = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in places)
        return element("path", class_=f"curve {look.stroke}", d=d, **look.dash)

    def _marker(self, mark: Entry, k: int, look: _Look) -> str:
        point = mark["points"][k]
        hint = element("title", escape(f"{mark['label']}: {number(point[0], 6)}, {number(point[1], 6)}"))
        return look.marker(*self._place(point), hint)

    def _across(self, mark: Entry, look: _Look) -> str:
        scale = self.x if mark["axis"] == "x" else self.y
        ends = [min(max(scale.at(value), min(scale[2:4])), max(scale[2:4])) for value in mark["at"]]
        low, high = min(ends), max(ends)
        if mark["kind"] == "rule":
            if not scale.holds(mark["at"][0]):
                return ""
            d = f"M{low:.1f} {TOP}v{HEIGHT}" if mark["axis"] == "x" else f"M{LEFT} {low:.1f}h{WIDTH}"
            return element("path", class_=f"rule {look.stroke}", d=d, **look.dash)
        where: dict[str, float] = (
            {"x": low, "y": TOP, "width": high - low, "height": HEIGHT}
            if mark["axis"] == "x"
            else {"x": LEFT, "y": low, "width": WIDTH, "height": high - low}
        )
        return element("rect", class_=f"band {look.fill}", **where)

    def _words(self, words: str, x: float, y: float, beside: bool = False) -> str:
        """Beside a marker, on the side on which there is room, and clear of words that are there already."""
        off, wide = (9 if beside else 0), text_width(words)
        sides = ((x + off, x + off), (x - off, x - off - wide))
        fits = [side for side in sides if LEFT <= side[1] <= LEFT + WIDTH - wide] or [sides[0]]
        rows = [row for n in range(LINES if beside else 1) for row in (y - off - n * LINE, y + off + 9 + n * LINE)]
        places = [(at, start, row) for row in rows for at, start in fits]
        free = (each for each in places if self._is_free(each[1], wide, each[2]))
        at, start, row = next(free, places[0])
        self.taken.append((start, wide, row))
        return text(words, at, row, class_="over", text_anchor="start" if at == start else "end")

    def _is_free(self, start: float, wide: float, row: float) -> bool:
        """Whether words can stand there."""
        apart = (abs(row - y) >= LINE or start >= x + w or x >= start + wide for x, w, y in self.taken)
        return TOP + LINE <= row <= TOP + HEIGHT and all(apart)

    def _place(self, point: Sequence[float]) -> tuple[float, float]:
        return self.x.at(point[0]), self.y.at(point[1])

    def _within(self, point: Sequence[float]) -> bool:
        return self.x.holds(point[0]) and self.y.holds(point[1])

    # --- legend ------------------------------------------------------------------------------------------------------

    def _legend(self, top: float) -> tuple[list[str], int]:
        """A sample and the name of each series, in rows below the plot; and how high they are."""
        parts, x, y = [], float(LEFT), top + ROW / 2
        for n, look in self.looks.items():
            mark = self.entry["marks"][n]
            words = _cut(mark["label"])
            room = SAMPLE + 8 + text_width(words) * 1.1 + 26
            if x > LEFT and x + room > LEFT + WIDTH + RIGHT:
                x, y = float(LEFT), y + ROW
            parts.append(self._sample(mark, look, x, y))
            hint = element("title", escape(mark["label"])) if words != mark["label"] else ""
            parts.append(element("g", hint, text(words, x + SAMPLE + 8, y + 4.5)))
            x += room
        return parts, round(y - top + ROW / 2 + 6)

    def _sample(self, mark: Entry, look: _Look, x: float, y: float) -> str:
        if mark["kind"] == "band":
            return element("rect", class_=f"band {look.fill}", x=x, y=y - 8, width=SAMPLE, height=16)
        middle = look.marker(x + SAMPLE / 2, y)
        if mark["kind"] == "points":
            return middle
        kind = "rule" if mark["kind"] == "rule" else "curve"
        line = element("path", class_=f"{kind} {look.stroke}", d=f"M{x:.1f} {y:.1f}h{SAMPLE}", **look.dash)
        return line + (middle if kind == "curve" and _has_markers(mark) else "")

    def _said(self) -> str:
        names = ", ".join(self.entry["marks"][n]["label"] for n in self.looks)
        sign = f" {MARK}" if self.entry.get("assumed") else ""
        return f"{self.entry['title']}{sign}. {_named(self.entry['y'])} against {_named(self.entry['x'])}: {names}."


def _has_markers(mark: Entry) -> bool:
    """All points, and those of a curve where there are few; a straight line between two has none."""
    return mark["kind"] == "points" or (mark.get("marked", True) and 2 < len(mark["points"]) <= MARKED)


def _cut(label: str) -> str:
    """A label that fits into a row of the legend."""
    words = label
    while text_width(words) * 1.1 > WIDTH - SAMPLE:
        words = words[: len(words) * 9 // 10 - 1] + "…"
    return words


def _named(axis: Entry) -> str:
    return f"{axis['name']} ({axis['unit']})" if axis["unit"] else str(axis["name"])


def _tick(value: float) -> str:
    return number(value, 6).replace("-", "−")
