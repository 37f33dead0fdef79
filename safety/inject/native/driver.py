"""The driver, in native code: groups of lanes through a stretch of time, from event to event.

A group starts from the fault-free run where its first fault begins, or goes on from lanes that were kept.  Its masks
change only at events: the steps at which a fault begins or ends.  While none acts, the group is compared with the
fault-free run now and then; when all lanes are as that is, it goes on at the next event, or at the end of the stretch.
What is counted is the difference from the fault-free run, so a step left out counts nothing.
"""

from __future__ import annotations

from safety.inject.native.kernel import Kernel
from safety.inject.native.masking import ENTRY
from safety.inject.native.routine import Routine

NEVER = 2**31 - 1
SELDOM = 16  # steps between two comparisons, at most
MOST_COUNTED = 2**15 - 1  # in 16 bits

# What the driver is given, each 8 bytes: an address, or a number.
PARAMETERS = (
    "groups", "going_on", "start", "stop", "prune", "wide", "atoms", "first", "end", "column", "entry", "entries",
    "rows", "before", "after", "apart", "state", "other", "seen", "taps", "passing", "sums", "up", "ever",
    "counts", "came", "columns", "blocks",
)  # fmt: skip
NUMBERS = {"groups", "going_on", "start", "stop", "wide", "prune", "columns", "blocks"}
# going_on: so many groups, the first, begin at step `start` with the lanes of `before`; all end before step `stop`,
# where `apart` says of each group which lanes are not as the fault-free run, in 8 bytes, and `after` takes these;
# wide: faults a run has at most; atoms, first, end: (wide, groups x lanes) of int32; column: of each lane, the last
# where it has none; entry: where each atom's entries begin, and the last's end; passing: `taps` without faults;
# counts: (wires, blocks, columns) of int32 and came: (watched, columns), both to be added to.

SUM = 2  # bytes of a lane's count before it goes out


class Driver:
    """Writes `run(parameters)` for a kernel."""

    def __init__(self, kernel: Kernel) -> None:
        self.kernel = kernel
        self.k = k = Routine(kernel.target, "run", ["ptr %parameters"])
        self.given = {
            name: k.load("i64" if name in NUMBERS else "ptr", "%parameters", 8 * i, align=8)
            for i, name in enumerate(PARAMETERS)
        }
        self.stride = k.op(f"mul i64 {self.given['groups']}, {k.lanes}")
        self.now, self.next = k.local("i64", 0), k.local("i64", 0)
        self.active, self.base = k.local("i64", 0), k.local("i64", 0)
        self.before, self.after = k.local("ptr", self.given["state"]), k.local("ptr", self.given["other"])
        self.check, self.gap = k.local("i64", 0), k.local("i64", 1)
        self.block, self.counted = k.local("i64", 0), k.local("i64", 0)
        self.golden = [k.local("i16", 0) for _ in kernel.counted]  # true frames without faults since counts went out
        self.missed = [k.local("i32", NEVER) for _ in range(kernel.watched)]

    def write(self) -> Routine:
        """The whole function."""
        k, stop = self.k, self.given["stop"]
        with k.each(0, self.given["groups"]) as group:
            self.base.set(k.op(f"mul i64 {group}, {k.lanes}"))
            self._begin(k.is_("slt", "i64", group, self.given["going_on"]))
            with k.while_(lambda: k.is_("slt", "i64", self.now.value, stop)):
                with k.when(k.is_("eq", "i64", self.now.value, self.next.value)):
                    self._change()
                    self._compare_from_now()
                idle = k.op(f"and i1 {self._prunes()}, {k.is_('eq', 'i64', self.active.value, 0)}")
                due = k.is_("sge", "i64", self.now.value, self.check.value)
                with k.when(k.op(f"and i1 {idle}, {due}")):
                    self._compare()
                stay = k.is_("ne", "i64", self.now.value, self.next.value)
                with k.when(k.op(f"and i1 {stay}, {k.is_('slt', 'i64', self.now.value, stop)}")):
                    self._step()
            self._finish(group)
        return k

    def _prunes(self) -> str:
        return self.k.is_("ne", "i64", self.given["prune"], 0)

    def _row(self) -> str:
        size = self.kernel.row.type.itemsize
        return self.k.at(self.given["rows"], self.k.op(f"mul i64 {self.now.value}, {size}"))

    def _field(self, row: str, name: str) -> str:
        return self.k.load("i32", row, self.kernel.row.offset(name))

    def _of_lane(self, name: str, place: str, lane: str) -> str:
        """A number of a lane's fault."""
        k = self.k
        row = k.op(f"mul i64 {place}, {self.stride}")
        index = k.op(f"add i64 {k.op(f'add i64 {row}, {self.base.value}')}, {lane}")
        return k.op(f"sext i32 {k.load('i32', k.element(self.given[name], 'i32', index), align=4)} to i64")

    # --- through time ----------------------------------------------------------------------------------------------

    def _begin(self, going_on: str) -> None:
        """With the lanes that were kept, else at the first event, or with the run where nothing is left out."""
        k = self.k
        self.counted.set(0)
        for i, missed in enumerate(self.missed):
            missed.set(NEVER)
            k.store(k.number, "zeroinitializer" if k.sliced else 0, self.given["ever"], i * self.kernel.word)
        self.active.set(0)
        self.now.set(0)
        self.next.set(0)
        leaps = k.op(f"and i1 {self._prunes()}, {k.op(f'xor i1 {going_on}, true')}")
        with k.when(leaps):
            self.next.set(NEVER)
            with k.each(0, self.given["wide"]) as place, k.each(0, k.lanes) as lane:
                begins = self._of_lane("first", place, lane)
                with k.when(k.is_("slt", "i64", begins, self.next.value)):
                    self.next.set(begins)
            self._leap()
        self._restore()
        with k.when(going_on):
            self.now.set(self.given["start"])
            self.next.set(self.given["start"])
            self.kernel.take_lanes(k, self.before.value, self._kept("before"))

    def _kept(self, name: str) -> str:
        """Where the lanes of this group are kept, a record each."""
        return self.k.at(self.given[name], self.k.op(f"mul i64 {self.base.value}, {8 * self.kernel.words}"))

    def _leap(self) -> None:
        """To the next event or the end; what the fault-free run shows first in between, each lane shows."""
        k, stop = self.k, self.given["stop"]
        earlier = k.is_("slt", "i64", self.next.value, stop)
        target = k.op(f"select i1 {earlier}, i64 {self.next.value}, i64 {stop}")
        here = self._row()
        self.now.set(target)
        there = self._row()  # one row stands behind the last
        for i, missed in enumerate(self.missed):
            comes = self._field(here, f"next{i}")
            within = k.is_("slt", "i32", comes, self._field(there, "frame"))
            sooner = k.is_("slt", "i32", comes, missed.value)
            with k.when(k.op(f"and i1 {within}, {sooner}")):
                missed.set(comes)

    def _restore(self) -> None:
        self.k.run("@restore", f"ptr {self.before.value}", f"ptr {self._row()}")
        self._compare_from_now()

    def _compare_from_now(self) -> None:
        self.check.set(self.now.value)
        self.gap.set(1)

    def _compare(self) -> None:
        """Leap when all lanes are as the fault-free run is; else wait twice as long."""
        k, kind = self.k, self.k.number
        apart = k.op(f"call {kind} @diverged(ptr {self.before.value}, ptr {self._row()})")
        self.check.set(k.op(f"add i64 {self.now.value}, {self.gap.value}"))
        longer = k.op(f"shl i64 {self.gap.value}, 1")
        self.gap.set(k.op(f"select i1 {k.is_('sgt', 'i64', longer, SELDOM)}, i64 {SELDOM}, i64 {longer}"))
        with k.when(k.op(f"xor i1 {k.some(apart)}, true")):
            self._flush()
            self._leap()
            self._restore()

    def _step(self) -> None:
        k = self.k
        row = self._row()
        seen = [f"ptr {x}" for x in (self.before.value, self.after.value, row, self.given["seen"])]
        masked = k.op(f"xor i1 {self._prunes()}, true")
        masked = k.op(f"or i1 {masked}, {k.is_('ne', 'i64', self.active.value, 0)}")
        with k.when(masked):
            k.run("@faulty", *seen, f"ptr {self.given['taps']}")
        with k.when(k.op(f"xor i1 {masked}, true")):
            self.kernel.healthy_step(k, seen, self.given["taps"])
        before = self.before.value
        self.before.set(self.after.value)
        self.after.set(before)
        ends = self._field(row, "tally")
        with k.when(k.is_("ne", "i32", ends, 0)):
            self._tally(row)
            self.counted.add(1)
            full = k.is_("sge", "i64", self.counted.value, MOST_COUNTED)
            with k.when(k.op(f"or i1 {full}, {k.is_('eq', 'i32', ends, 2)}")):
                self._flush()
        self.now.add(1)

    def _finish(self, group: str) -> None:
        """Masks away, counts and lanes out."""
        k, kind = self.k, self.k.number
        self._flush()
        with k.when(k.is_("ne", "ptr", self.given["after"], "null")):
            apart = k.op(f"call {kind} @diverged(ptr {self.before.value}, ptr {self._row()})")
            place = k.at(self.given["apart"], k.op(f"mul i64 {group}, {self.kernel.word}"))
            k.store(kind, apart, place, align=8)
            self.kernel.give_lanes(k, self.before.value, self._kept("after"), apart)
        with k.when(k.is_("ne", "i64", self.active.value, 0)):
            k.intrinsics.add("declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)")
            whole = f"ptr {self.given['taps']}, ptr {self.given['passing']}, i64 {self.kernel.taps_size}"
            k.lines.append(f"call void @llvm.memcpy.p0.p0.i64({whole}, i1 false)")
        for i, missed in enumerate(self.missed):
            with k.when(k.is_("ne", "i32", missed.value, NEVER)), k.each(0, k.lanes) as lane:
                self._came(i, lane, missed.value)

    # --- what is seen ----------------------------------------------------------------------------------------------

    def _tally(self, row: str) -> None:
        """At the end of a frame: where an observed wire is not as in the fault-free run, and where first true."""
        k, kind, kernel = self.k, self.k.number, self.kernel
        self.block.set(k.op(f"sext i32 {self._field(row, 'block')} to i64"))
        for i in range(len(kernel.wires)):
            seen = k.load(kind, self.given["seen"], i * kernel.word, align=8)
            golden = k.op(f"trunc i8 {k.load('i8', row, kernel.row.offset(f'wire{i}'))} to i1")
            if i in kernel.counted:
                self.golden[kernel.counted.index(i)].add(k.op(f"zext i1 {golden} to i16"))
                up = k.load(kind, self.given["up"], i * kernel.word, align=8)
                changed = k.op(f"xor {kind} {seen}, {up}")
                with k.when(k.some(changed)):
                    k.store(kind, seen, self.given["up"], i * kernel.word, align=8)
                    now = k.op(f"trunc i64 {self.counted.value} to i16")
                    self._count(i, k.op(f"and {kind} {changed}, {seen}"), k.op(f"sub i16 0, {now}"))
                    self._count(i, k.op(f"and {kind} {changed}, {up}"), now)
            if i < kernel.watched:
                ever = k.load(kind, self.given["ever"], i * kernel.word, align=8)
                new = k.op(f"and {kind} {seen}, {k.inverted(ever)}")
                with k.when(k.some(new)):
                    k.store(kind, k.op(f"or {kind} {ever}, {new}"), self.given["ever"], i * kernel.word, align=8)
                    with k.each_bit(new) as lane:
                        self._came(i, lane, self._field(row, "frame"))

    def _sums(self, wire: int, first: str) -> str:
        """Where the counts of a word of lanes are."""
        k = self.k
        place = k.at(self.given["sums"], self.kernel.counted.index(wire) * SUM * k.lanes)
        return k.element(place, "i16", first)

    def _count(self, wire: int, lanes: str, more: str) -> None:
        """Add to the counts of some lanes: less by the frame where a wire rises, more by that where it falls."""
        k = self.k
        many = min(k.lanes, 64)
        kind = f"<{many} x i16>"
        each = k.spread_over(many, "i16", more)
        with k.each_word(lanes) as (lane, word), k.when(k.is_("ne", k.word, word, 0)):
            place = self._sums(wire, lane)
            chosen = k.op(f"bitcast {k.word} {word} to <{many} x i1>")
            step = k.op(f"select <{many} x i1> {chosen}, {kind} {each}, {kind} zeroinitializer")
            k.store(kind, k.op(f"add {kind} {k.load(kind, place)}, {step}"), place)

    def _flush(self) -> None:
        """The counts of this block go out, where they are not those of the fault-free run; none is up any more."""
        k, blocks, columns = self.k, self.given["blocks"], self.given["columns"]
        many = min(k.lanes, 64)
        kind = f"<{many} x i16>"
        frames = k.spread_over(many, "i16", k.op(f"trunc i64 {self.counted.value} to i16"))
        self.counted.set(0)
        for position, wire in enumerate(self.kernel.counted):
            golden = k.spread_over(many, "i16", self.golden[position].value)
            self.golden[position].set(0)
            with k.each(0, k.lanes // many) as word:
                first = k.op(f"mul i64 {word}, {many}")
                place = k.element(k.at(self.given["up"], wire * self.kernel.word), k.word, word)
                up = k.op(f"bitcast {k.word} {k.load(k.word, place)} to <{many} x i1>")
                k.store(k.word, 0, place)
                until = k.op(f"select <{many} x i1> {up}, {kind} {frames}, {kind} zeroinitializer")
                sums = k.op(f"add {kind} {k.load(kind, self._sums(wire, first))}, {until}")
                sums = k.op(f"sub {kind} {sums}, {golden}")
                k.store(kind, sums, self._sums(wire, first))
                some = k.op(f"icmp ne {kind} {sums}, zeroinitializer")
                with k.each_of(k.op(f"bitcast <{many} x i1> {some} to {k.word}")) as place:
                    lane = k.op(f"add i64 {first}, {place}")
                    block = k.op(f"add i64 {k.op(f'mul i64 {blocks}, {position}')}, {self.block.value}")
                    index = k.op(f"add i64 {k.op(f'mul i64 {block}, {columns}')}, {self._column(lane)}")
                    place, own = k.element(self.given["counts"], "i32", index), self._sums(wire, lane)
                    more = k.op(f"sext i16 {k.load('i16', own, align=2)} to i32")
                    k.store("i32", k.op(f"add i32 {k.load('i32', place, align=4)}, {more}"), place, align=4)
                    k.store("i16", 0, own, align=2)

    def _came(self, wire: int, lane: str, frame: str) -> None:
        """A watched wire is true at a frame's end: keep the first."""
        k = self.k
        row = k.op(f"mul i64 {self.given['columns']}, {wire}")
        place = k.element(self.given["came"], "i32", k.op(f"add i64 {row}, {self._column(lane)}"))
        with k.when(k.is_("slt", "i32", frame, k.load("i32", place, align=4))):
            k.store("i32", frame, place, align=4)

    def _column(self, lane: str) -> str:
        k = self.k
        place = k.element(self.given["column"], "i32", k.op(f"add i64 {self.base.value}, {lane}"))
        return k.op(f"sext i32 {k.load('i32', place, align=4)} to i64")

    # --- masks -----------------------------------------------------------------------------------------------------

    def _change(self) -> None:
        """The masks of the lanes that have an event at this step, and when the next event is."""
        k, now, wide = self.k, self.now, self.given["wide"]
        many = min(k.lanes, 64)
        times, yes = f"<{many} x i32>", f"<{many} x i1>"
        at = k.spread_over(many, "i32", k.op(f"trunc i64 {now.value} to i32"))
        never = k.spread_over(many, "i32", str(NEVER))
        following, acting = k.local(times, never), k.local(k.word, 0)
        following.set(never)
        acting.set(0)
        with k.each(0, k.lanes // many) as word:
            first = k.op(f"mul i64 {word}, {many}")
            touched = k.local(k.word, 0)
            touched.set(0)
            with k.each(0, wide) as place:
                begins, ends = (self._of_lanes(name, place, first, times) for name in ("first", "end"))
                for event in (begins, ends):
                    here = k.op(f"bitcast {yes} {k.op(f'icmp eq {times} {event}, {at}')} to {k.word}")
                    touched.set(k.op(f"or {k.word} {touched.value}, {here}"))
                    later = k.op(f"icmp sgt {times} {event}, {at}")
                    event = k.op(f"select {yes} {later}, {times} {event}, {times} {never}")
                    following.set(k.call("smin", times, following.value, event))
                begun = k.op(f"icmp sle {times} {begins}, {at}")
                acts = k.op(f"and {yes} {begun}, {k.op(f'icmp slt {times} {at}, {ends}')}")
                acting.set(k.op(f"or {k.word} {acting.value}, {k.op(f'bitcast {yes} {acts} to {k.word}')}"))
            with k.each_of(touched.value) as inside:
                lane = k.op(f"add i64 {first}, {inside}")
                with k.each(0, wide) as place:
                    begun = k.is_("sle", "i64", self._of_lane("first", place, lane), now.value)
                    self._masks(begun, place, lane, "@pass")
                with k.each(0, wide) as place:
                    window = self._of_lane("first", place, lane), self._of_lane("end", place, lane)
                    self._masks(self._acts(*window), place, lane, "@mask")
        self.next.set(k.op(f"sext i32 {k.least(many, following.value)} to i64"))
        self.active.set(k.op(f"zext i1 {k.is_('ne', k.word, acting.value, 0)} to i64"))
        with k.when(k.is_("eq", "i64", self.active.value, 0)):
            self.kernel.clear(k, self.given["taps"])

    def _of_lanes(self, name: str, place: str, first: str, times: str) -> str:
        """A number of the fault of each of some lanes."""
        k = self.k
        index = k.op(f"add i64 {k.op(f'mul i64 {place}, {self.stride}')}, {self.base.value}")
        return k.load(times, k.element(self.given[name], "i32", k.op(f"add i64 {index}, {first}")), align=4)

    def _acts(self, begins: str, ends: str) -> str:
        k, now = self.k, self.now.value
        return k.op(f"and i1 {k.is_('sle', 'i64', begins, now)}, {k.is_('slt', 'i64', now, ends)}")

    def _masks(self, condition: str, place: str, lane: str, function: str) -> None:
        """Call a function on each entry of a lane's fault."""
        k = self.k
        with k.when(condition):
            atom = k.element(self.given["entry"], "i64", self._of_lane("atoms", place, lane))
            with k.each(k.load("i64", atom), k.load("i64", atom, 8)) as i:
                entry = k.at(self.given["entries"], k.op(f"mul i64 {i}, {8 * len(ENTRY)}"))
                k.run(function, f"ptr {self.given['taps']}", f"ptr {entry}", f"i64 {lane}")


def recorder(kernel: Kernel) -> Routine:
    """`golden(rows, total, state, other, seen, taps)`: the fault-free run, a row a step.

    It goes on from the state in the first lane, under `taps` without faults.
    """
    k = Routine(
        kernel.target, "golden", ["ptr %rows", "i64 %total", "ptr %state", "ptr %other", "ptr %seen", "ptr %taps"]
    )
    before, after = k.local("ptr", "%state"), k.local("ptr", "%other")
    with k.each(0, "%total") as step:
        row = k.at("%rows", k.op(f"mul i64 {step}, {kernel.row.type.itemsize}"))
        k.run("@record", f"ptr {before.value}", f"ptr {row}")
        given = [f"ptr {before.value}", f"ptr {after.value}", f"ptr {row}", "ptr %seen"]
        kernel.healthy_step(k, given, "%taps")
        for i in range(len(kernel.wires)):
            k.store(
                "i8", k.op(f"and i8 {k.load('i8', '%seen', i * kernel.word)}, 1"), row, kernel.row.offset(f"wire{i}")
            )
        x = before.value
        before.set(after.value)
        after.set(x)
    return k
