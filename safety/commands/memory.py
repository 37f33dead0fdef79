"""The last results of a project, in .rightside/last.json: what --lf, replay and report go by.

A run of a part is merged into what is there.  Results of an older text of models/ or proofs/ are marked `outdated`:
good enough to choose what to run first, not good enough for a report.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from safety.commands.selection import Item
from safety.report.results import Results, ResultsError, load, merge, save, write_text
from safety.report.schema import JUDGED, Entry

FOLDER, FILE = ".rightside", "last.json"


def last(root: Path) -> Results:
    """The last results; an empty document when there are none that can be read."""
    try:
        return load(root / FOLDER / FILE)
    except ResultsError:
        return {}


def keep(root: Path, results: Results, whole: Sequence[str]) -> str:
    """Merge results into the last ones, replacing the sections in `whole`; a warning when that is not possible."""
    there = last(root)
    before = {name: value for name, value in there.items() if name not in (*whole, "runs", "limits", "interrupted")}
    if before.get("models") != results.get("models"):
        for section in JUDGED:
            before[section] = [{**entry, "outdated": True} for entry in before.get(section, ())]
    before.pop("models", None)
    merged = merge(before, results)
    if {**merged, "runs": None} == {**there, "runs": None}:  # results of an earlier run, which are there already
        return ""
    try:
        folder = root / FOLDER
        if not (folder / ".gitignore").exists():
            write_text(folder / ".gitignore", "*\n")
        save(merged, folder / FILE)
    except OSError as error:
        return f"the results could not be kept for --lf, replay and report: {folder}: {error.strerror}"
    return ""


def longest_first(root: Path, items: Sequence[Item]) -> list[Item]:
    """The items as they best keep several workers busy to the end: by the time they took, new ones first."""
    results = last(root)
    took = {(section, entry["id"]): _seconds(entry) for section in JUDGED for entry in results.get(section, ())}
    return sorted(items, key=lambda item: -took.get((item.section, item.id), math.inf))


def _seconds(entry: Entry) -> float:
    """What an entry took, to the second: shorter ones stay in the order in which they are declared."""
    seconds = entry.get("seconds")
    if isinstance(seconds, dict):
        seconds = seconds.get("total")
    return float(round(seconds)) if isinstance(seconds, int | float) else 0.0


def outdated(results: Results) -> int:
    """How many results are of an older text than the newest."""
    return sum(bool(entry.get("outdated")) for section in JUDGED for entry in results.get(section, ()))
