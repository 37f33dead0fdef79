"""TS-7: the quantities that the proofs about a speed-check channel reason with, as plain functions.

A channel has two races: speed pulses against the pattern of the signal (brake), and against that of roll-back.  The
*potential* of a race is how far the speed pulses are ahead, counted to the last fraction of a pulse: whole pulses stand
in the comparator, fractions in the phases of axle, wheel correction, reference and divider.  A frame changes it by
exactly speed minus limit, unless the comparator stands at one of its ends.  So overspeed raises it steadily, and how
soon the latch sets follows from the margin, whatever the phases were.

Units: a pulse of f_v or f_p is 256 * SCALE = 2**24; a word (0.47124 km/h) of excess adds PER_WORD = 4096 a frame.
Source: the joint null space of the registers, for all phases, words and wheels [D].
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from math import ceil, floor
from typing import Any, NamedTuple

from models.ts7.numbers import BRAKE_AREA, KMH_PER_WORD, ROLLBACK_WORD, SPEEDS, WORD
from models.ts7.train import PER_WORD, SCALE
from safety import Bit, Int, Seen, age, any_of, implies, previous, total

Formula = Callable[[Seen], Bit]

PULSE = 256 * SCALE  # one pulse of f_v or f_p
SMALLEST_WHEEL, LARGEST_WHEEL = 156, 172  # settings of the wheel switch, 5 mm
SPEED_FRACTION = 255 * SCALE + LARGEST_WHEEL * SCALE - 1  # most that wheel correction and axle hold below a pulse
REFERENCE_FRACTION = PER_WORD * (256 * 16 - 1)  # most that reference and divider hold below a pulse
EXCESS_AREA = BRAKE_AREA * PER_WORD  # sum of the excess after which the latch is set, from any state


class Race(NamedTuple):
    """Which comparator, fed by which reference and divider, with which limit in words."""

    counter: str
    reference: str
    divider: str
    limit: Callable[[Any], Any]


BRAKE = Race("comparator", "j0", "div0", lambda channel: channel.limit)
ROLL_BACK = Race("rollback", "j3", "div3", lambda channel: ROLLBACK_WORD)


def potential(s: Seen, channel: str = "a", race: Race = BRAKE) -> Int:
    """How far the speed pulses of a channel are ahead of its reference."""
    c = s[channel]
    ahead = PULSE * c[race.counter].u.int() + SCALE * c.ring.j1.int() + s.axle.phase
    return ahead - PER_WORD * (c.ring[race.reference].int() + 256 * c[race.divider].n.int())


def excess(s: Seen, channel: str = "a", race: Race = BRAKE) -> Int:
    """Speed above the limit of a channel, 1/4096 word a frame; negative below it."""
    return s.speed - PER_WORD * race.limit(s[channel])


def overspeed(s: Seen, channel: str = "a", words: int = 0) -> Bit:
    """At least so many words above the limit in force in the channel."""
    return excess(s, channel) >= PER_WORD * words


def underspeed(s: Seen, channel: str = "a", words: int = 0) -> Bit:
    """At least so many words below the limit in force in the channel."""
    return excess(s, channel) <= -PER_WORD * words


@cache
def at_least_kmh(speed: Fraction | int | str) -> int:
    """Least value of the speed input, 1/4096 word a frame, that is no slower than a speed in km/h."""
    return ceil(KMH_PER_WORD.inverse().times(PER_WORD * Fraction(speed)).high)


@cache
def at_most_kmh(speed: Fraction | int | str) -> int:
    """Greatest value of the speed input, 1/4096 word a frame, that is no faster than a speed in km/h."""
    return floor(KMH_PER_WORD.inverse().times(PER_WORD * Fraction(speed)).low)


def frames_for(units: int) -> int:
    """Frames after which an excess (or lack) of so many 1/4096 words has moved the latch, from any state."""
    return -(-EXCESS_AREA // units)


def wheel_set_right(s: Seen) -> Bit:
    """The wheel switch shows the true diameter, 780 to 860 mm."""
    return (s.wheel == s.true_wheel) & (s.wheel >= SMALLEST_WHEEL) & (s.wheel <= LARGEST_WHEEL)


def wheel_kept(s: Seen) -> Bit:
    """The wheel setting is what it was a frame before."""
    return s.wheel == previous(s.wheel, 0)


def two_above(s: Seen) -> Bit:
    """2.0 km/h or more above the speed of the signal."""
    return any_of(*((s.word == WORD[v]) & (s.speed >= at_least_kmh(v + 2)) for v in SPEEDS))


def two_below(s: Seen) -> Bit:
    """2.0 km/h or more below the speed of the signal, not lowered by synchronisation."""
    return ~s.lowered & any_of(*((s.word == WORD[v]) & (s.speed <= at_most_kmh(v - 2)) for v in SPEEDS))


# --- lemmas: invariants of the registers ---------------------------------------------------------------------------


def named(name: str, formula: Formula) -> Formula:
    """The formula under the name by which results show it."""
    formula.__name__ = name
    return formula


def latch_at_the_ends(channel: str = "a", race: Race = BRAKE) -> Formula:
    """Three pulses ahead the latch is set, none ahead it is not."""

    def lemma(s: Seen) -> Bit:
        c = s[channel][race.counter]
        return implies(c.u == 3, c.latch) & implies(c.u == 0, ~c.latch)

    return named(f"latch of {channel}.{race.counter} is right at both ends", lemma)


def braked_and_ahead(s: Seen, channel: str = "a", race: Race = BRAKE) -> Bit:
    """Latched, and so far ahead that the counter cannot fall to 0 before the speed falls below the limit."""
    return s[channel][race.counter].latch & (potential(s, channel, race) >= 3 * PULSE - REFERENCE_FRACTION)


def free_and_behind(s: Seen, channel: str = "a", race: Race = BRAKE) -> Bit:
    """Not latched, and so far behind that the counter cannot rise to 3 before the speed rises above the limit."""
    return ~s[channel][race.counter].latch & (potential(s, channel, race) <= SPEED_FRACTION)


def rising(while_: Formula, units: int, ticks: int, channel: str = "a", race: Race = BRAKE) -> Formula:
    """While the excess is `units` or more, the race is latched, or its potential rises by that a frame."""

    def lemma(s: Seen) -> Bit:
        risen = units * age(while_(s), ticks).int()
        return braked_and_ahead(s, channel, race) | (potential(s, channel, race) >= risen - REFERENCE_FRACTION)

    return named(f"{while_.__name__}: {channel}.{race.counter} is latched or its potential rises", lemma)


def falling(while_: Formula, units: int, ticks: int, channel: str = "a", race: Race = BRAKE) -> Formula:
    """While the excess is -`units` or less, the race is released, or its potential falls by that a frame."""

    def lemma(s: Seen) -> Bit:
        left = 3 * PULSE + SPEED_FRACTION - units * age(while_(s), ticks).int()
        return free_and_behind(s, channel, race) | (potential(s, channel, race) <= left)

    return named(f"{while_.__name__}: {channel}.{race.counter} is released or its potential falls", lemma)


def surplus(channel: str = "a", words: int = 1, ticks: int = BRAKE_AREA, broken: Formula | None = None) -> Formula:
    """Overspeed by `words` brakes or raises the potential by that a frame; while `broken` it does not count."""

    def over(s: Seen) -> Bit:
        fast = overspeed(s, channel, words)
        return fast if broken is None else fast & ~broken(s)

    return rising(named(f"overspeed by {words} words", over), PER_WORD * words, ticks, channel)


def sum_of_excess(s: Seen, channel: str = "a") -> Int:
    """Sum of the excess over all steps so far, where it is above 0; counted up to just above EXCESS_AREA."""
    return total(excess(s, channel).clip(0, 2**24 - 1).sat(24), 2**27).int()
