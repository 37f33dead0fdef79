"""TS-7 threshold model: channels as exact limits on a real axis, synchronisation as one event.

x is the excess of the speed over the limit V_E of the signal, in km/h; channel i brakes where x > e_i.  One step is one
synchronisation window, over which x stays the same; with no disagreement the step is a moment.
Source: lowering 2 km/h, isolation of the channel that stands alone, accuracy +-2.0 km/h [P]; constant x [A].
Main results: spread of the e_i up to 2.0 km/h isolates nobody; the published +-2.0 (spread 4.0) does.
"""

from __future__ import annotations

from typing import NamedTuple

from models.ts7.voting import Trio, disagree, outvoted
from safety import Bit, Model, Real, any_of, at_least, parameter, point, power_up, select

LOWERING = 2  # km/h [P]
ERROR = "[P] accuracy +-2.0 km/h: the channel's limit is V_E + e"


class Limits(NamedTuple):
    """Limits of the three channels above V_E, km/h."""

    a: Real
    b: Real
    c: Real


class Outcome(NamedTuple):
    """What a window brings."""

    nb: Bit
    eb: Bit
    braked: Trio  # brakes at some instant of the window
    cut: Trio  # isolated at its end
    limit: Limits  # in force in the window, km/h above V_E


class Window(NamedTuple):
    """A window at constant speed, as a pure function of the speed and the limits."""

    lowered: Trio
    braked: Trio
    odd: Trio  # stands alone at the end: to be isolated


def window(own: Trio, follows: Trio, synchronising: Bit) -> Window:
    """Outcome of a window: who brakes by its own limit, who would by the lowered one, whether there is a window."""
    opens = synchronising & disagree(own)
    lowered = Trio(*(opens & ~brake for brake in own))
    braked = Trio(*(b | (low & f) for b, low, f in zip(own, lowered, follows, strict=True)))
    return Window(lowered, braked, Trio(*(opens & odd for odd in outvoted(braked))))


class Thresholds(Model, event="window of constant speed"):
    """Three channels with constant limits, synchronisation, isolation and vote by rule (a)."""

    cut_a: Bit = power_up(False)
    cut_b: Bit = power_up(False)
    cut_c: Bit = power_up(False)
    e_a: Real = parameter(0, unit="km/h", within=(-2, 2), source=ERROR)
    e_b: Real = parameter(0, unit="km/h", within=(-2, 2), source=ERROR)
    e_c: Real = parameter(0, unit="km/h", within=(-2, 2), source=ERROR)

    def step(self, x: Real) -> tuple[Thresholds, Outcome]:
        """One window at excess speed x, km/h."""
        e, cut = Limits(self.e_a, self.e_b, self.e_c), Trio(self.cut_a, self.cut_b, self.cut_c)
        own = Trio(*(point(f"brakes_{n}", x > limit) for n, limit in zip("abc", e, strict=True)))
        follows = Trio(*(point(f"follows_{n}", x > limit - LOWERING) for n, limit in zip("abc", e, strict=True)))
        seen = window(own, follows, ~any_of(*cut))
        cut = Trio(*(before | odd for before, odd in zip(cut, seen.odd, strict=True)))
        limit = Limits(*(select(low, own - LOWERING, own) for own, low in zip(e, seen.lowered, strict=True)))
        nb, eb = self.brakes(seen.braked, cut), at_least(2, *cut)
        return type(self)(cut_a=cut.a, cut_b=cut.b, cut_c=cut.c), Outcome(nb, eb, seen.braked, cut, limit)

    def brakes(self, braked: Trio, cut: Trio) -> Bit:
        """Rule (a): two of three, an isolated channel counts as braking."""
        return at_least(2, *(brake | out for brake, out in zip(braked, cut, strict=True)))


class BothRemaining(Thresholds, event="window of constant speed"):
    """Rule (b), to be refuted: an isolated channel has no vote, both remaining ones must brake."""

    def brakes(self, braked: Trio, cut: Trio) -> Bit:
        """Two of three; after an isolation all that remain."""
        remaining = [brake | out for brake, out in zip(braked, cut, strict=True)]
        return select(any_of(*cut), remaining[0] & remaining[1] & remaining[2], at_least(2, *braked))
