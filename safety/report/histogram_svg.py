"""A histogram as a small chart: how long it took until something happened, a bar for each bin."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from html import escape
from typing import NamedTuple

from safety.report.numbers import number
from safety.report.svg import element, text

WIDTH, HIGH = 420, 64  # px: of the bars
TOP, BELOW, SIDE = 16, 20, 12  # px around them: counts above, the axis below, half a label at the sides
LABEL = 46  # px: from one label below the axis to the next
WIDEST = 60  # px: of one bar
LEAST = 2  # px: a bin with one in a million is still seen


class Bin(NamedTuple):
    """How many values lie from `low` to `high`, both included."""

    low: int
    high: int
    values: int


def bins(counts: Mapping[int, int]) -> list[Bin]:
    """The bins of a histogram that gives, for some of the edges 0, 1, 2, 5, 10, 20, ..., how many lie up to each.

    Those between the first and the last that it gives are there too, without a count.
    """
    found: list[Bin] = []
    before, edges = -1, itertools.chain([0], (d * 10**k for k in itertools.count() for d in (1, 2, 5)))
    while counts and before < max(counts):
        edge = next(edges)
        if found or edge in counts:
            found.append(Bin(before + 1, edge, counts.get(edge, 0)))
        before = edge
    return found


def histogram_svg(found: Sequence[Bin], unit: str, what: str) -> str:
    """The chart, empty without a bin; heights go by count, widths are alike; below stands the last value of a bin."""
    if not found:
        return ""
    most = max(one.values for one in found)
    wide = min(WIDTH / len(found), WIDEST)
    drawn = wide * len(found)
    parts = []
    for n, one in enumerate(found):
        tall = max(LEAST, HIGH * one.values / most) if one.values else 0.0
        hint = element("title", escape(f"{_ends(one)} {unit}: {number(one.values)}"))
        whole = element("rect", x=SIDE + n * wide, y=TOP, width=wide, height=HIGH, class_="ground")
        bar = element(
            "rect", x=SIDE + n * wide + 0.5, y=TOP + HIGH - tall, width=wide - 1, height=tall, class_="column"
        )
        parts.append(element("g", hint, whole, bar))
    parts.append(element("path", class_="rule", d=f"M{SIDE} {TOP + HIGH}h{round(drawn, 1)}"))
    for n in range(0, len(found), math.ceil(LABEL / wide)):
        parts.append(text(number(found[n].high), SIDE + (n + 0.5) * wide, TOP + HIGH + 14, text_anchor="middle"))
    peak = max(range(len(found)), key=lambda n: found[n].values)
    at = min(max(SIDE + (peak + 0.5) * wide, SIDE + 14), SIDE + drawn - 14)
    parts.append(text(number(most), at, TOP - 4, text_anchor="middle", class_="dim"))
    said = f"{what}: " + ", ".join(f"{_ends(one)} {unit}: {one.values}" for one in found if one.values)
    return element(
        "svg",
        *parts,
        class_="histogram",
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {round(drawn + 2 * SIDE)} {TOP + HIGH + BELOW}",
        width=round(drawn + 2 * SIDE),
        height=TOP + HIGH + BELOW,
        role="img",
        aria_label=said,
    )


def _ends(one: Bin) -> str:
    return number(one.low) if one.low == one.high else f"{number(one.low)}–{number(one.high)}"
