"""An engine by a C++ compiler: the text of `injection_text`, compiled to a library of its own."""

from __future__ import annotations

import ctypes
import itertools
import platform
import subprocess
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import numpy.typing as npt

from safety.inject.engine import NEVER, NONE, Batch, Outcome, Task
from tests.bench.injection_slices import Slices
from tests.bench.injection_task import healthy, sites, stimulus
from tests.bench.injection_text import Writer

WIDE = ("-march=native",)  # registers of 64 bytes where there are
NARROW = (*WIDE, *(["-mno-avx512f"] if platform.machine() in ("x86_64", "AMD64") else []))  # of 32
ALIGNED = {"clang++": ("-mstackrealign",)}  # else what it keeps on the stack lies across lines of the cache
Array = npt.NDArray[np.generic]


@dataclass(frozen=True)
class Packed:
    """Runs sorted by the points of their faults, 64 side by side: arrays of shape (batches, rows, 64)."""

    columns: npt.NDArray[np.int64]  # of the batch, -1 where a place is left empty; shape (batches, 64)
    sites: npt.NDArray[np.int32]  # shape (batches, rows)
    keeps: npt.NDArray[np.uint8]
    turns: npt.NDArray[np.uint8]
    firsts: npt.NDArray[np.int32]
    ends: npt.NDArray[np.int32]


class VectorC:
    """Runs side by side in one core, compiled in a folder by `compiler` with `flags`.

    `wires`: `bytes`, `masks` (AVX-512) or `slices`; `lanes` go with the width of a register, 64 or 512 for 64 bytes.
    """

    def __init__(
        self, task: Task, folder: Path, compiler: str = "g++", flags: Sequence[str] = WIDE, wires: str = "bytes",
        lanes: int = 64, rows: int = 1,
    ) -> None:  # fmt: skip
        assert task.timing.steps == 1, "a frame is a step here"
        self.task, self.rows, self.lanes = task, rows, lanes
        points, found = sites(task)
        wire = np.array([task.system.points[points[site]].sort.kind == "bit" for site, _ in found] + [False])
        self._site = np.array([site for site, _ in found] + [NONE], np.int32)
        keep, turn = (
            np.array([getattr(m, of) for _, m in found] + [none]) for of, none in (("keep", 255), ("turn", 0))
        )
        self._keep, self._turn = (np.where(wire, 255 * (x & 1), x).astype(np.uint8) for x in (keep, turn))
        self._inputs = [np.array(values, np.int32) for values in stimulus(task).values()]
        own = Path(tempfile.mkdtemp(dir=folder))  # a library is known to the loader by its name
        source, library = own / "lanes.cpp", own / "lanes.so"
        writer = Slices(task, rows) if wires == "slices" else Writer(task, rows)
        source.write_text(writer.program(lanes, wires), encoding="utf-8")
        words = [
            compiler,
            "-O3",
            *ALIGNED.get(compiler, ()),
            *flags,
            "-w",
            "-shared",
            "-fPIC",
            "-o",
            str(library),
            str(source),
        ]
        subprocess.run(words, check=True, timeout=300)
        self.seconds = 0.0  # of processor time, in the compiled code, of the last batch
        self._run = ctypes.CDLL(str(library)).run

    @cached_property
    def golden(self) -> Outcome:
        """The fault-free run."""
        return self.run(healthy(self.rows))

    def run(self, batch: Batch) -> Outcome:
        """Run a batch of `rows` rows."""
        return self.outcome(self.packed(batch), batch.runs)

    def packed(self, batch: Batch) -> Packed:
        """The runs of a batch in the order of their points, filled up to 64 for each."""
        where = self._site[batch.atoms]
        order = np.lexsort(where[::-1])
        changes = np.flatnonzero(np.any(np.diff(where[:, order], axis=1) != 0, axis=0)) + 1
        edges = np.concatenate([[0], changes, [batch.runs]])
        columns = np.concatenate(
            [
                np.concatenate([order[a:b], np.full(-(b - a) % self.lanes, -1)]).reshape(-1, self.lanes)
                for a, b in itertools.pairwise(edges)
            ]
        )

        def spread(values: Array) -> Array:
            return np.ascontiguousarray(np.moveaxis(values[:, columns], 0, 1))

        atoms = np.where(columns < 0, NONE, spread(batch.atoms).swapaxes(0, 1)).swapaxes(0, 1)
        return Packed(
            columns, np.ascontiguousarray(self._site[batch.atoms][:, columns[:, 0]].T), self._keep[atoms],
            self._turn[atoms], spread(batch.first), spread(batch.end),
        )  # fmt: skip

    def outcome(self, packed: Packed, runs: int) -> Outcome:
        """Run what has been packed."""
        task, batches = self.task, len(packed.columns)
        counts = np.zeros((batches, len(task.count), task.timing.blocks, self.lanes), np.int32)
        seen = np.full((batches, len(task.watch), self.lanes), NEVER, np.int32)
        arrays = (packed.sites, packed.keeps, packed.turns, packed.firsts, packed.ends, counts, seen, *self._inputs)
        began = time.process_time()
        self._run(batches, *(ctypes.c_void_p(a.ctypes.data) for a in arrays))
        self.seconds = time.process_time() - began
        there = packed.columns >= 0
        where = packed.columns[there]

        def back(values: Array, shape: tuple[int, ...]) -> Array:
            result = np.empty((*shape, runs), np.int32)
            result[..., where] = np.moveaxis(values, 0, -2)[..., there]
            return result

        return Outcome(
            {name: back(counts[:, n], (task.timing.blocks,)) for n, name in enumerate(task.count)},
            {name: back(seen[:, n], ()) for n, name in enumerate(task.watch)},
        )
