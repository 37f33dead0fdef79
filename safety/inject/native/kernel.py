"""The native functions of one step: with faults, without, and what a run needs around them.

All lanes read the same row of the fault-free run, which has the inputs of the step, and the registers before it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

from safety.inject.kernel import live_states
from safety.inject.native.layout import LINE, Block, Row
from safety.inject.native.routine import Routine
from safety.inject.native.tapped import Tapped
from safety.system import State, System
from safety.terms.column_native import bit_type, lane_vector
from safety.terms.graph import BIT, Term, variable, variables
from safety.terms.llvm import Target
from safety.terms.native import bytes_of
from safety.terms.native_bits import slices_pay

if TYPE_CHECKING:
    import numpy.typing as npt

    Array = npt.NDArray[Any]

STEP = ("ptr noalias %before", "ptr noalias %after", "ptr noalias %row", "ptr noalias %seen")
UNUSED = variable("unused", BIT)  # a place among the taps for what a switch has no use for


@dataclass(frozen=True)
class Kernel:
    """A step of a system that observes wires, with faults.

    Of the observed `wires`, the first `watched` are for their first true frame, those at `counted` to be counted;
    `recorded` are registers that matter besides.
    """

    tapped: Tapped
    wires: Sequence[str]
    watched: int
    counted: Sequence[int]
    target: Target
    recorded: Sequence[str] = ()

    @cached_property
    def registers(self) -> tuple[State, ...]:
        """The registers that what is observed, or an assumption, depends on at some time."""
        return tuple(live_states(self.tapped.system.states, variables(self._observed)))

    @property
    def _observed(self) -> list[Term]:
        system = self.tapped.system
        return [system.lookup(name) for name in (*self.wires, *self.recorded)] + [*system.assumptions.values()]

    @cached_property
    def state(self) -> Block:
        """The lanes of the registers."""
        return Block([s.var for s in self.registers], self.target)

    @cached_property
    def taps(self) -> Block:
        """The lanes of what faults set."""
        return Block([*self.tapped.taps, UNUSED], self.target)

    @cached_property
    def row(self) -> Row:
        """The fault-free run as this kernel reads it."""
        return Row(
            [*(s.var for s in self.registers), *self.inputs.values()],
            self.watched,
            len(self.wires),
            self.recorded_words,
        )

    @property
    def slices_pay(self) -> bool:
        """Whether the gates of a step are cheaper for each lane than its instructions on words."""
        following = [self.tapped.system.state[s.path].next for s in self.registers]
        wires = [self.tapped.system.lookup(wire) for wire in self.wires]
        return slices_pay([*following, *wires], [s.var for s in self.registers])

    @property
    def recorded_words(self) -> int:
        """Words of a record in a row, where the functions here read and write one instead of the registers."""
        return 0

    @property
    def word(self) -> int:
        """Bytes of an observed wire of all lanes."""
        return max(self.target.lanes // 8, 8)

    @cached_property
    def flags(self) -> Mapping[str, int]:
        """Where, among the taps, it stands whether a point has a fault in some lane; the last is for no point."""
        return {point: self.taps.size + i for i, point in enumerate([*self.tapped.masks, ""])}

    @property
    def taps_size(self) -> int:
        """Bytes of the taps with the flags, in whole lines."""
        return -(-(self.taps.size + len(self.flags)) // LINE) * LINE

    @cached_property
    def inputs(self) -> Mapping[str, Term]:
        """The inputs that these registers, what is observed or an assumption depend on."""
        read = {v.uid for v in variables([*self._observed, *(s.next for s in self.registers)])}
        return {name: term for name, term in self.tapped.system.inputs.items() if term.uid in read}

    # --- functions -------------------------------------------------------------------------------------------------

    def faulty(self) -> Routine:
        """`faulty(before, after, row, seen, taps)`: a step with faults."""
        k = Routine(self.target, "faulty", [*STEP, "ptr noalias %taps"])
        for term in self.tapped.taps:
            k.bound[term.uid] = partial(k.load_lanes, term, "%taps", self.taps.offsets[term.uid])
        return self._step(k, self.tapped.system)

    def healthy(self) -> Routine:
        """`healthy(before, after, row, seen)`: a step without faults."""
        return self._step(Routine(self.target, "healthy", STEP), self.tapped.without_faults())

    def _step(self, k: Routine, system: System) -> Routine:
        for s in self.registers:
            k.bound[s.var.uid] = partial(k.load_lanes, s.var, "%before", self.state.offsets[s.var.uid])
        for term in self.inputs.values():
            k.bound[term.uid] = partial(k.load_spread, term, "%row", self.row.places[term.uid])
        for s in self.registers:
            following = system.state[s.path].next
            k.write([following])
            k.store_lanes(s.var, k.of(following), "%after", self.state.offsets[s.var.uid])
        for i, wire in enumerate(self.wires):
            k.write([system.lookup(wire)])
            k.store(f"i{k.lanes}", k.as_number(k.of(system.lookup(wire))), "%seen", i * self.word)
        return k

    def restore(self) -> Routine:
        """`restore(state, row)`: every lane as the fault-free run is."""
        k = Routine(self.target, "restore", ["ptr noalias %state", "ptr noalias %row"])
        for s in self.registers:
            k.store_lanes(s.var, self._golden(k, s), "%state", self.state.offsets[s.var.uid])
        return k

    def diverged(self) -> Routine:
        """`diverged(state, row)`: the lanes that are not as the fault-free run is."""
        k = Routine(self.target, "diverged", ["ptr noalias %state", "ptr noalias %row"], Routine.number_of(self.target))
        apart: dict[str, str] = {}  # what differs, collected by type
        for s in self.registers:
            kind = lane_vector(k, s.var)
            now = k.load_lanes(s.var, "%state", self.state.offsets[s.var.uid])
            other = k.op(f"xor {kind} {now}, {self._golden(k, s)}")
            apart[kind] = k.op(f"or {kind} {apart[kind]}, {other}") if kind in apart else other
        total, whole = "0", k.number
        for kind, other in apart.items():
            if kind == bit_type(k):
                lanes = k.as_number(other)
            else:
                lanes = k.op(f"bitcast <{k.lanes} x i1> {k.op(f'icmp ne {kind} {other}, zeroinitializer')} to {whole}")
            total = k.op(f"or {whole} {total}, {lanes}")
        k.lines.append(f"ret {whole} {total}")
        return k

    def _golden(self, k: Routine, s: State) -> str:
        return k.load_spread(s.var, "%row", self.row.places[s.var.uid])

    # --- the registers of one lane as a record, in words of 64 bits ---------------------------------------------------

    @cached_property
    def kept(self) -> Row:
        """What stands where in a record."""
        return Row([s.var for s in self.registers], 0, 0)

    @property
    def words(self) -> int:
        """Words of a record."""
        return int(self.kept.type.itemsize) // 8

    def to_record(self, values: Sequence[int]) -> Array:
        """A record of values of the registers, in their order."""
        import numpy as np

        record = np.zeros(1, self.kept.type)
        for i, (s, value) in enumerate(zip(self.registers, values, strict=True)):
            bytes_ = s.var.sort == BIT and not self.target.packed
            record[f"v{i}"] = value * (255 if bytes_ else 1)
        return record.view(np.uint64)

    def from_records(self, records: Array, register: int) -> Array:
        """What a register, by its number, holds in each record."""
        import numpy as np

        held: Array = np.ascontiguousarray(records).view(self.kept.type)[:, 0][f"v{register}"]
        return held

    def give(self) -> Routine:
        """`give(state, lane, record)`: a lane as a record."""
        return self._of_lane("give")

    def take(self) -> Routine:
        """`take(state, lane, record)`: a lane from its record."""
        return self._of_lane("take")

    def _of_lane(self, name: str) -> Routine:
        k = Routine(self.target, name, ["ptr noalias %state", "i64 %lane", "ptr noalias %record"])
        for s in self.registers:
            place, kind = k.at("%state", self.state.offsets[s.var.uid]), f"i{8 * bytes_of(s.var)}"
            inside = self.kept.places[s.var.uid]
            if s.var.sort == BIT and k.packed:
                self._packed_lane(k, name, place, "%lane", k.at("%record", inside))
            elif name == "give":
                k.store(kind, k.load(kind, k.element(place, kind, "%lane")), "%record", inside)
            else:
                k.store(kind, k.load(kind, "%record", inside), k.element(place, kind, "%lane"))
        return k

    def _packed_lane(self, k: Routine, name: str, place: str, lane: str, record: str) -> None:
        """A bit of a whole number, as a byte in a record."""
        kind = f"i{k.lanes}"
        shift = lane if kind == "i64" else k.op(f"trunc i64 {lane} to {kind}")
        word = k.load(kind, place)
        if name == "give":
            moved = k.op(f"lshr {kind} {word}, {shift}")
            k.store("i8", k.op(f"and i8 {k.op(f'trunc {kind} {moved} to i8')}, 1"), record)
        else:
            own = k.op(f"shl {kind} 1, {shift}")
            others = k.op(f"and {kind} {word}, {k.op(f'xor {kind} {own}, -1')}")
            bit = k.load("i8", record)
            bit = k.op(f"shl {kind} {k.op(f'zext i8 {bit} to {kind}')}, {shift}")
            k.store(kind, k.op(f"or {kind} {others}, {bit}"), place)

    def steps(self) -> list[Routine]:
        """The functions of a step, with faults and without."""
        return [self.faulty(), self.healthy()]

    def healthy_step(self, k: Routine, given: Sequence[str], taps: str) -> None:
        """Write a step in which no fault acts; `given` are its first arguments."""
        k.run("@healthy", *given)

    def clear(self, k: Routine, taps: str) -> None:
        """Write what is done when no fault acts any more."""

    def take_lanes(self, k: Routine, state: str, records: str) -> None:
        """Write what takes each lane of a group from its record."""
        with k.each(0, k.lanes) as lane:
            k.run("@take", f"ptr {state}", f"i64 {lane}", f"ptr {self._record_of(k, records, lane)}")

    def give_lanes(self, k: Routine, state: str, records: str, lanes: str) -> None:
        """Write what gives some lanes of a group, at least, as records."""
        with k.each_bit(lanes) as lane:
            k.run("@give", f"ptr {state}", f"i64 {lane}", f"ptr {self._record_of(k, records, lane)}")

    def _record_of(self, k: Routine, records: str, lane: str) -> str:
        return k.at(records, k.op(f"mul i64 {lane}, {8 * self.words}"))

    def helpers(self) -> list[Routine]:
        """Functions that these call."""
        return []

    def record(self) -> Routine:
        """`record(state, row)`: the first lane as the fault-free run."""
        k = Routine(self.target, "record", ["ptr noalias %state", "ptr noalias %row"])
        for s in self.registers:
            offset, kind = self.state.offsets[s.var.uid], f"i{8 * bytes_of(s.var)}"
            value = k.load(kind, "%state", offset)  # the lowest bit is the first lane's, packed or not
            if s.var.sort == BIT:
                value = k.op(f"and i8 {value}, 1")
            k.store(kind, value, "%row", self.row.places[s.var.uid])
        return k
