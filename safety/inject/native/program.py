"""A kernel compiled, with its fault-free run, and the runs of a batch on it."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

from safety.inject.engine import NEVER, NONE, Batch, Outcome, Task
from safety.inject.masks import Mask
from safety.inject.native.driver import PARAMETERS, SUM, Driver, recorder
from safety.inject.native.kernel import UNUSED, Kernel
from safety.inject.native.layout import LINE, lane_bytes
from safety.inject.native.masking import ENTRY, PACKED, masking
from safety.inject.native.planes import Planes
from safety.inject.native.reals import UNDECIDED, enclosed, stimulus_in_doubles
from safety.inject.native.tapped import Tapped
from safety.terms.column_bits import size_of
from safety.terms.graph import BIT, Term
from safety.terms.llvm import Library, Target
from safety.terms.native import bytes_of
from safety.trace import initial_state

if TYPE_CHECKING:
    import numpy.typing as npt

    Array = npt.NDArray[Any]

AUTO, WORDS, SLICED = FORMS = ("auto", "words", "sliced")  # how lanes are kept: words, bits, or what is cheaper
SELDOM = '!0 = !{!"branch_weights", i32 1, i32 2000}'  # what a branch that is seldom taken refers to
POINTER, NUMBER = ctypes.c_void_p, ctypes.c_int64

Act = Mapping[str, Mask] | int  # what a fault does: masks at points, or the number of its switch


class Stretch(NamedTuple):
    """What runs showed in a stretch of time, as differences from the fault-free run, and how they stand at its end.

    `counts`: (wires, blocks, runs) from block `block` on; `came`: (watched, runs), the first true measured frame;
    `records`: the lanes, in words of 64 bits; `apart`: whether they differ from the fault-free run.
    """

    block: int
    counts: Array
    came: Array
    records: Array
    apart: Array


class Program:
    """Runs faults, given by their numbers in `acts`, on a system that can carry them.

    `stimulus` gives each input of the model, a value a frame.
    """

    def __init__(
        self,
        task: Task,
        system: Tapped,
        acts: Sequence[Act],
        stimulus: Callable[[], Mapping[str, Array]],
        target: Target,
        recorded: Sequence[str] = (),
        form: str = AUTO,
    ) -> None:
        wires = tuple(dict.fromkeys((*task.watch, *task.count)))
        counted = [wires.index(name) for name in task.count]
        if UNDECIDED in wires:
            exact, given = system.system, stimulus
            system = in_doubles = enclosed(system, wires, task.start)
            task = replace(task, start={})
            stimulus = lambda: stimulus_in_doubles(exact.inputs, given(), in_doubles.scales)  # noqa: E731
        self.task, self.acts, self._stimulus = task, acts, stimulus
        self.kernel = Kernel(system, wires, len(task.watch), counted, target, recorded)
        if form == SLICED or (form == AUTO and self.kernel.slices_pay):
            target = target.in_slices()
            self.kernel = Planes(system, wires, len(task.watch), counted, target, recorded)
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
        if kernel.recorded_words:
            rows["record"][0] = kernel.to_record([power_up[s.path] for s in kernel.registers])
        stimulus, chosen = self._stimulus(), self._choices(total)
        for i, name in enumerate(kernel.inputs, start=len(kernel.registers)):
            rows[f"v{i}"][:total] = np.repeat(stimulus[name], t.steps) if name in stimulus else chosen[name]
        state, other, seen = (
            aligned(n) for n in (kernel.state.size, kernel.state.size, len(kernel.wires) * kernel.word)
        )
        self._library.function("restore", POINTER, POINTER)(state.ctypes.data, rows.ctypes.data)
        golden = self._library.function("golden", POINTER, NUMBER, POINTER, POINTER, POINTER, POINTER)
        golden(rows.ctypes.data, total, *(a.ctypes.data for a in (state, other, seen, self._passing)))
        if kernel.recorded_words:
            for i in range(len(kernel.registers)):
                rows[f"v{i}"] = kernel.from_records(rows["record"], i)
        self._time(rows)
        return rows

    def _choices(self, total: int) -> Mapping[str, Array]:
        """What the faults built in choose, a value a step."""
        import numpy as np

        tapped = self.kernel.tapped
        several = total if tapped.changes is None else min(tapped.changes, total)
        said = [tapped.choices(step) for step in range(several)]
        return {
            name: np.pad(np.array([row[name] for row in said], object), (0, total - several), mode="edge")
            for name in said[0]
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

    def kept(self, step: int, blank: Callable[[str], bool] = lambda register: False) -> Array:
        """The lane of the fault-free run before a step, some registers at 0, as a record in words of 64 bits."""
        rows, registers = self.rows, self.kernel.registers
        return self.kernel.to_record([not blank(s.path) and int(rows[f"v{i}"][step]) for i, s in enumerate(registers)])

    @cached_property
    def golden(self) -> Outcome:
        """The fault-free run, as an outcome of one run."""
        import numpy as np

        t, rows = self.task.timing, self.rows
        seen = {name: rows[f"wire{i}"][rows["tally"] > 0] for i, name in enumerate(self.kernel.wires)}
        counts = {n: seen[n].reshape(t.blocks, t.block).sum(axis=1, dtype=np.int32)[:, None] for n in self.task.count}
        return Outcome(counts, {name: rows[f"next{i}"][:1].copy() for i, name in enumerate(self.task.watch)})

    # --- runs ------------------------------------------------------------------------------------------------------

    def stretch(
        self, runs: Batch, start: int, stop: int, *, kept: Array | None = None, keep: bool = False, prune: bool = True
    ) -> Stretch:
        """Run faults, their atoms being numbers in `acts`, from step `start` to before step `stop`.

        The first runs go on from the lanes `kept`, a record each; the others begin with their first fault, and without
        `prune` at step 0.  With `keep` the lanes are kept again.
        """
        import numpy as np

        kernel, lanes = self.kernel, self.kernel.target.lanes
        going_on = 0 if kept is None else len(kept)
        before = self._whole_groups(np.arange(going_on)), self._whole_groups(np.arange(going_on, runs.runs))
        column = np.concatenate(before)
        known = column >= 0
        groups = len(column) // lanes
        first, last = (int(self.rows["block"][step]) for step in (start, stop - 1))
        columns = runs.runs + 1  # the last is of lanes that have no run
        counts = np.zeros((len(kernel.counted), last + 1 - first, columns), np.int32)
        came = np.full((kernel.watched, columns), NEVER, np.int32)
        words = kernel.words
        records = np.zeros((len(column) if keep else 0, words), np.uint64)
        taken = np.zeros((len(before[0]), words), np.uint64)
        if kept is not None and going_on:
            taken[:going_on], taken[going_on:] = kept, kept[-1]
        apart = np.zeros((groups, kernel.word // 8), np.uint64)
        block, taps = (aligned(kernel.state.size) for _ in range(2)), aligned(kernel.taps_size)
        taps[:] = self._passing
        wires, (entry, entries) = len(kernel.wires), self._entries
        given: dict[str, Any] = {
            **{"groups": groups, "going_on": len(taken) // lanes, "start": start, "stop": stop, "prune": prune},
            **{"wide": len(runs.atoms), "column": np.where(known, column, runs.runs).astype(np.int32)},
            **{
                n: _chosen(getattr(runs, n), column, none)
                for n, none in (("atoms", NONE), ("first", NEVER), ("end", NEVER))
            },
            **{"entry": entry, "entries": entries, "rows": self.rows, "taps": taps, "passing": self._passing},
            **{"before": taken, "after": records if keep else 0, "apart": apart},
            **dict(zip(("state", "other"), block, strict=True)),
            **{
                "seen": aligned(wires * kernel.word),
                "ever": aligned(wires * kernel.word),
                "up": aligned(wires * kernel.word),
                "sums": aligned(wires * lanes * SUM),
            },
            **{"counts": counts.ctypes.data - 4 * first * columns, "came": came},
            **{"columns": columns, "blocks": counts.shape[1]},
        }
        addresses = [x.ctypes.data if isinstance(x := given[name], np.ndarray) else int(x) for name in PARAMETERS]
        parameters = np.array(addresses, np.int64)
        self._run(parameters.ctypes.data)
        bits = (
            np.unpackbits(apart.view(np.uint8), bitorder="little").reshape(groups, 8 * kernel.word)[:, :lanes].ravel()
        )
        if keep:
            records[bits == 0] = self.kept(stop)
        return Stretch(first, counts[:, :, :-1], came[:, :-1], records[known] if keep else records, bits[known] > 0)

    def _whole_groups(self, columns: Array) -> Array:
        """Columns filled up to whole groups by -1."""
        import numpy as np

        return np.pad(columns, (0, -len(columns) % self.kernel.target.lanes), constant_values=-1)

    @cached_property
    def _entries(self) -> tuple[Array, Array]:
        """What each fault sets among the taps, as the driver reads it."""
        import numpy as np

        entry, entries = [0], [(0,) * len(ENTRY)]
        for act in self.acts:
            if isinstance(act, int):
                entries.append(self._entry(UNUSED, self.kernel.tapped.switches[act], Mask(0, 1), ""))
            else:
                pairs = self.kernel.tapped.masks
                entries += [self._entry(*pairs[point], mask, point) for point, mask in act.items()]
            entry.append(len(entries) - 1)
        return np.array(entry, np.int64), np.array(entries[1:] or entries, np.int64)

    def _entry(self, keep: Term, turn: Term, mask: Mask, point: str) -> tuple[int, ...]:
        offsets, packed = self.kernel.taps.offsets, self.kernel.target.packed
        at = offsets[keep.uid], offsets[turn.uid]
        if self.kernel.target.sliced:
            return (_signed(mask.keep), _signed(mask.turn), *at, size_of(turn.sort), self.kernel.flags[point])
        size = PACKED if turn.sort == BIT and packed else bytes_of(turn)
        values = (-mask.keep, -mask.turn) if turn.sort == BIT and not packed else (mask.keep, mask.turn)
        return (*map(_signed, values), *at, size, self.kernel.flags[point])

    @cached_property
    def _passing(self) -> Array:
        """The taps without faults: masks that let everything pass, switches that are off."""
        block = aligned(self.kernel.taps_size)
        for keep, _ in self.kernel.tapped.masks.values():
            start = self.kernel.taps.offsets[keep.uid]
            block[start : start + lane_bytes(keep, self.kernel.target)] = 255
        return block


def source(kernel: Kernel) -> str:
    """LLVM text of everything that a kernel's runs need."""
    steps = [*kernel.steps(), kernel.restore(), kernel.diverged(), kernel.record()]
    steps += [kernel.give(), kernel.take(), *kernel.helpers()]
    routines = [*steps, *masking(kernel), Driver(kernel).write(), recorder(kernel)]
    declared = sorted({d for routine in routines for d in routine.intrinsics})
    return "\n\n".join(["\n".join(declared), *(routine.text for routine in routines), SELDOM]) + "\n"


def _chosen(array: Array, columns: Array, filler: int) -> Array:
    """Columns of an array, a filler where there is none."""
    import numpy as np

    return np.ascontiguousarray(np.where(columns >= 0, array[:, columns], filler), np.int32)


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
