"""What constraints leave of the variables: a first box from the constraints alone, and one variable in a box."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

from flint import fmpq

from safety.prove.bounds.cases import AT, Atom, Case
from safety.prove.bounds.polynomials import ZERO, Box, Interval, Polynomial, quotient, root, rounded

Open = tuple[fmpq | None, fmpq | None]  # an interval that may lack an end


def first_box(case: Case, size: int) -> tuple[Box | None, int | None]:
    """The box that the constraints leave, or none; and the first variable to which they leave no end."""
    ends: list[Open] = [(None, None)] * size
    for _ in range(size + 1):
        before = list(ends)
        for atom in case:
            for i in atom.polynomial.variables:
                others = [ends[j] for j in atom.polynomial.variables if j != i]
                if all(low is not None and high is not None for low, high in others):
                    left = left_by(atom, i, ends)
                    if left is None:
                        return None, None
                    ends[i] = left
        if before == ends:
            break
    box: Box = []
    used = {i for atom in case for i in atom.polynomial.variables}
    for i, (low, high) in enumerate(ends):
        if i not in used:
            low = high = ZERO
        if low is None or high is None:
            return [], i
        box.append((low, high))
    return box, None


def left_by(atom: Atom, variable: int, box: Sequence[Open]) -> Open | None:
    """The values of a variable for which the atom may hold somewhere in the box; None for no value.

    The variable itself may lack an end, the others in the atom may not.
    """
    low, high = box[variable]
    others = cast(Box, box)  # the other variables have both ends
    parts = atom.polynomial.in_powers_of(variable)
    shape = set(parts) - {0}
    if shape in ({1}, {2}):
        (power,) = shape
        left = _image(atom.relation, parts[power], parts.get(0), others)
        if left is not None:
            left = _square_root(left, (low, high)) if power == 2 else left
            return None if left is None else _common((low, high), left)
    if low is None or high is None:
        return low, high
    slope = atom.polynomial.derivative(variable).over(others)
    if slope[0].p <= 0 <= slope[1].p:
        return low, high
    middle = (low + high) / 2
    value = atom.polynomial.over([*others[:variable], (middle, middle), *others[variable + 1 :]])
    least, most = _reached(atom.relation, slope, value)
    return _common((low, high), (None if least is None else least + middle, None if most is None else most + middle))


def _image(relation: str, factor: Polynomial, rest: Polynomial | None, box: Box) -> Open | None:
    """What `factor * y + rest` standing so to zero leaves of y; None where the factor may be zero."""
    slope = factor.over(box)
    return (
        None if slope[0].p <= 0 <= slope[1].p else _reached(relation, slope, rest.over(box) if rest else (ZERO, ZERO))
    )


def _reached(relation: str, slope: Interval, value: Interval) -> Open:
    """Where `slope * y + value` can be zero (an equality), or from zero up; the slope is not zero."""
    low, high = quotient((-value[1], -value[0]), slope)
    if relation == AT:
        return low, high
    return (low, None) if slope[0] > 0 else (None, high)


def _square_root(square: Open, now: Open) -> Open | None:
    """The y with y * y in `square` and y in `now`; None for no value."""
    low, high = now
    least, most = square
    if most is not None:
        if most < 0:
            return None
        reach = root(most, True)
        shared = _common((low, high), (-reach, reach))
        if shared is None:
            return None
        low, high = shared
    if least is not None and least > 0:
        away = root(least, False)
        low = away if low is not None and low > -away else low
        high = -away if high is not None and high < away else high
    return low, high


def _common(now: Open, new: Open) -> Open | None:
    """What two intervals share, new ends rounded outwards; None for nothing."""
    low, high = now
    if new[0] is not None and (low is None or new[0] > low):
        low = max(rounded(new[0], False), low) if low is not None else rounded(new[0], False)
    if new[1] is not None and (high is None or new[1] < high):
        high = min(rounded(new[1], True), high) if high is not None else rounded(new[1], True)
    return None if low is not None and high is not None and low > high else (low, high)
