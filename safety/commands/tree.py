"""Find the cut sets of the hazards of proofs/, draw their fault trees and solve them; or solve tree files.

Without FILE: every hazard, its cut sets straight from the model.  With FILE: Open-PSA MEF XML (trees and data may stand
in several files), Aralia text, Galileo (.dft, dynamic gates too, its data also in MEF files) or the project's own JSON;
no project is needed then.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace

from safety.commands import CommandError, options
from safety.commands.output import data, probe, write
from safety.commands.tree_text import over_all, told

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from safety.report.schema import Entry

EXAMPLES = """
rightside tree                                            all hazards
rightside tree -k no_brake --svg no_brake.svg             one hazard, with its picture
rightside tree permit.xml rates.xml --hours 8760          a tree with its data
rightside tree permit.json --json -                       all figures as JSON
rightside tree permit.xml --uncertainty 10000 --lhs       what the distributions of its data make of the top event
rightside tree permit.xml --hours 8760 --sil --curve 12   PFDavg, PFH, safety integrity level, and Q over the year
rightside tree permit.xml --certificate permit.cert.json  for `rightside check`
rightside tree permit.dft --hours 8760 --export permit.xml  from one format into another
rightside tree plant.dft data.xml --hours 8760 --uncertainty 10000  dynamic gates; a MEF file has the distributions
"""
OF_FILES: dict[str, object] = {  # options that belong to tree files, with their values when not given
    "top": None, "hours": None, "export": [], "certificate": None, "likeliest": False, "exact": False, "gates": False,
    "joint": False, "prime_implicants": None, "uncertainty": None, "lhs": False, "seed": None, "correlation": None,
    "sensitivity": False, "target": [], "curve": None, "sil": False,
    "order": None, "above": None,
    "ties": "refuse",
}  # fmt: skip


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("files", nargs="*", metavar="FILE", help="a fault tree, instead of the project's hazards")
    parser.add_argument("--svg", metavar="FILE", help="draw the tree (there has to be only one), or event trees")
    group = parser.add_argument_group("with FILE")
    group.add_argument("--top", metavar="GATE", help="the top gate, where the file leaves it open")
    group.add_argument("--hours", metavar="H", help="mission time of rates without a time of their own")
    group.add_argument("--likeliest", action="store_true", help="list the likeliest cut sets, not the smallest")
    group.add_argument("--order", metavar="N", type=_order, help="only cut sets of at most N events")
    group.add_argument("--above", metavar="P", type=_chance, help="only cut sets of probability P or more")
    group.add_argument("--exact", action="store_true", help="the probability as a rational, however large the tree")
    group.add_argument("--gates", action="store_true", help="importance of gates as well")
    group.add_argument(
        "--prime-implicants", metavar="N", type=_samples, help="count them, and list N (with not or xor)"
    )
    group.add_argument("--joint", action="store_true", help="joint importance of pairs, differential importance")
    group.add_argument(
        "--uncertainty",
        metavar="N",
        type=_samples,
        help="N samples of the data's distributions (event trees: for each sequence)",
    )
    group.add_argument("--lhs", action="store_true", help="Latin hypercubes instead of independent samples")
    group.add_argument("--seed", metavar="S", type=int, help="of the samples (default: 1)")
    group.add_argument(
        "--correlation", metavar="FILE", help='of its variables: {"rank_correlations": [["a", "b", 0.5]]} in JSON'
    )
    group.add_argument("--sensitivity", action="store_true", help="derivative by each parameter, and what ranges do")
    group.add_argument(
        "--target", metavar="NAME=P", action="append", default=[],
        help="the value of a parameter or event at which the top has probability P; may be repeated",
    )  # fmt: skip
    group.add_argument(
        "--curve", metavar="N", type=_samples, help="unavailability and frequency at N steps of the time"
    )
    group.add_argument("--sil", action="store_true", help="PFDavg, PFH, mean time to failure, safety integrity level")
    group.add_argument("--export", metavar="FILE", action="append", default=[],
                       help="write the tree as .xml, .json, .dag, .dft or .dot; may be repeated")  # fmt: skip
    group.add_argument("--certificate", metavar="FILE", help="write what `rightside check` needs to check the result")
    group.add_argument(
        "--ties", choices=("refuse", "as written"), default="refuse",
        help="with dynamic gates: what failures at the same moment mean, if their order counts",
    )  # fmt: skip
    options.add_selection(parser)
    options.add_work(parser)


def run(args: Namespace) -> int:
    """Carry out the verb."""
    _keep_apart([*args.files, args.correlation], [args.svg, args.certificate, args.json, *args.export])
    for path in (args.svg, args.certificate, *args.export):
        if path:
            probe(path)
    if args.files:
        from safety.commands.tree_files import solve_files

        entries, code = solve_files(args)
    else:
        for name, default in OF_FILES.items():
            if getattr(args, name) != default:
                raise CommandError(f"--{name.replace('_', '-')} is for tree files; give a FILE")
        from safety.commands.session import work

        session = work(args, "trees")
        entries, code = session.results.get("trees", []), session.code
    if args.json != "-":
        texts = [told(entry) for entry in entries if entry.get("structure") or "sequences" in entry]
        data("\n\n".join(filter(None, [*texts, over_all(entries)])))
    if args.files and args.json:
        from safety.commands.tree_files import write_entries

        write_entries(entries, args.json)
    if args.svg:
        _draw(args.svg, entries)
    return code


def _keep_apart(read: list[str | None], written: list[str | None]) -> None:
    """Refuse to write over what is read, or two results to one place."""
    import os

    places = {os.path.realpath(path) for path in read if path}
    for path in written:
        place = os.path.realpath(path) if path and path != "-" else None
        if place in places:
            raise CommandError(f"{path} is read or written otherwise; give this result a file of its own")
        if place:
            places.add(place)


def _draw(path: str, entries: list[Entry]) -> None:
    if entries and all("sequences" in entry for entry in entries):
        from safety.report.event_tree_svg import event_trees_svg

        write(path, event_trees_svg(entries))
        names = ", ".join(dict.fromkeys(entry["event_tree"] for entry in entries))
        print(f"picture of {names}: {path}", file=sys.stderr)
        return
    from safety.report.tree_svg import tree_svg

    if len(entries) != 1:
        raise CommandError(f"--svg draws one tree, {len(entries)} were found; choose one with -k")
    picture = tree_svg(entries[0])
    if not picture:
        raise CommandError(f"{entries[0]['id']} has no structure to draw")
    write(path, picture)
    print(f"picture of {entries[0]['id']}: {path}", file=sys.stderr)


def _samples(text: str) -> int:
    if not text.isdecimal() or int(text) < 2:
        from argparse import ArgumentTypeError

        raise ArgumentTypeError(f"{text!r}: give a whole number, 2 or more")
    return int(text)


def _order(text: str) -> int:
    if not text.isdecimal() or len(text) > 9:
        from argparse import ArgumentTypeError

        raise ArgumentTypeError(f"{text!r}: give a whole number of events, 0 or more")
    return int(text)


def _chance(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value <= 1:
        from argparse import ArgumentTypeError

        raise ArgumentTypeError(f"{text!r}: give a probability, above 0 and up to 1")
    return value
