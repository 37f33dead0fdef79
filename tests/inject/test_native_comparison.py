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


def latches() -> Task:
    """Registers that each keep a flip of their own point for ever; one wire is their parity."""
    points: Any = {f"p{i}": node("point", (bit(False),), f"p{i}", BIT) for i in range(4)}
    held: Any = [variable(f"r{i}", BIT) for i in range(4)]
    states = [State(var, var ^ point, False) for var, point in zip(held, points.values(), strict=True)]
    wires = {"w": functools.reduce(operator.xor, held)}
    system = System("latches", Clock(event="tick"), tuple(states), {}, wires, points, {}, {})
    atoms = tuple(Fault(flip(), [point]) for point in points)
    return Task(system, atoms, ("w",), ("w",), Timing(0, 40, 10, 1), lambda frame: {}, {})


@pytest.mark.parametrize("i", range(4))
def test_a_register_left_out_is_found(i: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    task, when = latches(), np.array([[7]], np.int32)
    flipped = Batch(np.array([[i]], np.int32), when, when + 1)
    right = NativeEngine(task, prune=False).run(flipped)
    assert not differences(NativeEngine(task).run(flipped), right)
    forgetting("diverged", [k for k in range(4) if k != i])(monkeypatch)
    assert differences(NativeEngine(task).run(flipped), right)
