"""A train's motion over a stretch of time without a quotient: its speed at the end, and the part of the time it moves.

A train that is braked to a standstill within the stretch moves only for a part of it.  Given the speed `reached` at the
end and the time `moving`, the acceleration (reached - v) / moving is constant while it moves; any constant acceleration
is one such pair.  One text for Fraction, float, arb balls and Real terms.
"""

from __future__ import annotations

from fractions import Fraction

from models.kinematics.braking import Decision, Quantity


def way_doubled(v: Quantity, reached: Quantity, moving: Quantity) -> Quantity:
    """Twice the way, m."""
    return (v + reached) * moving


def is_motion(reached: Quantity, moving: Quantity, span: Quantity) -> Decision:
    """Whether this is a motion forward for `span` seconds: it ends early only at a standstill."""
    return (reached >= 0) & (moving >= 0) & (moving <= span) & ((moving == span) | (reached == 0))


def gains_at_most(v: Quantity, reached: Quantity, moving: Quantity, a: Quantity) -> Decision:
    """Whether the acceleration is at most a."""
    return reached - v <= a * moving


def loses_at_least(v: Quantity, reached: Quantity, moving: Quantity, b: Quantity) -> Decision:
    """Whether the deceleration is at least b."""
    return v - reached >= b * moving


def moved(v: Fraction, acceleration: Fraction | int, span: Fraction) -> tuple[Fraction, Fraction]:
    """`reached` and `moving` of a train at v that keeps a constant acceleration, or comes to a standstill."""
    reached = v + acceleration * span
    return (reached, span) if reached >= 0 else (Fraction(0), -v / acceleration)
