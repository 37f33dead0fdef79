"""The inverse problem: which value of a parameter, or of an event's probability, brings the top event to a target?"""

from __future__ import annotations

import itertools
from array import array
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

from safety.trees.as_written import Rational, TreeError, exact
from safety.trees.exact import Exact
from safety.trees.expressions.expression import Parameter
from safety.trees.solve import Solution
from safety.trees.uncertainty.sensitivity import quantity

DOUBLINGS = 200  # of a quantity, searched for one that meets a target
START = Fraction(1, 10**6)  # where the search begins for a quantity that is 0 or unknown
RELATIVE = 1e-13  # width of the answer
JUMP = 1e-6  # part of the top by which it changes over that width only where it jumps
FLAT = 1e-10  # part of the top below which a change may be one of rounding
EXACT_NODES = 20_000  # largest diagram whose answer is checked in rationals
WIDENINGS, GROWTH = 24, 4.0  # from RELATIVE to more than the quantity itself


@dataclass(frozen=True)
class Crossing:
    """Between `low` and `high` of a quantity the top's probability crosses the target; it meets it where they are one.

    `kind` tells a "parameter" from an "event" of the name. `exact` says whether the probabilities at both ends (here
    as doubles) were compared with the target in rationals; `jump` whether the probability leaps over the target, from
    `top_low` to `top_high`, so that no value may meet it; `others_possible` that values further off may meet it, too:
    it is False only where the top is linear in the quantity and not constant.
    """

    name: str
    kind: str
    target: float
    low: float
    high: float
    top_low: float
    top_high: float
    exact: bool
    jump: bool
    others_possible: bool


def meets(solution: Solution, name: str, target: Rational, start: Rational | None = None) -> Crossing:
    """The value of the parameter or basic event `name` at which the top's probability crosses `target`.

    `name` may be written "parameter:x" or "event:x", and must be where both have it. Searched from `start` (the present
    value, else START) downwards and then, if that finds none, upwards, by doublings and then by bisection; that the
    target lies between the probabilities at both ends proves the answer, in rationals where the expressions allow it.
    Raises TreeError: unknown or ambiguous name, a target outside 0..1, no value that meets it.
    """
    search = _Search(solution, name)
    goal = exact(target, "the target")
    if not 0 <= goal <= 1:
        raise TreeError(f"the target is {target}, expected a probability between 0 and 1; correct it")
    first = search.present if start is None else exact(start, "start")
    low, high = search.bracket(first or START, float(goal))
    while high - low > RELATIVE * max(abs(low), abs(high)):
        middle = (low + high) / 2
        if not low < middle < high:
            break
        if search.is_above(middle, float(goal)) == search.is_above(low, float(goal)):
            low = middle
        else:
            high = middle
    tops = search.top(low), search.top(high)
    jump = abs(tops[1] - tops[0]) > JUMP * max(tops)
    checked = search.proven(low, high, goal)
    if checked is not None:
        low, high = checked
        tops = search.top(low), search.top(high)
    return Crossing(
        search.name, search.kind, float(goal), low, high, *tops, checked is not None, jump, not search.is_unique()
    )


class _Search:
    """The top's probability as a function of one quantity."""

    def __init__(self, solution: Solution, name: str) -> None:
        self.solution, tree = solution, solution.tree
        self.kind, self.name = quantity(name, tree)
        name = self.name
        self.is_parameter = self.kind == "parameter"
        self.events = [
            i
            for i, event in enumerate(tree.events)
            if (
                event.expression is not None and name in event.expression.parameters
                if self.is_parameter
                else event.name == name
            )
        ]
        first = tree.events[self.events[0]]
        self.present = exact(first.chance[0], name) if first.chance and not self.is_parameter else None
        if self.is_parameter:
            assert first.expression is not None
            self.present = exact(first.expression.parameters[name].value(first.mission_time_h), name)
        self._base = [event.chance for event in tree.events]
        if None in self._base:
            raise TreeError(f'fault tree "{tree.name}" has events without a probability; give them one')

    def is_unique(self) -> bool:
        """Whether the top is known to be linear in the quantity, as it is in each event's probability, and not flat."""
        if self.is_parameter:
            expressions = [self.solution.tree.events[i].expression for i in self.events]
            if len(expressions) > 1 or not isinstance(expressions[0], Parameter) or expressions[0].name != self.name:
                return False
        ends = self.top(0.0), self.top(1.0)
        return abs(ends[1] - ends[0]) > FLAT * max(ends)

    def top(self, x: float) -> float:
        """The probability at x. Raises TreeError where the tree has none."""
        column = array("d", [chance[0] for chance in self._base if chance is not None])
        for i in self.events:
            column[i] = self._changed(i, x)
        return self.solution.many(column)[0]

    def _changed(self, i: int, x: float) -> float:
        event = self.solution.tree.events[i]
        if not self.is_parameter:
            return x
        assert event.expression is not None
        return event.expression.value(event.mission_time_h, {self.name: x})

    def is_above(self, x: float, target: float) -> bool:
        """Whether the probability at x is above the target."""
        return self.top(x) > target

    def _side(self, x: float, target: float) -> int:
        """1 where the probability at x is above the target, -1 below, 0 at it."""
        top = self.top(x)
        return (top > target) - (top < target)

    def bracket(self, start: Fraction, target: float) -> tuple[float, float]:
        """Two values, one above the target and one not; or twice the one that meets it."""
        at = float(start)
        side = self._side(at, target)
        if not side:
            return at, at
        for walk in (self._downwards(at), self._upwards(at)):
            last = at
            for x in walk:
                crossing, last = self._towards(last, x, target, side)
                if crossing is not None:
                    if not self._side(crossing, target):
                        return crossing, crossing
                    return min(last, crossing), max(last, crossing)
                if last != x:
                    break  # at the end of the quantity's domain
        raise TreeError(
            f'no value of "{self.name}" was found that brings the top event to {target:g}; its probability is '
            f"{self.top(at):g} at {at:g} and stays {'above' if side > 0 else 'below'} the target at all values tried; "
            "choose another target or quantity",
            self.name,
        )

    def _towards(self, last: float, x: float, target: float, side: int) -> tuple[float | None, float]:
        """A value from `last` to `x`, or to the end of the domain, at which the target is reached, if there is one.

        With it the last value before, at which it is not.
        """
        outside: float | None = None  # the nearest value at which the tree has no probability
        for _ in range(DOUBLINGS):
            try:
                if self._side(x, target) != side:
                    return x, last
                last = x
            except TreeError:
                outside = x
            if outside is None:
                break
            x = (last + outside) / 2
            if x in (last, outside):
                break
        return None, last

    def _downwards(self, at: float) -> Iterator[float]:
        return itertools.chain((at * 2.0**-n for n in range(1, DOUBLINGS)), [0.0])

    def _upwards(self, at: float) -> Iterator[float]:
        steps = (at * 2.0**n for n in range(1, DOUBLINGS))
        return steps if self.is_parameter else itertools.chain((x for x in steps if x < 1), [1.0])

    def proven(self, low: float, high: float, goal: Fraction) -> tuple[float, float] | None:
        """The ends moved apart until, in rationals, the goal lies between the probabilities; None if irrational.

        Twice the same end where the goal is met there. Raises TreeError if it is nowhere near.
        """
        if self.solution.nodes > EXACT_NODES:
            return None
        ends, tops = [low, high], [self._exactly(low), self._exactly(high)]
        step = RELATIVE * (max(abs(low), abs(high)) or float(START))
        for n in range(WIDENINGS):
            if tops[0] is None or tops[1] is None:
                return None
            if goal in tops:
                met = ends[tops.index(goal)]
                return met, met
            if min(tops[0], tops[1]) < goal < max(tops[0], tops[1]):
                return ends[0], ends[1]
            by = step * GROWTH**n
            for i, end in enumerate((max(low - by, 0.0) if low >= 0 else low - by, high + by)):
                top = self._exactly(end)
                if top is not None:  # else the domain of the quantity ends before
                    ends[i], tops[i] = end, top
        raise TreeError(
            f'"{self.name}" brings the top event nearer to {float(goal):g} than doubles tell at {low!r}, but in '
            "rationals the probability does not reach it; choose a target a little off",
            self.name,
        )

    def _exactly(self, x: float) -> Fraction | None:
        tree, value = self.solution.tree, Fraction(x)
        events = list(tree.events)
        for i in self.events:
            event = events[i]
            if self.is_parameter:
                assert event.expression is not None
                q = event.expression.exact(event.mission_time_h, {self.name: value})
            else:
                q = value
            if q is None or not 0 <= q <= 1:
                return None
            events[i] = replace(event, probability=q, expression=None, rate_per_hour=None)
        return Exact(replace(tree, events=tuple(events)), self.solution.parts).probability
