"""How likely one mission becomes dangerous, with several faults in it, each by chance and at any time.

    found = mission(campaign, {"channel a": "1e-4", "channel b": "1e-4", "supply": "1e-6"}, runs=10_000,
                    stratum=lambda faulty: len({name for name in faulty if name.startswith("channel")}))

A mission is the measured frames of the campaign: the hazard counts in these only, so faults begin in these only.  Each
group has a fault during the mission with its probability, independently [A]: one of its faults, at one of the frames
of the mission, all alike.  Plain sampling would hardly ever draw two.  So the missions are divided into strata by
`stratum`, a function of which groups are faulty (how many, unless given otherwise: how many channels, which of them),
and each stratum is tried as often as the others and weighs its exact probability.  A stratum left out counts as
dangerous.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from safety.inject.classes import CELLS, NO_EFFECT, Tally
from safety.inject.engine import NEVER, NONE, Batch
from safety.inject.judging import judge, onset_frames
from safety.inject.patterns import by_pattern
from safety.inject.space import CampaignError
from safety.inject.statistics import Share, Trials, total
from safety.system import nearest

if TYPE_CHECKING:
    import numpy as np

    from safety.inject.campaign import Campaign

Faulty = frozenset[str]
BATCH = 2**16  # missions side by side


@dataclass(frozen=True)
class Mission:
    """The probability of a dangerous undetected mission, by strata: their weight and what was found in each.

    `left_out`: the probability of the strata that were not tried; it is part of the estimate.
    """

    probability: Share
    strata: Mapping[Hashable, Trials]
    tallies: Mapping[Hashable, Tally]
    left_out: Fraction

    @property
    def plain_runs(self) -> float:
        """How many missions drawn plainly would show, by their number alone, so small a bound: 1 / its upper end."""
        return 1 / self.probability.high


def mission(
    campaign: Campaign,
    chances: Mapping[str, Fraction | str],
    *,
    runs: int | Mapping[Hashable, int],
    stratum: Callable[[Faulty], Hashable] = len,
    seed: int = 0,
) -> Mission:
    """Estimate it with `runs` missions a stratum, or so many of each (0: left out), with bounds valid for all at once.

    `chances`: probability of a fault in each group of the campaign (16 groups at most) during the mission, which is the
    measured frames of the campaign; faults last `length` steps, as those of the campaign, or stay.  Raises
    `CampaignError` for a group that is missing or unknown, a chance that is none, drawn scenarios, a fault-free run
    that is judged faulty, and runs for no stratum or an unknown one.
    """
    import numpy as np

    groups = [group.name for group in campaign.space.groups]
    for name in sorted(chances.keys() ^ set(groups)):
        raise CampaignError(f"{campaign.id}: the chances differ from the groups in {name!r}; {nearest(name, groups)}")
    if campaign.vary:
        raise CampaignError(f"{campaign.id}: vary draws scenarios; a mission has one stimulus, leave it out")
    if campaign.space.drawn:
        raise CampaignError(f"{campaign.id}: drawn= takes a few faults out of endlessly many; a mission draws from all")
    golden = campaign.engine_of().golden
    if judge(campaign, golden, golden, NEVER).cells[0] != NO_EFFECT:
        raise CampaignError(f"{campaign.id}: the fault-free run is judged faulty; correct the judges or the stimulus")
    patterns: dict[Hashable, list[tuple[Faulty, Fraction]]] = {}
    for faulty, weight in by_pattern(chances).items():
        if weight:
            patterns.setdefault(stratum(faulty), []).append((faulty, weight))
    for key in () if isinstance(runs, int) else runs.keys() - patterns.keys():
        raise CampaignError(f"{campaign.id}: runs name no stratum {key!r}; they are {', '.join(map(str, patterns))}")
    rng = np.random.default_rng(seed)
    strata, tallies, left_out = {}, {}, Fraction(0)
    for key, members in patterns.items():
        weight = sum((w for _, w in members), Fraction(0))
        number = runs if isinstance(runs, int) else runs.get(key, 0)
        if [faulty for faulty, _ in members] == [frozenset()]:
            strata[key] = Trials(str(key), weight, 0, 1, exhaustive=True)  # the fault-free run
        elif number < 1:
            strata[key], left_out = Trials(str(key), weight, 1, 1, exhaustive=True), left_out + weight
        else:
            tallies[key] = _tried(campaign, members, weight, number, rng)
            strata[key] = Trials(str(key), weight, tallies[key].dangerous_undetected, number)
    if not tallies:
        raise CampaignError(f"{campaign.id}: runs={runs!r} tries no stratum that has a fault; give at least 1")
    return Mission(total(list(strata.values()), campaign.confidence), strata, tallies, left_out)


def _tried(
    campaign: Campaign, members: list[tuple[Faulty, Fraction]], weight: Fraction, number: int, rng: np.random.Generator
) -> Tally:
    """Run and judge so many missions of a stratum."""
    import numpy as np

    cells = np.zeros(len(CELLS), dtype=np.int64)
    likely = [float(w / weight) for _, w in members]
    which = rng.choice(len(members), size=number, p=np.array(likely) / sum(likely))
    for start in range(0, number, BATCH):
        batch = _batch(campaign, [members[i][0] for i in which[start : start + BATCH]], rng)
        engine = campaign.engine_of()
        found = judge(campaign, engine.run(batch), engine.golden, onset_frames(campaign, batch))
        cells += np.bincount(found.cells, minlength=len(CELLS))
    return Tally.numbered(cells.tolist())


def _batch(campaign: Campaign, missions: list[Faulty], rng: np.random.Generator) -> Batch:
    """For each mission one fault of each faulty group, at a measured frame of its own; rows in the groups' order."""
    import numpy as np

    space, timing = campaign.space, campaign.timing
    of_group = np.array(space.of_group)
    length = NEVER if campaign.length is None else min(campaign.length, NEVER)
    atoms = np.full((len(space.groups), len(missions)), NONE, dtype=np.int32)
    first, end = np.zeros_like(atoms), np.zeros_like(atoms)
    for row, group in enumerate(space.groups):
        there = np.array([group.name in faulty for faulty in missions])
        own = np.flatnonzero(of_group == row)
        atoms[row, there] = own[rng.integers(len(own), size=int(there.sum()))]
        first[row] = np.where(there, rng.integers(timing.run_in, timing.frames, size=len(missions)) * timing.steps, 0)
        end[row] = np.where(there, np.minimum(first[row].astype(np.int64) + length, NEVER), 0)
    order = np.argsort(atoms == NONE, axis=0, kind="stable")[: max(1, *map(len, missions))]
    return Batch(*(np.take_along_axis(array, order, axis=0) for array in (atoms, first, end)))
