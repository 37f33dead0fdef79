"""Families of codes and courses: a peak that decays, a ring counter beside a number, a Gray code."""

from random import Random
from typing import Annotated

from safety.model import Model, power_up
from safety.prove.claims import Formula, Scenario, Seen, age, previous
from safety.terms import Bit, UInt, count, implies, select
from tests.generated.case import Case, bits, fails, holds, size


def peak(rng: Random) -> list[Case]:
    """A peak that decays by `fall` a tick is gone in (highest - low) / fall ticks, and not before."""
    highest, fall = size(rng, 3, 30, 60_000), rng.randint(1, 3)
    low = rng.randrange(highest - 1)
    ticks, width = -(-(highest - low) // fall), bits(highest)

    class Peak(Model, event="tick"):
        m: Annotated[UInt, width] = power_up(0)

        def step(self, x: Annotated[UInt, width]) -> "Peak":
            less = self.m.sat_sub(fall)
            return Peak(m=select(x > less, x, less))

    def within(s: Seen) -> Bit:
        """The input stays in its range."""
        return s.x <= highest

    def gone(least: int) -> Formula:
        return lambda s: implies(age(s.x <= low, ticks) >= least, s.m <= low)

    fallen = Scenario(ticks + 1, {"x": lambda k: low if k else highest})
    return [holds(Peak, gone(ticks), given=within), fails(Peak, gone(ticks - 1), fallen, given=within)]


def ring(rng: Random) -> list[Case]:
    """The one of a ring counter stands where the number beside it says, if both turn over together."""
    n = size(rng, 2, 6, 24)
    width, place = bits(n), rng.randrange(n)

    def made(turns: int) -> type[Model]:
        class Ring(Model, event="tick"):
            r: Annotated[UInt, n] = power_up(1)
            at: Annotated[UInt, width] = power_up(0)

            def step(self, go: Bit) -> "Ring":
                turned = self.r.low(n - 1).concat(self.r.slice(n - 1, 1))
                at = select(self.at == turns - 1, 0, (self.at + 1).low(width))
                return Ring(r=select(go, turned, self.r), at=select(go, at, self.at))

        return Ring

    def agree(s: Seen) -> Bit:
        return ~(s.r.bit(place) ^ (s.at == place))

    turns = n - 1 if n > 2 and rng.random() < 0.5 else n + 1
    if turns > (1 << width):
        turns = n - 1
    return [holds(made(n), agree), fails(made(turns), agree, Scenario(2 * n + 3, {"go": True}))]


def gray(rng: Random) -> list[Case]:
    """A Gray code changes in one bit, also where it turns over, if it turns over at a power of two."""
    width = size(rng, 2, 4, 14)
    short = (1 << width) - rng.randint(1, (1 << width - 1) - 1)

    def made(turns: int) -> type[Model]:
        class Gray(Model, event="tick"):
            n: Annotated[UInt, width] = power_up(0)
            code: Annotated[UInt, width] = power_up(0)

            def step(self, go: Bit) -> "Gray":
                ahead = select(self.n == turns - 1, 0, (self.n + 1).low(width))
                n = select(go, ahead, self.n)
                return Gray(n=n, code=n ^ (n >> 1).widen(width))

        return Gray

    def one_bit(s: Seen) -> Bit:
        change = s.code ^ previous(s.code, 0)
        return count(*(change.bit(i) for i in range(width))) <= 1

    while (short - 1 ^ (short - 1 >> 1)).bit_count() == 1:
        short -= 1
    return [holds(made(1 << width), one_bit), fails(made(short), one_bit, Scenario(short + 1, {"go": True}))]
