"""Unbounded proofs of the channel and voter family: ours against other tools, whole processes under one cap.

    python -m tests.bench.channel_voter [--cap 60] [--lemmas none|asserted|assumed] [--only single] [--control]

`--lemmas`: without help; the same lemmas to all, to be shown along with the claim; or to the others as constraints.
`--control`: a time far too short, so that every tool has to find the violation: the exported files mean what they say.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from safety.prove.problem import build_problem
from tests.bench.machine import described
from tests.bench.peers import BROKEN, LATE, PEERS, PROVED, Peer, Time, assumed, timed
from tests.bench.races import SIZES, question, ticks_for

LINE = "{:<8}{:>6}{:>7}{:>8}  {:<22}{:<14}{:>9}{:>9}  {}"
CONTROL = 10  # ticks


def ours(kind: str, width: int, margin: int, lemmas: bool, ticks: int | None, cap: float) -> Time:
    """Our proof as a process of its own."""
    words = ["-m", "tests.bench.races", kind, str(width), str(margin), *(["--lemmas"] if lemmas else [])]
    words += ["--ticks", str(ticks)] if ticks else []
    itself = Peer("rightside", (sys.executable,), lambda _: "", ((sys.executable, *words),), r"^proved", r"^refuted")
    with tempfile.TemporaryDirectory() as folder:
        return timed(itself, build_problem(question(kind, width, margin, lemmas, ticks)), cap, Path(folder))


def ratio(theirs: Time, own: Time, wanted: str) -> str:
    """How many times as long as ours; a lower bound when it was stopped, nothing without a verdict on both sides."""
    if own.verdict != wanted:
        return "-"
    if theirs.verdict == wanted:
        return f"{theirs.seconds / own.seconds:.1f}"
    return f">= {theirs.seconds / own.seconds:.1f}" if theirs.verdict == LATE else "-"


def asked_for(peer: Peer, names: list[str] | None, control: bool) -> bool:
    """Whether a tool takes part: those that were named, and one that only searches only where there is something."""
    return (not names or any(name in peer.name for name in names)) and (control or bool(peer.proved))


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cap", type=float, default=60.0, help="seconds of processor time for a process")
    parser.add_argument("--lemmas", choices=["none", "asserted", "assumed"], default="none")
    parser.add_argument("--only", choices=["single", "voter"])
    parser.add_argument("--peer", action="append", help="only tools whose name contains this")
    parser.add_argument("--control", action="store_true")
    options = parser.parse_args()
    help_, wanted = options.lemmas != "none", BROKEN if options.control else PROVED
    print(f"{described()}; cap {options.cap:g} s; lemmas: {options.lemmas}; wanted: {wanted}")
    print(LINE.format("model", "bits", "margin", "T", "tool", "verdict", "cpu s", "wall s", "ratio to ours"))
    for kind in [options.only] if options.only else ["single", "voter"]:
        for width, margin in SIZES:
            ticks = CONTROL if options.control else None
            lead = kind, width, margin, ticks or ticks_for(width, margin)
            own = ours(kind, width, margin, help_, ticks, options.cap)
            print(LINE.format(*lead, "rightside", own.verdict, f"{own.seconds:.2f}", f"{own.wall:.2f}", ""), flush=True)
            problem = build_problem(replace(question(kind, width, margin, help_, ticks), witness=None))
            problem = assumed(problem) if options.lemmas == "assumed" else problem
            for peer in PEERS:
                if asked_for(peer, options.peer, options.control):
                    with tempfile.TemporaryDirectory() as folder:
                        their = timed(peer, problem, options.cap, Path(folder))
                    print(
                        LINE.format(
                            *lead,
                            peer.name,
                            their.verdict,
                            f"{their.seconds:.2f}",
                            f"{their.wall:.2f}",
                            ratio(their, own, wanted),
                        ),
                        flush=True,
                    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
