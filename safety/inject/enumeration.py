"""From the groups of a campaign to its space: every injection, or a stated sample; what cannot be meant is refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from safety.faults import FROM_START, Fault, expand
from safety.inject.ranks import drawn
from safety.inject.space import CampaignError, Group, Space, identify
from safety.system import System, nearest

if TYPE_CHECKING:
    from safety.inject.ranks import Positions

NOUNS = {1: "single faults", 2: "pairs", 3: "triples"}


def enumerate_space(
    system: System,
    groups: Sequence[Group],
    *,
    order: int = 1,
    onsets: range | None = None,
    length: int | None = None,
    scenarios: int = 1,
    sample: int | Mapping[str, int] | None = None,
    seed: int = 0,
) -> Space:
    """All injections of the groups, or `sample` of them drawn without replacement with `seed`.

    `order` 1 injects single faults, 2 all pairs of them, 3 all triples; `onsets` gives each of them every one of these
    first steps, and `length` steps to last (None: it stays).  `sample` by group (order 1) draws so many of each.
    Raises `CampaignError` for an empty or ambiguous list.
    """
    if order not in NOUNS:
        raise CampaignError(f"order {order}: a campaign injects single faults (1), pairs (2) or triples (3)")
    of_group = [(k, fault) for k, group in enumerate(groups) for fault in _expanded(system, group)]
    singles = tuple(fault for _, fault in of_group)
    _refuse_repeats([group.name for group in groups], "group")
    _refuse_repeats([identify(fault) for fault in singles], "fault")
    _check_onsets(singles, onsets, length)
    whole = Space(
        tuple(groups), singles, tuple(k for k, _ in of_group), order, onsets, length, scenarios, None,
        statement="",
    )  # fmt: skip
    if not whole.population:
        raise CampaignError(
            f"there is no {NOUNS[order][:-1]}: name {order} faults or more"
            if singles
            else "no group has a fault: name at least one"
        )
    noun = NOUNS[order] if order == 1 else f"{NOUNS[order]} of {len(singles)} faults"
    if onsets is not None:
        noun += f" at {len(onsets)} onsets"
    if scenarios > 1:
        noun += f" in {scenarios} drawn scenarios"
    return _chosen(whole, noun, sample, seed)


def _chosen(whole: Space, noun: str, sample: int | Mapping[str, int] | None, seed: int) -> Space:
    import numpy as np

    population = whole.population
    if isinstance(sample, Mapping):
        parts = [_of_group(whole, name, number, seed) for name, number in sample.items()]
        missing = [group.name for group in whole.groups if group.name not in sample]
        if missing:
            raise CampaignError(f"sample says nothing of group {missing[0]!r}; give a number for each group")
        statement = f"{sum(map(len, parts))} of {population} {noun}, drawn by group with seed {seed}"
        return replace(whole, chosen=np.sort(np.concatenate(parts)), statement=statement, by_group=True)
    if sample is not None and not 1 <= sample <= population:
        raise CampaignError(
            f"sample={sample} of {population} injections; choose 1 to {population}, or leave it out for all"
        )
    if sample is None or sample == population:
        return replace(whole, statement=f"all {population} {noun}")
    statement = f"{sample} of {population} {noun}, drawn with seed {seed}"
    return replace(whole, chosen=drawn(population, sample, seed), statement=statement)


def _of_group(whole: Space, name: str, number: int, seed: int) -> Positions:
    """So many positions of a group, whose single faults stand side by side."""
    import numpy as np

    if whole.order != 1:
        raise CampaignError("a sample by group is of single faults (order 1); give one number for pairs and triples")
    if name not in whole.sizes:
        raise CampaignError(f"sample names the group {name!r}; {nearest(name, whole.sizes)}")
    if not 1 <= number <= whole.sizes[name]:
        raise CampaignError(
            f"sample={number} of {whole.sizes[name]} injections of {name!r}; choose 1 to {whole.sizes[name]}"
        )
    places = [place for place, group in enumerate(whole.of_group) if whole.groups[group].name == name]
    own = len(places) * whole.times
    found = drawn(whole.sizes[name], number, f"{seed} {name}")
    return np.asarray(found // own * whole.in_a_scenario + places[0] * whole.times + found % own)


def _expanded(system: System, group: Group) -> list[Fault]:
    faults = expand(system, group.faults)
    if not faults:
        raise CampaignError(f"group {group.name!r} has no fault; name some, or leave the group out")
    return faults


def _check_onsets(singles: Sequence[Fault], onsets: range | None, length: int | None) -> None:
    if onsets is None:
        if length is not None:
            raise CampaignError(f"length={length} goes with onsets; without them each fault has its own schedule")
        return
    if not onsets or onsets.step < 1 or (length is not None and length < 1):
        raise CampaignError(f"onsets={onsets}, length={length}: name steps in ascending order, and a length from 1 up")
    for fault in singles:
        if fault.onset != FROM_START:
            raise CampaignError(
                f"fault {identify(fault)!r} has a schedule of its own; leave it out where the campaign has onsets"
            )


def _refuse_repeats(names: Sequence[str], what: str) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise CampaignError(
                f"{what} {name!r} is there twice: leave one out or give it a name of its own (Fault(..., name=...))"
            )
        seen.add(name)
