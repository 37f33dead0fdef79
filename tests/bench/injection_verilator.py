"""An engine by Verilator: the system exported as Verilog with masks at its points as inputs, one run after the other.

Of the forms tried this is the fastest: a mask at each point and one block for both edges of the clock.  One mask with
the number of its point takes 1.2 times as long, wires with registers on the rising edge 3.3 times.
"""

from __future__ import annotations

import re
import subprocess
import tempfile
from dataclasses import replace
from functools import cached_property
from pathlib import Path

import numpy as np

from safety.export.verilog import machine
from safety.inject.engine import NONE, Batch, Outcome, Task
from safety.inject.masks import Mask, masked
from safety.system import substitute
from safety.terms.graph import variable
from tests.bench.injection_task import healthy, sites, starts, stimulus

MAIN = (Path(__file__).parent / "injection_verilator.cpp").read_text(encoding="utf-8")
OPTIONS = ("-O3", "--x-assign", "fast", "--x-initial", "fast", "--noassert", "-Wno-fatal", "-Wno-lint")
COMPILED = ("-CFLAGS", "-O3 -march=native", "-MAKEFLAGS", 'OPT_FAST="-O3 -march=native"')


class Verilator:
    """One run after the other in one core, compiled in a folder; `FileNotFoundError` where Verilator is missing."""

    def __init__(self, task: Task, folder: Path) -> None:
        assert task.timing.steps == 1, "a frame is a step here"
        self.task = task
        self.points, self.sites = sites(task)
        self.wires = list(dict.fromkeys((*task.count, *task.watch)))
        self.sorts = [task.system.points[point].sort for point in self.points]
        self.folder = Path(tempfile.mkdtemp(dir=folder))
        (self.folder / "machine.v").write_text(self._verilog(), encoding="utf-8")
        (self.folder / "main.cpp").write_text(self._main(), encoding="utf-8")
        subprocess.run(
            ["verilator", "--cc", "--exe", "--build", *OPTIONS, *COMPILED, "machine.v", "main.cpp"],
            cwd=self.folder, check=True, timeout=300, capture_output=True,
        )  # fmt: skip

    def _verilog(self) -> str:
        """The module, with `keep0`, `turn0`, ... as inputs."""
        carried, power_up, ports = masked(self.task.system, self.points), starts(self.task), {}
        for n, point in enumerate(self.points):
            for name, mask in zip(("keep", "turn"), carried.variables[point], strict=True):
                ports[mask.uid] = variable(f"{name}{n}", mask.sort)
        system = carried.system.mapped(lambda roots: substitute(roots, ports))
        system = replace(
            system,
            states=tuple(replace(s, power_up=power_up[s.path]) for s in system.states),
            inputs={**system.inputs, **{str(port.attr): port for port in ports.values()}},
        )
        return machine(system, {f"seen{n}": system.lookup(name) for n, name in enumerate(self.wires)})

    def _main(self) -> str:
        timing, count = self.task.timing, range(len(self.points))
        marked = {
            "POINTS": len(self.points), "RUN_IN": timing.run_in, "FRAMES": timing.frames, "BLOCK": timing.block,
            "COUNTED": len(self.task.count), "WATCHED": len(self.task.watch),
            "KEEP": ", ".join(f"&machine.keep{n}" for n in count),
            "TURN": ", ".join(f"&machine.turn{n}" for n in count),
            "PASSING": ", ".join(str(sort.bounds[1]) for sort in self.sorts),
            "INPUTS": "\n".join(f"  const int32_t *in_{v} = next; next += FRAMES;" for v in self.task.system.inputs),
            "SET": "\n".join(f"      machine.{v} = in_{v}[frame];" for v in self.task.system.inputs),
            **{
                f"{what}_WIRES": ", ".join(f"machine.seen{self.wires.index(name)}" for name in names)
                for what, names in (("COUNTED", self.task.count), ("WATCHED", self.task.watch))
            },
        }  # fmt: skip
        return re.sub("@([A-Z_]+)@", lambda found: str(marked[found[1]]), MAIN)

    @cached_property
    def golden(self) -> Outcome:
        """The fault-free run."""
        return self.run(healthy())

    def run(self, batch: Batch) -> Outcome:
        """Run a batch."""
        events = [self._events(batch, run) for run in range(batch.runs)]
        asked = [[batch.runs], *stimulus(self.task).values(), *([len(e) // 4, *e] for e in events)]
        files = self.folder / "asked", self.folder / "answered"
        np.concatenate(asked).astype(np.int32).tofile(files[0])
        subprocess.run([self.folder / "obj_dir" / "Vmachine", *files], check=True)
        counted, blocks = len(self.task.count), self.task.timing.blocks
        words = np.fromfile(files[1], np.int32).reshape(batch.runs, -1)
        counts = words[:, : counted * blocks].reshape(batch.runs, counted, blocks)
        first = words[:, counted * blocks :]
        return Outcome(
            {name: counts[:, n].T for n, name in enumerate(self.task.count)},
            {name: first[:, n] for n, name in enumerate(self.task.watch)},
        )

    def _events(self, batch: Batch, run: int) -> list[int]:
        """The masks of a run: frame, point, keep, turn, one after the other."""
        faults = [
            (*self.sites[atom], first, end)
            for atom, first, end in zip(
                *(part[:, run].tolist() for part in (batch.atoms, batch.first, batch.end)), strict=True
            )
            if atom != NONE
        ]
        told = []
        for frame in sorted(
            {frame for *_, first, end in faults for frame in (first, end) if frame < self.task.timing.frames}
        ):
            for point in {point for point, *_ in faults}:
                whole = Mask(self.sorts[point].bounds[1], 0)
                for site, mask, first, end in faults:
                    if site == point and first <= frame < end:
                        whole = mask.after(whole)
                told += [frame, point, whole.keep, whole.turn]
        return told
