"""TS-7: the quantities that the proofs about a speed-check channel reason with, as plain functions.

The *potential* of a channel is how far the speed pulses are ahead of the reference, counted to the last fraction of a
pulse: whole pulses stand in the comparator, fractions in the phases of axle, wheel correction, reference and divider.
A frame changes it by exactly (speed - limit), unless the comparator stands at one of its ends.  So overspeed raises it
steadily, and the place where the comparator has to set its latch comes after a time that follows from the margin.

Units: a pulse of f_v or f_p is 256 * SCALE = 2**24; a word (0.47124 km/h) of excess adds PER_WORD = 4096 a frame.
Source: lemmas found by hand and by the joint null space of the registers, for all phases, words and wheels [D].
"""

from __future__ import annotations

from collections.abc import Callable

from models.ts7.train import PER_WORD, SCALE
from safety import Bit, Int, Seen, age, implies, total

Formula = Callable[[Seen], Bit]

PULSE = 256 * SCALE  # one pulse of f_v or f_p
SMALLEST_WHEEL, LARGEST_WHEEL = 156, 172  # settings of the wheel switch, 5 mm
SPEED_FRACTION = 255 * SCALE + LARGEST_WHEEL * SCALE - 1  # most that wheel correction and axle hold below a pulse
REFERENCE_FRACTION = PER_WORD * (256 * 16 - 1)  # most that reference and divider hold below a pulse


def potential(s: Seen, channel: str = "a") -> Int:
    """How far the speed pulses of a channel are ahead of its reference."""
    c = s[channel]
    ahead = PULSE * c.comparator.u.int() + SCALE * c.ring.j1.int() + s.axle.phase
    return ahead - PER_WORD * (c.ring.j0.int() + 256 * c.div0.n.int())


def excess(s: Seen, channel: str = "a") -> Int:
    """Speed above the limit of a channel, 1/4096 word a frame; negative below it."""
    return s.speed - PER_WORD * s[channel].limit.int()


def overspeed(s: Seen, channel: str = "a", words: int = 0) -> Bit:
    """At least so many words above the limit in force in the channel."""
    return excess(s, channel) >= PER_WORD * words


def underspeed(s: Seen, channel: str = "a", words: int = 0) -> Bit:
    """At least so many words below the limit in force in the channel."""
    return excess(s, channel) <= -PER_WORD * words


def wheel_set_right(s: Seen) -> Bit:
    """On the bench: the wheel switch shows the true diameter, 780 to 860 mm."""
    return (s.wheel == s.true_wheel) & (s.wheel >= SMALLEST_WHEEL) & (s.wheel <= LARGEST_WHEEL)


def named(name: str, formula: Formula) -> Formula:
    """The formula under the name by which results show it."""
    formula.__name__ = name
    return formula


def latch_at_the_ends(channel: str = "a") -> Formula:
    """Lemma: three pulses ahead the brake is set, none ahead it is not."""

    def lemma(s: Seen) -> Bit:
        c = s[channel].comparator
        return implies(c.u == 3, c.latch) & implies(c.u == 0, ~c.latch)

    return named(f"latch of {channel} follows its counter at both ends", lemma)


def braked_and_ahead(s: Seen, channel: str = "a") -> Bit:
    """Braking, and so far ahead that the counter cannot fall to 0 before the speed falls below the limit."""
    return s[channel].comparator.latch & (potential(s, channel) >= 3 * PULSE - REFERENCE_FRACTION)


def free_and_behind(s: Seen, channel: str = "a") -> Bit:
    """Not braking, and so far behind that the counter cannot rise to 3 before the speed rises above the limit."""
    return ~s[channel].comparator.latch & (potential(s, channel) <= SPEED_FRACTION)


def surplus(channel: str = "a", words: int = 1, ticks: int = 19_120, broken: Formula | None = None) -> Formula:
    """Lemma: overspeed by `words` brakes or raises the potential, by `words` a frame; `broken` starts it anew."""

    def lemma(s: Seen) -> Bit:
        over = overspeed(s, channel, words)
        since = age(over if broken is None else over & ~broken(s), ticks).int()
        return braked_and_ahead(s, channel) | (potential(s, channel) >= PER_WORD * words * since - REFERENCE_FRACTION)

    return named(f"overspeed of {words} words brakes {channel} or raises its potential", lemma)


def surplus_of_sum(channel: str = "a", upto: int = 2**27) -> Formula:
    """Lemma: from a start at or above the limit on, the potential has grown by the sum of the excess, or it brakes."""

    def lemma(s: Seen) -> Bit:
        grown = total(excess(s, channel).clip(0, 2**24 - 1).sat(24), upto).int()
        return braked_and_ahead(s, channel) | (potential(s, channel) >= grown - REFERENCE_FRACTION)

    return named(f"the sum of the excess brakes {channel} or raises its potential", lemma)


def deficit(channel: str = "a", words: int = 1, ticks: int = 19_120) -> Formula:
    """Lemma: underspeed by `words` releases or lowers the potential, by `words` a frame."""

    def lemma(s: Seen) -> Bit:
        since = age(underspeed(s, channel, words), ticks).int()
        fallen = 3 * PULSE + SPEED_FRACTION - PER_WORD * words * since
        return free_and_behind(s, channel) | (potential(s, channel) <= fallen)

    return named(f"underspeed of {words} words releases {channel} or lowers its potential", lemma)


def stays_free(channel: str = "a") -> Formula:
    """Lemma for speeds never above the limit: the channel stays free and behind."""
    return named(f"{channel} stays free and behind", lambda s: free_and_behind(s, channel))


def stays_braked(channel: str = "a") -> Formula:
    """Lemma for speeds never below the limit: the channel stays braked and ahead."""
    return named(f"{channel} stays braked and ahead", lambda s: braked_and_ahead(s, channel))
