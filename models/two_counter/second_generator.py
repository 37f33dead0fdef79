"""Two-counter ATC with a second speed generator on another axle [A]: what it would buy.

A comparison counts the edges of both generators against each other, anew after each read-out; where they differ by more
than `tolerance` edges it brakes, until power is switched off.  At standstill both are silent, so nothing is braked
needlessly, which a watchdog cannot say.
One step is one period of the standard oscillator.  Source: no second generator is published; all of this [A].
"""

from __future__ import annotations

from typing import Annotated

from models.two_counter import step_s
from models.two_counter.circuit import Command
from models.two_counter.equipment import Equipment
from models.two_counter.selection import Lines
from models.two_counter.train import Speed, Train
from safety import U5, Bit, Int, Model, parameter, point, power_up, select

Difference = Annotated[Int, (-31, 31)]


class Comparison(Model, tick_s=step_s):
    """Edges of the first generator less those of the second, since the last read-out; latched when out of tolerance."""

    difference: Difference = power_up(0)
    differs: Bit = power_up(False)
    tolerance: U5 = parameter(8, unit="edge", within=(2, 30), source="[A] 0.8 % of a period at 250 km/h")

    def step(self, first: Bit, second: Bit, read_out: Bit) -> tuple[Comparison, Bit]:
        """Count, judge, begin anew."""
        now = (self.difference + first.word() - second.word()).clip(-31, 31)
        differs = point("differs", self.differs | (now > self.tolerance) | (now < -self.tolerance.int()))
        return type(self)(difference=select(read_out, 0, now).clip(-31, 31), differs=differs), differs


class SecondGenerator(Equipment, tick_s=step_s):
    """The equipment, a second generator with a wheel of its own, and the comparison of both."""

    second: Train
    comparison: Comparison

    def step(self, speed: Speed, lines: Lines) -> tuple[SecondGenerator, Command]:
        """One period."""
        n1f, error = self.circuit.counter1.n1f, self.oscillator.error
        outside, edge, pulses, preset = self.arriving(speed, lines, n1f)
        second, other = self.second.step(speed, self.second.spacing(n1f, error))
        circuit, command = self.circuit.step(edge, pulses, preset)
        comparison, differs = self.comparison.step(edge, other, command.signal1)
        following = type(self)(**outside, circuit=circuit, second=second, comparison=comparison)
        return following, command._replace(brake=command.brake | differs)
