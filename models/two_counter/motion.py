"""Two-counter ATC: a steady rise of the speed as inputs of the models, exact, placed against the oscillator.

Time in steps (oscillator periods, the pulse at the end of each), way in turning: SPACING from edge to edge, half a
pulse, more for a fast oscillator.  One start of a count, signal 3, is put where it is wanted: `phase` of a period after
a pulse, 0 being at it and so after it.  It is the first one after power-up, or a later one; speeds are turning a step,
as in `train.py`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import count
from math import ceil, lcm

from models.two_counter.circuit import START
from models.two_counter.numbers import COUNTING_S, N1F
from models.two_counter.theory import Interval, positive_root
from models.two_counter.train import KMH, TURN

SPACING = TURN * N1F


@dataclass(frozen=True)
class Rise:
    """A motion with `speed` at the start of a count, `phase` (0 up to 1) of a period after an oscillator pulse.

    That signal 3 comes with the edge number `edges` after power-up; `spacing` is the way from edge to edge.
    """

    speed: Fraction
    rise: Fraction = Fraction(0)
    phase: Fraction = Fraction(0)
    edges: int = START
    spacing: int = SPACING

    @cached_property
    def start(self) -> Fraction:
        """The time of that signal 3, the first that leaves less than the way of one edge at power-up; see `place`."""
        return place(self)

    def way(self, since: Fraction | int) -> Fraction:
        """The way since power-up, edges at the multiples of `spacing`, at a time after that signal 3 or before it."""
        return self.edges * self.spacing + self.speed * since + self.rise * since * since / 2

    def position(self, time: Fraction | int) -> Fraction:
        """The way at a time after power-up."""
        return self.way(time - self.start)

    def speed_at(self, time: Fraction | int) -> Fraction:
        """The speed at a time after power-up."""
        return self.speed + self.rise * (time - self.start)


def place(motion: Rise) -> Fraction:
    """The time from power-up to the signal 3 of a motion.

    Raises ValueError where the train was at a standstill before, or has no place for that many edges.
    """
    steps = max(0, int(motion.edges * motion.spacing / motion.speed - motion.phase))
    while motion.way(-steps - motion.phase) >= motion.spacing:
        steps += 1
        if motion.speed <= motion.rise * (steps + 1):
            raise ValueError(f"from a standstill there are fewer than {motion.edges} edges; give a smaller rise")
    return steps + motion.phase


def train_phase(motion: Rise) -> int:
    """The phase of the axle at power-up; ValueError where an edge lies before it."""
    found = ceil(motion.position(0)) - 1
    if not 0 <= found < motion.spacing:
        raise ValueError(f"turned by {found} at power-up, with edges {motion.spacing} apart; choose another speed")
    return found


def inputs(motion: Rise) -> Iterator[int]:
    """The speed of each step: whole ways, so that each is rounded up at the step's end."""
    fixed, slope, bend = motion.position(0), motion.speed_at(0), motion.rise / 2
    scale = lcm(fixed.denominator, slope.denominator, bend.denominator)
    a, b, c = (int(x * scale) for x in (bend, slope, fixed))
    before = -(-c // scale)
    for step in count(1):
        now = -(-((a * step + b) * step + c) // scale)
        yield now - before
        before = now


def instant(motion: Rise, edge: int) -> Interval:
    """When an edge comes, by its number after power-up, not before that signal 3; ends at most 1e-20 apart."""
    if edge <= motion.edges:
        return Interval(motion.start, motion.start)
    return positive_root(motion.rise / 2, motion.speed, (edge - motion.edges) * motion.spacing).scaled(1, motion.start)


def rise_per_step(acceleration: Fraction | int) -> Fraction:
    """What a step adds to the speed, at an acceleration in km/h/s."""
    return Fraction(acceleration) * KMH * COUNTING_S / N1F


def just_released(edges: int, rise: Fraction, window: Fraction, spacing: int = SPACING) -> Fraction:
    """The speed at the start of a count of so many edges that lasts `window` steps, at a rise per step."""
    return (edges * spacing - rise * window * window / 2) / window
