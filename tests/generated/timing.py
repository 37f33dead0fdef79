"""Families of timers: watchdog, monostable, hold-off, reset in time, and a window that a generator has to meet."""

import math
from random import Random
from typing import Annotated, NamedTuple

from safety.model import Model, power_up
from safety.prove.claims import Formula, Scenario, Seen, age, once, previous
from safety.terms import Bit, UInt, implies, select
from tests.generated.case import Case, bits, fails, holds, silent, size


class Out(NamedTuple):
    out: Bit


def watchdog(rng: Random) -> list[Case]:
    """A watchdog speaks after `dead` ticks without a kick; what it has at power-up makes it early, never late."""
    dead = size(rng, 2, 12, 100_000)
    start = rng.choice([0, 0, rng.randrange(dead + 1)])
    width = bits(dead)

    class Watchdog(Model, event="tick"):
        t: Annotated[UInt, width] = power_up(start)

        def step(self, kick: Bit) -> "tuple[Watchdog, Out]":
            late = self.t >= dead
            older = select(late, self.t, (self.t + 1).low(width))
            return Watchdog(t=select(kick, 0, older)), Out(out=late)

    def speaks(ticks: int, upto: int) -> Formula:
        return lambda s: implies(age(~s.kick, upto) >= ticks, s.out)

    def rightly(ticks: int) -> Formula:
        return lambda s: implies(s.out, age(~s.kick, dead + 1) >= ticks)

    kind = rng.randrange(3)
    kicked = Scenario(dead + 1, {"kick": lambda k: k == 0})
    if kind == 0:
        return [holds(Watchdog, speaks(dead, dead)), fails(Watchdog, speaks(dead - 1, dead), kicked)]
    if kind == 1:
        first = dead - start
        return [holds(Watchdog, rightly(first)), fails(Watchdog, rightly(first + 1), Scenario(first + 1))]
    return [holds(Watchdog, speaks(dead, dead + 1)), silent(Watchdog, speaks(dead, dead - 1))]


def monostable(rng: Random) -> list[Case]:
    """A monostable that can be triggered again is on for `length` ticks after the last trigger, not longer."""
    length = size(rng, 2, 12, 60_000)
    width = bits(length)

    def mono(again: bool) -> type[Model]:
        class Monostable(Model, event="tick"):
            t: Annotated[UInt, width] = power_up(0)

            def step(self, trigger: Bit) -> "tuple[Monostable, Out]":
                taken = trigger if again else trigger & (self.t == 0)
                return Monostable(t=select(taken, length, self.t.sat_sub(1))), Out(out=self.t > 0)

        return Monostable

    def off_in(ticks: int) -> Formula:
        return lambda s: implies(s.out, age(~s.trigger, length) < ticks)

    def on_for(ticks: int) -> Formula:
        return lambda s: implies(once(s.trigger) & (age(~s.trigger, length + 1) < ticks), s.out)

    pulse = {"trigger": lambda k: k == 0}
    if rng.random() < 0.4:
        return [holds(mono(True), off_in(length)), fails(mono(True), off_in(length - 1), Scenario(length + 1, pulse))]
    if rng.random() < 0.5:
        return [holds(mono(True), on_for(length)), fails(mono(True), on_for(length + 1), Scenario(length + 2, pulse))]
    return [
        holds(mono(True), on_for(length)),
        fails(mono(False), on_for(length), Scenario(length + 2, {"trigger": True})),
    ]


def hold_off(rng: Random) -> list[Case]:
    """An input counts once it has stood for `hold` ticks: then surely, and never before."""
    hold = size(rng, 2, 10, 30_000)
    width = bits(hold)

    class HoldOff(Model, event="tick"):
        y: Bit = power_up(False)
        t: Annotated[UInt, width] = power_up(0)

        def step(self, x: Bit) -> "HoldOff":
            differs = x ^ self.y
            done = differs & (self.t >= hold - 1)
            return HoldOff(y=self.y ^ done, t=select(differs & ~done, (self.t + 1).low(width), 0))

    def follows(ticks: int) -> Formula:
        return lambda s: implies(age(s.x, hold) >= ticks, s.y)

    def rises(ticks: int) -> Formula:
        return lambda s: implies(s.y & ~previous(s.y, False), age(s.x, hold + 1) >= ticks)

    if rng.random() < 0.5:
        return [holds(HoldOff, follows(hold)), fails(HoldOff, follows(hold - 1), Scenario(hold, {"x": True}))]
    return [holds(HoldOff, rises(hold)), fails(HoldOff, rises(hold + 1), Scenario(hold + 1, {"x": True}))]


def reset(rng: Random) -> list[Case]:
    """A sum that is taken back every `every` ticks at least stays below its greatest growth in that time."""
    every, most = size(rng, 2, 6, 20_000), rng.randint(1, 9)
    start = rng.choice([0, rng.randint(0, 5)])
    bound = start + most * (every - 1)
    width, word = bits(bound + most), bits(most)

    class Integral(Model, event="tick"):
        n: Annotated[UInt, width] = power_up(start)

        def step(self, x: Annotated[UInt, word], back: Bit) -> "Integral":
            return Integral(n=select(back, 0, (self.n + x).sat(width)))

    def in_time(s: Seen) -> Bit:
        """Small words, and a reset in time."""
        return (s.x <= most) & (age(~s.back, every) < every)

    wrong = bound - rng.choice([1, start or 1])
    return [
        holds(Integral, lambda s: s.n <= bound, given=in_time),
        fails(Integral, lambda s: s.n <= wrong, Scenario(every, {"x": most}), given=in_time),
    ]


def window(rng: Random) -> list[Case]:
    """A window of every frame meets a pulse of every period if it is as wide as the longest wait that can occur.

    Frame and period see each other only at phases that agree modulo their greatest common divisor.
    """
    common = rng.randint(1, 5)
    period = common * size(rng, 2, 5, 40)
    frame = common * (period // common * rng.randint(1, 2) + rng.randint(1, 4)) + common
    start = rng.randrange(period)
    common = math.gcd(frame, period)
    opens = rng.randrange(1, common + 1)
    longest = period - common + -(start + opens) % common
    width, phase = bits(frame - 1), bits(period - 1)

    def watch(wide: int) -> type[Model]:
        class Window(Model, event="tick"):
            f: Annotated[UInt, width] = power_up(0)
            p: Annotated[UInt, phase] = power_up(start)
            seen: Bit = power_up(False)

            def step(self) -> "tuple[Window, Out]":
                inside = (self.f >= opens) & (self.f < opens + wide)
                seen = inside & (self.seen | (self.p == 0))
                f = select(self.f == frame - 1, 0, (self.f + 1).low(width))
                p = select(self.p == period - 1, 0, (self.p + 1).low(phase))
                return Window(f=f, p=p, seen=seen), Out(out=(self.f == opens + wide - 1) & ~seen)

        return Window

    enough = [holds(watch(longest + 1), lambda s: ~s.out)]
    if longest == 0:
        return enough
    laps = next(j for j in range(period) if (start + opens + j * frame + longest) % period == 0)
    return [*enough, fails(watch(longest), lambda s: ~s.out, Scenario(laps * frame + opens + longest))]
