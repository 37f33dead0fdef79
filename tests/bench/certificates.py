"""Certificates of the channel and voter family and of claims of TS-7: seconds to write, and to check by a stranger.

    python -m tests.bench.certificates [--cap 60] [--module ts7_window ...]

The check is `safety/prove/check.py` as a process of its own; the last column is its time by obligation.
"""

from __future__ import annotations

import argparse
import importlib
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from safety.prove import check
from safety.prove.certificate import write_certificate
from safety.prove.claims import PROVED, Claim, registered
from safety.prove.prove import prove
from tests.bench.machine import described
from tests.bench.races import SIZES, question

LINE = "{:<46}{:>12}{:>9}{:>9}{:>9}  {:<12}{:>12}"


def claims(modules: list[str]) -> Iterator[Claim]:
    """The family with its lemmas, then what the modules claim to be proved."""
    yield from (question(kind, *size, lemmas=True) for kind in ("single", "voter") for size in SIZES)
    for name in modules:
        importlib.import_module(f"proofs.{name}")
        yield from (c for c in registered() if c.id.startswith(f"{name}.") and c.expect == PROVED)


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cap", type=float, default=60.0, help="seconds for the bit-level proof of an obligation")
    parser.add_argument("--module", action="append", default=[])
    options = parser.parse_args()
    print(described())
    print(LINE.format("claim", "obligations", "prove s", "write s", "check s", "check", "s/obligation"))
    for claim in claims(options.module):
        found = prove(claim)
        if found.verdict != PROVED or found.problem is None:
            print(f"{claim.id:<46}{found.verdict}: {found.why}", flush=True)
            continue
        depth = int(found.method.partition("depth ")[2].partition(",")[0])
        with tempfile.TemporaryDirectory() as folder:
            written = write_certificate(found.problem, depth, Path(folder) / "claim.zip", timeout=options.cap)
            began = time.perf_counter()
            done = subprocess.run(
                [sys.executable, check.__file__, str(written.path)], capture_output=True, text=True, timeout=3600
            )
            seconds, count = time.perf_counter() - began, len(written.missing)
        verdict = next(name for name, code in check.EXIT.items() if code == done.returncode)
        times = [f"{s:.2f}" for s in (found.seconds, written.seconds, seconds)]
        print(LINE.format(claim.id, count, *times, verdict, f"{seconds / count:.2f}"), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
