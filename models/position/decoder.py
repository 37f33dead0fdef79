"""Decoder of the absolute position code: COLLECT, GUARD, DECIDE over counted distances.

    COLLECT  the first reference balise opens a group; further ones belong to it while x - x0 <= W = (L + 2e)(1 + eps)
    GUARD    one more within W after the last one: the whole group is rejected, on and on until W is free
    DECIDE   accepted: exactly five, no hit of the guard, span within L eps + 2e (1 + eps) of L, every inner one within
             u_tol of a slot of 40ths of the span, slots different, code in the line data; a reversal, slip or slide
             rejects

A slot is u = 1 m, L = 40 m.  A step is the run up to a balise, or any stretch without one.
Source: five balises of a kind of their own [P]; rules and numbers [A].
"""

from __future__ import annotations

from fractions import Fraction
from typing import ClassVar, NamedTuple, Self

from models.kinematics import at_most
from models.position.code import SPAN
from models.position.code_sets import TURNED, CodeSet, bose
from models.position.odometer import step_s
from safety import (
    U3,
    U6,
    Bit,
    Model,
    Real,
    UInt,
    all_of,
    any_of,
    assume,
    bit,
    parameter,
    point,
    power_up,
    real,
    require,
    select,
    word,
)

FIVE = 5


class Spots(NamedTuple):
    """Counted distance of the balises after the first, m."""

    a: Real
    b: Real
    c: Real
    last: Real


class Slot(NamedTuple):
    """The slot of an inner balise, and whether it is near enough to one."""

    number: U6
    clear: Bit


class Reading(NamedTuple):
    """What comes of a group at its end; `origin` is the way run since its first balise, m."""

    accepted: Bit
    rejected: Bit
    p: U6
    q: U6
    r: U6
    origin: Real


def window(e: Fraction, eps: Fraction) -> Fraction:
    """W, m: no group is longer as counted."""
    return (SPAN + 2 * e) * (1 + eps)


def span_tolerance(e: Fraction, eps: Fraction) -> Fraction:
    """How far the counted span of a true group can be from L, m."""
    return SPAN * eps + 2 * e * (1 + eps)


def below(name: str, limit: Real, divisor: Fraction | int, unit: str) -> str:
    """What to say of a parameter that is too large."""
    return f"the nearest admissible {name} is any below {at_most(limit.attr / divisor)} {unit}"


def read(spot: Real, last: Real, tolerance: Fraction | Real) -> Slot:
    """The slot at a counted distance of a group that is `last` long: within `tolerance`, in slots, of n 40ths of it."""
    slack = last * tolerance
    near = [(spot * SPAN - last * n <= slack) & (last * n - spot * SPAN <= slack) for n in range(1, SPAN)]
    number = word(0, 6)
    for n, here in enumerate(near, start=1):
        number = select(here, word(n, 6), number)
    return Slot(number, any_of(*near))


class Collector(Model, tick_s=step_s):
    """COLLECT and GUARD."""

    count: U3 = power_up(0)  # balises in the group, 6 for more than five
    hit: Bit = power_up(False)  # by the guard
    since_first: Real = power_up(0)
    since_last: Real = power_up(0)
    a: Real = power_up(0)
    b: Real = power_up(0)
    c: Real = power_up(0)
    last: Real = power_up(0)

    def step(self, from_first: Real, from_last: Real, balise: Bit, ends: Bit, usable: Bit, window: Real) -> Collector:
        """Way since first and last balise of the group; whether one is here; whether the group has ended before it."""
        opens, inside = balise & usable & (ends | (self.count == 0)), from_first <= window
        goes_on = ~ends & (self.count > 0)
        taken = balise & goes_on & inside
        spots = zip((2, 3, 4, 5), (self.a, self.b, self.c, self.last), strict=True)
        a, b, c, fifth = (select(taken & (self.count == k - 1), from_first, spot) for k, spot in spots)
        more = select(self.count >= FIVE, word(FIVE + 1, 3), (self.count + 1).low(3))
        count = select(taken, more, select(goes_on, self.count, select(opens, word(1, 3), word(0, 3))))
        return type(self)(
            count=count, hit=goes_on & (self.hit | (balise & ~inside)), a=a, b=b, c=c, last=fifth,
            since_first=select(opens, real(0), from_first), since_last=select(balise, real(0), from_last),
        )  # fmt: skip


class DecoderData(Model):
    """What a decoder works with; `codes` are those of the line data, None for all 9139."""

    codes: ClassVar[CodeSet | None] = None
    jitter: Real = parameter(Fraction("0.1"), unit="m", within=(0, 1), source="[A] e, of the detection of a balise")
    eps: Real = parameter(Fraction("0.01"), unit="1", within=(0, Fraction("0.1")), source="[A] scale error")
    u_tol: Real = parameter(Fraction("0.25"), unit="slot", within=(0, Fraction("0.49")), source="[A] off a slot")

    def slack(self) -> Real:
        """How far the counted span of a true group can be from L, m; W less L."""
        return SPAN * self.eps + 2 * self.jitter + 2 * self.jitter * self.eps

    def check(self) -> None:
        """Refuse numbers with which codes are not told apart."""
        require("2e below u_tol", 2 * self.jitter < self.u_tol, lambda: below("jitter", self.u_tol, 2, "m"))
        require("L eps + 2e (1 + eps) below one slot", self.slack() < 1, lambda: below("eps", *self.widest(), "1"))

    def widest(self) -> tuple[Real, Fraction]:
        """The scale error at which the span is off by one slot, as dividend and divisor."""
        return 1 - 2 * self.jitter, SPAN + 2 * self.jitter.attr

    def listed(self, p: UInt, q: UInt, r: UInt) -> Bit:
        """Whether the line data have the code."""
        if self.codes is None:
            return bit(True)
        return any_of(*((p == code[0]) & (q == code[1]) & (r == code[2]) for code in sorted(self.codes)))


class Decoder(DecoderData, tick_s=step_s):
    """The decoder."""

    group: Collector

    def step(self, run: Real, balise: Bit, reverses: Bit, slips: Bit) -> tuple[Self, Reading]:
        """Counted way since the last step, m; whether a reference balise is at its end; reversal, slip or slide."""
        self.check()
        assume("the train runs forward", run >= 0)
        group, spoilt = self.group, reverses | slips
        first, last = group.since_first + run, group.since_last + run
        ends = (group.count > 0) & (spoilt | self.over(first, last))
        slots = [read(spot, group.last, self.u_tol) for spot in (group.a, group.b, group.c)]
        p, q, r = (each.number for each in slots)
        span = (group.last - SPAN <= self.slack()) & (SPAN - group.last <= self.slack())
        clear = all_of(*(each.clear for each in slots)) & (p < q) & (q < r) & span
        five = (group.count == FIVE) & ~group.hit
        accepted = point("accepted", ends & ~spoilt & five & clear & self.listed(p, q, r))
        following = group.step(first, last, point("balise", balise), ends, ~spoilt, SPAN + self.slack())
        return type(self)(group=following), Reading(accepted, ends & ~accepted, p, q, r, first)

    def over(self, first: Real, last: Real) -> Bit:
        """Whether the group has ended: W after its last balise, hit or not, is free."""
        return last > SPAN + self.slack()


class Unguarded(Decoder, tick_s=step_s):
    """Without the guard, to be refuted: the group ends with its window, and the next balise opens another one."""

    def over(self, first: Real, last: Real) -> Bit:
        """Whether W after the first balise is over."""
        return first > SPAN + self.slack()


class Thinned(Decoder, tick_s=step_s):
    """With the 247 codes of which none is another one's misreading."""

    codes = bose(TURNED)
