"""Faults that stay, several at once: which of them change nothing beside the others, so that fewer runs say the same.

A fault that would have changed nothing at its points, at any step of a run, may be added to that run without a
difference.  One more run of each fault alone, and where it pays of each pair, notes which bits its points showed; so a
pair of faults often is one of them alone, and three are two.  Faults that share a point are left as they are.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

from safety.inject.engine import NEVER, NONE, Batch, Task
from safety.inject.masks import Mask
from safety.inject.native.program import AUTO, Program
from safety.inject.native.tapped import tapped
from safety.system import State, System
from safety.terms import UInt
from safety.terms.graph import variable
from safety.terms.llvm import Target

if TYPE_CHECKING:
    import numpy.typing as npt

    Array = npt.NDArray[Any]

ONES, ZEROS = " has shown 1", " has shown 0"  # registers are named after their point
PAYS = 4  # runs of three faults for each pair, so that runs of all pairs pay
MOST_PAIRS = 2**17  # so many are noted, a byte an atom


def reduces(batch: Batch) -> bool:
    """Whether all faults of a batch begin together and stay."""
    there = batch.atoms != NONE
    first = batch.first[there]
    return bool(len(first) and (first == first[0]).all() and (batch.end[there] == NEVER).all())


class Excitation:
    """What the faults of a task, all of them masks, would change in runs of others that begin at one step and stay."""

    def __init__(
        self,
        task: Task,
        masks: Sequence[Mapping[str, Mask]],
        first: int,
        stimulus: Callable[[], Mapping[str, Array]],
        target: Target,
        form: str = AUTO,
    ) -> None:
        import numpy as np

        self.first, self.masks = first, masks
        self.points = tuple(dict.fromkeys(point for found in masks for point in found))
        names = [point + which for point in self.points for which in (ONES, ZEROS)]
        blind = replace(task, system=noting(task.system, self.points), count=(), watch=())
        self.program = Program(blind, tapped(blind.system, self.points), masks, stimulus, target, names, form)
        none = len(masks)
        self._pair = np.full((none + 1, none + 1), -1)  # the row of a pair in the next; the last stands for unknown
        self._pairs_change = np.ones((1, none + 1), np.bool_)
        self._threes = 0  # runs of three faults asked for until now

    def changes(self, atoms: Array) -> Array:
        """For each run of faults, of shape (k, runs), the atoms that would change something in it: (runs, atoms + 1).

        What acts in the run, or shares a point with it, always would; the last column stands for no fault.
        """
        import numpy as np

        runs = atoms.shape[1]
        none = atoms == NONE
        batch = Batch(atoms, np.where(none, NEVER, self.first), np.full_like(atoms, NEVER))
        total = len(self.program.rows) - 1
        kept = np.repeat(self._before[None], runs, axis=0)
        records = self.program.stretch(batch, self.first, total, kept=kept, keep=True).records
        kernel = self.program.kernel
        place = {str(s.path): i for i, s in enumerate(kernel.registers)}
        found = np.zeros((runs, len(self.masks) + 1), np.bool_)
        for atom, masks in enumerate(self.masks):
            for point, mask in masks.items():
                ones, zeros = (kernel.from_records(records, place[point + which]) for which in (ONES, ZEROS))
                full = int(self.program.task.system.points[point].sort.bounds[1])
                low, high, turned = full & ~mask.keep & ~mask.turn, full & ~mask.keep & mask.turn, mask.keep & mask.turn
                found[:, atom] |= ((ones & low) | (zeros & high)) != 0 if not turned else True
        for row in atoms:
            found |= self._share[row]
        return found

    @cached_property
    def _before(self) -> Array:
        """The fault-free lane when the faults begin, nothing shown yet."""
        return self.program.kept(self.first, blank=lambda path: path.endswith((ONES, ZEROS)))

    @cached_property
    def _share(self) -> Array:
        """Which atoms share a point, themselves included; no fault, the last, shares none."""
        import numpy as np

        at = np.array([[point in found for point in self.points] for found in (*self.masks, {})], np.int32)
        return np.asarray(at.reshape(len(self.masks) + 1, -1) @ at.reshape(len(self.masks) + 1, -1).T > 0)

    @cached_property
    def _alone(self) -> Array:
        """`changes` of each atom alone, and at last of no fault."""
        import numpy as np

        return self.changes(np.append(np.arange(len(self.masks)), NONE)[None].astype(np.int32))

    # --- fewer faults ----------------------------------------------------------------------------------------------

    def reduced(self, atoms: Array) -> Array:
        """The same runs, of shape (k, runs) with k up to 3, with fewer faults: `NONE` for those that change nothing.

        `NONE` stands last, and faults that share no point by their number, so that equal runs look equal.
        """
        import numpy as np

        found = np.where(atoms == NONE, len(self.masks), atoms)
        self._note_pairs(found)
        for _ in found:
            for z in range(len(found)):
                others = [found[i] for i in range(len(found)) if i != z]
                found[z] = np.where(self._would_change(others, found[z]), found[z], len(self.masks))
        pairs = [(i, j) for i in range(len(found)) for j in range(i)]
        share = np.any([self._share[found[i], found[j]] for i, j in pairs], axis=0)
        last = np.take_along_axis(found, np.argsort(found == len(self.masks), axis=0, kind="stable"), axis=0)
        found = np.where(share, last, np.sort(found, axis=0))
        return np.where(found == len(self.masks), NONE, found).astype(np.int32)

    def _would_change(self, others: Sequence[Array], z: Array) -> Array:
        """Whether a fault would change something in the run of the others."""
        import numpy as np

        alone = self._alone
        x, y = [*others, *[np.full_like(z, len(self.masks))] * 2][:2]
        with_both = self._pairs_change[self._pair[x, y], z]
        changed: Array = np.where(~alone[y, x], alone[y, z], np.where(~alone[x, y], alone[x, z], with_both))
        return changed

    def _note_pairs(self, atoms: Array) -> None:
        """What pairs of these atoms would change, if there are so many runs of three that this pays."""
        import numpy as np

        if len(atoms) < 3:
            return
        there = np.zeros(len(self.masks) + 1, np.bool_)
        there[np.unique(atoms)] = True
        there[-1] = False
        both = self._alone & self._alone.T & ~self._share & there & there[:, None] & (self._pair < 0)
        x, y = np.nonzero(np.triu(both))
        self._threes += atoms.shape[1]
        if not len(x) or len(x) > MOST_PAIRS or self._threes < PAYS * len(x):
            return
        known = len(self._pairs_change) - 1
        self._pair[x, y] = self._pair[y, x] = known + np.arange(len(x))
        more = self.changes(np.stack([x, y]).astype(np.int32))
        self._pairs_change = np.concatenate([self._pairs_change[:-1], more, self._pairs_change[-1:]])


def noting(system: System, points: Sequence[str]) -> System:
    """The system with registers that note, bit by bit, what each point has shown of what is there without its fault."""
    states = list(system.states)
    for point in points:
        there = cast(UInt, system.points[point].args[0])
        for which, shown in ((ONES, there), (ZEROS, ~there)):
            held = cast(UInt, variable(point + which, there.sort))
            states.append(State(held, held | shown, False if there.sort.kind == "bit" else 0))
    return replace(system, states=tuple(states))
