"""Two-counter ATC: rides at each check speed on which faults strike, first within the limit, then too fast.

The train runs 3.3 % below the threshold of the check speed and is released; the fault strikes; then it runs at the
least speed at which the brake is certain.  Four moments of fault and overspeed: at the outset of a count; a fault early
in a count, and one late in it, when it has said safe, with the overspeed in the preparation that follows; both in the
midst of a count.  Steps are oscillator periods.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import ceil

from models.two_counter.circuit import RESET, START
from models.two_counter.numbers import CHECK_SPEEDS
from models.two_counter.selection import Lines
from proofs.two_counter_brake_chain import Chain
from proofs.two_counter_formulas import EDGE, ROWS, greatest_permitted
from safety import ANY_TIME, TRANSIENT, Bit, Fault, Scenario, Seen, any_of, persists

LATE = 35  # steps between a fault late in a count and its end: n1F has been reached
SOME_LOST = 700  # edges in which pulses that are lost in 100 are lost in a count, not in a preparation only


@dataclass(frozen=True)
class Ride:
    """The ride at check speed `v`, km/h."""

    v: int

    @property
    def m(self) -> int:
        """Preset, edges."""
        return ROWS[self.v]

    @cached_property
    def chain(self) -> Chain:
        """What brings the brake."""
        return Chain(self.m)

    @property
    def within(self) -> int:
        """A speed within the limit."""
        return greatest_permitted(self.m) * 29 // 30

    @property
    def lines(self) -> dict[str, bool]:
        """This check speed selected, and no other."""
        return {f"lines.{name}": name == f"s{self.v}" for name in Lines._fields}

    def selected(self, s: Seen) -> Bit:
        """This check speed is selected, and no other."""
        return s.lines[f"s{self.v}"] & ~any_of(*(s.lines[name] for name in Lines._fields if name != f"s{self.v}"))

    def too_fast_too_long(self, s: Seen) -> Bit:
        """Overspeed for the time that property 4 allows."""
        return persists(self.chain.overspeed(s), self.chain.braked)

    def step(self, edges: Fraction | int) -> int:
        """The step of an edge, counted from power-up, within the limit."""
        return ceil(Fraction(edges) * EDGE / self.within)

    @property
    def run_in(self) -> int:
        """Steps to the first release."""
        return self.step(START + self.m + RESET) + 2

    @property
    def moments(self) -> dict[str, tuple[int, int]]:
        """Steps of the fault and of the overspeed."""
        period = START + self.m
        outset, early = self.step(period + 2 * START + 2), self.step(period + Fraction(7 * period, 16))
        midst, preparing = (
            self.step(2 * period + Fraction(5 * period, 6)),
            self.step(2 * period + RESET + Fraction(1, 2)),
        )
        late = self.step(2 * period) - LATE
        return {
            "outset": (outset, outset + 1), "early": (early, preparing), "late": (late, preparing),
            "midst": (midst - 1, midst),
        }  # fmt: skip

    @property
    def lasts(self) -> int:
        """Steps of overspeed: twice what the brake may take, and longer where few edges come in it."""
        return max(2 * self.chain.braked, SOME_LOST * EDGE // self.chain.speed)

    def speed(self, step: int, begins: int) -> int:
        """The speed of a step, the overspeed beginning at a given one."""
        return self.within if step < begins else self.chain.speed

    def scenarios(self, present: tuple[str, ...]) -> list[Scenario]:
        """The rides with these faults, up to the brake; then one that begins just before a count, and a long one."""
        before, (outset, _) = self.moments["late"][1], self.moments["outset"]
        brief = self.chain.braked + 20
        strikes = [(*moment, brief) for moment in self.moments.values()]
        strikes += [(before - 1, before, brief), (outset, outset + 1, self.lasts)]
        return [self._scenario(present, *one) for one in strikes]

    def _scenario(self, present: tuple[str, ...], strike: int, begins: int, lasts: int) -> Scenario:
        """The ride on which these strike at a step, with overspeed from another one on."""
        speed = {"speed": lambda k: self.speed(k, begins)}
        return Scenario(begins + lasts, {**self.lines, **speed}, present=present, at=strike)


LOWER = [v for v in CHECK_SPEEDS if v < max(CHECK_SPEEDS)]


def struck(faults: Sequence[Fault], strike: int, begins: int) -> Iterator[Fault]:
    """Permanent faults from `strike` on; transient ones are over when the overspeed begins."""
    for fault in faults:
        if fault.onset == TRANSIENT:
            yield replace(fault, at=begins - 1 - (fault.ticks or 1))
        else:
            yield replace(fault, onset=ANY_TIME, at=strike)
