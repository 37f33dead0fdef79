"""Readers of the exported files that share nothing with the writers: AIGER to run it, BTOR2 and VMT to unroll them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass


@dataclass
class Aiger:
    """A file in either form of AIGER 1.9: registers as (literal, next, power-up), gates as (output, input, input)."""

    inputs: list[int]
    registers: list[tuple[int, int, int]]
    bad: list[int]
    constraints: list[int]
    gates: list[tuple[int, int, int]]
    names: dict[str, str]

    def run(self, held: dict[int, bool], given: dict[int, bool]) -> Callable[[int], bool]:
        """One step: the value of any literal."""
        values = {0: False, **held, **given}

        def value(literal: int) -> bool:
            return values[literal & ~1] ^ bool(literal & 1)

        for out, a, b in self.gates:
            values[out] = value(a) and value(b)
        return value


def read_aiger(content: bytes) -> Aiger:
    header, _, rest = content.partition(b"\n")
    form, *counts = header.decode().split()
    m, i, r, o, a, b, c = [*map(int, counts), 0, 0][:7]
    binary = form == "aig"
    assert form in ("aig", "aag")
    assert not binary or m == i + r + a

    def lines(count: int) -> list[list[int]]:
        nonlocal rest
        found = []
        for _ in range(count):
            line, _, rest = rest.partition(b"\n")
            found.append([int(word) for word in line.split()])
        return found

    inputs = [2 * (n + 1) for n in range(i)] if binary else [line[0] for line in lines(i)]
    registers = []
    for n, line in enumerate(lines(r)):
        own, after, *reset = [2 * (i + n + 1), *line] if binary else line
        registers.append((own, after, reset[0] if reset else 0))
    bad = [line[0] for line in lines(o + b)]
    constraints = [line[0] for line in lines(c)]
    if binary:
        numbers, rest = _unpacked(rest, 2 * a)
        outs = [2 * (i + r + n + 1) for n in range(a)]
        gates = [(out, out - x, out - x - y) for out, x, y in zip(outs, numbers[::2], numbers[1::2], strict=True)]
    else:
        gates = [(x, y, z) for x, y, z in lines(a)]
    names = dict(line.split(" ", 1) for line in rest.decode().splitlines())
    for out, x, y in gates:
        assert out > x >= y, "a gate comes after what it reads, the greater first"
    return Aiger(inputs, registers, bad, constraints, gates, names)


def _unpacked(data: bytes, count: int) -> tuple[list[int], bytes]:
    numbers, place = [], 0
    for _ in range(count):
        number = shift = 0
        while True:
            byte = data[place]
            place += 1
            number |= (byte & 0x7F) << shift
            shift += 7
            if not byte & 0x80:
                break
        numbers.append(number)
    return numbers, data[place:]


# --- unrolling: is there a run of these steps? ---------------------------------------------------------------------


def btor2_unrolled(text: str, from_power_up: bool, last: int) -> str:
    """The lines copied once a step, as BTOR2 without states: bad at the last step, before it only if not from power-up.

    What is kept: a state is its init (or an input) at step 0, and the line of its next of the step before later.
    """
    lines = [line.split() for line in text.splitlines() if not line.startswith(";")]
    made: list[str] = []

    def add(*words: object) -> int:
        made.append(" ".join(map(str, (len(made) + 1, *words))))
        return len(made)

    before: dict[int, int] = {}
    init = {int(w[3]): int(w[4]) for w in lines if w[1] == "init"}
    following = {int(w[3]): int(w[4]) for w in lines if w[1] == "next"}
    for step in range(last + 1):
        now: dict[int, int] = {}
        for number, op, *rest in lines:
            n = int(number)
            if op == "sort":
                now[n] = before.get(n) or add(op, *rest)
            elif op in ("input", "state"):
                sort = now[int(rest[0])]
                if op == "state" and step:
                    now[n] = before[following[n]]
                elif op == "state" and from_power_up and n in init:
                    now[n] = now[init[n]]
                else:
                    now[n] = add("input", sort)
            elif op in ("constraint", "bad"):
                if op == "constraint" or step == last:
                    add("constraint", now[int(rest[0])])
                elif not from_power_up:
                    add("constraint", -now[int(rest[0])])
            elif op in ("constd", "uext", "sext", "slice"):
                whole = 1 if op == "constd" else 2
                now[n] = add(op, *(now[int(word)] for word in rest[:whole]), *rest[whole:])
            elif op not in ("init", "next", "output"):
                now[n] = add(op, *(now[int(word)] for word in rest))
        before = now
    return "\n".join(made) + "\n"


Sexpr = str | list["Sexpr"]


def commands(text: str) -> Iterator[Sexpr]:
    """The commands of an SMT-LIB text."""
    stack: list[list[Sexpr]] = [[]]
    for token in re.findall(r"\|[^|]*\||[()]|[^\s()|]+", re.sub(r"^;.*$", "", text, flags=re.M)):
        if token == "(":
            stack.append([])
        elif token == ")":
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(token)
    assert len(stack) == 1
    yield from stack[0]


def written(x: Sexpr, names: dict[str, str]) -> str:
    """The text, with some symbols replaced (no recursion: a claim may be deep)."""
    words, stack = [], [x]
    while stack:
        y = stack.pop()
        if isinstance(y, str):
            words.append(names.get(y, y))
        else:
            stack += [")", *reversed(y), "("]
    return " ".join(words)


def vmt_unrolled(text: str, from_power_up: bool, last: int) -> str:
    """An SMT-LIB question of the same kind as `btor2_unrolled`, from the annotations alone."""
    after: dict[str, str] = {}
    sorts: dict[str, Sexpr] = {}
    said: dict[str, Sexpr] = {}
    for command in commands(text):
        kind, name, *rest = command
        if kind == "declare-fun":
            sorts[str(name)] = rest[1]
        else:
            assert kind == "define-fun"
            bang, body, attribute, value = rest[2]
            assert bang == "!"
            if attribute == ":next":
                after[str(body)] = str(value)
            else:
                said[str(attribute)] = body
    assert set(said) == {":init", ":trans", ":invar-property"}
    assert set(sorts) == {*after, *after.values()}

    def at(what: str, step: int) -> str:
        names = {x: f"|{x.strip('|')}@{step}|" for x in after}
        names |= {y: f"|{x.strip('|')}@{step + 1}|" for x, y in after.items()}
        return written(said[what], names)

    lines = [f"(declare-const |{x.strip('|')}@{k}| {written(sorts[x], {})})" for k in range(last + 1) for x in after]
    asserted = [at(":init", 0)] if from_power_up else [at(":invar-property", k) for k in range(last)]
    asserted += [at(":trans", k) for k in range(last)]
    asserted.append(f"(not {at(':invar-property', last)})")
    return "\n".join([*lines, *(f"(assert {a})" for a in asserted), "(check-sat)\n"])


def shortest(found: Callable[[bool, int], bool], most: int) -> int | None:
    """Steps of the shortest counterexample, None once an induction of some depth shows that there is none.

    `found(from_power_up, last)`: whether a run violates the property at this step (and before that only if from
    power-up).
    """
    for last in range(most):
        if found(True, last):
            return last + 1
        if not found(False, last + 1):
            return None
    raise AssertionError(f"neither a counterexample nor an induction within {most} steps")


def wires(names: Sequence[str]) -> dict[str, list[int]]:
    """Positions of the bits of each full name, the lowest first."""
    found: dict[str, dict[int, int]] = {}
    for place, name in enumerate(names):
        path, _, bit = name.removesuffix("]").rpartition("[")
        found.setdefault(path, {})[int(bit)] = place
    return {path: [bits[i] for i in range(len(bits))] for path, bits in found.items()}
