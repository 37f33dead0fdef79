"""One cycle of a supervised train as laws: for all brakes, budgets and accelerations.

`v` and `x` before the cycle, `u` the speed after it, `m` how long of the cycle h the train moves, `r` the time left
until the brake acts.  The induction over the model, `patterns_supervisor`, takes these steps at its parameters.
Source: speed patterns, SP-P2 and SP-P3 over one cycle [D].
"""

from __future__ import annotations

from models.kinematics import (
    CYCLE,
    gains_at_most,
    is_motion,
    loses_at_least,
    permits_accelerating,
    stops_accelerating,
    way_doubled,
)
from safety import PROVED, REFUTED, Bit, Real, implies, real
from safety.prove.laws import law

SOURCE = "[D] constant acceleration within a cycle, a standstill on the way included"


def moving(v: Real, u: Real, m: Real, h: Real, b: Real, a: Real) -> Bit:
    """The train moves forward through the cycle, and the numbers are what they are called."""
    return (v >= 0) & (h > 0) & (b > 0) & (a >= 0) & is_motion(u, m, h)


@law(expect=PROVED, requirement="SP-P3", source=SOURCE)
def a_cycle_before_the_brake_acts_keeps_the_stop(v: Real, x: Real, u: Real, m: Real, b: Real, a: Real, r: Real) -> Bit:
    """Whose stop fits with r left until the brake acts still fits a cycle of 0.1 s later with that much less left."""
    known = moving(v, u, m, real(CYCLE), b, a) & gains_at_most(v, u, m, a) & (r >= CYCLE)
    fits = stops_accelerating(v, x, b, r, a)
    return implies(known & fits, stops_accelerating(u, x - way_doubled(v, u, m) / 2, b, r - CYCLE, a))


@law(expect=REFUTED, requirement="SP-P3", source=SOURCE, twin_of=a_cycle_before_the_brake_acts_keeps_the_stop)
def a_cycle_before_the_brake_acts_costs_no_time(
    v: Real, x: Real, u: Real, m: Real, h: Real, b: Real, a: Real, r: Real
) -> Bit:
    """The same with r left a cycle later.  False: the cycle has to be in the budget."""
    known = moving(v, u, m, h, b, a) & gains_at_most(v, u, m, a) & (r >= h) & stops_accelerating(v, x, b, r, a)
    return implies(known, stops_accelerating(u, x - way_doubled(v, u, m) / 2, b, r, a))


@law(expect=REFUTED, requirement="SP-P3", source=SOURCE, twin_of=a_cycle_before_the_brake_acts_keeps_the_stop)
def a_cycle_of_any_acceleration_keeps_the_stop(
    v: Real, x: Real, u: Real, m: Real, h: Real, b: Real, a: Real, r: Real
) -> Bit:
    """The same whatever the train accelerates by.  False."""
    known = moving(v, u, m, h, b, a) & (r >= h) & stops_accelerating(v, x, b, r, a)
    return implies(known, stops_accelerating(u, x - way_doubled(v, u, m) / 2, b, r - h, a))


@law(expect=PROVED, requirement="SP-P2", source=SOURCE)
def a_cycle_under_the_brake_keeps_the_stop(
    v: Real, x: Real, u: Real, m: Real, h: Real, b: Real, a: Real, r: Real
) -> Bit:
    """Whose stop fits, with whatever time to spare, still fits after a cycle under the brake."""
    known = moving(v, u, m, h, b, a) & loses_at_least(v, u, m, b) & (r >= 0) & stops_accelerating(v, x, b, r, a)
    return implies(known, stops_accelerating(u, x - way_doubled(v, u, m) / 2, b, r, a))


@law(expect=REFUTED, requirement="SP-P2", source=SOURCE, twin_of=a_cycle_under_the_brake_keeps_the_stop)
def a_cycle_without_the_brake_keeps_the_stop(
    v: Real, x: Real, u: Real, m: Real, h: Real, b: Real, a: Real, r: Real
) -> Bit:
    """The same for a train that coasts.  False."""
    known = moving(v, u, m, h, b, a) & gains_at_most(v, u, m, 0) & (r >= 0) & stops_accelerating(v, x, b, r, a)
    return implies(known, stops_accelerating(u, x - way_doubled(v, u, m) / 2, b, r, a))


@law(expect=PROVED, requirement="SP-P5", source="[D] unsafe end of each interval")
def intervals_are_compared_on_the_safe_side(v: Real, x: Real, v_hi: Real, x_lo: Real, b: Real, t: Real, a: Real) -> Bit:
    """What is permitted at the faster and nearer end is permitted at the true speed and distance."""
    known = (v >= 0) & (v <= v_hi) & (x_lo <= x) & (b > 0) & (t >= 0) & (a >= 0)
    return implies(known & permits_accelerating(v_hi, x_lo, b, t, a), permits_accelerating(v, x, b, t, a))


@law(expect=REFUTED, requirement="SP-P5", source="[D]", twin_of=intervals_are_compared_on_the_safe_side)
def the_other_ends_are_as_good(v: Real, x: Real, v_lo: Real, x_hi: Real, b: Real, t: Real, a: Real) -> Bit:
    """The same at the slower and farther end.  False: the train may be faster and nearer."""
    known = (v_lo >= 0) & (v_lo <= v) & (x <= x_hi) & (b > 0) & (t >= 0) & (a >= 0)
    return implies(known & permits_accelerating(v_lo, x_hi, b, t, a), permits_accelerating(v, x, b, t, a))
