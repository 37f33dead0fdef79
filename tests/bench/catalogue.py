"""All claims of TS-7 by the command itself: wall clock, processor time, median and greatest time of a claim.

    python -m tests.bench.catalogue [-k EXPRESSION] [-j N] [--slowest 10]

The command works on a copy of the project's texts in a temporary folder, without results of earlier runs.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.bench.machine import described

ROOT = Path(__file__).resolve().parents[2]
COMMAND = "import sys; from safety.commands import main; sys.exit(main(sys.argv[1:]))"


def main() -> int:
    """Print the figures; the command's exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-k", metavar="EXPRESSION")
    parser.add_argument("-j", metavar="N")
    parser.add_argument("--slowest", type=int, default=10)
    options = parser.parse_args()
    print(described())
    with tempfile.TemporaryDirectory() as folder:
        for name in ("models", "proofs"):
            shutil.copytree(ROOT / name, Path(folder) / name, ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(ROOT / "pyproject.toml", folder)
        results = Path(folder) / "results.json"
        words = ["prove", "--project", folder, "--no-cache", "--no-progress", "-q", "--json", str(results)]
        words += [w for flag, value in (("-k", options.k), ("-j", options.j)) if value for w in (flag, value)]
        before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-c", COMMAND, *words], cwd=folder, stdout=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )  # fmt: skip
        wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
        claims = json.loads(results.read_text(encoding="utf-8"))["claims"]
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    seconds = sorted(((c["seconds"], c["id"], c["verdict"]) for c in claims), reverse=True)
    taken = [s for s, _, _ in seconds]
    print(f"{len(claims)} claims, exit code {done.returncode}")
    print(f"wall {wall:.1f} s, processor {cpu:.1f} s, {cpu / wall:.2f} cores busy")
    print(f"a claim: median {statistics.median(taken):.2f} s, greatest {taken[0]:.2f} s, sum {sum(taken):.1f} s")
    for s, name, verdict in seconds[: options.slowest]:
        print(f"{s:>9.2f}  {verdict:<10} {name}")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
