"""Two small charts: a campaign's classes as one stacked bar, and a value with its interval against a target."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from safety.report.svg import element

CLASSES = (
    ("safe", "safe"),
    ("detected", "detected"),
    ("dangerous_undetected", "dangerous, undetected"),
    ("no_effect", "no effect"),
)
BAR, LINE, HEIGHT = 640, 320, 22  # px
INSET = 12  # px kept free at both ends of a line
THIN = 0.005  # share of the bar that each class has at least: one fault in a million is still seen


def classes_bar(classes: Mapping[str, int], ident: str) -> str:
    """Stacked bar; hatching tells the dangerous class without colour. `ident` is unique in a page."""
    counts = [(name, words, classes[name]) for name, words in CLASSES if classes.get(name)]
    total = sum(count for _, _, count in counts)
    scale = sum(max(THIN, count / total) for _, _, count in counts)
    hatch = element(
        "pattern",
        element("rect", width=7, height=7, class_="c-dangerous_undetected"),
        element("rect", width=2.5, height=7, class_="hatch"),
        id=ident,
        width=7,
        height=7,
        patternUnits="userSpaceOnUse",
        patternTransform="rotate(45)",
    )
    parts = [element("defs", hatch)]
    x = 0.0
    for name, words, count in counts:
        wide = BAR * max(THIN, count / total) / scale
        look = {"fill": f"url(#{ident})"} if name == "dangerous_undetected" else {"class_": f"c-{name}"}
        hint = element("title", f"{words}: {count}")
        parts.append(element("rect", hint, x=x, y=0, width=wide, height=HEIGHT, **look))
        x += wide
    said = ", ".join(f"{words} {count}" for _, words, count in counts)
    return element(
        "svg",
        *parts,
        class_="bar",
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {BAR} {HEIGHT}",
        preserveAspectRatio="none",
        role="img",
        aria_label=said,
    )


def interval_svg(value: Any, low: Any, high: Any, target: Any = None, upper: float | None = None) -> str:
    """Value and interval on a line: from 0 to `upper` where given, else logarithmic around the values."""
    given = {"value": value, "low": low, "high": high, "target": target}
    known = {name: float(number) for name, number in given.items() if _finite(number)}
    if not known or (upper is None and min(known.values()) <= 0):
        return ""
    if upper is None:
        known = {name: math.log10(number) for name, number in known.items()}
    start = 0.0 if upper is not None else min(known.values()) - 0.15
    end = upper if upper is not None else max(known.values()) + 0.15
    at = {
        name: round(INSET + (LINE - 2 * INSET) * (number - start) / (end - start), 1) for name, number in known.items()
    }
    parts = [element("path", class_="rule", d=f"M{INSET} 11H{LINE - INSET}")]
    if "low" in at and "high" in at:
        parts.append(element("path", class_="span", d=f"M{at['low']} 5v12m0-6H{at['high']}m0-6v12"))
    if "target" in at:
        parts.append(element("path", class_="target", d=f"M{at['target']} 1v20"))
    if "value" in at:
        parts.append(element("circle", class_="dot", cx=at["value"], cy=11, r=4))
    return element(
        "svg",
        *parts,
        class_="interval",
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {LINE} {HEIGHT}",
        width=LINE,
        height=HEIGHT,
        aria_hidden="true",
    )


def _finite(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
