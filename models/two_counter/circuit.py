"""Circuit of the two-counter ATC: counters 1 and 2 with their gate circuits, AND1..AND3, FF2, FF6, relay Ry-1.

One step is one period of the standard oscillator, 155.8695 us; in it comes first the edge of the speed generator, if
any, then the oscillator's pulse at its end.

    f2 edge --> counter 2, gate circuit 2 --> signals 1, 2, 3, gate
    f1, gate --> AND1 --> counter 1, gate circuit 1 --> FF6 (reset by 2) --> AND2, AND3 (strobed by 1) --> FF2 --> Ry-1

Source: blocks, order of the signals, polarity of the relay [P]; half pulses, read-out after one pulse, start after four
[D]; reset after two, wrap of the 11 stages, power-up, set before reset, relay times [A].
"""

from __future__ import annotations

from typing import NamedTuple

from models.ts7.voting import Relay
from models.two_counter import TUNED, step_s
from models.two_counter.selection import Stages
from models.two_counter.train import PulseCount
from safety import U10, Bit, Model, UInt, bit, parameter, point, power_up, select

READ_OUT, RESET, START = 2, 4, 8  # edges after the end of a count: signals 1, 2 and 3


class Signals(NamedTuple):
    """What counter 2 says, at the edge at which it does; `gate` lasts."""

    signal1: Bit  # read-out
    signal2: Bit  # reset
    signal3: Bit  # count start
    gate: Bit  # counter 1 counts


class Counter2(Model, tick_s=step_s):
    """Counter 2 and gate circuit 2: edges of the speed generator, up to the preset and through the preparation."""

    n: Stages = power_up(0)
    counting: Bit = power_up(False)

    def step(self, edge: Bit, preset: Stages) -> tuple[Counter2, Signals]:
        """Count an edge, if there is one."""
        edge = point("input", edge)
        counted = point("count", select(edge, (self.n + 1).low(11), self.n))
        full = edge & self.counting & self.reached(counted, preset)
        prepared = edge & ~self.counting
        read_out = point("signal1", prepared & (counted == READ_OUT))
        reset = point("signal2", prepared & (counted == RESET))
        start = point("signal3", prepared & (counted == START))
        n = point("cleared", select(point("clear", full | start), 0, counted))
        gate = point("gate", start | (self.counting & ~full))
        return type(self)(n=n, counting=gate), Signals(read_out, reset, start, gate)

    def reached(self, counted: UInt, preset: UInt) -> Bit:
        """Gate circuit 2: the preset is reached or passed."""
        return counted >= preset


class RequiredCount(Model):
    """The count that makes a sample safe, one for all check speeds."""

    n1f: Stages = parameter(
        TUNED, unit="pulse", within=(1885, 2047), source="[A]; [D] 1884 < n1F <= 2355, and 11 stages reach 2047"
    )


class Counter1(RequiredCount, tick_s=step_s):
    """Counter 1 and gate circuit 1: oscillator pulses in the gate; it says at each pulse whether there are n1F."""

    n: Stages = power_up(0)

    def step(self, pulses: PulseCount, reset: Bit) -> tuple[Counter1, Bit]:
        """Reset, then count; a stage that is stuck is so after either."""
        before = point("cleared", select(point("clear", reset), 0, self.n))
        n = point("count", (before + pulses).low(11))
        between = (pulses == 2) & ((before + 1).low(11) >= self.n1f)
        return type(self)(n=n), point("gate1", (pulses > 0) & ((n >= self.n1f) | between))


class Memory(Model, tick_s=step_s):
    """Flip-flop FF6: set dominates reset."""

    on: Bit = power_up(False)

    def step(self, set_: Bit, reset: Bit) -> tuple[Memory, Bit]:
        """Its content after both."""
        on = point("on", set_ | (self.on & ~reset))
        return type(self)(on=on), on


class CommandMemory(Memory, tick_s=step_s):
    """Flip-flop FF2: 1 is brake, and so it is when power comes."""

    on: Bit = power_up(True)


class BrakeRelay(Relay, tick_s=step_s):
    """Relay Ry-1: energised is brake release."""

    operate: U10 = parameter(0, unit="period", within=(0, 800), source="[A] coil to closed contact; 642 are 0.1 s")
    release: U10 = parameter(0, unit="period", within=(0, 800), source="[A] coil to open contact; 642 are 0.1 s")


class Command(NamedTuple):
    """What driver and test circuits see."""

    brake: Bit  # Ry-1 is open
    ff7: Bit  # brake output of the test circuit, follows FF2
    signal1: Bit
    signal2: Bit
    signal3: Bit
    gate: Bit


class Gating:
    """The gates between the memories, which the variants change."""

    def strobed(self, name: str, opened: Bit, read_out: Bit) -> Bit:
        """AND2 or AND3: opened by FF6, then strobed by signal 1."""
        return point(name, opened) & read_out

    def of_ff2(self, and2: Bit, and3: Bit) -> tuple[Bit, Bit]:
        """Set and reset of FF2: AND2 sets, AND3 resets."""
        return and2, and3

    def of_ff6(self, enough: Bit, signal2: Bit) -> tuple[Bit, Bit]:
        """Set and reset of FF6: gate circuit 1 sets, signal 2 resets."""
        return enough, signal2

    def energised(self, brake: Bit) -> Bit:
        """Coil of Ry-1: the complement of FF2."""
        return ~brake


class Circuit(Gating, Model, tick_s=step_s):
    """The prototype's circuit, from the edges of the speed generator to the relay."""

    counter2: Counter2
    counter1: Counter1
    ff6: Memory
    ff2: CommandMemory
    ry1: BrakeRelay

    def step(self, edge: Bit, pulses: PulseCount, preset: Stages) -> tuple[Circuit, Command]:
        """One period: an edge or none, then the oscillator's pulses."""
        counter2, seen = self.counter2.step(edge, preset)
        safe = self.ff6.on
        and2, and3 = self.strobed("and2", ~safe, seen.signal1), self.strobed("and3", safe, seen.signal1)
        ff2, brake = self.ff2.step(*self.of_ff2(and2, and3))
        counter1, enough = self.counter1.step(select(point("and1", seen.gate), pulses, 0), seen.signal2)
        ff6, _ = self.ff6.step(*self.of_ff6(enough, seen.signal2))
        ry1, released = self.ry1.step(point("supply", bit(True)) & self.energised(brake))
        following = type(self)(counter2=counter2, counter1=counter1, ff6=ff6, ff2=ff2, ry1=ry1)
        return following, Command(~released, point("ff7", brake), *seen)
