"""The channel and voter family that tools are compared on, and our proof of it as a process of its own.

A channel: two phase accumulators (speed and reference word free at each tick) race into a counter of 4 bits that trips
at 8.  A voter: three of them from any phases, one broken in any way at each tick; two of three, one of two after
isolation by a counter of disagreement, and the brake when fewer are left.  A margin of m trips it in T ticks.

    python -m tests.bench.races single 8 64 [--lemmas] [--ticks T]
"""

import argparse
import sys
from typing import Annotated, NamedTuple

from safety.faults import at_most
from safety.model import ANY, Model, point, power_up
from safety.prove.claims import Claim, Formula, Scenario, Seen, age
from safety.prove.prove import prove
from safety.terms import U3, U4, Bit, UInt, at_least, count, implies, select
from tests.prove.small import asked

LEVEL, MOST = 8, 15
SIZES = [(8, 64), (8, 8), (8, 1), (13, 1)]  # bits of a word, margin; the last: T near 1e5


class Drive(NamedTuple):
    trip: Bit


class Brake(NamedTuple):
    brake: Bit


def ticks_for(width: int, margin: int) -> int:
    """Ticks in which the margin takes 2^w d + v - r from its least value past that of a counter below the level."""
    return -(-((1 << width) * (LEVEL - 1) + 2 * ((1 << width) - 1) + 1) // margin)


def single(width: int) -> type[Model]:
    """One channel."""

    class Channel(Model, event="tick"):
        v: Annotated[UInt, width] = power_up(ANY)
        r: Annotated[UInt, width] = power_up(ANY)
        d: U4 = power_up(ANY)

        def step(self, kv: Annotated[UInt, width], kr: Annotated[UInt, width]) -> "tuple[Channel, Drive]":
            v, r = self.v + kv, self.r + kr
            up, down = v.bit(width) & ~r.bit(width), r.bit(width) & ~v.bit(width)
            d = select(up, (self.d + 1).sat(4), select(down, self.d.sat_sub(1), self.d))
            return Channel(v=v.low(width), r=r.low(width), d=d), Drive(trip=point("trip", self.d >= LEVEL))

    return Channel


def voter(width: int) -> type[Model]:
    """Three channels, isolation by disagreement, and the vote."""
    Channel = single(width)

    class Isolation(Model, event="tick"):
        n: U3 = power_up(0)
        out: Bit = power_up(False)

        def step(self, disagrees: Bit) -> "Isolation":
            return Isolation(n=select(disagrees, (self.n + 1).sat(3), 0), out=self.out | (self.n == 7))

    class Voter(Model, event="tick"):
        a: Channel
        b: Channel
        c: Channel
        ia: Isolation
        ib: Isolation
        ic: Isolation

        def step(self, kv: Annotated[UInt, width], kr: Annotated[UInt, width]) -> "tuple[Voter, Brake]":
            channels = [self.a.step(kv, kr), self.b.step(kv, kr), self.c.step(kv, kr)]
            trips, outs = [drive.trip for _, drive in channels], [i.out for i in (self.ia, self.ib, self.ic)]
            asking = count(*(t & ~out for t, out in zip(trips, outs, strict=True)))
            lost = count(*outs)
            brake = (asking >= 2) | ((lost == 1) & (asking >= 1)) | at_least(2, *outs)
            a, b, c = (channel for channel, _ in channels)
            ia, ib, ic = (i.step(t ^ brake) for i, t in zip((self.ia, self.ib, self.ic), trips, strict=True))
            return Voter(a=a, b=b, c=c, ia=ia, ib=ib, ic=ic), Brake(brake=brake)

    return Voter


def question(kind: str, width: int, margin: int, lemmas: bool, ticks: int | None = None) -> Claim:
    """The claim of one size; without `ticks` in just the time that it takes."""
    enough = ticks_for(width, margin)
    asks = ticks or enough

    def potential(part: str) -> Formula:
        def of_channel(s: Seen) -> Bit:
            pulses = (1 << width) * s[part + "d"] + s[part + "v"] - s[part + "r"]
            lasted = age(s.kv - s.kr >= margin, asks)
            return (lasted <= asks) & (pulses >= margin * lasted.int() - ((1 << width) - 1))

        return of_channel

    def trips(s: Seen) -> Bit:
        return implies(age(s.kv - s.kr >= margin, asks) >= asks, s.brake if kind == "voter" else s.trip)

    parts = ["a.", "b.", "c."] if kind == "voter" else [""]
    return asked(
        trips,
        voter(width) if kind == "voter" else single(width),
        id=f"races.{kind}_{width}_{margin}",
        faults=at_most(1, "channel") if kind == "voter" else None,
        lemmas=tuple(map(potential, parts)) if lemmas else (),
        witness=Scenario(asks + 1, {"kv": margin}),
    )


def main() -> int:
    """Prove one of them and print the verdict."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=["single", "voter"])
    parser.add_argument("width", type=int)
    parser.add_argument("margin", type=int)
    parser.add_argument("--lemmas", action="store_true")
    parser.add_argument("--ticks", type=int)
    options = parser.parse_args()
    found = prove(question(options.kind, options.width, options.margin, options.lemmas, options.ticks))
    print(found.verdict, found.method, "confirmed by", *found.agreed_by, f"; {found.why}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
