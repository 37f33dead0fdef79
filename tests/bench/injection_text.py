"""A task as straight-line C++ over 64 runs side by side, as one would write it by hand with vector extensions.

Words of up to 8 bits are bytes, wider ones have 16 bits; a wire is a byte, 0 or 255 (`bytes`, any processor), or a bit
of a 64-bit word (`masks`, AVX-512).  What no fault can change is computed once a frame, as a plain number.  Runs side
by side share the points of their faults, so that a point is a branch that is always predicted.  Nothing is shared with
the engines but the graph.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from safety.inject.engine import Task
from safety.system import State
from safety.terms.graph import Term, postorder
from tests.bench.injection_task import starts

FRAME = (Path(__file__).parent / "injection_lanes.cpp").read_text(encoding="utf-8")
INFIX = {"and": "&", "or": "|", "xor": "^", "band": "&", "bor": "|", "bxor": "^", "add": "+", "sub": "-"}
COMPARE = {"eq": "equal", "lt": "less", "le": "at_most"}
SYMBOL = {**INFIX, "eq": "==", "lt": "<", "le": "<=", "mul": "*"}


class Writer:
    """Writes each term of a step once for each width that is asked for."""

    def __init__(self, task: Task, rows: int) -> None:
        registers = {s.var.uid: s for s in task.system.states}
        self.task, self.rows = task, rows
        self.observed = {name: task.system.lookup(name) for name in dict.fromkeys((*task.count, *task.watch))}
        order = postorder(self.observed.values())
        while len(order) < len(order := postorder([*self.observed.values(), *_nexts(registers, order)])):
            pass
        self.order, self.states = order, [registers[t.uid] for t in order if t.uid in registers]
        self.points = {p: n for n, p in enumerate(task.system.points)}
        self.varies = self._varying()
        self.starts = starts(task)
        self.spans: dict[int, tuple[int, int]] = {}
        self.lines: list[str] = []
        self.known: dict[tuple[int, int], str] = {}

    def _varying(self) -> set[int]:
        found: set[int] = set()
        while True:
            size = len(found)
            for t in self.order:
                if t.op == "point" or any(a.uid in found for a in t.args):
                    found.add(t.uid)
            found |= {s.var.uid for s in self.states if s.next.uid in found}
            if len(found) == size:
                return found

    # --- widths ----------------------------------------------------------------------------------------------------

    def span(self, t: Term) -> tuple[int, int]:
        """Least and greatest value, often closer than the sort's."""
        if t.uid not in self.spans:
            low, high = t.sort.bounds
            if t.is_const:
                low = high = int(t.attr)
            elif t.op in ("add", "sub"):
                (a, b), (c, d) = map(self.span, t.args)
                low, high = (a + c, b + d) if t.op == "add" else (a - d, b - c)
            elif t.op == "cast":
                low, high = self.span(t.args[0])
            self.spans[t.uid] = low, high
        return self.spans[t.uid]

    def width(self, *terms: Term) -> int:
        """Bits of an element that holds the values of all these, which are not negative."""
        spans = [self.span(t) for t in terms]
        assert min(low for low, _ in spans) >= 0, "a number below 0 is only clipped"
        high = max(high for _, high in spans)
        assert high < 1 << 16, "no number that a fault can change is wider than 16 bits here"
        return 8 if high < 256 else 16

    # --- text ------------------------------------------------------------------------------------------------------

    def text(self, t: Term, width: int = 0) -> str:
        """A wire (`width` 0), or a number modulo 2 to the power of 8 or 16."""
        key = (t.uid, width)
        if key not in self.known:
            if t.uid not in self.varies:
                self.known[key] = f"every({self.plain(t)})" if not width else f"v{width}_of({self.plain(t)})"
            elif t.op == "var":
                own = 0 if t.sort.kind == "bit" else self.width(t)
                self.known[key] = f"q{t.uid}" if width == own else f"to{width}(q{t.uid})"
            else:
                self.known[key] = self._named(
                    "wire" if not width else f"v{width}", self._wire(t) if not width else self._number(t, width)
                )
                if t.op == "point":
                    self._site(t, self.known[key], width)
        return self.known[key]

    def _named(self, kind: str, text: str) -> str:
        name = f"t{len(self.lines)}"
        self.lines.append(f"{kind} {name} = {text};")
        return name

    def _site(self, t: Term, name: str, width: int) -> None:
        """Where a fault may act; all runs side by side have it at the same points."""
        assert width in (0, 8), "a mask has a byte a run"
        kind = "" if width else "_wire"
        self.lines.append(self.at(t, lambda r: f"{name} = ({name} & held[{r}].keep{kind}) ^ held[{r}].turn{kind};"))

    def at(self, point: Term, masked: Callable[[str], str]) -> str:
        """A branch that is taken where the batch has a fault at the point; `masked` says what each row then does."""
        number = self.points[point.attr]
        if self.rows == 1:
            return f"if (UNLIKELY(site[0] == {number})) {{ {masked('0')} }}"
        each = "for (int r = 0; r < ROWS; r++)"
        return f"if (UNLIKELY(at[{number}])) {each} if (site[r] == {number}) {{ {masked('r')} }}"

    def _wire(self, t: Term) -> str:
        if t.op in COMPARE and t.args[0].sort.kind != "bit":
            width = self.width(*t.args)
            return f"{COMPARE[t.op]}({', '.join(self.text(a, width) for a in t.args)})"
        if t.op == "bit":
            (x,) = t.args
            if x.op == "add" and t.attr == 8 and self.width(*x.args) == 8:
                return f"less({self.text(x, 8)}, {self.text(x.args[0], 8)})"  # the carry
            return f"bit_of({self.text(x, self.width(x))}, {1 << t.attr})"
        x, *others = (self.text(a) for a in t.args)
        if t.op in INFIX:
            return f"{x} {INFIX[t.op]} {others[0]}"
        if t.op == "select":
            return f"chosen({x}, {others[0]}, {others[1]})"
        return {"point": x, "not": f"~{x}", "eq": f"~({x} ^ {''.join(others)})"}[t.op]

    def _number(self, t: Term, width: int) -> str:
        if t.op in INFIX:
            return f" {INFIX[t.op]} ".join(self.text(a, width) for a in t.args)
        if t.op in ("cast", "point"):
            return self.text(t.args[0], width)
        if t.op == "select":
            c, x, y = t.args
            if x.is_const and y.is_const and (x.attr, y.attr) == (1, 0):
                return f"one({self.text(c)})" if width == 8 else f"to16({self.text(t, 8)})"
            return f"chosen({self.text(c)}, {self.text(x, width)}, {self.text(y, width)})"
        if t.op == "slice" and t.attr[0] == 0:
            x = self.text(t.args[0], width)
            return x if t.attr[1] == width else f"{x} & {(1 << t.attr[1]) - 1}"
        assert t.op == "clip", f"{t.op} does not occur"
        return self._clipped(t, width)

    def _clipped(self, t: Term, width: int) -> str:
        (x,), (low, high) = t.args, t.sort.bounds
        least, greatest = self.span(x)
        if least < low:
            assert x.op == "sub" and low == 0 and greatest <= high, "only a difference falls below its range"
            a, b = (self.text(y, width) for y in x.args)
            return f"chosen(less({a}, {b}), v{width}_of(0), {a} - {b})"
        inner = self.text(x, own := self.width(x))
        if greatest > high:
            bound = f"v{own}_of({high})"
            inner = self._named(f"v{own}", f"chosen(less({bound}, {inner}), {bound}, {inner})")
        return inner if own == width else f"to{width}({inner})"

    def plain(self, t: Term) -> str:
        """What no fault changes, as a number or a truth value."""
        key = (t.uid, -1)
        if key not in self.known:
            args = [self.plain(a) for a in t.args]
            if t.is_const:
                return str(int(t.attr))
            if t.op == "var":
                return f"q{t.uid}" if any(t is s.var for s in self.states) else f"in_{t.attr}[frame]"
            x, *others = args
            text = {
                "not": f"!{x}", "cast": x, "point": x,
                "clip": "clip({}, {}, {})".format(x, *t.sort.bounds),
                "slice": "{} >> {} & {}".format(x, (t.attr or (0, 0))[0] if t.op == "slice" else 0,
                                                t.sort.high if t.op == "slice" else 0),
                "bit": f"{x} >> {t.attr} & 1",
                "select": f"{x} ? {others[0]} : {others[-1]}" if others else "",
            }.get(t.op) or f"{x} {SYMBOL[t.op]} {others[0]}"  # fmt: skip
            self.known[key] = self._named("long", text)
        return self.known[key]

    # --- the program -----------------------------------------------------------------------------------------------

    def seen(self, wire: Term) -> str:
        """An observed wire, as it is before the registers change."""
        return self._named("wire", self.text(wire))

    def registers(self) -> Iterator[Register]:
        """The registers as the program has them."""
        for s in self.states:
            name, start = f"q{s.var.uid}", self.starts[s.path]
            if s.var.uid not in self.varies:
                yield Register(name, "long", str(start), self.plain(s.next))
            elif s.var.sort.kind == "bit":
                yield Register(name, "wire", f"every({start})", self.text(s.next))
            else:
                kind = f"v{(width := self.width(s.var))}"
                yield Register(name, kind, f"{kind}_of({start})", self.text(s.next, width))

    def program(self, lanes: int, wires: str) -> str:
        """The whole source."""
        timing = self.task.timing
        seen = {name: self.seen(t) for name, t in self.observed.items()}
        registers = list(self.registers())
        marked = {
            "WIRES": wires.upper(), "LANES": lanes, "ROWS": self.rows, "POINTS": len(self.points),
            "RUN_IN": timing.run_in, "FRAMES": timing.frames, "BLOCK": timing.block,
            "COUNTED": len(self.task.count), "WATCHED": len(self.task.watch),
            "INPUTS": "".join(f", const i32 *in_{name}" for name in self.task.system.inputs),
            "START": "\n".join(f"    {r.kind} {r.name} = {r.start};" for r in registers),
            "STEP": "\n".join(f"      {line}" for line in [
                *self.lines, *(f"const {r.kind} next_{r.name} = {r.following};" for r in registers),
                *(f"{r.name} = next_{r.name};" for r in registers),
            ]),
            "WATCHED_WIRES": ", ".join(seen[name] for name in self.task.watch),
            "COUNTED_WIRES": ", ".join(seen[name] for name in self.task.count),
        }  # fmt: skip
        return re.sub("@([A-Z_]+)@", lambda found: str(marked[found[1]]), FRAME)


class Register(NamedTuple):
    """A register of the program: its name, type, start and next value."""

    name: str
    kind: str
    start: str
    following: str


def _nexts(registers: Mapping[int, State], order: Sequence[Term]) -> list[Term]:
    return [registers[t.uid].next for t in order if t.uid in registers]
