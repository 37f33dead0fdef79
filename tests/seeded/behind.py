"""More wrong parts of TS-7, for campaigns: relays, votes, counters, words."""

from __future__ import annotations

from models.ts7.channel import Channel
from models.ts7.parts import CheckWindow, Comparator, Divider, RollBackComparator
from models.ts7.power import Power
from models.ts7.ring import Overflow, Words
from models.ts7.signals import Lines, Selection
from models.ts7.voting import ChannelRelays, CommonPart, Relay, Synchronisation, Trio, Vote, Window, outvoted
from safety import U8, Bit, UInt, any_of, at_least, bit, point, select


class ReleasesAtOnce(Relay):
    """The contact opens in the frame in which the coil loses its supply."""

    def step(self, energised: Bit) -> tuple[ReleasesAtOnce, Bit]:
        coil = point("coil", energised)
        differs = coil ^ self.closed
        moves = differs & (~coil | (self.waited >= self.operate))
        waited = select(differs & ~moves, (self.waited + 1).low(10), 0)
        closed = self.closed ^ moves
        return type(self)(closed=closed, waited=waited), point("contact", closed)


class ReleasesTooLate(Relay):
    """Release takes 800 frames, not 160."""

    def step(self, energised: Bit) -> tuple[ReleasesTooLate, Bit]:
        coil = point("coil", energised)
        differs = coil ^ self.closed
        moves = differs & (self.waited >= select(coil, self.operate, 800))
        waited = select(differs & ~moves, (self.waited + 1).low(10), 0)
        closed = self.closed ^ moves
        return type(self)(closed=closed, waited=waited), point("contact", closed)


class HoldsItself(Relay):
    """A closed contact keeps its own coil energised: once up, always up."""

    def step(self, energised: Bit) -> tuple[HoldsItself, Bit]:
        following, contact = super().step(energised | self.closed)
        return following, contact


class ThreeOfThree(CommonPart):
    """All three relays NBRR have to be up: one channel alone stops the train."""

    def released(self, runs: Trio, isolated: Trio) -> Bit:
        return at_least(3, *runs)


class WithoutC(CommonPart):
    """The contact of channel c is missing in the vote: a and b decide, and both have to be up."""

    def released(self, runs: Trio, isolated: Trio) -> Bit:
        return runs.a & runs.b


class NoEmergencyForRollBack(CommonPart):
    """A train that rolls back gets no emergency brake."""

    def permitted(self, isolated: Trio, rolling_back: Trio) -> Bit:
        return ~at_least(2, *isolated)


class OneIsolatedStops(CommonPart):
    """One isolated channel brings the emergency brake, not two."""

    def permitted(self, isolated: Trio, rolling_back: Trio) -> Bit:
        return ~any_of(*isolated) & ~any_of(*rolling_back)


class EndsWithoutVerdict(Synchronisation):
    """A window ends at once, without a verdict: nobody is ever isolated by comparison."""

    def settled(self, brakes: Trio) -> Bit:
        return bit(True)


class NeverIsolatesC(Synchronisation):
    """Channel c is not compared with the others."""

    def odd(self, seen: Trio) -> Trio:
        return outvoted(seen)._replace(c=bit(False))


class IsolatesWhoBrakes(Synchronisation):
    """At the end of a window all channels that have braked are isolated."""

    def odd(self, seen: Trio) -> Trio:
        return seen


class NobodyIsFirst(Window):
    """Who braked when the window opened is forgotten, so that all are lowered."""

    def first(self) -> Trio:
        return Trio(bit(False), bit(False), bit(False))


class ForgetsWhoBraked(Window):
    """Only who brakes at the end of the window counts, not who has braked in it."""

    def seen(self, brakes: Trio) -> Trio:
        return brakes


class DividesByFifteen(Divider):
    """The post-divider starts anew at fifteen."""

    def step(self, pulse: Bit) -> tuple[DividesByFifteen, Bit]:
        counted = point("n", self.n) + pulse.word()
        full = counted >= 15
        return type(self)(n=select(full, 0, counted.low(4))), full


class StopsAtTwo(Comparator):
    """The counter stops at two: the latch never sets."""

    def step(self, up: Bit, down: Bit) -> tuple[StopsAtTwo, Bit]:
        rise, fall = up & ~down, down & ~up
        more = select(self.u >= 2, self.u, (self.u + 1).sat(2))
        u = point("u", select(rise, more, select(fall, self.u.sat_sub(1), self.u)))
        latch = point("latch", (u == 3) | (self.latch & (u != 0)))
        return type(self)(u=u, latch=latch), latch


class DoesNotHold(Comparator):
    """The latch does not hold: it is there only while the counter stands at three."""

    def step(self, up: Bit, down: Bit) -> tuple[DoesNotHold, Bit]:
        rise, fall = up & ~down, down & ~up
        u = point("u", select(rise, (self.u + 1).sat(2), select(fall, self.u.sat_sub(1), self.u)))
        latch = point("latch", u == 3)
        return type(self)(u=u, latch=latch), latch


class NeverReverse(RollBackComparator):
    """Roll-back is never found."""

    def step(self, up: Bit, down: Bit) -> tuple[NeverReverse, Bit]:
        following, _ = super().step(up, down)
        return following, bit(False)


class JudgesBelowOnly(CheckWindow):
    """Too many overflows of the check word pass."""

    def normal(self, counted: UInt) -> Bit:
        return counted > 64


class JudgesAboveOnly(CheckWindow):
    """Too few overflows of the check word pass."""

    def normal(self, counted: UInt) -> Bit:
        return counted < 128


class ReferenceAtPulses(Words):
    """The limit is added in frames with a speed pulse only, like the wheel."""

    def step(self, d0: U8, d1: U8, d2: U8, d3: U8, pulse: Bit) -> tuple[ReferenceAtPulses, Overflow]:
        following, overflow = super().step(select(pulse, d0, 0), d1, d2, d3, pulse)
        return following, overflow


class WheelOfTheDrawing(Words):
    """The wheel switch is not read: the wheel counts as 820 mm whatever is set."""

    def step(self, d0: U8, d1: U8, d2: U8, d3: U8, pulse: Bit) -> tuple[WheelOfTheDrawing, Overflow]:
        following, overflow = super().step(d0, (d1 & 0) | 164, d2, d3, pulse)
        return following, overflow


class LowersTwice(Channel):
    """The limit is lowered by twice the number of words."""

    def limit(self, word: UInt, lowered: Bit) -> UInt:
        own = select(word == 0, word, (word + self.offset).sat(8))
        return select(lowered, own.sat_sub(self.lowering).sat_sub(self.lowering), own)


class OneRowFurther(Selection):
    """Each line selects the row of the next higher signal."""

    def chosen(self, lines: Lines, words: tuple[UInt, ...]) -> UInt:
        return super().chosen(lines, (*words[1:], words[-1]))


class SwapsTheRelays(ChannelRelays):
    """The coils of CHR and NBRR are exchanged."""

    def step(self, drive: Bit, cut: Bit, supply: Bit) -> tuple[SwapsTheRelays, Vote]:
        following, vote = super().step(drive, cut, supply)
        return following, Vote(chr=vote.nbrr, nbrr=vote.chr)


class SupplyIsThere(Power):
    """The supply is there whether or not a source delivers."""

    def step(self, inverter: Bit, mg: Bit) -> tuple[SupplyIsThere, Bit]:
        following, _ = super().step(inverter, mg)
        return following, bit(True)
