"""Run the fault-injection campaigns of proofs/ and count what becomes of each fault.

Each campaign states the counts it expects; a differing count is shown as not as asked.
A baseline is what a run found, kept in a file: against it, a new dangerous undetected fault or a lost detection ends
with 1, what became better is told.
With --store, --executor, --shard, --merge or --resume results are kept as they come, in shards: whatever is killed,
--resume makes only what is missing.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from safety.commands import CommandError, options
from safety.commands.output import data, write
from safety.commands.session import Session, work
from safety.commands.table import table
from safety.report.assumed import assumed_mode, mark, rests_on_assumed
from safety.report.numbers import number
from safety.report.schema import Entry

EXAMPLES = """
rightside inject                                 all campaigns
rightside inject -k ring -j 1                    those whose id contains the word, in one process
rightside inject --json out.json                 with every count, also by group of faults
rightside inject --write-baseline baseline.json  accept what is found
rightside inject --baseline baseline.json --sarif out.sarif --junit out.xml
rightside inject --target-coverage 0.9 --target-coverage ring=99/100
rightside inject -k pairs --store shards --shard 2/4
rightside inject -k pairs --store all --merge shards
rightside inject --executor dask://10.0.0.5:8786 --resume
"""
CLASSES = ("safe", "detected", "dangerous_undetected", "no_effect")


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    options.add_selection(parser)
    options.add_work(parser, solvers=False)
    group = parser.add_argument_group("what is asked of a campaign")
    group.add_argument("--baseline", metavar="FILE", help="fail for what is worse than in this file")
    group.add_argument("--write-baseline", metavar="FILE", help="keep what is found, to be compared with later")
    group.add_argument(
        "--target-coverage", metavar="[ID=]SHARE", action="append", default=[], type=_target, dest="targets",
        help="what the lower bound of the diagnostic coverage has to reach: 0.9, 90%%; of one campaign, or of all",
    )  # fmt: skip
    group.add_argument(
        "--shrink", metavar="N", type=_number, default=0,
        help="find the minimal reproducer of the first N dangerous undetected injections, new ones first",
    )  # fmt: skip
    group = parser.add_argument_group("how it is run")
    group.add_argument("--engine", choices=["auto", "native", "lanes"], default="", help="default: as declared")
    group.add_argument("--no-collapse", action="store_true", help="run also faults that come to the same as another")
    group.add_argument("--audit", action="store_true", help="run these too and compare: a difference is an error")
    group.add_argument("--store", metavar="DIR", help="keep results there, in shards (default: .rightside/campaigns)")
    group.add_argument("--resume", action="store_true", help="take what the store has, make only what is missing")
    group.add_argument("--shard", metavar="I/N", help="the I-th of N parts, for one of N machines")
    group.add_argument("--merge", metavar="DIR", action="append", default=[], help="take the shards of another store")
    group.add_argument(
        "--executor", metavar="WHERE", help="processes[:N], serial, or dask://HOST:PORT (needs rightside[cluster])"
    )
    group = parser.add_argument_group("files of results")
    group.add_argument("--sarif", metavar="FILE", help="for code-scanning pages: SARIF 2.1.0")
    group.add_argument("--junit", metavar="FILE", help="for test pages: JUnit XML")
    group.add_argument("--csv", metavar="FILE", help="the tables of failure modes")
    group.add_argument("--xlsx", metavar="FILE", help="the same as a workbook (needs rightside[xlsx])")


def run(args: Namespace) -> int:
    """Carry out the verb."""
    from safety.commands.inject_checks import check, refuse

    refuse(args)
    with ExitStack() as stack:
        session = work(args, "campaigns", check=lambda session: check(session, args, stack))
    entries = session.results.get("campaigns", [])
    if entries:
        _write(args, session)
    rows = [row for entry in entries for row in _rows(entry)]
    if rows and args.json != "-":
        head = [
            "campaign",
            "faults",
            "injections",
            *(name.replace("_", " ") for name in CLASSES),
            "coverage",
            "engine",
            "per second",
            "rate /h",
        ]
        rated = any(row[-1] for row in rows)
        data(table(head, rows) if rated else table(head[:-1], [row[:-1] for row in rows]))
    return session.code


def _target(text: str) -> tuple[str, str]:
    """`0.9`, `90%` or `ring=9/10`: a campaign's id, empty for all, and the exact share."""
    name, _, share = text.rpartition("=")
    return name, str(options.share(share)[0])


def _number(text: str) -> int:
    if not text.isdecimal():
        raise ArgumentTypeError(f"{text!r}: give how many, 0 or more")
    return int(text)


def _write(args: Namespace, session: Session) -> None:
    """Write the files that are asked for, and say which a campaign wrote itself.

    Raises `CommandError` for what cannot be written, when all the others are.
    """
    results, texts = session.results, {}
    if args.sarif:
        from safety.report.sarif import sarif

        texts[args.sarif] = sarif(results)
    if args.junit:
        from safety.report.junit import junit

        texts[args.junit] = junit(results, timings=True)
    if args.write_baseline:
        texts |= _baseline(session, args.write_baseline)
    if args.csv or args.xlsx:
        from safety.commands.injecting import Wishes

        modes = [entry["id"] for entry in results["campaigns"] if entry.get("fmeda")]
        files = [Wishes(**args.injecting).file(kind, name) for kind in ("csv", "xlsx") for name in modes]
        told = ", ".join(str(file) for file in files if file) or "none: these campaigns are not of single faults"
        print(f"failure modes: {told}", file=sys.stderr)
    failed = []
    for file, text in texts.items():
        try:
            write(Path(file), text)
        except OSError as error:
            failed.append(f"{file} cannot be written: {error.strerror}")
    if failed:
        raise CommandError(f"{'; '.join(failed)}; the results are kept, and with --store nothing is injected again")


def _baseline(session: Session, file: str) -> dict[str, str]:
    """The text of the baseline: the records of what ran; of a part, those of the other campaigns stay."""
    from safety.commands.injecting import records
    from safety.inject.baseline_file import dumps

    without = [item.id for item in session.chosen if item.id not in session.records]
    if without or session.project.problems:
        print(f"{file} is not written: {', '.join(without) or 'a file of the project'} has no result", file=sys.stderr)
        return {}
    others = records(file) if session.part and Path(file).exists() else {}
    print(f"baseline of {len(session.records)} campaigns: {file}", file=sys.stderr)
    return {file: dumps({**others, **session.records})}


def _rows(entry: Entry) -> list[list[str]]:
    """The campaign as a whole, then its failure modes."""
    whole = [
        entry["id"],
        "all",
        str(entry["injections"]),
        *_counts(entry["classes"]),
        _share(entry.get("diagnostic_coverage")),
        entry.get("engine") or "",
        _speed(entry),
        _undetected(entry),
    ]
    modes = [
        [
            entry["id"],
            f"{mode['part']} {mode['mode']}".strip(),
            str(mode.get("faults", "")),
            *_counts(mode),
            "",
            "",
            "",
            _rate(mode),
        ]
        for mode in entry.get("fmeda", ())
    ]
    return [whole, *(modes if len(modes) > 1 else [])]


def _speed(entry: Entry) -> str:
    speed = entry.get("injections_per_second")
    return "" if speed is None else number(float(f"{speed:.2g}"))


def _undetected(entry: Entry) -> str:
    """The rate of all that is dangerous and not detected, where rates are given."""
    rate = (entry.get("by_rate") or {}).get("lambda_du")
    return "" if rate is None else f"{number(rate)}{mark(rests_on_assumed('campaigns', entry))} dangerous undetected"


def _rate(mode: Entry) -> str:
    rate = mode.get("rate_per_h")
    return "" if rate is None else number(rate) + mark(assumed_mode(mode))


def _counts(counts: Entry) -> list[str]:
    return [str(counts.get(name, 0)) for name in CLASSES]


def _share(share: Any) -> str:
    if not share:
        return ""
    value = number(share["value"])
    return value if share["low"] == share["high"] else f"{value} ({number(share['low'])} to {number(share['high'])})"
