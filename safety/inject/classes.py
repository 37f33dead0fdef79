"""What an injection comes to: its direction, whether it is detected, and the class that follows from both.

| direction \\ detected | yes      | no                     |
|-----------------------|----------|------------------------|
| wrong side            | detected | dangerous_undetected   |
| safe side             | detected | safe                   |
| neutral               | detected | no_effect              |

IEC 61508 divides otherwise: dangerous detected is wrong/yes, dangerous undetected wrong/no; safe is safe/yes, safe/no
and neutral/yes (a detected fault brings the safe state though it does no harm); no effect, neutral/no, counts nowhere.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from safety.inject.engine import NEVER, Outcome

if TYPE_CHECKING:
    import numpy.typing as npt

    Lanes = npt.NDArray[Any]

DIRECTIONS = ("neutral", "safe", "wrong")
CLASSES = ("safe", "detected", "dangerous_undetected", "no_effect")
CELLS = tuple(f"{direction}/{found}" for direction in DIRECTIONS for found in ("yes", "no"))
NO_EFFECT = CELLS.index("neutral/no")
_UNDETECTED = {"wrong/no": "dangerous_undetected", "safe/no": "safe", "neutral/no": "no_effect"}


class Counts:
    """What was seen in some runs side by side: `counts["o2"]` has the shape (blocks, runs), counts of frames."""

    def __init__(self, outcome: Outcome, golden: Outcome) -> None:
        self._outcome, self._golden = outcome, golden

    def __getitem__(self, name: str) -> Lanes:
        return _wide(self._outcome.counts, name, "observed")

    @property
    def runs(self) -> int:
        """How many runs stand side by side."""
        return int(next(iter((self._outcome.counts or self._outcome.first).values())).shape[-1])

    def total(self, name: str) -> Lanes:
        """Frames with the wire true over all measured blocks, one number a run."""
        total: Lanes = self[name].sum(axis=0)
        return total

    def ever(self, name: str) -> Lanes:
        """Whether the wire was true at the end of a measured frame, one truth value a run."""
        return self.total(name) > 0

    def first(self, name: str) -> Lanes:
        """The first measured frame (from 0) at whose end the watched wire was true, `NEVER` where none was."""
        return _wide(self._outcome.first, name, "watched")

    def healthy(self, name: str) -> int:
        """`total` of the fault-free run."""
        return int(_wide(self._golden.counts, name, "observed").sum())


def _wide(found: Mapping[str, Lanes], name: str, how: str) -> Lanes:
    """Numbers that can be multiplied with each other without running over."""
    if name not in found:
        raise KeyError(f"{name!r} is not {how}; there is {', '.join(found) or 'none'}")
    wide: Lanes = found[name].astype("int64", copy=False)
    return wide


Runs = Any  # an array, one value a run
Judge = Callable[[Counts], Runs]


def cells_of(counts: Counts, wrong_side: Judge, safe_side: Judge | None, detected: Judge) -> Lanes:
    """The cell of each run, by its place in `CELLS`; a run on both sides counts as wrong."""
    import numpy as np

    wrong, found = (np.broadcast_to(j(counts), counts.runs).astype(bool) for j in (wrong_side, detected))
    safe = np.broadcast_to(safe_side(counts) if safe_side else False, counts.runs)
    return cell(wrong, safe, found)


def cell(wrong: Lanes, safe: Lanes, found: Lanes) -> Lanes:
    """The cell of each run, uint8, from whether it is on the wrong side, on the safe side, and detected."""
    import numpy as np

    return np.asarray(2 * np.where(wrong, 2, np.where(safe, 1, 0)) + ~found, dtype=np.uint8)


def came(first: Lanes) -> Lanes:
    """Whether what was watched came at all."""
    there: Lanes = first != NEVER
    return there


def class_of(cell: str) -> str:
    """The class of a `direction/detected` cell."""
    return _UNDETECTED.get(cell, "detected")


@dataclass(frozen=True)
class Tally:
    """How many injections came to each cell."""

    cells: Mapping[str, int]

    @classmethod
    def of(cls, cells: Sequence[str]) -> Tally:
        """Count a list of cells."""
        return cls(Counter(cells))

    @classmethod
    def numbered(cls, numbers: Sequence[int]) -> Tally:
        """From the number of injections in each cell, in the order of `CELLS`."""
        return cls({cell: int(number) for cell, number in zip(CELLS, numbers, strict=True) if number})

    def __getitem__(self, cell: str) -> int:
        return self.cells.get(cell, 0)

    @property
    def injections(self) -> int:
        """All of them."""
        return sum(self.cells.values())

    @property
    def classes(self) -> dict[str, int]:
        """Counts of the four classes, in the order of `CLASSES`."""
        counts = Counter[str]()
        for cell, number in self.cells.items():
            counts[class_of(cell)] += number
        return {name: counts[name] for name in CLASSES}

    @property
    def safe(self) -> int:
        """Safe failures in the sense of IEC 61508."""
        return self["safe/yes"] + self["safe/no"] + self["neutral/yes"]

    @property
    def dangerous_detected(self) -> int:
        """Dangerous failures that are detected."""
        return self["wrong/yes"]

    @property
    def dangerous_undetected(self) -> int:
        """Dangerous failures that are not."""
        return self["wrong/no"]

    @property
    def table(self) -> dict[str, int]:
        """The cells that occur, in the order of `CELLS`."""
        return {cell: self[cell] for cell in CELLS if self[cell]}
