"""What values a function of a few inputs takes, each within its range: with the inputs as witness, or with a proof.

`find` looks for a value in a target, `escapes` for one outside it.  A witness is tried at the corners of the ranges,
then between two points on either side of the target, where a function without a gap crosses it; the value there is
looked at again before it counts.  That there is none is shown by boxes that cover all the ranges.  Counts stay whole.
Nothing is sampled.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from itertools import product
from typing import TypeAlias

from safety.audit.exceptions import Undecided
from safety.audit.spans import Span

Box: TypeAlias = Mapping[str, Span]
Point: TypeAlias = Mapping[str, Fraction]
Function: TypeAlias = Callable[[Box], Span]

CORNERS = 6  # inputs of which all corners are tried; of more, one at a time and all at once
HALVINGS, BOXES, TRIED = 80, 4000, 400
NEAR = Fraction(1, 2**40)  # of the way to a target of no width, at which it counts as reached
NOTHING: frozenset[str] = frozenset()


def find(function: Function, box: Box, start: Box, target: Span, whole: frozenset[str] = NOTHING) -> Point | None:
    """The inputs at which the value lies in the target, nearest to `start` first; None where there are none.

    `start` has the values of all inputs, `box` the ranges of those that have one; those that are `whole` count
    something.  Raises Undecided when the function is too wild, or its inputs come up too often in it, for an answer.
    """
    ranged = {name: each for name, each in box.items() if not each.exact}
    begin = {name: start[name].middle for name in ranged}
    if _within(function, {**start, **_spans(begin)}, target):
        return begin
    if whole.isdisjoint(ranged):
        return _find(function, ranged, start, target, begin)
    left: list[Box] = [ranged]
    for _ in range(BOXES):
        if not left:
            return None
        box = left.pop()
        if _misses(function, {**start, **box}, target):
            continue
        halves = _halves({name: box[name] for name in sorted(whole & box.keys())}, ranged, whole)
        if halves:
            parts = [{**box, **half} for half in halves]
            left += sorted(parts, key=lambda part: all(part[n].low <= at <= part[n].high for n, at in begin.items()))
            continue
        counts = {name: box[name].low for name in whole & box.keys()}
        others = {name: each for name, each in box.items() if name not in counts}
        there = {**start, **_spans(counts)}
        found = _find(function, others, there, target, {name: begin[name] for name in others})
        if found is not None:
            return {**counts, **found}
    raise _open(ranged)


def _find(function: Function, ranged: Box, start: Box, target: Span, begin: Point) -> Point | None:
    """The same for ranges without counts."""

    def at(point: Point) -> Span:
        return function({**start, **_spans(point)})

    first = at(begin)
    if first.within(target):
        return begin
    for corner in _corners(ranged, begin):
        if _has_no_gap(function, {**start, **_between(begin, corner)}):
            there = at(corner)
            if there.within(target):
                return corner
            if _side(there, target) * _side(first, target) < 0:
                found = _crossing(at, begin, corner, _side(first, target), target)
                if found is not None:
                    return found
    left: list[Box] = [ranged]
    for _ in range(BOXES):
        if not left:
            return None
        box = left.pop()
        if not _misses(function, {**start, **box}, target):
            halves = _halves(box, ranged, NOTHING)
            if not halves:
                break
            left += halves
    raise _open(ranged)


def escapes(function: Function, box: Box, start: Box, target: Span, whole: frozenset[str] = NOTHING) -> Point | None:
    """Inputs at which the value does not lie in the target, or there is none; None where it always does.

    Raises Undecided as `find` does.
    """
    ranged = {name: each for name, each in box.items() if not each.exact}
    left: list[Box] = [ranged]
    for point in _corners(ranged, {name: start[name].middle for name in ranged}):
        if not _within(function, {**start, **_spans(point)}, target):
            return point
    for _ in range(BOXES):
        if not left:
            return None
        box = left.pop()
        if _within(function, {**start, **box}, target):
            continue
        middle = _middle(box, whole)
        if not _within(function, {**start, **_spans(middle)}, target):
            return middle
        left += _halves(box, ranged, whole)
    raise _open(ranged)


def lasts(
    function: Function, box: Box, free: Box, start: Box, target: Span, whole: frozenset[str] = NOTHING
) -> Point | None:
    """Values in `box` for which no values in `free` give the target; None where for all in `box` there are some.

    Raises Undecided as `find` does.
    """
    ranged = {name: each for name, each in box.items() if not each.exact}
    left: list[Box] = [ranged]
    for point in _corners(ranged, {name: start[name].middle for name in ranged}):
        if find(function, free, {**start, **_spans(point)}, target, whole) is None:
            return point
    for _ in range(TRIED):
        if not left:
            return None
        box = left.pop()
        middle = _middle(box, whole)
        found = find(function, free, {**start, **_spans(middle)}, target, whole)
        if found is None:
            return middle
        if not _within(function, {**start, **_spans(found), **box}, target):
            left += _halves(box, ranged, whole)
    raise _open(ranged)


def _open(ranged: Box) -> Undecided:
    return Undecided(
        f"whether a value of {', '.join(ranged)} gives what is printed stays open; write the relation so that "
        "each of them stands in it once"
    )


def _spans(point: Point) -> dict[str, Span]:
    return {name: Span(value) for name, value in point.items()}


def _within(function: Function, box: Box, target: Span) -> bool:
    """Whether there is a value everywhere in a box, and in the target."""
    try:
        return function(box).within(target)
    except ArithmeticError:
        return False


def _misses(function: Function, box: Box, target: Span) -> bool:
    """Whether an enclosure of all values in a box lies outside the target."""
    try:
        return not function(box).meets(target)
    except ArithmeticError:
        return False


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


def _middle(box: Box, whole: frozenset[str]) -> Point:
    """The middle of a box, counts rounded down."""
    return {name: Fraction(each.middle // 1) if name in whole else each.middle for name, each in box.items()}


def _halves(box: Box, ranged: Box, whole: frozenset[str]) -> list[Box]:
    """The two halves of a box along its relatively widest side; none for a point."""
    wide = [name for name, each in box.items() if not each.exact]
    if not wide:
        return []
    name = max(wide, key=lambda n: (box[n].high - box[n].low) / (ranged[n].high - ranged[n].low))
    low, high, middle = box[name].low, box[name].high, box[name].middle
    ends = (Fraction(middle // 1), Fraction(middle // 1 + 1)) if name in whole else (middle, middle)
    return [{**box, name: Span(low, ends[0])}, {**box, name: Span(ends[1], high)}]


def _between(a: Point, b: Point) -> dict[str, Span]:
    return {name: Span(min(a[name], b[name]), max(a[name], b[name])) for name in a}


def _has_no_gap(function: Function, box: Box) -> bool:
    """Whether no divisor is 0 and no root of a negative is taken anywhere in a box: there it is continuous."""
    try:
        function(box)
    except ArithmeticError:
        return False
    return True


def _crossing(at: Callable[[Point], Span], a: Point, b: Point, side: int, target: Span) -> Point | None:
    """A point between two on either side of the target with a value in it; None where the function leaps over it.

    For a target of no width, that it comes so near counts.
    """
    begin, middle, value = at(a).distance(target), a, at(a)
    for _ in range(HALVINGS):
        middle = {name: (a[name] + b[name]) / 2 for name in a}
        value = at(middle)
        if value.within(target):
            return middle
        a, b = (middle, b) if _side(value, target) == side else (a, middle)
    return middle if target.exact and value.distance(target) <= begin * NEAR else None
