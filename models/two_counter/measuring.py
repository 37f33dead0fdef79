r"""Test circuits of the two-counter ATC: ramp with lost pulses, static test, dynamic test with memory Me (figure 8).

One step is one period of the standard oscillator, 155.8695 us; speeds in thousandths of a generator pulse per counting
time Tc, 2000 a km/h.
Source: oscillator of eight times the frequency with three binary stages, Me set by signal 3 and reset by FF7 [P];
Me is gated by a reset R and its time is counted in oscillator periods [A].

From 1 km/h below f2E up by 1 km/h/s until it brakes, 250 km/h selected, one generator pulse in 500 lost:

    rightside run two_counter.measuring.Ride "lines.*=0" lines.s250=1 --steps 16000 --show "brake,signal1,speed" \
        --set start=25775 --set acceleration=100 --set lost_one_in=500
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from models.two_counter import step_s
from models.two_counter.circuit import Circuit
from models.two_counter.equipment import Surroundings
from models.two_counter.selection import Lines, Selection, Stages
from models.two_counter.train import KMH, TURN, Oscillator, Speed
from safety import ANY, U3, U9, U12, U16, Bit, Int, Model, UInt, assume, parameter, point, power_up, select, word

PARTS = 100_000  # of a speed unit, times n1F; 0.01 km/h/s is 20 units a second, a step lasts 0.311739 s / n1F
HALF_STEP = 311_739  # such parts that 0.01 km/h/s brings in half a step
Part = Annotated[Int, (0, 2047 * PARTS - 1)]


class Ramp(Model, tick_s=step_s):
    """Constant acceleration: the way turned in each step is that of the continuous motion, for a nominal oscillator."""

    gained: Speed = power_up(0)
    rest: Part = power_up(0)  # of the speed
    ahead: Part = power_up(0)  # of the way, which is rounded up
    start: U16 = parameter(
        25_775, unit="0.01 km/h", within=(0, 40_000), source="[A] V = f/k at power-up; 258.75 is f2E of 250 km/h"
    )
    acceleration: U9 = parameter(100, unit="0.01 km/h/s", within=(0, 300), source="[P] 1 km/h/s; others to vary it")

    def step(self, n1f: Stages) -> tuple[Ramp, Speed]:
        """The way turned in one step."""
        unit, half = (n1f * PARTS).int(), self.acceleration.int() * HALF_STEP
        missing = self.rest + half - self.ahead
        whole = (missing > 0).word() + (missing > unit).word()
        ahead = select(missing > unit, unit + unit, select(missing > 0, unit, 0)) - missing
        reached = self.rest + half + half
        faster = reached >= unit
        rest = select(faster, reached - unit, reached).clip(0, 2047 * PARTS - 1)
        gained = (self.gained + faster.word()).clip(0, 400 * KMH)
        speed = (self.start.int() * (KMH // 100) + self.gained + whole).clip(0, 400 * KMH)
        return type(self)(gained=gained, rest=rest, ahead=ahead.clip(0, 2047 * PARTS - 1)), speed


class Loss(Model, tick_s=step_s):
    """A speed generator that loses the last pulse, two edges, of each so many."""

    came: U12 = power_up(0)  # edges of this many
    lost_one_in: U12 = parameter(0, unit="pulse", within=(0, 2000), source="[A] one pulse lost in so many; 0 for none")

    def step(self, edge: Bit) -> tuple[Loss, Bit]:
        """The edge, unless it is lost."""
        edges = (self.lost_one_in + self.lost_one_in).low(12)
        last, lost = self.came + 1 >= edges, (edges != 0) & (self.came + 2 >= edges)
        came = select(edge, select(last, 0, (self.came + 1).low(12)), self.came)
        return type(self)(came=came), edge & ~lost


class Journey(NamedTuple):
    """What is seen of a ride."""

    speed: Speed
    brake: Bit
    signal1: Bit
    gate: Bit


class Ride(Surroundings, tick_s=step_s):
    """The equipment on a ramp, its speed generator losing pulses: settings are all that it needs besides the lines."""

    ramp: Ramp
    loss: Loss
    circuit: Circuit

    def step(self, lines: Lines) -> tuple[Ride, Journey]:
        """One period."""
        ramp, speed = self.ramp.step(self.circuit.counter1.n1f)
        outside, edge, pulses, preset = self.arriving(speed, lines, self.circuit.counter1.n1f)
        loss, edge = self.loss.step(edge)
        circuit, command = self.circuit.step(edge, pulses, preset)
        following = type(self)(**outside, ramp=ramp, loss=loss, circuit=circuit)
        return following, Journey(speed, command.brake, command.signal1, command.gate)


class Measuring(Model, tick_s=step_s):
    """Memory Me and the counter of the time for which it is set."""

    on: Bit = power_up(False)
    elapsed: U16 = power_up(0)

    def step(self, signal3: Bit, ff7: Bit, reset: Bit) -> tuple[Measuring, UInt]:
        """Set by signal 3 (t1), reset by the brake (t4) or R; periods from t1 to t4, or to now."""
        on = point("on", (self.on | signal3) & ~ff7 & ~reset)
        elapsed = select(reset, 0, select(on, (self.elapsed + 1).sat(16), self.elapsed))
        return type(self)(on=on, elapsed=elapsed), elapsed


class Measured(NamedTuple):
    """What the instruments of the dynamic test show."""

    brake: Bit
    signal1: Bit
    signal3: Bit
    me: Bit
    time: UInt  # periods


class DynamicTest(Surroundings, tick_s=step_s):
    """Dynamic error: the equipment at a rising speed with the measuring circuit; `reset` is the key R."""

    circuit: Circuit
    measuring: Measuring

    def step(self, speed: Speed, lines: Lines, reset: Bit) -> tuple[DynamicTest, Measured]:
        """One period."""
        outside, edge, pulses, preset = self.arriving(speed, lines, self.circuit.counter1.n1f)
        circuit, command = self.circuit.step(edge, pulses, preset)
        measuring, time = self.measuring.step(command.signal3, command.ff7, reset)
        following = type(self)(**outside, circuit=circuit, measuring=measuring)
        return following, Measured(command.brake, command.signal1, command.signal3, measuring.on, time)


Frequency = Annotated[Int, (0, 8 * 400 * KMH)]
TestPhase = Annotated[Int, (0, 2**22 - 1)]
TestSpacing = Annotated[UInt, 22]


class TestOscillator(Model, tick_s=step_s):
    """Oscillator of eight times the frequency of the speed generator."""

    __test__ = False  # for pytest, which takes classes so named for tests
    phase: TestPhase = power_up(ANY)

    def step(self, frequency: Frequency, spacing: TestSpacing) -> tuple[TestOscillator, U3]:
        """Its pulses in one step, thousandths of a pulse per Tc."""
        assume("phase within one pulse", self.phase < spacing)
        turned, pulses = self.phase + frequency, word(0, 3)
        for _ in range(4):
            full = turned >= spacing
            turned, pulses = select(full, turned - spacing, turned), (pulses + full.word()).low(3)
        return type(self)(phase=turned.clip(0, 2**22 - 1)), pulses


class DivideByEight(Model, tick_s=step_s):
    """Three binary stages; the last one is the speed signal, an edge for four pulses."""

    n: U3 = power_up(ANY)

    def step(self, pulses: U3) -> tuple[DivideByEight, Bit]:
        """Count; an edge when the last stage changes."""
        n = (self.n + pulses).low(3)
        return type(self)(n=n), n.bit(2) ^ self.n.bit(2)


class Static(NamedTuple):
    """What is read in the static test."""

    brake: Bit
    signal1: Bit


class StaticTest(Model, tick_s=step_s):
    """Static error: at which oscillator frequency does the brake signal appear?"""

    test_oscillator: TestOscillator
    divider: DivideByEight
    oscillator: Oscillator
    selection: Selection
    circuit: Circuit

    def step(self, frequency: Frequency, lines: Lines) -> tuple[StaticTest, Static]:
        """One period."""
        n1f, error = self.circuit.counter1.n1f, self.oscillator.error
        spacing = (n1f * 2 * TURN * (error + 1_000_000).sat(21) // 1_000_000).low(22)
        test_oscillator, generated = self.test_oscillator.step(frequency, spacing)
        divider, edge = self.divider.step(generated)
        oscillator, pulses = self.oscillator.step()
        selection, preset = self.selection.step(lines)
        circuit, command = self.circuit.step(edge, pulses, preset)
        following = type(self)(
            test_oscillator=test_oscillator, divider=divider, oscillator=oscillator, selection=selection,
            circuit=circuit,
        )  # fmt: skip
        return following, Static(command.brake, command.signal1)
