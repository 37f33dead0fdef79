"""What people see while a command works: a line a result, and on a terminal a line that says what is being done."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Mapping, Sequence
from textwrap import shorten
from typing import Any

from safety.commands.selection import Item
from safety.report.assumed import mark, rests_on_assumed
from safety.report.figures import word
from safety.report.numbers import bracket_text, number, weakest_text
from safety.report.schema import Entry
from safety.report.standing import Standing, standing

Styles = Mapping[int, str]
STYLES: Styles = {0: "green", 3: "yellow", 4: "yellow"}  # else red
_UP_TO = {"bounded": "to", "refuted": "in"}
NAMES = 44  # most characters of an id before the columns shift
REASON = 160  # most characters of a reason


class Screen:
    """stderr.  Colour and the progress line only on a terminal; rich is imported only there."""

    def __init__(self, progress: bool = True) -> None:
        self.live: Any = None
        self.console: Any = None
        self.began = time.monotonic()
        if sys.stderr.isatty() and os.environ.get("TERM") != "dumb":
            from rich.console import Console
            from rich.live import Live

            self.console = Console(stderr=True, highlight=False, soft_wrap=True)
            if progress:
                self.live = Live(console=self.console, auto_refresh=False, transient=True)

    def __enter__(self) -> Screen:
        if self.live:
            self.live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self.live:
            self.live.update("")
            self.live.stop()

    def say(self, text: str, style: str = "") -> None:
        """A line for people."""
        if self.console is None:
            print(text, file=sys.stderr, flush=True)
        else:
            from rich.text import Text

            self.console.print(Text(text, style=style))

    def working(self, done: int, of: int, items: Sequence[Item], notes: Mapping[str, str]) -> None:
        """Update the progress line."""
        if self.live:
            from rich.text import Text

            texts = [f"{item.id} {notes.get(item.id, '')}".rstrip() for item in items]
            line = f"{done} of {of}  {time.monotonic() - self.began:.0f} s  {'; '.join(texts)}"
            self.live.update(Text(line[: max(self.console.width - 1, 20)], style="dim"), refresh=True)

    def result(self, section: str, entry: Entry, width: int) -> None:
        """The line of a result."""
        judged = standing(section, entry)
        self.say(line(section, entry, judged, width), STYLES.get(judged.code, "bold red") if judged.code else "")


def line(section: str, entry: Entry, judged: Standing, width: int) -> str:
    """Mark, verdict, id, what is not as asked, and how it was found: `x BOUNDED  voter.trips  expected proved ...`."""
    word, *told = _TOLD[section](entry)
    mark = "x" if judged.code else " "
    reason = [shorten(judged.reason, REASON, placeholder=" ...")] if judged.code else []  # the summary has all of it
    seconds = entry.get("seconds")
    if isinstance(seconds, Mapping):
        seconds = seconds.get("total")
    took = [f"{seconds:.2f} s"] if isinstance(seconds, int | float) else []
    took += ["cached"] if entry.get("cached") else []
    head = f"{mark} {word.upper():<9} {entry['id']:<{min(width, NAMES)}}"
    return "  ".join([head, *(text for text in (*reason, *told, *took) if text)]).rstrip()


def _claim(entry: Entry) -> list[str]:
    verdict, method = entry["verdict"], entry.get("method") or ""
    steps = (entry.get("strength") or {}).get("steps")
    lemmas = entry.get("user_lemmas") or 0
    agreed = entry.get("agreed_by") or []
    expected = {"refuted": "as it must be", "proved": ""}.get(verdict, "as expected")
    return [
        verdict,
        expected if verdict == entry["expect"] else "",
        bracket_text(entry["bracket"]) if entry.get("bracket") else "",
        f"{_UP_TO[verdict]} {steps} steps" if verdict in _UP_TO and steps is not None else "",
        method,
        f"{lemmas} user lemma{'s' * (lemmas > 1)}" if lemmas and "lemma" not in method else "",
        f"agreed by {', '.join(agreed)}" if agreed else "",
    ]


def _synthesis(entry: Entry) -> list[str]:
    proof = entry.get("proof") or {}
    return [
        "found" if entry["safe_from"] is not None else "open",
        f"{entry['parameter']}: {weakest_text(entry)}",
        f"{proof['user_lemmas']} user lemmas" if proof.get("user_lemmas") else "",
        f"agreed by {', '.join(proof['agreed_by'])}" if proof.get("agreed_by") else "",
    ]


def _campaign(entry: Entry) -> list[str]:
    classes = ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in entry["classes"].items())
    kind = "all" if entry["exhaustive"] else "sample"
    return ["injected", f"{entry['injections']} injections ({kind}): {classes}"]


def _tree(entry: Entry) -> list[str]:
    sets = entry.get("minimal_cut_sets") or {}
    orders = ", ".join(f"{count} of order {order}" for order, count in (sets.get("by_order") or {}).items())
    told = f"{sets.get('count', 0)} cut sets" + (f": {orders}" if orders else "")
    candidates = sum((entry.get("candidate") or {}).values())
    probability = entry.get("probability")
    return [
        "solved", told, entry.get("completeness") or "",
        f"{candidates} candidates" if candidates else "",
        f"probability {number(probability)}{mark(rests_on_assumed('trees', entry))}" if probability is not None else "",
    ]  # fmt: skip


def _rate(entry: Entry) -> list[str]:
    target = f"target {entry['target']}" + (" met" if entry.get("met") else "") if entry.get("target") else ""
    return [
        "found",
        f"{number(entry.get('value'))} {entry.get('unit') or ''}".rstrip() + mark(rests_on_assumed("rates", entry)),
        target,
        entry.get("quantity") or "",
    ]


def _exhibit(entry: Entry) -> list[str]:
    size = f"table of {len(entry['rows'])} rows" if "rows" in entry else "plot" if "marks" in entry else ""
    return ["made", size + mark(rests_on_assumed("exhibits", entry)), entry.get("title") or ""]


def _figure(entry: Entry) -> list[str]:
    recomputed = entry.get("mended") or entry.get("recomputed") or ""
    differs = recomputed and entry["verdict"] not in ("confirmed", "rounding")
    told = f"{entry.get('printed')} for {recomputed}" if differs else entry.get("printed") or ""
    return [word(entry), told + mark(rests_on_assumed("figures", entry))]


_TOLD = {
    "claims": _claim,
    "syntheses": _synthesis,
    "campaigns": _campaign,
    "trees": _tree,
    "rates": _rate,
    "figures": _figure,
    "exhibits": _exhibit,
}
