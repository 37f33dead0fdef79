"""The native engine for models with reals: runs in doubles that enclose them, and in exact lanes where these part."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

from safety.inject.engine import NEVER, Batch, Outcome, Task
from safety.inject.lanes import LaneEngine
from safety.inject.native import sweep
from safety.inject.native.engine import NativeEngine
from safety.inject.native.program import WORDS
from safety.inject.native.reals import UNDECIDED, check_enclosed, exact_run
from safety.inject.space import CampaignError
from safety.system import ModelError
from safety.terms.llvm import Target, host

LANES = 16  # of doubles: more would be as fast, and take longer to compile


class EnclosingEngine(NativeEngine):
    """Runs batches of a task with reals; outcomes are those of the exact reading.

    A run with a comparison that its doubles do not decide is run again on the exact lanes; `redone` of `asked` runs
    were.  Raises as `NativeEngine` does, and `EnclosureError` when the fault-free run leaves its doubles.
    """

    def __init__(self, task: Task, *, prune: bool = True, target: Target | None = None) -> None:
        target = target or replace(host(), lanes=LANES)
        super().__init__(replace(task, watch=(*task.watch, UNDECIDED)), prune=prune, target=target, form=WORDS)
        self._given = task
        self.redone = self.asked = 0

    @property
    def note(self) -> str:
        """How many runs were redone."""
        return f"reals as enclosing doubles; {self.redone} of {self.asked} runs redone on exact lanes"

    @cached_property
    def _exact(self) -> LaneEngine:
        return LaneEngine(self._given)

    @cached_property
    def golden(self) -> Outcome:
        """See `NativeEngine`; checked against the exact run."""
        task = self._given
        try:
            exact = exact_run(self._masked, task.system, task.inputs, task.start)
        except ModelError as reason:
            raise CampaignError(f"the fault-free run: {reason}") from reason
        check_enclosed(self._masked, exact)
        found = self._masked.golden
        return self._exact.golden if found.first[UNDECIDED][0] != NEVER else self._shown(found)

    def _shown(self, found: Outcome) -> Outcome:
        """What the task asked for."""
        return Outcome(found.counts, {name: found.first[name] for name in self._given.watch})

    def run(self, batch: Batch) -> Outcome:
        """See `Engine`."""
        import numpy as np

        found = super().run(batch)
        again = np.flatnonzero(found.first[UNDECIDED] != NEVER)
        self.asked += batch.runs
        self.redone += len(again)
        shown = self._shown(found)
        if len(again):
            exact = self._exact.run(Batch(batch.atoms[:, again], batch.first[:, again], batch.end[:, again]))
            for name, counts in shown.counts.items():
                counts[:, again] = exact.counts[name]
            for name, first in shown.first.items():
                first[again] = exact.first[name]
        return shown

    def _run_masked(self, batch: Batch) -> Outcome:
        """Every run on its own: what a marked run would have shown at a point does not count."""
        return sweep.run(self._masked, batch, prune=self.prune)
