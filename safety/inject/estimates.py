"""Shares of the injections of a campaign, with bounds that fit how these were chosen.

| chosen                       | bounds                                                                              |
|------------------------------|-------------------------------------------------------------------------------------|
| all                          | none: exact                                                                         |
| drawn from all               | hypergeometric; of a part whose size is not known, those for any population         |
| drawn by group               | those of strata that weigh as many injections as they have                          |
| from endlessly many faults   | the same, of a group without end                                                    |
| in scenarios that are drawn  | over the scenarios: what happens under one goes together                            |
| as far as it came            | no share at all: what was done first is no random sample                            |
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from safety.inject.classes import CELLS, Tally
from safety.inject.fmeda import rated
from safety.inject.statistics import Share, Stratum, clustered, clustered_ratio, share, weighted

if TYPE_CHECKING:
    from safety.inject.result import Result

Cells = Sequence[str]


def estimate(result: Result, good: Cells, bad: Cells) -> Share | None:
    """The share of the cells `good` among these and the cells `bad`, all injections alike; None without a case."""
    space, confidence = result.campaign.space, result.campaign.confidence
    hits, of = _sum(result.tally, good), _sum(result.tally, (*good, *bad))
    if result.interrupted or not of:
        return None
    of_all = {*good, *bad} == {*CELLS}
    if result.campaign.vary:
        scenarios = result.by_scenario.values()
        goods, bads = ([_part(tally, cells) for tally in scenarios] for cells in (good, bad))
        return _over_scenarios(goods, bads, confidence, of_all=of_all)
    if (space.by_group or space.drawn) and not result.exhaustive:
        strata = [
            _stratum(group.name, Fraction(space.sizes[group.name]), tally, None if group.drawn else size, good, bad)
            for group in space.groups
            for tally, size in [(result.groups[group.name], space.sizes[group.name])]
        ]
        return weighted(strata, safe_too=False, confidence=confidence)
    known = space.population if of_all else None
    return share(hits, of, exhaustive=result.exhaustive, confidence=confidence, population=known)


def by_rate(result: Result, good: Cells, bad: Cells) -> Share | None:
    """The same with each group weighing its failure rate; None without rates or without a case.

    No group weighs nothing and passes unseen: that is refused before the run (`fmeda.check_rates`).
    """
    campaign, rows = result.campaign, result.rows
    if result.interrupted or not rows or not rated(campaign.space.groups, campaign.id):
        return None
    rates = [row.rate or Fraction(0) for row in rows]
    if campaign.vary:
        scenarios = list(zip(*(row.scenarios for row in rows), strict=True))
        goods, bads = ([_weighed(rates, under, cells) for under in scenarios] for cells in (good, bad))
        return _over_scenarios(goods, bads, campaign.confidence, of_all=False)
    strata = [
        _stratum(row.group.name, rate, row.tally, row.of, good, bad) for row, rate in zip(rows, rates, strict=True)
    ]
    return weighted(strata, safe_too=False, confidence=campaign.confidence)


def _stratum(name: str, weight: Fraction, tally: Tally, of: int | None, good: Cells, bad: Cells) -> Stratum:
    """A group of which there are `of` injections (None: no end of them)."""
    tried = tally.injections
    return Stratum(name, weight, tried, 0, _sum(tally, good), _sum(tally, bad), tried == of, of)


def _over_scenarios(
    good: Sequence[Fraction], bad: Sequence[Fraction], confidence: float, *, of_all: bool
) -> Share | None:
    """From the shares of both under each scenario; `of_all`: there is nothing else, under any scenario."""
    goods, bads = sum(good, Fraction(0)), sum(bad, Fraction(0))
    if not goods + bads:
        return None
    bounds = clustered(good, confidence) if of_all else clustered_ratio(good, bad, confidence)
    return Share(float(goods / (goods + bads)), *bounds)


def _sum(tally: Tally, cells: Cells) -> int:
    return sum(tally[cell] for cell in cells)


def _part(tally: Tally, cells: Cells) -> Fraction:
    return Fraction(_sum(tally, cells), tally.injections)


def _weighed(rates: Sequence[Fraction], tallies: Sequence[Tally], cells: Cells) -> Fraction:
    parts = (rate * _part(tally, cells) for rate, tally in zip(rates, tallies, strict=True))
    return sum(parts, Fraction(0)) / sum(rates, Fraction(0))
