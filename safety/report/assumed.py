"""Which figures rest on assumed inputs: they carry the mark [A] wherever they are shown."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

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
    return {name for name, one in _named(tree) if _assumed(one)}


def assumed_set(tree: Entry, events: Iterable[str]) -> bool:
    """Whether the probability of a cut set rests on an assumed event."""
    chosen = frozenset(events)
    return any(name in chosen and _assumed(one) for name, one in _named(tree))


def mark(assumed: bool) -> str:
    """What stands behind a figure: ` [A]` or nothing."""
    return f" {MARK}" if assumed else ""


def _named(tree: Entry) -> Iterator[tuple[str, Entry]]:
    """The basic events of a tree by name: as it was given, and with their figures."""
    yield from ((one["name"], one) for one in (tree.get("structure") or {}).get("basic_events", ()))
    yield from ((one["event"], one) for one in tree.get("importance") or ())


def _assumed(event: Entry) -> bool:
    said = event.get("description") or ""
    return event.get("source") == "A" or (said != "" and "A" in tags_of(said))
