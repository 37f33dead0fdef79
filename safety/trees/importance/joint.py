"""Joint importance of pairs of events, and the differential importance of events and groups of them.

With P the probability of the top event and q of events:

    joint                  d2P / dq_i dq_j: how much the Birnbaum importance of one rises with the other's probability.
                           Positive where both are needed (an and), negative where either is enough (an or)
    differential           what part of a small change of P comes from the event when every q changes by the same
                           amount: B_i / sum of B
    differential_relative  the same when every q changes by the same fraction: B_i q_i / sum of B q

where B is the Birnbaum importance. The two differential measures add up: that of a group is the sum of its members'.

Sources: J. S. Hong and C. H. Lie, "Joint reliability-importance of two edges in an undirected network", IEEE Trans.
Reliability 42 (1993); E. Borgonovo and G. E. Apostolakis, "A new importance measure for risk-informed decision making",
Reliability Engineering and System Safety 72 (2001).
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Collection, Iterable
from dataclasses import dataclass

from safety.trees.as_written import TreeError
from safety.trees.solve import Solution

CANCELLED = 1e-12  # a sum so small beside its terms is rounding


@dataclass(frozen=True)
class Joint:
    """The joint importance of a pair of events (no unit)."""

    events: tuple[str, str]
    joint: float


@dataclass(frozen=True)
class Differential:
    """The differential importance of a group of events (no unit); None where P does not change at all."""

    events: tuple[str, ...]
    differential: float | None
    differential_relative: float | None


def joint_importance(solution: Solution, events: Collection[str] | None = None) -> list[Joint]:
    """The joint importance of every pair of `events` (all events if None), the largest in size first.

    P is linear in each q, so the second derivative is the difference of the first at q_i = 1 and q_i = 0: exact, but
    for rounding of about 1e-16 of the larger of these. All pairs of n events take 2n passes over the diagram.
    Raises TreeError: an unknown event, or one below the top without a probability.
    """
    names = list(dict.fromkeys(solution.events if events is None else events))
    at = {name: row for row, name in enumerate(solution.events)}
    _check(solution, names)
    width = 2 * len(names)
    columns = array("d")
    for event in solution.tree.events:
        columns.extend([event.chance[0] if event.chance else 0.0] * width)
    for place, name in enumerate(names):
        columns[at[name] * width + 2 * place] = 1.0
        columns[at[name] * width + 2 * place + 1] = 0.0
    slopes = solution.many_derivatives(columns)
    pairs = [
        Joint((first, second), slopes[row + 2 * i] - slopes[row + 2 * i + 1])
        for i, first in enumerate(names)
        for second in names[i + 1 :]
        for row in [at[second] * width]
    ]
    return sorted(pairs, key=lambda pair: (-abs(pair.joint), pair.events))


def differential_importance(solution: Solution, groups: Iterable[Collection[str]] | None = None) -> list[Differential]:
    """The differential importance of each of `groups` (each event by itself if None), in that order.

    Raises TreeError: an unknown event, or one below the top without a probability.
    """
    wanted = [(name,) for name in solution.events] if groups is None else [tuple(dict.fromkeys(g)) for g in groups]
    _check(solution, [name for group in wanted for name in group])
    measures = solution.importance()
    slope = {name: m.birnbaum for name, m in measures.items()}
    moved = {name: m.birnbaum * m.probability for name, m in measures.items()}
    result = []
    for group in wanted:
        parts = [_part(change, group) for change in (slope, moved)]
        result.append(Differential(group, *parts))
    return result


def _part(change: dict[str, float], group: Iterable[str]) -> float | None:
    whole = math.fsum(change.values())
    if abs(whole) <= CANCELLED * math.fsum(map(abs, change.values())):
        return None
    return math.fsum(change.get(name, 0.0) for name in group) / whole


def _check(solution: Solution, names: Iterable[str]) -> None:
    if solution.probability is None:
        unknown = next(event.name for event in solution.tree.events if event.chance is None)
        raise TreeError(f'basic event "{unknown}" has no probability, so there is no importance; give it one', unknown)
    for name in names:
        if name not in solution.events:
            raise TreeError(
                f'fault tree "{solution.tree.name}" has no basic event "{name}"; name one of its events', name
            )
