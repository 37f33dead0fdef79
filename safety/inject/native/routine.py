"""Writing a native function: memory, variables, branches and loops on top of the instructions of the terms."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from safety.terms.column_native import lane_vector, vector
from safety.terms.graph import BIT, Term
from safety.terms.llvm import Target
from safety.terms.native import ATTRIBUTES, Writer, bytes_of

Operand = str | int


@dataclass(frozen=True)
class Local:
    """A variable of a function."""

    routine: Routine
    kind: str
    place: str

    @property
    def value(self) -> str:
        """What it holds now."""
        return self.routine.op(f"load {self.kind}, ptr {self.place}")

    def set(self, value: Operand) -> None:
        """Change it."""
        self.routine.lines.append(f"store {self.kind} {value}, ptr {self.place}")

    def add(self, value: Operand) -> None:
        """Increase it."""
        self.set(self.routine.op(f"add {self.kind} {self.value}, {value}"))


class Routine(Writer):
    """LLVM text of a function of pointers and 64-bit numbers, from its name and parameters (`ptr state`, `i64 n`)."""

    def __init__(self, target: Target, name: str, parameters: Sequence[str], result: str = "void") -> None:
        super().__init__(target)
        self.name, self.parameters, self.result = name, parameters, result
        self.locals: list[str] = []
        self.bound: dict[int, Callable[[], str]] = {}  # how to read a variable, by uid
        self.labels = 0
        self.attributes = ""

    def variable(self, term: Term) -> str:
        """Read a variable where it is used first: near its use, and not at all where it has none."""
        return self.bound[term.uid]() if term.uid in self.bound else super().variable(term)

    # --- memory ----------------------------------------------------------------------------------------------------

    def at(self, base: str, offset: Operand) -> str:
        """The address some bytes behind another."""
        return base if offset == 0 else self.op(f"getelementptr i8, ptr {base}, i64 {offset}")

    def element(self, base: str, kind: str, index: Operand) -> str:
        """The address of an element of an array."""
        return self.op(f"getelementptr {kind}, ptr {base}, i64 {index}")

    def load(self, kind: str, base: str, offset: Operand = 0, align: int = 1) -> str:
        """Read memory."""
        return self.op(f"load {kind}, ptr {self.at(base, offset)}, align {align}")

    def store(self, kind: str, value: Operand, base: str, offset: Operand = 0, align: int = 1) -> None:
        """Write memory."""
        self.lines.append(f"store {kind} {value}, ptr {self.at(base, offset)}, align {align}")

    def lanes_in(self, term: Term) -> str:
        """The type of a term's lanes in memory: a bit that is not packed is a byte, all ones or zero."""
        return vector(self, 8) if self._as_bytes(term) else lane_vector(self, term)

    def _as_bytes(self, term: Term) -> bool:
        return term.sort == BIT and not (self.packed or self.sliced)

    def load_lanes(self, term: Term, base: str, offset: Operand = 0) -> str:
        """A term's lanes."""
        x = self.load(self.lanes_in(term), base, offset, align=8)
        return self.op(f"icmp slt {vector(self, 8)} {x}, zeroinitializer") if self._as_bytes(term) else x

    def store_lanes(self, term: Term, value: str, base: str, offset: Operand = 0) -> None:
        """Keep a term's lanes."""
        kind = self.lanes_in(term)
        if self._as_bytes(term):
            value = self.op(f"sext {vector(self, 1)} {value} to {kind}")
        self.store(kind, value, base, offset, align=8)

    def spread(self, kind: str, value: str) -> str:
        """A number in every lane."""
        return self.spread_over(self.lanes, kind, value)

    def spread_over(self, many: int, kind: str, value: str) -> str:
        """A number so many times."""
        lanes = f"<{many} x {kind}>"
        first = self.op(f"insertelement {lanes} poison, {kind} {value}, i64 0")
        return self.op(f"shufflevector {lanes} {first}, {lanes} poison, <{many} x i32> zeroinitializer")

    def least(self, many: int, numbers: str) -> str:
        """The least of so many numbers of 32 bits."""
        reduce = f"i32 @llvm.vector.reduce.smin.v{many}i32(<{many} x i32>"
        self.intrinsics.add(f"declare {reduce})")
        return self.op(f"call {reduce} {numbers})")

    def load_spread(self, term: Term, base: str, offset: Operand = 0) -> str:
        """One value of a term (a bit is a byte) in every lane."""
        x = self.load(f"i{8 * bytes_of(term)}", base, offset)
        if term.sort != BIT:
            return self.spread(f"i{8 * bytes_of(term)}", x)
        on = self.op(f"icmp ne i8 {x}, 0")
        return self.op(f"sext i1 {on} to i{self.lanes}") if self.packed else self.spread("i1", on)

    @staticmethod
    def number_of(target: Target) -> str:
        """The type of a bit of all lanes where it is seen as a whole: a number, or words of 64 bits."""
        return f"<{target.lanes // 64} x i64>" if target.sliced else f"i{target.lanes}"

    @property
    def number(self) -> str:
        """The same."""
        return f"<{self.lanes // 64} x i64>" if self.sliced else f"i{self.lanes}"

    def all_of(self, i1: str) -> str:
        """A bit that is the same in all lanes, as a whole."""
        if not self.sliced:
            return self.op(f"sext i1 {i1} to {self.number}")
        return self.op(f"select i1 {i1}, {self.number} splat (i64 -1), {self.number} zeroinitializer")

    def inverted(self, number: str) -> str:
        """A bit of all lanes, inverted."""
        return self.op(f"xor {self.number} {number}, {'splat (i64 -1)' if self.sliced else '-1'}")

    def some(self, number: str) -> str:
        """Whether a bit is set in some lane."""
        if not self.sliced:
            return self.is_("ne", self.number, number, 0)
        words = self.lanes // 64
        apart = self.op(f"icmp ne {self.number} {number}, zeroinitializer")
        return self.is_("ne", f"i{words}", self.op(f"bitcast <{words} x i1> {apart} to i{words}"), 0)

    @contextmanager
    def each_word(self, number: str) -> Iterator[tuple[str, str]]:
        """What is done for each word of a bit of all lanes: its first lane, the word."""
        if not self.sliced:
            yield "0", number
            return
        place = self.fresh()
        self.locals.append(f"{place} = alloca {self.number}, align 64")
        self.store(self.number, number, place)
        with self.each(0, self.lanes // 64) as i:
            yield self.op(f"mul i64 {i}, 64"), self.load("i64", self.element(place, "i64", i))

    @property
    def word(self) -> str:
        """The type of a word."""
        return f"i{min(self.lanes, 64)}"

    def as_number(self, bit: str) -> str:
        """A bit of all lanes as one whole number."""
        return bit if self.packed else self.op(f"bitcast {vector(self, 1)} {bit} to i{self.lanes}")

    # --- control ---------------------------------------------------------------------------------------------------

    def local(self, kind: str, value: Operand) -> Local:
        """A variable with its first value."""
        name = self.fresh()
        self.locals.append(f"{name} = alloca {kind}")
        found = Local(self, kind, name)
        found.set(value)
        return found

    def is_(self, how: str, kind: str, x: Operand, y: Operand) -> str:
        """A comparison of two numbers."""
        return self.op(f"icmp {how} {kind} {x}, {y}")

    def _labels(self, *names: str) -> list[str]:
        self.labels += 1
        return [f"{name}{self.labels}" for name in names]

    def _begin(self, label: str) -> None:
        self.lines += [f"br label %{label}", f"{label}:"]

    @contextmanager
    def when(self, condition: str) -> Iterator[None]:
        """What is done only where a condition holds."""
        then, end = self._labels("then", "end")
        self.lines += [f"br i1 {condition}, label %{then}, label %{end}", f"{then}:"]
        yield
        self._begin(end)

    def fork(self, condition: str) -> tuple[str, str, str]:
        """Go on with what is seldom done: the labels of before, of here and of where both ways are to `join`."""
        before, then, end = self._labels("before", "then", "end")
        self._begin(before)
        self.lines += [f"br i1 {condition}, label %{then}, label %{end}, !prof !0", f"{then}:"]
        return before, then, end

    def join(self, end: str) -> None:
        """Where both ways meet."""
        self._begin(end)

    @contextmanager
    def while_(self, condition: Callable[[], str]) -> Iterator[None]:
        """What is done as long as a condition holds."""
        top, body, end = self._labels("top", "body", "end")
        self._begin(top)
        self.lines += [f"br i1 {condition()}, label %{body}, label %{end}", f"{body}:"]
        yield
        self.lines += [f"br label %{top}", f"{end}:"]

    @contextmanager
    def each(self, first: Operand, end: Operand) -> Iterator[str]:
        """What is done for each number from the first to before the end."""
        i = self.local("i64", first)
        with self.while_(lambda: self.is_("slt", "i64", i.value, end)):
            yield i.value
            i.add(1)

    @contextmanager
    def each_bit(self, number: str) -> Iterator[str]:
        """What is done for each lane whose bit is set in a bit of all lanes."""
        with self.each_word(number) as (first, word), self.each_of(word) as place:
            yield self.op(f"add i64 {first}, {place}")

    @contextmanager
    def each_of(self, word: str) -> Iterator[str]:
        """What is done for each lane whose bit is set in a word."""
        kind = self.word
        rest = self.local(kind, word)
        with self.while_(lambda: self.is_("ne", kind, rest.value, 0)):
            x = rest.value
            rest.set(self.op(f"and {kind} {x}, {self.op(f'add {kind} {x}, -1')}"))
            self.intrinsics.add(f"declare {kind} @llvm.cttz.{kind}({kind}, i1)")
            place = self.op(f"call {kind} @llvm.cttz.{kind}({kind} {x}, i1 true)")
            yield place if kind == "i64" else self.op(f"zext {kind} {place} to i64")

    def run(self, function: str, *args: str) -> None:
        """Call a function that gives nothing; an argument is `ptr x` or `i64 n`."""
        self.lines.append(f"call void {function}({', '.join(args)})")

    @property
    def text(self) -> str:
        """The function, complete but for the declarations of its `intrinsics`."""
        head = f"define {self.result} @{self.name}({', '.join(self.parameters)}) {ATTRIBUTES}{self.attributes} {{"
        ended = [*self.lines, *(["ret void"] if self.result == "void" else [])]
        return "\n".join([head, *(f"  {x}" for x in (*self.locals, "br label %begin", "begin:", *ended)), "}"])
