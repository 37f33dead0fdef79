"""A stored pattern on board: function generator, gradient selector, comparator.

One step is one cycle of 0.1 s.  The generator starts where a stop is told, `POINT` metres before the protected point,
and counts the distance left down by what the speed generator has measured.  The comparator holds the brake off while
the speed keeps to the conservative ceiling of that distance; each gradient bin is taken at its steepest end.
Source: function generator, gradient selection in five curves, comparator [P]; distances, steepest end [A].
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from models.kinematics import ACCELERATION, B_SERVICE, CYCLE, MARGIN, T_SERVICE, effective, permits_accelerating
from models.patterns.detectors import Found
from models.patterns.vehicle import Reading
from safety import Bit, Model, Real, bit, point, power_up, real, select

POINT = 1000  # m, of the coil or magnet [A]: enough from the line speed on the steepest downgrade
REACTION = T_SERVICE + CYCLE  # s: one cycle until the next look, and the free run
BINS = (-16, -8, 0, 8, 16)  # permille, middle of each [P]
HALF_BIN = 4  # permille


class Checks(NamedTuple):
    """What the pattern says, and what its detectors would find."""

    below: Bit  # the speed is below the pattern, or there is none
    found: Found


class StoredPattern(Model, tick_s="0.1"):
    """Where a second function generator is fitted, the smaller distance counts."""

    left: Real = power_up(POINT)  # m, as measured

    def step(self, told: Bit, read: Reading, target: Real, gradient: Real, second: Bit) -> tuple[StoredPattern, Checks]:
        """A cycle; `told` stays once the point is to be protected, from where `target` m/s are to be held."""
        left = self.left - read.way
        first, other = point("generator", left - MARGIN), point("second_generator", left - MARGIN)
        room = select(second & (other < first), other, first)
        given = bin_of(gradient)
        chosen = point("selector", given)
        below = point("comparator", ~told | self.kept(read.v, room, target, chosen))
        found = Found(
            two_patterns=first != other, echo=chosen != given, dynamic_test=point("comparator_test", bit(False))
        )
        return type(self)(left=select(told, left, POINT)), Checks(below, found)

    def kept(self, v: Real, room: Real, target: Real, chosen: Real) -> Bit:
        """The speed is at most the ceiling of the chosen bin; what is none counts as the steepest downgrade."""
        kept = bit(True)
        for k, centre in enumerate(BINS):
            curve = permits_accelerating(v, room, steepest(centre), REACTION, ACCELERATION, target)
            kept = select(chosen == centre, curve, kept) if k else curve
        return kept


def steepest(centre: int) -> Fraction:
    """The deceleration at the steepest end of a gradient bin, m/s^2."""
    return Fraction(effective(B_SERVICE, centre - HALF_BIN))


def bin_of(gradient: Real) -> Real:
    """The middle of the bin that a gradient lies in, permille, as the ground signals it."""
    middle = real(BINS[0])
    for centre in BINS[1:]:
        middle = select(gradient >= centre - HALF_BIN, real(centre), middle)
    return middle
