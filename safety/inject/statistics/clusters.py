"""Bounds on a mean share from clusters: all injections of one drawn scenario stand or fall together.

A thousand faults under five drawn speed profiles are no five thousand independent trials; what is independent is the
five.  Hoeffding (JASA 58, 1963, theorem 1): the mean of n independent numbers of 0 to 1 with expectation p is x or less
(x < p), and likewise x or more (x > p), with a probability of at most exp(-n KL(x, p)), where
KL(x, p) = x log(x/p) + (1-x) log((1-x)/(1-p)).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

from safety.inject.statistics.sequences import last_excluded
from safety.inject.statistics.tails import SLACK, deviance, one_tail


def clustered(shares: Sequence[Fraction], confidence: float = 0.99) -> tuple[float, float]:
    """Two-sided bounds on the expected share, from the share found in each of some independent clusters.

    Raises `ValueError` without a cluster, for a share outside 0 to 1, or unless 0 < confidence < 1.
    """
    if not shares or not all(0 <= share <= 1 for share in shares):
        raise ValueError(f"shares {', '.join(map(str, shares[:5]))}: give at least one, each from 0 to 1")
    bar = -math.log(float(one_tail(confidence))) * (1 + SLACK)
    hits = float(sum(shares, Fraction(0)))
    misses = float(sum((1 - share for share in shares), Fraction(0)))

    def excluded(p: float) -> bool:
        far = 0.0
        for found, share in ((hits, p), (misses, 1 - p)):
            if share <= 0:
                far += math.inf if found else 0.0
            else:
                far += deviance(found, len(shares) * share) if found else len(shares) * share
        return far >= bar

    middle = hits / len(shares)
    return last_excluded(excluded, 0.0, middle) if hits else 0.0, last_excluded(
        excluded, 1.0, middle
    ) if misses else 1.0


def clustered_ratio(good: Sequence[Fraction], bad: Sequence[Fraction], confidence: float = 0.99) -> tuple[float, float]:
    """Bounds on expected good / (good + bad), from the shares of both in each cluster, which hold together.

    Raises as `clustered`.
    """
    each = float(1 - one_tail(confidence))  # half of the error for the bounds of the good, half for those of the bad
    (good_low, good_high), (bad_low, bad_high) = clustered(good, each), clustered(bad, each)
    low = good_low / (good_low + bad_high) if bad_high else 1.0
    high = good_high / (good_high + bad_low) if good_high else 0.0
    return low * (1 - SLACK), min(high * (1 + SLACK), 1.0)
