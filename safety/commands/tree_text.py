"""A solved fault tree or event tree as text for people."""

from __future__ import annotations

from safety.commands.table import table
from safety.report.assumed import assumed_set, mark, rests_on_assumed
from safety.report.numbers import number

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from safety.report.schema import Entry

MEASURES = ("fussell_vesely", "birnbaum")
LISTED = 20  # cut sets and events in the text; --json has more


def told(entry: Entry) -> str:
    """What an entry of "trees" or "event_trees" says."""
    if "sequences" in entry:
        return _event_tree(entry)
    if "dynamic" in entry:
        return _dynamic(entry)
    lines = [
        f"{entry['id']}  {entry.get('statement') or entry.get('description') or ''}".rstrip(),
        f"{entry['gates']} gates, {entry['basic_events']} basic events{_counted(entry['minimal_cut_sets'])}",
    ]
    if entry.get("completeness"):
        confirmed, candidate = (sum(entry[name].values()) for name in ("confirmed", "candidate"))
        lines.append(f"cut sets {entry['completeness']}; {confirmed} confirmed by a run, {candidate} candidates")
        if entry.get("minimal_by"):
            lines.append(f"no part of a cut set suffices: {', '.join(entry['minimal_by'])}")
    lines.append(_probability(entry))
    if entry.get("note") and not entry.get("completeness"):
        lines.append(entry["note"])
    lines += [*_cut_sets(entry), *_important(entry), *_gates(entry)]
    lines += [line for key, say in EXTRAS.items() if key in entry for line in ("", *say(entry[key]))]
    return "\n".join(lines)


def _counted(sets: Entry | None) -> str:
    if sets is None:
        return ""
    orders = ", ".join(f"{count} of order {order}" for order, count in sets["by_order"].items())
    return f"; {sets['count']} minimal cut sets" + (f": {orders}" if orders else "")


def _cut_sets(entry: Entry) -> list[str]:
    sets = entry["minimal_cut_sets"] or {"count": 0, "sets": []}
    rows = [
        [f"#{n}", " & ".join(one["events"]) or "(no fault needed)", _chance(entry, one), one.get("status", "")]
        for n, one in enumerate(sets["sets"][:LISTED])
    ]
    head = ["cut set", "events", "probability", "status"]
    if not any(row[3] for row in rows):
        head, rows = head[:3], [row[:3] for row in rows]
    return ["", table(head, rows), *_more(sets["count"] - len(rows), "cut sets")] if rows else []


def _important(entry: Entry) -> list[str]:
    on_assumed = mark(rests_on_assumed("trees", entry))
    important = [
        [row["event"], *(number(row.get(name)) + on_assumed for name in MEASURES), _tag(row.get("source"))]
        for row in entry["importance"][:LISTED]
        if row.get("birnbaum") is not None
    ]
    head = ["event", "Fussell-Vesely", "Birnbaum", "source"]
    if not any(row[3] for row in important):
        head, important = head[:3], [row[:3] for row in important]
    left = _more(len(entry["importance"]) - len(important), "events")
    return ["", table(head, important), *left] if important else []


def _gates(entry: Entry) -> list[str]:
    rows = [
        [row["gate"], *(number(row[name]) for name in ("probability", *MEASURES))]
        for row in entry.get("gate_importance", ())[:LISTED]
    ]
    left = _more(len(entry.get("gate_importance", ())) - len(rows), "gates")
    return ["", table(["gate", "probability", "Fussell-Vesely", "Birnbaum"], rows), *left] if rows else []


def _uncertainty(found: Entry) -> list[str]:
    lines = [
        f"uncertainty: {found['samples']} samples ({found['method']}, seed {found['seed']}) of "
        f"{len(found['variables'])} random variables",
        f"mean {number(found['mean'])} (standard error {number(found['standard_error'])}), "
        f"standard deviation {number(found['standard_deviation'])}, error factor {number(found['error_factor'])}",
    ]
    rows = [
        [number(row["level"]), number(row["value"]), f"{number(row['low'])} to {number(row['high'])}"]
        for row in found["quantiles"]
    ]
    if found["hypercubes"]:
        return [*lines, table(["quantile", "value"], [row[:2] for row in rows])]  # samples that are not independent
    confidence = found["quantiles"][0]["confidence"]
    return [*lines, table(["quantile", "value", f"with confidence {number(confidence)} or more"], rows)]


def _sensitivity(found: Entry) -> list[str]:
    rows = [
        [row["name"], number(row["value"]), number(row["derivative"]), number(row["elasticity"])]
        for row in found["derivatives"][:LISTED]
    ]
    return [
        table(["parameter or event", "value", "derivative of the top", "elasticity"], rows),
        *_more(len(found["derivatives"]) - len(rows), "parameters and events"),
    ]


def _targets(found: list[Entry]) -> list[str]:
    proof = {True: "compared in rationals", False: "compared in doubles"}
    return [
        f"the top has probability {number(one['target'])} where {one['name']} is between {one['low']!r} and "
        f"{one['high']!r} ({proof[one['exact']]})"
        for one in found
    ]


def _curve(found: Entry) -> list[str]:
    frequency = found["frequency_per_h"] or [None] * len(found["times_h"])
    rows = [
        [number(time), number(q), number(w)]
        for time, q, w in zip(found["times_h"], found["unavailability"], frequency, strict=True)
    ]
    why = [f"no frequency: {found['frequency_unknown']}"] if found["frequency_unknown"] else []
    return [table(["hours", "unavailability", "failures per hour"], rows), *why]


def _averages(found: Entry) -> list[str]:
    lines, time = [], found["mission_time_h"]
    over = "" if time is None else f", over {number(time)} h"
    for words, figure, level in (
        ("PFDavg", found["pfd_avg"], found["sil_low_demand"]),
        ("PFH, per hour,", found["pfh_per_h"], found["sil_high_demand"]),
    ):
        if figure is None:
            lines.append(f"{words} not known: {found['frequency_unknown']}")
            continue
        sil = f"SIL {level['sil']}" if level["sil"] else "no SIL"
        if level["sil"] is None:
            sil = f"at the limit {number(level['limit'])} of two levels: SIL {level['sil_at_least']} at least"
        lines.append(
            f"{words} {number(figure['value'])} between {figure['low']!r} and {figure['high']!r}: {sil} "
            f"({level['mode']}; {found['method']}{over})"
        )
    return lines


def _mean_time(found: Entry) -> list[str]:
    if "why_not" in found:
        return [f"no mean time to failure: {found['why_not']}"]
    exact = f", exactly {found['exact']}" if found.get("exact") else ""
    return [f"mean time to failure {number(found['value'])} h ({found['method']}{exact})"]


def _pairs(found: list[Entry]) -> list[str]:
    rows = [[" & ".join(one["events"]), number(one["joint"])] for one in found[:LISTED]]
    return [table(["pair", "joint importance"], rows), *_more(len(found) - len(rows), "pairs")]


def _primes(found: Entry) -> list[str]:
    orders = ", ".join(f"{count} of order {order}" for order, count in found["by_order"].items())
    lines = [f"{found['count']} prime implicants: {orders}"]
    for one in found["list"][:LISTED]:
        lines.append("  " + (" & ".join(("" if x["occurs"] else "not ") + x["event"] for x in one) or "(always)"))
    return [*lines, *_more(found["count"] - min(LISTED, len(found["list"])), "prime implicants")]


EXTRAS: dict[str, Callable[[Any], list[str]]] = {
    "prime_implicants": _primes,
    "joint_importance": _pairs,
    "uncertainty": _uncertainty,
    "sensitivity": _sensitivity,
    "targets": _targets,
    "curve": _curve,
    "averages": _averages,
    "mean_time_to_failure_h": _mean_time,
}


def _dynamic(entry: Entry) -> str:
    from safety.trees.dynamic_summary import dynamic_lines

    head = f"{entry['id']}\n{entry['gates']} gates, {entry['basic_events']} basic events"
    timed = entry["dynamic"]["mission_time_h"] is not None
    lines = [head, *([_probability(entry)] if timed else ["probability: give --hours H"]), *dynamic_lines(entry)]
    if entry["minimal_cut_sets"]:
        lines += _cut_sets(entry)
    return "\n".join([*lines, *_important(entry)])


def _event_tree(entry: Entry) -> str:
    rows = [
        [row["id"], number(row["probability"]), number(row["frequency"]), str(row["minimal_cut_sets"]["count"])]
        for row in entry["sequences"]
    ]
    whole = {True: "the sequences share out all that can happen", False: "NOT all that can happen, or more", None: ""}
    return "\n".join(
        [
            f"{entry['id']}  event tree {entry['event_tree']}, {len(rows)} sequences",
            f"sum over the sequences {number(entry['total'], 6)}  {whole[entry['partition']]}".rstrip(),
            *(f"wrong: {one}" for one in entry["wrong"]),
            "",
            table(["sequence", "probability", "frequency", "cut sets"], rows),
        ]
    )


def _chance(entry: Entry, one: Entry) -> str:
    """Probability of a cut set, marked where it rests on an assumed event."""
    known = one["probability"] is not None
    return number(one["probability"]) + mark(known and assumed_set(entry, one["events"]))


def _tag(source: str | None) -> str:
    return f"[{source}]" if source else ""


def _probability(entry: Entry) -> str:
    value, low, high = (entry.get(name) for name in ("probability", "probability_low", "probability_high"))
    if low is None and high is None:
        return "probability unknown: not every event has one"
    sign = mark(rests_on_assumed("trees", entry))
    model = f"  ({entry['chance']}, {entry['hours']} h)" if entry.get("chance") else ""
    if entry.get("mean_over_phases") is not None:
        share = f"{number(entry['time_fraction'])} of the time"
        model = f"  ({share}; mean over the phases {number(entry['mean_over_phases'], 6)})"
    if value is None:
        return f"probability between {low or 0.0!r} and {1.0 if high is None else high!r}{sign}{model}"
    return f"probability {number(value, 6)}{sign}, enclosed by {low!r} and {high!r}{model}"


def _more(left: int, noun: str) -> list[str]:
    return [f"and {left} more {noun}; --json lists them"] if left > 0 else []
