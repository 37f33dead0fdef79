"""Printed figures in the order in which a reader wants them: what is wrong in print first."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fnmatch import fnmatchcase
from typing import Any

from safety.report.schema import Entry

NOT_JUDGED = "not judged"  # of words whose claim has no verdict to give
VERDICTS = ("misprint", "inconsistent", "assumed", "not derivable", "rounding", "confirmed")
ORDER = (*VERDICTS, None)


def word(figure: Entry) -> str:
    """The verdict, or that there is none."""
    return figure["verdict"] or NOT_JUDGED


def published(figures: Iterable[Entry]) -> list[Entry]:
    """Those that stand in print."""
    return [figure for figure in figures if figure.get("published", True)]


def counted(figures: Iterable[Entry]) -> dict[str, int]:
    """How many figures have each verdict; those without one do not count."""
    verdicts = [figure["verdict"] for figure in figures]
    return {verdict: verdicts.count(verdict) for verdict in VERDICTS if verdict in verdicts}


def unjudged(figures: Iterable[Entry]) -> str:
    """What is to be said of the figures without a verdict; nothing where there are none."""
    left = [figure for figure in figures if figure["verdict"] is None]
    waiting = [figure["claim"] for figure in left if figure.get("waits")]
    if not waiting:
        return f"{len(left)} {NOT_JUDGED}" if left else ""
    others = f"; {len(left) - len(waiting)} {NOT_JUDGED}" if len(waiting) < len(left) else ""
    run = f"prove -k {waiting[0]}" + (", ..." if len(waiting) > 1 else "")
    return f"{len(waiting)} not run: `rightside verify`, or `rightside {run}`{others}"


def in_order(figures: Iterable[Entry]) -> list[Entry]:
    """By verdict, and within one verdict as they came."""
    return sorted(figures, key=lambda figure: ORDER.index(figure["verdict"]))


def by_paper(figures: Iterable[Entry]) -> dict[str, list[Entry]]:
    """The figures of each paper, what is wrong in print first."""
    papers: dict[str, list[Entry]] = {}
    for figure in in_order(figures):
        papers.setdefault(figure.get("paper") or "", []).append(figure)
    return dict(sorted(papers.items()))


def decided(figure: Entry, results: Mapping[str, Any]) -> Entry:
    """An entry with the verdict of the claim that its words stand for, as far as these results have that claim."""
    from safety.audit.entry import by_claim

    claim = next((claim for claim in results.get("claims", ()) if claim["id"] == figure["claim"]), None)
    altered = _altered(claim or {}, results.get("settings") or {})
    judged = by_claim(figure["claim"], claim, altered, figure.get("denies", False)).to_json()
    waits = {"waits": True} if claim is None else {}
    return {name: each for name, each in figure.items() if name not in ("waits", "assumed")} | judged | waits


def _altered(claim: Mapping[str, Any], settings: Mapping[str, Any]) -> list[str]:
    """The settings of this run that are parameters of a claim's model."""
    names = [parameter["name"] for parameter in claim.get("parameters") or ()]
    return [key for key in settings if any(fnmatchcase(name, key) or name.endswith(f".{key}") for name in names)]
