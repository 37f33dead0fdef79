"""Averages over the mission: PFDavg, PFH, the expected number of failures, and bounds on the unreliability.

    PFDavg               1/T times the integral of the unavailability Q(t) over the mission time T
    expected failures    the integral of the failure frequency w(t)
    PFH                  expected failures / T: the average unconditional failure frequency
    unreliability        probability of at least one failure, at least every Q(t), at most Q(0) + expected failures

If no event changes, Q is constant and PFDavg exact. Otherwise the integrals are by `quadrature`, where w has M times 2
times the sum of all failure rates for a bound, as |dQ/dq_i| <= 2 M / max(|q_i| + |1 - q_i|). To its error the rounding
is added: as Q is monotone in every q_i of a coherent tree, relative errors of the q_i and of the passes over the
diagram add up. Where an event's expression is not of exponentials (Weibull, tests that last), or the rounding has no
such bound (the tree is not coherent), the result is called "estimated": the bounds are then ten times the difference
between two rules, around the finer one.

Sources: IEC 61508-6:2010 annex B (PFDavg, PFH); W. E. Vesely, Nuclear Engineering and Design 13 (1970), the bounds.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from safety.trees.behaviour import UnknownFrequency
from safety.trees.mission import Mission
from safety.trees.quadrature import Bounds, Panel, Rule, doubling, rounding, rules
from safety.trees.safety_levels import Level, level

AT_ONCE = 4096  # points evaluated in one pass
COARSE, FINE = 16, 24  # points of the two rules of an estimate


@dataclass(frozen=True)
class Averages:
    """The figures of the module over `mission_time_h`; None where the failure frequency is not known (`unknown`)."""

    mission_time_h: float
    unavailability: Bounds  # PFDavg
    exact: Fraction | None  # PFDavg where nothing changes and all is rational
    expected_failures: Bounds | None
    frequency: Bounds | None  # PFH, per hour
    unreliability: Bounds | None
    largest_unavailability: float  # of those at the ends of the mission and just before each test
    method: str  # "constant", "certified quadrature" or "estimated"
    points: int  # at which the tree was evaluated
    unknown: str = ""

    @property
    def low_demand(self) -> Level:
        """The safety integrity level of PFDavg."""
        return level("low demand", *((self.exact,) if self.exact is not None else self.unavailability))

    @property
    def high_demand(self) -> Level | None:
        """The safety integrity level of PFH."""
        return None if self.frequency is None else level("high demand", *self.frequency)

    def plain(self) -> dict[str, Any]:
        """The entry of a results document."""

        def entry(figure: Bounds | None) -> dict[str, float] | None:
            return None if figure is None else figure.plain()

        high_demand = self.high_demand
        return {
            "mission_time_h": self.mission_time_h,
            "pfd_avg": self.unavailability.plain() | {"exact": None if self.exact is None else str(self.exact)},
            "pfh_per_h": entry(self.frequency),
            "expected_failures": entry(self.expected_failures),
            "unreliability": None if self.unreliability is None else self.unreliability._asdict(),
            "largest_unavailability": self.largest_unavailability,
            "sil_low_demand": self.low_demand.plain(),
            "sil_high_demand": None if high_demand is None else high_demand.plain(),
            "method": self.method,
            "points": self.points,
            "frequency_unknown": self.unknown or None,
        }


def averages(mission: Mission) -> Averages:
    """The averages of a mission. Raises TreeError when it has too many tests."""
    time, solution = float(mission.time_h), mission.solution
    ends = [*mission.tests(), mission.time_h]
    first, *at_ends = solution.many(mission.columns([(Fraction(0), 0.0), *((end, 0.0) for end in ends)]))
    if not mission.changing:
        around = Bounds(*(solution.bounds or (first, first)))
        why = "no event below the top event has a rate"
        return Averages(time, around, solution.exact, None, None, None, first, "constant", 1, why)
    certified = mission.is_coherent and all(event.is_bounded for event in mission.changing.values())
    total = _certified(mission, ends) if certified else _estimated(mission, ends)
    down, failures, epsilon = total.down, total.failures, rounding(solution, len(ends))
    largest = max(first, *at_ends)
    unreliability = None
    if failures is not None:
        most = min(1.0, first * (1 + epsilon) + failures.high)
        unreliability = Bounds(min(most, max(0.0, largest * (1 - epsilon))), most)
    return Averages(
        time,
        Bounds(*(min(1.0, end) for end in down.times(1 / time))),
        None,
        failures,
        None if failures is None else failures.times(1 / time),
        unreliability,
        largest,
        "certified quadrature" if certified else "estimated",
        total.points,
        total.unknown,
    )


@dataclass
class _Total:
    """The integrals of Q and of w."""

    down: Bounds
    failures: Bounds | None
    points: int
    unknown: str


def _certified(mission: Mission, ends: Sequence[Fraction]) -> _Total:
    panels = list(_panels(mission, ends))
    middles = mission.solution.many(mission.columns([(panel.base, panel.middle) for panel in panels]))
    scale = math.fsum(q * panel.width for q, panel in zip(middles, panels, strict=True)) / float(mission.time_h)
    events = mission.changing.values()
    rates = 2 * sum(float(event.scale * event.failure_rate) for event in events)
    total = _sum(mission, [r for p in panels for r in rules(events, p, scale, rates * float(mission.time_h))])
    cut, epsilon = total.down.high - total.down.low, 2 * rounding(mission.solution, len(ends))
    middle = total.down.low
    total.down = Bounds(max(0.0, middle * (1 - epsilon) - cut), middle * (1 + epsilon) + cut)
    if total.failures is not None:
        middle = total.failures.low
        lost = epsilon * (middle + rates * total.down.high) + rates * cut
        total.failures = Bounds(max(0.0, middle - lost), middle + lost)
    return total


def _estimated(mission: Mission, ends: Sequence[Fraction]) -> _Total:
    panels = list(_panels(mission, ends))
    coarse, fine = (_sum(mission, [Rule(panel, n, 0.0) for panel in panels]) for n in (COARSE, FINE))
    fine.down = _spread(coarse.down, fine.down)
    if coarse.failures is not None and fine.failures is not None:
        fine.failures = _spread(coarse.failures, fine.failures)
    fine.points += coarse.points
    return fine


def _spread(coarse: Bounds, fine: Bounds) -> Bounds:
    difference = 10 * abs(fine.low - coarse.low)
    return Bounds(max(0.0, fine.low - difference), fine.low + difference)


def _panels(mission: Mission, ends: Sequence[Fraction]) -> Iterator[Panel]:
    """From each beginning on, panels that double from the shortest time constant of what begins there."""
    base = Fraction(0)
    for end in ends:
        length = float(end - base)
        paces = [float(event.pace) for event in mission.changing.values() if event.piece(end)[0] == base or not base]
        yield from doubling(base, length, 1 / max((pace for pace in paces if pace), default=1 / length))
        base = end


def _sum(mission: Mission, given: Sequence[Rule]) -> _Total:
    """Both integrals by the rules given: the sum, and the sum plus all that the rules cut off for Q."""
    down: list[float] = []
    failures: list[float] = []
    agenda = [place for rule in given for place in rule.places()]
    unknown = ""
    for first in range(0, len(agenda), AT_ONCE):
        places, weights = zip(*agenda[first : first + AT_ONCE], strict=True)
        try:
            if unknown:
                raise UnknownFrequency(unknown)
            values, frequencies = mission.occurrences(places)
            failures += map(float.__mul__, weights, frequencies)
        except UnknownFrequency as error:
            unknown, values = str(error), list(mission.solution.many(mission.columns(places)))
        down += map(float.__mul__, weights, values)
    whole, cut = math.fsum(down), math.fsum(rule.cut for rule in given)
    failed = math.fsum(failures)
    return _Total(Bounds(whole, whole + cut), None if unknown else Bounds(failed, failed), len(agenda), unknown)
