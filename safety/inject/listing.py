"""Faults of a kind at many places, as a campaign's groups list them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from safety.faults import TRANSIENT, Fault, Kind, flip, matching, stuck
from safety.inject.space import CampaignError, Faults
from safety.system import System


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


def flipped_bits(*patterns: str, **when: Any) -> Faults:
    """Each bit of each point inverted; with `onsets` and `length` of a campaign, single-event upsets."""
    return each_bit(lambda bit: (flip(bit),), *patterns, **when)


def upsets(*patterns: str, at: Iterable[int]) -> Faults:
    """Each bit of each point inverted for one step, at each of the given steps, as faults of their own."""
    steps = list(at)

    def faults(system: System) -> list[Fault]:
        make = [flipped_bits(*patterns, onset=TRANSIENT, at=step, ticks=1) for step in steps]
        return [fault for one in make for fault in one(system)]

    return faults


def _bits(system: System, point: str) -> Sequence[int | None]:
    sort = system.points[point].sort
    if sort.kind not in ("bit", "uint"):
        raise CampaignError(f"{point} is a {sort} and has no bits; name a fault for it with Fault(kind, [{point!r}])")
    return [None] if sort.kind == "bit" else range(sort.width)
