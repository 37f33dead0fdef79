"""Families that share: a latch, a conserved sum, credits, a queue, an arbiter."""

from random import Random
from typing import Annotated, NamedTuple

from safety.model import Model, power_up
from safety.prove.claims import Formula, Scenario, age, once, previous
from safety.terms import Bit, UInt, count, implies, select
from tests.generated.case import Case, bits, fails, holds, size


class Grant(NamedTuple):
    grant: UInt


def latch(rng: Random) -> list[Case]:
    """A latch that is set by a trouble of `long` ticks: which of set and reset wins, and what it remembers."""
    long = size(rng, 2, 10, 20_000)
    width = bits(long)

    def latched(reset_wins: bool) -> type[Model]:
        class Latch(Model, event="tick"):
            t: Annotated[UInt, width] = power_up(0)
            on: Bit = power_up(False)

            def step(self, bad: Bit, back: Bit) -> "Latch":
                due = self.t >= long
                t = select(bad, select(due, self.t, (self.t + 1).low(width)), 0)
                return Latch(t=t, on=(self.on | due) & ~back if reset_wins else (self.on & ~back) | due)

        return Latch

    def told(ticks: int) -> Formula:
        return lambda s: implies(s.on, once(age(s.bad, long + 1) >= ticks))

    def obeys(s):
        return implies(previous(s.back, False), ~s.on)

    if rng.random() < 0.4:
        both = Scenario(long + 2, {"bad": True, "back": True})
        return [holds(latched(True), obeys), fails(latched(False), obeys, both)]
    return [
        holds(latched(True), told(long)),
        fails(latched(True), told(long + 1), Scenario(long + 2, {"bad": lambda k: k < long})),
    ]


def transfer(rng: Random) -> list[Case]:
    """What is moved between two stores stays as much, unless one gives what it has not."""
    whole, most = size(rng, 1, 12, 30_000), rng.randint(1, 9)
    width, word = bits(whole + 16), bits(most)

    def stores(guarded: bool) -> type[Model]:
        class Stores(Model, event="tick"):
            a: Annotated[UInt, width] = power_up(whole)
            b: Annotated[UInt, width] = power_up(0)

            def step(self, x: Annotated[UInt, word], home: Bit) -> "Stores":
                out = select(~home & ((x <= self.a) if guarded else (self.b <= whole)), x, 0)
                back = select(home & (x <= self.b), x, 0)
                a = select(home, (self.a + back).sat(width), self.a.sat_sub(out))
                return Stores(a=a, b=select(home, self.b.sat_sub(back), (self.b + out).sat(width)))

        return Stores

    moved = Scenario(whole + 2, {"x": 1})
    wrong = fails(stores(True), lambda s: s.b < whole, moved)
    if rng.random() < 0.4:
        wrong = fails(stores(False), lambda s: s.b <= whole, moved)
    return [holds(stores(True), lambda s: s.b <= whole), wrong]


def credit(rng: Random) -> list[Case]:
    """Credits, messages on their way and messages in the buffer are as many as there were credits."""
    credits = size(rng, 1, 8, 5000)
    width = bits(credits + 1)

    def link(guarded: bool) -> type[Model]:
        class Link(Model, event="tick"):
            free: Annotated[UInt, width] = power_up(credits)
            way: Annotated[UInt, width] = power_up(0)
            buffer: Annotated[UInt, width] = power_up(0)

            def step(self, send: Bit, arrive: Bit, take: Bit) -> "Link":
                sent, arrived = send & (self.free > 0), arrive & (self.way > 0)
                taken = take & (self.buffer > 0)
                back = taken if guarded else take & (self.free < credits)
                return Link(
                    free=(self.free + back.word() - sent.word()).sat(width),
                    way=(self.way + sent.word() - arrived.word()).sat(width),
                    buffer=(self.buffer + arrived.word() - taken.word()).sat(width),
                )

        return Link

    filled = Scenario(credits + 3, {"send": True, "arrive": True})
    wrong = fails(link(True), lambda s: s.buffer < credits, filled)
    if rng.random() < 0.4:
        twice = Scenario(credits + 4, {"send": True, "arrive": lambda k: k > 1, "take": lambda k: k == 1})
        wrong = fails(link(False), lambda s: s.buffer <= credits, twice)
    return [holds(link(True), lambda s: s.buffer <= credits), wrong]


def queue(rng: Random) -> list[Case]:
    """Two pointers that turn differ by what is in the queue, as long as it is never full to the last place."""
    width = size(rng, 1, 3, 11)
    places = 1 << width
    height = width + 1

    def made(cap: int, guarded: bool) -> type[Model]:
        class Queue(Model, event="tick"):
            head: Annotated[UInt, width] = power_up(0)
            tail: Annotated[UInt, width] = power_up(0)
            filled: Annotated[UInt, height] = power_up(0)

            def step(self, push: Bit, pop: Bit) -> "Queue":
                come = push & (self.filled < cap)
                go = pop & (self.filled > 0)
                head, tail = self.head + come.word(), self.tail + (go if guarded else pop).word()
                filled = (self.filled + come.word() - go.word()).sat(height)
                return Queue(head=head.low(width), tail=tail.low(width), filled=filled)

        return Queue

    def agree(s):
        return (s.head - s.tail).low(width) == s.filled

    wrong = fails(made(places, True), agree, Scenario(places + 1, {"push": True}))
    if rng.random() < 0.4:
        wrong = fails(made(places - 1, False), agree, Scenario(2, {"pop": True}))
    return [holds(made(places - 1, True), agree), wrong]


def arbiter(rng: Random) -> list[Case]:
    """One token goes round: one grant at a time, and none waits longer than all others may hold it."""
    stations, hold = rng.randint(2, 4), size(rng, 1, 4, 300)
    width = bits(hold - 1)

    def made(tokens: int) -> type[Model]:
        class Arbiter(Model, event="tick"):
            token: Annotated[UInt, stations] = power_up(tokens)
            t: Annotated[UInt, width] = power_up(0)

            def step(self, request: Annotated[UInt, stations]) -> "tuple[Arbiter, Grant]":
                grant = self.token & request
                move = (grant == 0) | (self.t >= hold - 1)
                turned = self.token.low(stations - 1).concat(self.token.slice(stations - 1, 1))
                return (
                    Arbiter(token=select(move, turned, self.token), t=select(move, 0, (self.t + 1).low(width))),
                    Grant(grant=grant),
                )

        return Arbiter

    def alone(s):
        return count(*(s.grant.bit(i) for i in range(stations))) <= 1

    every = {"request": (1 << stations) - 1}
    if rng.random() < 0.4:
        return [holds(made(1), alone), fails(made(3), alone, Scenario(1, every))]
    last, longest = stations - 1, (stations - 1) * hold

    def waits(ticks: int) -> Formula:
        return lambda s: age(s.request.bit(last) & ~s.grant.bit(last), longest + 1) < ticks

    return [holds(made(1), waits(longest + 1)), fails(made(1), waits(longest), Scenario(longest + 1, every))]
