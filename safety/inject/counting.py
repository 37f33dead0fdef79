"""Numbers of injections out of arrays of results: in each cell, by group and scenario, and by detector and latency."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from safety.inject.classes import CELLS
from safety.inject.judging import UNDETECTED, UNMADE, Judged

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from safety.inject.ranks import Positions

    Numbers = npt.NDArray[np.int64]

PIECE = 2**20  # injections that are counted at a time
MOST_KEYS = 2**18  # up to so many there is a number for each key that can be


def pieces(total: int) -> Iterator[tuple[int, int]]:
    """Ranges that are counted at a time."""
    return ((low, min(low + PIECE, total)) for low in range(0, total, PIECE))


def by_key(judged: Judged, keys: Callable[[int, int], Positions], number: int) -> dict[int, list[int]]:
    """Number of injections made in each cell, by the key (below `number`) that each of a range has."""
    import numpy as np

    few = number <= MOST_KEYS
    found: dict[int, Numbers] = {}
    whole = np.zeros((number if few else 0) * len(CELLS), dtype=np.int64)
    for low, high in pieces(len(judged)):
        cells = judged.cells[low:high]
        made = cells != UNMADE
        own, cells = keys(low, high)[made], cells[made]
        if few:
            whole += np.bincount(own * len(CELLS) + cells, minlength=len(whole))
            continue
        new, places = np.unique(own, return_inverse=True)
        counts = np.bincount(places * len(CELLS) + cells, minlength=len(new) * len(CELLS)).reshape(len(new), -1)
        for key, row in zip(new.tolist(), counts, strict=True):
            found[key] = found.get(key, 0) + row
    if few:
        table = whole.reshape(number, len(CELLS))
        found = {int(key): table[key] for key in np.flatnonzero(table.any(axis=1))}
    return {key: found[key].tolist() for key in sorted(found)}


def latencies(judged: Judged, detectors: int) -> list[dict[str, Any]]:
    """For each detector how many injections it found first, and how long that took, in frames from the onset.

    `histogram` has pairs: up to how many frames (1, 2, 5, 10, 20, ...), and how many took as long, but not shorter.
    """
    import numpy as np

    edges = np.array([0, *(d * 10**k for k in range(10) for d in (1, 2, 5))])
    numbers, sums = np.zeros((detectors, len(edges)), dtype=np.int64), [0] * detectors
    ends: list[list[int]] = [[] for _ in range(detectors)]
    for low, high in pieces(len(judged)):
        found = np.flatnonzero(judged.detector[low:high] != UNDETECTED)
        by, times = judged.detector[low:high][found], judged.latency[low:high][found]
        for detector in np.unique(by).tolist():
            took = times[by == detector]
            numbers[detector] += np.bincount(np.searchsorted(edges, took), minlength=len(edges))
            sums[detector] += int(took.sum(dtype=np.int64))
            ends[detector] += [int(took.min()), int(took.max())]
    return [
        {"count": 0, "latency": None}
        if not ends[k]
        else {
            "count": int(numbers[k].sum()),
            "latency": {
                "min": min(ends[k]),
                "max": max(ends[k]),
                "mean": sums[k] / int(numbers[k].sum()),
                "unit": "frames",
                "histogram": [[int(e), int(n)] for e, n in zip(edges, numbers[k], strict=True) if n],
            },
        }
        for k in range(detectors)
    ]
