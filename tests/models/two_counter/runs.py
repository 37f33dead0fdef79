"""Runs of the two-counter ATC for its tests: lines, one run, many side by side, and a reference in continuous time."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from models.two_counter.equipment import Equipment
from safety.faults import Fault, instrument, schedule
from safety.model import Model
from safety.terms.texts import compile_lanes
from safety.trace import Trace, run
from safety.tracing import trace

TC = Fraction("0.311739")
STEP_S = TC / 2000
PRESET = {250: 1035, 210: 875, 160: 677, 110: 477, 70: 317, 30: 157, 5: 57}
SPACING, KMH = 1_000_000, 2000


def threshold(check: int) -> int:
    """The speed whose frequency is f2E."""
    return 500 * PRESET[check]


def brakes_from(check: int, n1f: int = 2000) -> int:
    """The least speed at which no phase reaches n1F."""
    return -(-threshold(check) * n1f // (n1f - 1))


def lines(*checks: int) -> dict[str, bool]:
    return {f"lines.s{v}": v in checks for v in PRESET}


def ride(
    speed: Callable[[int], int] | int,
    steps: int,
    checks: Callable[[int], int] | int = 250,
    model: type[Model] = Equipment,
    faults: Sequence[Fault] = (),
    phase: int = 0,
    settings: dict[str, Any] | None = None,
    keep: Sequence[str] | None = None,
) -> Trace:
    """One run at a speed, with a check speed, both constant or by step."""
    at = speed if callable(speed) else lambda _: speed
    check = checks if callable(checks) else lambda _: checks
    faulted = instrument(trace(model, settings or {}), list(faults))
    choose, wires = schedule(faulted), {v: lines(v) for v in (*PRESET, 0)}

    def row(k: int) -> dict[str, Any]:
        return {"speed": at(k), **wires[check(k)], **(choose(k) if faults else {})}

    return run(faulted.system, row, steps, start={"train.phase": phase}, keep=keep)


def steps_with(seen: Trace, signal: str) -> list[int]:
    return [k for k, there in enumerate(seen[signal]) if there]


class Fleet:
    """Many trains with one check speed side by side on the lanes reading; a call is one step at their speeds."""

    def __init__(self, check: int, phases: Any, settings: dict[str, Any] | None = None) -> None:
        self.system = trace(Equipment, settings or {})
        self.phases = np.asarray(phases)
        watched = [self.system.signals[name] for name in ("brake", "signal1", "signal3")]
        leaves = [*(s.var for s in self.system.states), *self.system.inputs.values()]
        self.function = compile_lanes(leaves, [*(s.next for s in self.system.states), *watched])
        fixed = {s.path: s.power_up for s in self.system.states} | {"train.phase": 0}
        self.state = {path: np.full(len(self.phases), value) for path, value in fixed.items()}
        self.state["train.phase"] = self.phases.astype(np.int64)
        self.lines = [np.full(len(self.phases), value) for value in lines(check).values()]

    def __call__(self, speed: Any) -> tuple[Any, Any, Any]:
        """Whether each brakes, has signal 1, has signal 3."""
        given = np.broadcast_to(np.asarray(speed, dtype=np.int64), self.phases.shape)
        *state, brake, read_out, start = self.function(*self.state.values(), given, *self.lines)
        self.before, self.state = self.state, dict(zip(self.state, state, strict=True))
        return brake, read_out, start

    @property
    def count(self) -> Any:
        """Counter 1 before the step."""
        return self.before["circuit.counter1.n"]


class Motion:
    """Position of the train in continuous time: piecewise constant speeds, in turning per oscillator period."""

    def __init__(self, start: Fraction, pieces: Sequence[tuple[Fraction, Fraction]]) -> None:
        self.start, self.pieces = start, pieces  # (duration in periods, speed)

    def turned(self, steps: int) -> list[Fraction]:
        """The position at the beginning of each step and after the last."""
        position, rest, found = self.start, list(self.pieces), [self.start]
        for _ in range(steps):
            left = Fraction(1)
            while left:
                duration, speed = rest[0]
                part = min(duration, left)
                position, left = position + speed * part, left - part
                rest[:1] = [(duration - part, speed)] if duration > part else []
            found.append(position)
        return found

    def inputs(self, steps: int) -> list[int]:
        """The speed of each step that runs this motion."""
        whole = [math.ceil(position) for position in self.turned(steps)]
        return [after - before for before, after in itertools.pairwise(whole)]

    def edges(self, spacing: int) -> list[Fraction]:
        """The instants of the edges, in periods; one at the end of a piece belongs to the next."""
        begins, position, found = Fraction(0), self.start, []
        for duration, speed in self.pieces:
            end = position + speed * duration
            passed = range(math.ceil(position / spacing), math.ceil(end / spacing))
            found += [begins + (k * spacing - position) / speed for k in passed]
            begins, position = begins + duration, end
        return found


class Sample(NamedTuple):
    """A read-out: its step, the count that it reads, whether it brakes."""

    step: int
    n1: int
    brake: bool


def sample_equation(edges: Sequence[Fraction], preset: Callable[[int], int], n1f: int) -> Iterator[Sample]:
    """Event by event: n1 is the number of oscillator instants in (start, end] of the window; floors of exact times."""
    at, n1 = 0, 0  # edges so far, since the last window ended
    while at + 9 < len(edges):
        yield Sample(math.floor(edges[at + 1]), n1, n1 < n1f)
        start, m = at + 7, 1
        while start + m < len(edges) and m < preset(math.floor(edges[start + m])):
            m += 1
        if start + m >= len(edges):
            return
        n1, at = math.floor(edges[start + m]) - math.floor(edges[start]), start + m + 1
