"""List what the project declares: claims, syntheses, campaigns, hazards, rates, figures, exhibits, models, points.

The table is on stdout, columns two spaces apart.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

from safety.commands import INPUT_ERROR, CommandError, options
from safety.commands.lookup import model_named
from safety.commands.output import data, probe, write_plain
from safety.commands.selection import Item, items, select
from safety.commands.table import table
from safety.project import Project, open_project
from safety.report.standing import NOTHING
from safety.system import System
from safety.tracing import trace

EXAMPLES = """
rightside list                     everything that has a result
rightside list claims -k ring      claims whose id, model or requirement contains the word
rightside list models              models with clock, and parameters with value, unit, range and source
rightside list points TwoOutOfThree    where faults can act in a model
"""
KINDS = {name: name for name in ("claims", "syntheses", "campaigns", "hazards", "rates", "figures", "exhibits")}
KINDS["hazards"] = "trees"
SINGULAR = {section: name.removesuffix("s") for name, section in KINDS.items()} | {"syntheses": "synthesis"}


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument(
        "what", nargs="?", choices=["all", *KINDS, "models", "points"], default="all", help="default: all"
    )
    parser.add_argument("model", nargs="?", metavar="MODEL", help="with points: the model")
    options.add_selection(parser)
    options.add_json(parser)


def run(args: Namespace) -> int:
    """Carry out the verb."""
    if (args.what == "points") != bool(args.model):
        raise CommandError("write `rightside list points MODEL`; `rightside list models` names them")
    if args.json:
        probe(Path(args.json))
    project = open_project(Path(args.project) if args.project else None)
    project.load_models() if args.what in ("models", "points") else project.load_proofs()
    for problem in project.problems:
        print(f"x {problem}", file=sys.stderr)
    rows = (
        _points(project, args.model)
        if args.model
        else _models(project)
        if args.what == "models"
        else _items(project, args)
    )
    if args.json:
        write_plain({"schema": "rightside/list/1", args.what: rows}, args.json)
    elif rows:
        data(table(list(rows[0]), [[str(cell) for cell in row.values()] for row in rows]))
    if project.problems:
        return INPUT_ERROR
    if not rows:
        print("nothing to list", file=sys.stderr)
    return 0 if rows else NOTHING


def _items(project: Project, args: Namespace) -> list[dict[str, Any]]:
    from safety.commands import memory

    sections = KINDS.values() if args.what == "all" else [KINDS[args.what]]
    chosen = select(items(project, sections), args, memory.last(project.root) if args.lf else {})
    return [_row(item) for item in chosen]


def _row(item: Item) -> dict[str, Any]:
    return {
        "kind": SINGULAR[item.section],
        "id": item.id,
        "model": item.model.rsplit(".", 1)[-1],
        "requirement": item.requirement,
        "expect": item.expect,
        "statement": item.statement,
    }


def _models(project: Project) -> list[dict[str, Any]]:
    """A row for each model, then one for each of its own parameters."""
    rows = []
    for name, model in project.models.items():
        if not hasattr(model, "step"):
            continue
        about = (model.__doc__ or "").strip().partition("\n")[0]
        rows.append({"model": name, "parameter": "", "value": "", "unit": "", "range": "", "source": about})
        for path, each in trace(model).settings.items():
            limits = f"{each.low}..{each.high}"
            row = {"model": name, "parameter": path, "value": each.value, "unit": each.unit, "range": limits}
            rows.append(row | {"source": each.source})
    return rows


def _points(project: Project, name: str) -> list[dict[str, Any]]:
    system: System = trace(model_named(project, name))
    return [{"point": path, "sort": str(term.sort)} for path, term in system.points.items()]
