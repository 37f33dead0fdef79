"""Variants of the two-counter ATC: readings of the paper to be refuted, open points, and an extension.

One step is one period of the standard oscillator, 155.8695 us.  Each variant is the reference with one method changed,
or one part more.  None of them changes what a healthy equipment does, but the two literal readings.
Source: literal readings of section 5 [P]; equality decoder, nothing decoded without selection, level on the reset line,
watchdog [A].
"""

from __future__ import annotations

from models.two_counter import step_s
from models.two_counter.circuit import Circuit, Command, Counter2
from models.two_counter.equipment import Equipment
from models.two_counter.selection import Lines, Selection
from models.two_counter.train import Speed
from safety import U16, Bit, Model, UInt, bit, parameter, point, power_up, select, word


class EqualityCounter2(Counter2, tick_s=step_s):
    """Counter 2 with a decoder that sees the preset only while it stands there."""

    def reached(self, counted: UInt, preset: UInt) -> Bit:
        """The preset is there now."""
        return counted == preset


class EqualityCircuit(Circuit, tick_s=step_s):
    """The circuit with the equality decoder."""

    counter2: EqualityCounter2


class EqualityDecoder(Equipment, tick_s=step_s):
    """A lower preset selected when it has been passed: counter 2 runs on to its capacity, the command is held."""

    circuit: EqualityCircuit


class NoDefaultSelection(Selection, tick_s=step_s):
    """Selection without a default: no line, no preset."""

    def none_selected(self) -> UInt:
        """0 stands for none."""
        return word(0, 11)


class NoDefaultCounter2(Counter2, tick_s=step_s):
    """Counter 2 that counts on while nothing is decoded."""

    def reached(self, counted: UInt, preset: UInt) -> Bit:
        """Reached or passed, where there is a preset."""
        return (preset != 0) & (counted >= preset)


class NoDefaultCircuit(Circuit, tick_s=step_s):
    """The circuit in which nothing may be decoded."""

    counter2: NoDefaultCounter2


class NoDefault(Equipment, tick_s=step_s):
    """No check speed selected: no read-out, the command is held."""

    selection: NoDefaultSelection
    circuit: NoDefaultCircuit


class SignalTwoSetsCircuit(Circuit, tick_s=step_s):
    """FF6 is set by signal 2, and never reset."""

    def of_ff6(self, enough: Bit, signal2: Bit) -> tuple[Bit, Bit]:
        """Both set."""
        return enough | signal2, bit(False)


class SignalTwoSets(Equipment, tick_s=step_s):
    """Literal reading L1, to be refuted: for overspeed "FF6 remains set by signal 2"; AND3 is always open."""

    circuit: SignalTwoSetsCircuit


class SignalOneResetsCircuit(Circuit, tick_s=step_s):
    """AND2 drives the reset input of FF2 as well."""

    def of_ff2(self, and2: Bit, and3: Bit) -> tuple[Bit, Bit]:
        """Both reset."""
        return bit(False), and2 | and3


class SignalOneResets(Equipment, tick_s=step_s):
    """Literal reading L2, to be refuted: for overspeed "AND2 opens, FF2 is reset by signal 1"."""

    circuit: SignalOneResetsCircuit


class LevelResetCircuit(Circuit, tick_s=step_s):
    """AND2 and AND3 strobe within, so that a stuck output is a level on the line behind it."""

    def strobed(self, name: str, opened: Bit, read_out: Bit) -> Bit:
        """The gate fails behind its strobe."""
        return point(name, opened & read_out)


class LevelReset(Equipment, tick_s=step_s):
    """AND3 stuck at 1 holds the reset line of FF2 between the strobes: each brake ends a step after its read-out."""

    circuit: LevelResetCircuit


class Watchdog(Model, tick_s=step_s):
    """Timer that read-outs restart; its contact lies in series with that of Ry-1."""

    idle: U16 = power_up(0)  # periods since the last read-out
    patience: U16 = parameter(
        12831,
        unit="period",
        within=(2400, 65_000),
        source="[A] T_w = 2 s; a train below (n2E + 4)/T_w is braked",
    )

    def step(self, signal1: Bit) -> tuple[Watchdog, Bit]:
        """Whether it brakes."""
        idle = point("idle", select(point("restart", signal1), 0, (self.idle + 1).sat(16)))
        return type(self)(idle=idle), point("late", idle > self.patience)


class Watched(Equipment, tick_s=step_s):
    """The equipment with a watchdog [A]: without a read-out for T_w it brakes until one comes."""

    watchdog: Watchdog

    def step(self, speed: Speed, lines: Lines) -> tuple[Watched, Command]:
        """One period."""
        outside, edge, pulses, preset = self.arriving(speed, lines, self.circuit.counter1.n1f)
        circuit, command = self.circuit.step(edge, pulses, preset)
        watchdog, late = self.watchdog.step(command.signal1)
        following = type(self)(**outside, circuit=circuit, watchdog=watchdog)
        return following, command._replace(brake=command.brake | late)
