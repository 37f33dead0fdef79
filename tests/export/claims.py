"""Small claims, each with what is true of it: None, or the number of steps of its shortest counterexample."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, NamedTuple

from safety.faults import ANY_TIME, at_most, every
from safety.kinds import stuck
from safety.model import Model, point, power_up
from safety.prove.claims import Seen, previous
from safety.prove.problem import Problem, build_problem
from safety.system import ANY
from safety.terms import U4, U8, Bit, Int, implies, select
from tests.prove.small import Counter, asked, passed_in_time

Height = Annotated[Int, (-4, 3)]
Slope = Annotated[Int, (-3, 2)]
Change = Annotated[Int, (-1, 1)]


class Water(NamedTuple):
    low: Bit
    share: U8


class Tank(Model, event="tick"):
    """A level between -4 and 3 that changes by 1 at most, and a phase of unknown beginning."""

    level: Height = power_up(0)
    phase: U4 = power_up(ANY)
    rate: Slope = power_up(ANY)

    def step(self, change: Change, k: U4) -> tuple[Tank, Water]:
        level = point("level", (self.level + change).clip(-4, 3))
        phase = select(self.rate < self.level, ((self.phase * 3) // 5).low(4), (self.phase + k % 7).low(4))
        water = Water(low=self.level < -2, share=(self.level * self.rate).low(8))
        return Tank(level=level, phase=phase, rate=self.rate), water


def slow(s: Seen) -> Bit:
    """Only true with the change in its range: two bits of two's complement have -2 as well."""
    change = s.level - previous(s.level, 0)
    return (change <= 1) & (change >= -1)


def in_range(s: Seen) -> Bit:
    """Only true with the free power-up value in its range."""
    return (s.rate <= 2) & (s.rate >= -3)


def far_from_empty(s: Seen) -> Bit:
    return s.level > -3


def product(s: Seen) -> Bit:
    """Signed multiplication, wrapped into a word of 8 bits: -9 at least, 12 at most."""
    return (s.share <= 12) | (s.share >= 256 - 9)


def no_product_of_minus_nine(s: Seen) -> Bit:
    return s.share != 256 - 9


def few(s: Seen) -> Bit:
    return s.n < 4


def below_nine(s: Seen) -> Bit:
    return s.n < 9


def idle(s: Seen) -> Bit:
    return ~s.go


def sees_it(s: Seen) -> Bit:
    return implies(s.high, s.on)


def claim(formula: Callable[[Seen], Bit], model: type[Model] = Counter, **changes: Any) -> Problem:
    return build_problem(asked(formula, model, **{"steps": 20, "lemmas": ()} | changes))


free = {"anywhere": True, "start": few}
passed_stuck = at_most(1, every(stuck(0), "passed", "high", onset=ANY_TIME))
CLAIMS: dict[str, tuple[Callable[[], Problem], int | None]] = {
    "passed": (lambda: claim(passed_in_time), None),
    "nine": (lambda: claim(below_nine), 10),
    "slow": (lambda: claim(slow, Tank), None),
    "in range": (lambda: claim(in_range, Tank), None),
    "far from empty": (lambda: claim(far_from_empty, Tank), 4),
    "product": (lambda: claim(product, Tank), None),
    "no product of -9": (lambda: claim(no_product_of_minus_nine, Tank), 4),
    "few and idle": (lambda: claim(few, given=idle, **free), None),
    "few": (lambda: claim(few, **free), 2),
    "assumed at the same step": (lambda: claim(below_nine, given=below_nine), None),
    "fault": (lambda: claim(passed_in_time, faults=passed_stuck), 5),
    "no fault": (lambda: claim(sees_it, lemmas=[passed_in_time]), None),
}
