"""The uncertainty of a top event as pictures: its sampled distribution, and a tornado of what moves it most.

Both are drawn from the plain fields of a results document. A bar of the tornado is filled towards the upper end of the
quantity and outlined towards the lower one, so that the direction is read without colour.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from safety.report.assumed import mark, rests_on_assumed
from safety.report.numbers import number
from safety.report.plot_svg import plot_svg
from safety.report.svg import element, text
from safety.report.tree_text import text_width

WIDE, ROW, BAR = 420, 24, 14  # px: of the bars' area, from row to row, and of a bar
SIDE, TOP, BELOW = 12, 26, 22  # px around
GAP = 8  # px between words and bars
SHOWN = 15  # bars, the widest first
NAME = 260  # px: of the longest name shown
WHAT = "probability of the top event"
STYLE = """
.tornado text { font: 12px system-ui, "Segoe UI", "DejaVu Sans", "Noto Sans CJK JP", Arial, sans-serif;
  fill: var(--ink, #1b1f24); }
.tornado .up { fill: var(--c-detected, #3f7fb5); } .tornado .rule { stroke: var(--dim, #57606a); fill: none; }
.tornado .down { fill: var(--paper, #ffffff); } .tornado .down, .tornado .up { stroke: var(--c-detected, #3f7fb5); }
"""


def distribution_svg(tree: Mapping[str, Any], ident: str, section: str = "trees", what: str = WHAT) -> str:
    """The histogram of the samples, the mean, and the range from the lowest to the highest quantile given.

    `tree` is an entry of "trees", or a sequence of an entry of another `section`, with "uncertainty" of `what`; `ident`
    is unique in a page.
    """
    found = tree["uncertainty"]
    bins, quantiles = found["histogram"], found["quantiles"]
    assumed = rests_on_assumed(section, tree)
    log = (
        len(bins) > 1
        and bins[0]["low"] > 0
        and not math.isclose(bins[0]["high"] - bins[0]["low"], bins[-1]["high"] - bins[-1]["low"], rel_tol=1e-6)
    )
    outline = [(bins[0]["low"], 0)]
    for each in bins:
        outline += [(each["low"], each["samples"]), (each["high"], each["samples"])]
    outline.append((bins[-1]["high"], 0))
    marks: list[dict[str, Any]] = [
        {"kind": "curve", "label": f"{found['samples']} samples", "points": outline, "marked": False},
        {"kind": "rule", "label": f"mean {number(found['mean'])}{mark(assumed)}", "axis": "x", "at": [found["mean"]]},
    ]
    if len(quantiles) > 1:
        first, last = quantiles[0], quantiles[-1]
        label = f"{_percent(first['level'])} to {_percent(last['level'])}"
        marks.append({"kind": "band", "label": label, "axis": "x", "at": [first["value"], last["value"]]})
    across = {"name": what, "unit": "", "log": log, "low": None, "high": None}
    up = {"name": "samples", "unit": "", "log": False, "low": 0, "high": None}
    title = f"Uncertainty of {tree['id']}"
    return plot_svg({"title": title, "assumed": assumed, "x": across, "y": up, "marks": marks}, ident)


def tornado_svg(tree: Mapping[str, Any]) -> str:
    """One row for each of the SHOWN widest bars, over a common axis with a line at the present probability.

    `tree` is an entry of "trees" with "sensitivity". Empty without bars.
    """
    bars, top, sign = tree["sensitivity"]["tornado"], tree["probability"], mark(rests_on_assumed("trees", tree))
    shown: Sequence[Mapping[str, Any]] = bars[:SHOWN]
    if not shown:
        return ""
    ends = [top, *(each[key] for each in shown for key in ("top_low", "top_high"))]
    low, high = min(ends), max(ends)
    names = [_cut(str(each["name"])) for each in shown]
    left = SIDE + max(map(text_width, names)) + GAP
    room = max(text_width(number(end, 3) + sign) for end in ends) + GAP
    start = left + room

    def at(value: float) -> float:
        return start + WIDE * ((value - low) / (high - low) if high > low else 0.5)

    height = TOP + ROW * len(shown) + BELOW
    parts = [element("style", STYLE)]
    for n, (each, name) in enumerate(zip(shown, names, strict=True)):
        middle = TOP + ROW * (n + 0.5)
        said = " to ".join(
            f"{number(each[q])} gives {number(each[p])}" for q, p in (("low", "top_low"), ("high", "top_high"))
        )
        row = [
            element("title", escape(f"{each['name']}: {said}")),
            text(name, left - GAP, middle + 4, text_anchor="end"),
        ]
        row += [
            element(
                "rect",
                class_=look,
                x=min(at(top), at(each[key])),
                y=middle - BAR / 2,
                width=abs(at(each[key]) - at(top)),
                height=BAR,
            )
            for key, look in (("top_low", "down"), ("top_high", "up"))
        ]
        least, most = sorted((each["top_low"], each["top_high"]))
        row.append(text(number(least, 3) + sign, min(at(least), at(top)) - GAP / 2, middle + 4, text_anchor="end"))
        row.append(text(number(most, 3) + sign, max(at(most), at(top)) + GAP / 2, middle + 4))
        parts.append(element("g", *row))
    parts.append(element("path", class_="rule", d=f"M{at(top):.1f} {TOP - 4}V{height - BELOW + 4}"))
    parts.append(text(number(top) + sign, at(top), TOP - 9, text_anchor="middle"))
    words = "filled: quantity at the upper end of its range; outlined: at the lower end"
    left_out = f"; {len(bars) - len(shown)} narrower bars are not shown" if len(bars) > len(shown) else ""
    parts.append(text(words + left_out, SIDE, height - 6))
    wide = max(start + WIDE + room + SIDE, 2 * SIDE + text_width(words + left_out) * 1.1)
    said = ", ".join(f"{each['name']} {number(each['top_low'])} to {number(each['top_high'])}" for each in shown)
    return element(
        "svg",
        *parts,
        class_="tornado",
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {math.ceil(wide)} {height}",
        width=math.ceil(wide),
        height=height,
        role="img",
        aria_label=f"What moves {tree['id']}{sign}. {said}",
    )


def _percent(level: float) -> str:
    return f"{number(100 * level)} %"


def _cut(name: str) -> str:
    words = name
    while text_width(words) > NAME:
        words = words[: len(words) * 9 // 10 - 1] + "…"
    return words
