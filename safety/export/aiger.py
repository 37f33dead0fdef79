"""A claim as an AIGER file: bits, registers, and-gates and inverters.

Format 1.9 (A. Biere, K. Heljanko, S. Wieringa, AIGER 1.9 And Beyond, 2011) has power-up values, assumptions (C) and
the bad condition (B).  Several tools do not go beyond the format of 2007: ABC takes a register of unknown power-up
value to hold 0, and only warns.  So by default the file is of that kind: one output, true at the violation, and every
register 0 at first.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from safety.export.bits import Bits, bits_of, refuse_real
from safety.export.gates import FALSE, TRUE, Gates, Word, constant
from safety.export.transition import Problem, Transition, power_up, transition
from safety.system import State

STARTED, VALID, FIRST = "tool.started", "tool.valid", "tool.first"
AT_START = "@start"


@dataclass
class Circuit:
    """Wires by name, registers by name with next and power-up literal (its own one: any), assumptions and bad."""

    gates: Gates = field(default_factory=Gates)
    inputs: dict[int, str] = field(default_factory=dict)
    registers: dict[int, str] = field(default_factory=dict)
    next: dict[int, int] = field(default_factory=dict)
    reset: dict[int, int] = field(default_factory=dict)
    constraints: list[int] = field(default_factory=list)
    bad: int = FALSE

    def input(self, name: str) -> int:
        """A new input."""
        literal = self.gates.variable()
        self.inputs[literal] = name
        return literal

    def register(self, name: str) -> int:
        """A new register; its next and its power-up literal are to be given."""
        literal = self.gates.variable()
        self.registers[literal] = name
        return literal


def aiger(problem: Problem, lemmas: bool = False, fold_constraints: bool = True) -> bytes:
    """The claim in binary AIGER: unreachable, the bad output, exactly if the claim holds for ever.

    `fold_constraints`: a file of the format of 2007 for any tool.  Its step 0 only loads the registers (free power-up
    values from inputs named `NAME@start[BIT]`), so its step n + 1 is the model's step n; `tool.started` is false at
    step 0 alone, and `tool.valid` says that all that is assumed held before.  Without it a file of format 1.9.
    `lemmas`: they have to hold as the claim does.  Wires are named `FULL.NAME[BIT]`, bit 0 the lowest.
    Raises `TermError` for a claim over reals.
    """
    return binary(circuit(problem, lemmas, fold_constraints))


def aag(problem: Problem, lemmas: bool = False, fold_constraints: bool = False) -> str:
    """The same in ASCII, by default in format 1.9."""
    return ascii_text(circuit(problem, lemmas, fold_constraints))


def circuit(problem: Problem, lemmas: bool = False, fold_constraints: bool = True) -> Circuit:
    """The claim as a circuit; see `aiger`."""
    what = transition(problem, lemmas)
    return _folded(what) if fold_constraints else _plain(what)


def _wires(make: Callable[[str], int], name: str, bits: int) -> Word:
    return tuple(make(f"{name}[{i}]") for i in range(bits))


def _bound(made: Circuit, what: Transition) -> tuple[Bits, dict[State, Word]]:
    """A reading with inputs and registers bound to wires of their own."""
    reading = Bits(made.gates)
    for v in (*what.inputs, *(s.var for s in what.states)):
        refuse_real(v)
    for v in what.inputs:
        reading.bind(v, _wires(made.input, str(v.attr), bits_of(v.sort)))
    held = {s: _wires(made.register, s.path, bits_of(s.var.sort)) for s in what.states}
    for s, word in held.items():
        reading.bind(s.var, word)
    return reading, held


def _plain(what: Transition) -> Circuit:
    made = Circuit()
    reading, held = _bound(made, what)
    given, holds = (word[0] for word in reading([what.given, what.holds]))
    for (s, word), after in zip(held.items(), reading([s.next for s in what.states]), strict=True):
        made.next.update(zip(word, after, strict=True))
        made.reset.update(zip(word, _at_start(s, word), strict=True))
    if what.has_start:
        first = made.register(FIRST)
        made.next[first], made.reset[first] = FALSE, TRUE
        made.constraints.append(made.gates.either(first ^ 1, reading([what.start])[0][0]))
    made.constraints.append(given)
    made.constraints = [c for c in made.constraints if c != TRUE]
    made.bad = holds ^ 1
    return made


def _folded(what: Transition) -> Circuit:
    made = Circuit()
    g = made.gates
    started, valid = made.register(STARTED), made.register(VALID)
    reading, held = _bound(made, what)
    given, holds = (word[0] for word in reading([what.given, what.holds]))
    loading = Bits(g)
    for s, word in held.items():
        free = _wires(made.input, s.path + AT_START, len(word)) if power_up(s) is None else word
        loading.bind(s.var, _at_start(s, free))
    begins = loading([what.start])[0][0]
    for (s, word), after in zip(held.items(), reading([s.next for s in what.states]), strict=True):
        made.next.update(zip(word, g.pick(started, after, loading.known[s.var.uid]), strict=True))
    made.next[started] = TRUE
    made.next[valid] = g.choose(started, g.both(valid, given), begins)
    made.reset = dict.fromkeys(made.registers, FALSE)
    made.bad = g.all_of([started, valid, given, holds ^ 1])
    return made


def _at_start(s: State, free: Word) -> Word:
    """The literals that a register holds at power-up: `free` where it may hold anything."""
    value = power_up(s)
    return free if value is None else constant(int(value), len(free))


# --- files ---------------------------------------------------------------------------------------------------------


@dataclass
class _Numbered:
    """A circuit with its literals renumbered as the binary format wants them: inputs, registers, then gates."""

    inputs: list[str]
    registers: list[tuple[str, int, int]]  # name, next, power-up
    gates: list[tuple[int, int, int]]  # output, inputs (the greater first)
    constraints: list[int]
    bad: int
    old: bool  # whether the format of 2007 says it all

    @property
    def header(self) -> str:
        m, i, r, a = self.greatest, len(self.inputs), len(self.registers), len(self.gates)
        extra = "" if self.old else f" 1 {len(self.constraints)}"
        return f"{m} {i} {r} {1 if self.old else 0} {a}{extra}"

    @property
    def greatest(self) -> int:
        return len(self.inputs) + len(self.registers) + len(self.gates)

    @property
    def first_register(self) -> int:
        return 2 * (len(self.inputs) + 1)

    @property
    def symbols(self) -> list[str]:
        lines = [f"i{n} {name}" for n, name in enumerate(self.inputs)]
        lines += [f"l{n} {name}" for n, (name, _, _) in enumerate(self.registers)]
        return [*lines, f"{'o' if self.old else 'b'}0 violated"]


def _numbered(made: Circuit) -> _Numbered:
    roots = [*made.next.values(), *made.constraints, made.bad]
    order = [*made.inputs, *made.registers, *(2 * n for n in made.gates.cone(roots))]
    new = {FALSE: FALSE, **{literal: 2 * (n + 1) for n, literal in enumerate(order)}}

    def renamed(literal: int) -> int:
        return new[literal & ~1] | literal & 1

    gates = []
    for n in made.gates.cone(roots):
        a, b = (renamed(x) for x in made.gates.inputs[n] or ())
        gates.append((new[2 * n], max(a, b), min(a, b)))
    registers = [(name, renamed(made.next[r]), renamed(made.reset[r])) for r, name in made.registers.items()]
    old = not made.constraints and all(reset == FALSE for reset in made.reset.values())
    constraints = [renamed(c) for c in made.constraints]
    return _Numbered([*made.inputs.values()], registers, gates, constraints, renamed(made.bad), old)


def _register_lines(file: _Numbered, with_own: bool) -> list[str]:
    lines = []
    for n, (_, after, reset) in enumerate(file.registers):
        own = file.first_register + 2 * n
        lines.append(" ".join([*[str(own)] * with_own, str(after), *[str(reset)] * (reset != FALSE)]))
    return lines


def _outputs(file: _Numbered) -> list[str]:
    return [str(literal) for literal in (file.bad, *file.constraints)]


def ascii_text(made: Circuit) -> str:
    """The ASCII format."""
    file = _numbered(made)
    inputs = [str(2 * (n + 1)) for n in range(len(file.inputs))]
    gates = [f"{out} {a} {b}" for out, a, b in file.gates]
    body = [*inputs, *_register_lines(file, True), *_outputs(file), *gates, *file.symbols]
    return "\n".join([f"aag {file.header}", *body]) + "\n"


def binary(made: Circuit) -> bytes:
    """The binary format."""
    file = _numbered(made)
    lines = [f"aig {file.header}", *_register_lines(file, False), *_outputs(file)]
    packed = b"".join(_packed([out - a, a - b]) for out, a, b in file.gates)
    return "\n".join(lines).encode() + b"\n" + packed + ("\n".join(file.symbols) + "\n").encode()


def _packed(numbers: Sequence[int]) -> bytes:
    """Seven bits a byte, the lowest first, the top bit set on all but the last."""
    found = bytearray()
    for number in numbers:
        while number >= 0x80:
            found.append(number & 0x7F | 0x80)
            number >>= 7
        found.append(number)
    return bytes(found)
