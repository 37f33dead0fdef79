"""Work out the rates and mean times that proofs/ states, each by two routes that must agree."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from safety.commands import options
from safety.commands.output import data
from safety.commands.session import work
from safety.commands.table import table
from safety.report.assumed import mark, rests_on_assumed
from safety.report.numbers import number
from safety.report.schema import Entry

EXAMPLES = """
rightside rate                 all statements
rightside rate -k mtbf         those whose id contains the word
rightside rate --json -        as JSON, with exact values as "p/q"
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    options.add_selection(parser)
    options.add_work(parser)


def run(args: Namespace) -> int:
    """Carry out the verb."""
    session = work(args, "rates")
    rows = [_row(entry) for entry in session.results.get("rates", ())]
    if rows and args.json != "-":
        data(table(["rate", "value", "low", "high", "unit", "target", "met", "routes"], rows))
    return session.code


def _row(entry: Entry) -> list[str]:
    met = {True: "yes", False: "NO", None: ""}[entry.get("met")]
    sign = mark(rests_on_assumed("rates", entry))
    values = [number(entry.get(name), 6) + sign for name in ("value", "low", "high")]
    return [
        entry["id"],
        *values,
        entry.get("unit") or "",
        entry.get("target") or "",
        met,
        ", ".join(entry.get("agreed_by", [])),
    ]
