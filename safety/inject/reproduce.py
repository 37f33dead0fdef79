"""The minimal reproducer of a dangerous undetected injection, found by an engine, confirmed by the Python reading.

It need not be an injection of the campaign's own: its faults are, their windows are whatever is shortest.  Its id says
both, so that `read` makes the same run of it again.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from safety.faults import ANY_TIME, FROM_START, INTERMITTENT, TRANSIENT, Fault
from safety.inject.classes import CELLS
from safety.inject.engine import NEVER, NONE, Batch
from safety.inject.judging import judge, onset_frames
from safety.inject.shrink import Acting, Candidate, shrink
from safety.inject.space import JOINT, CampaignError, Injection, check_schedule, identify, window
from safety.system import ModelError

if TYPE_CHECKING:
    from safety.inject.campaign import Campaign

HARM = "wrong/no"


class Unconfirmed(Exception):
    """The Python reading does not confirm what the fast engine found: the two disagree."""

    exit_code = 6


@dataclass(frozen=True)
class Reproducer:
    """The smallest injection that does the same harm, of which one, and how many runs it took to find it."""

    of: str
    injection: Injection
    runs: int

    def to_json(self) -> dict[str, Any]:
        """Plain values, for the entry of the results document."""
        return {"of": self.of, "injection": self.injection.id, "faults": len(self.injection.faults), "runs": self.runs}


def reproducer(campaign: Campaign, injection: Injection) -> Reproducer:
    """Shrink an injection that is dangerous and undetected.

    Raises `CampaignError` when it is not, `Unconfirmed` when the Python reading denies what was found.
    """
    steps = campaign.timing.frames * campaign.timing.steps
    engine, runs = campaign.engine_of(injection.scenario), 0

    def harmful(candidates: Sequence[Candidate]) -> list[bool]:
        nonlocal runs
        runs += len(candidates)
        batch = _batch(candidates, steps)
        found = judge(campaign, engine.run(batch), engine.golden, onset_frames(campaign, batch))
        return [CELLS[cell] == HARM for cell in found.cells.tolist()]

    windows = (window(fault) for fault in injection.faults)
    start = tuple(Acting(p, a, min(b, steps)) for p, (a, b) in zip(injection.places, windows, strict=True))
    try:
        least = shrink(start, harmful, campaign.steps_per_frame)
    except ValueError as wrong:
        raise CampaignError(f"{campaign.id}::{injection.id}: {wrong}") from None
    found = _injection(campaign, least, injection, steps)
    cell = campaign.replay(found).cell
    if cell != HARM:
        raise Unconfirmed(
            f"{campaign.id}::{found.id} is {HARM} on the {engine.name} engine, {cell} on the Python reading"
        )
    return Reproducer(injection.id, found, runs)


def _batch(candidates: Sequence[Candidate], steps: int) -> Batch:
    import numpy as np

    shape = max(map(len, candidates)), len(candidates)
    atoms, first, end = (np.full(shape, value, dtype=np.int32) for value in (NONE, 0, NEVER))
    for run, candidate in enumerate(candidates):
        for row, one in enumerate(candidate):
            atoms[row, run], first[row, run] = one.place, one.first
            end[row, run] = one.end if one.end < steps else NEVER
    return Batch(atoms, first, end)


def _injection(campaign: Campaign, candidate: Candidate, of: Injection, steps: int) -> Injection:
    space = campaign.space
    faults = tuple(_lasting(space.singles[one.place], one.first, one.end, steps) for one in candidate)
    return _made(campaign, faults, tuple(one.place for one in candidate), of.scenario)


def _lasting(fault: Fault, first: int, end: int, steps: int) -> Fault:
    """The fault with this window in a run of so many steps; one that lasts to the end is permanent."""
    if end < steps:
        return replace(fault, onset=TRANSIENT, at=first, ticks=end - first)
    return replace(fault, onset=ANY_TIME if first else FROM_START, at=first, ticks=None)


def _made(campaign: Campaign, faults: tuple[Fault, ...], places: tuple[int, ...], scenario: int) -> Injection:
    space = campaign.space
    group = JOINT.join(dict.fromkeys(space.groups[space.of_group[place]].name for place in places))
    name = JOINT.join(map(identify, faults)) + (f" in scenario {scenario}" if space.scenarios > 1 else "")
    return Injection(name, faults, group, places, scenario)


# --- ids of injections that need not be the campaign's own -----------------------------------------------------------


def read(campaign: Campaign, key: str | int) -> Injection:
    """An injection by number or id; an id may give the campaign's faults any onset and length.

    Raises `CampaignError` with the nearest names for an id that means none, and for a schedule that cannot be.
    """
    space = campaign.space
    try:
        return space.injection(space.find(key))
    except CampaignError:
        if isinstance(key, int):
            raise
        found = _read(campaign, key)
        if found is None:
            raise
    for fault in found.faults:
        check_schedule(identify(fault), *window(fault), campaign.timing)
    return found


def _read(campaign: Campaign, key: str) -> Injection | None:
    space, scenario = campaign.space, 0
    if space.scenarios > 1:
        key, _, last = key.rpartition(" in scenario ")
        scenario = int(last) if last.isdecimal() else -1
    places = {fault.name: place for place, fault in enumerate(space.singles)}
    parts = [_WHEN.fullmatch(part) for part in _parts(key, places)]
    if not all(part and part[1] in places for part in parts) or not 0 <= scenario < space.scenarios:
        return None
    found = [(places[part[1]], part) for part in parts if part]
    try:
        faults = tuple(_timed(space.singles[place], part) for place, part in found)
    except ModelError as wrong:
        raise CampaignError(f"injection {key!r}: {wrong}") from None
    return _made(campaign, faults, tuple(place for place, _ in found), scenario)


_WHEN = re.compile(rf"(.*?)(?: from step (\d+)|, ({TRANSIENT}|{INTERMITTENT}) at (\d+)(?: for (\d+))?)?", re.DOTALL)


def _parts(key: str, places: dict[str, int]) -> list[str]:
    """The faults of an id; the sign between them may also stand within a name."""
    parts: list[str] = []
    for piece in key.split(JOINT):
        whole = f"{parts[-1]} & {piece}" if parts else piece
        if parts and _named(parts[-1]) not in places:
            parts[-1] = whole
        else:
            parts.append(piece)
    return parts


def _named(part: str) -> str:
    found = _WHEN.fullmatch(part)
    return found[1] if found else part


def _timed(fault: Fault, told: re.Match[str]) -> Fault:
    """The fault with the schedule that follows its name."""
    _, since, onset, at, ticks = told.groups()
    if since is not None:
        return replace(fault, onset=ANY_TIME, at=int(since), ticks=None)
    if onset is not None:
        return replace(fault, onset=onset, at=int(at), ticks=None if ticks is None else int(ticks))
    return replace(fault, onset=FROM_START, at=0, ticks=None)
