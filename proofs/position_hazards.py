"""Position between two balises: minimal cut sets of an interval that does not hold the train, by the axle's faults.

The rows of speed generator, wheel and wheel-rail, from any time on, on a train that gains and loses what the premises
of `position_odometer` allow; its premises on the wheel (scale, onset, no spin in SLIDE, re-adhesion) are the faults.
Complete at every order, each set replayed.
Main results: beyond s_hi by pulse loss, by a wheel larger than set, by slide and by creep; behind s_lo by extra
pulses, by a worn wheel and by slip; no row in both.  A slide is in it though slides are detected: a wheel
that locks from below 0.15 m/s, or stays locked until it agrees with the estimate, is not seen to slide.
Rates are INVENTED [A].
"""

from __future__ import annotations

from collections.abc import Iterator

from models.ats.failures import rates_of, rows_of
from models.ats.rolling import Rolling
from safety import Bit, Scenario, Seen, hazard, implies, struck
from safety.tracing import trace

FAULTS = rows_of(set(trace(Rolling).points))
CREEP = "wheel-rail: creep"
UNDER = ("speed generator: pulse loss", "wheel: larger than set", "wheel-rail: slide", CREEP)
OVER = ("speed generator: extra pulses", "wheel: worn but not set", "wheel-rail: slip")
LIMITS = ("odometer.a_hi", "odometer.b_hi")
SOURCE = "[P] position from axle pulses; sizes of the faults [A]"


def moves(s: Seen) -> Bit:
    """The train gains and loses what it can, gains nothing in SLIDE, and a fix holds it."""
    o = s.odometer
    can = (s.gain <= o.a_hi) & (-s.gain <= o.b_hi) & implies(o.watch.sliding, s.gain <= 0)
    return can & implies(s.fix.given, (s.fix.low <= s.way) & (s.way <= s.fix.high))


def speed_is_below_top(s: Seen) -> Bit:
    """Lemma: unless the wheel shows too little the true mean speed is at most `top`, and is none below 0."""
    return (s.speed >= 0) & (struck(s, *UNDER) | (s.speed <= s.odometer.bounds.top))


def is_before_s_hi(s: Seen) -> Bit:
    """Lemma: unless the wheel shows too little the train is not beyond s_hi."""
    return struck(s, *UNDER) | (s.way <= s.odometer.s_hi)


def creep_takes_speed(s: Seen) -> Bit:
    """Lemma: creep has taken speed from the wheel, and given it none."""
    number = next(n for n, fault in enumerate(FAULTS) if fault.name == CREEP)
    taken: Bit = s[f"fault{number}.axle.grip.gone"] <= 0
    return taken


def speed_is_above_floor(s: Seen) -> Bit:
    """Lemma: unless the wheel shows too much the true mean speed is at least `floor`, and is none below 0."""
    return (s.speed >= 0) & (struck(s, *OVER) | (s.odometer.bounds.floor <= s.speed))


def is_behind_s_lo(s: Seen) -> Bit:
    """Lemma: unless the wheel shows too much the train is not behind s_lo."""
    return struck(s, *OVER) | (s.odometer.s_lo <= s.way)


def runs(present: tuple[str, ...]) -> Iterator[Scenario]:
    """From standstill, pulled: with the faults from the start, from 0.1 s on, and from 1 s on with no pull after."""
    limits = {"odometer.a_hi": 1, "odometer.b_hi": 1}
    for at, steps, pull in ((0, 20, 20), (1, 20, 20), (10, 80, 10)):
        yield Scenario(steps, {"gain": lambda step, pull=pull: int(step < pull)}, limits, present=present, at=at)


@hazard(Rolling, faults=FAULTS, scenarios=runs, given=moves, lemmas=[speed_is_below_top, is_before_s_hi],
        symbolic=LIMITS, rates=rates_of(FAULTS), hours="1000", requirement="AP-1", source=SOURCE,
        expect={1: 4})  # fmt: skip
def farther_or_faster_than_believed(s: Seen) -> Bit:
    """The train is beyond s_hi, or faster than v_hi, with no balise since."""
    return s.beyond


@hazard(Rolling, faults=FAULTS, scenarios=runs, given=moves,
        lemmas=[creep_takes_speed, speed_is_above_floor, is_behind_s_lo], symbolic=LIMITS, rates=rates_of(FAULTS),
        hours="1000", requirement="AP-1", source=SOURCE, expect={1: 3})  # fmt: skip
def not_as_far_as_believed(s: Seen) -> Bit:
    """The train is behind s_lo, so that a section could be believed to have been reached or cleared."""
    return s.behind
