"""What the options of `rightside tree FILE` ask for beyond cut sets, probability and importance.

Where one of them fails, the others and what was found before are kept: it is said and listed among the "errors".
"""

from __future__ import annotations

import sys
from argparse import Namespace

from safety.commands import CommandError
from safety.commands.tree_text import counted
from safety.trees.as_written import TreeError, exact
from safety.trees.solve import Solution
from safety.trees.summary import LISTED
from safety.trees.tree import FaultTree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from fractions import Fraction

    from safety.report.schema import Entry
    from safety.trees.dynamic.data import Data
    from safety.trees.dynamic.solve import DynamicSolution
    from safety.trees.event_trees.summary import Answered
    from safety.trees.study import Study
    from safety.trees.uncertainty.sampling import Plan

FEW_GATES = 60  # of a tree in whose picture the importance of gates is shown unasked
NEED_PROBABILITIES = ("likeliest", "gates", "joint", "sensitivity")
UNMARKED = (".dft", ".dag", ".txt")  # formats that hold no source tags


def extend(entry: Entry, args: Namespace, solution: Solution) -> list[str]:
    """Add to the entry of a solved tree; the errors."""
    errors = []
    for option, extra in _asked(args, solution):
        if solution.probability is None and option in NEED_PROBABILITIES:
            extra = _refusal(solution.tree)
        errors += _tried(f"--{option}", entry, extra)
    return errors


def extend_dynamic(entry: Entry, args: Namespace, solution: DynamicSolution, data: Data) -> list[str]:
    """Add to the entry of a dynamic tree; the errors."""

    def sampled() -> Entry:
        from safety.trees.dynamic.uncertainty import propagate
        from safety.trees.uncertainty.propagation import fields

        if args.hours is None:
            raise TreeError("is of the probability by a time; give it by --hours H")
        if data.is_certain:
            raise TreeError(
                "Galileo text holds plain numbers only; give the distributions of its basic events in an Open-PSA MEF "
                "file as well"
            )
        return {"uncertainty": fields(propagate(solution, data, exact(args.hours, "--hours"), _plan(args)))}

    def curve() -> Entry:
        if args.hours is None:
            raise TreeError("needs the time up to which it goes; give it by --hours H")
        times = [exact(args.hours, "--hours") * n / args.curve for n in range(args.curve + 1)]
        chances = [float(one.middle) for one in solution.probabilities(times)]
        return {
            "curve": {
                "times_h": [float(time) for time in times],
                "unavailability": chances,
                "frequency_per_h": None,
                "intensity_per_h": None,
                "frequency_unknown": "it is not computed for dynamic trees",
            }
        }

    asked = [("--uncertainty", sampled)] * bool(args.uncertainty) + [("--curve", curve)] * bool(args.curve)
    return [error for option, extra in asked for error in _tried(option, entry, extra)]


def extend_sequences(
    entries: list[Entry], args: Namespace, answers: list[Answered], mission_time_h: Fraction | None
) -> list[str]:
    """Add the uncertainty of every sequence to the entries of event trees; the errors."""

    def sampled() -> Entry:
        from safety.trees.event_trees.summary import add_uncertainty

        add_uncertainty(entries, answers, _plan(args), mission_time_h)
        return {}

    return _tried("--uncertainty", {}, sampled)


def _asked(args: Namespace, solution: Solution) -> list[tuple[str, Callable[[], Entry]]]:
    """What the options ask for beyond cut sets, probability and importance: the option, and what adds to the entry."""
    tree, known = solution.tree, solution.probability is not None
    drawn = args.svg and len(tree.gates) <= FEW_GATES and known
    listed: list[Entry] = []
    every: list[tuple[object, str, Callable[[], Entry]]] = [
        (args.likeliest, "likeliest", dict),
        (args.gates or drawn, "gates", lambda: _gates(tree)),
        (args.prime_implicants, "prime-implicants", lambda: _primes(solution, args.prime_implicants)),
        (args.joint, "joint", lambda: _joint(solution)),
        (args.uncertainty, "uncertainty", lambda: _uncertainty(args, solution)),
        (args.sensitivity, "sensitivity", lambda: _sensitivity(solution)),
        *((True, "target", lambda text=text: _target(solution, text, listed)) for text in args.target),
        (args.curve, "curve", lambda: _curve(args, tree)),
        (args.sil, "sil", lambda: _averages(args, tree)),
        (args.certificate, "certificate", lambda: _certificate(args, solution)),
    ]
    return [(option, extra) for asked, option, extra in every if asked]


def _tried(what: str, entry: Entry, extra: Callable[[], Entry]) -> list[str]:
    """Add to the entry; what speaks against it is said and given back, and what there is already is kept."""
    try:
        entry |= extra()
    except Exception as error:
        if getattr(error, "exit_code", None) not in (2, 3) and not isinstance(error, OSError):
            raise
        print(f"rightside tree: {what}: {error}", file=sys.stderr)
        return [f"{what}: {error}"]
    return []


def _refusal(tree: FaultTree) -> Callable[[], Entry]:
    """Say which probability is missing."""
    missing = [event.name for event in tree.events if event.chance is None]
    others = f", nor have {len(missing) - 1} more" if len(missing) > 1 else ""

    def refuse() -> Entry:
        raise TreeError(f'needs the probability of every basic event; "{missing[0]}" has none{others}: give it one')

    return refuse


def export(paths: list[str], tree: FaultTree | Study) -> list[str]:
    """Write the tree in other formats, for which it need not be solved; the errors."""
    from safety.trees.formats.files import write

    assumed, errors = sum(event.source == "A" for event in tree.events), []
    for path in paths:

        def written(path: str = path) -> Entry:
            write(tree, path)
            return {}

        failed = _tried(f"--export {path}", {}, written)
        errors += failed
        if assumed and path.lower().endswith(UNMARKED) and not failed:
            print(f"{path}: this format cannot hold the mark [A] of {counted(assumed, 'event')}", file=sys.stderr)
    return errors


def _gates(tree: FaultTree) -> Entry:
    from safety.trees.importance.events import plain
    from safety.trees.importance.gates import importance_of_gates

    return {"gate_importance": [plain(one) for one in importance_of_gates(tree).values()]}


def _sensitivity(solution: Solution) -> Entry:
    from safety.trees.uncertainty import sensitivity

    return {"sensitivity": sensitivity.fields(solution)}


def _certificate(args: Namespace, solution: Solution) -> Entry:
    from pathlib import Path

    from safety.trees import certificate

    certificate.write(solution, Path(args.certificate))
    return {}


def _primes(solution: Solution, listed: int) -> Entry:
    from itertools import islice

    from safety.trees.cut_sets.prime_implicants import PrimeImplicants

    primes = PrimeImplicants(solution)
    return {
        "prime_implicants": {
            "count": sum(primes.counts()),
            "by_order": {str(order): number for order, number in enumerate(primes.counts()) if number},
            "list": [[{"event": name, "occurs": occurs} for name, occurs in one] for one in islice(primes, listed)],
        }
    }


def _joint(solution: Solution) -> Entry:
    from safety.trees.importance.joint import differential_importance, joint_importance

    pairs = sorted(joint_importance(solution), key=lambda one: -abs(one.joint))
    return {
        "joint_importance": [vars(one) for one in pairs[:LISTED]],
        "joint_importance_not_listed": max(0, len(pairs) - LISTED),
        "differential_importance": [vars(one) for one in differential_importance(solution)],
    }


def _uncertainty(args: Namespace, solution: Solution) -> Entry:
    from safety.trees.uncertainty import propagation as uncertainty

    plan = _plan(args)
    found = uncertainty.fields(uncertainty.propagate(solution, plan))
    found["importance"] = uncertainty.importance_fields(uncertainty.propagate_importance(solution, plan))
    return {"uncertainty": found}


def _plan(args: Namespace) -> Plan:
    """How to sample."""
    from safety.trees.uncertainty.correlation import read_correlation
    from safety.trees.uncertainty.sampling import Plan

    correlation = read_correlation(args.correlation) if args.correlation else None
    return Plan(args.uncertainty, 1 if args.seed is None else args.seed, args.lhs, correlation=correlation)


def _curve(args: Namespace, tree: FaultTree) -> Entry:
    from safety.trees.over_time.mission import Mission

    return {"curve": Mission(tree, args.hours).curve(args.curve).plain()}


def _averages(args: Namespace, tree: FaultTree) -> Entry:
    from safety.trees.over_time.averages import averages
    from safety.trees.over_time.mission import Mission

    return {"averages": averages(Mission(tree, args.hours)).plain(), "mean_time_to_failure_h": _mean_time(args, tree)}


def _mean_time(args: Namespace, tree: FaultTree) -> Entry:
    """Of `tree`, or where its common-cause groups are in the way, with their shares taken of the failure rates."""
    from safety.trees.over_time.mean_time import mean_time_to_failure

    try:
        return mean_time_to_failure(tree).plain()
    except TreeError as error:
        why = error
    from safety.trees.formats.files import read_study

    try:
        study = read_study(*args.files, mission_time_h=args.hours)
        if study.ccf_groups:
            house = {one.name: one.state for one in tree.house_events}
            found = mean_time_to_failure(study.quantified(args.top, house=house, of_rates=True))
            return found.plain() | {"common_cause": "shares of failure rates"}
    except TreeError as error:
        why = error
    return {"why_not": why.message}


def _target(solution: Solution, text: str, listed: list[Entry]) -> Entry:
    from dataclasses import asdict

    from safety.trees.uncertainty.targets import meets

    name, equals, goal = text.rpartition("=")
    if not (equals and name):
        raise CommandError(f"{text!r}: give NAME=P, the name of a parameter or event and a probability")
    listed.append(asdict(meets(solution, name, goal)))
    return {"targets": listed}
