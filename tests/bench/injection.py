"""Injections a second: our engines, vectors in C by gcc and clang, and Verilator, on the same faults, in one go.

    python -m tests.bench.injection [same] [rate] [cold] [exhaustive] [triples] [store]

By default `rate`, `cold` and `exhaustive`.  One core and its processor time, since a machine is seldom idle; `triples`
and `store` two cores and wall clock.  What each word does stands at its function, what the table says in README.md.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from safety.inject.engine import LANES, NEVER, Batch, Engine, Outcome, Task, engine_for
from safety.inject.native import NativeEngine
from safety.inject.native.program import source
from safety.inject.store import Store, open_executor, run_sharded
from safety.terms.llvm import AVX2, _object
from tests.bench.injection_c import NARROW, WIDE, VectorC
from tests.bench.injection_campaigns import campaign
from tests.bench.injection_limits import most_adds, vector_instructions
from tests.bench.injection_python import Python
from tests.bench.injection_task import FRAMES, at_random, one_second, same
from tests.bench.injection_verilator import Verilator
from tests.bench.machine import described

ROUNDS = 3
CORES = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []
LONG_S = 15.0
A_POINT = 512  # runs with a fault at each point


@dataclass
class Contestant:
    """An engine, its part of the faults, and the seconds of processor time that each run of it took."""

    name: str
    engine: Engine | VectorC | Verilator
    batch: Batch
    seconds: list[float] = field(default_factory=list)

    def run(self) -> Outcome:
        """Run it once more.  In C only the compiled loop counts, of Verilator the whole process."""
        before = processor()
        outcome = self.engine.run(self.batch)
        taken = processor() - before
        self.seconds.append(self.engine.seconds if isinstance(self.engine, VectorC) else taken)
        return outcome

    @property
    def rate(self) -> float:
        """Injections a second, the median."""
        return self.batch.runs / statistics.median(self.seconds)


def processor() -> float:
    """Seconds of processor time of this process and of its children that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(u.ru_utime + u.ru_stime for u in used)


def mixed(task: Task, seed: int = 1) -> Batch:
    """`A_POINT` runs with a fault at each point: all its bits in turn, stuck for ever or inverted for one frame."""
    pick = np.random.default_rng(seed)
    by_point: dict[str, list[int]] = {}
    for n, atom in enumerate(task.atoms):
        by_point.setdefault(atom.points[0], []).append(n)
    atoms = np.array([np.resize(numbers, A_POINT) for numbers in by_point.values()], np.int32).ravel()
    first = pick.integers(0, task.timing.frames, len(atoms), dtype=np.int32)
    flips = np.array(["flip" in atom.kind.name for atom in task.atoms])[atoms]
    return Batch(atoms[None], first[None], np.where(flips, first + 1, NEVER).astype(np.int32)[None])


def part(batch: Batch, runs: int, seed: int = 2) -> Batch:
    """So many runs of a batch, drawn."""
    chosen = np.sort(np.random.default_rng(seed).permutation(batch.runs)[:runs])
    return Batch(*(each[:, chosen] for each in (batch.atoms, batch.first, batch.end)))


# --- words ------------------------------------------------------------------------------------------------------------


def agree(folder: Path, runs: int = 1000) -> int:
    """`same`: random faults, up to three at once, for the whole second: how many engines differ from Python."""
    task = one_second()
    batch = at_random(task, runs, seed=1, most=3)
    began = time.perf_counter()
    expected = Python(task).run(batch)
    print(f"Python: {runs} runs of {FRAMES} frames in {time.perf_counter() - began:.0f} s")
    wrong = 0
    for name, build in {
        "native": lambda: NativeEngine(task),
        "native, nothing left out": lambda: NativeEngine(task, prune=False),
        "native, AVX2": lambda: NativeEngine(task, target=AVX2),
        "NumPy lanes": lambda: engine_for(task, LANES),
        **{
            f"C {wires}, {compiler}": partial(VectorC, task, folder, compiler, WIDE, wires, lanes, rows=3)
            for compiler in ("g++", "clang++")
            for wires, lanes in (("bytes", 64), ("masks", 64), ("slices", 512))
        },
        "Verilator": lambda: Verilator(task, folder),
    }.items():
        equal = same(build().run(batch), expected)
        wrong += not equal
        print(f"{name:<26} {'the same' if equal else 'DIFFERENT'}", flush=True)
    return wrong


def rate(folder: Path) -> int:
    """`rate`: the same faults on every engine; the first column is for all frames of all runs, but for `pruned`."""
    task = one_second()
    faults = mixed(task)
    some, few = part(faults, 4096), part(faults, 1024)
    rows = [
        Contestant("native, pruned", NativeEngine(task), faults),
        Contestant("native", NativeEngine(task, prune=False), faults),
        Contestant("native, AVX2", NativeEngine(task, prune=False, target=AVX2), faults),
        Contestant("NumPy lanes", engine_for(task, LANES), few),
        *(
            Contestant(f"C {wires}, {compiler}{', AVX2' if flags is NARROW else ''}",
                       VectorC(task, folder, compiler, flags, wires, lanes), faults)
            for flags, forms in ((WIDE, (("bytes", 64), ("masks", 64), ("slices", 512))),
                                 (NARROW, (("bytes", 32), ("slices", 256))))
            for compiler in ("clang++", "g++")
            for wires, lanes in forms
        ),
        Contestant("Verilator", Verilator(task, folder), some),
    ]  # fmt: skip
    ours, wrong = NativeEngine(task), 0
    for row in rows:
        right = same(row.run(), ours.run(row.batch))
        wrong += not right
        print(f"{row.name:<24} {'the same' if right else 'DIFFERENT'}", flush=True)
    quick = [row for row in rows if row.seconds[0] < LONG_S]  # of the others the first run counts
    for row in quick:
        row.seconds.clear()
    for _ in range(ROUNDS):
        for row in quick:
            row.run()
    print(f"\n| {'engine':<24} | injections | 1/s, median (least to greatest) | x Verilator | x C bytes | x best C |")
    print("|---|---|---|---|---|---|")
    for row in rows:
        least, most = row.batch.runs / max(row.seconds), row.batch.runs / min(row.seconds)
        narrow = [r for r in rows if r.name.startswith("C ") and ("AVX2" in r.name) == ("AVX2" in row.name)]
        best = max(r.rate for r in narrow)
        lanes = max(r.rate for r in narrow if "bytes" in r.name)
        print(
            f"| {row.name:<24} | {row.batch.runs} | {row.rate:,.0f} ({least:,.0f} to {most:,.0f}) "
            f"| {row.rate / rows[-1].rate:.2f} | {row.rate / lanes:.2f} | {row.rate / best:.2f} |"
        )
    limit(rows[1])
    return wrong


def limit(native: Contestant) -> None:
    """How many vector instructions of a step are done in a second, against the most additions of vectors there are."""
    if not (shutil.which("objdump") and isinstance(native.engine, NativeEngine)):
        return
    target, text = native.engine._masked.kernel.target, source(native.engine._masked.kernel)
    width = native.engine.target.lanes
    computing, moving = vector_instructions(_object(target, text), "faulty")
    most = most_adds("clang++" if shutil.which("clang++") else "g++", width)
    steps = -(-native.batch.runs // target.lanes) * FRAMES / statistics.median(native.seconds)
    print(
        f"\nvector limit: {most / 1e9:.1f} G additions of {width} bytes a second; a step of {target.lanes} runs "
        f"is {computing} vector instructions and {moving} moves, {steps / 1e6:.1f} M steps a second: "
        f"{computing * steps / most:.2f} of the limit ({(computing + moving) * steps / most:.2f} with the moves)"
    )


def cold(folder: Path) -> int:
    """`cold`: from the start of Python to the result of 1000 upsets, the compiled code kept from before or not."""
    code = "from tests.bench.injection_campaigns import campaign; campaign('a thousand upsets, drawn').inject().tally"
    for kept in (False, True):
        cpu, wall = [], []
        for again in range(ROUNDS + 1):
            cache = folder / ("kept" if kept else str(again))
            before, began = processor(), time.perf_counter()
            subprocess.run(
                [sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL,
                env={**os.environ, "XDG_CACHE_HOME": str(cache), "PYTHONPATH": os.pathsep.join(sys.path)},
            )  # fmt: skip
            cpu.append(processor() - before)
            wall.append(time.perf_counter() - began)
        where = "code kept from before" if kept else "nothing compiled yet"
        print(
            f"start to the result of 1000 injections, {where}: processor {statistics.median(cpu[1:]):.2f} s, "
            f"wall {statistics.median(wall[1:]):.2f} s"
        )
    return 0


def exhaustive(folder: Path) -> int:
    """`exhaustive`: whole campaigns, from their declaration to the table, on one core."""
    for name in ("every bit stuck", "every bit inverted at every frame", "all pairs of stuck bits"):
        for again in range(2):
            before, began = processor(), time.perf_counter()
            declared = campaign(name)
            result = declared.inject()
            classes, runs = result.tally.classes, len(declared.space)
            cpu, wall = processor() - before, time.perf_counter() - began
            if again:
                figures = f"processor {cpu:.2f} s, wall {wall:.2f} s, {runs / cpu:,.0f}/s"
                print(f"{name}: {runs} injections, {figures}, {classes}")
    return 0


def stored(folder: Path, name: str, cap: float) -> int:
    """A campaign on two processes into a store; stops after `cap` seconds with what is there."""
    declared, store = campaign(name), Store(folder)
    before, began = processor(), time.perf_counter()

    def progress(share: float, seconds: float) -> None:
        if seconds > cap:
            raise KeyboardInterrupt

    with open_executor("processes:2") as executor:
        kept = run_sharded(declared, partial(campaign, name), store, executor, progress=progress)
    wall = time.perf_counter() - began
    size = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
    print(
        f"{name}: {kept.made} of {kept.total} injections, wall {wall:.1f} s, "
        f"processor {processor() - before:.1f} s, {kept.made / wall:,.0f}/s, {size / 1e6:.1f} MB"
    )
    return 0 if kept.made == kept.total else 1


def triples(folder: Path) -> int:
    """`triples`: all triples of stuck bits."""
    return stored(folder, "all triples of stuck bits", cap=120)


def store(folder: Path) -> int:
    """`store`: 1e8 injections, kept on disk."""
    return stored(folder, "every bit inverted at every frame, many rides", cap=400)


WORDS: dict[str, Callable[[Path], int]] = {
    "same": agree, "rate": rate, "cold": cold, "exhaustive": exhaustive, "triples": triples, "store": store,
}  # fmt: skip
BY_DEFAULT = ("rate", "cold", "exhaustive")
ON_TWO_CORES = {"triples", "store"}


def main() -> int:
    """Do what was asked for, in order; 1 when outcomes differ, or a campaign was stopped before its end."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("words", nargs="*", choices=[*WORDS, []], default=BY_DEFAULT, metavar="WORD")
    print(described())
    wrong = 0
    for word in parser.parse_args().words:
        if hasattr(os, "sched_setaffinity"):
            os.sched_setaffinity(0, CORES[:2] if word in ON_TWO_CORES else CORES[:1])
        print(f"\n## {word}", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            wrong += WORDS[word](Path(folder))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
