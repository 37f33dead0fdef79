"""Write the report folder of the last results, or check that the one in the project is still true.

--check compares reports/ with the last results, and its list of files with the project's models/ and proofs/; where
there are no last results, reports/results.json stands for them.  It fails (exit 1) when the report is stale.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path

from safety.commands import CommandError, memory
from safety.commands.output import data, probe
from safety.commands.session import texts
from safety.project import Project, open_project
from safety.report.folder import check, write
from safety.report.results import Results, exit_code, load, merge

EXAMPLES = """
rightside report                        write reports/ from the last results
rightside report --to out --timings     elsewhere, with times and versions, to be read and not committed
rightside report --from a.json b.json   out of results that were kept with --json
rightside report --check                fail when reports/ is stale
"""
STALE = 1


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("--from", dest="sources", metavar="FILE", nargs="+", help="results kept with --json")
    parser.add_argument("--to", metavar="DIR", help="folder of the report (default: reports/, or as configured)")
    parser.add_argument("--check", action="store_true", help="write nothing; fail when the report is stale")
    parser.add_argument("--timings", action="store_true", help="with times and versions: not for comparing")


def run(args: Namespace) -> int:
    """Carry out the verb."""
    project = open_project(Path(args.project) if args.project else None)
    folder = Path(args.to) if args.to else project.root / project.config.report
    if args.check:
        return _check(args, project, folder)
    results = _results(args, project)
    if not args.sources:
        _refuse_outdated(results, project)
    probe(folder / "index.html")
    write(results, folder, timings=args.timings)
    data(str(folder / "index.html"))
    return 0


def _check(args: Namespace, project: Project, folder: Path) -> int:
    committed = folder / "results.json"
    kept = args.sources or memory.last(project.root)
    if not kept and not committed.is_file():
        print(f"stale: there is no report in {folder}; `rightside verify` writes it", file=sys.stderr)
        return STALE
    results = _results(args, project) if kept else load(committed)
    found = [f"{name}: changed since the results were made; `rightside verify`" for name in _changed(results, project)]
    found += [str(difference) for difference in check(results, folder)]
    for text in found:
        print(f"stale: {text}", file=sys.stderr)
    if not found:
        print(f"{folder} is what the results say, exit code of the results: {exit_code(results)}", file=sys.stderr)
    return STALE if found else 0


def _results(args: Namespace, project: Project) -> Results:
    if args.sources:
        first, *others = (load(Path(source)) for source in args.sources)
        return merge(first, *others)
    results = memory.last(project.root)
    if not results:
        raise CommandError(f"{project.root} has no last results; run `rightside verify`, or give --from FILE")
    return results


def _refuse_outdated(results: Results, project: Project) -> None:
    changed = _changed(results, project)
    if changed or memory.outdated(results):
        what = (
            f"{', '.join(changed[:3])} changed"
            if changed
            else f"{memory.outdated(results)} results are of an older text"
        )
        raise CommandError(f"the last results are not of the project as it stands: {what}; run `rightside verify`")


def _changed(results: Results, project: Project) -> list[str]:
    """Files of models/ and proofs/ that are not as they were when the results were made."""
    then = {entry["id"]: entry.get("sha256") for entry in results.get("models", ())}
    now = {entry["id"]: entry["sha256"] for entry in texts(project)}
    return sorted(name for name in then.keys() | now.keys() if then.get(name) != now.get(name))
