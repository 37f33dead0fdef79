"""Two of the two-counter ATC side by side, for what is monotone: a slower and a faster train, a slow oscillator.

One step is one period of the standard oscillator, 155.8695 us; of `TwoOscillators` each gives a pulse in it or none, so
both may drift.
Source: comparison of two runs [D].
"""

from __future__ import annotations

from typing import NamedTuple

from models.two_counter import step_s
from models.two_counter.circuit import Circuit, Command
from models.two_counter.equipment import Equipment
from models.two_counter.selection import Lines, Stages
from models.two_counter.train import Speed
from safety import Bit, Model


class Two(NamedTuple):
    """What both command."""

    a: Command
    b: Command


class TwoTrains(Model, tick_s=step_s):
    """Two trains with one check speed selected, their oscillators in step."""

    first: Equipment
    second: Equipment

    def step(self, speed_a: Speed, speed_b: Speed, lines: Lines) -> tuple[TwoTrains, Two]:
        """One period of both."""
        first, a = self.first.step(speed_a, lines)
        second, b = self.second.step(speed_b, lines)
        return type(self)(first=first, second=second), Two(a, b)


class TwoOscillators(Model, tick_s=step_s):
    """One train, two circuits, each with an oscillator of its own."""

    first: Circuit
    second: Circuit

    def step(self, edge: Bit, pulse_a: Bit, pulse_b: Bit, preset: Stages) -> tuple[TwoOscillators, Two]:
        """One period: an edge for both or none, then a pulse from each or none."""
        first, a = self.first.step(edge, pulse_a.word().int(), preset)
        second, b = self.second.step(edge, pulse_b.word().int(), preset)
        return type(self)(first=first, second=second), Two(a, b)
