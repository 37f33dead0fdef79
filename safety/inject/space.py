"""The faults that a campaign injects: groups of faults, all of them or a stated sample, singly or in pairs.

    Group("stage", stuck_bits("ring"), part="ring register", mode="stage stuck", rate_per_h="6.4e-8", source="[A] ...")

An injection is one run with one fault (or one pair) present.  Its id is made of the names of its faults, so it does
not change when other faults are added.
"""

from __future__ import annotations

import itertools
import random
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb
from typing import Any

from safety.faults import ANY_TIME, FROM_START, TRANSIENT, Fault, Kind, byzantine, every, expand, flip, stuck
from safety.system import ModelError, System, nearest

Faults = Callable[[System], list[Fault]]


class CampaignError(ModelError):
    """A campaign is declared or used wrongly; the message gives the value, the place and what to write instead."""


@dataclass(frozen=True)
class Group:
    """Faults of one part that fail in one way: a row of the failure-mode table.

    `faults` is a list of faults or a function of the system such as `stuck_bits("ring")`.  `rate_per_h` is the failure
    rate of the whole group in 1/h, exact, shared evenly by its faults; `source` says where it comes from and starts
    with its tag, [P], [D], [A] or [R].  `expect` is the row of the result table that is declared, e.g.
    `{"safe/yes": 32, "wrong/yes": 32}`.
    """

    name: str
    faults: Any
    part: str = ""
    mode: str = ""
    rate_per_h: Fraction | str | None = None
    source: str = ""
    expect: Mapping[str, int] | None = None

    def __post_init__(self) -> None:
        if self.rate_per_h is None:
            return
        if isinstance(self.rate_per_h, float):
            raise CampaignError(
                f"group {self.name!r}: rate {self.rate_per_h} is a float; write it in quotes, so that it stays exact"
            )
        object.__setattr__(self, "rate_per_h", Fraction(self.rate_per_h))
        if self.source[:3] not in ("[P]", "[D]", "[A]", "[R]"):
            raise CampaignError(f"group {self.name!r}: rate source {self.source!r}; start it with [P], [D], [A] or [R]")

    @property
    def tag(self) -> str:
        """P printed, D derived, A assumed, R reconstructed; empty without a rate."""
        return self.source[1:2]


@dataclass(frozen=True)
class Injection:
    """One run to make: its id, the faults present, the group it counts in, and their places among all single faults."""

    id: str
    faults: tuple[Fault, ...]
    group: str
    places: tuple[int, ...] = ()


@dataclass(frozen=True)
class Space:
    """The injections of a campaign, with how many there are in all and how these were chosen."""

    injections: tuple[Injection, ...]
    groups: tuple[Group, ...]
    population: int
    statement: str
    sizes: Mapping[str, int]  # single faults of each group, drawn or not

    @property
    def exhaustive(self) -> bool:
        """Whether every injection of the population is here."""
        return len(self.injections) == self.population

    def find(self, key: str | int) -> int:
        """Position of an injection, by id or by position.  Raises `CampaignError` with the nearest ids."""
        if isinstance(key, int):
            if not 0 <= key < len(self.injections):
                raise CampaignError(f"injection {key}: they are numbered 0 to {len(self.injections) - 1}")
            return key
        for position, injection in enumerate(self.injections):
            if injection.id == key:
                return position
        raise CampaignError(f"no injection {key!r}; {nearest(key, (i.id for i in self.injections))}")


# --- faults of a kind at many places -------------------------------------------------------------------------------


def each_bit(kinds: Callable[[int | None], Iterable[Kind]], *patterns: str, **when: Any) -> Faults:
    """A fault for each bit of each point that fits a pattern and each kind: `kinds(bit)`, with None for a wire.

    `when` is passed on to `Fault`: onset, at, ticks.
    """

    def faults(system: System) -> list[Fault]:
        return [
            Fault(kind, [point], **when)
            for point in matching(system, patterns)
            for bit in _bits(system, point)
            for kind in kinds(bit)
        ]

    return faults


def stuck_bits(*patterns: str, **when: Any) -> Faults:
    """Each bit of each point stuck at 0 and stuck at 1."""
    return each_bit(lambda bit: (stuck(0, bit), stuck(1, bit)), *patterns, **when)


def upsets(*patterns: str, at: Iterable[int]) -> Faults:
    """Each bit of each point inverted for one step, at each of the given steps (single-event upsets)."""
    steps = list(at)

    def faults(system: System) -> list[Fault]:
        make = [each_bit(lambda bit: (flip(bit),), *patterns, onset=TRANSIENT, at=step, ticks=1) for step in steps]
        return [fault for one in make for fault in one(system)]

    return faults


def matching(system: System, patterns: Sequence[str]) -> list[str]:
    """Full names of the points that fit, each once.  Raises `ModelError` for a pattern that fits none."""
    return [fault.points[0] for fault in every(byzantine(), *patterns)(system)]


def _bits(system: System, point: str) -> Sequence[int | None]:
    sort = system.points[point].sort
    if sort.kind not in ("bit", "uint"):
        raise CampaignError(f"{point} is a {sort} and has no bits; name a fault for it with Fault(kind, [{point!r}])")
    return [None] if sort.kind == "bit" else range(sort.width)


# --- from groups to injections -------------------------------------------------------------------------------------


def enumerate_space(
    system: System, groups: Sequence[Group], *, order: int = 1, sample: int | None = None, seed: int = 0
) -> Space:
    """All injections of the groups, or `sample` of them drawn without replacement with `seed`.

    `order` 1 injects single faults, 2 all pairs of them.  Raises `CampaignError` for an empty or ambiguous list.
    """
    if order not in (1, 2):
        raise CampaignError(f"order {order}: a campaign injects single faults (1) or pairs (2)")
    single = [(group.name, fault) for group in groups for fault in _expanded(system, group)]
    _refuse_repeats([group.name for group in groups], "group")
    _refuse_repeats([identify(fault) for _, fault in single], "fault")
    population = comb(len(single), order)
    if not population:
        raise CampaignError(
            "there is no pair: name two faults or more" if single else "no group has a fault: name at least one"
        )
    if sample is not None and not 1 <= sample <= population:
        raise CampaignError(
            f"sample={sample} of {population} injections; choose 1 to {population}, or leave it out for all"
        )
    chosen: Iterable[tuple[int, ...]] = itertools.combinations(range(len(single)), order)
    noun = "single faults" if order == 1 else f"pairs of {len(single)} faults"
    statement = f"all {population} {noun}"
    if sample is not None and sample < population:
        positions = sorted(random.Random(seed).sample(range(population), sample))
        chosen = (_unrank(p, len(single), order) for p in positions)
        statement = f"{sample} of {population} {noun}, drawn with seed {seed}"
    return Space(
        tuple(_injection([single[i] for i in c], c) for c in chosen),
        tuple(groups),
        population,
        statement,
        Counter(name for name, _ in single),
    )


def _expanded(system: System, group: Group) -> list[Fault]:
    faults = expand(system, group.faults)
    if not faults:
        raise CampaignError(f"group {group.name!r} has no fault; name some, or leave the group out")
    return faults


def identify(fault: Fault) -> str:
    """A fault's name with its schedule: two faults of one name at different times are two."""
    if fault.onset == FROM_START:
        return fault.name
    if fault.onset == ANY_TIME:
        return f"{fault.name} from step {fault.at}"
    return f"{fault.name}, {fault.onset} at {fault.at}" + (f" for {fault.ticks}" if fault.ticks is not None else "")


def _injection(members: Sequence[tuple[str, Fault]], places: tuple[int, ...]) -> Injection:
    group = " & ".join(dict.fromkeys(name for name, _ in members))
    return Injection(" & ".join(identify(f) for _, f in members), tuple(f for _, f in members), group, places)


def _unrank(position: int, n: int, order: int) -> tuple[int, ...]:
    """The combination at a position of the lexicographic order."""
    if order == 1:
        return (position,)
    first = 0
    while position >= n - 1 - first:
        position -= n - 1 - first
        first += 1
    return first, first + 1 + position


def _refuse_repeats(names: Sequence[str], what: str) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise CampaignError(
                f"{what} {name!r} is there twice: leave one out or give it a name of its own (Fault(..., name=...))"
            )
        seen.add(name)
