"""A train that passes a group of five reference balises, as benches for the decoder.

The surroundings choose where the balises stand, jitter and scale error; balises may be lost or stand there too many, at
any place.  A step is the run up to a balise, or any stretch without one; nothing has been seen before the group.
"""

from __future__ import annotations

from typing import NamedTuple, Self

from models.position.code import SPAN
from models.position.decoder import FIVE, Decoder, Reading, Spots, Thinned, Unguarded
from models.position.odometer import step_s
from safety import ANY, U3, U6, Bit, Model, Real, assume, bit, point, power_up, real, select


class Detection(NamedTuple):
    """What the next stretch brings."""

    run: Real  # counted, m
    own: Bit  # a balise of the group at its end
    extra: Bit  # one that does not belong to it


class Passed(NamedTuple):
    """What is true at the end of the stretch."""

    since_first: Real  # way since the group's first balise that was seen, m
    window: Real  # W, m
    reading: Reading


class Stood(NamedTuple):
    """The group as it truly stood, as counted, m."""

    spots: Spots
    window: Real  # W
    reading: Reading


class Passing(Model, tick_s=step_s):
    """A group as it truly comes, counted from its first balise: it is no longer than W."""

    decoder: Decoder
    own: U3 = power_up(0)
    lost: Bit = power_up(ANY)  # one of the five gives nothing
    strange: Bit = power_up(False)  # an extra balise has been seen
    first: Real = power_up(0)  # way since the first one, m
    a: Real = power_up(0)
    b: Real = power_up(0)
    c: Real = power_up(0)
    last: Real = power_up(0)

    def step(self, seen: Detection) -> tuple[Self, Passed]:
        """One stretch."""
        here, begun, more = self.first + seen.run, self.own > 0, self.own + self.lost.word() < FIVE
        assume("one balise at a time, five or four of the group", ~(seen.own & (seen.extra | ~more)))
        assume("the group is no longer than W", ~(begun & more) | (here <= SPAN + self.decoder.slack()))
        decoder, reading = self.decoder.step(seen.run, seen.own | seen.extra, bit(False), bit(False))
        spots = zip((1, 2, 3, 4), (self.a, self.b, self.c, self.last), strict=True)
        a, b, c, last = (select(seen.own & (self.own == k), here, spot) for k, spot in spots)
        own, first = (self.own + seen.own.word()).low(3), select(begun, here, real(0))
        following = type(self)(
            decoder=decoder, own=own, lost=self.lost, strange=self.strange | seen.extra,
            first=first, a=a, b=b, c=c, last=last,
        )  # fmt: skip
        return following, Passed(first, SPAN + self.decoder.slack(), reading)


class UnguardedPassing(Passing, tick_s=step_s):
    """The same without the guard."""

    decoder: Unguarded


class ThinnedPassing(Passing, tick_s=step_s):
    """The same with 247 codes."""

    decoder: Thinned


class LaidGroup(Passing, tick_s=step_s):
    """The same with points for faults of the group: a balise that is missing, and one that is too many."""

    def step(self, seen: Detection) -> tuple[Self, Passed]:
        """One stretch."""
        point("missing", bit(False))
        point("extra", bit(False))
        return super().step(seen)


class TrueGroup(Model, tick_s=step_s):
    """A group that has been collected: what DECIDE makes of any code, any jitter and any scale error.

    `scale` is 1 + scale error; jitter is in counted metres, so at most scale times e.
    """

    decoder: Decoder
    scale: Real = power_up(ANY)
    p: U6 = power_up(ANY)
    q: U6 = power_up(ANY)
    r: U6 = power_up(ANY)
    jitter_first: Real = power_up(ANY)
    jitter_p: Real = power_up(ANY)
    jitter_q: Real = power_up(ANY)
    jitter_r: Real = power_up(ANY)
    jitter_last: Real = power_up(ANY)

    def step(self, run: Real) -> tuple[Self, Stood]:
        """A stretch without a balise."""
        decoder, reading = self.decoder.step(run, bit(False), bit(False), bit(False))
        stood = Stood(self.spots(), SPAN + self.decoder.slack(), reading)
        same = {name: getattr(self, name) for name in (*"pqr", *(f"jitter_{n}" for n in ENDS))}
        return type(self)(decoder=decoder, scale=self.scale, **same), stood

    def spots(self) -> Spots:
        """Counted distance of the balises after the first."""
        slots = zip((self.p, self.q, self.r), (self.jitter_p, self.jitter_q, self.jitter_r), strict=True)
        a, b, c = (times(self.scale, slot) + jitter - self.jitter_first for slot, jitter in slots)
        return Spots(a, b, c, SPAN * self.scale + self.jitter_last - self.jitter_first)


ENDS = ("first", "p", "q", "r", "last")


def times(scale: Real, slot: U6) -> Real:
    """A slot in counted metres, case by case."""
    found = real(0)
    for n in range(1, SPAN):
        found = select(slot == n, scale * n, found)
    return found
