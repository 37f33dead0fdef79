"""Run a model on the Python reading and show its signals, a line a step at which something changed.

Inputs are constants (NAME=VALUE) or rows of a CSV file whose head names them; what the file lacks is taken from the
constants.  A fault is KIND@POINT, with :AT for its first step and +TICKS for its length.  Kinds: stuck(0), stuck(1,
bit=3), flip(), frozen, delayed(2), drift(1), clock_stop@PART, bridge(0)@POINT+POINT and more: docs/fault_kinds.md.
"""

from __future__ import annotations

import csv
import fnmatch
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

from safety.commands import INPUT_ERROR, CommandError, options, settings
from safety.commands.evaluate import fitting
from safety.commands.lookup import fault, model_named
from safety.commands.output import probe
from safety.commands.runs import add_signals, chosen_signals, moving, show_run, unchanged
from safety.faults import Faulted, instrument, schedule
from safety.project import open_project
from safety.system import System, nearest
from safety.terms.graph import Sort
from safety.trace import run as run_system
from safety.tracing import trace

EXAMPLES = """
rightside run Channel k=100 v=120 --steps 40
rightside run Channel k=100 --csv speed.csv --show "d,trip"
rightside run Channel k=100 v=120 --steps 40 --fault "stuck(0)@speed:10+5" --vcd run.vcd
rightside run ts7.channel.Channel --set lowering=0 --start acc=17 --steps 8 --json -
"""
DEFAULT_STEPS = 20


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("model", metavar="MODEL", help="its name, or its full name below models/")
    parser.add_argument(
        "inputs",
        nargs="*",
        metavar="NAME=VALUE",
        help="inputs that stay the same; lines.*=0 sets several, the later one wins",
    )
    parser.add_argument("--csv", metavar="FILE", help="inputs, a row a step")
    parser.add_argument(
        "--steps", metavar="N", type=int, help=f"how many (default: all rows of the file, else {DEFAULT_STEPS})"
    )
    parser.add_argument("--fault", metavar="KIND@POINT", action="append", default=[], help="may be repeated")
    parser.add_argument(
        "--start", metavar="NAME=VALUE", action="append", default=[], help="a register that powers up with any value"
    )
    add_signals(parser)
    options.add_settings(parser)
    options.add_json(parser)


def run(args: Namespace) -> int:
    """Carry out the verb."""
    for target in filter(None, (args.vcd, args.json)):
        probe(Path(target))
    project = open_project(Path(args.project) if args.project else None)
    project.load_models()
    model = model_named(project, args.model)
    settings.check(project, [model], dict(args.settings))
    system = trace(model, {**fitting(model, project.config.settings), **dict(args.settings)})
    given = [(name, value) for key, value in map(_pair, args.inputs) for name in _inputs(system, key)]
    fixed = {name: _typed(value, _sort(system, name), name) for name, value in given}
    rows, steps = _rows(args, system, fixed)
    start = {name: _typed(value, _register(system, name), name) for name, value in map(_pair, args.start)}
    faulted = instrument(system, [fault(text) for text in args.fault])
    result = run_system(faulted.system, _with_faults(rows, faulted), steps, start=start)
    paths = chosen_signals(args.show, result, moving(result))
    show_run(args, result, paths)
    if not args.show and (still := unchanged(result, paths)):
        print(f"unchanged: {still}", file=sys.stderr)
    for problem in project.problems:
        print(f"x {problem}", file=sys.stderr)
    return INPUT_ERROR if project.problems else 0


def _rows(args: Namespace, system: System, fixed: Mapping[str, Any]) -> tuple[Callable[[int], Mapping[str, Any]], int]:
    """Inputs by step, and how many steps."""
    table = _csv(Path(args.csv), system) if args.csv else None
    steps = args.steps if args.steps is not None else len(table) if table is not None else DEFAULT_STEPS
    if steps < 1:
        raise CommandError(f"--steps {steps}: run one step or more")
    if table is not None and steps > len(table):
        raise CommandError(f"--steps {steps}: {args.csv} has {len(table)} rows; give more rows or fewer steps")
    there = {*fixed, *(table[0] if table else ())}
    for name, term in system.inputs.items():
        if name not in there:
            raise CommandError(f"{system.name} needs the input {name} ({term.sort}); write {name}=VALUE")
    return (lambda k: {**fixed, **table[k]} if table is not None else fixed), steps


def _csv(path: Path, system: System) -> list[dict[str, Any]]:
    """The rows of a CSV file, typed by the model's inputs."""
    with path.open(encoding="utf-8-sig", newline="") as file:
        reader = csv.DictReader(file)
        sorts = {name: _sort(system, name) for name in reader.fieldnames or ()}
        rows = []
        for row in reader:
            if None in row or None in row.values():
                raise CommandError(f"{path}:{reader.line_num}: this row has not the {len(sorts)} cells of the head")
            rows.append(
                {n: _typed(row[n].strip(), sort, f"{path}:{reader.line_num}: {n}") for n, sort in sorts.items()}
            )
    if not rows:
        raise CommandError(f"{path} has no rows; write a head with input names, then a row a step")
    return rows


def _with_faults(rows: Callable[[int], Mapping[str, Any]], faulted: Faulted) -> Callable[[int], Mapping[str, Any]]:
    choose = schedule(faulted)
    return lambda step: {**rows(step), **choose(step)}


def _pair(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not (name and equals):
        raise CommandError(f"{text!r} is not NAME=VALUE")
    return name, value


def _inputs(system: System, key: str) -> list[str]:
    """The inputs that a name or a pattern means."""
    if "*" not in key:
        return [key]
    found = fnmatch.filter(system.inputs, key)
    if not found:
        raise CommandError(f"{system.name} has no input that fits {key!r}; it has {', '.join(system.inputs)}")
    return found


def _sort(system: System, name: str) -> Sort:
    if name not in system.inputs:
        raise CommandError(f"{system.name} has no input {name!r}; {nearest(name, system.inputs)}")
    return system.inputs[name].sort


def _register(system: System, name: str) -> Sort:
    if name not in system.state:
        raise CommandError(f"{system.name} has no register {name!r}; {nearest(name, system.state)}")
    return system.state[name].var.sort


def _typed(text: str, sort: Sort, where: str) -> Any:
    """A value of a sort; a bit is 0, 1, true or false."""
    words = {"0": False, "1": True, "false": False, "true": True}
    try:
        value: Any = (
            words[text.lower()] if sort.kind == "bit" else Fraction(text) if sort.kind == "real" else int(text, 0)
        )
    except (KeyError, ValueError, ZeroDivisionError):
        value = None
    if not sort.admits(value):
        raise CommandError(f"{where} is {sort}: {text!r} is not a value of it")
    return value
