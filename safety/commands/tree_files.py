"""Tree files for `rightside tree`: read, solved, exported; nothing is imported that is not used."""

from __future__ import annotations

import sys
import time
from argparse import Namespace
from fractions import Fraction
from math import inf

from safety.commands import CommandError
from safety.commands.output import data, probe
from safety.commands.versions import VERSION
from safety.report.files import dumps, write_text
from safety.trees.as_written import TreeError, exact
from safety.trees.formats.files import LARGEST, read
from safety.trees.module_diagrams import TooLarge
from safety.trees.solve import solve
from safety.trees.summary import LISTED, cut_set_rows, entry_of
from safety.trees.tree import FaultTree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from safety.report.schema import Entry
    from safety.trees.cut_sets.enclosures import Enclosed
    from safety.trees.cut_sets.truncated import Truncated
    from safety.trees.study import Study
    from safety.trees.tree import BasicEvent

NOT_AS_ASKED, INPUT_ERROR, WEAKER = 1, 2, 4
QUICKLY_EXACT = 30  # nodes of a diagram that is evaluated in rationals unasked
UNCERTAIN = ("uncertainty", "lhs", "seed", "correlation")
FREE = ("top", "hours", "ties", "export", "order", "above", "likeliest")  # options that need no diagram
EVENT_TREES, PHASES = (b"event-tree", b'"event_trees"'), (b"define-alignment", b'"alignments"')  # in MEF, in JSON
EXTRAS = (  # options that add to what a tree's entry always holds
    "likeliest", "gates", "prime_implicants", "joint", "uncertainty", "sensitivity", "target", "curve", "sil",
    "certificate", "svg",
)  # fmt: skip


def solve_files(args: Namespace) -> tuple[list[Entry], int]:
    """The entries for the files, and the exit code."""
    if args.keyword or args.req or args.lf or args.settings:
        raise CommandError("-k, --req, --lf and --set choose among a project's hazards; leave them out with a FILE")
    for option, given in (("--timeout", args.timeout), ("-j", args.jobs), ("-x", args.first)):
        if given:
            raise CommandError(f"{option} is of the project's hazards; leave it out with a FILE")
    if args.hours is not None:
        exact(args.hours, "--hours")
    texts = [_content(file) for file in args.files]
    if args.ties != "refuse" and not any(b"toplevel" in text for text in texts):
        raise CommandError("--ties is of dynamic trees in Galileo text; leave it out")
    if args.uncertainty is None and (args.lhs or args.correlation or args.seed is not None):
        raise CommandError("--lhs, --seed and --correlation are of --uncertainty N; add it")
    if args.json:
        probe(args.json)
    try:
        entries = _events(args, texts) or _phases(args, texts) or [_dynamic(args, texts) or _static(args)]
    except TreeError as error:
        raise error if any(file in str(error) for file in args.files) else error.at(", ".join(args.files)) from None
    if any(entry.get("errors") for entry in entries):
        return entries, INPUT_ERROR
    if any(entry.get("wrong") for entry in entries):
        return entries, NOT_AS_ASKED
    return entries, WEAKER if any(entry.get("note") for entry in entries) else 0


def write_entries(entries: list[Entry], target: str) -> None:
    """Write them as a results document, to a file or, for `-`, to stdout. Raises OSError."""
    results: dict[str, Any] = {"schema": "rightside/1", "tool": {"rightside": VERSION}}
    for entry in entries:
        results.setdefault("event_trees" if "sequences" in entry else "trees", []).append(entry)
    if target == "-":
        data(dumps(results).rstrip("\n"))
    else:
        write_text(target, dumps(results))


def _static(args: Namespace) -> Entry:
    began = time.perf_counter()
    tree = read(*args.files, top=args.top, mission_time_h=args.hours)
    return _solved(args, tree, time.perf_counter() - began)


def _phases(args: Namespace, texts: list[bytes]) -> list[Entry]:
    """An entry for each phase of the alignments in the files, if there are any."""
    if not _holds(texts, PHASES):
        return []
    from safety.trees.formats.files import read_study

    study = read_study(*args.files, mission_time_h=args.hours)
    if not study.alignments:
        return []
    if args.certificate or (args.svg and sum(len(one.phases) for one in study.alignments) > 1):
        name = "certificate" if args.certificate else "svg"
        raise CommandError(f"--{name} is of one tree, and {', '.join(args.files)} holds one for each phase")
    entries, errors = [], _exported(args, study)
    for alignment, phase, tree in study.in_phases(args.top):
        entry = _solved(args, tree, None, errors)
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


def _solved(args: Namespace, tree: FaultTree, read_s: float | None, errors: list[str] | None = None) -> Entry:
    errors = _exported(args, tree) if errors is None else errors
    began = time.perf_counter()
    try:
        solution = solve(tree)
    except TooLarge as why:
        return _enclosed(args, tree, read_s, why) | ({"errors": errors} if errors else {})
    known, within = solution.probability is not None, None
    if args.order is not None or args.above is not None:
        from safety.trees.cut_sets.truncated import limited

        within = limited(solution, args.order, args.above)
    entry = entry_of(
        solution, source=", ".join(args.files), read_s=read_s, solve_s=time.perf_counter() - began,
        likeliest=args.likeliest and known, exact_nodes=inf if args.exact else QUICKLY_EXACT,
        limited=within,
    )  # fmt: skip
    if args.exact and known and entry["exact"] is None:
        reason = "an event has no rational one" if solution.exact is None else "it has more than 3,900 digits"
        entry["note"] = f"no exact probability is given: {reason}"
    if any(getattr(args, name) for name in EXTRAS):
        from safety.commands.tree_extras import extend

        errors = errors + extend(entry, args, solution)
    return entry | {"errors": errors} if errors else entry


def _enclosed(args: Namespace, tree: FaultTree, read_s: float | None, why: TooLarge) -> Entry:
    """The entry of a tree that no diagram fits: certified bounds of its probability."""
    from safety.trees.cut_sets.enclosures import enclose
    from safety.trees.formats.json_form import to_document

    began = time.perf_counter()
    for name, default in _options().items():
        if name not in FREE and getattr(args, name) != default:
            raise TooLarge(
                f"{why}; --{name.replace('_', '-')} needs the diagram, without it certified bounds are given"
            )
    within, bounds = _within(args, tree), enclose(tree)
    if bounds is None and within is None:
        raise why
    low, high = (None, None) if bounds is None else bounds[:2]
    if low is not None and within is not None:
        low = max(low, within.lower() or 0.0)
    solve_s = time.perf_counter() - began
    return {
        "id": tree.name,
        "description": tree.description,
        "source": ", ".join(args.files),
        "gates": sum(not gate.inside for gate in tree.gates),
        "basic_events": len(tree.events),
        "probability": None,
        "probability_low": low,
        "probability_high": high,
        "minimal_cut_sets": within and cut_set_rows(within, LISTED, args.likeliest and bounds is not None),
        "importance": [],
        "structure": to_document(tree),
        "note": _not_exact(bounds, within),
        "seconds": {"read": read_s, "solve": solve_s, "total": solve_s + (read_s or 0)},
    }


def _within(args: Namespace, tree: FaultTree) -> Truncated | None:
    """The cut sets within the limits asked for, or up to the largest order that is quickly had, if there is one."""
    from safety.trees.cut_sets.truncated import largest_order, truncated

    if args.order is not None or args.above is not None:
        try:
            return truncated(tree, args.order, args.above)
        except TooLarge as why:
            print(f"rightside tree: {why}; those up to a lower order are given", file=sys.stderr)
    return largest_order(tree) if tree.is_monotone else None


def _not_exact(bounds: Enclosed | None, within: Truncated | None) -> str:
    """What the figures of a tree without a diagram are."""
    said = "no diagram fits the budget of nodes, and not every event has a probability"
    if bounds is not None:
        modules = f"{bounds.open_modules} modules have" if bounds.open_modules > 1 else "1 module has"
        said = f"certified bounds: {modules} no diagram within the budget of nodes"
    return said + ("; cut sets beyond the limits are not known" if within and not within.complete else "")


def _dynamic(args: Namespace, texts: list[bytes]) -> Entry | None:
    """The entry of a Galileo file with dynamic gates or with data in other files; None for any other."""
    if not any(b"toplevel" in text for text in texts):
        return None
    from safety.trees.formats.galileo import is_galileo, read_galileo

    places = [place for place, text in enumerate(texts) if is_galileo(text)]
    if len(places) != 1:
        return None
    began, file = time.perf_counter(), args.files[places[0]]
    others = [other for other in args.files if other != file]
    tree = read_galileo(texts[places[0]], file)
    if not tree.dynamic_elements and not others:
        return None
    from safety.trees.dynamic.data import static_with_data, with_data
    from safety.trees.formats.draft import at

    hours: Fraction | None = None if args.hours is None else exact(args.hours, "--hours")
    events = _data(others) if others else ()
    with at(", ".join(others) or file):
        known = with_data(tree, events) if tree.dynamic_elements else static_with_data(tree, events, hours)
    if isinstance(known, FaultTree):
        return _solved(args, known, time.perf_counter() - began)
    _refuse(args, "a dynamic tree; leave it out", "ties", "export", "curve", *UNCERTAIN)
    for path in args.export:
        if not path.lower().endswith(".dft"):
            raise CommandError(f"--export {path}: {file} holds a dynamic tree, which only .dft can hold")
        from safety.trees.formats.galileo import to_galileo

        write_text(path, to_galileo(known.tree))
        if not known.is_certain:
            print(f"{path}: this format holds no distributions, their means are written", file=sys.stderr)
    from safety.commands.tree_extras import extend_dynamic
    from safety.trees.dynamic.solve import solve_dynamic
    from safety.trees.dynamic.summary import dynamic_summary

    read_s, began = time.perf_counter() - began, time.perf_counter()
    with at(file):
        solution = solve_dynamic(known.tree, ties=args.ties)
    solve_s = time.perf_counter() - began
    source = ", ".join(args.files)
    entry = dynamic_summary(
        known.tree, hours, source=source, read_s=read_s, ties=args.ties, solution=solution, tags=known.sources
    )
    for key in ("solve", "total"):
        entry["seconds"][key] += solve_s
    errors = extend_dynamic(entry, args, solution, known)
    return entry | {"errors": errors} if errors else entry


def _data(files: list[str]) -> tuple[BasicEvent, ...]:
    """The basic events in files of data. Raises CommandError for files that hold more, or none."""
    from safety.trees.formats.files import read_study

    study = read_study(*files)
    kinds = ("gates", "event_trees", "ccf_groups", "substitutions", "alignments", "house_events")
    if more := [kind.replace("_", " ") for kind in kinds if getattr(study, kind)]:
        raise CommandError(
            f"{', '.join(files)}: beside a Galileo tree only the data of its basic events are read, but there are "
            f"{' and '.join(more)}; remove them"
        )
    if not study.events:
        raise CommandError(f"{', '.join(files)}: no basic event is defined; define those of the tree, by name")
    return study.events


def _events(args: Namespace, texts: list[bytes]) -> list[Entry]:
    """The entries of the event trees in the files, if there are any."""
    if not _holds(texts, EVENT_TREES):
        return []
    from safety.trees.formats.files import read_study

    study = read_study(*args.files, mission_time_h=args.hours)
    if not study.event_trees or (args.top and study.alignments):
        return []
    if args.top:
        return [_solved(args, study.quantified(args.top), None)]
    files = ", ".join(args.files)
    _refuse(args, "event trees; leave it out, or choose a fault tree by --top GATE", "export", *UNCERTAIN)
    if not any(one.event_tree for one in study.initiating_events):
        raise CommandError(f"{files}: no initiating event begins an event tree; define one, or give --top GATE")
    from safety.trees.event_trees.summary import answers_of, event_tree_entries

    errors = _exported(args, study)
    answers = answers_of(study)
    entries = event_tree_entries(study, answers, source=files)
    if args.uncertainty:
        from safety.commands.tree_extras import extend_sequences

        errors += extend_sequences(entries, args, answers, study.mission_time_h)
    return [entry | {"errors": errors} for entry in entries] if errors else entries


def _exported(args: Namespace, tree: FaultTree | Study) -> list[str]:
    if not args.export:
        return []
    from safety.commands.tree_extras import export

    return export(args.export, tree)


def _holds(texts: list[bytes], words: tuple[bytes, ...]) -> bool:
    return any(word in text for text in texts for word in words)


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
            raise CommandError(
                f"--{name.replace('_', '-')} is of a static fault tree, and {', '.join(args.files)} holds {what}"
            )
