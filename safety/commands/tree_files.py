"""Tree files for `rightside tree`: read, solved and asked what the options want; nothing is imported that is not used."""

from __future__ import annotations

import time
from argparse import Namespace
from fractions import Fraction
from math import inf

from safety.commands import CommandError
from safety.commands.output import data, probe
from safety.report.files import dumps, write_text
from safety.trees.formats import LARGEST, read
from safety.trees.solve import Solution, TooLarge, solve
from safety.trees.summary import LISTED, entry_of
from safety.trees.tree import FaultTree, TreeError, exact
from safety.commands.versions import VERSION

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from safety.report.schema import Entry

NOT_AS_ASKED, WEAKER = 1, 4
FEW_GATES = 60  # of a tree in whose picture the importance of gates is shown unasked
QUICKLY_EXACT = 30  # nodes of a diagram that is evaluated in rationals unasked


def solve_files(args: Namespace) -> tuple[list[Entry], int]:
    """The entries for the files, written as JSON where asked; and the exit code."""
    if args.keyword or args.req or args.lf or args.settings:
        raise CommandError("-k, --req, --lf and --set choose among a project's hazards; leave them out with a FILE")
    if args.ties != "refuse" and not all(b"toplevel" in _content(file) for file in args.files):
        raise CommandError("--ties is of dynamic trees in Galileo text; leave it out")
    if args.uncertainty is None and (args.lhs or args.correlation or args.seed is not None):
        raise CommandError("--lhs, --seed and --correlation are of --uncertainty N; add it")
    if args.json:
        probe(args.json)
    entries = _events(args) or _phases(args) or [_dynamic(args) or _static(args)]
    results: dict[str, Any] = {"schema": "rightside/1", "tool": {"rightside": VERSION}}
    for entry in entries:
        results.setdefault("event_trees" if "sequences" in entry else "trees", []).append(entry)
    if args.json == "-":
        data(dumps(results).rstrip("\n"))
    elif args.json:
        write_text(args.json, dumps(results))
    if any(entry.get("wrong") for entry in entries):
        return entries, NOT_AS_ASKED
    return entries, WEAKER if any(entry.get("note") for entry in entries) else 0


def _static(args: Namespace) -> Entry:
    began = time.perf_counter()
    tree = read(*args.files, top=args.top, mission_time_h=args.hours)
    return _solved(args, tree, time.perf_counter() - began)


def _phases(args: Namespace) -> list[Entry]:
    """An entry for each phase of the alignments in the files, if there are any."""
    if not any(b"define-alignment" in _content(file) for file in args.files):
        return []
    from safety.trees.formats import read_study

    study = read_study(*args.files, mission_time_h=args.hours)
    if not study.alignments:
        return []
    for name in ("export", "certificate"):
        if getattr(args, name):
            raise CommandError(f"--{name} is of one tree, and {', '.join(args.files)} holds one for each phase")
    entries = []
    for alignment, phase, tree in study.in_phases(args.top):
        entry = _solved(args, tree, None)
        entry |= {
            "id": f"{entry['id']}, {alignment.name}: {phase.name}",
            "alignment": alignment.name,
            "phase": phase.name,
            "time_fraction": float(phase.fraction),
        }
        entries.append(entry)
    for alignment in study.alignments:
        rows = [entry for entry in entries if entry["alignment"] == alignment.name]
        known = all(row["probability"] is not None for row in rows)
        mean = sum(row["time_fraction"] * row["probability"] for row in rows) if known else None
        for row in rows:
            row["mean_over_phases"] = mean
    return entries


def _solved(args: Namespace, tree: FaultTree, read_s: float | None) -> Entry:
    began = time.perf_counter()
    try:
        solution = solve(tree)
    except TooLarge as why:
        return _enclosed(args, tree, read_s, why)
    entry = entry_of(
        solution, source=", ".join(args.files), read_s=read_s, solve_s=time.perf_counter() - began,
        likeliest=args.likeliest, exact_nodes=inf if args.exact else QUICKLY_EXACT,
    )  # fmt: skip
    entry |= _more(args, tree, solution)
    return entry


def _enclosed(args: Namespace, tree: FaultTree, read_s: float | None, why: TooLarge) -> Entry:
    """The entry of a tree that no diagram fits: certified bounds of its probability."""
    from safety.trees.enclosures import enclose
    from safety.trees.json_form import to_document

    began = time.perf_counter()
    for name, default in _options().items():
        if name not in ("top", "hours", "ties") and getattr(args, name) != default:
            raise TooLarge(f"{why}; --{name} needs the diagram, without it certified bounds are given")
    found = enclose(tree)
    if found is None:
        raise why
    solve_s = time.perf_counter() - began
    return {
        "id": tree.name,
        "description": tree.description,
        "source": ", ".join(args.files),
        "gates": sum(not gate.inside for gate in tree.gates),
        "basic_events": len(tree.events),
        "probability": None,
        "probability_low": found.lower,
        "probability_high": found.upper,
        "minimal_cut_sets": None,
        "importance": [],
        "structure": to_document(tree),
        "note": f"certified bounds: {found.open_modules} modules have no diagram within the budget of nodes",
        "seconds": {"read": read_s, "solve": solve_s, "total": solve_s + (read_s or 0)},
    }


def _more(args: Namespace, tree: FaultTree, solution: Solution) -> Entry:
    """What the options ask for beyond cut sets, probability and importance."""
    found: Entry = {}
    if args.gates or (args.svg and len(tree.gates) <= FEW_GATES and solution.probability is not None):
        from safety.trees.importance_of_gates import importance_of_gates, plain

        found["gate_importance"] = [plain(one) for one in importance_of_gates(tree).values()]
    if args.prime_implicants:
        found["prime_implicants"] = _primes(solution, args.prime_implicants)
    if args.joint:
        found |= _joint(solution)
    if args.uncertainty:
        found["uncertainty"] = _uncertainty(args, solution)
    if args.sensitivity:
        from safety.trees import sensitivity

        found["sensitivity"] = sensitivity.fields(solution)
    if args.target:
        found["targets"] = [_target(solution, text) for text in args.target]
    if args.curve or args.sil:
        found |= _mission(args, tree)
    if args.certificate:
        from pathlib import Path

        from safety.trees import certificate

        certificate.write(solution, Path(args.certificate))
    for path in args.export:
        from safety.trees.formats import write

        write(tree, path)
    return found


def _primes(solution: Solution, listed: int) -> Entry:
    from itertools import islice

    from safety.trees.prime_implicants import PrimeImplicants

    primes = PrimeImplicants(solution)
    return {
        "count": sum(primes.counts()),
        "by_order": {str(order): number for order, number in enumerate(primes.counts()) if number},
        "list": [[{"event": name, "occurs": occurs} for name, occurs in one] for one in islice(primes, listed)],
    }


def _joint(solution: Solution) -> Entry:
    from safety.trees.joint_importance import differential_importance, joint_importance

    pairs = sorted(joint_importance(solution), key=lambda one: -abs(one.joint))
    return {
        "joint_importance": [vars(one) for one in pairs[:LISTED]],
        "joint_importance_not_listed": max(0, len(pairs) - LISTED),
        "differential_importance": [vars(one) for one in differential_importance(solution)],
    }


def _uncertainty(args: Namespace, solution: Solution) -> Entry:
    from safety.trees import uncertainty
    from safety.trees.correlation import read_correlation
    from safety.trees.sampling import Plan

    correlation = read_correlation(args.correlation) if args.correlation else None
    plan = Plan(args.uncertainty, 1 if args.seed is None else args.seed, args.lhs, correlation=correlation)
    found = uncertainty.fields(uncertainty.propagate(solution, plan))
    found["importance"] = uncertainty.importance_fields(uncertainty.propagate_importance(solution, plan))
    return found


def _mission(args: Namespace, tree: FaultTree) -> Entry:
    from safety.trees.mission import Mission

    mission, found = Mission(tree, args.hours), {}
    if args.curve:
        found["curve"] = mission.curve(args.curve).plain()
    if args.sil:
        from safety.trees.averages import averages
        from safety.trees.mean_time import mean_time_to_failure

        found["averages"] = averages(mission).plain()
        try:
            found["mean_time_to_failure_h"] = mean_time_to_failure(tree).plain()
        except TreeError as why:
            found["mean_time_to_failure_h"] = {"why_not": why.message}
    return found


def _target(solution: Solution, text: str) -> Entry:
    from dataclasses import asdict

    from safety.trees.targets import meets

    name, equals, goal = text.rpartition("=")
    if not (equals and name):
        raise CommandError(f"--target {text!r}: give NAME=P, the name of a parameter or event and a probability")
    return asdict(meets(solution, name, goal))


def _dynamic(args: Namespace) -> Entry | None:
    """The entry of a Galileo file with dynamic gates; None for any other."""
    text = _content(args.files[0]) if len(args.files) == 1 else b""
    if b"toplevel" not in text:
        return None
    from safety.trees.galileo import is_galileo, read_galileo

    if not is_galileo(text):
        return None
    began = time.perf_counter()
    tree = read_galileo(text, args.files[0])
    if not tree.dynamic_elements:
        return None
    _refuse(args, "a dynamic tree", "ties")
    from safety.trees.dynamic_summary import dynamic_summary

    hours: Fraction | None = None if args.hours is None else exact(args.hours, "--hours")
    read_s = time.perf_counter() - began
    return dynamic_summary(tree, hours, source=args.files[0], read_s=read_s, ties=args.ties)


def _events(args: Namespace) -> list[Entry]:
    """The entries of the event trees in the files, if there are any."""
    if not any(b"initiating-event" in _content(file) for file in args.files):
        return []
    from safety.trees.event_tree_summary import event_tree_entries
    from safety.trees.formats import read_study

    study = read_study(*args.files, mission_time_h=args.hours)
    if args.top or not study.event_trees:
        return []
    _refuse(args, "event trees")
    return event_tree_entries(study, source=", ".join(args.files))


def _content(path: str) -> bytes:
    """The beginning of a file, nothing where there is none: whoever reads it says what is wrong."""
    try:
        with open(path, "rb") as file:
            return file.read(LARGEST)
    except OSError:
        return b""


def _options() -> dict[str, object]:
    from safety.commands.tree import OF_FILES

    return OF_FILES


def _refuse(args: Namespace, what: str, *taken: str) -> None:
    for name, default in _options().items():
        if name not in ("hours", *taken) and getattr(args, name) != default:
            raise CommandError(f"--{name} is of a static fault tree, and {', '.join(args.files)} holds {what}")
