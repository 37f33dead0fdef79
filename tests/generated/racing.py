"""Families of channels: two accumulators that race into one counter; three counters and a vote."""

from random import Random
from typing import Annotated, NamedTuple

from safety.faults import at_most
from safety.model import ANY, Model, point, power_up
from safety.prove.claims import Formula, Scenario, age, total
from safety.terms import Bit, UInt, at_least, implies, select
from tests.generated.case import Case, bits, fails, holds, size


class Drive(NamedTuple):
    trip: Bit


class Brake(NamedTuple):
    brake: Bit


def race(rng: Random) -> list[Case]:
    """Speed pulses against reference pulses: a margin of m a tick brings the counter to its level in a known time.

    2^w d + speed phase - reference phase grows by m a tick at least: from 1 - 2^w to 2^w level takes `ticks`.  A
    counter that saturates at the level itself loses speed pulses there, and a reference pulse takes it below again.
    """
    width = size(rng, 2, 3, 9)
    period = 1 << width
    level = rng.randint(1, 3 if width < 4 else 8)
    margin = rng.choice([1, 1, max(1, period // 8), rng.randint(1, max(1, period // 2 - 2))])
    most = level + rng.randint(1, 3)
    ticks = -(-(period * level + period - 1) // margin)

    def counter(most: int) -> type[Model]:
        height = bits(most)

        class Race(Model, event="tick"):
            v: Annotated[UInt, width] = power_up(ANY)
            r: Annotated[UInt, width] = power_up(ANY)
            d: Annotated[UInt, height] = power_up(0)

            def step(self, kv: Annotated[UInt, width], kr: Annotated[UInt, width]) -> "Race":
                v, r = self.v + kv, self.r + kr
                up, down = v.bit(width) & ~r.bit(width), r.bit(width) & ~v.bit(width)
                fuller = select(self.d < most, (self.d + 1).low(height), self.d)
                return Race(
                    v=v.low(width), r=r.low(width), d=select(up, fuller, select(down, self.d.sat_sub(1), self.d))
                )

        return Race

    phases = {"v": 0, "r": period - 1}

    def late(last: int) -> Scenario:
        """The margin and no more; at the last step a reference pulse out of its turn."""
        return Scenario(last + 2, {"kv": lambda k: margin + (k == last), "kr": lambda k: int(k == last)}, phases)

    if rng.random() < 0.7:
        miss = fails(
            counter(most),
            lambda s: implies(age(s.kv - s.kr >= margin, ticks) >= ticks - 1, s.d >= level),
            late(ticks - 2),
        )
    else:
        last = next(k for k in range(ticks, ticks + period + 1) if margin * k % period + margin + 1 < period)
        miss = fails(
            counter(level), lambda s: implies(age(s.kv - s.kr >= margin, ticks) >= ticks, s.d >= level), late(last)
        )
    return [holds(counter(most), lambda s: implies(age(s.kv - s.kr >= margin, ticks) >= ticks, s.d >= level)), miss]


def vote(rng: Random) -> list[Case]:
    """Two of three counters of the same pulses: one broken in any way is outvoted, two are not."""
    level = size(rng, 1, 3, 3000)
    height = bits(level)

    class Channel(Model, event="tick"):
        n: Annotated[UInt, height] = power_up(0)

        def step(self, pulse: Bit) -> "tuple[Channel, Drive]":
            n = point("n", select(pulse & (self.n < level), (self.n + 1).low(height), self.n))
            return Channel(n=n), Drive(trip=point("trip", self.n >= level))

    class Voter(Model, event="tick"):
        a: Channel
        b: Channel
        c: Channel

        def step(self, pulse: Bit) -> "tuple[Voter, Brake]":
            a, da = self.a.step(pulse)
            b, db = self.b.step(pulse)
            c, dc = self.c.step(pulse)
            return Voter(a=a, b=b, c=c), Brake(brake=at_least(2, da.trip, db.trip, dc.trip))

    def brakes(pulses: int) -> Formula:
        return lambda s: implies(total(s.pulse.word(), level) >= pulses, s.brake)

    one, two = at_most(1, "channel"), at_most(2, "channel")
    if rng.random() < 0.4:
        early = Scenario(1, present=["a", "b"], values={"a.trip": True, "b.trip": True})
        rightly = [holds(Voter, lambda s: implies(s.brake, total(s.pulse.word(), level) == level), faults=one)]
        return [
            *rightly,
            fails(Voter, lambda s: implies(s.brake, total(s.pulse.word(), level) == level), early, faults=two),
        ]
    if level > 1 and rng.random() < 0.5:
        return [
            holds(Voter, brakes(level), faults=one),
            fails(Voter, brakes(level - 1), Scenario(level, {"pulse": True}), faults=one),
        ]
    deaf = Scenario(level + 1, {"pulse": True}, present=["a", "b"])
    return [holds(Voter, brakes(level), faults=one), fails(Voter, brakes(level), deaf, faults=two)]
