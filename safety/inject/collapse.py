"""Faults that come to the same by construction: one of each class is run, and counts for all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from safety.faults import Fault
from safety.inject.engine import NONE
from safety.inject.masks import Mask, changes_nothing, masks
from safety.inject.space import window
from safety.system import System

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Leaders = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Collapse:
    """For each single fault the one that is run for it (itself, an earlier one, or `NONE`: it cannot show), and

    which faults leave the equipment as it is.
    """

    leaders: Leaders
    idle: npt.NDArray[np.bool_]

    @property
    def nothing(self) -> bool:
        """Whether each fault is run for itself."""
        return bool((self.leaders == range(len(self.leaders))).all())

    def to_json(self) -> dict[str, int]:
        """How many single faults there are, are run, and cannot show."""
        own = int((self.leaders == range(len(self.leaders))).sum())
        return {"single_faults": len(self.leaders), "run": own, "cannot_show": int((self.leaders == NONE).sum())}


def collapse(system: System, faults: Sequence[Fault]) -> Collapse:
    """Collapse faults."""
    import numpy as np

    found = [masks(system, fault) for fault in faults]
    idle = np.array([m is not None and changes_nothing(system, m) for m in found])
    return Collapse(np.array(_same(faults, found), dtype=np.int64), idle)


def _same(faults: Sequence[Fault], found: Sequence[Mapping[str, Mask] | None]) -> list[int]:
    """Faults with the same masks at the same points at the same time are one, whatever else is broken."""
    leaders: dict[object, int] = {}
    return [
        place if m is None else leaders.setdefault((window(fault), frozenset(m.items())), place)
        for place, (fault, m) in enumerate(zip(faults, found, strict=True))
    ]
