"""Odometer and correction together: while the position is relied on, its interval holds the train.

The premises are those of the odometer (`position_odometer`) and of the correction (`position_correction`), without any
of what these show of each other: that a match holds the train follows here from the interval, and the other way round.
Source: AP-1, AP-4; position from axle pulses, corrected at every balise [P]; rules and numbers [A].

Main result: from the first code on, through any number of balises, slips and slides, the train is within the interval.
"""

from __future__ import annotations

from fractions import Fraction

from models.position.journey import Journey
from proofs.position_odometer import adhesion, brakes, gains, given, loses, no_traction, onset, scale
from safety import PROVED, REFUTED, Bit, Seen, claim, count, implies

NAMES = "abcd"
JITTER = Fraction(1, 10)  # m
PLACES = tuple(f"correction.data.place_{n}" for n in NAMES)


def listed(s: Seen) -> Bit:
    """a balise that is seen is in the line data, of the kind that it shows, within 0.1 m of its place"""
    here = (s.way - s.own.place <= JITTER) & (s.own.place - s.way <= JITTER) & (s.balise.kind == s.own.kind)
    return implies(s.balise.seen, here & (count(*(s.balise.which[n] for n in NAMES)) == 1))


def true_code(s: Seen) -> Bit:
    """what a code tells holds the train"""
    inside = (s.code.low <= s.code.place) & (s.code.place <= s.code.high)
    return implies(s.code.given, inside & (s.code.low <= s.way) & (s.way <= s.code.high))


ODOMETER = (scale, gains, loses, brakes, no_traction, onset, adhesion)
ALL = (*ODOMETER, listed, true_code)


def speed_is_bounded(s: Seen) -> Bit:
    """The true mean speed lies between `floor` and `top`, and is none below 0."""
    bounds = s.odometer.bounds
    return (bounds.floor <= s.speed) & (s.speed <= bounds.top) & (s.speed >= 0)


def train_is_inside(s: Seen) -> Bit:
    """A known position holds the train in its interval."""
    return implies(s.correction.tally.known, (s.odometer.s_lo <= s.way) & (s.way <= s.odometer.s_hi))


LEMMAS = (speed_is_bounded, train_is_inside)


@claim(Journey, expect=PROVED, symbolic=PLACES, given=given(*ALL), lemmas=LEMMAS, requirement="AP-1",
       source="[P] position from axle pulses, corrected at every balise")  # fmt: skip
def relied_on_means_inside(s: Seen) -> Bit:
    """As long as the position is relied on, the head of the train lies in [s_lo, s_hi] at the end of every cycle."""
    inside = (s.odometer.low <= s.there) & (s.there <= s.odometer.high)
    return implies(s.matched.reliable, inside)


@claim(Journey, expect=REFUTED, given=given(*ODOMETER, true_code), requirement="AP-4", twin_of=relied_on_means_inside,
       defeat=True, steps=6)  # fmt: skip
def relied_on_with_an_unlisted_balise(s: Seen) -> Bit:
    """The same when a balise may be seen that is not in the line data.  False: it is matched with another one."""
    return implies(s.matched.reliable, (s.odometer.low <= s.there) & (s.there <= s.odometer.high))


@claim(Journey, expect=REFUTED, given=given(*ODOMETER, listed), requirement="AP-1", twin_of=relied_on_means_inside)
def relied_on_with_a_wrong_code(s: Seen) -> Bit:
    """The same when a code may be read wrongly.  False: it puts the train somewhere else."""
    return implies(s.matched.reliable, (s.odometer.low <= s.there) & (s.there <= s.odometer.high))
