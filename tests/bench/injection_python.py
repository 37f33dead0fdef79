"""An engine by the Python reading: one run after the other, each fault built in by `instrument`; slow and obvious."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from safety.faults import FROM_START, TRANSIENT, Fault, instrument, schedule
from safety.inject.engine import NEVER, NONE, Batch, Outcome, Task
from safety.trace import run
from tests.bench.injection_task import healthy


class Python:
    """One run after the other in Python."""

    def __init__(self, task: Task) -> None:
        self.task = task

    @cached_property
    def golden(self) -> Outcome:
        """The fault-free run."""
        return self.run(healthy())

    def run(self, batch: Batch) -> Outcome:
        """Run a batch."""
        task, timing = self.task, self.task.timing
        counts = {name: np.zeros((timing.blocks, batch.runs), np.int32) for name in task.count}
        seen = {name: np.full(batch.runs, NEVER, np.int32) for name in task.watch}
        for column in range(batch.runs):
            trace = self._trace([f for row in range(len(batch.atoms)) if (f := self._fault(batch, row, column))])
            for name, into in counts.items():
                into[:, column] = np.reshape(trace[name], (timing.blocks, timing.block)).sum(axis=1)
            for name, first in seen.items():
                first[column] = trace[name].index(True) if True in trace[name] else NEVER
        return Outcome(counts, seen)

    def _fault(self, batch: Batch, row: int, column: int) -> Fault | None:
        atom, first, end = (int(part[row, column]) for part in (batch.atoms, batch.first, batch.end))
        if atom == NONE:
            return None
        plain = replace(self.task.atoms[atom], name=f"row {row}")
        if (first, end) == (0, NEVER):
            return replace(plain, onset=FROM_START)
        return replace(plain, onset=TRANSIENT, at=first, ticks=min(end, self.task.timing.frames) - first)

    def _trace(self, faults: list[Fault]) -> dict[str, list[bool]]:
        """What is observed at the end of each measured frame."""
        task, timing = self.task, self.task.timing
        faulted = instrument(task.system, faults)
        choose = schedule(faulted)
        trace = run(
            replace(faulted.system, assumptions={}),
            lambda step: {**task.inputs(step // timing.steps), **choose(step)},
            timing.frames * timing.steps,
            start=task.start,
            keep=list(dict.fromkeys((*task.count, *task.watch))),
        )
        return {
            name: trace[name][timing.run_in * timing.steps + timing.steps - 1 :: timing.steps] for name in trace.columns
        }
