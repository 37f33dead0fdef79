"""The smallest way to the same harm: fewest faults, then the shortest windows, then the earliest steps.

What comes out is locally minimal: without any one of its faults, with any one window shorter by a frame at either end,
or with any one fault (or all together) a frame earlier, the run is not dangerous undetected any more.  Up to `ALL`
faults, no part of them suffices at all.  A window is searched for in ever finer grids, of `WIDE` candidates side by
side; one of up to `WIDE` frames is searched through in full.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

ALL = 8  # up to so many faults, every part of them is tried
WIDE = 256  # candidates side by side


@dataclass(frozen=True)
class Acting:
    """A fault, by its place among those of the campaign, that acts from step `first` to before step `end`."""

    place: int
    first: int
    end: int

    @property
    def length(self) -> int:
        """Steps during which it acts."""
        return self.end - self.first


Candidate = tuple[Acting, ...]
Harmful = Callable[[Sequence[Candidate]], Sequence[bool]]  # which of these are dangerous and undetected


def size(candidate: Candidate) -> tuple[int, int, int]:
    """What is made smaller: faults, steps during which they act, sum of the steps at which they begin."""
    return len(candidate), sum(one.length for one in candidate), sum(one.first for one in candidate)


def smaller(candidate: Candidate, grid: int = 1) -> Iterator[Candidate]:
    """The neighbours of a candidate that are smaller: one fault less, or one window shorter or earlier by `grid`."""
    for i, one in enumerate(candidate):
        if len(candidate) > 1:
            yield (*candidate[:i], *candidate[i + 1 :])
        if one.length > grid:
            yield _with(candidate, i, end=one.end - grid)
            yield _with(candidate, i, first=one.first + grid)
        if one.first >= grid:
            yield _with(candidate, i, first=one.first - grid, end=one.end - grid)
    if len(candidate) > 1 and all(one.first >= grid for one in candidate):
        yield tuple(replace(one, first=one.first - grid, end=one.end - grid) for one in candidate)


def shrink(candidate: Candidate, harmful: Harmful, grid: int = 1) -> Candidate:
    """A smallest candidate; windows are multiples of `grid` steps, as those given have to be.

    Raises `ValueError` when the candidate given is not harmful itself.
    """
    if not harmful([candidate])[0]:
        raise ValueError("the faults given are not dangerous and undetected: there is nothing to shrink")
    found = _fewest(candidate, harmful)
    while True:
        before = found
        for i in range(len(found)):
            found = _shortest(found, i, harmful, grid)
        for i in range(len(found)):
            found = _earliest(found, i, harmful, grid)
        rest = list(smaller(found, grid))
        better = _first(rest, harmful(rest) if rest else [])
        if better is not None:
            found = better
        elif found == before:
            return found


def _fewest(candidate: Candidate, harmful: Harmful) -> Candidate:
    while len(candidate) > ALL:
        rest = [(*candidate[:i], *candidate[i + 1 :]) for i in range(len(candidate))]
        fewer = _first(rest, harmful(rest))
        if fewer is None:
            return candidate
        candidate = fewer
    parts = [part for n in range(1, len(candidate)) for part in combinations(candidate, n)]
    return _first(parts, harmful(parts) if parts else []) or candidate


def _shortest(candidate: Candidate, i: int, harmful: Harmful, grid: int) -> Candidate:
    """With a window that cannot be shortened at either end."""
    while True:
        one = candidate[i]
        ends = range(one.first + grid, one.end + 1, grid)
        candidate = _least([_with(candidate, i, end=end) for end in ends], harmful)
        one = candidate[i]
        firsts = range(one.end - grid, one.first - 1, -grid)
        after = _least([_with(candidate, i, first=first) for first in firsts], harmful)
        if after == candidate:
            return candidate
        candidate = after


def _earliest(candidate: Candidate, i: int, harmful: Harmful, grid: int) -> Candidate:
    one = candidate[i]
    firsts = range(one.first % grid, one.first + 1, grid)
    return _least([_with(candidate, i, first=first, end=first + one.length) for first in firsts], harmful)


def _least(ladder: Sequence[Candidate], harmful: Harmful) -> Candidate:
    """A harmful candidate of a ladder whose last is harmful, such that the one below is not."""
    below, above = -1, len(ladder) - 1  # below: not harmful; above: harmful
    while above - below > 1:
        gap = above - below - 1
        count = min(gap, WIDE)
        rungs = [below + 1 + k * gap // count for k in range(count)]
        hit = next((k for k, bad in enumerate(harmful([ladder[rung] for rung in rungs])) if bad), None)
        if hit is None:
            below = rungs[-1]
        else:
            below, above = rungs[hit - 1] if hit else below, rungs[hit]
    return ladder[above]


def _with(candidate: Candidate, i: int, **changes: int) -> Candidate:
    changed = replace(candidate[i], **changes)
    return (*candidate[:i], changed, *candidate[i + 1 :])


def _first(candidates: Sequence[Candidate], bad: Sequence[bool]) -> Candidate | None:
    return next((one for one, hit in zip(candidates, bad, strict=True) if hit), None)
