"""The native functions of a step where a word is its bits, and a bit of all lanes a vector: planes.

Gates are then instructions on whole vectors, with eight times as many lanes as there are bytes in one.  A point looks
at its masks only where the group has a fault there (`at`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

from safety.inject.native.kernel import STEP, Kernel
from safety.inject.native.routine import Routine
from safety.system import State, System
from safety.terms.column_bits import size_of
from safety.terms.column_native import bit_type, splat
from safety.terms.graph import Term
from safety.terms.native import bytes_of
from safety.terms.native_bits import Gates
from safety.terms.slicing import Slices, leaves

if TYPE_CHECKING:
    import numpy.typing as npt

    Array = npt.NDArray[Any]


class Planes(Kernel):
    """A kernel of planes; see `kernel.Kernel`."""

    @cached_property
    def plane(self) -> int:
        """Bytes of a bit of all lanes."""
        return self.target.lanes // 8

    @cached_property
    def _passing(self) -> System:
        return self.tapped.passing()

    def faulty(self) -> Routine:
        """`faulty(before, after, row, seen, taps)`: a step with faults."""
        k = Routine(self.target, "faulty", [*STEP, "ptr noalias %taps"])
        for switch in self.tapped.switches:
            (bit,) = leaves(switch)
            k.bound[bit.uid] = partial(k.load_lanes, bit, "%taps", self.taps.offsets[switch.uid])
        slices = Slices(cut=lambda point: point.attr in self.tapped.masks)
        return self._planes(k, self.tapped.passing(), slices)

    def _planes(self, k: Routine, system: System, slices: Slices) -> Routine:
        follow = [(s, slices.of(system.state[s.path].next)) for s in self.registers]
        seen = [slices.of(system.lookup(wire))[0] for wire in self.wires]
        gates = Gates(k, slices, [*(bit for _, bits in follow for bit in bits), *seen], partial(self._masked, k))
        for s in self.registers:
            for i, bit in enumerate(leaves(s.var)):
                k.bound[bit.uid] = partial(k.load_lanes, bit, "%before", self._place(s, i))
        for term in self.inputs.values():
            for i, bit in enumerate(leaves(term)):
                k.bound[bit.uid] = partial(self._spread_bit, k, term, i)
        for s, bits in follow:
            for i, bit in enumerate(bits):
                k.store_lanes(bit, gates.of(bit), "%after", self._place(s, i))
        for i, bit in enumerate(seen):
            k.store_lanes(bit, gates.of(bit), "%seen", i * self.plane)
        k.attributes = ' "ready"'
        return k

    def _place(self, s: State, i: int) -> int:
        """The byte of a bit of a register."""
        return self.state.offsets[s.var.uid] + i * self.plane

    def _masked(self, k: Routine, point: Term, healthy: Sequence[str]) -> list[str]:
        """The bits of a point, with its masks where the group has a fault there."""
        kind = bit_type(k)
        there = k.is_("ne", "i8", k.load("i8", "%taps", self.flags[point.attr]), 0)
        before, then, end = k.fork(there)
        seen = []
        for i, x in enumerate(healthy):
            keep, turn = (
                k.load(kind, "%taps", self.taps.offsets[mask.uid] + i * self.plane, align=8)
                for mask in self.tapped.masks[point.attr]
            )
            seen.append(k.op(f"xor {kind} {k.op(f'and {kind} {x}, {keep}')}, {turn}"))
        k.join(end)
        return [k.op(f"phi {kind} [ {x}, %{before} ], [ {y}, %{then} ]") for x, y in zip(healthy, seen, strict=True)]

    def _spread_bit(self, k: Routine, term: Term, i: int) -> str:
        """A bit of a number of the fault-free run, in every lane."""
        kind = f"i{8 * bytes_of(term)}"
        x = k.load(kind, "%row", self.row.places[term.uid])
        x = k.op(f"lshr {kind} {x}, {i}") if i else x
        bit = k.op(f"trunc {kind} {x} to i1")
        words = bit_type(k)
        first = k.op(f"insertelement {words} poison, i64 {k.op(f'sext i1 {bit} to i64')}, i64 0")
        return k.op(f"shufflevector {words} {first}, {words} poison, <{k.lanes // 64} x i32> zeroinitializer")

    # --- lanes and the fault-free run ------------------------------------------------------------------------------

    def restore(self) -> Routine:
        """`restore(state, row)`: every lane as the fault-free run is."""
        k = Routine(self.target, "restore", ["ptr noalias %state", "ptr noalias %row"])
        with self._each_plane(k) as (place, there):
            k.store(bit_type(k), there, place, align=8)
        return k

    def diverged(self) -> Routine:
        """`diverged(state, row)`: the lanes that are not as the fault-free run is."""
        k = Routine(self.target, "diverged", ["ptr noalias %state", "ptr noalias %row"], Routine.number_of(self.target))
        kind = bit_type(k)
        total = k.local(kind, "zeroinitializer")
        with self._each_plane(k) as (place, there):
            apart = k.op(f"xor {kind} {k.load(kind, place, align=8)}, {there}")
            total.set(k.op(f"or {kind} {total.value}, {apart}"))
        k.lines.append(f"ret {kind} {total.value}")
        return k

    @contextmanager
    def _each_plane(self, k: Routine) -> Iterator[tuple[str, str]]:
        """What is done for each plane: its place, and what the fault-free run has there."""
        kind, record = bit_type(k), k.at("%row", self.row.offset("record"))
        with k.each(0, self._planes_used) as i:
            word = k.load("i64", k.element(record, "i64", k.op(f"lshr i64 {i}, 6")))
            place = k.op(f"and i64 {i}, 63")
            bit = k.op(f"and i64 {k.op(f'lshr i64 {word}, {place}')}, 1")
            yield k.element("%state", kind, i), k.spread_over(k.lanes // 64, "i64", k.op(f"sub i64 0, {bit}"))

    @property
    def _planes_used(self) -> int:
        return sum(size_of(s.var.sort) for s in self.registers)

    def record(self) -> Routine:
        """`record(state, row)`: the first lane as the fault-free run, a bit for each plane."""
        k = Routine(self.target, "record", ["ptr noalias %state", "ptr noalias %row"])
        record = k.at("%row", self.row.offset("record"))
        with k.each(0, self.words) as word:
            total = k.local("i64", 0)
            total.set(0)
            with k.each(0, 64) as i:
                plane = k.op(f"add i64 {k.op(f'mul i64 {word}, 64')}, {i}")
                bit = k.op(f"and i64 {k.load('i64', k.element('%state', bit_type(k), plane))}, 1")
                total.set(k.op(f"or i64 {total.value}, {k.op(f'shl i64 {bit}, {i}')}"))
            k.store("i64", total.value, k.element(record, "i64", word))
        return k

    # --- records: a bit for each plane -----------------------------------------------------------------------------

    @property
    def recorded_words(self) -> int:
        """Words of a record in a row."""
        return self.words

    @property
    def words(self) -> int:
        """Words of a record."""
        return self.state.size // (64 * self.plane)

    def to_record(self, values: Sequence[int]) -> Array:
        """A record of values of the registers, in their order."""
        import numpy as np

        whole = 0
        for s, value in zip(self.registers, values, strict=True):
            whole |= (int(value) & (1 << size_of(s.var.sort)) - 1) << self.state.offsets[s.var.uid] // self.plane
        return np.frombuffer(whole.to_bytes(8 * self.words, "little"), np.uint64).copy()

    def from_records(self, records: Array, register: int) -> Array:
        """What a register, by its number, holds in each record."""
        import numpy as np

        s = self.registers[register]
        first, size = self.state.offsets[s.var.uid] // self.plane, size_of(s.var.sort)
        word, place = divmod(first, 64)
        found = records[:, word] >> np.uint64(place)
        if place + size > 64:
            found = found | records[:, word + 1] << np.uint64(64 - place)
        found = found & np.uint64((1 << size) - 1)
        if s.var.sort.bounds[0] >= 0:
            return found
        unused = np.uint64(64 - size)
        return (found << unused).view(np.int64) >> unused.astype(np.int64)

    def give(self) -> Routine:
        """`give(state, records)`: every lane as a record."""
        return self._squares("give")

    def take(self) -> Routine:
        """`take(state, records)`: every lane from its record."""
        return self._squares("take")

    def steps(self) -> list[Routine]:
        """The function of a step: one without faults would be as fast as that with no point flagged."""
        return [self.faulty()]

    def healthy_step(self, k: Routine, given: Sequence[str], taps: str) -> None:
        """Write a step in which no fault acts; `given` are its first arguments."""
        k.run("@faulty", *given, f"ptr {taps}")

    def clear(self, k: Routine, taps: str) -> None:
        """Write what is done when no fault acts any more: the masks let everything pass, no point is flagged."""
        k.intrinsics.add("declare void @llvm.memset.p0.i64(ptr, i8, i64, i1)")
        flags, size = k.at(taps, self.taps.size), self.taps_size - self.taps.size
        k.lines.append(f"call void @llvm.memset.p0.i64(ptr {flags}, i8 0, i64 {size}, i1 false)")

    def take_lanes(self, k: Routine, state: str, records: str) -> None:
        """Write what takes each lane of a group from its record."""
        k.run("@take", f"ptr {state}", f"ptr {records}")

    def give_lanes(self, k: Routine, state: str, records: str, lanes: str) -> None:
        """Write what gives the lanes of a group as records, all of them."""
        k.run("@give", f"ptr {state}", f"ptr {records}")

    def _squares(self, name: str) -> Routine:
        """64 planes and 64 lanes at a time."""
        k = Routine(self.target, name, ["ptr noalias %state", "ptr noalias %records"])
        with k.each(0, self.words) as word, k.each(0, k.lanes // 64) as group:
            planes = k.at("%state", k.op(f"mul i64 {word}, {64 * self.plane}"))
            planes = k.element(planes, "i64", group)
            lanes = k.at("%records", k.op(f"mul i64 {group}, {64 * 8 * self.words}"))
            lanes = k.element(lanes, "i64", word)
            ends = [(planes, self.plane), (lanes, 8 * self.words)]
            (source, step), (to, stride) = ends if name == "give" else ends[::-1]
            k.run("@transpose", f"ptr {source}", f"i64 {step}", f"ptr {to}", f"i64 {stride}")
        return k

    def helpers(self) -> list[Routine]:
        """`transpose(from, step, to, stride)`: a square of 64 words of 64 bits, so many bytes apart, on its side."""
        k = Routine(self.target, "transpose", ["ptr %from", "i64 %step", "ptr %to", "i64 %stride"])
        kind, square = "<64 x i64>", k.fresh()
        k.locals.append(f"{square} = alloca {kind}, align 64")
        with k.each(0, 64) as i:
            k.store("i64", k.load("i64", k.at("%from", k.op(f"mul i64 {i}, %step"))), k.element(square, "i64", i))
        x = k.load(kind, square)
        for by in (32, 16, 8, 4, 2, 1):  # the upper right quarter of each square changes places with the lower left
            low = sum(1 << i for i in range(64) if not i & by)
            order = ", ".join(f"i32 {i ^ by}" for i in range(64))
            other = k.op(f"shufflevector {kind} {x}, {kind} poison, <64 x i32> <{order}>")
            moved = [k.op(f"{how} {kind} {other}, {splat(64, by)}") for how in ("shl", "lshr")]
            upper = ", ".join(f"i1 {int(bool(i & by))}" for i in range(64))
            parts = []
            for mask, more in ((low, moved[0]), (~low, moved[1])):
                own, foreign = splat(64, mask), splat(64, ~mask)
                parts.append(
                    k.op(f"or {kind} {k.op(f'and {kind} {x}, {own}')}, {k.op(f'and {kind} {more}, {foreign}')}")
                )
            x = k.op(f"select <64 x i1> <{upper}>, {kind} {parts[1]}, {kind} {parts[0]}")
        k.store(kind, x, square)
        with k.each(0, 64) as i:
            k.store("i64", k.load("i64", k.element(square, "i64", i)), k.at("%to", k.op(f"mul i64 {i}, %stride")))
        return [k]
