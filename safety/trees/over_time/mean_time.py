"""Mean time to failure of a tree whose events are not repaired: the integral of the reliability over all time.

The reliability is R(t) = 1 - Q(t), as what has failed stays failed and the tree is coherent. With exponential events it
is a sum of exponentials, and where these are few the mean time is an exact rational: the sum of c / s over its terms
c exp(-s t). Otherwise R, computed as the probability that the opposite of the top holds, is integrated by `quadrature`
up to a time T; what remains is at most the sum of (1/r) exp(-r T) over the events whose failure alone is certain to
come, at rates r, provided that the top event is certain when all of these have failed.

A common-cause group has shares of the probability of its members, which no constant failure rate gives. Its mean time
is that of the tree in which it has the same shares of their rates (Study.quantified with `of_rates`).

The mean is infinite if the top event may never come, as when an event of constant probability is needed.
Times in hours. Source: IEC 61703:2016, 6.1.
"""

from __future__ import annotations

import math
from array import array
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from safety.trees.as_written import TreeError
from safety.trees.over_time.behaviour import ZERO, Relaxing
from safety.trees.over_time.mission import CAUSES, Mission
from safety.trees.over_time.quadrature import TOLERANCE, Bounds, doubling, rounding, rules, written
from safety.trees.solve import Solution, solve
from safety.trees.tree import BasicEvent, FaultTree, Gate

MOST_TERMS = 3_000  # of a sum of exponentials
MOST_WORK = 500_000  # terms added or multiplied, in all

Terms = dict[int, Any]  # coefficients by rate


@dataclass(frozen=True)
class MeanTime:
    """Mean time to failure, hours; `bounds` are infinite and `never` positive if the top event may never come."""

    bounds: Bounds
    exact: Fraction | None
    method: str  # "exact", "certified quadrature", "estimated" or "infinite"
    never: float = 0.0  # probability that the top event never comes

    def plain(self) -> dict[str, Any]:
        """The entry of a results document."""
        if self.never:
            return {
                "value": "inf",
                "low": "inf",
                "high": "inf",
                "exact": None,
                "method": self.method,
                "never": self.never,
            }
        return self.bounds.plain() | {"exact": written(self.exact), "method": self.method}


def mean_time_to_failure(tree: FaultTree) -> MeanTime:
    """The mean time until the top event of `tree`.

    Raises TreeError: an event that is repaired or tested, or not of constant probability or failure rate, or has a
    share of the probability of one; an exposure time that is not the mission's; one that changes and can prevent the
    top event; no event below the top that changes. Raises TooLarge.
    """
    mission = Mission(tree, 1)  # only the behaviours count
    if mission.unknown:
        raise TreeError(f"the mean time to failure is not known, as how often events fail is not: {mission.unknown}")
    if not mission.changing:
        raise TreeError(
            f'no event below the top of fault tree "{tree.name}" has a failure rate, so there is no mean time to '
            "failure; give the events rates"
        )
    events = _not_repaired(mission)
    successes = solve(_opposite(tree))
    never = _reliability(successes, [float(1 - event.scale * event.limit) for event in events])
    if never:
        return MeanTime(Bounds(math.inf, math.inf), None, "infinite", never)
    exact = _exact(mission.solution, events) if all(event.is_exact for event in events) else None
    if exact is not None:
        return MeanTime(Bounds.of(exact), exact, "exact")
    return _integrated(mission, events, successes)


def _not_repaired(mission: Mission) -> list[Relaxing]:
    """The behaviours, if the reliability is 1 - Q."""
    events: list[Relaxing] = []
    for name, event in zip(mission.solution.events, mission.events, strict=True):
        below = name in mission.changing
        if below and (not isinstance(event, Relaxing) or event.repair_rate or event.first_test is not None):
            raise TreeError(
                f'basic event "{name}" is repaired, tested or of no constant failure rate; the mean time to failure is '
                "known for constant probabilities and failure rates only",
                name,
            )
        if below and isinstance(event, Relaxing) and event.scale != 1:
            raise TreeError(
                f'basic event "{name}" has {float(event.scale):g} times the probability of an event with a rate, as '
                "one of a common-cause group has: that is no constant failure rate, and the mean time to failure is "
                "not known from it; give it a rate of its own, or let the group share out rates (of_rates)",
                name,
            )
        if below and mission.effects[name] != CAUSES:
            raise TreeError(
                f'basic event "{name}" can prevent the top event, so that it may come and go without a repair; the '
                "mean time to failure needs a tree in which events only cause it",
                name,
            )
        events.append(event if isinstance(event, Relaxing) else Relaxing(ZERO, ZERO))
    return events


def _opposite(tree: FaultTree) -> FaultTree:
    """The tree over "event does not occur" whose top is that the top event does not occur: small chances stay exact."""
    no = "not "
    while any(name.startswith(no) for name in tree.nodes):
        no = "not " + no
    negations = [Gate(event.name, "not", (no + event.name,)) for event in tree.events]
    return replace(
        tree,
        top=no + tree.top,
        gates=(*tree.gates, *negations, Gate(no + tree.top, "not", (tree.top,))),
        events=tuple(BasicEvent(no + event.name) for event in tree.events),
    )


def _reliability(successes: Solution, chances: list[float]) -> float:
    return float(successes.many(array("d", chances))[0])


# --- exactly ----------------------------------------------------------------------------------------------------------


class _TooLong(Exception):
    pass


def _exact(solution: Solution, events: list[Relaxing]) -> Fraction | None:
    """The integral of the reliability, None where it has too many terms."""
    sums = _Sums(math.lcm(*(event.pace.denominator for event in events)))
    try:
        unreliability = sums.top(solution, [sums.terms(event) for event in events])
    except _TooLong:
        return None
    total = sum((-c / rate for rate, c in unreliability.items() if rate), sums.zero)
    return Fraction(int(total.p), int(total.q)) * sums.unit


class _Sums:
    """Sums of exponentials through the diagrams: rationals of FLINT by rate, a whole number of 1 / `unit` per hour."""

    def __init__(self, unit: int) -> None:
        from flint import fmpq

        self.spent, self.unit, self.zero, self.rational = 0, unit, fmpq(0), fmpq
        self.one: Terms = {0: fmpq(1)}

    def terms(self, event: Relaxing) -> Terms:
        """The unavailability of an event."""
        limit, change = event.scale * event.limit, event.scale * (event.start - event.limit)
        result = {0: self.rational(*limit.as_integer_ratio())}
        if event.varies:
            result[int(event.pace * self.unit)] = self.rational(*change.as_integer_ratio())
        return result

    def top(self, solution: Solution, events: list[Terms]) -> Terms:
        """That of the top event."""
        chance = dict(enumerate(events, 1))
        for part in solution.parts:
            diagram = part.diagram
            level, high, low = list(diagram.level), list(diagram.high), list(diagram.low)
            edge: list[Terms] = [self.one, {}]
            for i in range(1, diagram.nodes):
                q, otherwise = chance[part.order[level[i]]], edge[low[i]]
                value = self.plus(otherwise, self.times(q, self.plus(edge[high[i]], otherwise, -1)))
                edge += [value, self.plus(self.one, value, -1)]
            chance[part.number] = edge[diagram.root]
        return chance[solution.parts[-1].number]

    def plus(self, a: Terms, b: Terms, sign: int = 1) -> Terms:
        """a + b or a - b. Raises _TooLong."""
        self._spend(len(b))
        result = dict(a)
        for rate, c in b.items():
            total = result.get(rate, self.zero) + sign * c
            if total:
                result[rate] = total
            else:
                result.pop(rate, None)
        return result

    def times(self, a: Terms, b: Terms) -> Terms:
        """a b. Raises _TooLong."""
        self._spend(len(a) * len(b))
        result: Terms = {}
        for x, c in a.items():
            for y, d in b.items():
                result[x + y] = result.get(x + y, self.zero) + c * d
        if len(result) > MOST_TERMS:
            raise _TooLong
        return result

    def _spend(self, terms: int) -> None:
        self.spent += terms
        if self.spent > MOST_WORK:
            raise _TooLong


# --- by quadrature ----------------------------------------------------------------------------------------------------


def _integrated(mission: Mission, events: list[Relaxing], successes: Solution) -> MeanTime:
    changing = [event for event in events if event.varies]
    certain = [float(event.pace) for event in changing if event.scale * event.limit == 1]

    def reliability(hours: list[float]) -> list[float]:
        return list(successes.many(array("d", [event.up(t) for event in events for t in hours])))

    def remaining(hours: float) -> float:
        return sum(math.exp(-rate * hours) / rate for rate in certain)

    shortest = 1 / max(float(event.pace) for event in changing)
    end = shortest
    scale = 0.0  # the largest of t R(t), at most the mean time
    while remaining(end) > TOLERANCE * scale:
        scale = max(scale, end * reliability([end])[0])
        end *= 2
    ruled = [rule for panel in doubling(ZERO, end, shortest) for rule in rules(changing, panel, scale / end)]
    places = [(offset, weight) for rule in ruled for (_, offset), weight in rule.places()]
    values = reliability([offset for offset, _ in places])
    total = math.fsum(weight * value for (_, weight), value in zip(places, values, strict=True))
    epsilon, cut = rounding(successes), math.fsum(rule.cut for rule in ruled)
    bounds = Bounds(max(0.0, total * (1 - epsilon) - cut), total * (1 + epsilon) + cut + remaining(end))
    return MeanTime(bounds, None, "certified quadrature" if mission.is_coherent else "estimated")
