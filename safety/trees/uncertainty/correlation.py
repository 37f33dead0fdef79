"""Rank correlations between random variables of a fault tree, and the file that names them.

The file is JSON: {"rank_correlations": [["pump rate", "valve rate", 0.6], ...]}, each pair of variables once; pairs
that are not named are uncorrelated.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from safety.trees.as_written import TreeError

KEY = "rank_correlations"
Vector = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class Correlation:
    """Rank correlations (Spearman's) between random variables: a matrix over `names`, symmetric, with ones.

    It is realised by the normal copula of correlations 2 sin(pi r / 6). Raises TreeError: no such matrix, or one that
    is not positive semidefinite and so the correlation of nothing.
    """

    names: tuple[str, ...]
    matrix: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "names", tuple(self.names))
        object.__setattr__(self, "matrix", tuple(tuple(float(x) for x in row) for row in self.matrix))
        size = len(self.names)
        if len(set(self.names)) != size or [len(row) for row in self.matrix] != [size] * size:
            raise TreeError(
                f"the correlation matrix has rows of {[len(row) for row in self.matrix]} numbers for {size} variables, "
                "expected as many rows and columns as variables, each named once; correct it"
            )
        for i, row in enumerate(self.matrix):
            for j, x in enumerate(row):
                if not -1 <= x <= 1 or x != self.matrix[j][i] or (i == j and x != 1):
                    raise TreeError(
                        f'the correlation of "{self.names[i]}" and "{self.names[j]}" is {x} (the other way round '
                        f"{self.matrix[j][i]}), expected -1 to 1, the same both ways, and 1 with itself; correct it"
                    )
        for what, values in (("matrix", np.array(self.matrix)), ("normal copula of the matrix", self._normal())):
            least = float(np.linalg.eigvalsh(values)[0]) if size else 0.0
            if least < -1e-12 * size:
                raise TreeError(
                    f"the {what} of rank correlations of {', '.join(self.names)} has the eigenvalue {least:.3g}, so no "
                    "variables have these correlations; bring the largest ones nearer to 0"
                )

    def _normal(self) -> Vector:
        return np.array(2 * np.sin(math.pi / 6 * np.array(self.matrix)))

    def root(self) -> Vector:
        """L with L L' the correlations of the normal copula."""
        values, vectors = np.linalg.eigh(self._normal())
        return np.array(vectors * np.sqrt(np.maximum(values, 0.0)))


def of_pairs(pairs: Iterable[tuple[str, str, float]]) -> Correlation:
    """The correlation of some pairs, all others 0. Raises TreeError: a pair twice, or with itself, or as above."""
    given: dict[frozenset[str], float] = {}
    names: dict[str, None] = {}
    for first, second, value in pairs:
        pair = frozenset((first, second))
        if first == second or pair in given:
            why = "with itself" if first == second else "twice"
            raise TreeError(f'the correlation of "{first}" and "{second}" is given {why}; give each pair once', first)
        given[pair] = value
        names |= {first: None, second: None}
    rows = tuple(tuple(1.0 if a == b else given.get(frozenset((a, b)), 0.0) for b in names) for a in names)
    return Correlation(tuple(names), rows)


def read_correlation(path: str | Path) -> Correlation:
    """The correlations in a JSON file. Raises TreeError with the file, and OSError."""
    place = str(path)
    try:
        document = json.loads(Path(path).read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise TreeError(f"no JSON text ({error}); correct it", place=place) from None
    pairs = document.get(KEY) if isinstance(document, dict) and document.keys() == {KEY} else None
    if not isinstance(pairs, list):
        raise TreeError(
            f'expected {{"{KEY}": [["first variable", "second variable", 0.5], ...]}}; rewrite it', place=place
        )
    for pair in pairs:
        match pair:
            case [str(), str(), int() | float()] if not isinstance(pair[2], bool):
                pass
            case _:
                raise TreeError(f"{json.dumps(pair)[:60]} is no pair of names with a number; correct it", place=place)
    try:
        return of_pairs(pairs)
    except TreeError as error:
        raise error.at(place) from None
