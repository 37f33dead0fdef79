"""Can a function of a few inputs, each within its range, take a value in a target?  With the inputs, or with a proof.

"Yes" is a point: tried at the corners of the ranges, then between two points on either side of the target, where the
function, being continuous there, crosses it.  "No" is a cover of all the ranges by boxes whose enclosures miss the
target.  Nothing is sampled.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from itertools import product
from typing import TypeAlias

from safety.audit.exceptions import AuditError
from safety.audit.spans import Span

Box: TypeAlias = Mapping[str, Span]
Point: TypeAlias = Mapping[str, Fraction]
Function: TypeAlias = Callable[[Box], Span]

CORNERS = 6  # inputs of which all corners are tried; of more, one at a time and all at once
HALVINGS, BOXES = 80, 4000


def find(function: Function, box: Box, start: Box, target: Span) -> Point | None:
    """The inputs at which the value lies in the target, nearest to `start` first; None where there are none.

    `start` has the values of all inputs, `box` the ranges of those that have one.  Raises AuditError when the function
    is too wild, or its inputs come up too often in it, for either answer.
    """
    ranged = {name: each for name, each in box.items() if not each.exact}
    begin = {name: start[name].middle for name in ranged}

    def at(point: Point) -> Span:
        return function({**start, **{name: Span(value) for name, value in point.items()}})

    first = at(begin)
    if first.within(target):
        return begin
    for corner in _corners(ranged, begin):
        if not _has_no_gap(function, {**start, **_between(begin, corner)}):
            continue
        there = at(corner)
        if there.within(target):
            return corner
        if _side(there, target) * _side(first, target) < 0:
            return _crossing(at, begin, corner, _side(first, target), target)
    if not _missed(function, ranged, start, target):
        raise AuditError(
            f"whether a value of {', '.join(ranged)} gives what is printed stays open; write the relation so that "
            "each of them stands in it once"
        )
    return None


def _side(value: Span, target: Span) -> int:
    """-1 below the target, 1 above it, 0 neither."""
    return -1 if value.high < target.low else 1 if value.low > target.high else 0


def _corners(ranged: Box, begin: Point) -> Iterator[Point]:
    for name, ends in ranged.items():
        for end in (ends.low, ends.high):
            yield {**begin, name: end}
    if len(ranged) <= CORNERS:
        for ends in product(*((each.low, each.high) for each in ranged.values())):  # type: ignore[assignment]
            yield dict(zip(ranged, ends, strict=True))  # type: ignore[call-overload]


def _between(a: Point, b: Point) -> dict[str, Span]:
    return {name: Span(min(a[name], b[name]), max(a[name], b[name])) for name in a}


def _has_no_gap(function: Function, box: Box) -> bool:
    """Whether no divisor is 0 and no root of a negative is taken anywhere in a box: there it is continuous."""
    try:
        function(box)
    except ArithmeticError:
        return False
    return True


def _crossing(at: Callable[[Point], Span], a: Point, b: Point, side: int, target: Span) -> Point:
    """A point between two on either side of the target; for a target of no width, within 2**-80 of the way to it."""
    middle = a
    for _ in range(HALVINGS):
        middle = {name: (a[name] + b[name]) / 2 for name in a}
        value = at(middle)
        if value.within(target):
            break
        a, b = (middle, b) if _side(value, target) == side else (a, middle)
    return middle


def _missed(function: Function, ranged: Box, start: Box, target: Span) -> bool:
    """Whether boxes that cover all the ranges miss the target; False when the search ends without an answer."""
    widths = {name: each.high - each.low for name, each in ranged.items()}
    left: list[Box] = [ranged]
    for _ in range(BOXES):
        if not left:
            return True
        box = left.pop()
        try:
            if not function({**start, **box}).meets(target):
                continue
        except ArithmeticError:
            pass
        if not widths:
            return False
        name = max(box, key=lambda n: (box[n].high - box[n].low) / widths[n])
        middle = box[name].middle
        left += [{**box, name: Span(box[name].low, middle)}, {**box, name: Span(middle, box[name].high)}]
    return False
