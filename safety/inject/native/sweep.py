"""Runs through time in stretches; runs that have come to one state share what follows.

Many faults that pass leave something behind, the phase of a counter for instance, and never come back to the fault-free
run; but they come to the state that another run has come to.  At the end of a stretch such runs, all their faults being
over, are one from there on.  What each shows is its own until then, and what the one shows after.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from safety.inject.engine import NEVER, NONE, Batch, Outcome
from safety.inject.native.program import Program, Stretch

if TYPE_CHECKING:
    import numpy.typing as npt

    Array = npt.NDArray[Any]

TILE = 16  # atoms
NEW_RUNS = 2**12  # that begin in a stretch, at least, about
MOST = 64  # stretches
SHORTEST = 32  # steps of a stretch
WORTH_WHILE = 0.2  # runs that are one with another, per new one that is not over; with fewer the rest is one stretch


@dataclass(frozen=True)
class _Leg:
    """A stretch and its runs: those that went on, then new ones, `new` being their columns; `heirs`: the place of each
    among those that go on from here, or -1."""

    seen: Stretch
    new: Array
    heirs: Array


def run(program: Program, batch: Batch, *, prune: bool = True, length: int | None = None) -> Outcome:
    """Run a batch, its atoms being numbers in the program's `acts`; `length`: steps of a stretch."""
    import numpy as np

    task = program.task
    none = batch.atoms == NONE
    first, end = np.where(none, NEVER, batch.first), np.where(none, NEVER, batch.end)
    stays = ((end == NEVER) & ~none).any(axis=0)
    begins = first.min(axis=0)
    tiles = [row // TILE for row in batch.atoms]  # so that a group has few points
    if prune:
        in_time = stays.astype(np.int64) << 62 | begins.astype(np.int64) << 31 | tiles[0] + 1
        order = np.argsort(in_time, kind="stable") if len(tiles) == 1 else np.lexsort([*tiles[::-1], begins, stays])
    else:
        order = np.lexsort([begins, batch.atoms[0]])
    ordered = Batch(*(np.ascontiguousarray(a[:, order]) for a in (batch.atoms, first, end)))
    passing = int(np.count_nonzero(~stays))
    total = task.timing.frames * task.timing.steps
    counts = np.zeros((len(task.count), task.timing.blocks, batch.runs), np.int32)
    came = np.full((len(task.watch), batch.runs), NEVER, np.int32)
    length = length or max(SHORTEST, -(-total // MOST), total * NEW_RUNS // max(passing, 1))
    if prune and length < total:
        _gather(_legs(program, _columns(ordered, 0, passing), length), counts, came)
    else:
        passing = 0
    seen = program.stretch(_columns(ordered, passing, batch.runs), 0, total, prune=prune)
    counts[:, :, passing:], came[:, passing:] = seen.counts, seen.came
    back = np.argsort(order)
    golden = program.golden
    return Outcome(
        {name: golden.counts[name] + counts[i][:, back] for i, name in enumerate(task.count)},
        {name: came[i, back] for i, name in enumerate(task.watch)},
    )


def _columns(batch: Batch, low: int, high: int) -> Batch:
    return Batch(*(a[:, low:high] for a in (batch.atoms, batch.first, batch.end)))


def _legs(program: Program, batch: Batch, length: int) -> list[_Leg]:
    """The stretches of a batch that is in the order of its first faults."""
    import numpy as np

    total = program.task.timing.frames * program.task.timing.steps
    begins = batch.first.min(axis=0).astype(np.int64)
    going_on, kept = _columns(batch, 0, 0), np.zeros((0, program.kernel.words), np.uint64)
    legs: list[_Leg] = []
    start = 0
    while start < total:
        stop = min(start + length, total)
        low, high = np.searchsorted(begins, [start, stop])
        new = np.arange(low, len(begins) if stop == total else high)  # with the last those that never begin
        more = _columns(batch, int(new[0]), int(new[-1]) + 1) if len(new) else _columns(batch, 0, 0)
        runs = Batch(*(np.concatenate([getattr(b, n) for b in (going_on, more)], axis=1) for n in NAMES))
        seen = program.stretch(runs, start, stop, kept=kept, keep=stop < total)
        if stop == total:
            legs.append(_Leg(seen, new, np.full(runs.runs, -1)))
            break
        pending = ((runs.atoms != NONE) & (runs.end > stop)).any(axis=0)
        goes_on = seen.apart | pending
        seen.came[:, ~goes_on] = np.minimum(seen.came[:, ~goes_on], _next(program, stop)[:, None])
        chosen, heirs = _one_of_each(seen.records, goes_on, pending)
        legs.append(_Leg(seen, new, heirs))
        kept = seen.records[chosen]
        going_on = Batch(runs.atoms[:, chosen], np.maximum(runs.first[:, chosen], stop), runs.end[:, chosen])
        merged = np.count_nonzero(goes_on) - len(chosen)
        if len(legs) > 2 and merged < WORTH_WHILE * np.count_nonzero(goes_on[-len(new) :]):
            length = total
        start = stop
    return legs


NAMES = ("atoms", "first", "end")


def _next(program: Program, step: int) -> Array:
    """The first measured frame from a step on at whose end each watched wire is true without faults."""
    import numpy as np

    return np.array([program.rows[f"next{i}"][step] for i in range(program.kernel.watched)], np.int32)


def _one_of_each(records: Array, goes_on: Array, pending: Array) -> tuple[Array, Array]:
    """One run for each state that is there, and for each run its place among these, or -1 for one that is over.

    Runs with faults to come stay apart.
    """
    import numpy as np

    heirs = np.full(len(records), -1)
    alone, free = np.flatnonzero(pending), np.flatnonzero(goes_on & ~pending)
    words = records[free]
    _, chosen, which = np.unique(_digest(words), return_index=True, return_inverse=True)
    unlike = (words != words[chosen][which]).any(axis=1)  # two states of one digest
    heirs[free] = which
    chosen = np.concatenate([free[chosen], free[unlike], alone])
    heirs[chosen] = np.arange(len(chosen))
    return chosen, heirs


def _digest(words: Array) -> Array:
    """A number for each row; equal rows have equal numbers."""
    import numpy as np

    odd = np.random.default_rng(0).integers(0, 2**63, words.shape[1], np.uint64) * np.uint64(2) + np.uint64(1)
    mixed = words * odd
    mixed ^= mixed >> np.uint64(29)
    digest: Array = mixed.sum(axis=1)
    return digest


def _gather(legs: list[_Leg], counts: Array, came: Array) -> None:
    """Add up what each run showed, from the last stretch to the first."""
    import numpy as np

    later = np.zeros((*counts.shape[:2], 0), np.int32)
    later_came = np.full((len(came), 0), NEVER, np.int32)
    for leg in reversed(legs):
        block, seen, heirs = leg.seen.block, leg.seen.counts, leg.heirs
        inherits = np.flatnonzero(heirs >= 0)
        total = np.zeros((*counts.shape[:2], len(heirs)), np.int32)
        total[:, :, inherits] = later[:, :, heirs[inherits]]
        total[:, block : block + seen.shape[1]] += seen
        first = leg.seen.came.copy()
        first[:, inherits] = np.minimum(first[:, inherits], later_came[:, heirs[inherits]])
        old = len(heirs) - len(leg.new)
        counts[:, :, leg.new], came[:, leg.new] = total[:, :, old:], first[:, old:]
        later, later_came = total[:, :, :old], first[:, :old]
