"""Averages over the mission: PFDavg, PFH, the expected number of failures, and bounds on the unreliability.

    PFDavg               1/T times the integral of the unavailability Q(t) over the mission time T
    expected failures    the integral of the failure frequency w(t)
    PFH                  expected failures / T: the average unconditional failure frequency
    unreliability        probability of at least one failure, at least every Q(t), at most Q(0) + expected failures

PFH is low, too, where the system is mostly down, as what has failed cannot fail again; and where an event that has a
share of another's probability, as in a common-cause group, is no more likely to fail however long the mission. No level
is then read off it.

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
from typing import Any, NamedTuple

from safety.trees.over_time.behaviour import UnknownFrequency
from safety.trees.over_time.mission import Mission
from safety.trees.over_time.quadrature import Bounds, Panel, Rule, doubling, rounding, rules, written
from safety.trees.over_time.safety_levels import MOST_UNAVAILABLE, Level, level, no_level

AT_ONCE = 4096  # points evaluated in one pass
COARSE, FINE = 16, 24  # points of the two rules of an estimate
FIRST, LATER = 2**20, 2**10  # how much shorter than a stretch between tests the time constants may be, if unknown
LEAST_DIFFERENCE = 1e-11  # relative, for the rounding of an estimate


@dataclass(frozen=True)
class Averages:
    """The figures of the module over `mission_time_h`; None where the failure frequency is not known (`unknown`)."""

    mission_time_h: float | None  # None where it does not matter
    unavailability: Bounds  # PFDavg
    exact: Fraction | None  # PFDavg where nothing changes and all is rational
    expected_failures: Bounds | None
    frequency: Bounds | None  # PFH, per hour
    unreliability: Bounds | None
    largest_unavailability: float  # of those at the ends of the mission and just before each test
    method: str  # "constant", "certified quadrature" or "estimated"
    points: int  # at which the tree was evaluated
    unknown: str = ""
    saturated: str = ""  # an event that PFH understates, with the reason

    @property
    def low_demand(self) -> Level:
        """The safety integrity level of PFDavg."""
        return level("low demand", *((self.exact,) if self.exact is not None else self.unavailability))

    @property
    def high_demand(self) -> Level | None:
        """The safety integrity level of PFH; none where it tells nothing, see the module."""
        if self.frequency is None:
            return None
        why = self.saturated
        if self.unavailability.high >= MOST_UNAVAILABLE:
            why = (
                f"the top event holds {self.unavailability.high:.3g} of the time on the average, "
                f"{float(MOST_UNAVAILABLE):g} or more, while what is down cannot fail: PFH understates the risk; "
                "take a shorter mission, tests or repairs"
            )
        return no_level("high demand", *self.frequency, why) if why else level("high demand", *self.frequency)

    def plain(self) -> dict[str, Any]:
        """The entry of a results document."""

        def entry(figure: Bounds | None) -> dict[str, float] | None:
            return None if figure is None else figure.plain()

        high_demand = self.high_demand
        return {
            "mission_time_h": self.mission_time_h,
            "pfd_avg": self.unavailability.plain() | {"exact": written(self.exact)},
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
        exact, why = solution.exact, mission.unknown or "no event below the top event has a rate"
        around = Bounds(*(solution.bounds or (first, first))) if exact is None else Bounds.of(exact)
        return Averages(None, around, exact, None, None, None, first, "constant", 1, why)
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
        _saturated(mission, ends),
    )


def _saturated(mission: Mission, ends: Sequence[Fraction]) -> str:
    """An event whose frequency falls as that of which it has a share has failed already, and why PFH is too low."""
    for name, event in mission.changing.items():
        share = float(event.scale)
        down = (piece.down(float(end - begin)) for end in ends for begin, piece in [event.piece(end)])
        if share < 1 and any(q >= MOST_UNAVAILABLE * share for q in down):
            return (
                f'"{name}" has {share:g} times the probability of an event that comes to '
                f"{float(MOST_UNAVAILABLE):g} or more, and then rises no more: PFH understates the risk; take a "
                "shorter mission, tests or repairs, or give it a rate of its own"
            )
    return ""


class _Sum(NamedTuple):
    """Integrals by a set of rules, without their errors: of Q, of w, and of Q times the frequency of all events."""

    down: float
    failures: float
    shaken: float
    points: int
    unknown: str


class _Total(NamedTuple):
    """The integrals of Q and of w."""

    down: Bounds
    failures: Bounds | None
    points: int
    unknown: str


def _certified(mission: Mission, ends: Sequence[Fraction]) -> _Total:
    """With the errors of the rules and of rounding.

    A derivative B_i, of error epsilon (P1 + P0) = epsilon (B_i + 2 P0) with P0 <= Q, makes for one of w of
    epsilon (w + 2 Q times the frequency of all events).
    """
    panels = list(_panels(mission, ends))
    middles = mission.solution.many(mission.columns([(panel.base, panel.middle) for panel in panels]))
    scale = math.fsum(q * panel.width for q, panel in zip(middles, panels, strict=True)) / float(mission.time_h)
    events = mission.changing.values()
    rates = 2 * sum(float(event.scale * event.failure_rate) for event in events)
    given = [rule for panel in panels for rule in rules(events, panel, scale, rates * float(mission.time_h))]
    found = _sum(mission, given)
    cut, epsilon = math.fsum(rule.cut for rule in given), 2 * rounding(mission.solution, len(ends))
    failures = None
    if not found.unknown:
        failures = _around(found.failures, epsilon * (found.failures + 2 * found.shaken) + rates * cut)
    return _Total(_around(found.down, epsilon * found.down + cut), failures, found.points, found.unknown)


def _estimated(mission: Mission, ends: Sequence[Fraction]) -> _Total:
    panels = list(_panels(mission, ends))
    coarse, fine = (_sum(mission, [Rule(panel, n, 0.0) for panel in panels]) for n in (COARSE, FINE))

    def between(one: float, other: float) -> Bounds:
        return _around(other, 10 * abs(other - one) + LEAST_DIFFERENCE * other)

    failures = None if fine.unknown else between(coarse.failures, fine.failures)
    return _Total(between(coarse.down, fine.down), failures, coarse.points + fine.points, fine.unknown)


def _around(middle: float, error: float) -> Bounds:
    return Bounds(max(0.0, middle - error), middle + error)


def _panels(mission: Mission, ends: Sequence[Fraction]) -> Iterator[Panel]:
    """From each beginning on, panels that double from the shortest time constant of what begins there."""
    base = Fraction(0)
    for end in ends:
        length = float(end - base)
        paces = [float(event.pace) for event in mission.changing.values() if event.piece(end)[0] == base or not base]
        if not all(event.is_bounded for event in mission.changing.values()):
            paces.append((LATER if base else FIRST) / length)
        yield from doubling(base, length, 1 / max((pace for pace in paces if pace), default=1 / length))
        base = end


def _sum(mission: Mission, given: Sequence[Rule]) -> _Sum:
    sums: tuple[list[float], list[float], list[float]] = [], [], []
    agenda = [place for rule in given for place in rule.places()]
    unknown = ""
    for first in range(0, len(agenda), AT_ONCE):
        places, weights = zip(*agenda[first : first + AT_ONCE], strict=True)
        if not unknown:
            try:
                down, failures, events = mission.occurrences(places)
            except UnknownFrequency as error:
                unknown = str(error)
        if unknown:
            down, failures, events = list(mission.solution.many(mission.columns(places))), [], []
        sums[0].extend(w * q for w, q in zip(weights, down, strict=True))
        sums[1].extend(map(float.__mul__, weights, failures))
        sums[2].extend(w * q * f for w, q, f in zip(weights, down, events, strict=bool(events)))
    whole, failed, shaken = map(math.fsum, sums)
    return _Sum(whole, failed, shaken, len(agenda), unknown)
