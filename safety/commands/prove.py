"""Prove or refute the claims of proofs/, and find the weakest safe parameters.

Each claim states the verdict it expects; anything else is shown as not as asked.  A refuted claim is shown with the
run that breaks it: a star marks a changed cell, an exclamation mark the step at which the claim is false.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from safety.commands import options
from safety.commands.session import work

EXAMPLES = """
rightside prove                           all claims
rightside prove -k "voting and not two"   those whose id, model or requirement contains the words
rightside prove --req TS7-7 -x            those for a requirement, up to the first that is not as asked
rightside prove --lf --timeout 300        those that failed the last time, with more time
rightside prove --set k=120 --vcd waves   with another parameter; waveforms of what is refuted
rightside prove --certify certificates    a certificate of each proof, for `rightside check`
rightside prove --mutants -k threshold    would these claims notice if the model said something else?
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    options.add_selection(parser)
    options.add_work(parser)
    options.add_cache(parser)
    parser.add_argument(
        "--vcd", metavar="DIR", help="write the run of each refuted claim as a waveform into this folder"
    )
    parser.add_argument(
        "--certify", metavar="FOLDER", help="write a certificate of each proved claim into this folder, <id>.cert.zip"
    )
    parser.add_argument(
        "--mutants", action="store_true",
        help="change the models in every place, one by one, and show which changes no claim notices",
    )  # fmt: skip
    parser.add_argument(
        "-q", "--quiet", action="store_true", help="no tables for claims that are refuted as they must be"
    )


def run(args: Namespace) -> int:
    """Carry out the verb."""
    if args.mutants:
        from safety.commands import mutants

        return mutants.run(args)
    return work(args, "claims", "syntheses", tables=not args.quiet).code
