"""Random systems with registers, inputs and points of reals among bits and words, and faults of all kinds in them."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

from safety import kinds
from safety.faults import Fault
from safety.inject.engine import Task
from safety.system import Clock, State, System
from safety.terms import real, select
from safety.terms.graph import BIT, REAL, Term, node, uint, variable
from tests.inject.native_systems import SHORT, Timing

LIMIT = 50
PARTS = (Fraction(1, 3), Fraction(1, 10), Fraction(-7, 8), Fraction(2), Fraction(-5, 9), Fraction(3, 4))


def number(pick: random.Random) -> Fraction:
    """Often one that is a double, and small enough to be met again."""
    return pick.choice([Fraction(pick.randint(-8, 8)), Fraction(pick.randint(-40, 40), 8), *PARTS])


class Pool:
    """Bits, words and reals that grow from each other; `products` go into no register, lest digits double."""

    def __init__(self, pick: random.Random, bits: list[Any], words: list[Any], reals: list[Any]) -> None:
        self.pick, self.bits, self.words, self.reals = pick, bits, words, reals
        self.products: list[Any] = []
        self.points: dict[str, Term] = {}

    def grow(self) -> None:
        pick = self.pick
        x, y, b = pick.choice(self.reals), pick.choice(self.reals), pick.choice(self.bits)
        w = pick.choice(self.words)
        kind = pick.randrange(12)
        if kind < 5:
            made = pick.choice([
                lambda: x + y, lambda: x - y, lambda: x * number(pick), lambda: select(b, x, y), lambda: w.real() / 8,
                lambda: select(b, x, real(number(pick))), lambda: x + number(pick), lambda: number(pick) - x,
                lambda: w.int().real() - x,
            ])()  # fmt: skip
            self.reals.append(self._pointed(made, 0.4))
        elif kind < 6:
            self.products.append(self._pointed(x * y, 0.2))
        elif kind < 10:
            z = pick.choice([y, real(number(pick)), *self.products])
            made = pick.choice([lambda: x == y, lambda: x < z, lambda: x <= z, lambda: z < x, lambda: x <= y + 1])()
            self.bits.append(self._pointed(made, 0.3))
        elif kind < 11:
            self.bits.append(pick.choice([b & pick.choice(self.bits), b ^ pick.choice(self.bits), ~b]))
        else:
            self.words.append(self._pointed((w + b.word()).low(8), 0.4))

    def _pointed(self, term: Any, share: float) -> Any:
        if self.pick.random() < share:
            name = f"p{len(self.points)}"
            term = self.points[name] = node("point", (term,), name, term.sort)
        return term


def held(x: Any) -> Any:
    """Saturated, so that it stays where numbers are met again."""
    return select(x > LIMIT, real(LIMIT), select(x < -LIMIT, real(-LIMIT), x))


def random_real_system(seed: int, size: int = 40) -> System:
    """A system with registers, inputs and points of all sorts; signals `w0`, `w1`, ... are bits."""
    pick = random.Random(seed)
    bits: list[Any] = [variable(f"part0.b{i}", BIT) for i in range(2)]
    words: list[Any] = [variable("part1.w", uint(8))]
    reals: list[Any] = [variable(f"part{i % 2}.r{i}", REAL) for i in range(3)]
    registers = [*bits, *words, *reals]
    inputs = {"x0": variable("x0", BIT), "x1": variable("x1", uint(6)), "x2": variable("x2", REAL)}
    pool = Pool(pick, [*bits, inputs["x0"]], [*words, inputs["x1"]], [*reals, inputs["x2"]])
    for _ in range(size):
        pool.grow()
    states = []
    for var in registers:
        if var.sort == REAL:
            states.append(State(var, held(pick.choice(pool.reals[-8:])), number(pick)))
        elif var.sort == BIT:
            states.append(State(var, pick.choice(pool.bits[-8:]), False))
        else:
            following: Any = pick.choice(pool.words)
            states.append(State(var, following if following.sort == var.sort else following.widen(8), 3))
    shown = pick.sample(pool.bits[3:], 4)  # what compares with a register shows it
    wires = {f"w{i}": bit ^ (reals[i % 3] < number(pick)) for i, bit in enumerate(shown)}
    parts = {"part0": "Part", "part1": "Part"}
    return System("random", Clock(event="tick"), tuple(states), inputs, wires, pool.points, {}, parts)


def random_real_task(seed: int, timing: Timing = SHORT, atoms: int = 10) -> Task:
    """A task on such a system; half of its faults at reals."""
    system, pick = random_real_system(seed), random.Random(seed)
    rows = [{"x0": pick.random() < 0.5, "x1": pick.randrange(64), "x2": number(pick)} for _ in range(timing.frames)]
    found = [
        fault(pick, name, system.points[name].sort.kind, str(i))
        for i, name in enumerate(pick.choices(list(system.points), k=atoms))
    ]
    return Task(system, tuple(found), ("w0", "w1", "w3"), ("w1", "w2"), timing, rows.__getitem__, {})


def fault(pick: random.Random, name: str, kind: str, label: str) -> Fault:
    """A fault at a point of this kind of sort, or at a part."""
    if pick.random() < 0.1:
        part = pick.choice([kinds.clock_stop(), kinds.clock_fast(2), kinds.power_dip()])
        return Fault(part, [pick.choice(["part0", "part1"])], name=label)
    some = [kinds.frozen(), kinds.delayed(2), kinds.byzantine()]
    if kind == "real":
        some += [kinds.offset(number(pick) or 1), kinds.drift(Fraction(1, 7)), kinds.noise(Fraction(1, 3))]
        some += [kinds.dead(), kinds.reads(number(pick))]
    elif kind == "bit":
        some += [kinds.stuck(1), kinds.stuck(0), kinds.flip()]
    else:
        some += [kinds.stuck(1, 0), kinds.flip(1), kinds.offset(1)]
    chosen = pick.choice(some)
    values = None
    if chosen.name == "byzantine":
        values = {"bit": [True, False], "uint": [1, 5, 7], "real": [Fraction(1, 3), Fraction(2), Fraction(-9, 7)]}[kind]
    return Fault(chosen, [name], name=label, values=None if values is None else {name: values})


def braking_train(frames: int = 900) -> Task:
    """A train that drives up to a stop: speed and position in reals, the braking curve compared by squares.

    Steps of 1/10 s; the odometer counts 1/30 m, the limit falls with the distance left at 4/5 m/s^2.
    """
    speed: Any = variable("speed", REAL)
    place: Any = variable("place", REAL)
    measured: Any = variable("odometer.place", REAL)
    brakes: Any = variable("computer.brakes", BIT)
    step, end = Fraction(1, 10), Fraction(1000)

    def point(name: str, term: Any) -> Any:
        return node("point", (term,), name, term.sort)

    seen = point("seen speed", speed)
    counted = point("odometer", measured)
    command = point("command", brakes)
    left = point("distance left", real(end) - counted)
    over = (seen * seen > left * Fraction(8, 5)) | (left < 0)
    under = seen * seen < left * Fraction(7, 5)
    after = select(command, speed - Fraction(1) * step, speed + Fraction(7, 10) * step)
    bounded = select(after < 0, real(0), select(after > Fraction(100, 3), real(Fraction(100, 3)), after))
    states = (
        State(speed, bounded, Fraction(0)),
        State(place, place + speed * step, Fraction(0)),
        State(measured, measured + point("pulses", seen * step), Fraction(0)),
        State(brakes, point("curve", over) | (brakes & ~under), False),
    )
    wires = {"passed": place > end, "stopped": (speed <= 0) & (place > 1), "fast": speed > 34}
    points = {p.attr: p for p in (seen, counted, command, left)}
    points |= {"pulses": states[2].next.args[1], "curve": states[3].next.args[0]}
    system = System(
        "train", Clock(period=step), states, {}, wires, points, {}, {"odometer": "Part", "computer": "Part"}
    )
    atoms = [Fault(kind, [name]) for name in ("seen speed", "odometer", "distance left", "pulses") for kind in (
        kinds.offset(Fraction(1, 3)), kinds.offset(-2), kinds.drift(Fraction(-1, 30)), kinds.frozen(), kinds.dead(),
        kinds.noise(Fraction(1, 2)),
    )]  # fmt: skip
    atoms += [Fault(kind, [name]) for name in ("command", "curve") for kind in (kinds.stuck(0), kinds.stuck(1))]
    return Task(
        system,
        tuple(atoms),
        ("fast", "stopped"),
        ("passed", "stopped"),
        Timing(0, frames, frames, 1),
        lambda frame: {},
        {},
    )
