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
        return vector(self, 8) if term.sort == BIT and not self.packed else lane_vector(self, term)

    def load_lanes(self, term: Term, base: str, offset: Operand = 0) -> str:
        """A term's lanes."""
        x = self.load(self.lanes_in(term), base, offset, align=8)
        bytes_ = term.sort == BIT and not self.packed
        return self.op(f"icmp slt {vector(self, 8)} {x}, zeroinitializer") if bytes_ else x

    def store_lanes(self, term: Term, value: str, base: str, offset: Operand = 0) -> None:
        """Keep a term's lanes."""
        kind = self.lanes_in(term)
        if term.sort == BIT and not self.packed:
            value = self.op(f"sext {vector(self, 1)} {value} to {kind}")
        self.store(kind, value, base, offset, align=8)

    def spread(self, kind: str, value: str) -> str:
        """A number in every lane."""
        lanes = f"<{self.lanes} x {kind}>"
        first = self.op(f"insertelement {lanes} poison, {kind} {value}, i64 0")
        return self.op(f"shufflevector {lanes} {first}, {lanes} poison, <{self.lanes} x i32> zeroinitializer")

    def load_spread(self, term: Term, base: str, offset: Operand = 0) -> str:
        """One value of a term (a bit is a byte) in every lane."""
        x = self.load(f"i{8 * bytes_of(term)}", base, offset)
        if term.sort != BIT:
            return self.spread(f"i{8 * bytes_of(term)}", x)
        on = self.op(f"icmp ne i8 {x}, 0")
        return self.op(f"sext i1 {on} to i{self.lanes}") if self.packed else self.spread("i1", on)

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
        """What is done for each lane whose bit is set in a whole number of lanes."""
        kind = f"i{self.lanes}"
        rest = self.local(kind, number)
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
        head = f"define {self.result} @{self.name}({', '.join(self.parameters)}) {ATTRIBUTES} {{"
        ended = [*self.lines, *(["ret void"] if self.result == "void" else [])]
        return "\n".join([head, *(f"  {x}" for x in (*self.locals, "br label %begin", "begin:", *ended)), "}"])
