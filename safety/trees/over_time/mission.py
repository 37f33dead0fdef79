"""A fault tree over its mission time: curves of unavailability and failure frequency.

With q_i and w_i the unavailability and the unconditional failure frequency of event i, and Q that of the top event:

    unavailability        Q(t), from the q_i(t) by the diagram
    failure frequency     w(t) = sum of dQ/dq_i w_i(t): the expected number of occurrences of the top event per hour
    conditional intensity w(t) / (1 - Q(t)), given that the top event has not occurred at t

Where an event acts through a negation only, its repairs cause the top event: it adds -dQ/dq_i times its frequency of
repair. An event that acts both ways leaves w unknown, as the derivative then nets occurrences with their opposite.

Units: hours, frequencies per hour. Sources: W. E. Vesely, "A time-dependent methodology for fault tree evaluation",
Nuclear Engineering and Design 13 (1970); IEC 61508-6:2010 annex B.5.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

from safety.trees.as_written import Rational, TreeError, exact
from safety.trees.over_time.behaviour import Behaviour, Piece, UnknownFrequency, double
from safety.trees.over_time.laws import behaviours, mission_time
from safety.trees.solve import Solution, solve
from safety.trees.tree import FaultTree

MOST_TESTS = 20_000
CAUSES, PREVENTS, BOTH = 1, 2, 3  # what the occurrence of an event can do to the top event


@dataclass(frozen=True)
class Curve:
    """Values at `times_h`; an event that is tested at a time counts as just before the test."""

    times_h: tuple[float, ...]
    unavailability: tuple[float, ...]
    frequency: tuple[float, ...] | None  # per hour; None where it is not known
    intensity: tuple[float | None, ...] | None  # per hour, None where the top event is certain
    unknown: str = ""  # why there is no frequency

    def plain(self) -> dict[str, Any]:
        """The entry of a results document."""
        return {
            "times_h": list(self.times_h),
            "unavailability": list(self.unavailability),
            "frequency_per_h": None if self.frequency is None else list(self.frequency),
            "intensity_per_h": None if self.intensity is None else list(self.intensity),
            "frequency_unknown": self.unknown or None,
        }


class Occurrences(NamedTuple):
    """At each of some places: Q, w, and the frequency of the events together, per hour."""

    unavailability: list[float]
    frequency: list[float]
    events: list[float]


class Mission:
    """A solved tree with what each of its events does over time.

    Raises TreeError: an event without a probability, a mission time of 0, mission times that differ, a time or rate
    that no double can hold; and TooLarge.
    """

    def __init__(self, tree: FaultTree, mission_time_h: Rational | None = None) -> None:
        found = mission_time(tree) if mission_time_h is None else exact(mission_time_h, "the mission time")
        self.events: list[Behaviour] = behaviours(tree)
        if found is not None and found <= 0:
            raise TreeError(f"the mission time is {float(found):g} h, expected more than 0; correct it")
        self.tree = tree
        self.time_h = Fraction(1) if found is None else double(found, "the mission time")  # without one nothing changes
        self.effects = effects(tree)
        self.solution: Solution = solve(tree)

    @cached_property
    def changing(self) -> dict[str, Behaviour]:
        """The events below the top that change in the course of time."""
        named = zip(self.solution.events, self.events, strict=True)
        return {name: event for name, event in named if event.varies and name in self.effects}

    @cached_property
    def unknown(self) -> str:
        """Why the failures of one of the events below the top are not known; empty if they are."""
        named = zip(self.solution.events, self.events, strict=True)
        return next(
            (f'"{name}": {event.unknown}' for name, event in named if event.unknown and name in self.effects), ""
        )

    @property
    def is_coherent(self) -> bool:
        """Whether events can only cause the top event, as the kinds of the gates show."""
        return all(effect == CAUSES for effect in self.effects.values())

    def columns(self, places: Sequence[tuple[Fraction, float]]) -> array[float]:
        """The unavailability of each event at each place, a time and hours after it, row by row."""
        return self._rows(places, [_down] * len(self.events))

    def occurrences(self, places: Sequence[tuple[Fraction, float]]) -> Occurrences:
        """Q, w and the sum of the w_i at each place. Raises UnknownFrequency."""
        if self.unknown:
            raise UnknownFrequency(self.unknown)
        if not self.changing:
            raise UnknownFrequency("no event below the top event has a rate")
        columns = self.columns(places)
        slopes = self.solution.many_derivatives(columns)
        effects = [self.effects[name] if name in self.changing else 0 for name in self.solution.events]
        changes = self._rows(places, list(map(_change, self.solution.events, effects)))
        count = len(places)
        frequency, events = [0.0] * count, [0.0] * count
        for row, effect in enumerate(effects):
            if effect:
                first = row * count
                for j in range(count):
                    frequency[j] += slopes[first + j] * changes[first + j]
                    events[j] += changes[first + j]
        return Occurrences(list(self.solution.many(columns)), frequency, events)

    def _rows(self, places: Sequence[tuple[Fraction, float]], ask: Sequence[Ask]) -> array[float]:
        """What is asked of each event at each place; places of one part between tests share their first element."""
        result = array("d")
        for event, function in zip(self.events, ask, strict=True):
            known, gap = None, 0.0
            piece: Piece
            for base, offset in places:
                if base is not known:
                    known = base
                    begin, piece = event.piece(base + Fraction(offset))
                    gap = float(base - begin)
                result.append(function(piece, gap + offset))
        return result

    def tests(self) -> list[Fraction]:
        """The times at which an event below the top is tested, before the end of the mission.

        Raises TreeError when there are more than MOST_TESTS.
        """
        found: set[Fraction] = set()
        for event in self.changing.values():
            for time in event.tests(self.time_h):
                if time > 0:
                    found.add(time)
                if len(found) > MOST_TESTS:
                    raise TreeError(
                        f"the mission of {float(self.time_h):g} h has more than {MOST_TESTS} tests; take a shorter one"
                    )
        return sorted(found)

    def curve(self, times_h: Iterable[Rational] | int) -> Curve:
        """The curve at given times, or at so many equal steps from 0 to the mission time.

        Raises TreeError for a negative time or one that no double can hold.
        """
        if isinstance(times_h, int):
            if times_h < 1:
                raise TreeError(f"a curve of {times_h} steps was asked for, expected 1 or more")
            times = [self.time_h * n / times_h for n in range(times_h + 1)]
        else:
            times = [double(exact(time, "a time of the curve"), "a time of the curve") for time in times_h]
        if times and min(times) < 0:
            raise TreeError(f"a time of the curve is {float(min(times)):g} h, expected 0 or more; correct it")
        places = [(time, 0.0) for time in times]
        try:
            unavailability, frequency, _ = self.occurrences(places)
        except UnknownFrequency as error:
            return Curve(
                tuple(map(float, times)), tuple(self.solution.many(self.columns(places))), None, None, str(error)
            )
        intensity = tuple(w / (1 - q) if q < 1 else None for q, w in zip(unavailability, frequency, strict=True))
        return Curve(tuple(map(float, times)), tuple(unavailability), tuple(frequency), intensity)


Ask = Callable[[Piece, float], float]  # of a piece of a behaviour and the hours since it began


def _down(piece: Piece, hours: float) -> float:
    return piece.down(hours)


def _change(name: str, effect: int) -> Ask:
    """What of an event adds to the frequency of the top event, apart from its derivative. Raises UnknownFrequency."""
    if effect == BOTH:
        raise UnknownFrequency(f'"{name}" can both cause and prevent the top event')

    def change(piece: Piece, hours: float) -> float:
        if not effect:
            return 0.0
        try:
            return piece.failures(hours) if effect == CAUSES else -piece.repairs(hours)
        except UnknownFrequency as error:
            raise UnknownFrequency(f'"{name}": {error}', name) from None

    return change


def effects(tree: FaultTree) -> dict[str, int]:
    """Which gates and events below the top can cause it, prevent it, or both, read off the kinds of the gates.

    An event found to do BOTH may do only one of them: x and not x are nothing.
    """
    found = {tree.top: CAUSES}
    for gate in reversed(tree.inputs_first):
        effect = found[gate.name]
        if gate.kind == "not":
            effect = {CAUSES: PREVENTS, PREVENTS: CAUSES, BOTH: BOTH}[effect]
        elif gate.kind == "xor" and len(gate.inputs) > 1:
            effect = BOTH
        for name in gate.inputs:
            found[name] = found.get(name, 0) | effect
    return found
