"""Small random systems with points everywhere, to hold what is clever against what is plain."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any, cast

from safety.faults import ANY_TIME, TRANSIENT, Fault, delayed, flip, frozen, stuck
from safety.inject.engine import Task, Timing
from safety.kinds import bridge, wired_or
from safety.system import Clock, State, System
from safety.terms import Bit, UInt, implies, select, word
from safety.terms.graph import BIT, Term, node, uint, variable
from safety.terms.values import bit

WIDTH, FRAMES = 3, 12
LOOKS = ("look 0", "look 1")


def random_system(pick: random.Random) -> System:
    """Three registers, two inputs, two signals, and some thirty terms, most of them points; two points on constants."""
    points = {name: node("point", (c,), name, c.sort) for name, c in (("one", bit(True)), ("five", word(5, WIDTH)))}
    wires: list[Term] = [*(variable(name, BIT) for name in ("p", "q", "x")), points["one"]]
    words: list[Term] = [*(variable(name, uint(WIDTH)) for name in ("w", "y")), points["five"]]

    def wire() -> Bit:
        return cast(Bit, pick.choice(wires[-8:] if pick.random() < 0.7 else wires))

    def number() -> UInt:
        return cast(UInt, pick.choice(words[-5:] if pick.random() < 0.7 else words))

    def part() -> UInt:
        n = number()
        return n.slice(1, 2).concat(n.low(1)) if pick.random() < 0.5 else wire().word().concat(number().low(2))

    new_wires = [
        lambda: wire() & wire(), lambda: wire() | wire(), lambda: wire() ^ wire(), lambda: ~wire(),
        lambda: implies(wire(), wire()), lambda: number().bit(pick.randrange(WIDTH)), lambda: number() < number(),
    ]  # fmt: skip
    new_words = [
        lambda: number() & number(), lambda: number() | number(), lambda: number() ^ number(), part,
        lambda: (number() + wire().word()).low(WIDTH), lambda: select(wire(), number(), number()),
        lambda: number().widen(WIDTH + 1).slice(0, WIDTH),
    ]  # fmt: skip
    for k in range(30):
        made: Term = pick.choice(new_wires)() if k % 2 else pick.choice(new_words)()
        if pick.random() < 0.7 and not made.is_const:
            made = points[f"t{k}"] = node("point", (made,), f"t{k}", made.sort)
        (wires if made.sort == BIT else words).append(made)
    registers = [(wires[0], False), (wires[1], True), (words[0], 2)]
    nexts = [wire(), wire(), number()]
    states = tuple(State(var, new, start) for (var, start), new in zip(registers, nexts, strict=True))
    signals = dict(zip(LOOKS, (wire(), wire()), strict=True))
    return System("random", Clock(event="tick"), states, {"x": wires[2], "y": words[1]}, signals, points, {}, {})


def bit_faults(system: System) -> Iterator[Fault]:
    """Every bit of every point stuck and inverted, from the start, from a step on and for a while."""
    for point, term in system.points.items():
        for number in [None] if term.sort == BIT else range(WIDTH):
            for kind in (stuck(0, number), stuck(1, number), flip(number)):
                yield Fault(kind, [point])
        yield Fault(stuck(0), [point], name=f"{point} again")
        yield Fault(flip(), [point], ANY_TIME, at=4)
        yield Fault(stuck(1), [point], TRANSIENT, at=3, ticks=4)


def other_faults(pick: random.Random, system: System) -> Iterator[Fault]:
    """Some faults with memory, of two points apart and of two points that touch."""
    for number, kind in enumerate((frozen(), delayed(1), stuck(0), bridge(late=True), wired_or(late=True))):
        two = [p for p in system.points if system.points[p].sort == BIT]
        if len(two) > 1:
            chosen = pick.sample(two, 2) if number > 1 else [pick.choice(two)]
            yield Fault(kind, chosen, ANY_TIME, at=2, name=f"other {number}")


def task_of(system: System, faults: list[Fault], pick: random.Random) -> Task:
    """Twelve frames of random inputs; both signals counted and watched."""
    rows = [{"x": pick.random() < 0.5, "y": pick.randrange(2**WIDTH)} for _ in range(FRAMES)]
    inputs: Any = rows.__getitem__
    return Task(system, tuple(faults), LOOKS, LOOKS, Timing(2, FRAMES - 2, 5, 1), inputs, {})
