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
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from safety.commands import CommandError, options
from safety.commands.output import data, probe, write
from safety.commands.session import Session, work
from safety.commands.table import table
from safety.report.assumed import assumed_mode, mark, rests_on_assumed
from safety.report.numbers import number
from safety.report.schema import Entry
from safety.system import nearest

if TYPE_CHECKING:
    from safety.commands.evaluate import Evaluate, Note, Order
    from safety.commands.injecting import Wishes
    from safety.commands.selection import Item
    from safety.project import Project

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
    options.add_work(parser)
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
    _refuse(args)
    with ExitStack() as stack:
        session = work(args, "campaigns", check=lambda session: _check(session, args, stack))
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


# --- what is asked ---------------------------------------------------------------------------------------------------


def _target(text: str) -> tuple[str, str]:
    """`0.9`, `90%` or `ring=9/10`: a campaign's id, empty for all, and the exact share."""
    name, _, share = text.rpartition("=")
    return name, str(options.share(share)[0])


def _number(text: str) -> int:
    if not text.isdecimal():
        raise ArgumentTypeError(f"{text!r}: give how many, 0 or more")
    return int(text)


def _refuse(args: Namespace) -> None:
    """Refuse what cannot be written, or contradicts itself, before hours of work."""
    for target in filter(None, (args.write_baseline, args.sarif, args.junit, args.csv, args.xlsx)):
        probe(Path(target))
    if args.baseline and args.baseline == args.write_baseline:
        raise CommandError(f"--baseline and --write-baseline are both {args.baseline}: compare first, then accept")
    if args.xlsx:
        try:
            import openpyxl  # noqa: F401
        except ImportError:
            raise CommandError("--xlsx: openpyxl is not installed; pip install rightside[xlsx]") from None
    if args.shard and args.write_baseline:
        raise CommandError("--write-baseline with --shard would keep a part; write it where the shards are merged")


def _check(session: Session, args: Namespace, stack: ExitStack) -> Evaluate | None:
    """Refuse targets and baselines that do not fit; what works in this process where results are kept in a store."""
    from safety.commands.evaluate import find
    from safety.commands.injecting import EVERY, Wishes, prepare, records

    wishes = Wishes(
        args.engine, not args.no_collapse, args.audit, dict(args.targets), args.baseline or "",
        bool(args.write_baseline), args.shrink, args.csv or "", args.xlsx or "", args.shard or "",
        several=len(session.chosen) > 1,
    )  # fmt: skip
    args.injecting = wishes.__dict__

    known = [campaign.id for campaign in session.project.campaigns]
    for name in wishes.targets:
        if name != EVERY and name not in known:
            raise CommandError(f"--target-coverage {name}=...: no campaign {name!r}; {nearest(name, known)}")
    if args.write_baseline and Path(args.write_baseline).exists():
        records(args.write_baseline)
    settings = {**session.project.config.settings, **dict(args.settings)}
    kept = _kept(args, session, wishes, settings, stack)
    if wishes.baseline or kept:
        for item in session.chosen:
            prepare(find(session.project.campaigns, item.id), wishes, settings)
    if wishes.baseline and not session.project.problems:
        _fits(session, records(wishes.baseline), wishes.baseline)
    return kept


def _fits(session: Session, there: Mapping[str, Any], file: str) -> None:
    """Refuse a baseline of other campaigns."""
    from safety.commands.evaluate import find
    from safety.inject.baseline import same_campaign

    chosen = [item.id for item in session.chosen]
    new, gone = [name for name in chosen if name not in there], [name for name in there if name not in chosen]
    write = f"`rightside inject --write-baseline {file}` accepts what is found now"
    if new:
        raise CommandError(f"{file} has no campaign {new[0]!r}; it has {', '.join(there) or 'none'}; {write}")
    if gone and not session.part:
        raise CommandError(f"{file} has the campaign {gone[0]!r}, which the project no longer declares; {write}")
    for name in chosen:
        same_campaign(there[name], find(session.project.campaigns, name), file)


def _kept(
    args: Namespace, session: Session, wishes: Wishes, settings: Mapping[str, Any], stack: ExitStack
) -> Evaluate | None:
    if not (args.store or args.resume or args.shard or args.merge or args.executor):
        return None
    from safety.commands.evaluate import Answer, find
    from safety.commands.injecting import injected
    from safety.commands.sharding import Kept
    from safety.inject.store import FOLDER, Part, open_executor

    root = session.project.root
    Part.parse(args.shard or "1/1")
    jobs = args.jobs or session.project.config.jobs or options.cores()
    executor = stack.enter_context(open_executor(args.executor or "processes", workers=jobs))
    kept = Kept(
        Path(args.store) if args.store else root / FOLDER, executor, root, settings, wishes,
        resume=args.resume or bool(args.merge), merge=args.merge, told=lambda text: print(text, file=sys.stderr),
    )  # fmt: skip

    def here(project: Project, item: Item, order: Order, note: Note) -> Answer:
        return Answer(item, injected(find(project.campaigns, item.id), wishes, root, note, kept.run))

    return here


# --- what is shown and written ---------------------------------------------------------------------------------------


def _write(args: Namespace, session: Session) -> None:
    """Write the files that are asked for, and say which a campaign wrote itself."""
    from safety.commands.injecting import Wishes

    results, wishes = session.results, Wishes(**args.injecting)
    if args.sarif:
        from safety.report.sarif import sarif

        write(Path(args.sarif), sarif(results))
    if args.junit:
        from safety.report.junit import junit

        write(Path(args.junit), junit(results, timings=True))
    if args.write_baseline:
        _write_baseline(session, Path(args.write_baseline))
    modes = [entry["id"] for entry in results["campaigns"] if entry.get("fmeda")]
    if (args.csv or args.xlsx) and not modes:
        print("no table of failure modes: it is of campaigns of single faults", file=sys.stderr)
    for kind in ("csv", "xlsx") if modes else ():
        for file in filter(None, (wishes.file(kind, name) for name in modes)):
            print(f"failure modes: {file}", file=sys.stderr)


def _write_baseline(session: Session, file: Path) -> None:
    """Write the records of what ran; of a part, those of the other campaigns stay."""
    from safety.commands.injecting import records
    from safety.inject.baseline import dumps

    without = [item.id for item in session.chosen if item.id not in session.records]
    if without or session.project.problems:
        print(f"{file} is not written: {', '.join(without) or 'a file of the project'} has no result", file=sys.stderr)
        return
    others = records(str(file)) if session.part and file.exists() else {}
    write(file, dumps({**others, **session.records}))
    print(f"baseline of {len(session.records)} campaigns: {file}", file=sys.stderr)


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
