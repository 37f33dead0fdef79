"""Which figures rest on assumed inputs: they carry the mark [A] wherever they are shown."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from safety.report.numbers import tags_of

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Any

    Entry = Mapping[str, Any]

MARK = "[A]"


def rests_on_assumed(section: str, entry: Entry) -> bool:
    """Whether the rates or probabilities of an entry of `section` rest on an assumed input."""
    if section == "trees":
        return bool(assumed_events(entry))
    if section == "campaigns":
        return any(assumed_mode(row) for row in entry.get("fmeda", ()))
    return bool(entry.get("assumed")) or "A" in tags_of(entry.get("source") or "")


def assumed_mode(row: Entry) -> bool:
    """Whether the rate of a row of a failure-mode table is assumed."""
    return row.get("rate_per_h") is not None and (row.get("tag") == "A" or "A" in tags_of(row.get("source") or ""))


def assumed_events(tree: Entry) -> set[str]:
    """The basic events whose figures are assumed."""
    events = (tree.get("structure") or {}).get("basic_events", ())
    rows = tree.get("importance") or ()
    return {one["name"] for one in events if _assumed(one)} | {one["event"] for one in rows if _assumed(one)}


def assumed_set(tree: Entry, events: Iterable[str]) -> bool:
    """Whether the probability of a cut set rests on an assumed event."""
    return not assumed_events(tree).isdisjoint(events)


def mark(assumed: bool) -> str:
    """What stands behind a figure: ` [A]` or nothing."""
    return f" {MARK}" if assumed else ""


def _assumed(event: Entry) -> bool:
    return event.get("source") == "A" or "A" in tags_of(event.get("description") or "")
