"""Injecting at random until a coverage is surely above, or surely below, its target.

    found = until_sure(campaign, "0.99", by_rate=True)
    found.watch.answer, found.watch.bounds

Every injection is drawn from all of the space, independently of the others (so some may be drawn twice, and are run
once): by equal chances, or with `by_rate` the group by its failure rate and the fault within it by equal chances.  The
plain share of what was drawn is then the coverage by rate, without strata.  The answer may be looked for after every
batch: its error holds over all looks together.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

from safety.inject.classes import CELLS, Tally
from safety.inject.figures import GOOD, good
from safety.inject.figures import count as behind
from safety.inject.fmeda import rated
from safety.inject.space import CampaignError, Space
from safety.inject.statistics import StopWhenSure
from safety.system import nearest

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from safety.inject.campaign import Campaign

    Positions = npt.NDArray[np.int64]

FIRST, LARGEST = 1024, 2**18  # draws of a batch


@dataclass(frozen=True)
class Stopped:
    """Where it stopped: what was watched, all that was drawn, and what figure that is."""

    watch: StopWhenSure
    tally: Tally
    figure: str
    by_rate: bool

    def to_json(self) -> dict[str, Any]:
        """The keys of `StopWhenSure`, with figure, by_rate and the cells."""
        return self.watch.to_json() | {"figure": self.figure, "by_rate": self.by_rate, "cells": self.tally.table}


def until_sure(
    campaign: Campaign,
    target: Fraction | str,
    *,
    figure: str = "diagnostic_coverage",
    by_rate: bool = False,
    most: int = 10**7,
    seed: int = 0,
) -> Stopped:
    """Inject at random until `figure` is surely at least or at most `target`, or `most` injections are drawn.

    `figure`: diagnostic_coverage or safe_failure_fraction.  The confidence is that of the campaign.  Raises
    `CampaignError` for another figure, a target that does not lie between 0 and 1 or is in floating point, a campaign
    that draws scenarios or a sample itself, and with `by_rate` without the rate of each group, or for pairs.
    """
    import numpy as np

    if figure not in GOOD:
        raise CampaignError(f"{campaign.id}: figure {figure!r}; {nearest(figure, GOOD)}")
    if isinstance(target, float) or not 0 < Fraction(target) < 1:
        raise CampaignError(f"{campaign.id}: target {target!r}; give a number between 0 and 1 in quotes, e.g. '0.99'")
    if campaign.vary or campaign.sample is not None:
        given = "vary" if campaign.vary else "sample"
        raise CampaignError(f"{campaign.id}: {given} draws already; leave it out where injections are drawn until sure")
    space = campaign.space
    if space.drawn:
        raise CampaignError(
            f"{campaign.id}: drawn= takes a few faults out of endlessly many, and to draw from these few again says "
            "nothing about the rest; draw more of them instead"
        )
    weights = _weights(campaign) if by_rate else None
    rng, watch, size = np.random.default_rng(seed), StopWhenSure(Fraction(target), campaign.confidence), FIRST
    cells, drawn = np.zeros(len(CELLS), dtype=np.int64), 0
    tally = Tally({})
    while watch.answer == "go on" and drawn < most:
        number = min(size, most - drawn)
        positions, times = np.unique(_draw(space, weights, number, rng), return_counts=True)
        part = copy.copy(campaign)
        part.space = replace(space, chosen=positions)
        found = part.judged(0, len(positions)).cells
        cells += np.bincount(found, weights=times, minlength=len(CELLS)).astype(np.int64)
        drawn, size, tally = drawn + number, min(2 * size, LARGEST), Tally.numbered(cells.tolist())
        if of := behind(tally, figure):
            watch.look(good(tally, figure), of)
    return Stopped(watch, tally, figure, by_rate)


def _weights(campaign: Campaign) -> list[float]:
    """The part of the failure rate that each group has."""
    if campaign.order != 1:
        raise CampaignError(f"{campaign.id}: by_rate is for single faults; pairs and triples have no rate of their own")
    groups = campaign.space.groups
    if not rated(groups, campaign.id):
        raise CampaignError(f"{campaign.id}: by_rate, but no group has a failure rate; give each its rate_per_h")
    rates = [cast(Fraction, group.rate_per_h) for group in groups]
    return [float(rate / sum(rates)) for rate in rates]


def _draw(space: Space, weights: list[float] | None, number: int, rng: np.random.Generator) -> Positions:
    """So many positions, each drawn from all; with weights, of a group by its weight."""
    import numpy as np

    if weights is None:
        return rng.integers(space.population, size=number, dtype=np.int64)
    of_group = np.array(space.of_group)
    sizes = np.bincount(of_group, minlength=len(weights))
    starts = np.searchsorted(of_group, np.arange(len(weights)))  # the faults of a group stand side by side
    group = rng.choice(len(weights), size=number, p=weights)
    single = starts[group] + rng.integers(sizes[group])
    return np.asarray(single * space.times + rng.integers(space.times, size=number), dtype=np.int64)
