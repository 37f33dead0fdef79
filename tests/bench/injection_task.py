"""What the engines of fault injection are compared on: the whole of TS-7, frame by frame, with stuck and flipped bits.

The ride of `ts7_overspeed_single_faults`, shortened to 8000 frames: 15 km/h, from frame 2500 on 63 km/h, and for the
last 5104 frames, the time that the proof allows for the brake, 68.8 km/h.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from models.ts7.train import PER_WORD
from proofs.ts7_formulas import at_most_kmh
from proofs.ts7_system_campaign import STRIKE, TOO_FAST, overspeed
from safety.faults import Fault, flip, stuck
from safety.inject.engine import NEVER, NONE, Batch, Outcome, Task, Timing
from safety.inject.masks import Mask, mask_of
from safety.inject.space import CampaignError
from safety.system import System
from safety.trace import initial_state

FRAMES = 8000
HAZARD = FRAMES - TOO_FAST.allowed
SLOW, WITHIN, FAST = at_most_kmh(15), at_most_kmh(63), TOO_FAST.speed
WIRES = tuple(name for name in overspeed.system.signals if name.startswith("observed "))


def ride(frame: int) -> Mapping[str, Any]:
    """Stimulus of a frame."""
    return {"speed": SLOW if frame < STRIKE else WITHIN if frame < HAZARD else FAST, "backward": False}


def rolling(frame: int) -> Mapping[str, Any]:
    """A ride that moves everything within a few hundred frames: all speeds, both directions."""
    return {"speed": PER_WORD * (frame * 7 % 230), "backward": frame % 97 > 60}


def one_second(system: System | None = None) -> Task:
    """The whole system for a second, with every bit of every point stuck at 0, stuck at 1, and inverted."""
    system = overspeed.system if system is None else system
    timing = Timing(run_in=0, measured=FRAMES, block=500, steps=1)
    return Task(system, tuple(bits(system)), WIRES, WIRES, timing, ride, overspeed.start)


def short(frames: int) -> Task:
    """The same system for a few frames of `rolling`, every wire among its signals observed, for comparisons."""
    task = one_second()
    wires = tuple(name for name, term in task.system.signals.items() if term.sort.kind == "bit")
    timing = Timing(frames // 4, frames - frames // 4, frames // 4, 1)
    return replace(task, count=wires, watch=wires, timing=timing, inputs=rolling)


def bits(system: System) -> Iterator[Fault]:
    """Every bit of every point: stuck at 0, stuck at 1, inverted."""
    for point, term in system.points.items():
        for bit in [None] if term.sort.kind == "bit" else range(term.sort.width):
            yield from (Fault(kind, [point]) for kind in (stuck(0, bit), stuck(1, bit), flip(bit)))


def at_random(task: Task, runs: int, seed: int, most: int = 1) -> Batch:
    """Runs with `most` faults each at most, at random: from power-up, from any frame on, or for up to 40 frames."""
    pick, last = random.Random(seed), task.timing.frames
    atoms, first, end = (np.full((most, runs), fill, dtype=np.int32) for fill in (NONE, 0, NEVER))
    for run in range(runs):
        for row in range(pick.randint(1, most)):
            atoms[row, run] = pick.randrange(len(task.atoms))
            kind = pick.choice(["power-up", "lasting", "transient", "transient"])
            first[row, run] = 0 if kind == "power-up" else pick.randrange(last)
            if kind == "transient":
                end[row, run] = first[row, run] + pick.choice([1, 1, 2, 8, 40])
    return Batch(atoms, first, end)


def healthy(rows: int = 1) -> Batch:
    """One run without a fault."""
    shape = (rows, 1)
    return Batch(np.full(shape, NONE, np.int32), np.zeros(shape, np.int32), np.full(shape, NEVER, np.int32))


def sites(task: Task) -> tuple[list[str], list[tuple[int, Mask]]]:
    """The points by number, and for each atom the number of its point and its mask: what a peer can inject.

    Raises `CampaignError` for a fault at several points, or one that no mask carries.
    """
    points = list(task.system.points)
    found = []
    for atom in task.atoms:
        masks = {p: mask_of(atom.kind, task.system.points[p].sort) for p in atom.points if p in task.system.points}
        if len(masks) != 1 or None in masks.values() or len(masks) != len(atom.points):
            raise CampaignError(f"{atom}: peers inject masks at one point; leave this fault out")
        ((point, mask),) = masks.items()
        assert mask is not None
        found.append((points.index(point), mask))
    return points, found


def starts(task: Task) -> dict[str, int]:
    """What each register holds at power-up."""
    values, _ = initial_state(task.system, task.start)
    return {s.path: int(value) for s, value in zip(task.system.states, values, strict=True)}


def stimulus(task: Task) -> dict[str, list[int]]:
    """The inputs by name, a value a frame."""
    rows = [task.inputs(frame) for frame in range(task.timing.frames)]
    return {name: [int(row[name]) for row in rows] for name in task.system.inputs}


def same(left: Outcome, right: Outcome) -> bool:
    """Whether two outcomes agree to the last bit."""
    return all(
        mine.keys() == theirs.keys() and all(np.array_equal(mine[name], theirs[name]) for name in mine)
        for mine, theirs in ((left.counts, right.counts), (left.first, right.first))
    )
