"""Run again on the Python reading, without any solver, what a result rests on, and show it.

ID is a claim that was refuted (its run; of a bound its point), a synthesis (its run), CAMPAIGN#N or CAMPAIGN::INJECTION
(one injection), HAZARD#N or HAZARD::FAULTS (one cut set, numbered as `rightside tree` shows them; order 0 is #0).
Results are those of the last run, or of --from.
An INJECTION may give the campaign's faults any onset: NAME, NAME from step 40, NAME, transient at 40 for 3; several
stand with & between.
Exit 0 when it comes out as it was recorded, 1 when it does not.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from safety.commands import CommandError, memory, options, settings
from safety.commands.evaluate import find, fitting, fitting_claim
from safety.commands.output import data, probe
from safety.commands.runs import add_signals, chosen_signals, show_run
from safety.commands.table import table
from safety.project import Project, Value, open_project
from safety.prove import search
from safety.prove.bounds.claims import RealClaim
from safety.prove.problem import build_problem, observed
from safety.prove.record import story
from safety.prove.refinement import build_refinement
from safety.prove.stimulus import rerun
from safety.report.results import load
from safety.report.sarif import replay_command
from safety.report.schema import Entry
from safety.system import ModelError, nearest
from safety.trace import Trace

if TYPE_CHECKING:
    from safety.inject import Campaign, Injection
    from safety.inject import Replay as InjectionReplay
    from safety.prove.problem import Problem as Asked

EXAMPLES = """
rightside replay ts7_voting.brakes_with_two_faults
rightside replay ts7.ring#17 --show "ring,overflow.*" --last 200
rightside replay "ts7.ring::sum stuck-at-1" --shrink
rightside replay "ts7.ring::sum stuck-at-1, transient at 640 for 32" --vcd sum.vcd
rightside replay ts7_voting.overspeed_without_brake#0 --vcd cut_set.vcd
rightside replay ts7_voting.brakes_with_two_faults --from results.json
"""
SHOWN = 40  # steps
ROWS = 100  # lines


class Replayed(NamedTuple):
    """A run, whether it came out as recorded, and what happened in it."""

    trace: Trace
    same: bool
    told: str
    paths: list[str]  # signals that tell its story


class Recorded(NamedTuple):
    """What is known of the results: the settings they were made with, and the entry that was asked for."""

    settings: Mapping[str, Value]
    entry: Entry | None


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("id", metavar="ID", help="a claim, CAMPAIGN#N or HAZARD#N")
    parser.add_argument(
        "--from", dest="source", metavar="FILE", help="results kept with --json (default: the last ones)"
    )
    parser.add_argument(
        "--shrink", action="store_true",
        help="of an injection that is dangerous undetected: the fewest faults, for the shortest time, that are so too",
    )  # fmt: skip
    add_signals(parser)
    parser.add_argument(
        "--first",
        metavar="STEP",
        type=int,
        help=f"first step shown (default: 0, or {SHOWN} before the last where more than {ROWS} lines would come)",
    )
    parser.add_argument("--last", metavar="STEP", type=int, help="last step shown (default: where the run ends)")
    options.add_json(parser)


def run(args: Namespace) -> int:
    """Carry out the verb."""
    for target in filter(None, (args.vcd, args.json)):
        probe(Path(target))
    project = open_project(Path(args.project) if args.project else None)
    project.load_proofs()
    settings.check(project, [], {})
    for problem in project.problems:
        print(f"x {problem}", file=sys.stderr)
    bound = next((each for each in project.bounds if each.id == args.id), None)
    if bound is not None:
        return _at_point(bound, _recorded(project, args, "claims", bound.id).entry)
    found = _replayed(project, args)
    last = len(found.trace) - 1 if args.last is None else min(args.last, len(found.trace) - 1)
    paths = chosen_signals(args.show, found.trace, found.paths)
    short = sum(1 for _, changed in found.trace.changes(0, last) if not changed.keys().isdisjoint(paths)) <= ROWS
    first = args.first if args.first is not None else 0 if short else max(0, last - SHOWN + 1)
    if not 0 <= first <= last:
        raise CommandError(f"--first {first} --last {last}: the run has steps 0 to {len(found.trace) - 1}")
    show_run(args, found.trace, paths, first, last)
    print(f"{'reproduced' if found.same else 'NOT reproduced'}: {found.told}", file=sys.stderr)
    return 0 if found.same else 1


def _replayed(project: Project, args: Namespace) -> Replayed:
    name, number, which = args.id.partition("#")
    key: str | int | None = None
    if not number:
        name, named, which = args.id.partition("::")
        key = which if named else None
    elif which.isdecimal():
        key = int(which)
    else:
        raise CommandError(f"{args.id}: a number follows #, e.g. {name}#0")
    of_claims, of_hazards, of_campaigns = ({each.id for each in each_kind} for each_kind in _declared(project))
    of_syntheses = {each.id for each in project.syntheses}
    if args.shrink and name in of_claims | of_hazards | of_syntheses:
        raise CommandError(f"--shrink is for an injection of a campaign; {name} is none")
    if name in of_claims:
        return _claim(project, name, _recorded(project, args, "claims", name))
    if name in of_syntheses:
        return _synthesis(project, name, _recorded(project, args, "syntheses", name))
    if name in of_hazards:
        return _cut_set(project, name, key, _recorded(project, args, "trees", name))
    if name in of_campaigns:
        return _injection(project, name, key, args, _recorded(project, args, "campaigns", name))
    known = of_claims | of_syntheses | of_hazards | of_campaigns | {bound.id for bound in project.bounds}
    raise CommandError(f"no claim, campaign or hazard {name!r}; {nearest(name, known)}")


def _declared(project: Project) -> list[list[Any]]:
    return [[*project.claims], [*project.hazards], [*project.campaigns]]


def _recorded(project: Project, args: Namespace, section: str, name: str) -> Recorded:
    results = load(Path(args.source)) if args.source else memory.last(project.root)
    given = {key: options.typed(text) for key, text in results.get("settings", {}).items()}
    entry = next((each for each in results.get(section, ()) if each["id"] == name), None)
    return Recorded({**project.config.settings, **given}, entry)


def _at_point(bound: RealClaim, entry: Entry | None) -> int:
    """Whether a claim over reals is broken at its point, computed again with fractions; the point goes to stdout."""
    counterexample = (entry or {}).get("counterexample")
    if not counterexample:
        verdict = f"is {entry['verdict']}" if entry else "has no result yet"
        raise CommandError(f"{bound.id} {verdict}: no point to show; `rightside prove -k {bound.id}` looks for one")
    exceeded = bound.broken_at(counterexample["values"])
    data(table(["name", "value"], [[name, text] for name, text in counterexample["values"].items()]))
    told = f"{bound.id} is {'broken' if exceeded else 'not broken'} at this point"
    print(f"{'reproduced' if exceeded else 'NOT reproduced'}: {told}", file=sys.stderr)
    return 0 if exceeded else 1


def _claim(project: Project, name: str, recorded: Recorded) -> Replayed:
    counterexample = (recorded.entry or {}).get("counterexample")
    if not counterexample:
        verdict = f"is {recorded.entry['verdict']}" if recorded.entry else "has no result yet"
        raise CommandError(f"{name} {verdict}: there is no run to show; `rightside prove -k {name}` looks for one")
    claim = find(project.claims, name)
    settings = fitting_claim(claim, recorded.settings)
    build = build_problem if claim.refinement is None else build_refinement
    problem = build(claim, settings)
    given = counterexample.get("stimulus")
    if given is not None:
        trace = rerun(observed(problem), given, counterexample["steps"])
    elif claim.scenario is not None:
        script = search.scripted(problem, claim.scenario)
        trace = search.cut_at(script, "claim.holds", False) or script
    else:
        raise CommandError(f"{name}: these results do not say what its run was given; `rightside prove -k {name}` does")
    return _of_claim(name, problem, trace)


def _of_claim(name: str, problem: Asked, trace: Trace) -> Replayed:
    same = not trace["claim.holds"][-1] and all(trace["claim.given"])
    how = "false" if not trace["claim.holds"][-1] else "true"
    return Replayed(trace, same, f"{name} is {how} at step {len(trace) - 1}", story(trace, problem))


def _synthesis(project: Project, name: str, recorded: Recorded) -> Replayed:
    """The run at the value that was refuted."""
    entry: Entry = recorded.entry or {}
    counterexample, breaking = entry.get("counterexample") or {}, find(project.syntheses, name).breaking
    if breaking is None or not counterexample.get("stimulus"):
        raise CommandError(f"{name} has no run in the last results; `rightside prove -k {name}` looks for one")
    claim = replace(breaking(entry["refuted_at"]), scenario=None)
    problem = build_problem(claim, fitting(claim.model, recorded.settings))
    trace = rerun(observed(problem), counterexample["stimulus"], counterexample["steps"])
    return _of_claim(f"{name} with {entry['parameter']} {entry['refuted_at']}", problem, trace)


def _cut_set(project: Project, name: str, key: str | int | None, recorded: Recorded) -> Replayed:
    hazard = find(project.hazards, name)
    faults = _faults(name, key, recorded.entry)
    settings = {**fitting(hazard.claim.model, recorded.settings), **hazard.claim.settings}
    problem = search.with_faults(build_problem(replace(hazard.claim, settings=settings)), faults)
    present = " & ".join(faults) or "no fault"
    run: Trace | None = None
    for script in hazard.scenarios(faults):
        run = search.scripted(problem, script)
        hit = search.cut_at(run, "claim.holds", False)
        if hit is not None:
            return Replayed(hit, True, f"{name} happens at step {len(hit) - 1} with {present}", story(hit, problem))
    if run is None:
        raise CommandError(f"{name} has no scenario for {present}; add one to its `scenarios`")
    return Replayed(run, False, f"{name} does not happen in any scenario with {present}", story(run, problem))


def _faults(name: str, key: str | int | None, entry: Entry | None) -> tuple[str, ...]:
    if isinstance(key, str):
        return tuple(key.split(" & "))
    if entry is None:
        raise CommandError(f"{name} has no cut sets yet; `rightside tree -k {name}` finds them")
    sets = [one["events"] for one in (entry.get("minimal_cut_sets") or {}).get("sets", ())]
    if key is None or key >= len(sets):
        raise CommandError(f"{name} has {len(sets)} cut sets listed, from #0 on; write {name}#0")
    return tuple(sets[key])


def _injection(project: Project, name: str, key: str | int | None, args: Namespace, recorded: Recorded) -> Replayed:
    from safety.inject.classes import class_of
    from safety.inject.reproduce import read, reproducer

    if key is None:
        raise CommandError(f"{name} is a campaign; write {name}#0, {name}#1, ... for one of its injections")
    campaign = find(project.campaigns, name)
    if isinstance(campaign.model, type):
        campaign.settings = {**campaign.settings, **fitting(campaign.model, recorded.settings)}
    injection = read(campaign, key)
    if args.shrink:
        least = reproducer(campaign, injection)
        injection = least.injection
        print(f"minimal reproducer, of {least.runs} runs: {replay_command(f'{name}::{injection.id}')}", file=sys.stderr)
    keep = [path for path in campaign.system.names() if path not in campaign.system.inputs]
    found = campaign.replay(injection, keep=keep)
    came = class_of(found.cell)
    told = f"{injection.id} is {came.replace('_', ' ')}{_by_what(found)}"
    paths = found.trace.telling([path for path in found.trace.columns if path.startswith("observed ")])
    entry = recorded.entry
    if entry is None:
        return Replayed(found.trace, True, f"{told}; there is no earlier result to compare with", paths)
    listed = entry.get("replay", ())
    was = f"{name}::{injection.id}" in listed
    if not was and (not _own(campaign, injection) or entry.get("replay_of", 0) > len(listed)):
        return Replayed(found.trace, True, f"{told}; the results do not list it", paths)
    same = was == (came == "dangerous_undetected")
    return Replayed(found.trace, same, told + ("" if same else ", which the results deny"), paths)


def _own(campaign: Campaign, injection: Injection) -> bool:
    """Whether the campaign itself makes this injection."""
    try:
        return campaign.space.find(injection.id) >= 0
    except ModelError:
        return False


def _by_what(found: InjectionReplay) -> str:
    if found.detected_by is None:
        return ""
    return f" by {found.detected_by}" + ("" if found.latency is None else f" after {found.latency} frames")
