"""The NumPy engine: runs side by side as lanes of arrays; lane 0 is the fault-free run, each further lane a column.

Lanes that run together carry masks, and a few faults built in one by one (`MOST_BUILT_IN` of them) that no mask can
carry; masks change at the steps at which faults begin and end, and stand still between.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from safety.faults import schedule
from safety.inject.built_in import BuiltIn, Slot
from safety.inject.engine import NEVER, NONE, Batch, Outcome, Task
from safety.inject.kernel import BROKEN, Kernel, build_kernel
from safety.inject.masks import KEEP, TURN, Mask
from safety.inject.space import CampaignError
from safety.terms.table import is_object
from safety.terms.texts import lane_type
from safety.trace import initial_state

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Lanes = npt.NDArray[Any]
    Columns = npt.NDArray[np.int64]

MOST_LANES = 8192
MOST_BUILT_IN = 24


@dataclass(frozen=True)
class Chunk:
    """Columns of a batch that run side by side, and the faults built in for them."""

    columns: Columns
    slots: tuple[Slot, ...] = ()


class LaneEngine:
    """The NumPy lanes as an engine.

    `tick` is told, after each frame, the share of the batch that is done.  Raises `CampaignError` for a kind that does
    not fit its point, `ModelError` for a point that does not exist.
    """

    name, note = "lanes", ""

    def __init__(self, task: Task, most_lanes: int = MOST_LANES) -> None:
        self.task, self.most_lanes = task, most_lanes
        self.tick: Callable[[float], None] = lambda share: None
        self._rule = BuiltIn(task)
        self.masks = self._rule.masks
        self._kernels: dict[tuple[Slot, ...], Kernel] = {}
        self._golden: Outcome | None = None

    @property
    def golden(self) -> Outcome:
        """The fault-free run; see `Engine`."""
        if self._golden is None:
            import numpy as np

            self.run(Batch(*(np.empty((1, 0), dtype=np.int32) for _ in range(3))))
        assert self._golden is not None
        return self._golden

    def run(self, batch: Batch) -> Outcome:
        """Run a batch; see `Engine`.  Raises `CampaignError` when the fault-free run breaks an assumption."""
        import numpy as np

        task, runs = self.task, batch.runs
        counts: dict[str, Lanes] = {n: np.zeros((task.timing.blocks, runs), dtype=np.int32) for n in task.count}
        first: dict[str, Lanes] = {name: np.full(runs, NEVER, dtype=np.int32) for name in task.watch}
        built = self._built_in(batch)
        chunks = list(self._chunks(batch, built)) or [Chunk(np.empty(0, dtype=np.int64))]
        for done, chunk in enumerate(chunks):
            seen = self._run(batch, built, chunk, done / len(chunks), 1 / len(chunks))
            for name, array in counts.items():
                array[:, chunk.columns] = seen.counts[name][:, 1:]
            for name, array in first.items():
                array[chunk.columns] = seen.first[name][1:]
        return Outcome(counts, first)

    # --- what runs side by side ----------------------------------------------------------------------------------

    def _built_in(self, batch: Batch) -> Lanes:
        """Which faults of each run are built in."""
        import numpy as np

        bare = np.array([found is None for found in self.masks] + [False])  # the last stands for NONE
        built = bare[batch.atoms]
        for column in np.flatnonzero(built.any(axis=0)):
            for row, _ in self._rule.slots(batch.atoms[:, column].tolist()):
                built[row, column] = True
        return np.asarray(built)

    def _chunks(self, batch: Batch, built: Lanes) -> Iterator[Chunk]:
        """Runs with faults to build in come first; the others fill up their chunks and follow in their own."""
        import numpy as np

        special = built.any(axis=0)
        plain = np.flatnonzero(~special)
        for columns, slots in self._with_slots(batch, built, np.flatnonzero(special)):
            room = self.most_lanes - len(columns)
            yield Chunk(np.concatenate([columns, plain[:room]]), slots)
            plain = plain[room:]
        for k in range(0, len(plain), self.most_lanes):
            yield Chunk(plain[k : k + self.most_lanes])

    def _with_slots(self, batch: Batch, built: Lanes, columns: Columns) -> Iterator[tuple[Columns, tuple[Slot, ...]]]:
        import numpy as np

        chosen: list[int] = []
        slots: set[Slot] = set()
        for column in columns.tolist():
            more = {(row, int(batch.atoms[row, column])) for row in np.flatnonzero(built[:, column]).tolist()}
            wide, there = ({slot for slot in some if self._rule.wide[slot[1]]} for some in (more, slots))
            apart = bool(wide and there and wide != there)
            if chosen and (apart or len(slots | more) > MOST_BUILT_IN or len(chosen) >= self.most_lanes):
                yield np.array(chosen), tuple(sorted(slots))
                chosen, slots = [], set()
            chosen.append(column)
            slots |= more
        if chosen:
            yield np.array(chosen), tuple(sorted(slots))

    def _kernel(self, slots: tuple[Slot, ...]) -> Kernel:
        """The kernel with these faults built in, in the order of their rows; the one with masks only is kept."""
        if slots in self._kernels:
            return self._kernels[slots]
        task = self.task
        points = sorted({point for found in self.masks for point in found or ()})
        faults = [task.atoms[atom] for _, atom in slots]
        kernel = build_kernel(task.system, task.count, task.watch, points, faults, task.timing.steps)
        if task.timing.steps > 1 and kernel.faulted.draws:
            raise CampaignError(
                f"{next(iter(kernel.faulted.draws))} draws a value at each step, but a frame holds it for "
                f"{task.timing.steps} steps; use steps_per_frame=1"
            )
        if not slots:
            self._kernels[slots] = kernel
        return kernel

    # --- a run of all lanes --------------------------------------------------------------------------------------

    def _run(self, batch: Batch, built: Lanes, chunk: Chunk, before: float, share: float) -> Outcome:
        """Run a chunk; in the outcome lane 0 is the fault-free run, which is kept."""
        import numpy as np

        kernel, timing, lanes = self._kernel(chunk.slots), self.task.timing, 1 + len(chunk.columns)
        faults = _FaultLanes(kernel, self.masks, batch, built, chunk)
        choose = schedule(kernel.faulted)
        changes = _changes(kernel)
        state = _power_up(kernel, self.task.start, lanes)
        counts = {name: np.zeros((timing.blocks, lanes), dtype=np.int64) for name in self.task.count}
        fixed: tuple[Any, ...] = ()
        free: dict[str, Any] = {}
        for frame in range(timing.frames):
            step = frame * timing.steps
            if step == 0 or step in faults.events:
                fixed = kernel.prologue(*faults.at(step))
            if step < changes:
                free = choose(step)
            inputs = _input_lanes(kernel, {**self.task.inputs(frame), **free}, lanes)
            if frame == timing.run_in:
                for wait, came in kernel.waits.values():
                    state[wait], state[came] = np.zeros(lanes, dtype=np.int64), np.zeros(lanes, dtype=np.bool_)
            state = list(kernel.step(*state, *inputs, *fixed))
            for position in kernel.constant:
                state[position] = np.asarray(state[position])
            state[:1] = [np.broadcast_to(first, (lanes,)) for first in state[:1]]  # its length is that of all
            done = frame + 1 - timing.run_in
            if done >= 0 and done % timing.block == 0:
                for name, array in counts.items():
                    if done:
                        array[done // timing.block - 1] = state[kernel.counters[name]]
                    state[kernel.counters[name]] = np.zeros(lanes, dtype=np.int64)
            self.tick(before + share * (frame + 1) / timing.frames)
        if np.broadcast_to(state[kernel.counters[BROKEN]], (lanes,))[0]:
            raise CampaignError("the fault-free run breaks an assumption of the model: choose a stimulus that keeps it")
        first = {
            name: np.where(np.broadcast_to(state[came], lanes), state[wait], NEVER)
            for name, (wait, came) in kernel.waits.items()
        }
        seen = Outcome(
            {name: array.astype(np.int32) for name, array in counts.items()},
            {name: array.astype(np.int32) for name, array in first.items()},
        )
        if self._golden is None:
            alone = [{name: array[..., :1] for name, array in found.items()} for found in (seen.counts, seen.first)]
            self._golden = Outcome(*alone)
        return seen


def _changes(kernel: Kernel) -> int:
    """Up to which step the free choices of the faults that are built in change."""
    if kernel.faulted.draws:
        return NEVER
    return max((len(v) for fault in kernel.faulted.faults for v in (fault.values or {}).values()), default=1)


def _power_up(kernel: Kernel, start: Mapping[str, Any], lanes: int) -> list[Any]:
    import numpy as np

    states = kernel.faulted.system.states
    values, _ = initial_state(kernel.faulted.system, start)
    known = {s.path: value for s, value in zip(states, values, strict=True)}
    return [np.full(lanes, known.get(s.path, 0), dtype=lane_type(s.var)) for s in kernel.states]


class _FaultLanes:
    """Masks, and which built-in faults act, an array for each of `kernel.faults`; `events`: which lanes change when."""

    def __init__(
        self, kernel: Kernel, found: Sequence[Mapping[str, Mask] | None], batch: Batch, built: Lanes, chunk: Chunk
    ) -> None:
        import numpy as np

        self.masks, self.slots = found, {slot: i for i, slot in enumerate(chunk.slots)}
        self.names = [str(term.attr) for term in kernel.faults]
        self.atoms, self.first, self.end = (a[:, chunk.columns] for a in (batch.atoms, batch.first, batch.end))
        self.built = built[:, chunk.columns]
        sorts = {name: term.sort for term, name in zip(kernel.faults, self.names, strict=True)}
        self.passing: dict[str, Any] = {n: s.bounds[1] if n.endswith(KEEP) else 0 for n, s in sorts.items()}
        self.arrays = {
            name: np.full(1 + len(chunk.columns), self.passing[name], dtype=lane_type(term))
            for term, name in zip(kernel.faults, self.names, strict=True)
        }
        self.acting = self.names[len(self.names) - len(chunk.slots) :]
        self.events = self._events()

    def _events(self) -> dict[int, Columns]:
        """The columns of which some fault begins or ends, by step."""
        import numpy as np

        rows = [(np.where(self.atoms == NONE, NEVER, a)) for a in (self.first, self.end)]
        steps = np.concatenate([row.ravel() for row in rows])
        if not len(steps):
            return {}
        columns = np.tile(np.arange(self.atoms.shape[1]), 2 * self.atoms.shape[0])
        order = np.argsort(steps, kind="stable")
        found, starts = np.unique(steps[order], return_index=True)
        parts = np.split(columns[order], starts[1:])
        return {int(step): np.unique(part) for step, part in zip(found, parts, strict=True) if step != NEVER}

    def at(self, step: int) -> list[Lanes]:
        """The arrays from this step on; call it at each step of `events`, in order."""
        columns = self.events.get(step)
        if columns is not None:
            acts = (self.first[:, columns] <= step) & (step < self.end[:, columns])
            fresh: dict[str, Lanes] = {}  # copies, for a register may hold what it was given a step ago
            for lanes, found in self._masked(columns):
                for name in (point + which for point in found for which in (KEEP, TURN)):
                    fresh.setdefault(name, self.arrays[name].copy())[lanes] = self.passing[name]
            for lanes, found in self._masked(columns, acts):
                for point, mask in found.items():
                    keep, turn = fresh[point + KEEP], fresh[point + TURN]
                    keep[lanes] = keep[lanes] & mask.keep
                    turn[lanes] = turn[lanes] & mask.keep ^ mask.turn
            for (row, atom), i in self.slots.items():
                here = self.built[row, columns] & (self.atoms[row, columns] == atom)
                acting = self.acting[i]
                fresh.setdefault(acting, self.arrays[acting].copy())[1 + columns[here]] = acts[row, here]
            self.arrays |= fresh
        return [self.arrays[name] for name in self.names]

    def _masked(self, columns: Columns, acts: Lanes | None = None) -> Iterator[tuple[Columns, Mapping[str, Mask]]]:
        """For each row and atom its lanes among the columns, those that act only where `acts` is given."""
        import numpy as np

        for row in range(self.atoms.shape[0]):
            atoms = self.atoms[row, columns]
            by_mask = ~self.built[row, columns] & (atoms != NONE)
            chosen = by_mask if acts is None else by_mask & acts[row]
            for atom in np.unique(atoms[chosen]).tolist():
                yield 1 + columns[chosen & (atoms == atom)], self.masks[atom] or {}


def _input_lanes(kernel: Kernel, row: Mapping[str, Any], lanes: int) -> list[Any]:
    """Inputs of a frame: one number for all lanes, or an array where lanes hold objects."""
    import numpy as np

    return [
        np.full(lanes, row[str(term.attr)], dtype=object)
        if is_object(term.sort)
        else (np.bool_ if term.sort.kind == "bit" else np.int64)(row[str(term.attr)])
        for term in kernel.inputs
    ]
