"""Injections a second into a model with reals, a train that brakes: native code in doubles, and the exact lanes.

    python -m tests.bench.injection_reals

One core, its processor time; the same random faults at random steps, half of them for two seconds.  What native code
does alone stands beside what it does with the runs redone that its doubles did not decide.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from safety.inject.engine import NEVER, Batch, Outcome, Task
from safety.inject.lanes import LaneEngine
from safety.inject.native.enclosing import EnclosingEngine
from safety.inject.native.engine import NativeEngine
from tests.bench.machine import described
from tests.inject.real_systems import braking_train

FRAMES, RUNS, FEW, STAYS = 900, 20_000, 300, 20


def at_random(task: Task, runs: int) -> Batch:
    """Single faults."""
    rng = np.random.default_rng(1)
    atoms = rng.integers(0, len(task.atoms), (1, runs))
    first = rng.integers(0, FRAMES - STAYS, (1, runs))
    end = np.where(rng.random((1, runs)) < 0.5, NEVER, first + STAYS)
    return Batch(*(a.astype(np.int32) for a in (atoms, first, end)))


def timed(what: str, runs: int, run: Callable[[], Any]) -> Any:
    """Run something and print how fast it was."""
    before = time.process_time()
    found = run()
    taken = time.process_time() - before
    print(f"{what:44} {runs:6} runs {taken:7.2f} s {runs / taken:10,.0f} a second")
    return found


def main() -> None:
    """Print the table."""
    print(described())
    task = braking_train(FRAMES)
    batch = at_random(task, RUNS)
    few = Batch(*(a[:, :FEW] for a in (batch.atoms, batch.first, batch.end)))
    engine, whole = EnclosingEngine(task), EnclosingEngine(task, prune=False)
    for ready in (engine, whole):
        NativeEngine.run(ready, few)
    timed("native, before any is redone", RUNS, lambda: NativeEngine.run(engine, batch))
    timed("the same, nothing left out", RUNS, lambda: NativeEngine.run(whole, batch))
    ours: Outcome = timed("native, with the undecided redone", FEW, lambda: engine.run(few))
    print(engine.note)
    exact: Outcome = timed("NumPy lanes of exact fractions", FEW, lambda: LaneEngine(task).run(few))
    for name in task.watch:
        assert np.array_equal(ours.first[name], exact.first[name]), name


if __name__ == "__main__":
    main()
