"""One-stage pattern: target speed and distance are known, the ceiling is v_p(x - m); it intervenes at the last moment.

The run is that of the supervisor with the plain ceiling and no traction; `LaterRun` is one that intervenes later still.
Source: one-stage pattern (section 2.4), SP-P4; comparison with steps (section 2.2) [D].

Main results: 750.0 m from 100 km/h for the train of 2.0 km/h/s, against 825.0 m of steps; 518.5 m at 3.0 km/h/s.
"""

from __future__ import annotations

from fractions import Fraction

from models.kinematics import T_SERVICE, distance, intervenes, mps
from models.patterns.slips import Plain, WithoutTraction
from models.patterns.step_supervision import LADDER, WORST
from models.patterns.train import TICK
from safety import Bit, Real


def pattern_length(kmh: int = LADDER[0], b: Fraction = WORST, t: Fraction = T_SERVICE) -> Fraction:
    """Way of a pattern from a speed to a stop, m."""
    found: Fraction = distance(mps(kmh), b, t)
    return found


class Later(Plain, tick_s=TICK):
    """A rule that permits some speeds above the ceiling: it counts on three quarters of the free run."""

    def above(self, v: Real, x: Real, b: Real, t: Real) -> Bit:
        """Later than the last moment."""
        found: Bit = intervenes(v, x, b, t * 3 / 4)
        return found


class LaterRun(WithoutTraction, tick_s=TICK):
    """The train under that rule."""

    guard: Later
