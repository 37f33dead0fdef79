"""What `inject` refuses before anything runs, and who works where its results are kept in a store."""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from safety.commands import CommandError, options
from safety.commands.evaluate import Answer, find
from safety.commands.injecting import EVERY, Wishes, injected, prepare, records
from safety.commands.output import probe
from safety.inject.baseline_file import same_campaign
from safety.system import nearest

if TYPE_CHECKING:
    from safety.commands.evaluate import Evaluate, Note, Order
    from safety.commands.selection import Item
    from safety.commands.session import Session
    from safety.commands.sharding import Kept
    from safety.project import Project

KIND = "rightside/baseline/"  # in every baseline
FILES = ("write_baseline", "sarif", "junit", "csv", "xlsx", "json")  # that are written
WHOLE = ("baseline", "write_baseline", "targets", "sarif", "junit", "csv", "xlsx")  # ask for the whole campaign


def refuse(args: Namespace) -> None:
    """Refuse what cannot be written, or contradicts itself, before hours of work."""
    _refuse_empty(args)
    _refuse_parts(args)
    _refuse_files(args)
    if args.xlsx:
        try:
            import openpyxl  # noqa: F401
        except ImportError:
            raise CommandError("--xlsx: openpyxl is not installed; pip install rightside[xlsx]") from None


def _refuse_empty(args: Namespace) -> None:
    """Refuse an option with nothing behind it, as a shell's unset variable leaves it: it would ask for nothing."""
    for name in (*FILES, "baseline", "store", "shard", "merge", "executor"):
        given = getattr(args, name)
        if given == "" or (name == "merge" and "" in given):
            raise CommandError(f"{_option(name)} is empty; write its value, or leave it out")


def _refuse_parts(args: Namespace) -> None:
    """Refuse what needs the whole campaign where a part of it is made: it would be passed over in silence."""
    asked = [name for name in WHOLE if getattr(args, name)]
    if args.shard and asked:
        raise CommandError(
            f"{_option(asked[0])} needs the whole campaign, --shard {args.shard} makes a part: make all parts without "
            f"it, then put them together with --merge DIR for each, without --shard, and {_option(asked[0])}"
        )


def _refuse_files(args: Namespace) -> None:
    """Refuse files that cannot be written, and one file for two things."""
    known: dict[Path, str] = {Path(args.baseline).resolve(): "baseline"} if args.baseline else {}
    for name in FILES:
        target = getattr(args, name)
        if not target or (name == "json" and target == "-"):
            continue
        if target == "-":
            raise CommandError(f"{_option(name)} -: only --json goes to stdout; give a file (./- for one of this name)")
        path = Path(target)
        probe(path)
        if path.exists() and not path.is_file():  # a device takes any number
            continue
        other = known.setdefault(path.resolve(), name)
        if (other, name) == ("baseline", "write_baseline"):
            raise CommandError(f"--baseline and --write-baseline are both {args.baseline}: compare first, then accept")
        if other != name:
            raise CommandError(f"{_option(other)} and {_option(name)} are both {target}; give each a file of its own")


def _option(name: str) -> str:
    return "--target-coverage" if name == "targets" else f"--{name.replace('_', '-')}"


def check(session: Session, args: Namespace, stack: ExitStack) -> Evaluate | None:
    """Refuse targets, baselines and stores that do not fit; what works here where results are kept in a store."""
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
        if session.part:
            records(args.write_baseline)
        elif KIND not in Path(args.write_baseline).read_text(encoding="utf-8", errors="replace"):
            raise CommandError(f"{args.write_baseline} is there and is no baseline; it is not written over")
    settings = {**session.project.config.settings, **dict(args.settings)}
    kept = _kept(args, session, wishes, settings, stack)
    if wishes.baseline or kept:
        for item in session.chosen:
            prepare(find(session.project.campaigns, item.id), wishes, settings)
    if wishes.baseline:
        _fits(session, records(wishes.baseline), wishes.baseline)
    if kept is None:
        return None
    for item in session.chosen:
        kept.take(find(session.project.campaigns, item.id))
    return _here(kept)


def _fits(session: Session, there: Mapping[str, Any], file: str) -> None:
    """Refuse a baseline of other campaigns."""
    chosen = [item.id for item in session.chosen]
    new, gone = [name for name in chosen if name not in there], [name for name in there if name not in chosen]
    write = f"`rightside inject --write-baseline {file}` accepts what is found now"
    if new:
        raise CommandError(f"{file} has no campaign {new[0]!r}; it has {', '.join(there) or 'none'}; {write}")
    if gone and not (session.part or session.project.problems):
        raise CommandError(f"{file} has the campaign {gone[0]!r}, which the project no longer declares; {write}")
    for name in chosen:
        same_campaign(there[name], find(session.project.campaigns, name), file)


def _kept(
    args: Namespace, session: Session, wishes: Wishes, settings: Mapping[str, Any], stack: ExitStack
) -> Kept | None:
    """Where results are kept; None where they are not."""
    if not (args.store or args.resume or args.shard or args.merge or args.executor):
        return None
    from safety.commands.sharding import Kept
    from safety.inject.store import FOLDER, Part, open_executor

    root = session.project.root
    Part.parse(args.shard or "1/1")
    jobs = args.jobs or session.project.config.jobs or options.cores()
    executor = stack.enter_context(open_executor(args.executor or "processes", workers=jobs))
    return Kept(
        Path(args.store) if args.store else root / FOLDER, executor, root, settings, wishes,
        resume=args.resume or bool(args.merge), merge=args.merge, told=lambda text: print(text, file=sys.stderr),
    )  # fmt: skip


def _here(kept: Kept) -> Evaluate:
    """What works on a campaign whose results are kept."""

    def here(project: Project, item: Item, order: Order, note: Note) -> Answer:
        entry = injected(find(project.campaigns, item.id), kept.wishes, project, note, kept.run)
        if kept.resume:  # some may have been there
            entry["injections_per_second"] = None
        return Answer(item, entry)

    return here
