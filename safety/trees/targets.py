"""The inverse problem: which value of a parameter, or of an event's probability, brings the top event to a target?"""

from __future__ import annotations

import itertools
from array import array
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

from safety.trees.exact import Exact
from safety.trees.sampling import parameters
from safety.trees.sensitivity import unknown
from safety.trees.solve import Solution
from safety.trees.tree import Rational, TreeError, exact

DOUBLINGS = 200  # of a quantity, searched for one that meets a target
RELATIVE = 1e-13  # width of the answer
EXACT_NODES = 20_000  # largest diagram whose answer is checked in rationals
WIDENINGS = 40


@dataclass(frozen=True)
class Crossing:
    """Between `low` and `high` of a quantity the top's probability crosses the target.

    `exact` says whether the probabilities at both ends (here as doubles) were compared with it in rationals.
    """

    name: str
    target: float
    low: float
    high: float
    top_low: float
    top_high: float
    exact: bool


def meets(solution: Solution, name: str, target: Rational, start: Rational | None = None) -> Crossing:
    """The value of the parameter or basic event `name` at which the top's probability crosses `target`.

    Searched from `start` (the present value, else 1e-6) downwards and upwards by doublings and then by bisection;
    that the target lies between the probabilities at both ends proves the answer, in rationals where the expressions
    allow it. Raises TreeError: unknown name, a target outside 0..1, no value that meets it.
    """
    search = _Search(solution, name)
    goal = exact(target, "the target")
    if not 0 <= goal <= 1:
        raise TreeError(f"the target is {target}, expected a probability between 0 and 1; correct it")
    first = exact(start, "start") if start is not None else search.present or Fraction(1, 10**6)
    low, high = search.bracket(first, float(goal))
    while high - low > RELATIVE * max(abs(low), abs(high)):
        middle = (low + high) / 2
        if not low < middle < high:
            break
        if search.is_above(middle, float(goal)) == search.is_above(low, float(goal)):
            low = middle
        else:
            high = middle
    checked = search.widened(low, high, goal)
    if checked is not None:
        low, high = checked
    return Crossing(name, float(goal), low, high, search.top(low), search.top(high), checked is not None)


class _Search:
    """The top's probability as a function of one quantity."""

    def __init__(self, solution: Solution, name: str) -> None:
        self.solution, self.name = solution, name
        tree = solution.tree
        self.is_parameter = name in parameters(tree)
        self.events = [
            i
            for i, event in enumerate(tree.events)
            if (
                event.expression is not None and name in event.expression.parameters
                if self.is_parameter
                else event.name == name
            )
        ]
        if not self.events:
            raise unknown(name, tree)
        first = tree.events[self.events[0]]
        self.present = first.exact_chance[0] if first.exact_chance and not self.is_parameter else None
        if self.is_parameter:
            assert first.expression is not None
            value = first.expression.parameters[name].value(first.mission_time_h)
            self.present = exact(value, name) if value else None
        self._base = [event.chance for event in tree.events]
        if None in self._base:
            raise TreeError(f'fault tree "{tree.name}" has events without a probability; give them one')

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

    def bracket(self, start: Fraction, target: float) -> tuple[float, float]:
        """Two values, one above the target and one not."""
        at = float(start)
        above = self.is_above(at, target)
        for walk in (self._downwards(at), self._upwards(at)):
            last = at
            for x in walk:
                crossing, last = self._towards(last, x, target, above)
                if crossing is not None:
                    return min(last, crossing), max(last, crossing)
                if last != x:
                    break  # at the end of the quantity's domain
        raise TreeError(
            f'no value of "{self.name}" brings the top event to {target:g}; its probability is {self.top(at):g} at '
            f"{at:g} and stays {'above' if above else 'at or below'} the target; choose another target or quantity",
            self.name,
        )

    def _towards(self, last: float, x: float, target: float, above: bool) -> tuple[float | None, float]:
        """A value from `last` to `x`, or to the end of the domain, at which the target is crossed, if there is one.

        With it the last value before, at which it is not.
        """
        outside: float | None = None  # the nearest value at which the tree has no probability
        for _ in range(DOUBLINGS):
            try:
                if self.is_above(x, target) != above:
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

    def widened(self, low: float, high: float, goal: Fraction) -> tuple[float, float] | None:
        """The ends moved apart until, in rationals, the goal lies between the probabilities; None if irrational."""
        if self.solution.nodes > EXACT_NODES:
            return None
        step = max(abs(low), abs(high)) * RELATIVE
        for n in range(WIDENINGS):
            by = step * (2.0**n - 1)
            ends = max(low - by, 0.0) if low >= 0 else low - by, high + by
            tops = [self._exactly(end) for end in ends]
            if tops[0] is None or tops[1] is None:
                return None
            if min(tops[0], tops[1]) <= goal <= max(tops[0], tops[1]):
                return ends
        return None

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
