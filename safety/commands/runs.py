"""Showing a run of a model: which signals, as a table, as JSON, as a waveform."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from fnmatch import fnmatchcase
from pathlib import Path

from safety.commands import CommandError
from safety.commands.output import data, write, write_plain
from safety.system import nearest
from safety.trace import Trace, show


def add_signals(parser: ArgumentParser) -> None:
    """--show and --vcd."""
    parser.add_argument(
        "--show", metavar="SIGNALS", help="names or patterns, separated by commas (default: all that change)"
    )
    parser.add_argument("--vcd", metavar="FILE", help="write the run as a waveform")


def moving(trace: Trace, first: int = 0, last: int | None = None) -> list[str]:
    """Signals that change between two steps, without what watches and faults keep to themselves; all if none does."""
    end = len(trace) if last is None else last + 1
    paths = [path for path in trace.columns if not path.startswith(("fault", "watch."))]
    return [path for path in paths if any(value != trace[path][first] for value in trace[path][first:end])] or paths


def unchanged(trace: Trace, shown: list[str]) -> str:
    """Signals that are not shown because they never change, with their values."""
    still = [path for path in trace.columns if path not in shown and not path.startswith(("fault", "watch."))]
    return ", ".join(f"{path}={show(trace[path][0])}" for path in still)


def chosen_signals(patterns: str | None, trace: Trace, usual: list[str]) -> list[str]:
    """The signals that --show names, else the usual ones.  Raises CommandError for a pattern that fits none."""
    chosen: list[str] = []
    for pattern in patterns.split(",") if patterns else ():
        hits = [path for path in trace.columns if fnmatchcase(path, pattern.strip())]
        if not hits:
            raise CommandError(
                f"--show {pattern}: {trace.system.name} has no such signal; {nearest(pattern, trace.columns)}"
            )
        chosen += [path for path in hits if path not in chosen]
    return chosen or usual


def show_run(args: Namespace, trace: Trace, paths: list[str], first: int = 0, last: int | None = None) -> None:
    """The table on stdout, or JSON if that is asked for there; a waveform if asked for."""
    if args.vcd:
        write(Path(args.vcd), trace.vcd())
        print(f"waveform: {args.vcd}", file=sys.stderr)
    if args.json:
        write_plain({"schema": "rightside/run/1", "model": trace.system.name, **trace.to_json(paths)}, args.json)
    if args.json != "-":
        data(trace.table(paths, first, last))
