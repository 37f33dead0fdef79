"""The injections of a campaign: every fault, pair or triple of its groups at every onset, by number, made when asked.

    Group("stage", stuck_bits("ring"), part="ring register", mode="stage stuck", rate_per_h="6.4e-8", source="[A] ...")

An injection is one run with one fault, or so many as `order` says, present.  Its id is made of the names of its faults
and their onset, so it does not change when other faults are added; its number says where it stands in the space.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from safety.faults import ANY_TIME, FROM_START, TRANSIENT, Fault
from safety.inject.engine import NEVER, Batch, Timing
from safety.inject.ranks import Combinations
from safety.system import ModelError, System, nearest

if TYPE_CHECKING:
    from safety.inject.ranks import Positions

Faults = Callable[[System], list[Fault]]
JOINT = " & "  # between the names of an id


class CampaignError(ModelError):
    """A campaign is declared or used wrongly; the message gives the value, the place and what to write instead."""


@dataclass(frozen=True)
class Group:
    """Faults of one part that fail in one way: a row of the failure-mode table.

    `faults` is a list of faults or a function of the system such as `stuck_bits("ring")`.  `rate_per_h` is the failure
    rate of the whole group in 1/h, exact, shared evenly by its faults; `source` says where it comes from and starts
    with its tag, [P], [D], [A] or [R].  `expect` is the row of the result table that is declared, e.g.
    `{"safe/yes": 32, "wrong/yes": 32}`.

    With `drawn=n` the group stands for endlessly many faults, of any drift rate, delay or onset, say: `faults` makes
    one from a generator (`random.Random`), n are drawn with the campaign's seed, and fractions have bounds.
    """

    name: str
    faults: Any
    part: str = ""
    mode: str = ""
    rate_per_h: Fraction | str | None = None
    source: str = ""
    expect: Mapping[str, int] | None = None
    drawn: int | None = None

    def __post_init__(self) -> None:
        if self.drawn is not None and (type(self.drawn) is not int or self.drawn < 1):
            raise CampaignError(f"group {self.name!r}: drawn={self.drawn!r}; draw 1 fault or more, or leave it out")
        if self.rate_per_h is None:
            return
        if isinstance(self.rate_per_h, float):
            raise CampaignError(
                f"group {self.name!r}: rate {self.rate_per_h} is a float; write it in quotes, so that it stays exact"
            )
        try:
            object.__setattr__(self, "rate_per_h", Fraction(self.rate_per_h))
        except (ValueError, TypeError, ZeroDivisionError):
            raise CampaignError(
                f"group {self.name!r}: rate {self.rate_per_h!r} is no number; write e.g. '6.4e-8' or '1/1000000'"
            ) from None
        if self.source[:3] not in ("[P]", "[D]", "[A]", "[R]"):
            raise CampaignError(f"group {self.name!r}: rate source {self.source!r}; start it with [P], [D], [A] or [R]")

    @property
    def tag(self) -> str:
        """P printed, D derived, A assumed, R reconstructed; empty without a rate."""
        return self.source[1:2]


@dataclass(frozen=True)
class Injection:
    """One run to make: its id, the faults present with their schedules, its group, and in which scenario."""

    id: str
    faults: tuple[Fault, ...]
    group: str
    places: tuple[int, ...] = ()  # of the faults among all single faults
    scenario: int = 0


@dataclass(frozen=True, eq=False)
class Space:
    """All injections of a campaign, or those drawn from them; number i stands for one without there being an object.

    They are all combinations of `order` of the `singles`, each at every one of the `onsets` (model steps, for `length`
    steps or for ever; without `onsets` each fault has its own schedule), in each of the `scenarios`, in this order.
    `chosen`: the positions that were drawn, ascending, or None for all.
    """

    groups: tuple[Group, ...]
    singles: tuple[Fault, ...]
    of_group: tuple[int, ...]  # by single fault
    order: int
    onsets: range | None
    length: int | None
    scenarios: int
    chosen: Positions | None
    statement: str
    by_group: bool = False  # whether so many were drawn of each group

    @cached_property
    def combinations(self) -> Combinations:
        """The faults that are present together, by number."""
        return Combinations(len(self.singles), self.order)

    @property
    def times(self) -> int:
        """At how many onsets each combination is injected."""
        return 1 if self.onsets is None else len(self.onsets)

    @property
    def in_a_scenario(self) -> int:
        """Injections of one scenario, drawn or not."""
        return len(self.combinations) * self.times

    @property
    def population(self) -> int:
        """All injections, drawn or not."""
        return self.in_a_scenario * self.scenarios

    def __len__(self) -> int:
        return self.population if self.chosen is None else len(self.chosen)

    @property
    def drawn(self) -> bool:
        """Whether some of the faults are drawn from endlessly many."""
        return any(group.drawn for group in self.groups)

    @property
    def exhaustive(self) -> bool:
        """Whether every injection that there is is here."""
        return len(self) == self.population and not self.drawn

    @cached_property
    def sizes(self) -> Mapping[str, int]:
        """Injections of each group of single faults, drawn or not."""
        each = Counter(self.groups[g].name for g in self.of_group)
        return {name: number * self.times * self.scenarios for name, number in each.items()}

    # --- by number, many at a time -------------------------------------------------------------------------------

    def positions(self, low: int, high: int) -> Positions:
        """Where the injections numbered `low` to `high` (not included) stand in the population."""
        import numpy as np

        return np.arange(low, high, dtype=np.int64) if self.chosen is None else self.chosen[low:high]

    def number(self, positions: Positions) -> Positions:
        """The number of the injections at these positions, -1 for one that was not drawn."""
        import numpy as np

        if self.chosen is None:
            return positions
        found = np.searchsorted(self.chosen, positions)
        there = self.chosen[np.minimum(found, len(self.chosen) - 1)] == positions
        return np.where(there, found, -1)

    def members(self, positions: Positions) -> Positions:
        """The single faults at these positions, shape (order, positions)."""
        return self.combinations.at(positions % self.in_a_scenario // self.times)

    def when(self, positions: Positions, members: Positions) -> tuple[Positions, Positions]:
        """First step, and the one before which it ends, of each of the faults: two arrays, shape (order, positions)."""
        import numpy as np

        if self.onsets is None:
            first, end = np.array([window(fault) for fault in self.singles], dtype=np.int64).T
            return first[members], end[members]
        steps = np.asarray(self.onsets, dtype=np.int64)[positions % self.times]
        first = np.broadcast_to(steps, members.shape)
        length = NEVER if self.length is None else min(self.length, NEVER)
        return first, np.minimum(first + length, NEVER)

    def batch(self, low: int, high: int) -> Batch:
        """The injections numbered `low` to `high` (not included) as columns; atoms are the single faults."""
        import numpy as np

        positions = self.positions(low, high)
        members = self.members(positions)
        return Batch(*(array.astype(np.int32) for array in (members, *self.when(positions, members))))

    @property
    def group_keys(self) -> int:
        """How many numbers stand for the groups of an injection; see `group_name`."""
        return int(len(self.groups) ** self.order)

    def keys(self, low: int, high: int) -> Positions:
        """For each injection a number that stands for its scenario and groups: scenario * `group_keys` + groups."""
        import numpy as np

        positions = self.positions(low, high)
        keys = positions // self.in_a_scenario
        of_group = np.array(self.of_group, dtype=np.int64)
        for row in self.members(positions):
            keys = keys * len(self.groups) + of_group[row]
        return keys

    def group_name(self, key: int) -> str:
        """The groups of an injection: the name of one, or `one & other`."""
        names = []
        for _ in range(self.order):
            key, group = divmod(key, len(self.groups))
            names.append(self.groups[group].name)
        return JOINT.join(dict.fromkeys(reversed(names)))

    # --- one at a time -------------------------------------------------------------------------------------------

    def injection(self, number: int) -> Injection:
        """The injection of a number.  Raises `CampaignError` when there is none."""
        if not 0 <= number < len(self):
            raise CampaignError(f"injection {number}: they are numbered 0 to {len(self) - 1}")
        positions = self.positions(number, number + 1)
        places = tuple(int(place) for place in self.members(positions)[:, 0])
        faults = [self.singles[place] for place in places]
        if self.onsets is not None:
            faults = [scheduled(fault, self.onsets[int(positions[0]) % self.times], self.length) for fault in faults]
        scenario = int(positions[0]) // self.in_a_scenario
        group = JOINT.join(dict.fromkeys(self.groups[self.of_group[place]].name for place in places))
        name = JOINT.join(identify(fault) for fault in faults)
        return Injection(self._in_scenario(name, scenario), tuple(faults), group, places, scenario)

    def _in_scenario(self, name: str, scenario: int) -> str:
        return f"{name} in scenario {scenario}" if self.scenarios > 1 else name

    @property
    def injections(self) -> Iterator[Injection]:
        """All of them, one after the other."""
        return (self.injection(number) for number in range(len(self)))

    @cached_property
    def _place(self) -> dict[str, int]:
        named = (fault.name if self.onsets is not None else identify(fault) for fault in self.singles)
        return {name: place for place, name in enumerate(named)}

    def find(self, key: str | int) -> int:
        """Number of an injection, by id or by number.  Raises `CampaignError` with the nearest names."""
        import numpy as np

        if isinstance(key, int):
            self.injection(key)
            return key
        for position in self._read(key):
            number = int(self.number(np.array([position]))[0])
            if number < 0:
                raise CampaignError(f"injection {key!r} was not drawn; {self.statement}")
            return number
        raise CampaignError(f"no injection {key!r}; {nearest(key, self._place)}")

    def _read(self, key: str) -> Iterator[int]:
        """The positions at which an id may be meant: names may hold the sign that stands between them."""
        import numpy as np

        scenario = 0
        if self.scenarios > 1:
            key, _, last = key.rpartition(" in scenario ")
            scenario = int(last) if last.isdecimal() and int(last) < self.scenarios else -1
        for names in _divided(key.split(JOINT), self.order):
            told = [without_onset(name) if self.onsets is not None else (name, 0) for name in names]
            places = [self._place.get(name, -1) for name, _ in told]
            if scenario < 0 or -1 in places or any(a >= b for a, b in pairwise(places)):
                continue
            rank = int(self.combinations.position(np.array([[place] for place in places], dtype=np.int64))[0])
            position = scenario * self.in_a_scenario + rank * self.times
            if self.onsets is None:
                yield position
            elif told[0][1] in self.onsets:
                position += self.onsets.index(told[0][1])
                faults = [scheduled(self.singles[place], told[0][1], self.length) for place in places]
                if [identify(fault) for fault in faults] == names:
                    yield position


def _divided(parts: list[str], number: int) -> Iterator[list[str]]:
    """All ways to put parts together again into so many names."""
    if number == 1:
        yield [JOINT.join(parts)]
        return
    for k in range(1, len(parts) - number + 2):
        for others in _divided(parts[k:], number - 1):
            yield [JOINT.join(parts[:k]), *others]


_ONSET = re.compile(r"(.*)(?: from step |, transient at )(\d+)(?: for \d+)?", re.DOTALL)


def without_onset(name: str) -> tuple[str, int]:
    """A name without the onset that an id gives it, and that step; -1 where it has none."""
    found = _ONSET.fullmatch(name)
    return (found[1], int(found[2])) if found else (name, -1)


# --- schedules -----------------------------------------------------------------------------------------------------


def scheduled(fault: Fault, step: int, length: int | None) -> Fault:
    """A fault that begins at a step, for so many steps or for ever."""
    if length is None:
        return replace(fault, onset=ANY_TIME, at=step)
    return replace(fault, onset=TRANSIENT, at=step, ticks=length)


def window(fault: Fault) -> tuple[int, int]:
    """Steps at which a fault acts in a run, from the first to before the second (`NEVER`: to the end)."""
    first, end = fault.window()
    return first, NEVER if end is None else min(end, NEVER)


def identify(fault: Fault) -> str:
    """A fault's name with its schedule: two faults of one name at different times are two."""
    if fault.onset == FROM_START:
        return fault.name
    if fault.onset == ANY_TIME:
        return f"{fault.name} from step {fault.at}"
    return f"{fault.name}, {fault.onset} at {fault.at}" + (f" for {fault.ticks}" if fault.ticks is not None else "")


def check_schedule(name: str, first: int, end: int, timing: Timing) -> None:
    """Raise `CampaignError` unless a fault begins within the run and begins and ends between two frames."""
    last = timing.frames * timing.steps
    if not 0 <= first < last:
        raise CampaignError(
            f"fault {name!r} begins at step {first}, outside the run (0 to {last - 1}); choose another `at`"
        )
    for step in (first, end):
        if step != NEVER and step % timing.steps:
            near = step - step % timing.steps
            raise CampaignError(
                f"fault {name!r} begins or ends at step {step}, inside a frame of {timing.steps} steps; "
                f"choose {near} or {near + timing.steps}, or a campaign with steps_per_frame=1"
            )
