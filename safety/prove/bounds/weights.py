"""Weights with which the slopes of some constraints cancel the slope of another, as well as they can.

Least squares, small and dense; whatever comes out is sound for what it is used for, so that doubles serve.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import frexp

from flint import fmpq

Slope = Mapping[int, float]
DIGITS = 20  # bits of a weight: more would only make the exact numbers longer


def weights(goal: Slope, others: Sequence[tuple[Slope, bool]]) -> list[fmpq]:
    """For each of the others a weight: of either sign where it is an equality (True), else from zero up."""
    taken = [k for k, (slope, _) in enumerate(others) if any(slope.values())]
    while taken:
        found = _least_squares(goal, [others[k][0] for k in taken])
        wrong = [k for k, w in zip(taken, found, strict=True) if w < 0 and not others[k][1]]
        if not wrong:
            chosen = dict(zip(taken, found, strict=True))
            return [_short(chosen.get(k, 0.0)) for k in range(len(others))]
        taken = [k for k in taken if k not in wrong]
    return [fmpq(0)] * len(others)


def _least_squares(goal: Slope, slopes: Sequence[Slope]) -> list[float]:
    """The weights that bring `goal + sum of weight * slope` nearest to zero (normal equations, slightly damped)."""
    size = len(slopes)
    rows = [[_dot(a, b) for b in slopes] + [-_dot(a, goal)] for a in slopes]
    for k in range(size):
        rows[k][k] = rows[k][k] * (1 + 1e-12)
    for k in range(size):
        pivot = max(range(k, size), key=lambda r: abs(rows[r][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        if rows[k][k] == 0:
            continue
        for r in range(size):
            if r != k and rows[r][k]:
                share = rows[r][k] / rows[k][k]
                rows[r] = [x - share * y for x, y in zip(rows[r], rows[k], strict=True)]
    return [row[size] / row[k] if row[k] else 0.0 for k, row in enumerate(rows)]


def _dot(a: Slope, b: Slope) -> float:
    return sum(x * b[i] for i, x in a.items() if i in b)


def _short(x: float) -> fmpq:
    """A rational of few digits near a double; zero for what is no number."""
    if x != x or abs(x) in (0.0, float("inf")):
        return fmpq(0)
    mantissa, exponent = frexp(x)
    whole = round(mantissa * (1 << DIGITS))
    shift = exponent - DIGITS
    return fmpq(whole << shift) if shift >= 0 else fmpq(whole, 1 << -shift)
