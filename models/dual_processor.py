"""Two processors in lock-step on one clock, their buses compared in each bus cycle, on the task of ATS-SP supervision.

    line data --> processor A  =  comparator  =  processor B --> output unit --> brake relay (energised: run)
                                      |  alternating signal              ^
                                      +----------------------------------+

One step is one bus cycle.  The same program of four bus cycles runs in both: read the balise, read the line data, read
the odometer, compare speed and distance and write the command.  The comparator compares address, data and control of
both buses and, as the specification models it, the stored state.  While all agree it turns its output over in each
cycle; the relay is fed only by these changes, so that a comparator that stands still at either level brakes.  The
first mismatch stops processors and comparator for good.  Distances are in units of s^2/(2 b), with s the unit of speed:
speed may be kept while speed^2 <= distance left.

`truth` is a third processor, part of no equipment: it reads what is so, and no fault reaches it.
Source: two 8-bit processors in lock-step, comparison of addresses, data and control, mismatch brakes [P]; alternating
signal, B drives the output unit (as the blocks are drawn), program, widths, 1 us a bus cycle, check word [A].
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import xor
from typing import Annotated, NamedTuple

from safety import U2, U4, U8, Bit, Model, UInt, all_of, bit, point, power_up, select

SWEEP = 4  # bus cycles of the program; its place is the address on the bus
U13 = Annotated[UInt, 13]
BUS_CYCLE = "1e-6"  # s
POLYNOMIAL, DATA_BITS, CHECK_BITS = 0b10011, 8, 4  # x^4 + x + 1 is primitive: two wrong bits within 15 are found


class Reading(NamedTuple):
    """What the processors are given."""

    balise: Bit  # a signal balise is passed over
    stop: Bit  # it shows stop
    distance: U8  # line data: from this balise to its signal
    run: U2  # odometer: units run since the last sweep
    speed: U4


class Words(NamedTuple):
    """What a processor shows in one bus cycle: its bus, and what it has stored at the end."""

    address: U2
    data: U8
    write: Bit  # control: write, else read
    stored: U13


BUS = 3  # the words of the bus come first


class Processor(Model, tick_s=BUS_CYCLE):
    """One processor: registers and bus.  At power-up it knows of no distance, so that it permits standing only."""

    place: U2 = power_up(0)
    told: Bit = power_up(False)  # a balise at stop was read in this sweep
    active: Bit = power_up(True)
    left: U8 = power_up(0)  # to the signal, while active
    permit: Bit = power_up(False)  # the command last written

    def step(self, reading: Reading, usable: Bit, runs: Bit) -> tuple[Processor, Words]:
        """One bus cycle, if the clock runs; line data that are not usable count as a distance of 0."""
        at_balise, at_line, at_odometer, at_write = (self.place == k for k in range(SWEEP))
        told = select(at_balise, reading.balise & reading.stop, self.told)
        cleared = at_balise & reading.balise & ~reading.stop
        active = (self.active | (at_line & self.told)) & ~cleared
        advanced = select(at_odometer, self.left.sat_sub(reading.run), self.left)
        left = select(at_line & self.told, select(usable, reading.distance, 0), advanced)
        fits = ~self.active | (reading.speed * reading.speed <= self.left)
        permit = select(at_write, fits, self.permit)
        computed = {"place": (self.place + 1).low(2), "told": told, "active": active, "left": left, "permit": permit}
        kept = {name: select(runs, value, getattr(self, name)) for name, value in computed.items()}
        following = type(self)(**{name: point(name, value) for name, value in kept.items()})
        read = select(at_balise, told.word().widen(8), select(at_odometer, advanced, left))
        data = point("data", select(at_write, fits.word().widen(8), read))
        return following, Words(point("address", self.place), data, point("write", at_write), following.stored())

    def stored(self) -> UInt:
        """All registers in one word."""
        flags = self.told.word().concat(self.active.word()).concat(self.permit.word())
        return self.place.concat(self.left).concat(flags)


class Comparator(Model, tick_s=BUS_CYCLE):
    """Turns its output over in each bus cycle in which all was equal; the first mismatch stops it for good."""

    stopped: Bit = power_up(False)
    level: Bit = power_up(False)

    def step(self, a: Words, b: Words, clock: Bit) -> tuple[Comparator, Bit]:
        """Compare one cycle; the output is the level before it."""
        pairs = zip(self.compared(a), self.compared(b), strict=True)
        equal = point("equal", all_of(*(x == y for x, y in pairs)))
        stopped = self.stopped | (clock & ~equal)
        level = self.level_after(clock, stopped)
        return type(self)(stopped=stopped, level=level), point("signal", self.level)

    def compared(self, words: Words) -> Sequence[Bit | UInt]:
        """Every bit of the bus and of what is stored."""
        return words

    def level_after(self, clock: Bit, stopped: Bit) -> Bit:
        """Alternating: the output changes as long as it is clocked and not stopped."""
        return self.level ^ (clock & ~stopped)


class OutputUnit(Model, tick_s=BUS_CYCLE):
    """Holds the command last written and drives the brake relay, fed by the changes of the comparator's signal."""

    command: Bit = power_up(False)
    before: Bit = power_up(False)

    def step(self, data: U8, write: Bit, signal: Bit) -> tuple[OutputUnit, Bit]:
        """The relay in this cycle: by the command and the comparison of the cycles before; energised is run."""
        fed = self.alive(signal) & point("supply", bit(True))
        command = select(write, data.bit(0), self.command)
        return type(self)(command=command, before=signal), point("relay", fed & self.command)

    def alive(self, signal: Bit) -> Bit:
        """The signal has changed since the last cycle."""
        return signal ^ self.before


class DualProcessors(Model, tick_s=BUS_CYCLE):
    """Processors, comparator and output unit on one clock."""

    a: Processor
    b: Processor
    comparator: Comparator
    output: OutputUnit

    def step(self, reading: Reading, usable: Bit) -> tuple[DualProcessors, Bit]:
        """One bus cycle: the brake relay."""
        clock = point("clock", bit(True))
        runs = clock & ~self.comparator.stopped
        a, words_a = self.a.step(reading, usable, runs)
        b, words_b = self.b.step(reading, usable, runs)
        comparator, signal = self.comparator.step(words_a, words_b, clock)
        output, relay = self.output.step(words_b.data, words_b.write, signal)
        return type(self)(a=a, b=b, comparator=comparator, output=output), relay


# --- line data --------------------------------------------------------------------------------------------------------


def remainder(power: int) -> int:
    """x^power modulo the polynomial over GF(2)."""
    value = 1
    for _ in range(power):
        value <<= 1
        value ^= POLYNOMIAL if value >> CHECK_BITS else 0
    return value


def check_bits(data: UInt) -> list[Bit]:
    """The four check bits of a word of eight, the lowest first."""
    weights = [remainder(CHECK_BITS + k) for k in range(DATA_BITS)]
    return [reduce(xor, (data.bit(k) for k in range(DATA_BITS) if weights[k] >> j & 1)) for j in range(CHECK_BITS)]


class Entry(NamedTuple):
    """A distance as it is read, and whether the processors may use it."""

    distance: U8
    usable: Bit


class Store(Model, tick_s=BUS_CYCLE):
    """Line data in a ROM or on a card: words with check bits."""

    def step(self, distance: U8) -> tuple[Store, Entry]:
        """Read the entry of a balise whose true distance is given; `entry` is what was written into the store."""
        entry = point("entry", distance)
        stored = point("word", entry)
        checks = [point(f"check{j}", c) for j, c in enumerate(check_bits(entry))]
        good = all_of(*(x == y for x, y in zip(check_bits(stored), checks, strict=True)))
        return type(self)(), Entry(stored, good)


class OneSource(Model, tick_s=BUS_CYCLE):
    """Line data from the ROM alone."""

    rom: Store

    def step(self, distance: U8) -> tuple[OneSource, Entry]:
        """What both processors read."""
        rom, entry = self.rom.step(distance)
        return type(self)(rom=rom), entry


class TwoSources(Model, tick_s=BUS_CYCLE):
    """Line data that stand in the ROM and, written independently, on the card; both have to be good and equal."""

    rom: Store
    card: Store

    def step(self, distance: U8) -> tuple[TwoSources, Entry]:
        """What both processors read."""
        rom, one = self.rom.step(distance)
        card, other = self.card.step(distance)
        usable = one.usable & other.usable & (one.distance == other.distance)
        return type(self)(rom=rom, card=card), Entry(one.distance, usable)


# --- on board ---------------------------------------------------------------------------------------------------------


class Output(NamedTuple):
    """Brake relay de-energised, and what would be right."""

    brake: Bit
    safe: Bit  # the command that follows from what is so


class OnBoard(Model, tick_s=BUS_CYCLE):
    """Line data, the two processors, and the truth beside them."""

    line: OneSource
    dual: DualProcessors
    truth: Processor

    def step(self, reading: Reading) -> tuple[OnBoard, Output]:
        """One bus cycle."""
        line, entry = self.line.step(reading.distance)
        dual, relay = self.dual.step(reading._replace(distance=entry.distance), entry.usable)
        truth, _ = self.truth.step(reading, bit(True), bit(True))
        return type(self)(line=line, dual=dual, truth=truth), Output(brake=~relay, safe=self.truth.permit)


class TwoSourceOnBoard(OnBoard, tick_s=BUS_CYCLE):
    """With two sources of line data."""

    line: TwoSources


# --- variants to be refuted -------------------------------------------------------------------------------------------


class BusComparator(Comparator, tick_s=BUS_CYCLE):
    """Compares the buses alone, as two real processors show no more: a wrong register is found when it is used."""

    def compared(self, words: Words) -> Sequence[Bit | UInt]:
        """Every bit of the bus."""
        return words[:BUS]


class StaticComparator(Comparator, tick_s=BUS_CYCLE):
    """Says equal by a steady level."""

    level: Bit = power_up(True)

    def level_after(self, clock: Bit, stopped: Bit) -> Bit:
        """High until the first mismatch that is clocked."""
        return ~stopped


class StaticOutputUnit(OutputUnit, tick_s=BUS_CYCLE):
    """Fed by the level itself."""

    def alive(self, signal: Bit) -> Bit:
        """The level is high."""
        return signal


class BusDual(DualProcessors, tick_s=BUS_CYCLE):
    """Compared by buses alone."""

    comparator: BusComparator


class StaticDual(DualProcessors, tick_s=BUS_CYCLE):
    """With a steady signal."""

    comparator: StaticComparator
    output: StaticOutputUnit


class BusCompared(OnBoard, tick_s=BUS_CYCLE):
    """On board, compared by buses alone."""

    dual: BusDual


class StaticSignal(OnBoard, tick_s=BUS_CYCLE):
    """On board, with a steady signal of the comparator."""

    dual: StaticDual
