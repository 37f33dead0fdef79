"""Position on board: speed generator, odometer and correction at balises together.

A balise is dealt with at the beginning of a cycle, at the position that the last one ended with.
Source: position from axle pulses, corrected at every balise [P]; rules and numbers [A].
"""

from __future__ import annotations

from typing import NamedTuple

from models.position.correction import Correction, Matched, Where
from models.position.odometer import Fix, Odometer, Position, SpeedGenerator, step_s
from safety import U2, Bit, Model, Real


class Located(NamedTuple):
    """Position at the end of the cycle, what the correction told, the wheel's speed in m/s."""

    position: Position
    matched: Matched
    wheel: Real


class Locator(Model, tick_s=step_s):
    """Where the train is, surely; `matched.reliable` false calls for the most restrictive pattern."""

    generator: SpeedGenerator
    odometer: Odometer
    correction: Correction

    def step(self, pulses: Real, seen: Bit, kind: U2, code: Fix) -> tuple[Locator, Located]:
        """One cycle: pulses a second; a balise of a kind at its beginning, if `seen`; what a code told, if any."""
        before = self.odometer
        at = Where(before.s_lo, before.s, before.s_hi)
        correction, matched = self.correction.step(seen, kind, at, code)
        generator, wheel = self.generator.step(pulses)
        odometer, position = self.odometer.step(wheel, matched.fix)
        following = type(self)(generator=generator, odometer=odometer, correction=correction)
        return following, Located(position, matched, wheel)
