"""Odometer and correction together: while the position is relied on, its interval holds the train.

The premises are those of the odometer (`position_odometer`) and of the correction (`position_correction`), without any
of what these show of each other: that a match holds the train follows here from the interval, and the other way round.
Source: AP-1, AP-4; position from axle pulses, corrected at every balise [P]; rules and numbers [A].

Main result: from the first code on, through any number of balises, each anywhere in its cycle, slips and slides, the
train is within the interval.  A balise taken for one at the cycle's beginning would put the train up to a cycle's way
too far.
"""

from __future__ import annotations

from fractions import Fraction

from models.position.journey import FromTheBeginning, Journey, UnstampedJourney
from proofs.position_odometer import adhesion, brakes, gains, loses, no_traction, onset, scale, speed_is_bounded
from proofs.premises import together
from safety import PROVED, REFUTED, Bit, Scenario, Seen, claim, count, implies

NAMES = "abcd"
JITTER, SCALE = Fraction(1, 10), Fraction(1, 100)  # m, 1
PLACES = tuple(f"correction.data.place_{n}" for n in NAMES)


def listed(s: Seen) -> Bit:
    """a balise that is seen, anywhere in a cycle, is in the line data, of the kind that it shows, detected within 0.1 m
    of its place"""
    off, e = s.there - s.balise.passed - s.own.place, JITTER
    here = (off <= e) & (-off <= e) & (s.balise.kind == s.own.kind)
    return implies(s.balise.seen, here & (count(*(s.balise.which[n] for n in NAMES)) == 1))


def stamped(s: Seen) -> Bit:
    """the count since a balise is at most eps too little, unless the wheel slides, and eps too much, unless it spins"""
    since, passed = s.balise.since, s.balise.passed
    off = SCALE * since
    return implies(s.balise.seen, (s.at.slides | (passed <= since + off)) & (s.at.spins | (since - off <= passed)))


def true_code(s: Seen) -> Bit:
    """what a code tells holds the train at the end of the cycle"""
    inside = (s.code.low <= s.code.place) & (s.code.place <= s.code.high)
    return implies(s.code.given, inside & (s.code.low <= s.there) & (s.there <= s.code.high))


ODOMETER = (scale, gains, loses, brakes, no_traction, onset, adhesion)
ALL = (*ODOMETER, listed, stamped, true_code)


def train_is_inside(s: Seen) -> Bit:
    """A known position holds the train in its interval."""
    return implies(s.correction.tally.known, (s.odometer.s_lo <= s.way) & (s.way <= s.odometer.s_hi))


LEMMAS = (speed_is_bounded, train_is_inside)


def late_balise(place: str, since: str) -> Scenario:
    """From standstill with 1 m/s^2, a code at 4.65 m after 3 s, a balise in the cycle from 4.96 to 5.28 m."""
    told, at = {f"code.{name}": Fraction("4.65") for name in ("low", "place", "high")}, Fraction(place)
    return Scenario(32, {
        **told, "code.given": lambda k: k == 29, "at.gain": 1, "at.wheel": lambda k: Fraction(k + 1, 10),
        "balise.seen": lambda k: k == 31, "balise.kind": 0, "balise.which.a": True, "balise.which.b": False,
        "balise.which.c": False, "balise.which.d": False, "balise.since": Fraction(since),
        "balise.passed": Fraction("5.28") - at, "at.spins": False, "at.slides": False,
    })  # fmt: skip


def inside(s: Seen) -> Bit:
    """A position that is relied on holds the head of the train at the end of the cycle."""
    return implies(s.matched.reliable, (s.position.low <= s.there) & (s.there <= s.position.high))


@claim(Journey, expect=PROVED, symbolic=PLACES, given=together(*ALL), lemmas=LEMMAS, requirement="AP-1",
       source="[P] position from axle pulses, corrected at every balise")  # fmt: skip
def relied_on_means_inside(s: Seen) -> Bit:
    """As long as the position is relied on, the head of the train lies in [s_lo, s_hi] at the end of every cycle,
    wherever in a cycle a balise is passed."""
    return inside(s)


@claim(UnstampedJourney, expect=PROVED, symbolic=PLACES, given=together(*ODOMETER, listed, true_code), lemmas=LEMMAS,
       requirement="AP-1", source="[A] all that the train can run in a cycle")  # fmt: skip
def relied_on_without_stamps_means_inside(s: Seen) -> Bit:
    """The same without time stamps of balises, the interval widened by the way of a cycle."""
    return inside(s)


@claim(FromTheBeginning, expect=REFUTED, given=together(*ALL), requirement="AP-1", twin_of=relied_on_means_inside,
       scenario=late_balise("5.26", "0.02"), settings={PLACES[0]: Fraction("5.26")}, defeat=True)  # fmt: skip
def relied_on_from_the_beginning(s: Seen) -> Bit:
    """The same where a balise passed in a cycle counts as passed at its beginning.  False: it is passed later, and the
    train is not yet where it is put."""
    return inside(s)


@claim(UnstampedJourney, expect=REFUTED, given=together(*ODOMETER, true_code), requirement="AP-4", steps=6, defeat=True,
       twin_of=relied_on_without_stamps_means_inside)  # fmt: skip
def relied_on_without_stamps_or_line_data(s: Seen) -> Bit:
    """Without time stamps when a balise may be seen that is not in the line data.  False: it is matched with another
    one."""
    return inside(s)


@claim(Journey, expect=REFUTED, given=together(*ODOMETER, listed, true_code), requirement="AP-1",
       scenario=late_balise("4.98", "0"), settings={PLACES[0]: Fraction("4.98")},
       twin_of=relied_on_means_inside)  # fmt: skip
def relied_on_with_any_stamp(s: Seen) -> Bit:
    """The same when the way since a balise may be counted wrongly with a wheel that grips.  False."""
    return inside(s)


@claim(Journey, expect=REFUTED, given=together(*ODOMETER, stamped, true_code), requirement="AP-4", defeat=True, steps=6,
       twin_of=relied_on_means_inside)  # fmt: skip
def relied_on_with_an_unlisted_balise(s: Seen) -> Bit:
    """The same when a balise may be seen that is not in the line data.  False: it is matched with another one."""
    return inside(s)


@claim(Journey, expect=REFUTED, given=together(*ODOMETER, listed, stamped), requirement="AP-1",
       twin_of=relied_on_means_inside)  # fmt: skip
def relied_on_with_a_wrong_code(s: Seen) -> Bit:
    """The same when a code may be read wrongly.  False: it puts the train somewhere else."""
    return inside(s)
