"""Exact probabilities of which parts are faulty, and of how many: the weights of strata of fault sequences.

    weights = by_pattern({"a": "1e-4", "b": "1e-4", "c": "1e-4"})
    found = total([Trials(name(p), weight, hits[p], tried[p]) for p, weight in weights.items()])

The rare patterns are then tried as often as the common ones, and weigh what they weigh.  Parts fail independently [A];
a common cause is a part of its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction

from safety.inject.space import CampaignError

MOST_PARTS = 16


def by_pattern(probabilities: Mapping[str, Fraction | str]) -> dict[frozenset[str], Fraction]:
    """Probability of each set of faulty parts, from that of each part; the sum is 1.

    Raises `CampaignError` for a probability outside 0 to 1 or in floating point, or more than 16 parts.
    """
    if len(probabilities) > MOST_PARTS:
        raise CampaignError(f"{len(probabilities)} parts have 2^{len(probabilities)} patterns; put parts together")
    found = {frozenset[str](): Fraction(1)}
    for part, given in probabilities.items():
        p = _exact(given, f"part {part!r}")
        found = {s: w * (1 - p) for s, w in found.items()} | {s | {part}: w * p for s, w in found.items()}
    return found


def by_count(probabilities: Iterable[Fraction | str]) -> list[Fraction]:
    """Probability that 0, 1, 2 ... of the parts are faulty; the sum is 1.

    Raises `CampaignError` for a probability outside 0 to 1 or in floating point.
    """
    found = [Fraction(1)]
    for given in probabilities:
        p = _exact(given, "a part")
        found = [(1 - p) * a + p * b for a, b in zip([*found, Fraction(0)], [Fraction(0), *found], strict=True)]
    return found


def _exact(given: Fraction | str, whose: str) -> Fraction:
    if isinstance(given, float):
        raise CampaignError(f"{whose}: probability {given} is a float; write it in quotes, so that it stays exact")
    p = Fraction(given)
    if not 0 <= p <= 1:
        raise CampaignError(f"{whose}: probability {given} does not lie between 0 and 1")
    return p
