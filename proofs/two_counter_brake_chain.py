"""Two-counter ATC: from overspeed to the brake, the invariants along the sampling periods.

What is *left* until a read-out that must brake is a number of edges of the speed generator, less what the axle has
turned since the last one; overspeed works it off at its own pace, whatever the phases.  A count is *short* when the
rest of the gate time is too short to reach n1F at this speed; a count that began in overspeed is.

    counting, short    -> read-out that brakes, 2 edges after the gate closes
    counting, not short -> the count may still say safe; 10 edges and a whole count later the brake is there
    preparing          -> before the read-out FF6 decides, after it a count follows that is short

An invariant is excused where a fault has struck that breaks its link; what excuses it is given by the claim.
One step is an oscillator period.  Source: property 4, at most 2 n2E + 5 pulses at the check speed [D].
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from models.two_counter.circuit import READ_OUT, RESET, START
from models.two_counter.numbers import N1F
from proofs.two_counter_formulas import EDGE, Formula, least_too_fast, named
from safety import Bit, Fault, Int, Seen, age, any_of, implies, new_fault, select, struck

FULL = 2048  # edges after which counter 2 is at 0 again


def never(s: Seen) -> Bit:
    """No excuse."""
    return any_of()


def excuse(faults: Sequence[Fault], singles: Iterable[str], pairs: Iterable[tuple[str, str]]) -> Formula:
    """Of these faults one has struck after which overspeed need not brake, or a pair of which both are needed."""
    names = {fault.name for fault in faults}
    alone = [name for name in singles if name in names]
    together = [pair for pair in pairs if names.issuperset(pair)]

    def broken(s: Seen) -> Bit:
        return any_of(*(struck(s, n) for n in alone), *(struck(s, a) & struck(s, b) for a, b in together))

    return broken


@dataclass(frozen=True)
class Chain:
    """The chain at one check speed of preset `m`, with what excuses its links."""

    m: int
    broken: Formula = never  # faults after which overspeed need not brake
    stranded: Formula = never  # faults after which a count may end without a preparation

    @property
    def speed(self) -> int:
        """The least speed at which a brake is certain, whatever the phase."""
        return least_too_fast(self.m)

    @property
    def braked(self) -> int:
        """Steps after which the brake is applied."""
        return -(-(2 * self.m + START + READ_OUT) * EDGE // self.speed) + 1

    def overspeed(self, s: Seen) -> Bit:
        """At the least speed that brakes, or above; no fault begins now."""
        return (s.speed >= self.speed) & ~new_fault(s)

    def short(self, s: Seen) -> Bit:
        """FF6 is off, and stays so at overspeed until the gate closes."""
        rest = EDGE * (self.m - s.circuit.counter2.n.int()) - s.train.phase
        return ~s.circuit.ff6.on & (self.speed * (N1F - opened(s)) >= rest)

    def braking(self, s: Seen) -> Bit:
        """The brake is applied, and the next read-out applies it again."""
        return s.circuit.ff2.on & select(s.circuit.counter2.counting, self.short(s), ~s.circuit.ff6.on)

    def left(self, s: Seen) -> Int:
        """Turning until a read-out that must brake."""
        n, safe = s.circuit.counter2.n.int(), s.circuit.ff6.on
        whole = START + self.m + READ_OUT
        counting = select(self.short(s), self.m + READ_OUT - n, self.m + whole - n)
        preparing = select((n < READ_OUT) & ~safe, READ_OUT - n, whole - n)
        edges = select(s.circuit.counter2.counting, counting, select(self.stranded(s), self._next(s), preparing))
        return EDGE * edges - s.train.phase

    def _next(self, s: Seen) -> Int:
        """Edges until a read-out that must brake, where no count begins: the next one, if FF6 is off by then."""
        n, safe = s.circuit.counter2.n.int(), s.circuit.ff6.on
        read_out = select(n < READ_OUT, READ_OUT - n, select(n < START, START + READ_OUT - n, FULL + READ_OUT - n))
        off = ~safe | ((n >= READ_OUT) & (n < RESET))
        return select(off, read_out, read_out + START)

    def lemmas(self) -> list[Formula]:
        """All invariants."""
        found = [self._period, self._cleared, self._counted, self._worked_off]
        return [named((one.__doc__ or "").partition(".")[0], lambda s, one=one: one(s)) for one in found]

    def _period(self, s: Seen) -> Bit:
        """Counter 2 is within its period."""
        n = s.circuit.counter2.n
        counting = (n < self.m) & ~self.stranded(s)
        return self.broken(s) | select(s.circuit.counter2.counting, counting, self.stranded(s) | (n < START))

    def _cleared(self, s: Seen) -> Bit:
        """Counter 1 and FF6 are cleared before a count begins."""
        n, c1 = s.circuit.counter2.n, s.circuit.counter1.n
        before = ~s.circuit.counter2.counting & (n >= RESET) & (n < START)
        return self.broken(s) | self.stranded(s) | implies(before, (c1 == 0) & ~s.circuit.ff6.on)

    def _counted(self, s: Seen) -> Bit:
        """Counter 1 shows no more than the steps for which the gate has been open."""
        shut = (opened(s) == 0) | (s.circuit.counter2.n == 0)
        return self.broken(s) | select(s.circuit.counter2.counting, s.circuit.counter1.n.int() <= opened(s), shut)

    def _worked_off(self, s: Seen) -> Bit:
        """Overspeed has worked off its share, or the brake is applied for good."""
        since = age(self.overspeed(s), self.braked).int()
        most = (2 * self.m + START + READ_OUT) * EDGE
        return self.broken(s) | self.braking(s) | (self.left(s) <= most - self.speed * since)


def opened(s: Seen) -> Int:
    """For how many steps the gate has been open."""
    return age(s.gate, FULL).int()
