"""Combinations by number: the position of a combination in lexicographic order, and back, for many at a time."""

from __future__ import annotations

import random
from dataclasses import dataclass
from functools import cached_property
from math import comb
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Positions = npt.NDArray[np.int64]

FEW = 100_000  # up to so many are drawn with the generator of the standard library


@dataclass(frozen=True)
class Combinations:
    """The combinations of `order` out of `n` things, ascending, in lexicographic order."""

    n: int
    order: int

    def __len__(self) -> int:
        return comb(self.n, self.order)

    @cached_property
    def starts(self) -> tuple[Positions, ...]:
        """`starts[k - 1][first]`: the position, among combinations of k, of the first that begins with `first`.

        Combinations of k whose members all lie beyond some thing are the tail of this list, so one table serves each
        depth.
        """
        import numpy as np

        def table(k: int) -> Positions:
            return np.array([comb(self.n, k) - comb(self.n - first, k) for first in range(self.n + 1)], dtype=np.int64)

        return tuple(table(k) for k in range(1, self.order + 1))

    def at(self, positions: Positions) -> Positions:
        """The members of the combinations at these positions, shape (order, positions)."""
        import numpy as np

        found = np.empty((self.order, len(positions)), dtype=np.int64)
        rest = positions
        for row, k in enumerate(range(self.order, 1, -1)):
            first = np.searchsorted(self.starts[k - 1], rest, side="right") - 1
            rest = rest - self.starts[k - 1][first] + self.starts[k - 2][first + 1]
            found[row] = first
        found[-1] = rest
        return found

    def position(self, members: Positions) -> Positions:
        """The positions of combinations, given as `at` gives them; members have to ascend."""
        result: Positions = members[-1]
        for row, k in zip(range(self.order - 2, -1, -1), range(2, self.order + 1), strict=True):
            first = members[row]
            result = result - self.starts[k - 2][first + 1] + self.starts[k - 1][first]
        return result


def drawn(population: int, number: int, seed: int | str) -> Positions:
    """`number` of the positions below `population`, each set of them as likely as any other, ascending."""
    import numpy as np

    if number <= FEW:
        return np.array(sorted(random.Random(seed).sample(range(population), number)), dtype=np.int64)
    if number > population // 2:
        left_out = drawn(population, population - number, seed)
        return np.setdiff1d(np.arange(population, dtype=np.int64), left_out, assume_unique=True)
    generator = np.random.default_rng(random.Random(seed).getrandbits(128))
    found: Positions = np.empty(0, dtype=np.int64)
    while len(found) < number:  # the first so many different ones of an endless sequence
        more = np.concatenate([found, generator.integers(population, size=number, dtype=np.int64)])
        _, firsts = np.unique(more, return_index=True)
        found = more[np.sort(firsts)[:number]]
    return np.sort(found)
