"""Find the cut sets of the hazards of proofs/, draw their fault trees and solve them; or solve tree files.

Without FILE: every hazard, its cut sets straight from the model.  With FILE: Open-PSA MEF XML (trees and data may stand
in several files) or the project's own JSON; no project is needed then.
"""

from __future__ import annotations

import sys
import time
from argparse import ArgumentParser, Namespace
from pathlib import Path

from safety.commands import CommandError, options
from safety.commands.output import data, probe, write, write_json
from safety.commands.table import table
from safety.report.assumed import assumed_set, mark, rests_on_assumed
from safety.report.numbers import number
from safety.report.schema import Entry

EXAMPLES = """
rightside tree                                    all hazards
rightside tree -k no_brake --svg no_brake.svg     one hazard, with its picture
rightside tree permit.xml rates.xml --hours 8760  a tree with its data
rightside tree permit.json --json -               all figures as JSON
"""
MEASURES = ("fussell_vesely", "birnbaum")
LISTED = 20  # cut sets and events in the text; --json has more


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("files", nargs="*", metavar="FILE", help="a fault tree, instead of the project's hazards")
    parser.add_argument("--top", metavar="GATE", help="with FILE: the top gate, where the file leaves it open")
    parser.add_argument("--hours", metavar="H", help="with FILE: mission time of rates without a time of their own")
    parser.add_argument("--svg", metavar="FILE", help="draw the tree (there has to be only one)")
    options.add_selection(parser)
    options.add_work(parser)


def run(args: Namespace) -> int:
    """Carry out the verb."""
    if args.svg:
        probe(Path(args.svg))
    if args.files:
        return _files(args)
    if args.top or args.hours:
        raise CommandError("--top and --hours are for tree files; give a FILE")
    from safety.commands.session import work

    session = work(args, "trees")
    _show(args, session.results.get("trees", []))
    return session.code


def _files(args: Namespace) -> int:
    from safety.commands.versions import versions
    from safety.report.results import empty, exit_code
    from safety.trees import read, summary

    if args.keyword or args.req or args.lf or args.settings:
        raise CommandError("-k, --req, --lf and --set choose among a project's hazards; leave them out with a FILE")
    if args.json:
        probe(Path(args.json))
    began = time.perf_counter()
    tree = read(*args.files, top=args.top, mission_time_h=args.hours)
    entry = summary(tree, source=", ".join(args.files), read_s=time.perf_counter() - began)
    results = empty(**versions()) | {"trees": [entry]}
    _show(args, [entry])
    if args.json:
        write_json(results, args.json)
    return exit_code(results)


def _show(args: Namespace, entries: list[Entry]) -> None:
    if args.json != "-":
        data("\n\n".join(_text(entry) for entry in entries if entry.get("structure")))
    if args.svg:
        _draw(Path(args.svg), entries)


def _draw(path: Path, entries: list[Entry]) -> None:
    from safety.report.tree_svg import tree_svg

    if len(entries) != 1:
        raise CommandError(f"--svg draws one tree, {len(entries)} were found; choose one with -k")
    picture = tree_svg(entries[0])
    if not picture:
        raise CommandError(f"{entries[0]['id']} has no structure to draw")
    write(path, picture)
    print(f"picture of {entries[0]['id']}: {path}", file=sys.stderr)


def _text(entry: Entry) -> str:
    sets = entry["minimal_cut_sets"]
    orders = ", ".join(f"{count} of order {order}" for order, count in sets["by_order"].items())
    lines = [
        f"{entry['id']}  {entry.get('statement') or entry.get('description') or ''}".rstrip(),
        f"{entry['gates']} gates, {entry['basic_events']} basic events; {sets['count']} minimal cut sets"
        + (f": {orders}" if orders else ""),
    ]
    if entry.get("completeness"):
        confirmed, candidate = (sum(entry[name].values()) for name in ("confirmed", "candidate"))
        lines.append(f"cut sets {entry['completeness']}; {confirmed} confirmed by a run, {candidate} candidates")
        if entry.get("minimal_by"):
            lines.append(f"no part of a cut set suffices: {', '.join(entry['minimal_by'])}")
    lines.append(_probability(entry))
    rows = [
        [f"#{n}", " & ".join(one["events"]) or "(no fault needed)", _chance(entry, one), one.get("status", "")]
        for n, one in enumerate(sets["sets"][:LISTED])
    ]
    if rows:
        lines += [
            "",
            table(["cut set", "events", "probability", "status"], rows),
            *_more(sets["count"] - len(rows), "cut sets"),
        ]
    on_assumed = mark(rests_on_assumed("trees", entry))
    important = [
        [row["event"], *(number(row.get(name)) + on_assumed for name in MEASURES), _tag(row.get("source"))]
        for row in entry["importance"][:LISTED]
        if row.get("birnbaum") is not None
    ]
    if important:
        lines += ["", table(["event", "Fussell-Vesely", "Birnbaum", "source"], important)]
        lines += _more(len(entry["importance"]) - len(important), "events")
    return "\n".join(lines)


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
    if value is None:
        return f"probability between {number(low)} and {number(high if high is not None else 1.0)}{sign}{model}"
    return f"probability {number(value, 6)}{sign}, enclosed by {low!r} and {high!r}{model}"


def _more(left: int, noun: str) -> list[str]:
    return [f"and {left} more {noun}; --json lists them"] if left > 0 else []
