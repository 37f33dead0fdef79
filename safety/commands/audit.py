"""Recompute what papers print: numbers, equations, statements and wordings, each with a verdict that follows.

Verdicts: confirmed, rounding (inputs within their printed precision give it), misprint (one slip of the pen explains
it, and something independent agrees), inconsistent, not derivable, assumed (it hangs on an assumed input).  A misprint
that is found is a finding, not a failure.  Words that a claim decides have no verdict until the claim was run: exit 3.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from safety.commands import CommandError, options
from safety.commands.output import data
from safety.commands.session import Session, work
from safety.commands.table import table
from safety.report.assumed import mark, rests_on_assumed
from safety.report.figures import counted, in_order, published, unjudged, word
from safety.report.schema import Entry

WIDTH = 48  # of a cell; JSON and the report have all of it
EXAMPLES = """
rightside audit                       every figure of every paper, the misprints first
rightside audit -k table2b            those whose id contains the word
rightside audit --paper two_counter   one paper, by the first part of the ids
rightside audit --json -              as JSON, with what the verdicts rest on
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    options.add_selection(parser)
    parser.add_argument("--paper", metavar="ID", help="those of one paper, by the first part of their ids")
    options.add_work(parser)


def run(args: Namespace) -> int:
    """Carry out the verb."""
    if args.settings:
        raise CommandError("--set is for parameters of models, which figures have none of; leave it out")
    session = work(args, "figures", check=lambda each: _of_paper(each, args.paper))
    found = in_order(session.results.get("figures", ()))
    if found and args.json != "-":
        data(table(["figure", "printed", "recomputed", "unit", "verdict", "why"], [_row(entry) for entry in found]))
        printed = published(found)
        others = _counts([each for each in found if not each.get("published", True)])
        for text in (_counts(printed), f"worked out here, not in print: {others}" if others else "", unjudged(found)):
            if text:
                data(text)
    return session.code


def _of_paper(session: Session, paper: str | None) -> None:
    """Leave the figures of one paper.  Raises CommandError for one that there is none of."""
    if paper is None:
        return
    papers = sorted({item.id.partition(".")[0] for item in session.chosen})
    if paper not in papers:
        raise CommandError(
            f"--paper {paper}: no figure of that paper is chosen; there is {', '.join(papers) or 'none'}"
        )
    session.chosen = [item for item in session.chosen if item.id.startswith(f"{paper}.")]


def _counts(found: list[Entry]) -> str:
    return ", ".join(f"{count} {verdict}" for verdict, count in counted(found).items())


def _row(entry: Entry) -> list[str]:
    why = "; ".join(filter(None, (entry.get("slip"), entry.get("note") or "")))
    recomputed = _short(str(entry.get("mended") or entry.get("recomputed") or ""))
    return [
        entry["id"],
        _short(str(entry.get("printed") or "")),
        recomputed + mark(rests_on_assumed("figures", entry)),
        entry.get("unit") or "",
        word(entry),
        why,
    ]


def _short(text: str) -> str:
    return text if len(text) <= WIDTH else text[: WIDTH - 3] + "..."
