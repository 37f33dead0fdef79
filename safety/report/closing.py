"""The single faults of a campaign divided by what settles them: proved harmless, simulated, or only sampled.

The rows come from `safety.closure`; a proof counts when the results say that it succeeded.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from safety.report.schema import Entry

PARTS = ("proved", "simulated", "sampled")


def settled(entry: Entry, results: Mapping[str, Any]) -> Entry:
    """A campaign's entry with its faults divided into parts, by what the claims in these results came to.

    `closure.parts`: faults and rate of each part; `closure.contradictions`: faults proved harmless that were found
    dangerous; `closure.open`: proofs that do not count, each with the reason.
    """
    rows, ties = entry["closure"]["faults"], entry["closure"]["tied"]
    harmless = {id_: _harmless(id_, results) for id_ in ties}
    left = {id_: "not proved in these results" for id_, test in harmless.items() if test is None}
    untied = "no dangerous run of this campaign that was tried breaks it"
    left |= {id_: untied for id_, tie in ties.items() if tie is None}
    parts: dict[str, list[Entry]] = {part: [] for part in PARTS}
    contradictions = []
    for row in rows:
        shown = [id_ for id_, name in row["by"].items() if (test := harmless[id_]) is not None and test(name)]
        proofs = [id_ for id_ in shown if id_ not in left]
        parts["proved" if proofs else "simulated" if entry["exhaustive"] else "sampled"].append(row)
        if shown and row["dangerous"]:
            contradictions.append(f"{row['id']}: harmless by {shown[0]}, dangerous in {entry['id']}")
    told = {
        **entry["closure"],
        "parts": {part: _sums(found, rows) for part, found in parts.items()},
        "contradictions": contradictions,
        "open": [f"{id_}: {why}" for id_, why in sorted(left.items())],
    }
    return {**entry, "closure": told}


def _harmless(id_: str, results: Mapping[str, Any]) -> Callable[[str], bool] | None:
    """Whether a proof shows that its fault of a name alone does no harm; None where there is no such proof."""
    for claim in results.get("claims", ()):
        if claim["id"] == id_ and claim["verdict"] == "proved" and not claim.get("outdated"):
            return lambda name: True
    for tree in results.get("trees", ()):
        if tree["id"] == id_ and tree.get("complete_to_order", -1) >= 1 and not tree.get("outdated"):
            alone = {tuple(cut["faults"]) for cut in tree["cut_sets"]}
            if tree["minimal_cut_sets"]["count"] == len(alone) and () not in alone:
                return lambda name: (name,) not in alone
    return None


def _sums(found: Sequence[Entry], of: Sequence[Entry]) -> Entry:
    """Number and rate of some faults, with their share of all; rates only where every fault has one."""
    told: Entry = {"faults": len(found), "share": len(found) / len(of)}
    if all(row["rate_per_h"] is not None for row in of):
        rate, whole = (sum((Fraction(row["rate_per_h"]) for row in rows), Fraction(0)) for rows in (found, of))
        told |= {"rate_per_h": float(rate), "share_of_rate": float(rate / whole)}
    return told
