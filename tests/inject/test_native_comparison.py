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
from safety.inject.native.planes import Planes
from safety.inject.native.routine import Routine
from safety.system import Clock, State, System
from safety.terms.graph import BIT, node, variable
from safety.terms.values import bit
from tests.inject.native_systems import differences
from tests.inject.test_native_mistakes import Plant, forgetting


def latches() -> Task:
    """Registers that each keep a flip of their own point for ever; one wire is their parity."""
    points: Any = {f"p{i}": node("point", (bit(False),), f"p{i}", BIT) for i in range(4)}
    held: Any = [variable(f"r{i}", BIT) for i in range(4)]
    states = [State(var, var ^ point, False) for var, point in zip(held, points.values(), strict=True)]
    wires = {"w": functools.reduce(operator.xor, held)}
    system = System("latches", Clock(event="tick"), tuple(states), {}, wires, points, {}, {})
    atoms = tuple(Fault(flip(), [point]) for point in points)
    return Task(system, atoms, ("w",), ("w",), Timing(0, 40, 10, 1), lambda frame: {}, {})


def without_the_last_plane(patch: pytest.MonkeyPatch) -> None:
    right = Planes.diverged

    def wrong(self: Planes) -> Routine:
        with patch.context() as within:
            within.setattr(Planes, "_planes_used", 3)
            return right(self)

    patch.setattr(Planes, "diverged", wrong)


@pytest.mark.parametrize(
    ("form", "i", "plant"),
    [
        *(("words", i, forgetting("diverged", [k for k in range(4) if k != i])) for i in range(4)),
        ("sliced", 3, without_the_last_plane),
    ],
)
def test_a_register_left_out_is_found(
    form: str, i: int, plant: Plant, monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    task, when = latches(), np.array([[7]], np.int32)
    flipped = Batch(np.array([[i]], np.int32), when, when + 1)
    right = NativeEngine(task, prune=False, form=form).run(flipped)
    assert not differences(NativeEngine(task, form=form).run(flipped), right)
    plant(monkeypatch)
    assert differences(NativeEngine(task, form=form).run(flipped), right)
