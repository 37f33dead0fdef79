"""Is each result as asked? One judgement an entry, and the exit code out of all of them.

0 all as asked · 1 refuted, a target missed, or a claim that must fail and does not · 3 undecided ·
4 weaker than asked · 5 nothing selected · 6 engines disagree · 70 internal error.
The worst wins: 70, 6, 1, 3, 4, 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from safety.report.assumed import mark, rests_on_assumed
from safety.report.schema import JUDGED, Entry

AS_ASKED, FAILED, UNDECIDED, WEAKER, NOTHING, DISAGREE, INTERNAL = 0, 1, 3, 4, 5, 6, 70
WORST_FIRST = (INTERNAL, DISAGREE, FAILED, UNDECIDED, WEAKER, AS_ASKED)
WORDS = {
    AS_ASKED: "as asked",
    FAILED: "refuted or target missed",
    UNDECIDED: "undecided",
    WEAKER: "weaker than asked",
    NOTHING: "nothing selected",
    DISAGREE: "engines disagree",
    INTERNAL: "internal error",
}


class Standing(NamedTuple):
    """How one entry stands: its exit code and why."""

    code: int
    reason: str = ""  # empty when as asked


class Judged(NamedTuple):
    """An entry with its section and standing."""

    section: str
    entry: Entry
    standing: Standing


# verdict got, by verdict expected: what is stronger than asked is as asked
_CLAIM: Mapping[str, Mapping[str, int]] = {
    "proved": {"proved": AS_ASKED, "bounded": WEAKER, "vacuous": WEAKER, "refuted": FAILED, "undecided": UNDECIDED},
    "bounded": {"proved": AS_ASKED, "bounded": AS_ASKED, "vacuous": WEAKER, "refuted": FAILED, "undecided": UNDECIDED},
    "vacuous": {"proved": AS_ASKED, "bounded": WEAKER, "vacuous": AS_ASKED, "refuted": FAILED, "undecided": UNDECIDED},
    "refuted": {"proved": FAILED, "bounded": FAILED, "vacuous": FAILED, "refuted": AS_ASKED, "undecided": UNDECIDED},
    "undecided": {"proved": AS_ASKED, "bounded": AS_ASKED, "vacuous": WEAKER, "refuted": FAILED, "undecided": AS_ASKED},
}


def exit_code(results: Mapping[str, Any]) -> int:
    """The worst standing of all entries; 5 when there is none."""
    codes = {judged.standing.code for judged in judge(results)}
    return next(code for code in WORST_FIRST if code in codes) if codes else NOTHING


def judge(results: Mapping[str, Any]) -> Iterator[Judged]:
    """Every entry with its standing, in the order of the document."""
    for section in JUDGED:
        for entry in results.get(section, ()):
            yield Judged(section, entry, standing(section, entry))


def standing(section: str, entry: Entry) -> Standing:
    """How an entry of `section` stands."""
    if entry.get("error"):
        return Standing(INTERNAL, f"internal error: {entry['error']}")
    if section == "claims":
        return _claim(entry)
    if section == "syntheses":
        return _synthesis(entry)
    if section in ("campaigns", "figures") and entry.get("disagreed_by"):
        return Standing(DISAGREE, f"engines disagree: {'; '.join(entry['disagreed_by'])}")
    if entry.get("as_expected") is False and not (entry.get("closure") or {}).get("contradictions"):
        return Standing(FAILED, entry.get("note") or "not as expected")
    return {"campaigns": _campaign, "trees": _tree, "rates": _target, "event_trees": _event_tree}.get(section, _figure)(
        entry
    )


def _claim(entry: Entry) -> Standing:
    verdict, expected = entry["verdict"], entry["expect"]
    trace = entry.get("counterexample")
    if entry.get("disagreed_by"):
        return Standing(DISAGREE, f"{verdict}, but {', '.join(entry['disagreed_by'])} disagree")
    if verdict == "refuted" and trace and not trace["replayed"]:
        return Standing(DISAGREE, "refuted by a trace that does not replay: prover and simulator disagree")
    code = _CLAIM[expected][verdict]
    if code == AS_ASKED and verdict == "refuted" and not trace:
        return Standing(WEAKER, "refuted, but without a trace to replay")
    if code == AS_ASKED:
        return Standing(AS_ASKED)
    if expected == "refuted" and verdict != "undecided":
        return Standing(code, f"must fail, but is {_strength(entry)}")
    return Standing(code, f"{_strength(entry)}, expected {expected}")


def _synthesis(entry: Entry) -> Standing:
    if entry.get("disagreed_by"):
        return Standing(DISAGREE, f"engines disagree: {'; '.join(entry['disagreed_by'])}")
    if entry["safe_from"] is None:
        code = UNDECIDED if entry["refuted_at"] is None else FAILED
        return Standing(code, entry.get("why") or "no value is shown to be safe")
    if not entry["settled"]:
        open_ = "no value is refuted" if entry["refuted_at"] is None else "proved and refuted values lie too far apart"
        return Standing(WEAKER, "; ".join(filter(None, [open_, entry.get("why")])))
    return Standing(AS_ASKED)


def _strength(entry: Entry) -> str:
    steps = (entry.get("strength") or {}).get("steps")
    return f"bounded to {steps} steps" if entry["verdict"] == "bounded" and steps is not None else str(entry["verdict"])


def _campaign(entry: Entry) -> Standing:
    contradictions = (entry.get("closure") or {}).get("contradictions")
    if contradictions:
        return Standing(DISAGREE, f"proof and simulation contradict each other: {'; '.join(contradictions)}")
    target = entry.get("target_coverage") or {}
    if target.get("met", True) is None:
        return Standing(UNDECIDED, target["told"])
    if not entry["injections"] and entry.get("note") and not entry.get("part"):
        return Standing(UNDECIDED, entry["note"])
    if not entry["exhaustive"] and entry.get("expect", {}).get("exhaustive", True):
        return Standing(WEAKER, f"a sample of {entry['injections']} injections, expected all")
    return Standing(AS_ASKED)


def _tree(entry: Entry) -> Standing:
    if (
        entry.get("probability") is None
        and entry.get("probability_high") is None
        and entry.get("probability_low") is not None
    ):
        return Standing(UNDECIDED, entry.get("note") or "the probability has no upper bound")
    return _target(entry)


def _event_tree(entry: Entry) -> Standing:
    return Standing(FAILED, "; ".join(entry["wrong"])) if entry.get("wrong") else Standing(AS_ASKED)


def _target(entry: Entry) -> Standing:
    if entry.get("agree") is False:
        return Standing(DISAGREE, "two independent routes give different values")
    if entry.get("met") is False:
        return Standing(FAILED, f"{_value(entry)}, target {entry.get('target')} missed")
    if entry.get("target") is not None and entry.get("met") is None:
        return Standing(UNDECIDED, f"target {entry['target']}: not known whether met")
    return Standing(AS_ASKED)


def _value(entry: Entry) -> str:
    value = entry.get("value", entry.get("probability"))
    assumed = rests_on_assumed("rates", entry) or rests_on_assumed("trees", entry)
    return f"{'unknown' if value is None else value} {entry.get('unit') or ''}".rstrip() + mark(assumed)


def _figure(entry: Entry) -> Standing:
    if entry.get("waits"):
        return Standing(UNDECIDED, entry.get("note") or "not run")
    return Standing(AS_ASKED)
