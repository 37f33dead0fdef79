"""Fault trees side by side with SCRAM: exact probability and all minimal cut sets, whole process and kernel.

    python -m tests.bench.fault_trees [--quick] [--only NAME...] [--limit 60] [--rounds 3] [--listing]

Ours is `rightside tree FILE --json OUT`, SCRAM's `scram --bdd --probability 1 -l 1000 FILE -o OUT`, in turn; the median
of the rounds counts, and one that runs for more than five seconds or into the limit is not repeated. SCRAM writes all
cut sets, some of them millions, and we the smallest: it is stopped where its listing begins, unless `--listing` is
given. The kernels: our simplification, diagrams, probability and cut sets by order, in a process of its own after
reading, the best of three; SCRAM's the times that it reports for products and probability. A ratio is SCRAM's time by
ours. Trees: the public ones of $RIGHTSIDE_ORACLES, and those that come with SCRAM, whose mission time is 8760 h.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from tests.bench.machine import described
from tests.bench.peers import program
from tests.oracles import SHARED

ROOT = Path(__file__).resolve().parents[2]
ARALIA, INPUTS = SHARED / "fault_trees" / "aralia", Path("/usr/share/scram/input")
COMMAND = "import sys; from safety.commands import main; sys.exit(main(sys.argv[1:]))"
KERNEL = """
import json, sys, time
from safety.trees import read, solve
tree, times = read(*sys.argv[1:], mission_time_h=8760), []
while len(times) < 3 and sum(times) < 5:
    began = time.perf_counter()
    solution = solve(tree)
    solution.probability, solution.counts
    times.append(time.perf_counter() - began)
print(min(times))
"""
QUICK = ("chinese", "baobab1", "das9601", "edfpa15b", "elf9601", "isp9606")
WITH_SCRAM = {
    "scram: BSCU": ("BSCU/BSCU.xml",),
    "scram: CEA9601": ("CEA9601/CEA9601.xml", "CEA9601/CEA9601-basic-events.xml"),
    "scram: Chinese": ("Chinese/chinese.xml", "Chinese/chinese-basic-events.xml"),
    "scram: HIPPS": ("HIPPS/HIPPS.xml",),
    "scram: Lift": ("Lift/lift.xml",),
    "scram: SmallTree": ("SmallTree/SmallTree.xml",),
    "scram: Theatre": ("Theatre/theatre.xml",),
    "scram: ThreeMotor": ("ThreeMotor/three_motor.xml",),
    "scram: TwoTrain": ("TwoTrain/two_train.xml",),
    "scram: baobab1": ("Baobab/baobab1.xml", "Baobab/baobab1-basic-events.xml"),
    "scram: baobab2": ("Baobab/baobab2.xml", "Baobab/baobab2-basic-events.xml"),
    "scram: ne574": ("ne574/ne574.xml",),
}
LONG = 5.0  # seconds; a run as long as that is not repeated


@dataclass(frozen=True)
class Run:
    """What a process took, in seconds and MB, and what it found; `solved` is False at the limit or on an error."""

    solved: bool
    wall: float
    cpu: float
    peak: float
    kernel: float = math.nan
    probability: float = math.nan
    sets: int = -1


def trees() -> dict[str, list[Path]]:
    """The files of each tree."""
    found = {path.stem: [path] for path in sorted(ARALIA.glob("*.xml"))}
    own = {name: [INPUTS / file for file in files] for name, files in WITH_SCRAM.items()}
    return found | {name: files for name, files in own.items() if all(file.is_file() for file in files)}


def process(words: Sequence[str | Path], limit: float, here: bool = False) -> tuple[Run, str]:
    """Run a command for at most `limit` seconds; what it printed. `here` finds our package in this folder."""
    with tempfile.TemporaryFile("w+") as output:
        environment = {**os.environ, "PYTHONPATH": str(ROOT)} if here else None
        began = time.perf_counter()
        child = subprocess.Popen(
            words, stdout=output, stderr=subprocess.DEVNULL, start_new_session=True, env=environment
        )
        clock = threading.Timer(limit, os.killpg, (child.pid, signal.SIGKILL))
        clock.start()
        _, status, used = os.wait4(child.pid, 0)
        clock.cancel()
        wall = time.perf_counter() - began
        child.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        cpu, peak = used.ru_utime + used.ru_stime, used.ru_maxrss / 1024
        return Run(child.returncode == 0, min(wall, limit), cpu, peak), output.read()


def ours(files: Sequence[Path], out: Path, limit: float) -> Run:
    """Our command, as installed, else from the project's folder."""
    installed = program("rightside")
    start = [installed] if installed else [sys.executable, "-c", COMMAND]
    run, _ = process([*start, "tree", *files, "--hours", "8760", "--json", out], limit, here=not installed)
    if not run.solved:
        return run
    (entry,) = json.loads(out.read_text(encoding="utf-8"))["trees"]
    if entry["probability"] is None:  # bounds at best
        return replace(run, solved=False)
    alone, printed = process([sys.executable, "-c", KERNEL, *files], limit, here=True)
    return replace(
        run,
        kernel=float(printed) if alone.solved else math.nan,
        probability=entry["probability"],
        sets=entry["minimal_cut_sets"]["count"],
    )


def scram(files: Sequence[Path], out: Path, limit: float, listing: bool = False) -> Run:
    """SCRAM as its authors have it: BDD, exact probability, products of any order; its report goes through a pipe."""
    pipe, head = out.with_name("pipe"), [b""]
    os.mkfifo(pipe)
    reader = threading.Thread(target=_read, args=(pipe, head, listing), daemon=True)
    reader.start()
    words = [program("scram") or "scram", "--bdd", "--probability", "1", "-l", "1000", *files, "-o", pipe]
    run, _ = process(words, limit)
    with contextlib.suppress(OSError):  # if it never got as far as its report, this ends the wait for it
        os.close(os.open(pipe, os.O_WRONLY | os.O_NONBLOCK))
    reader.join()
    pipe.unlink()
    text = head[0].decode()
    found = re.search(r'<sum-of-products .*?products="(\d+)" probability="([^"]+)"', text)
    if found is None:
        return replace(run, solved=False)
    kernel = sum(map(float, re.findall(r"<(?:products|probability)>([^<]+)<", text)))
    return replace(run, solved=True, kernel=kernel, probability=float(found[2]), sets=int(found[1]))


def _read(pipe: Path, head: list[bytes], listing: bool) -> None:
    """Put the beginning of a report into `head`, up to the first product; then close, or read on and forget."""
    with pipe.open("rb", buffering=0) as report:
        while piece := report.read(1 << 16):
            if b"<product " not in head[0]:
                head[0] += piece
            elif not listing:
                return


def median(runs: Sequence[Run]) -> Run:
    """The run of the median wall clock."""
    return sorted(runs, key=lambda run: run.wall)[len(runs) // 2]


def side_by_side(files: Sequence[Path], limit: float, rounds: int, listing: bool) -> tuple[Run, Run]:
    """Both tools in turn."""
    tools = [ours, partial(scram, listing=listing)]
    runs: list[list[Run]] = [[], []]
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(rounds):
            for tool, done in zip(tools, runs, strict=True):
                if not done or (done[-1].solved and done[-1].wall < LONG):
                    done.append(tool(files, Path(folder, "out"), limit))
    return median(runs[0]), median(runs[1])


def agree(a: Run, b: Run) -> str:
    """Nothing, or what the two differ in; SCRAM prints six digits."""
    if not (a.solved and b.solved):
        return ""
    different = [] if math.isclose(a.probability, b.probability, rel_tol=5e-6) else ["probability"]
    different += [] if a.sets == b.sets else ["cut sets"]
    return f"DIFFERENT {' and '.join(different)}" if different else ""


def figures(pairs: dict[str, tuple[Run, Run]], limit: float) -> list[str]:
    """Ratios over all trees."""
    both = [pair for pair in pairs.values() if pair[0].solved and pair[1].solved]
    failed = [name for name, pair in pairs.items() if any(not run.solved and run.wall < limit for run in pair)]
    capped = [(own.wall, theirs.wall) for name, (own, theirs) in pairs.items() if name not in failed]
    walls = [theirs.wall / own.wall for own, theirs in both]
    kernels = [r for own, theirs in both if (r := theirs.kernel / own.kernel) > 0]
    worst = min(
        ((theirs.wall / own.wall, name) for name, (own, theirs) in pairs.items() if own.solved and theirs.solved)
    )
    lines = [
        f"{len(pairs)} trees; solved by us {sum(p[0].solved for p in pairs.values())}, "
        f"by SCRAM {sum(p[1].solved for p in pairs.values())}, by both {len(both)}"
        + (f"; no exact result: {', '.join(failed)}" if failed else ""),
        f"whole process, those both solve: median {statistics.median(walls):.2f}, "
        f"geometric mean {statistics.geometric_mean(walls):.2f}, worst {worst[0]:.2f} ({worst[1]}), "
        f"slower on {sum(r < 1 for r in walls)}",
        f"with time-outs as {limit:g} s: geometric mean {statistics.geometric_mean([t / o for o, t in capped]):.2f}",
        f"kernel, those both solve: median {statistics.median(kernels):.2f}, "
        f"geometric mean {statistics.geometric_mean(kernels):.2f}, worst {min(kernels):.2f}",
        f"together: ours {sum(o for o, _ in capped):.1f} s, SCRAM {sum(t for _, t in capped):.1f} s",
    ]
    return lines


def main() -> int:
    """Print the table and the figures; 1 where results differ."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help=f"only {', '.join(QUICK)}")
    parser.add_argument("--only", metavar="NAME", nargs="+")
    parser.add_argument("--limit", metavar="SECONDS", type=float, default=60.0)
    parser.add_argument("--rounds", metavar="N", type=int, default=3)
    parser.add_argument("--listing", action="store_true", help="let SCRAM write all cut sets, and count that")
    options = parser.parse_args()
    if program("scram") is None:
        print("scram is not installed; there is nothing to compare with")
        return 2
    chosen = options.only or (QUICK if options.quick else None)
    selected = {name: files for name, files in trees().items() if chosen is None or name in chosen}
    if not selected:
        print(f"none of these trees is in {ARALIA} or {INPUTS}; set RIGHTSIDE_ORACLES")
        return 2
    print(described())
    print(f"{'tree':<20}{'ours s':>8}{'SCRAM s':>9}{'ratio':>8}{'kernel':>9}{'SCRAM':>9}{'ratio':>8}"
          f"{'CPU':>7}{'SCRAM':>8}{'MB':>7}{'SCRAM':>7}  cut sets")  # fmt: skip
    pairs: dict[str, tuple[Run, Run]] = {}
    wrong = 0
    for name, files in selected.items():
        own, theirs = pairs[name] = side_by_side(files, options.limit, options.rounds, options.listing)
        said = agree(own, theirs)
        wrong += bool(said)
        print(
            f"{name:<20}{_seconds(own.wall, own)}{_seconds(theirs.wall, theirs, 9)}{_ratio(own, theirs)}"
            f"{own.kernel:>9.4f}{theirs.kernel:>9.4f}{theirs.kernel / own.kernel:>8.2f}"
            f"{own.cpu:>7.2f}{theirs.cpu:>8.2f}{own.peak:>7.0f}{theirs.peak:>7.0f}  {own.sets} {said}".rstrip(),
            flush=True,
        )
    print(*figures(pairs, options.limit), sep="\n")
    return 1 if wrong else 0


def _seconds(seconds: float, run: Run, width: int = 8) -> str:
    return f"{seconds:>{width}.3f}" if run.solved else f"{'> ' + format(seconds, '.0f'):>{width}}"


def _ratio(own: Run, theirs: Run) -> str:
    sign = "" if own.solved and theirs.solved else ">=" if own.solved else "<="
    return f"{sign + format(theirs.wall / own.wall, '.2f'):>8}"


if __name__ == "__main__":
    sys.exit(main())
