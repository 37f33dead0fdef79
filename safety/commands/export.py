"""Write a claim as a file for another tool, which can then be asked whether it holds.

CLAIM is the id of a claim or refinement.  The file goes to stdout, or to --to, whose ending names the format too.
Assumptions (given, start, fault budget, ranges) are in it.  No file says that a claim can happen at all: that its
premise is met is shown by `rightside prove`.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from safety.commands import CommandError, options
from safety.commands.output import data, probe
from safety.project import open_project
from safety.system import nearest

if TYPE_CHECKING:
    from safety.prove.problem import Problem

EXAMPLES = """
rightside export ts7_voting.lowering_only_lowers --format btor2
rightside export ts7_voting.lowering_only_lowers --to claim.aig
  berkeley-abc -c "read_aiger claim.aig; pdr"
rightside export ts7_channel.brakes_one_word_above --lemmas --to claim.smt2
  z3 claim.smt2
rightside export ts7_voting.lowering_only_lowers --to claim.v
  yosys -p "read_verilog -formal claim.v; prep; sat -tempinduct -prove-asserts -set-assumes"
rightside export ts7_ring.ring_refines_words --to claim.vmt --arithmetic bits
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    from safety.export import FORMATS

    known = "; ".join(f"{name} ({form.ending}): {form.text}" for name, form in FORMATS.items())
    parser.add_argument("claim", metavar="CLAIM", help="a claim's id, as `rightside list` shows it")
    parser.add_argument("--format", metavar="F", choices=sorted(FORMATS), help=known)
    parser.add_argument("--to", metavar="FILE", help="where to; - is stdout (default)")
    parser.add_argument(
        "--lemmas",
        action="store_true",
        help="the claim's lemmas have to hold as the claim does (none is taken on trust)",
    )
    parser.add_argument(
        "--arithmetic", choices=("integers", "bits"),
        help="words as integers or as bit-vectors, in smtlib and vmt (default: as the claim is proved)",
    )  # fmt: skip
    options.add_settings(parser)


def run(args: Namespace) -> int:
    """Carry out the verb."""
    from safety.export import FORMATS, export

    format = args.format or _format_of(args.to)
    binary = format == "aiger"
    to_stdout = args.to in (None, "-")
    if binary and to_stdout and sys.stdout.isatty():
        raise CommandError("aiger is a binary format; give --to FILE, or --format aag for text")
    if not to_stdout:
        probe(Path(args.to))
    problem = _problem(args)
    claim = problem.claim
    integers = (args.arithmetic or claim.arithmetic) == "integers"
    content = export(problem, format, args.lemmas, integers, max(1, claim.induction))
    if to_stdout:
        _to_stdout(content)
    else:
        from safety.report.results import write_bytes

        write_bytes(Path(args.to), content if isinstance(content, bytes) else content.encode("utf-8"))
    print(f"{claim.id}: {claim.statement}", file=sys.stderr)
    where = "stdout" if to_stdout else args.to
    print(
        f"{format} ({FORMATS[format].text}), {len(content)} bytes, to {where}; {_said_of(args, problem)}",
        file=sys.stderr,
    )
    return 0


def _format_of(target: str | None) -> str:
    """The format that a file's ending names.  Raises CommandError when there is none."""
    from safety.export import FORMATS

    endings = {form.ending: name for name, form in FORMATS.items()}
    ending = Path(target or "").suffix
    if ending in endings:
        return endings[ending]
    raise CommandError(
        f"which format? Give --format ({', '.join(FORMATS)}), or --to with one of the endings {', '.join(endings)}"
    )


def _problem(args: Namespace) -> Problem:
    """The claim's problem with the settings given.  Raises CommandError for a name that is no claim's."""
    from safety.commands.evaluate import fitting_claim, models_of_claim
    from safety.commands.settings import check
    from safety.prove import written_for
    from safety.prove.prove import stated

    project = open_project(Path(args.project) if args.project else None)
    project.load_proofs()
    for trouble in project.problems:
        print(f"x {trouble}", file=sys.stderr)
    claims = {claim.id: claim for claim in project.claims}
    if any(bound.id == args.claim for bound in project.bounds):
        raise CommandError(f"{args.claim} is a bound over reals, without a model that could be exported")
    if args.claim not in claims:
        raise CommandError(f"no claim {args.claim!r}; {nearest(args.claim, claims)}")
    claim = claims[args.claim]
    check(project, models_of_claim(claim), dict(args.settings))
    settings = {**project.config.settings, **dict(args.settings)}
    written_for.check(claim.id, models_of_claim(claim), claim.own_parameters, settings)
    return stated(claim, fitting_claim(claim, settings))


def _to_stdout(content: str | bytes) -> None:
    if isinstance(content, str):
        data(content.removesuffix("\n"))
    else:
        sys.stdout.buffer.write(content)
        sys.stdout.buffer.flush()


def _said_of(args: Namespace, problem: Problem) -> str:
    """What has to hold in the file."""
    lemmas = len(problem.lemmas)
    if not args.lemmas:
        return "the claim alone" + (f" (of its {lemmas} lemmas none; --lemmas adds them)" if lemmas else "")
    return f"the claim and its {lemmas} lemmas, to be shown together" if lemmas else "the claim; it has no lemmas"
