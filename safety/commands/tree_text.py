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
LEVELS = (0.05, 0.5, 0.95)  # quantiles of a sequence
SHORT = 60  # characters of a rational shown
LISTED = 20  # cut sets and events in the text; --json has more


def told(entry: Entry) -> str:
    """What an entry of "trees" or "event_trees" says."""
    if "sequences" in entry:
        return _event_tree(entry)
    if "dynamic" in entry:
        return _dynamic(entry)
    lines = [
        f"{entry['id']}  {entry.get('statement') or entry.get('description') or ''}".rstrip(),
        f"{counted(entry['gates'], 'gate')}, {counted(entry['basic_events'], 'basic event')}"
        + _counted(entry["minimal_cut_sets"]),
    ]
    if entry.get("completeness"):
        confirmed, candidate = (sum(entry[name].values()) for name in ("confirmed", "candidate"))
        lines.append(
            f"cut sets {entry['completeness']}; {confirmed} confirmed by a run, {counted(candidate, 'candidate')}"
        )
        if entry.get("minimal_by"):
            lines.append(f"no part of a cut set suffices: {', '.join(entry['minimal_by'])}")
    lines.append(_probability(entry))
    if entry.get("note") and not entry.get("completeness"):
        lines.append(entry["note"])
    if _negates(entry) and entry["minimal_cut_sets"]:
        lines += [
            "cut sets: positive parts of the prime implicants (the tree has not or xor), silent on what must not be;",
            "the probability beside one is that of its events together, and no bound; --prime-implicants N says more",
        ]
    lines += [*_cut_sets(entry), *_important(entry), *_gates(entry)]
    return "\n".join([*lines, *_extras(entry)])


def _extras(entry: Entry) -> list[str]:
    """What options have added."""
    on_assumed = mark(rests_on_assumed("trees", entry))
    return [line for key, say in EXTRAS.items() if key in entry for line in ("", *say(entry[key], on_assumed))]


def _counted(sets: Entry | None) -> str:
    if sets is None:
        return ""
    orders = ", ".join(f"{count} of order {order}" for order, count in sets["by_order"].items())
    found = f"; {counted(sets['count'], 'minimal cut set')}" + _limits(sets.get("limits"))
    return found + (f": {orders}" if orders else "")


def _limits(limits: Entry | None) -> str:
    """Which cut sets a count is of."""
    if limits is None:
        return ""
    order, chance = limits["order"], limits["probability"]
    said = [f"up to order {order}"] * (order is not None) + [f"of probability {chance!r} or more"] * (
        chance is not None
    )
    return " " + " and ".join(said)


def counted(number: int, noun: str) -> str:
    """1 gate, 2 gates."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _negates(entry: Entry) -> bool:
    return any(gate["kind"] in ("not", "xor") for gate in (entry.get("structure") or {}).get("gates", ()))


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
    on_assumed = mark(rests_on_assumed("trees", entry))
    rows = [
        [row["gate"], *(number(row[name]) + on_assumed for name in ("probability", *MEASURES))]
        for row in entry.get("gate_importance", ())[:LISTED]
    ]
    left = _more(len(entry.get("gate_importance", ())) - len(rows), "gates")
    return ["", table(["gate", "probability", "Fussell-Vesely", "Birnbaum"], rows), *left] if rows else []


def _uncertainty(found: Entry, on_assumed: str) -> list[str]:
    lines = [
        f"uncertainty: {found['samples']} samples ({found['method']}, seed {found['seed']}) of "
        f"{counted(len(found['variables']), 'random variable')}",
        f"mean {number(found['mean'])}{on_assumed} (standard error {number(found['standard_error'])}), standard "
        f"deviation {number(found['standard_deviation'])}{on_assumed}, error factor {number(found['error_factor'])}"
        f"{on_assumed}",
        *_out_of_range(found.get("set_to_range", {})),
    ]
    rows = [
        [
            number(row["level"]),
            number(row["value"]) + on_assumed,
            f"{number(row['low'])} to {number(row['high'])}{on_assumed}",
        ]
        for row in found["quantiles"]
    ]
    if found["hypercubes"]:
        return [*lines, table(["quantile", "value"], [row[:2] for row in rows])]  # samples that are not independent
    confidence = found["quantiles"][0]["confidence"]
    return [*lines, table(["quantile", "value", f"with confidence {number(confidence)} or more"], rows)]


def _sensitivity(found: Entry, on_assumed: str) -> list[str]:
    rows = [
        [row["name"], number(row["value"]), *(number(row[name]) + on_assumed for name in ("derivative", "elasticity"))]
        for row in found["derivatives"][:LISTED]
    ]
    return [
        table(["parameter or event", "value", "derivative of the top", "elasticity"], rows),
        *_more(len(found["derivatives"]) - len(rows), "parameters and events"),
    ]


def _targets(found: list[Entry], on_assumed: str) -> list[str]:
    return [line for one in found for line in _target(one, on_assumed)]


def _target(one: Entry, on_assumed: str) -> list[str]:
    proof = "compared in rationals" if one["exact"] else "compared in doubles"
    between = f"between {one['low']!r} and {one['high']!r}{on_assumed} ({proof})"
    if one.get("jump"):
        ends = f"from {number(one['top_low'])} to {number(one['top_high'])}"
        lines = [f"the top jumps over {number(one['target'])}, {ends}, where {one['name']} is {between}"]
    else:
        lines = [f"the top has probability {number(one['target'])} where {one['name']} is {between}"]
    return [*lines, "  other values may do so as well"] if one.get("others_possible") else lines


def _curve(found: Entry, on_assumed: str) -> list[str]:
    frequency = found["frequency_per_h"] or [None] * len(found["times_h"])
    rows = [
        [number(time), number(q) + on_assumed, number(w) + (on_assumed if w is not None else "")]
        for time, q, w in zip(found["times_h"], found["unavailability"], frequency, strict=True)
    ]
    why = [f"no frequency: {found['frequency_unknown']}"] if found["frequency_unknown"] else []
    return [table(["hours", "unavailability", "failures per hour"], rows), *why]


def _averages(found: Entry, on_assumed: str) -> list[str]:
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
            least = f"SIL {level['sil_at_least']} at least" if level["sil_at_least"] else "perhaps no SIL"
            sil = f"at the limit {number(level['limit'])} of two levels: {least}"
        if level.get("why_none"):
            sil = f"no SIL, as {level['why_none']}"
        lines.append(
            f"{words} {number(figure['value'])}{on_assumed} between {figure['low']!r} and {figure['high']!r}: "
            f"{sil}{on_assumed} "
            f"({level['mode']}; {found['method']}{over})"
        )
    return lines


def _mean_time(found: Entry, on_assumed: str) -> list[str]:
    if "why_not" in found:
        return [f"no mean time to failure: {found['why_not']}"]
    exact = f", exactly {found['exact']}" if found.get("exact") else ""
    shares = "; common causes have their shares of the failure rates" if found.get("common_cause") else ""
    return [f"mean time to failure {number(found['value'])} h{on_assumed} ({found['method']}{exact}{shares})"]


def _pairs(found: list[Entry], on_assumed: str) -> list[str]:
    if not found:
        return ["joint importance: there is no pair of events"]
    rows = [[" & ".join(one["events"]), number(one["joint"]) + on_assumed] for one in found[:LISTED]]
    return [table(["pair", "joint importance"], rows), *_more(len(found) - len(rows), "pairs")]


def _primes(found: Entry, on_assumed: str) -> list[str]:
    orders = ", ".join(f"{count} of order {order}" for order, count in found["by_order"].items())
    lines = [f"{counted(found['count'], 'prime implicant')}: {orders}"]
    for one in found["list"][:LISTED]:
        lines.append("  " + (" & ".join(("" if x["occurs"] else "not ") + x["event"] for x in one) or "(always)"))
    return [*lines, *_more(found["count"] - min(LISTED, len(found["list"])), "prime implicants")]


EXTRAS: dict[str, Callable[[Any, str], list[str]]] = {
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
    from safety.trees.dynamic.summary import dynamic_lines

    head = f"{entry['id']}\n{counted(entry['gates'], 'gate')}, {counted(entry['basic_events'], 'basic event')}"
    timed = entry["dynamic"]["mission_time_h"] is not None
    lines = [head, *([_probability(entry)] if timed else ["probability: give --hours H"]), *dynamic_lines(entry)]
    if entry["minimal_cut_sets"]:
        lines += _cut_sets(entry)
    return "\n".join([*lines, *_important(entry), *_extras(entry)])


def _event_tree(entry: Entry) -> str:
    rows = [
        [
            row["id"],
            *(
                number(row[name]) + mark(row[name] is not None and row["assumed"])
                for name in ("probability", "frequency")
            ),
            str(row["minimal_cut_sets"]["count"]),
        ]
        for row in entry["sequences"]
    ]
    on_assumed = mark(entry["total"] is not None and any(row["assumed"] for row in entry["sequences"]))
    whole = {True: "the sequences share out all that can happen", False: "NOT all that can happen, or more", None: ""}
    return "\n".join(
        [
            f"{entry['id']}  event tree {entry['event_tree']}, {counted(len(rows), 'sequence')}",
            f"sum over the sequences {number(entry['total'], 6)}{on_assumed}  {whole[entry['partition']]}".rstrip(),
            *(f"wrong: {one}" for one in entry["wrong"]),
            "",
            table(["sequence", "probability", "frequency", "cut sets"], rows),
            *_spreads(entry["sequences"]),
        ]
    )


def over_all(entries: list[Entry]) -> str:
    """The sequences of all event trees together: their frequencies over all initiating events, where there are some."""
    if len(entries) < 2 or any("sequences" not in entry for entry in entries):
        return ""
    if len({entry.get("alignment") for entry in entries}) > 1:
        return ""
    phases = " and phases" if entries[0].get("alignment") else ""
    key = "frequency_of_all_initiating_events"
    sequences = {one["id"]: one for entry in entries for one in entry["sequences"] if one[key] is not None}
    together = [one | {"assumed": one["assumed_over_all"]} for one in sequences.values()]
    if not together:
        return ""
    rows = [[one["id"], number(one[key]) + mark(one["assumed"])] for one in together]
    return "\n".join(
        [
            f"over all initiating events{phases}",
            "",
            table(["sequence", "frequency"], rows),
            *_spreads(together, f"{key}_uncertainty"),
        ]
    )


def _spreads(sequences: list[Entry], key: str = "") -> list[str]:
    """The uncertainty of the sequences: of their frequencies, where these are known."""
    if not key:
        often = all("frequency_uncertainty" in one for one in sequences)
        key = "frequency_uncertainty" if often else "uncertainty"
    sampled = [one for one in sequences if key in one]
    if not sampled:
        return []
    first = sampled[0][key]
    random = {name for one in sampled for name in one[key]["variables"]}
    what = "frequencies" if key.startswith("frequency") else "probabilities"
    rows, outside = [], dict[str, int]()
    for one in sampled:
        found, sign = one[key], mark(one["assumed"])
        by_level = {row["level"]: row for row in found["quantiles"]}
        cells = [found["mean"], found["standard_deviation"], *(by_level[level]["value"] for level in LEVELS)]
        high = by_level[LEVELS[-1]]
        within = [] if found["hypercubes"] else [f"{number(high['low'])} to {number(high['high'])}{sign}"]
        rows.append([one["id"], *(number(cell) + sign for cell in cells), *within])
        outside |= found["set_to_range"]
    levels = [f"{100 * level:.0f} %" for level in LEVELS]
    head = ["sequence", "mean", "standard deviation", *levels]
    if not first["hypercubes"]:
        head.append(f"{levels[-1]}, with confidence {number(first['quantiles'][-1]['confidence'])} or more")
    return [
        "",
        f"uncertainty of the {what}: {first['samples']} samples ({first['method']}, seed {first['seed']}) of "
        f"{counted(len(random), 'random variable')}",
        *_out_of_range(outside),
        table(head, rows),
    ]


def _out_of_range(outside: dict[str, int]) -> list[str]:
    return [
        f"{name}: {counted(times, 'sample')} out of range, set to the nearer end of the range"
        for name, times in outside.items()
    ]


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
        model = f"  ({share}; mean over the phases {number(entry['mean_over_phases'], 6)}{sign})"
    if value is None:
        return f"probability between {low or 0.0!r} and {1.0 if high is None else high!r}{sign}{model}"
    return f"probability {number(value, 6)}{sign}, enclosed by {low!r} and {high!r}{_rational(entry)}{model}"


def _rational(entry: Entry) -> str:
    exact = entry.get("exact") or ""
    return (
        f", exactly {exact}"
        if 0 < len(exact) <= SHORT
        else f"; exactly in --json ({len(exact)} characters)" * bool(exact)
    )


def _more(left: int, noun: str) -> list[str]:
    return [f"and {left} more {noun}; --json lists them"] if left > 0 else []
