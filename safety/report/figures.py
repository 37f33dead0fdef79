"""Printed figures in the order in which a reader wants them: what is wrong in print first."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from safety.report.schema import Entry

ORDER = ("misprint", "inconsistent", "assumed", "not derivable", "rounding", "confirmed")


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

    verdict = next((claim["verdict"] for claim in results.get("claims", ()) if claim["id"] == figure["claim"]), "")
    return {**figure, **by_claim(figure["claim"], verdict).to_json()}
