"""What makes a campaign's entry fail beside its declaration: a target that is missed, a baseline that was better."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

from safety.inject.baseline import Comparison
from safety.report.numbers import number
from safety.report.sarif import replay_command
from safety.report.schema import Entry

TOLD = 25  # differences that the entry tells in a line of their own


def aim(entry: Entry, target: Fraction) -> None:
    """Hold the diagnostic coverage against a target: its lower bound, weighted by rates where they are given.

    Where no injection is dangerous there is none to detect: of all injections the target is met; of a sample nothing is
    known of the others, so a target is neither met nor missed.
    """
    by_rate = entry.get("by_rate") or {}
    found: dict[str, Any] | None = by_rate.get("diagnostic_coverage") or entry.get("diagnostic_coverage")
    words = "diagnostic coverage" + (" by rate" if by_rate.get("diagnostic_coverage") else "")
    met: bool | None
    if found is None and (entry["exhaustive"] or not target):
        met, told = True, f"no injection is dangerous, target {number(float(target))} met"
    elif found is None:
        met, told = None, f"no injection drawn is dangerous, target {number(float(target))} undecided: draw more"
    else:
        low = Fraction(found["exact"]) if found.get("exact") else Fraction(found["low"])
        met, least = low >= target, "" if found.get("exact") else " at least"
        told = f"{words}{least} {number(float(low))}, target {number(float(target))} {'met' if met else 'missed'}"
    entry["target_coverage"] = {"target": str(target), "met": met, "told": told}
    if met is False:
        fail(entry, told, [told])


def against(entry: Entry, found: Comparison, file: str) -> None:
    """Enter what is otherwise than in the baseline kept in `file`; what became worse fails."""
    lines = list(_lines(entry["id"], found))
    counts = ", ".join(f"{number(len(of))} {words}" for of, words in _worse(found) if of)
    told = [*lines[:TOLD], *([f"and {len(lines) - TOLD + found.left_out} more"] if len(lines) > TOLD else [])]
    entry["baseline"] = {"file": file, **found.to_json(), "told": told, "better": _better(found)}
    if found.worse:
        fail(entry, f"{counts} against {file}", told)


def fail(entry: Entry, note: str, told: Sequence[str]) -> None:
    """Let an entry fail for reasons that are told, shortly in its note."""
    entry["surprises"] = [*entry.get("surprises", ()), *told]
    entry["note"] = "; ".join(filter(None, [note, entry.get("note", "")]))
    entry["as_expected"] = False


def _worse(found: Comparison) -> list[tuple[dict[str, str], str]]:
    return [
        (found.new, "new dangerous undetected"),
        (found.lost, "lost detection" + "s" * (len(found.lost) > 1)),
        (found.unclear, "with changes the baseline does not list"),
    ]


def _lines(campaign: str, found: Comparison) -> Iterator[str]:
    for injection, was in found.new.items():
        yield f"new dangerous undetected: {injection} (was {was}); {replay_command(f'{campaign}::{injection}')}"
    for injection, now in found.lost.items():
        yield f"lost detection: {injection} (now {now.replace('_', ' ')}); {replay_command(f'{campaign}::{injection}')}"
    for what, injection in found.unclear.items():
        yield f"changed: {what}; {replay_command(f'{campaign}::{injection}')}"


def _better(found: Comparison) -> list[str]:
    """What became better, for people; to keep it, the baseline is written anew."""
    told = [
        f"{number(len(of))} {words}: {', '.join(of[:3])}{', ...' if len(of) > 3 else ''}"
        for of, words in ((found.gone, "no longer dangerous undetected"), (found.gained, "newly detected"))
        if of
    ]
    return told + ([f"{number(found.moved)} detected by others than before"] if found.moved else [])
