"""Position on board: speed generator, odometer and correction at balises together.

A balise may be passed anywhere in a cycle.  It is dealt with at the end of the cycle: looked up at the position of its
detection, which is that of now less the way since, and what is found is moved on by that way.  The way since is counted
by axle pulses from the time stamp of the detection; where the wheel slips or slides in the cycle the count is not used,
but all that the train can have run in it.  `UnstampedLocator` has no stamp, and always takes all that.
Source: position from axle pulses, corrected at every balise [P]; rules and numbers [A]; the stamp of 1 ms, 2.8 cm at
100 km/h, is part of e [A].

Main results: with the stamp, lookup and fix are wider than without a cycle by the scale error of the way since alone,
at 100 km/h and 1 % at most 0.03 m on each side; without it by the way of a cycle, 2.8 m on the far side.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Self

from models.position.correction import Correction, Matched, Where
from models.position.odometer import Fix, Odometer, Position, SpeedGenerator, ordered, smaller, step_s
from safety import U2, Bit, Model, Real, assume, bit, real, select


class Sighted(NamedTuple):
    """A balise of a kind, if `seen` in the cycle, and the way that is counted from there to the end of the cycle, m."""

    seen: Bit
    kind: U2
    since: Real


class Way(NamedTuple):
    """Way since the balise, as estimated, surely between `low` and `high`, m."""

    low: Real
    guess: Real
    high: Real


class Ran(NamedTuple):
    """Way of the cycle, m, surely between `least` and `most`; `sure` where the wheel grips all the while."""

    sure: Bit
    least: Real
    most: Real
    eps: Real  # scale error


class Located(NamedTuple):
    """Position at the end of the cycle, what the correction told, the wheel's speed in m/s."""

    position: Position
    matched: Matched
    wheel: Real


Rule = Callable[[Real, Ran], Way]
NOTHING = Fix(bit(False), real(0), real(0), real(0))


def counted(since: Real, ran: Ran) -> Way:
    """As counted, within the scale error; in a slip or slide anything that the train can have run in the cycle."""
    off = since * ran.eps
    high = select(ran.sure, since + off, ran.most)
    return Way(select(ran.sure, since - off, 0), smaller(since, high), high)


def unstamped(since: Real, ran: Ran) -> Way:
    """Anything that the train can have run in the cycle."""
    return Way(real(0), ran.most / 2, ran.most)


def locate(
    odometer: Odometer, correction: Correction, wheel: Real, sight: Sighted, code: Fix, rule: Rule
) -> tuple[Odometer, Correction, Position, Matched]:
    """One cycle: the wheel's mean speed in m/s, a balise, what a code tells of the end of the cycle."""
    moved, now = odometer.step(wheel, NOTHING)
    sure = ~moved.watch.slip & ~moved.watch.slide
    way = rule(sight.since, Ran(sure, now.low - odometer.s_lo, now.high - odometer.s_hi, odometer.eps))
    low, guess, high = (select(sight.seen, each, 0) for each in way)
    at = Where(now.low - high, now.guess - guess, now.high - low)
    following, matched = correction.step(sight.seen, sight.kind, at, code)
    put = moved.put(later(matched.fix, Way(*(select(code.given, 0, each) for each in (low, guess, high)))))
    return put, following, now._replace(low=put.s_lo, guess=put.s, high=put.s_hi), matched


def later(fix: Fix, way: Way) -> Fix:
    """The fix after such a way."""
    return Fix(fix.given, fix.low + way.low, fix.place + way.guess, fix.high + way.high)


class Locator(Model, tick_s=step_s):
    """Where the train is, surely; `matched.reliable` false calls for the most restrictive pattern."""

    generator: SpeedGenerator
    odometer: Odometer
    correction: Correction

    def step(self, pulses: Real, sight: Sighted, code: Fix) -> tuple[Self, Located]:
        """One cycle: pulses a second; a balise passed in it; what a code tells of its end, if any."""
        assume("what a code tells lies in its interval", ordered(code))
        generator, wheel = self.generator.step(pulses)
        odometer, correction, position, matched = locate(self.odometer, self.correction, wheel, sight, code, self.since)
        following = type(self)(generator=generator, odometer=odometer, correction=correction)
        return following, Located(position, matched, wheel)

    def since(self, since: Real, ran: Ran) -> Way:
        """Way since the balise."""
        return counted(since, ran)


class UnstampedLocator(Locator, tick_s=step_s):
    """The same with a balise of which only the cycle is known."""

    def since(self, since: Real, ran: Ran) -> Way:
        """Anything that the train can have run in the cycle."""
        return unstamped(since, ran)
