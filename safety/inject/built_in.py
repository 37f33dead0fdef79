"""Which faults of a run masks carry, and which are built into the system: one rule for all engines."""

from __future__ import annotations

from collections.abc import Sequence

from safety.faults import is_wide, where
from safety.inject.engine import NONE, Task
from safety.inject.masks import masks

Slot = tuple[int, int]  # a fault that is built in: its row in the batch, its atom


class BuiltIn:
    """The atoms of a task: `masks` of each (None where none can carry it), and whether it is `wide`.

    A wide one joins points or acts on parts: those of different runs are not built in together.
    """

    def __init__(self, task: Task) -> None:
        self.masks = [masks(task.system, atom) for atom in task.atoms]
        self.wide = [is_wide(task.system, atom) for atom in task.atoms]
        self._where = [frozenset(where(task.system, atom)) for atom in task.atoms]

    def slots(self, atoms: Sequence[int]) -> list[Slot]:
        """The faults of a run that are built in: those without masks, what shares their points, and so on from there.

        Faults at one point act in the order of their rows, which a mask behind a fault built in could not keep.
        """
        there = [(row, atom) for row, atom in enumerate(atoms) if atom != NONE]
        found = {slot for slot in there if self.masks[slot[1]] is None}
        while True:
            taken = frozenset().union(*(self._where[atom] for _, atom in found))
            more = {slot for slot in there if self._where[slot[1]] & taken}
            if more <= found:
                return sorted(found)
            found |= more
