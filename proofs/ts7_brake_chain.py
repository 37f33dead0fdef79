"""TS-7, from overspeed to the brake: the lemmas along the chain channel, relay NBRR, vote, relay NB.

Each link follows the one before it within a known time, so every lemma ties a register to one clock: for how long the
train has been too fast.  A lemma is excused where a fault has struck that breaks its link; what excuses it is given by
the claim, so that one chain serves proofs about whole channels and cut sets over single components.

Times in frames of 125 us for a margin of m words (0.47124 km/h each) above every healthy limit.
Source: surplus lemma of the channel [D]; relay times 20 ms release [A].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from models.ts7.train import PER_WORD
from proofs.ts7_formulas import (
    PULSE,
    REFERENCE_FRACTION,
    SPEED_FRACTION,
    Formula,
    braked_and_ahead,
    latch_at_the_ends,
    named,
    potential,
)
from safety import Bit, Int, Seen, UInt, age, all_of, any_of, at_least, new_fault, select, word

CHANNELS = "abc"
OFFSET = 4  # greatest error of a healthy channel's threshold, words
RELEASE = 160  # frames from coil to open contact
WORDS = {"s0": 0, "s25": 53, "s45": 95, "s65": 138, "s75": 159, "s90": 191}  # independent of the model, on purpose


@dataclass(frozen=True)
class Chain:
    """The chain for a margin of `words`, with what excuses each link (part of the equipment broken)."""

    words: int
    blind: Callable[[Seen, str], Bit] = lambda s, n: any_of()  # channel n does not see the overspeed
    mute: Callable[[Seen, str], Bit] = lambda s, n: any_of()  # relay NBRR of channel n does not fall
    unheard: Callable[[Seen], Bit] = lambda s: any_of()  # relay NB does not fall
    broken: Callable[[Seen, str], Bit] = lambda s, n: any_of()  # channel n as a whole: its limit does not count
    offset: Callable[[Seen, str], Int] = lambda s, n: word(0, 1).int()  # error of the threshold of channel n

    @property
    def latched(self) -> int:
        """Frames of overspeed after which a channel demands the brake."""
        return -(-(2 * PULSE + SPEED_FRACTION + REFERENCE_FRACTION) // (PER_WORD * self.words)) + 1

    @property
    def voted(self) -> int:
        """Frames after which its relay NBRR is down."""
        return self.latched + RELEASE + 1

    @property
    def braked(self) -> int:
        """Frames after which the brake is applied."""
        return self.voted + RELEASE + 2

    def overspeed(self, s: Seen) -> Bit:
        """The train is at least `words` above the limit of every channel not broken, and no fault begins now."""
        above = (self.broken(s, n) | (s.speed >= PER_WORD * (self.limit(s, n) + self.words)) for n in CHANNELS)
        return all_of(*above) & ~new_fault(s)

    def limit(self, s: Seen, n: str) -> UInt:
        """The limit of channel n when it is healthy and not lowered; a stop stays a stop."""
        allowed = permitted(s)
        return select(allowed == 0, allowed, (allowed + self.offset(s, n)).sat(8))

    def since(self, s: Seen) -> Int:
        """For how many frames, up to the end of the chain."""
        return age(self.overspeed(s), self.braked).int()

    def lemmas(self) -> list[Formula]:
        """All links."""
        links = [f for n in CHANNELS for f in (self._ends(n), self._surplus(n), self._relay(n))]
        return [*links, named("NB falls with two NBRR", lambda s: self._output(s))]

    def _ends(self, n: str) -> Formula:
        inner = latch_at_the_ends(n)
        return named(inner.__name__, lambda s: self.blind(s, n) | inner(s))

    def _surplus(self, n: str) -> Formula:
        def lemma(s: Seen) -> Bit:
            risen = potential(s, n) >= PER_WORD * self.words * self.since(s) - REFERENCE_FRACTION
            return self.blind(s, n) | braked_and_ahead(s, n) | risen

        return named(f"overspeed brakes {n} or raises its potential", lemma)

    def _relay(self, n: str) -> Formula:
        def lemma(s: Seen) -> Bit:
            return self.mute(s, n) | self._falls(s, s.common[n].nbrr_relay, self.latched - 1)

        return named(f"NBRR of {n} falls with its demand", lemma)

    def _output(self, s: Seen) -> Bit:
        two_mute = at_least(2, *(self.mute(s, n) for n in CHANNELS))
        return two_mute | self.unheard(s) | self._falls(s, s.common.nb_relay, self.voted)

    def _falls(self, s: Seen, relay: Seen, after: int) -> Bit:
        """The relay is open, or its release time is still running since frame `after` of the overspeed."""
        return ~relay.closed | ((self.since(s) <= after + relay.waited.int()) & (relay.waited <= RELEASE))


def permitted(s: Seen) -> UInt:
    """The limit that the track allows, in words: that of the lowest active line; no line means stop."""
    limit = word(0, 8)
    for line, value in reversed(WORDS.items()):
        limit = select(s.lines[line], value, limit)
    return limit
