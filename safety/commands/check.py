"""Check certificates: of proofs, every obligation anew, by z3, by cvc5 and by its bit-level proof; of fault trees.

No project is needed, and nothing of rightside is used but one file, `safety/prove/check.py` or, of a fault tree,
`safety/trees/check_tree.py`, which run alone as well.
A certificate may prove another claim than one thinks: --against compares it with the claim of its name in the project.
Exit codes: 0 checked, 1 rejected, 2 not a certificate, 3 undecided, 4 weaker (a solver or a bit-level proof is
missing), 6 the engines disagree; that of the worst file.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

from safety.commands import CommandError, options, settings
from safety.commands.output import probe, write_plain
from safety.commands.table import table
from safety.commands.tree_text import counted
from safety.prove import check
from safety.system import nearest

EXAMPLES = """
rightside check reports/certificates/*.zip            every certificate
rightside check brakes.zip --against                  and whether it is of the project's claim as it is now
rightside check tree.json                             the certificate of a fault tree
rightside check brakes.zip --timeout 300 --json -     with more time for each solver; the report as JSON
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("files", metavar="FILE", nargs="+", type=Path, help="a certificate")
    parser.add_argument("--against", action="store_true", help="it has to be of the project's claim as it is now")
    options.add_timeout(parser)
    options.add_json(parser)


def run(args: Namespace) -> int:
    """Carry out the verb."""
    if args.json:
        probe(Path(args.json))
    reports = [_examined(file, args) for file in args.files]
    if args.against:
        _compare(reports, args)
    for report in reports:
        print(_told(report), file=sys.stderr)
    if args.json:
        write_plain({"certificates": reports}, args.json)
    return check.EXIT[check.worst(report["verdict"] for report in reports)]


def _examined(file: Path, args: Namespace) -> dict[str, Any]:
    """The report on a file, by the checker of its kind: a certificate of a proof is a zip, that of a tree is JSON."""
    try:
        with file.open("rb") as opened:
            if opened.read(1) != b"{":
                return check.examine(file, args.timeout or 60.0)
    except OSError:
        return check.examine(file)
    if args.against:
        raise CommandError(f"--against is for claims of the project, and {file} is of a fault tree; leave it out")
    from safety.trees import check_tree

    return check_tree.examine(file)


def _compare(reports: list[dict[str, Any]], args: Namespace) -> None:
    """Reject the certificates that are not of a claim of the project as it is now."""
    from safety.commands.evaluate import fitting_claim
    from safety.project import open_project
    from safety.prove.certificate import unlike
    from safety.prove.prove import stated

    project = open_project(Path(args.project) if args.project else None)
    project.load_proofs()
    settings.check(project, [], {})
    claims = {claim.id: claim for claim in project.claims}
    over_reals = {claim.id: claim for claim in project.bounds}
    for report in reports:
        if check.EXIT[report["verdict"]] not in (check.EXIT[check.CHECKED], check.EXIT[check.WEAKER]):
            continue
        name = report["claim"]["id"]
        if name in over_reals:
            why = unlike(report, over_reals[name].problem())
        elif name not in claims:
            why = f"the project has no claim {name!r}; {nearest(name, [*claims, *over_reals])}"
        else:
            why = unlike(report, stated(claims[name], fitting_claim(claims[name], project.config.settings)))
        if why:
            report |= {"verdict": check.REJECTED, "why": why}


def _told(report: dict[str, Any]) -> str:
    """A report in words: what is claimed, a row for each obligation, the verdict."""
    lines = []
    if "claim" in report:
        claim, lemmas = report["claim"], len(report["lemmas"])
        lines += [
            f"{claim['id']}: {claim['statement']!r}",
            f"  with the faults: {', '.join(claim['faults']) or 'none'}",
        ]
        lines += [f"  claim sha256 {claim['sha256']}", f"  model sha256 {report['model']['sha256']}"]
        lines += [f"  induction of depth {report['depth']}, {lemmas} lemmas"]
        rows = [[one["verdict"], one["label"], one["z3"], one["cvc5"], _bits(one)] for one in report["obligations"]]
        shown = table(["verdict", "obligation", "z3", "cvc5", "bits"], rows) if rows else ""
        lines += [f"  {line}" for line in shown.splitlines()]
    if "cut_sets_by_order" in report:
        low, high = report["probability"] or (None, None)
        lines += [
            f"{report['name']}: fault tree, {counted(sum(report['cut_sets_by_order']), 'minimal cut set')}",
            "  no probability" if low is None else f"  probability between {low!r} and {high!r}",
            *(f"  {part} sha256 {digest}" for part, digest in report["sha256"].items()),
        ]
    return "\n".join(
        [*lines, f"{report['file']}: {report['verdict']}" + (f": {report['why']}" if report["why"] else "")]
    )


def _bits(one: dict[str, Any]) -> str:
    bits, note = str(one["bits"]), one["note"]
    return f"{bits} ({note})" if bits == "no proof" and note else bits
