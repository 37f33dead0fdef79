"""Shares of the injections of a campaign, with bounds that fit how these were chosen.

| chosen                                | bounds                                                                     |
|---------------------------------------|----------------------------------------------------------------------------|
| all                                   | none: exact                                                                |
| drawn from all                        | hypergeometric, or for any population where its size is not known          |
| drawn by group                        | of strata that weigh their injections                                      |
| in scenarios that were drawn          | Hoeffding's, over the scenarios: injections of one scenario go together    |
| as far as it came                     | no share at all: what was done first is no random sample                   |

Hoeffding: JASA 58 (1963), theorem 1, for the mean of the scenarios' shares, which lie between 0 and 1.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from safety.inject.classes import CELLS, Tally
from safety.inject.statistics import Share, Stratum, share, weighted

if TYPE_CHECKING:
    from safety.inject.result import Result


def estimate(result: Result, good: Sequence[str], bad: Sequence[str]) -> Share | None:
    """The share of the cells `good` among these and the cells `bad`; None where there is no case."""
    space, confidence = result.campaign.space, result.campaign.confidence
    hits, of = (sum(result.tally[cell] for cell in cells) for cells in (good, (*good, *bad)))
    if result.interrupted or not of:
        return None
    if result.campaign.vary:
        return _over_scenarios(list(result.by_scenario.values()), good, bad, confidence)
    if space.by_group and not result.exhaustive:
        return weighted(_strata(result.groups, space.sizes, good, bad), safe_too=False, confidence=confidence)
    known = space.population if {*good, *bad} == {*CELLS} else None
    return share(hits, of, exhaustive=result.exhaustive, confidence=confidence, population=known)


def _strata(
    groups: Mapping[str, Tally], sizes: Mapping[str, int], good: Sequence[str], bad: Sequence[str]
) -> list[Stratum]:
    return [
        Stratum(
            name, Fraction(sizes[name]), tally.injections, 0, sum(tally[c] for c in good), sum(tally[c] for c in bad),
            tally.injections == sizes[name],
        )
        for name, tally in groups.items()
    ]  # fmt: skip


def _over_scenarios(
    scenarios: Sequence[Tally], good: Sequence[str], bad: Sequence[str], confidence: float
) -> Share | None:
    """Bounds on a share in all scenarios that there could be; each scenario has as many injections."""
    sums = [
        sum((Fraction(sum(t[c] for c in cells), t.injections) for t in scenarios), Fraction(0)) for cells in (good, bad)
    ]
    means = [float(part / len(scenarios)) for part in sums]
    tails = 2 if {*good, *bad} == {*CELLS} else 4  # of all, the two shares are one; else both have to hold
    reach = math.sqrt(math.log(tails / (1 - confidence)) / (2 * len(scenarios)))
    (least, most), (few, many) = ((max(0.0, mean - reach), min(1.0, mean + reach)) for mean in means)
    if tails == 2:
        return Share(means[0], least, most)
    return Share(float(sums[0] / sum(sums)), least / (least + many), most / (most + few) if most + few else 1.0)
