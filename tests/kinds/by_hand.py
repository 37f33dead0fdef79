"""What each fault kind does, written down a second time: as a rule on whole courses of values, without any machine.

`rule(t, acts, given, shown)` says whether what is shown at step t is allowed, from when the fault acts, what the
equipment is given at every step, and what was shown before.  Nothing here is taken from `safety.kinds` but the names.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Any

from safety.kinds import (
    Kind,
    bridge,
    byzantine,
    clock_fast,
    clock_glitch,
    clock_slow,
    clock_stop,
    dead,
    delayed,
    drift,
    extra,
    flip,
    frozen,
    intermittent,
    memory_flip,
    missing,
    noise,
    offset,
    open_circuit,
    oscillating,
    power_dip,
    reads,
    slow_to_operate,
    slow_to_release,
    stuck,
    swapped,
    upset,
    welded,
    wired_and,
    wired_or,
)
from safety.model import Model, point, power_up
from safety.system import ANY
from safety.terms import U2, Bit, Int, Real

Whole = Annotated[Int, (-3, 3)]
HALF = Fraction(1, 2)


class Cell(Model, event="tick"):
    """Counts up, and keeps a value of its own."""

    n: U2 = power_up(1)
    kept: U2 = power_up(ANY)

    def step(self, add: U2) -> Cell:
        return Cell(n=(self.n + add).low(2), kept=self.kept)


class Desk(Model, event="tick"):
    """Points of every sort, each showing an input, and a part with registers."""

    cell: Cell

    def step(self, w: Bit, v: Bit, x: U2, y: U2, i: Whole, r: Real, add: U2) -> tuple[Desk, Bit]:
        point("wire", w), point("line", v), point("word", x), point("byte", y), point("whole", i), point("real", r)
        return Desk(cell=self.cell.step(add)), w


INPUT = {"wire": "w", "line": "v", "word": "x", "byte": "y", "whole": "i", "real": "r", "cell.n": "add"}
BITS, WORDS, WHOLES, REALS = [False, True], [0, 1, 2, 3], [*range(-3, 4)], [Fraction(0), HALF, Fraction(-2)]
VALUES = {"w": BITS, "v": BITS, "x": WORDS, "y": WORDS, "i": WHOLES, "r": REALS, "add": WORDS}
IDLE = {"w": False, "v": False, "x": 0, "y": 0, "i": 0, "r": Fraction(0), "add": 0}

Course = Sequence[Any]
Rule = Callable[[int, Sequence[bool], Course, Course], bool]


@dataclass(frozen=True)
class Case:
    """A kind, where it is put, which inputs are given and which signals shown, and its rule."""

    kind: Kind
    at: tuple[str, ...]
    given: tuple[str, ...]
    shown: tuple[str, ...]
    values: Sequence[Any]  # that may be shown of each signal, those that the rule forbids among them
    rule: Rule

    def __str__(self) -> str:
        return f"{self.kind} at {self.at[0]}"


def allowed(case: Case, acts: Sequence[bool], given: Course, shown: Course) -> bool:
    """Whether a course of values is one that the kind allows."""
    return all(case.rule(t, acts, given, shown) for t in range(len(shown)))


def patterns(onset: str, ticks: int | None, length: int) -> Iterator[tuple[bool, ...]]:
    """When a fault that is present may act, by its onset."""
    fits: dict[str, Callable[[str], bool]] = {
        "from start": lambda text: "0" not in text,
        "any time": lambda text: "10" not in text,
        "transient": lambda text: "0" not in text.strip("0") and text.count("1") <= (ticks or 0),
        "intermittent": lambda text: True,
    }
    for acts in itertools.product([False, True], repeat=length):
        if fits[onset]("".join(str(int(a)) for a in acts)):
            yield acts


def place(t: int, acts: Sequence[bool]) -> int:
    """How many steps before t the fault has been acting without a break (0: it begins at t)."""
    begun = t
    while begun and acts[begun - 1]:
        begun -= 1
    return t - begun


def while_active(seen: Callable[[int, Sequence[bool], Course], Any]) -> Rule:
    """The rule of a kind whose value follows from what is given: that while the fault acts, what is given else."""
    return lambda t, acts, given, shown: shown[t] == (seen(t, acts, given) if acts[t] else given[t])


def clamped(value: Any, low: int, high: int) -> Any:
    return min(max(value, low), high)


def _frozen(t: int, acts: Sequence[bool], given: Course, shown: Course) -> bool:
    healthy = [k for k in range(t) if not acts[k]]
    if not acts[t]:
        return bool(shown[t] == given[t])
    return bool(shown[t] == given[healthy[-1]]) if healthy else t == 0 or shown[t] == shown[0]


def _missing(pulses: int, every: int | None) -> Rule:
    def seen(t: int, acts: Sequence[bool], given: Course) -> Any:
        while_acting, before = sum(acts[k] and given[k] for k in range(t)), sum(given[:t])
        lost = while_acting < pulses if every is None else before % every >= every - pulses
        return given[t] and not lost

    return while_active(seen)


def _noise(most: Any, low: Any, high: Any) -> Rule:
    def rule(t: int, acts: Sequence[bool], given: Course, shown: Course) -> bool:
        if not acts[t]:
            return bool(shown[t] == given[t])
        return bool(max(given[t] - most, low) <= shown[t] <= min(given[t] + most, high))

    return rule


def _register(after: Callable[[int, Sequence[bool], int, int], int]) -> Rule:
    """The rule of a kind at the register n: what it holds after a step in which the fault acts."""

    def rule(t: int, acts: Sequence[bool], given: Course, shown: Course) -> bool:
        if t == 0:
            return bool(shown[0] == 1)
        k, n, add = t - 1, shown[t - 1], given[t - 1]
        return bool(shown[t] == (after(k, acts, n, add) % 4 if acts[k] else (n + add) % 4))

    return rule


def _dip_of_any(t: int, acts: Sequence[bool], given: Course, shown: Course) -> bool:
    return t == 0 or acts[t - 1] or shown[t] == shown[t - 1]


def _both(seen: Callable[[Any, Any], set[Any]]) -> Rule:
    """The rule of a kind at two points that both show one of some values."""

    def rule(t: int, acts: Sequence[bool], given: Course, shown: Course) -> bool:
        if not acts[t]:
            return bool(shown[t] == given[t])
        return bool(shown[t][0] == shown[t][1] and shown[t][0] in seen(*given[t]))

    return rule


def _mixtures(a: int, b: int) -> set[int]:
    return {v for v in range(4) if not (v ^ a) & (v ^ b)}


def _late_or(t: int, acts: Sequence[bool], given: Course, shown: Course) -> bool:
    (a, b), (c, d) = given[t], given[t - 1] if t else (False, False)
    return bool(shown[t] == ((a or d, b or c) if acts[t] else (a, b)))


def _cases() -> Iterator[Case]:
    def wire(kind: Kind, rule: Rule) -> Case:
        return Case(kind, ("wire",), ("w",), ("wire",), BITS, rule)

    def word(kind: Kind, rule: Rule) -> Case:
        return Case(kind, ("word",), ("x",), ("word",), WORDS, rule)

    def whole(kind: Kind, rule: Rule) -> Case:
        return Case(kind, ("whole",), ("i",), ("whole",), WHOLES, rule)

    def real(kind: Kind, rule: Rule) -> Case:
        quarters = [Fraction(n, 4) for n in range(-17, 7)]
        return Case(kind, ("real",), ("r",), ("real",), quarters, rule)

    def wires(kind: Kind, rule: Rule) -> Case:
        return Case(kind, ("wire", "line"), ("w", "v"), ("wire", "line"), BITS, rule)

    def words(kind: Kind, rule: Rule) -> Case:
        return Case(kind, ("word", "byte"), ("x", "y"), ("word", "byte"), WORDS, rule)

    def register(kind: Kind, after: Callable[[int, Sequence[bool], int, int], int]) -> Case:
        return Case(kind, ("cell",), ("add",), ("cell.n",), WORDS, _register(after))

    yield wire(stuck(0), while_active(lambda t, acts, g: False))
    yield wire(stuck(1), while_active(lambda t, acts, g: True))
    yield word(stuck(1, bit=1), while_active(lambda t, acts, g: g[t] % 2 + 2))
    yield word(stuck(0, bit=(0, 1)), while_active(lambda t, acts, g: 0))
    yield wire(flip(), while_active(lambda t, acts, g: not g[t]))
    yield word(flip(bit=0), while_active(lambda t, acts, g: g[t] + 1 - 2 * (g[t] % 2)))
    yield word(upset(0, 1), while_active(lambda t, acts, g: 3 - g[t]))
    yield wire(open_circuit(), while_active(lambda t, acts, g: False))
    yield wire(welded(), while_active(lambda t, acts, g: True))
    yield word(reads(2), while_active(lambda t, acts, g: 2))
    yield real(reads(HALF), while_active(lambda t, acts, g: HALF))
    yield whole(dead(), while_active(lambda t, acts, g: 0))
    yield wire(oscillating(2), while_active(lambda t, acts, g: place(t, acts) % 4 < 2))
    yield wire(byzantine(), lambda t, acts, g, s: acts[t] or s[t] == g[t])
    yield wire(frozen(), _frozen)
    yield word(frozen(), _frozen)
    yield wire(delayed(2), while_active(lambda t, acts, g: t >= 2 and g[t - 2]))
    yield whole(delayed(1), while_active(lambda t, acts, g: g[t - 1] if t else 0))
    yield wire(slow_to_operate(2), while_active(lambda t, acts, g: t >= 2 and all(g[t - 2 : t + 1])))
    yield wire(slow_to_release(2), while_active(lambda t, acts, g: any(g[max(t - 2, 0) : t + 1])))
    yield wire(intermittent(stuck(1), 2, 3), while_active(lambda t, acts, g: g[t] or place(t, acts) % 3 < 2))
    twice = intermittent(intermittent(stuck(1), 1, 3), 2, 3)
    yield wire(twice, while_active(lambda t, acts, g: g[t] or place(t, acts) % 3 == 0))
    yield wire(missing(2), _missing(2, None))
    yield wire(missing(1, every=2), _missing(1, 2))
    yield wire(extra(), while_active(lambda t, acts, g: g[t] or place(t, acts) == 0))
    yield wire(extra(every=2), while_active(lambda t, acts, g: g[t] or place(t, acts) % 2 == 0))
    yield word(offset(-2), while_active(lambda t, acts, g: clamped(g[t] - 2, 0, 3)))
    yield real(offset(HALF), while_active(lambda t, acts, g: g[t] + HALF))
    yield word(drift(1), while_active(lambda t, acts, g: clamped(g[t] + place(t, acts) + 1, 0, 3)))
    yield whole(drift(-HALF), while_active(lambda t, acts, g: clamped(g[t] - (place(t, acts) + 1) // 2, -3, 3)))
    yield real(drift(-HALF), while_active(lambda t, acts, g: g[t] - HALF * (place(t, acts) + 1)))
    yield word(noise(1), _noise(1, 0, 3))
    yield whole(noise(2, seed=7), _noise(2, -3, 3))
    yield real(noise(HALF), _noise(HALF, -1000, 1000))
    yield wires(wired_and(), _both(lambda a, b: {a and b}))
    yield wires(wired_or(), _both(lambda a, b: {a or b}))
    yield words(wired_or(), _both(lambda a, b: {a | b}))
    yield wires(wired_or(late=True), _late_or)
    yield wires(bridge(0), _both(lambda a, b: {a}))
    yield wires(bridge(1), _both(lambda a, b: {b}))
    yield wires(bridge(), _both(lambda a, b: {a, b}))
    yield words(bridge(), _both(_mixtures))
    yield wires(swapped(), while_active(lambda t, acts, g: g[t][::-1]))
    yield register(clock_stop(), lambda k, acts, n, add: n)
    yield register(clock_slow(2), lambda k, acts, n, add: n if place(k, acts) % 2 else n + add)
    yield register(clock_fast(3), lambda k, acts, n, add: n + 3 * add)
    yield register(clock_fast(2, every=2), lambda k, acts, n, add: n + (1 + place(k, acts) % 2) * add)
    yield register(clock_glitch(2), lambda k, acts, n, add: n + (1 if place(k, acts) else 2) * add)
    yield register(clock_glitch(0), lambda k, acts, n, add: n + add if place(k, acts) else n)
    yield register(power_dip(), lambda k, acts, n, add: 1)
    yield Case(power_dip(), ("cell.kept",), ("add",), ("cell.kept",), WORDS, _dip_of_any)
    yield register(memory_flip(bit=1), lambda k, acts, n, add: (n + add) % 4 ^ 2)
    yield register(intermittent(clock_stop(), 1, 2), lambda k, acts, n, add: n + add if place(k, acts) % 2 else n)


CASES = tuple(_cases())
