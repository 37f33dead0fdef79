r"""The two-counter ATC on the train: axle, standard oscillator, check-speed selection, circuit.

One step is one period of the standard oscillator, 155.8695 us; a sampling period at 250 km/h is about 2015 of them.
Source: figure 6 [P]; see the parts.

250 km/h selected, its f2E is a speed of 517500; 1 km/h above it, and the same with an oscillator 1 % fast:

    rightside run two_counter.equipment.Equipment speed=519500 "lines.*=0" lines.s250=1 --steps 9000 \
        --show "brake,signal?,gate" --set error=10000
"""

from __future__ import annotations

from typing import Any

from models.two_counter import step_s
from models.two_counter.circuit import Circuit, Command
from models.two_counter.selection import Lines, Selection
from models.two_counter.train import Oscillator, Speed, Train
from safety import Bit, Int, Model, UInt


class Surroundings(Model):
    """What stands before the circuit: train, standard oscillator, check-speed selection."""

    train: Train
    oscillator: Oscillator
    selection: Selection

    def arriving(self, speed: Speed, lines: Lines, n1f: UInt) -> tuple[dict[str, Any], Bit, Int, UInt]:
        """One period of the three parts, and what they deliver: edge, oscillator pulses, preset."""
        train, edge = self.train.step(speed, self.train.spacing(n1f, self.oscillator.error))
        oscillator, pulses = self.oscillator.step()
        selection, preset = self.selection.step(lines)
        return {"train": train, "oscillator": oscillator, "selection": selection}, edge, pulses, preset


class Equipment(Surroundings, tick_s=step_s):
    """Two-counter ATC behind the axle of the train; `brake` true = brake."""

    circuit: Circuit

    def step(self, speed: Speed, lines: Lines) -> tuple[Equipment, Command]:
        """One period at a true speed with the selected check speed."""
        outside, edge, pulses, preset = self.arriving(speed, lines, self.circuit.counter1.n1f)
        circuit, command = self.circuit.step(edge, pulses, preset)
        return type(self)(**outside, circuit=circuit), command
