"""One step of a system on the Python reading, the direct one and the lanes."""

from __future__ import annotations

from typing import Any

import numpy as np

from safety.system import System
from safety.terms.direct import evaluate
from safety.terms.texts import compile_lanes, lane_type
from safety.trace import Stepper


def reading(system: System, row: list[Any]) -> tuple[Any, ...]:
    """Next registers, signals and points from registers and inputs, the same on the three readings."""
    inputs = [*(s.var for s in system.states), *system.inputs.values()]
    outputs = [*(s.next for s in system.states), *system.signals.values(), *system.points.values()]
    direct = tuple(evaluate(outputs, dict(zip(inputs, row, strict=True))))
    stepper = Stepper.of(system)
    python = stepper.function(*row)
    following = python[: len(system.states)]
    assert following == direct[: len(system.states)]
    assert dict(zip(stepper.observed, python[len(following) :], strict=False)) == {
        p: v
        for p, v in zip([*system.signals, *system.points], direct[len(following) :], strict=True)
        if p in stepper.observed
    }
    arrays = [np.array([v], dtype=lane_type(t)) for v, t in zip(row, inputs, strict=True)]
    lanes = compile_lanes(inputs, outputs)(*arrays)
    assert tuple(lane[0].item() if hasattr(lane[0], "item") else lane[0] for lane in lanes) == direct
    return direct
