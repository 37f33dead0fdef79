"""Families that count: a modulus, an accumulator, a divider, sums against counts, a rate that is a parameter."""

import math
from random import Random
from typing import Annotated, NamedTuple

from safety.model import ANY, Model, parameter, power_up
from safety.prove.claims import Formula, Scenario, Seen, age, total
from safety.terms import Bit, UInt, implies, select, word
from tests.generated.case import Case, bits, fails, holds, size


class Pulse(NamedTuple):
    out: Bit


class Amount(NamedTuple):
    put: UInt


def modulus(rng: Random) -> list[Case]:
    """Counting in steps modulo m reaches just the values that differ from the start by a multiple of the gcd."""
    common = rng.randint(2, 6)
    laps = size(rng, 1, 8, 20_000)
    stride = rng.choice([s for s in range(laps) if math.gcd(s, laps) == 1] if laps < 50 else [1, laps - 1])
    m, k = common * laps, common * stride
    start = rng.randrange(m)
    width = bits(m - 1)

    class Wheel(Model, event="tick"):
        n: Annotated[UInt, width] = power_up(start)

        def step(self, go: Bit) -> "Wheel":
            ahead = self.n + k
            turned = select(ahead >= m, (ahead - m).low(width), ahead.low(width))
            return Wheel(n=select(go, turned, self.n))

    missed = (start + rng.randrange(1, common)) % common + common * rng.randrange(laps)
    laps_on = rng.randrange(laps)
    reached = (start + laps_on * common) % m
    ticks = laps_on * pow(stride, -1, laps) % laps if laps > 1 else 0
    top = m - common + start % common
    to_top = (top - start) // common * pow(stride, -1, laps) % laps if laps > 1 else 0
    if rng.random() < 0.5:
        return [
            holds(Wheel, lambda s: s.n != missed),
            fails(Wheel, lambda s: s.n != reached, Scenario(ticks + 1, {"go": True})),
        ]
    return [
        holds(Wheel, lambda s: s.n <= top),
        fails(Wheel, lambda s: s.n < top, Scenario(to_top + 1, {"go": True})),
    ]


def accumulator(rng: Random) -> list[Case]:
    """A phase accumulator of w bits carries floor((phase + sum) / 2^w) times: after so many ticks, not before."""
    width, pulses = size(rng, 1, 3, 12), rng.randint(1, 6)
    period = 1 << width
    rate = rng.choice([1, rng.randrange(1, period), period - 1, max(1, period // 2)])

    class Accumulator(Model, event="tick"):
        phase: Annotated[UInt, width] = power_up(ANY)

        def step(self, k: Annotated[UInt, width]) -> "tuple[Accumulator, Pulse]":
            ahead = self.phase + k
            return Accumulator(phase=ahead.low(width)), Pulse(out=ahead.bit(width))

    if rng.random() < 0.5:
        ticks = -(-pulses * period // rate)
        slow = Scenario(ticks, {"k": rate}, {"phase": 0})
        return [
            holds(
                Accumulator, lambda s: implies(age(s.k >= rate, ticks) >= ticks, total(s.out.word(), pulses) == pulses)
            ),
            fails(
                Accumulator,
                lambda s: implies(age(s.k >= rate, ticks) >= ticks - 1, total(s.out.word(), pulses) == pulses),
                slow,
            ),
        ]
    ticks = -(-(pulses * period - (period - 1)) // rate)
    fast = Scenario(ticks + 1, {"k": rate}, {"phase": period - 1})
    return [
        holds(
            Accumulator,
            lambda s: implies(total(s.out.word(), pulses) == pulses, total(word(1, 1), ticks + 1) >= ticks),
            given=lambda s: s.k <= rate,
        ),
        fails(
            Accumulator,
            lambda s: implies(total(s.out.word(), pulses) == pulses, total(word(1, 1), ticks + 1) > ticks),
            fast,
            given=lambda s: s.k <= rate,
        ),
    ]


def divider(rng: Random) -> list[Case]:
    """A divider by n that starts at n0 gives its m-th pulse with the (m n - n0)-th; a reset takes back what it had."""
    n, pulses = size(rng, 2, 6, 2000), rng.randint(1, 3)
    start = rng.choice([0, rng.randrange(n)])
    width, needed = bits(n - 1), pulses * n - start

    def divide(resets: bool) -> type[Model]:
        class Divider(Model, event="tick"):
            count: Annotated[UInt, width] = power_up(start)

            def step(self, pulse: Bit, reset: Bit) -> "tuple[Divider, Pulse]":
                full, back = self.count == n - 1, reset & resets
                ahead = select(pulse, select(full, 0, (self.count + 1).low(width)), self.count)
                return Divider(count=select(back, 0, ahead)), Pulse(out=pulse & full & ~back)

        return Divider

    def gives(least: int) -> Formula:
        return lambda s: implies(total(s.pulse.word(), needed) >= least, total(s.out.word(), pulses) == pulses)

    def gives_in_a_row(least: int) -> Formula:
        unbroken = pulses * n
        return lambda s: implies(age(s.pulse & ~s.reset, unbroken) >= least, total(s.out.word(), pulses) == pulses)

    if rng.random() < 0.5:
        return [
            holds(divide(False), gives(needed)),
            fails(divide(False), gives(needed - 1), Scenario(needed, {"pulse": True})),
        ]
    forgotten = Scenario(needed + 1, {"pulse": True, "reset": lambda k: k == 0})
    return [holds(divide(True), gives_in_a_row(pulses * n)), fails(divide(True), gives(needed), forgotten)]


def sums(rng: Random) -> list[Case]:
    """A sum of words of at most x needs sum / x of them; a register that saturates is the sum counted up to its end."""
    most = rng.choice([1, rng.randint(1, 6), rng.randint(1, 60)])
    cap = (1 << size(rng, 1, 5, 11)) - 1
    width, wide = bits(most), bits(cap)

    def store(wraps: bool, start: int) -> type[Model]:
        class Store(Model, event="tick"):
            n: Annotated[UInt, wide] = power_up(start)

            def step(self, on: Bit, x: Annotated[UInt, width]) -> "tuple[Store, Amount]":
                put = select(on, x, 0)
                more = self.n + put
                return Store(n=more.low(wide) if wraps else more.sat(wide)), Amount(put=put)

        return Store

    def bounded(s: Seen) -> Bit:
        """No word exceeds the greatest."""
        return s.x <= most

    full = {"on": True, "x": most}
    if rng.random() < 0.5:
        words = -(-cap // most)

        def needs(least: int) -> Formula:
            return lambda s: implies(total(s.put, cap) == cap, total(s.on.word(), words + 1) >= least)

        return [
            holds(store(False, 0), needs(words), given=bounded),
            fails(store(False, 0), needs(words + 1), Scenario(words + 1, full), given=bounded),
        ]
    wraps = rng.random() < 0.5
    wrong = store(True, 0) if wraps else store(False, 1)
    return [
        holds(store(False, 0), lambda s: s.n == total(s.put, cap), given=bounded),
        fails(wrong, lambda s: s.n == total(s.put, cap), Scenario(cap // most + 2, full), given=bounded),
    ]


def rate(rng: Random) -> list[Case]:
    """An accumulator whose word is left open from `low` up gives its pulses in the time of `low`; if 0, never."""
    width, pulses = size(rng, 2, 3, 12), rng.randint(1, 4)
    period = 1 << width
    low = rng.choice([0, 1, rng.randrange(1, period), rng.randrange(1, period)])
    high, start = rng.randrange(max(low, 1), period), rng.choice([0, rng.randrange(period)])

    class Rate(Model, event="tick"):
        k: Annotated[UInt, width] = parameter(high, unit="1", within=(low, high), source="[A]")
        phase: Annotated[UInt, width] = power_up(start)

        def step(self) -> "tuple[Rate, Pulse]":
            ahead = self.phase + self.k
            return Rate(phase=ahead.low(width)), Pulse(out=ahead.bit(width))

    def gives(ticks: int, least: int) -> Formula:
        return lambda s: implies(total(word(1, 1), ticks) == ticks, total(s.out.word(), pulses) >= least)

    open_ = {"symbolic": ["k"]}
    if low == 0:
        ticks = size(rng, 1, 20, 5000)
        faster = -(-(period - start) // high)

        def moving(s: Seen) -> Bit:
            """The word is not 0."""
            return s.k == high

        return [
            holds(Rate, gives(faster, 1), given=moving, **open_),
            fails(Rate, gives(ticks, 1), Scenario(ticks + 1, start={"k": 0}), **open_),
        ]
    ticks = -(-(pulses * period - start) // low)
    if ticks < 2:
        return [holds(Rate, gives(ticks, pulses), **open_)]
    slow = Scenario(ticks, start={"k": low})
    return [holds(Rate, gives(ticks, pulses), **open_), fails(Rate, gives(ticks - 1, pulses), slow, **open_)]
