"""A histogram as a small chart: how long it took until something happened, a bar for each bin."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from safety.report.numbers import number
from safety.report.svg import element, text

WIDTH, HIGH = 420, 64  # px: of the bars
TOP, BELOW, SIDE = 16, 20, 12  # px around them: counts above, the axis below, half a label at the sides
LEAST = 2  # px: a bin with one in a million is still seen
BARS = 48  # at most; more bins are taken together


class Bin(NamedTuple):
    """How many values lie from `low` to `high`, both included."""

    low: int
    high: int
    count: int


def histogram_svg(bins: Sequence[Bin], unit: str, what: str) -> str:
    """The chart, empty without a bin; heights go by count, widths are alike, ends are written below."""
    bins = coarser(bins)
    if not bins:
        return ""
    most = max(one.count for one in bins)
    wide = WIDTH / len(bins)
    parts = []
    for n, one in enumerate(bins):
        tall = max(LEAST, HIGH * one.count / most) if one.count else 0.0
        hint = element("title", f"{_ends(one)} {unit}: {number(one.count)}")
        whole = element("rect", x=SIDE + n * wide, y=TOP, width=wide, height=HIGH, class_="ground")
        bar = element(
            "rect", x=SIDE + n * wide + 0.5, y=TOP + HIGH - tall, width=wide - 1, height=tall, class_="column"
        )
        parts.append(element("g", hint, whole, bar))
    parts.append(element("path", class_="rule", d=f"M{SIDE} {TOP + HIGH}h{WIDTH}"))
    for n in _labelled(len(bins)):
        words, x = _ends(bins[n]), SIDE + (n + 0.5) * wide
        anchor = "start" if n == 0 and len(bins) > 1 else "end" if n and n == len(bins) - 1 else "middle"
        x = SIDE if anchor == "start" else SIDE + WIDTH if anchor == "end" else x
        parts.append(text(words, x, TOP + HIGH + 14, text_anchor=anchor))
    peak = max(range(len(bins)), key=lambda n: bins[n].count)
    at = min(max(SIDE + (peak + 0.5) * wide, SIDE + 14), SIDE + WIDTH - 14)
    parts.append(text(number(most), at, TOP - 4, text_anchor="middle", class_="dim"))
    said = f"{what}: " + ", ".join(f"{_ends(one)} {unit}: {one.count}" for one in bins if one.count)
    return element(
        "svg",
        *parts,
        class_="histogram",
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {WIDTH + 2 * SIDE} {TOP + HIGH + BELOW}",
        width=WIDTH + 2 * SIDE,
        height=TOP + HIGH + BELOW,
        role="img",
        aria_label=said,
    )


def coarser(bins: Sequence[Bin]) -> list[Bin]:
    """Neighbouring bins taken together until there are at most `BARS`."""
    taken = -(-len(bins) // BARS)
    parts = [bins[n : n + taken] for n in range(0, len(bins), taken)] if taken else []
    return [Bin(part[0].low, part[-1].high, sum(one.count for one in part)) for part in parts]


def _ends(one: Bin) -> str:
    return number(one.low) if one.low == one.high else f"{number(one.low)}–{number(one.high)}"


def _labelled(count: int) -> list[int]:
    """The first, the last, and one in the middle where there is room."""
    return sorted({0, count // 2, count - 1} if count > 4 else {0, count - 1})
