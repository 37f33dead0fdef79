"""Importance of every basic event, all of them in two passes over the diagrams.

Exact definitions, with P the probability of the top event, q that of the event, P1 = P(top | the event occurs) and
P0 = P(top | it does not):

    birnbaum                 P1 - P0, the derivative of P with respect to q
    criticality              q (P1 - P0) / P
    fussell_vesely           (P - P0) / P, the fraction of P that vanishes with the event
    diagnostic               P(event | top) = q P1 / P
    risk_achievement_worth   P1 / P
    risk_reduction_worth     P / P0, infinite when the top event cannot occur without the event

P is linear in each q, so Fussell-Vesely, so defined, is the same number as the criticality. The probability of the
cut sets with the event over P, which some tools print under that name, differs from it in terms of second order.

Sources: W. E. Vesely et al., NUREG/CR-3385 (1983), worths; Y. Dutuit and A. Rauzy, "Efficient algorithms to assess
component and gate importance in fault tree analysis", Reliability Engineering and System Safety 72 (2001), the
factors and their computation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic

from safety.trees.bdd import Bdd, Chance, Number


@dataclass(frozen=True)
class Importance(Generic[Number]):
    """The measures of one basic event (no unit; see the module). None where 0/0 leaves one without meaning."""

    event: str
    probability: Number
    birnbaum: Number
    criticality: Number | None
    fussell_vesely: Number | None
    diagnostic: Number | None
    risk_achievement_worth: Number | None
    risk_reduction_worth: Number | float | None


def measures(event: str, q: Number, top: Number, with_event: Number, without_event: Number) -> Importance[Number]:
    """All measures of `event` from q, P, P1 and P0 (see the module)."""
    birnbaum = with_event - without_event
    if top == 0:
        return Importance(event, q, birnbaum, None, None, None, None, None)
    lost = q * birnbaum  # P - P0, without its cancellation
    return Importance(
        event,
        q,
        birnbaum,
        criticality=lost / top,
        fussell_vesely=lost / top,
        diagnostic=q * with_event / top,
        risk_achievement_worth=with_event / top,
        risk_reduction_worth=top / without_event if without_event else math.inf,
    )


def conditionals(
    bdd: Bdd,
    root: int,
    variables: Sequence[Chance[Number]],
    chances: dict[int, Chance[Number]],
    zero: Number,
    one: Number,
) -> list[tuple[Number, Number]]:
    """For each variable by level, the probability of `root` when the variable is true, and when it is false.

    `chances` is what `Bdd.chances` gave for the same arguments. Sums of products only: an outcome that cannot happen
    comes out as zero itself, never as a rounding error, which is what makes an infinite risk reduction worth visible.
    """
    when_true, when_false = [zero] * bdd.levels, [zero] * bdd.levels
    skipping: _RangeSums[Number] = _RangeSums(
        bdd.levels, zero
    )  # per level, probability of the true paths that have no node there
    skipping.add(0, bdd.level[root], chances[root][0])
    reach = {root: one}
    for node in reversed(bdd.below(root)):
        level, arrives = bdd.level[node], reach[node]
        for child, taken, total in zip(
            (bdd.high[node], bdd.low[node]), variables[level], (when_true, when_false), strict=True
        ):
            truth = chances[child][0]
            total[level] += arrives * truth
            reach[child] = reach.get(child, zero) + arrives * taken
            skipping.add(level + 1, bdd.level[child], arrives * taken * truth)
    skipped = [skipping.at(level) for level in range(bdd.levels)]
    return [(t + s, f + s) for t, f, s in zip(when_true, when_false, skipped, strict=True)]


class _RangeSums(Generic[Number]):
    """Numbers by index, added to whole ranges at a time (a segment tree: no subtraction, so no cancellation)."""

    def __init__(self, size: int, zero: Number) -> None:
        self.size = size
        self.zero: Number = zero
        self.sums: list[Number] = [zero] * (2 * size)

    def add(self, start: int, stop: int, value: Number) -> None:
        """Add `value` at each index of range(start, stop)."""
        start, stop = start + self.size, stop + self.size
        while start < stop:
            if start & 1:
                self.sums[start] += value
                start += 1
            if stop & 1:
                stop -= 1
                self.sums[stop] += value
            start, stop = start >> 1, stop >> 1

    def at(self, index: int) -> Number:
        """The sum of all that was added at `index`."""
        total, index = self.zero, index + self.size
        while index:
            total += self.sums[index]
            index >>= 1
        return total
