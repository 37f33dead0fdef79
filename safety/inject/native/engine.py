"""The engine: batches divided among programs, one for all faults that masks carry, others for faults built in."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

from safety.inject.built_in import BuiltIn, Slot
from safety.inject.engine import NEVER, NONE, Batch, Outcome, Task
from safety.inject.native import sweep
from safety.inject.native.excitation import Excitation, reduces
from safety.inject.native.program import AUTO, FORMS, Program
from safety.inject.native.tapped import tapped
from safety.inject.space import CampaignError
from safety.system import ModelError, nearest
from safety.terms.llvm import Target, host
from safety.terms.texts import compile_lanes, lane_type

if TYPE_CHECKING:
    import numpy.typing as npt

    Array = npt.NDArray[Any]

MOST_BUILT_IN = 64
MOST_PROGRAMS = 64  # kept, besides that of all masks
REDUCING_PAYS = 2**28  # runs times steps


class NativeEngine:
    """Runs batches of a task on native code; see `safety.inject.engine`.

    `prune=False` runs every group from the first step to the last with faults, whatever may be left out; the outcome is
    the same.  `form`: lanes as "words", as bits ("sliced"), or for each program what is cheaper ("auto").  Raises
    `TermError` for a model that has reals or numbers beyond 64 bits, `CampaignError` for a fault that does not fit its
    point, `ModelError` for an unknown form, `ImportError` without LLVM.
    """

    name = "native"

    @property
    def note(self) -> str:
        """What is worth saying about how it ran; nothing."""
        return ""

    def __init__(self, task: Task, *, prune: bool = True, target: Target | None = None, form: str = AUTO) -> None:
        if form not in FORMS:
            raise ModelError(f"form {form!r}; {nearest(form, FORMS)}")
        self.task, self.prune, self.target, self.form = task, prune, target or host(), form
        self._built_in = BuiltIn(task)
        self._masks = self._built_in.masks
        self._points = tuple(dict.fromkeys(point for found in self._masks for point in found or ()))
        self._excitations: dict[int, Excitation] = {}
        self._programs: dict[tuple[tuple[Slot, ...], bool], Program] = {}
        self._masked = Program(
            task,
            tapped(task.system, self._points),
            [found or {} for found in self._masks],
            lambda: self._stimulus,
            self.target,
            form=form,
        )

    @cached_property
    def _stimulus(self) -> Mapping[str, Array]:
        """Each input of the model, a value a frame: Python's numbers, for NumPy takes wide ones for floats."""
        import numpy as np

        rows = [self.task.inputs(frame) for frame in range(self.task.timing.frames)]
        return {name: np.array([row[name] for row in rows], object) for name in self.task.system.inputs}

    @cached_property
    def golden(self) -> Outcome:
        """The fault-free run, as an outcome of one run.

        Raises `CampaignError` when it breaks an assumption of the model.
        """
        import numpy as np

        kernel, rows = self._masked.kernel, self._masked.rows[:-1]
        lanes = [rows[f"v{i}"].astype(lane_type(term)) for i, term in enumerate(kernel.row.given)]
        for label, assumed in kernel.tapped.without_faults().assumptions.items():
            (holds,) = compile_lanes(kernel.row.given, [assumed])(*lanes)
            if not np.all(holds):
                raise CampaignError(
                    f"the fault-free run breaks the assumption {label!r} of the model at step {int(np.argmin(holds))}: "
                    "choose a stimulus that keeps it"
                )
        return self._masked.golden

    def run(self, batch: Batch) -> Outcome:
        """Run a batch; the order of its columns is free, and kept."""
        import numpy as np

        golden = self.golden
        bare = np.array([found is None for found in self._masks] + [False])  # the last stands for NONE
        special = bare[batch.atoms].any(axis=0)
        if not special.any():
            return self._run_masked(batch)
        counts = {name: np.repeat(array, batch.runs, axis=1) for name, array in golden.counts.items()}
        first = {name: np.full(batch.runs, NEVER, np.int32) for name in self.task.watch}
        for program, columns, atoms in self._parts(batch, special):
            part = Batch(atoms, batch.first[:, columns], batch.end[:, columns])
            seen = sweep.run(program, part, prune=self.prune)
            for name in counts:
                counts[name][:, columns] = seen.counts[name]
            for name in first:
                first[name][columns] = seen.first[name]
        return Outcome(counts, first)

    def _run_masked(self, batch: Batch) -> Outcome:
        """Run faults that masks carry; of several that stay only those that change something, and each run once."""
        import numpy as np

        order, timing = len(batch.atoms), self.task.timing
        work = batch.runs * timing.frames * timing.steps
        if not (self.prune and order in (2, 3) and work >= REDUCING_PAYS and reduces(batch)):
            return sweep.run(self._masked, batch, prune=self.prune)
        first = int(batch.first[batch.atoms != NONE][0])
        if first not in self._excitations:
            masks = [found or {} for found in self._masks]
            self._excitations[first] = Excitation(
                self.task, masks, first, lambda: self._stimulus, self.target, self.form
            )
        atoms = self._excitations[first].reduced(batch.atoms).astype(np.int64) + 1
        key = sum(row * (len(self.task.atoms) + 1) ** i for i, row in enumerate(atoms))
        _, chosen, which = np.unique(key, return_index=True, return_inverse=True)
        fewer = (atoms[:, chosen] - 1).astype(np.int32)
        steps = [np.full_like(fewer, step) for step in (first, NEVER)]
        seen = sweep.run(self._masked, Batch(fewer, *steps), prune=True)
        return Outcome(
            {name: array[:, which] for name, array in seen.counts.items()},
            {name: array[which] for name, array in seen.first.items()},
        )

    def _parts(self, batch: Batch, special: Any) -> Iterator[tuple[Program, Array, Array]]:
        """Programs with the columns that run on them, and the atoms of these columns as the program numbers them."""
        import numpy as np

        plain = np.flatnonzero(~special)
        if len(plain):
            yield self._masked, plain, batch.atoms[:, plain]
        columns = np.flatnonzero(special)
        kinds, which = np.unique(batch.atoms[:, columns], axis=1, return_inverse=True)
        which = which.ravel()
        slots = [self._built_in.slots(atoms) for atoms in kinds.T.tolist()]
        for chosen, built in _divided(slots, self._built_in.wide):
            carries = any(len(slots[kind]) < (kinds[:, kind] != NONE).sum() for kind in chosen)
            program = self._program(tuple(built), carries)
            number = {slot: len(self.task.atoms) + i for i, slot in enumerate(built)}
            local = kinds[:, chosen].copy()
            for position, kind in enumerate(chosen):
                for row, atom in slots[kind]:
                    local[row, position] = number[row, atom]
            place = np.full(kinds.shape[1], -1)
            place[chosen] = np.arange(len(chosen))
            here = place[which] >= 0
            yield program, columns[here], local[:, place[which[here]]]

    def _program(self, slots: tuple[Slot, ...], carries: bool) -> Program:
        """The program with these faults built in, in the order of their rows; with masks too where it `carries` any."""
        if (slots, carries) not in self._programs:
            faults = [self.task.atoms[atom] for _, atom in slots]
            system = tapped(self.task.system, self._points if carries else (), faults)
            acts = [*(found or {} if carries else {} for found in self._masks), *range(len(slots))]
            if len(self._programs) >= MOST_PROGRAMS:
                del self._programs[next(iter(self._programs))]
            made = Program(self.task, system, acts, lambda: self._stimulus, self.target, form=self.form)
            self._programs[slots, carries] = made
        return self._programs[slots, carries]


def _divided(slots: Sequence[list[Slot]], wide: Sequence[bool]) -> Iterator[tuple[list[int], list[Slot]]]:
    """Which runs go together, so that few faults have to be built in for them, and which these are."""
    chosen: list[int] = []
    built: set[Slot] = set()
    for i, more in enumerate(slots):
        alone, there = ({slot for slot in some if wide[slot[1]]} for some in (more, built))
        apart = bool(alone and there and alone != there)
        if chosen and (apart or len(built | set(more)) > MOST_BUILT_IN):
            yield chosen, sorted(built)
            chosen, built = [], set()
        chosen.append(i)
        built |= set(more)
    if chosen:
        yield chosen, sorted(built)
