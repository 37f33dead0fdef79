"""A train under way with odometer and correction at balises, as a bench: what is true beside what is believed.

In each cycle, anywhere, a balise may be passed, of the line data or not, or a code may tell the place at its end.
"""

from __future__ import annotations

from typing import NamedTuple, Self

from models.position.correction import Ahead, Correction, Entry, Matched
from models.position.locator import Ran, Sighted, Way, counted, locate, unstamped
from models.position.odometer import Fix, Odometer, Position, step_s
from models.position.ride import Limits, Surroundings, Travelled, travelled
from safety import U2, Bit, Model, Real, assume, power_up


class Balise(NamedTuple):
    """A balise, if `seen` in the cycle."""

    seen: Bit
    kind: U2
    which: Ahead  # the balise of the line data that it is
    passed: Real  # true way from its detection to the end of the cycle, m
    since: Real  # the same as counted, m


class Progress(NamedTuple):
    """What is true of the cycle, and what is believed at its end."""

    now: Real  # mean speed, m/s
    there: Real  # position of the head at its end, m
    kept: Limits
    position: Position
    matched: Matched
    own: Entry  # the balise as it stands in the line data


class Journey(Model, tick_s=step_s):
    """Train, wheel, odometer and correction."""

    odometer: Odometer
    correction: Correction
    way: Real = power_up(0)  # true position of the head, m
    speed: Real = power_up(0)  # true mean speed over the last cycle, m/s
    raw: Real = power_up(0)  # way by the plain count, m

    def step(self, at: Surroundings, balise: Balise, code: Fix) -> tuple[Self, Progress]:
        """One cycle, with what is seen in it."""
        own = self.correction.data.stored().one_of(balise.which)
        true = travelled(self.odometer, Travelled(self.way, self.speed, self.raw), at)
        within = (balise.passed >= 0) & (balise.passed <= true.now * self.odometer.cycle)
        assume("a balise is passed anywhere within the cycle", ~balise.seen | within)
        forward = (balise.since >= 0) & (balise.since <= at.wheel * self.odometer.cycle)
        assume("the way since a balise is counted forward, within the cycle", ~balise.seen | forward)
        sight = Sighted(balise.seen, balise.kind, balise.since)
        odometer, correction, position, matched = locate(
            self.odometer, self.correction, at.wheel, sight, code, self.since
        )
        following = type(self)(
            odometer=odometer, correction=correction, way=true.there, speed=true.now, raw=true.counted
        )
        return following, Progress(true.now, true.there, true.kept, position, matched, own)

    def since(self, since: Real, ran: Ran) -> Way:
        """Way since the balise, as on board."""
        return counted(since, ran)


class UnstampedJourney(Journey, tick_s=step_s):
    """The same without time stamps of balises."""

    def since(self, since: Real, ran: Ran) -> Way:
        """Anything that the train can have run in the cycle."""
        return unstamped(since, ran)


class FromTheBeginning(Journey, tick_s=step_s):
    """To be refuted: a balise passed in a cycle counts as passed at its beginning."""

    def since(self, since: Real, ran: Ran) -> Way:
        """The way of the cycle."""
        return Way(ran.least, (ran.least + ran.most) / 2, ran.most)
