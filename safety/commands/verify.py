"""Do everything that proofs/ asks for, then write the report: claims, syntheses, campaigns, trees, rates and so on.

The report folder is written when the whole project was worked through; a part of it makes a report only with --to.
The last line on stdout is the report's path.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path

from safety.commands import options
from safety.commands.output import data, probe
from safety.commands.session import Session, work

EXAMPLES = """
rightside verify                      everything; the report goes to reports/
rightside verify --to build/report    the report goes elsewhere, the committed one stays as it is
rightside verify --json results.json  all results as one JSON document
rightside verify -k ring --to ring    a part, with a report of its own
"""
SECTIONS = ("claims", "syntheses", "campaigns", "trees", "rates", "figures", "exhibits")


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    options.add_selection(parser)
    options.add_work(parser)
    options.add_cache(parser)
    parser.add_argument("--to", metavar="DIR", help="folder of the report (default: reports/, or as configured)")


def run(args: Namespace) -> int:
    """Carry out the verb."""
    if args.to:
        probe(Path(args.to, "index.html"))
    session = work(args, *SECTIONS, whole=True)
    if not session.results.keys() & set(SECTIONS):
        return session.code
    why = _why_not(session)
    if why:
        print(f"no report: {why}", file=sys.stderr)
        return session.code
    from safety.report.folder import write

    folder = Path(args.to) if args.to else session.project.root / session.project.config.report
    write(session.results, folder)
    if args.json == "-":
        print(folder / "index.html", file=sys.stderr)
    else:
        data(str(folder / "index.html"))
    return session.code


def _why_not(session: Session) -> str:
    if session.interrupted:
        return "interrupted; run it again"
    if session.project.problems:
        return "a file of the project could not be used; mend it and run again"
    if session.part and not session.args.to:
        return "only a part was asked for; give --to DIR to report it"
    return ""
