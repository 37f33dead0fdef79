"""Uncertainty of fault trees side by side with SCRAM: 10 000 samples, whole process.

    python -m tests.bench.uncertainty [--samples 10000] [--limit 60] [--only NAME...]

The public trees of $RIGHTSIDE_ORACLES, each probability up to 1 % made lognormal of that mean with error factor 3. Ours
reads, solves, draws and evaluates in a process of its own; SCRAM's is `scram --bdd --probability 1 --uncertainty 1
-l 1`, without cut sets beyond order 1 to list. "passes" is the time of ours over the diagrams alone, also for each 1000
of their nodes, the best of five. The means of both must agree within 4 standard errors, else "DIFFERS" stands behind.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.bench.machine import described
from tests.bench.peers import program
from tests.oracles import SHARED

OURS = """
import json, sys
from safety.trees import read, solve
from safety.trees.uncertainty.propagation import Plan, propagate
found = propagate(solve(read(sys.argv[1])), Plan(int(sys.argv[2])))
print(json.dumps([found.mean, found.standard_error]))
"""
PASSES = """
import json, sys, time
from safety.trees import read, solve
from safety.trees.uncertainty.sampling import Draws, Plan, probabilities, variables
tree, samples = read(sys.argv[1]), int(sys.argv[2])
solution, passes = solve(tree), []
uniforms = Plan(samples).uniforms(sorted(variables(tree)))
columns = probabilities(tree, samples, lambda time: Draws(time, uniforms)).values
while len(passes) < 5 and sum(passes) < 5:
    began = time.perf_counter()
    solution.many(columns)
    passes.append(time.perf_counter() - began)
print(json.dumps([solution.nodes, len(uniforms), min(passes)]))
"""
UNCERTAIN = '<lognormal-deviate><float value="{}"/><float value="3"/><float value="0.95"/></lognormal-deviate>'
TREES = ("chinese", "das9206", "isp9605", "isp9606", "baobab1", "elf9601", "edfpa15p", "edfpa14p", "edf9201", "das9601")


def uncertain(text: str) -> str:
    """The tree with distributions for its probabilities up to 1 %."""
    return re.sub(
        r'<float value="([^"]+)"\s*/>',
        lambda found: UNCERTAIN.format(found[1]) if 0 < float(found[1]) <= 0.01 else found[0],
        text,
    )


def run(command: list[str], limit: float) -> tuple[float, str | None]:
    """Seconds and what was written, None at the limit."""
    began = time.perf_counter()
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit, check=True)
    except subprocess.TimeoutExpired:
        return limit, None
    return time.perf_counter() - began, done.stdout


def main() -> int:
    """Print a row for each tree."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=10_000)
    parser.add_argument("--limit", type=float, default=60)
    parser.add_argument("--only", nargs="+", default=TREES)
    args = parser.parse_args()
    scram = program("scram")
    print(described())
    print(
        f"{'tree':10}{'nodes':>8}{'variables':>10}{'passes ms':>10}{'/1000':>7}{'ours s':>8}{'scram s':>9}{'ratio':>8}"
    )
    ratios = []
    for name in args.only:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / f"{name}.xml"
            file.write_text(uncertain((SHARED / "fault_trees" / "aralia" / f"{name}.xml").read_text()))
            ours, written = run([sys.executable, "-c", OURS, str(file), str(args.samples)], args.limit)
            _, counted = run([sys.executable, "-c", PASSES, str(file), str(args.samples)], args.limit)
            options = f"--bdd --probability 1 --uncertainty 1 -l 1 --seed 1 --num-trials {args.samples}".split()
            theirs, report = run([scram, *options, str(file)], args.limit)
        if written is None or counted is None:
            print(f"{name:10} not within {args.limit:g} s")
            continue
        mean, error = json.loads(written)
        nodes, variables, passes = json.loads(counted)
        row = f"{name:10}{nodes:8}{variables:10}{1e3 * passes:10.1f}{1e6 * passes / nodes:7.1f}{ours:8.2f}"
        print(
            f"{row}{theirs:9.2f}{theirs / ours:8.1f}{'' if report else ' (limit)'}{_judged(report, mean, error)}",
            flush=True,
        )
        ratios.append(theirs / ours)
    print(f"geometric mean of the ratios {math.exp(sum(map(math.log, ratios)) / len(ratios)):.1f}")
    return 0


def _judged(report: str | None, mean: float, error: float) -> str:
    found = re.search(r'<mean value="([^"]+)"/>', report or "")
    return "" if found is None or abs(float(found[1]) - mean) < 4 * math.hypot(error, error) else f" DIFFERS {found[1]}"


if __name__ == "__main__":
    sys.exit(main())
