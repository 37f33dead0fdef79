"""A kernel compiled, with its fault-free run, and the runs of a batch on it."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

from safety.inject.engine import NEVER, NONE, Batch, Outcome, Task
from safety.inject.masks import Mask
from safety.inject.native.driver import ENTRY, PACKED, PARAMETERS, SUM, Driver, masking, recorder
from safety.inject.native.kernel import UNUSED, WORD, Kernel
from safety.inject.native.layout import LINE
from safety.inject.native.tapped import Tapped
from safety.terms.graph import BIT, Term
from safety.terms.llvm import Library, Target
from safety.terms.native import bytes_of
from safety.trace import initial_state

if TYPE_CHECKING:
    import numpy.typing as npt

    Array = npt.NDArray[Any]

POINTER, NUMBER = ctypes.c_void_p, ctypes.c_int64

Act = Mapping[str, Mask] | int  # what a fault does: masks at points, or the number of its switch


class Program:
    """Runs faults, given by their numbers in `acts`, on a system that can carry them.

    `stimulus` has each input of the model, a value a frame.
    """

    def __init__(
        self, task: Task, system: Tapped, acts: Sequence[Act], stimulus: Mapping[str, Array], target: Target
    ) -> None:
        wires = tuple(dict.fromkeys((*task.watch, *task.count)))
        counted = [wires.index(name) for name in task.count]
        self.task, self.acts, self._stimulus = task, acts, stimulus
        self.kernel = Kernel(system, wires, len(task.watch), counted, target)
        self._library = Library(source(self.kernel), target, keep=True)
        self._run = self._library.function("run", POINTER)

    # --- the fault-free run ----------------------------------------------------------------------------------------

    @cached_property
    def rows(self) -> Array:
        """The fault-free run, a record a step and one behind the last; see `layout.Row`."""
        import numpy as np

        kernel, system, t = self.kernel, self.kernel.tapped.system, self.task.timing
        total = t.frames * t.steps
        rows = np.zeros(total + 1, kernel.row.type)
        values, _ = initial_state(system, self.task.start)
        power_up = {s.path: value for s, value in zip(system.states, values, strict=True)}
        for i, s in enumerate(kernel.registers):
            rows[f"v{i}"][0] = power_up[s.path]
        chosen = self._choices(total)
        for i, name in enumerate(system.inputs, start=len(kernel.registers)):
            given = np.repeat(self._stimulus[name], t.steps) if name in self._stimulus else chosen[name]
            rows[f"v{i}"][:total] = given
        state, other, seen = (aligned(n) for n in (kernel.state.size, kernel.state.size, len(kernel.wires) * WORD))
        self._library.function("restore", POINTER, POINTER)(state.ctypes.data, rows.ctypes.data)
        golden = self._library.function("golden", POINTER, NUMBER, POINTER, POINTER, POINTER)
        golden(rows.ctypes.data, total, *(a.ctypes.data for a in (state, other, seen)))
        self._time(rows)
        return rows

    def _choices(self, total: int) -> Mapping[str, Array]:
        """What the faults built in choose, a value a step."""
        import numpy as np

        tapped = self.kernel.tapped
        several = total if tapped.changes is None else min(tapped.changes, total)
        said = [tapped.choices(step) for step in range(several)]
        return {
            name: np.pad(np.array([row[name] for row in said]), (0, total - several), mode="edge") for name in said[0]
        }

    def _time(self, rows: Array) -> None:
        """When frames and blocks end, and when a watched wire is true next."""
        import numpy as np

        t = self.task.timing
        total = t.frames * t.steps
        step = np.arange(total + 1)
        measured = step // t.steps - t.run_in
        ends = (step % t.steps == t.steps - 1) & (measured >= 0) & (step < total)
        rows["tally"] = ends * (1 + (measured % t.block == t.block - 1))
        rows["block"] = np.clip(measured // t.block, 0, t.blocks - 1)
        rows["frame"] = np.maximum(measured, 0)
        for i in range(self.kernel.watched):
            true = np.where(rows[f"wire{i}"][ends], np.arange(t.measured), NEVER)
            ahead = np.minimum.accumulate(true[::-1])[::-1]
            rows[f"next{i}"] = np.append(ahead, NEVER)[rows["frame"]]

    @cached_property
    def golden(self) -> Outcome:
        """The fault-free run, as an outcome of one run."""
        import numpy as np

        t, rows = self.task.timing, self.rows
        seen = {name: rows[f"wire{i}"][rows["tally"] > 0] for i, name in enumerate(self.kernel.wires)}
        counts = {n: seen[n].reshape(t.blocks, t.block).sum(axis=1, dtype=np.int32)[:, None] for n in self.task.count}
        return Outcome(counts, {name: rows[f"next{i}"][:1].copy() for i, name in enumerate(self.task.watch)})

    # --- batches ---------------------------------------------------------------------------------------------------

    def run(self, batch: Batch, *, prune: bool) -> Outcome:
        """Run a batch, its atoms being numbers in `acts`."""
        import numpy as np

        t, kernel, rows, golden = self.task.timing, self.kernel, self.rows, self.golden
        groups, column, atoms, first, end = arranged(batch, kernel.target.lanes)
        counts = np.empty((len(self.task.count), t.blocks, batch.runs), np.int32)
        for i, name in enumerate(self.task.count):
            counts[i] = golden.counts[name]
        came = np.full((kernel.watched, batch.runs + 1), NEVER, np.int32)
        entry, entries = self._entries
        taps = aligned(kernel.taps.size)
        taps[:] = self._passing
        given = {
            **{"groups": groups, "wide": len(atoms), "atoms": atoms, "first": first, "end": end, "column": column},
            **{"entry": entry, "entries": entries, "rows": rows, "total": t.frames * t.steps, "prune": prune},
            **{"state": aligned(kernel.state.size), "other": aligned(kernel.state.size)},
            **{"seen": aligned(len(kernel.wires) * WORD), "taps": taps, "passing": self._passing},
            **{"sums": aligned(max(len(kernel.counted), 1) * kernel.target.lanes * SUM)},
            **{"ever": aligned(len(kernel.wires) * WORD), "counts": counts, "came": came},
            **{"runs": batch.runs, "blocks": t.blocks},
        }
        addresses = [x.ctypes.data if isinstance(x := given[name], np.ndarray) else int(x) for name in PARAMETERS]
        self._run(np.array(addresses, np.int64).ctypes.data)
        return Outcome(
            {name: counts[i] for i, name in enumerate(self.task.count)},
            {name: came[i, :-1] for i, name in enumerate(self.task.watch)},
        )

    @cached_property
    def _entries(self) -> tuple[Array, Array]:
        """What each fault sets among the taps, as the driver reads it."""
        import numpy as np

        entry, entries = [0], [(0,) * len(ENTRY)]
        for act in self.acts:
            if isinstance(act, int):
                entries.append(self._entry(UNUSED, self.kernel.tapped.switches[act], Mask(0, 1)))
            else:
                pairs = self.kernel.tapped.masks
                entries += [self._entry(*pairs[point], mask) for point, mask in act.items()]
            entry.append(len(entries) - 1)
        return np.array(entry, np.int64), np.array(entries[1:] or entries, np.int64)

    def _entry(self, keep: Term, turn: Term, mask: Mask) -> tuple[int, ...]:
        offsets, packed = self.kernel.taps.offsets, self.kernel.target.packed
        size = PACKED if turn.sort == BIT and packed else bytes_of(turn)
        values = (-mask.keep, -mask.turn) if turn.sort == BIT and not packed else (mask.keep, mask.turn)
        return (*map(_signed, values), offsets[keep.uid], offsets[turn.uid], size)

    @cached_property
    def _passing(self) -> Array:
        """The taps without faults: masks that let everything pass, switches that are off."""
        block = aligned(self.kernel.taps.size)
        packed, lanes = self.kernel.target.packed, self.kernel.target.lanes
        for keep, _ in self.kernel.tapped.masks.values():
            start = self.kernel.taps.offsets[keep.uid]
            block[start : start + (lanes // 8 if packed and keep.sort == BIT else lanes * bytes_of(keep))] = 255
        return block


def source(kernel: Kernel) -> str:
    """LLVM text of everything that a kernel's runs need."""
    steps = [kernel.faulty(), kernel.healthy(), kernel.restore(), kernel.diverged(), kernel.record()]
    routines = [*steps, *masking(kernel), Driver(kernel).write(), recorder(kernel)]
    declared = sorted({d for routine in routines for d in routine.intrinsics})
    return "\n\n".join(["\n".join(declared), *(routine.text for routine in routines)]) + "\n"


def arranged(batch: Batch, lanes: int) -> tuple[int, Array, Array, Array, Array]:
    """The runs of a batch in groups: how many, the column of each lane, and its atoms, first steps and ends.

    Runs that begin together share a group, those whose faults stay apart from those whose faults pass.
    """
    import numpy as np

    none = batch.atoms == NONE
    first, end = np.where(none, NEVER, batch.first), np.where(none, NEVER, batch.end)
    stays = ((end == NEVER) & ~none).any(axis=0)
    key = stays.astype(np.int64) << 62 | first.min(axis=0).astype(np.int64) << 31 | batch.atoms[0] + 1
    order = np.argsort(key)
    groups = -(-batch.runs // lanes)
    padding = groups * lanes - batch.runs

    def padded(array: Array, filler: int) -> Array:
        width = [(0, 0)] * (array.ndim - 1) + [(0, padding)]
        return np.ascontiguousarray(np.pad(array[..., order], width, constant_values=filler), np.int32)

    column = padded(np.arange(batch.runs), batch.runs)
    return groups, column, padded(batch.atoms, NONE), padded(first, NEVER), padded(end, NEVER)


def aligned(size: int) -> Array:
    """Zeroed bytes from a whole line of the cache on."""
    import numpy as np

    whole = np.zeros(size + LINE, np.uint8)
    start = -whole.ctypes.data % LINE
    return whole[start : start + size]


def _signed(value: int) -> int:
    """A number of 64 bits as one with a sign."""
    value %= 1 << 64
    return value - (1 << 64) if value >> 63 else value
