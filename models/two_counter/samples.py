"""The sample equation of the two-counter ATC as an ideal machine: no counters of eleven stages, no flip-flops.

One step is one period of the standard oscillator, 155.8695 us.  A window of m edges holds n1 = floor(phase + f1*W)
pulses; one pulse of the generator after its end: brake unless n1 has come up to n1F; the next window opens three later.
Source: eq. (3), (4) with the floor [D]; eq. (4) as printed brakes for n1 <= n1F, the circuit of section 5 only below.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from models.two_counter import step_s
from models.two_counter.circuit import READ_OUT, START, Circuit, RequiredCount
from models.two_counter.equipment import Surroundings
from models.two_counter.selection import Lines, Stages
from models.two_counter.train import Speed
from safety import Bit, Int, power_up, select

READ_OUT_BEFORE = START - READ_OUT  # edges before a window opens: the read-out of the last one
Place = Annotated[Int, (-START, 2046)]
Count = Annotated[Int, (0, 2048)]


class Sampler(RequiredCount, tick_s=step_s):
    """Decides from counted edges and periods; a count that suffices goes no further."""

    place: Place = power_up(-START)  # edges since the window opened; below 0: until it opens
    n1: Count = power_up(0)
    braking: Bit = power_up(True)

    def step(self, edge: Bit, preset: Stages) -> tuple[Sampler, Bit]:
        """One period; the decision in force after it."""
        moved = self.place + edge.word()
        closes = edge & (moved >= preset.int())
        place = select(closes, -START, moved).clip(-START, 2046)
        read_out = edge & (place == -READ_OUT_BEFORE)
        braking = select(read_out, self.n1 < self.needed(), self.braking)
        kept = select(read_out, 0, self.n1)
        n1 = select((place >= 0) & (kept < self.needed()), kept + 1, kept).clip(0, 2048)
        return type(self)(place=place, n1=n1, braking=braking), braking

    def needed(self) -> Int:
        """The least count that releases."""
        return self.n1f.int()


class EquationFour(Sampler, tick_s=step_s):
    """Eq. (4) as printed: the brake comes for n1 <= n1F."""

    def needed(self) -> Int:
        """One more than the circuit needs."""
        return self.n1f.int() + 1


class Decision(NamedTuple):
    """What the ideal machine commands."""

    brake: Bit


class Samples(Surroundings, tick_s=step_s):
    """The ideal machine behind the axle of the train."""

    sampler: Sampler

    def step(self, speed: Speed, lines: Lines) -> tuple[Samples, Decision]:
        """One period."""
        outside, edge, _, preset = self.arriving(speed, lines, self.sampler.n1f)
        sampler, brake = self.sampler.step(edge, preset)
        return type(self)(**outside, sampler=sampler), Decision(brake)


class Both(NamedTuple):
    """Brake of the circuit and of eq. (4) as printed."""

    circuit_brakes: Bit
    equation_brakes: Bit
    signal1: Bit


class Compared(Surroundings, tick_s=step_s):
    """Circuit and eq. (4) as printed side by side on one train."""

    circuit: Circuit
    equation: EquationFour

    def step(self, speed: Speed, lines: Lines) -> tuple[Compared, Both]:
        """One period."""
        outside, edge, pulses, preset = self.arriving(speed, lines, self.circuit.counter1.n1f)
        circuit, command = self.circuit.step(edge, pulses, preset)
        equation, brake = self.equation.step(edge, preset)
        following = type(self)(**outside, circuit=circuit, equation=equation)
        return following, Both(command.brake, brake, command.signal1)
