"""Run the fault-injection campaigns of proofs/ and count what becomes of each fault.

Each campaign states the counts it expects; a differing count is shown as not as asked.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from typing import Any

from safety.commands import options
from safety.commands.output import data
from safety.commands.session import work
from safety.commands.table import table
from safety.report.assumed import assumed_mode, mark, rests_on_assumed
from safety.report.numbers import number
from safety.report.schema import Entry

EXAMPLES = """
rightside inject                  all campaigns
rightside inject -k ring -j 1     those whose id contains the word, in one process
rightside inject --json out.json  with every count, also by group of faults
"""
CLASSES = ("safe", "detected", "dangerous_undetected", "no_effect")


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    options.add_selection(parser)
    options.add_work(parser)


def run(args: Namespace) -> int:
    """Carry out the verb."""
    session = work(args, "campaigns")
    rows = [row for entry in session.results.get("campaigns", ()) for row in _rows(entry)]
    if rows and args.json != "-":
        head = [
            "campaign",
            "faults",
            "injections",
            *(name.replace("_", " ") for name in CLASSES),
            "coverage",
            "rate /h",
        ]
        rated = any(row[-1] for row in rows)
        data(table(head, rows) if rated else table(head[:-1], [row[:-1] for row in rows]))
    return session.code


def _rows(entry: Entry) -> list[list[str]]:
    """The campaign as a whole, then its failure modes."""
    whole = [
        entry["id"],
        "all",
        str(entry["injections"]),
        *_counts(entry["classes"]),
        _share(entry.get("diagnostic_coverage")),
        _undetected(entry),
    ]
    modes = [
        [
            entry["id"],
            f"{mode['part']} {mode['mode']}".strip(),
            str(mode.get("faults", "")),
            *_counts(mode),
            "",
            _rate(mode),
        ]
        for mode in entry.get("fmeda", ())
    ]
    return [whole, *(modes if len(modes) > 1 else [])]


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
