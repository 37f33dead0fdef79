"""From the groups of a campaign to its space: every injection, or a stated sample; what cannot be meant is refused."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from safety.faults import FROM_START, Fault, expand
from safety.inject.ranks import drawn
from safety.inject.space import JOINT, CampaignError, Group, Space, identify, without_onset
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
    of_group = [(k, fault) for k, group in enumerate(groups) for fault in _expanded(system, group, seed)]
    singles = tuple(fault for _, fault in of_group)
    _refuse_repeats([group.name for group in groups], "group")
    _refuse_repeats([identify(fault) for fault in singles], "fault")
    if order > 1:
        _refuse_ambiguous([identify(fault) for fault in singles], order)
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
        noun += f" at {len(onsets)} onsets" if len(onsets) > 1 else f" at step {onsets[0]}"
    where = f" in each of {scenarios} drawn scenarios" if scenarios > 1 else ""
    if whole.drawn:
        where = f", {_drawn_faults(whole, sample)} of them drawn with seed {seed}"
    return _chosen(whole, noun, where, sample, seed)


def _chosen(whole: Space, noun: str, where: str, sample: int | Mapping[str, int] | None, seed: int) -> Space:
    """The space with what was drawn; anew in each scenario, as many in each."""
    import numpy as np

    population = whole.in_a_scenario
    if sample is None or sample == population:
        return replace(whole, statement=f"all {population} {noun}{where}")
    seeds = [seed if whole.scenarios == 1 else f"{seed} {scenario}" for scenario in range(whole.scenarios)]
    if isinstance(sample, Mapping):
        parts, how = [_by_group(whole, sample, own) for own in seeds], "drawn by group"
    elif 1 <= sample <= population:
        parts, how = [drawn(population, sample, own) for own in seeds], "drawn"
    else:
        raise CampaignError(
            f"sample={sample} of {population} injections; choose 1 to {population}, or leave it out for all"
        )
    statement = f"{len(parts[0])} of {population} {noun}{where}, {how} with seed {seed}"
    chosen = np.concatenate([part + scenario * population for scenario, part in enumerate(parts)])
    return replace(whole, chosen=chosen, statement=statement, by_group=isinstance(sample, Mapping))


def _by_group(whole: Space, sample: Mapping[str, int], seed: int | str) -> Positions:
    """So many positions of each group; the single faults of a group stand side by side."""
    import numpy as np

    if whole.order != 1:
        raise CampaignError("a sample by group is of single faults (order 1); give one number for pairs and triples")
    names = [group.name for group in whole.groups]
    for name in sample:
        if name not in names:
            raise CampaignError(f"sample names the group {name!r}; {nearest(name, names)}")
    parts, start = [], 0
    for place, name in enumerate(names):
        size = whole.of_group.count(place) * whole.times
        number = sample.get(name, 0)
        if not 1 <= number <= size:
            raise CampaignError(f"sample={number} of {size} injections of {name!r}; choose 1 to {size}")
        parts.append(start + drawn(size, number, f"{seed} {name}"))
        start += size
    return np.concatenate(parts)


def _drawn_faults(whole: Space, sample: object) -> int:
    """How many faults are drawn from endlessly many.

    Raises `CampaignError` where the injections would not be independent draws: bounds would then say too much.
    """
    if whole.order > 1 or whole.times > 1 or whole.scenarios > 1 or sample is not None:
        raise CampaignError(
            "a group with drawn= is injected once a fault, singly (order 1, no sample, scenario or range of onsets); "
            "draw the onset with the fault"
        )
    return sum(group.drawn or 0 for group in whole.groups)


def _expanded(system: System, group: Group, seed: int) -> list[Fault]:
    if group.drawn is not None:
        made = [group.faults(random.Random(f"{seed} {group.name} {k}")) for k in range(group.drawn)]
        return [replace(fault, name=f"{fault.name}, draw {k}") for k, fault in enumerate(made)]
    faults = expand(system, group.faults)
    if not faults:
        raise CampaignError(f"group {group.name!r} has no fault; name some, or leave the group out")
    return faults


def _check_onsets(singles: Sequence[Fault], onsets: range | None, length: int | None) -> None:
    if onsets is None:
        if length is not None:
            raise CampaignError(f"length={length} goes with onsets; without them each fault has its own schedule")
        return
    if not isinstance(onsets, range) or (length is not None and type(length) is not int):
        raise CampaignError(f"onsets={onsets!r}, length={length!r}: write range(first, end, step) and a whole number")
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


def _refuse_ambiguous(names: Sequence[str], order: int) -> None:
    """Two lists of names give one id where one goes on after a name of the other, and that ends with one of the first.

    So ` & ` within a name is fine unless both are there: `a`, `b & c` and `a & b`, `c` would both be `a & b & c`.  Of
    triples more is refused than has to be.
    """
    whole = set(names)
    cuts = [
        (name, JOINT.join(parts[:k]), JOINT.join(parts[k:]))
        for name in names
        for parts in [name.split(JOINT)]
        for k in range(1, len(parts))
    ]
    between = {without_onset(before)[0] for _, before, last in cuts if last in whole}
    for name, before, after in cuts:
        firsts = {before, without_onset(before)[0]} & whole
        if firsts and between and (order > 2 or without_onset(after)[0] in between):
            raise CampaignError(
                f"fault {name!r} begins with the name of fault {min(firsts)!r}, so that ids could mean two injections; "
                "give it another name (Fault(..., name=...))"
            )
