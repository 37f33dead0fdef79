"""Every register counts when a group is compared with the fault-free run."""

from __future__ import annotations

import functools
import operator
from typing import Any

import numpy as np
import pytest

from safety.faults import Fault, flip
from safety.inject.engine import Batch, Task, Timing
from safety.inject.native import NativeEngine
from safety.system import Clock, State, System
from safety.terms.graph import BIT, node, variable
from safety.terms.values import bit
from tests.inject.native_systems import differences
from tests.inject.test_native_mistakes import forgetting


def latches() -> tuple[Task, Batch]:
    """Registers that each keep a flip of their own point for ever; one wire is their parity."""
    points: Any = {f"p{i}": node("point", (bit(False),), f"p{i}", BIT) for i in range(4)}
    held: Any = [variable(f"r{i}", BIT) for i in range(4)]
    states = [State(var, var ^ point, False) for var, point in zip(held, points.values(), strict=True)]
    wires = {"w": functools.reduce(operator.xor, held)}
    system = System("latches", Clock(event="tick"), tuple(states), {}, wires, points, {}, {})
    atoms = tuple(Fault(flip(), [point]) for point in points)
    task = Task(system, atoms, ("w",), ("w",), Timing(0, 40, 10, 1), lambda frame: {}, {})
    when = np.full((1, 4), 7, np.int32)
    return task, Batch(np.arange(4, dtype=np.int32)[None], when, when + 1)


def test_a_comparison_without_any_one_register_is_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    task, batch = latches()
    right = NativeEngine(task, prune=False).run(batch)
    assert not differences(NativeEngine(task).run(batch), right)
    for i in range(4):
        with monkeypatch.context() as patch:
            forgetting("diverged", [k for k in range(4) if k != i])(patch)
            assert differences(NativeEngine(task).run(batch), right)
