"""A train under way with odometer and correction at balises, as a bench: what is true beside what is believed.

Before each cycle a balise may be seen, of the line data or not, or a code may tell the place.
"""

from __future__ import annotations

from typing import NamedTuple

from models.position.correction import Ahead, Correction, Entry, Matched, Where
from models.position.odometer import Fix, Odometer, step_s
from models.position.ride import Limits, Surroundings, Travelled, travelled
from safety import U2, Bit, Model, Real, power_up


class Balise(NamedTuple):
    """A balise, if `seen` before the cycle."""

    seen: Bit
    kind: U2
    which: Ahead  # the balise of the line data that it is


class Progress(NamedTuple):
    """What is true of the cycle, and what the correction told before it."""

    now: Real  # mean speed, m/s
    there: Real  # position of the head at its end, m
    kept: Limits
    matched: Matched
    own: Entry  # the balise as it stands in the line data


class Journey(Model, tick_s=step_s):
    """Train, wheel, odometer and correction."""

    odometer: Odometer
    correction: Correction
    way: Real = power_up(0)  # true position of the head, m
    speed: Real = power_up(0)  # true mean speed over the last cycle, m/s
    raw: Real = power_up(0)  # way by the plain count, m

    def step(self, at: Surroundings, balise: Balise, code: Fix) -> tuple[Journey, Progress]:
        """One cycle, with what is seen before it."""
        before, own = self.odometer, self.correction.data.stored().one_of(balise.which)
        where = Where(before.s_lo, before.s, before.s_hi)
        correction, matched = self.correction.step(balise.seen, balise.kind, where, code)
        true = travelled(before, Travelled(self.way, self.speed, self.raw), at)
        odometer, _ = self.odometer.step(at.wheel, matched.fix)
        following = type(self)(
            odometer=odometer, correction=correction, way=true.there, speed=true.now, raw=true.counted
        )
        return following, Progress(true.now, true.there, true.kept, matched, own)
