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
    dangerous; `closure.open`: proofs that are not in the results, or did not succeed.
    """
    rows = entry["closure"]["faults"]
    harmless = {id_: _harmless(id_, results) for row in rows for id_ in row["by"]}
    parts: dict[str, list[Entry]] = {part: [] for part in PARTS}
    contradictions = []
    for row in rows:
        proofs = [id_ for id_, name in row["by"].items() if (test := harmless[id_]) is not None and test(name)]
        part = "proved" if proofs else "simulated" if entry["exhaustive"] else "sampled"
        parts[part].append(row)
        if proofs and row["dangerous"]:
            contradictions.append(f"{row['id']}: harmless by {proofs[0]}, dangerous in {entry['id']}")
    told = {
        "faults": rows,
        "parts": {part: _sums(found, rows) for part, found in parts.items()},
        "contradictions": contradictions,
        "open": sorted(id_ for id_, test in harmless.items() if test is None),
    }
    return {**entry, "closure": told}


def _harmless(id_: str, results: Mapping[str, Any]) -> Callable[[str], bool] | None:
    """Whether a proof shows that its fault of a name alone does no harm; None where there is no such proof."""
    for claim in results.get("claims", ()):
        if claim["id"] == id_ and claim["verdict"] == "proved":
            return lambda name: True
    for tree in results.get("trees", ()):
        if tree["id"] == id_ and tree.get("complete_to_order", -1) >= 1:
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
