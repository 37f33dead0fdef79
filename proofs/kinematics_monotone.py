"""Kinematics as laws: how the ceiling moves (SP-P5), that it is inverse to the distance (SP-P6), warning.

For all real numbers, without any bound; letters as in `kinematics`, primed ones are the second of a pair.
Source: speed patterns, common physics and properties SP-P5, SP-P6 [D]; warning [A].

Main result: the ceiling rises with distance, deceleration and gradient, falls with free run; d and v_p are inverse.
"""

from __future__ import annotations

from models.kinematics import (
    intervenes,
    is_ceiling,
    is_effective,
    need,
    permits,
)
from safety import PROVED, REFUTED, Bit, Real, implies
from safety.prove.laws import law

SOURCE = "[D] constant deceleration after a free run at constant speed"
WARNING = "[A] warning: the same ceiling with a longer free run"


# --- SP-P5: monotone -------------------------------------------------------------------------------------------------


@law(expect=PROVED, requirement="SP-P5", source=SOURCE)
def ceiling_rises_with_distance(x: Real, x2: Real, b: Real, t: Real, v1: Real, c: Real, c2: Real) -> Bit:
    """More distance left, no lower ceiling."""
    known = (b > 0) & (t >= 0) & (v1 >= 0) & is_ceiling(c, x, b, t, v1) & is_ceiling(c2, x2, b, t, v1)
    return implies(known & (x <= x2), c <= c2)


@law(expect=PROVED, requirement="SP-P5", source=SOURCE)
def ceiling_rises_with_deceleration(x: Real, b: Real, b2: Real, t: Real, v1: Real, c: Real, c2: Real) -> Bit:
    """A better brake, no lower ceiling."""
    known = (b > 0) & (t >= 0) & (v1 >= 0) & is_ceiling(c, x, b, t, v1) & is_ceiling(c2, x, b2, t, v1)
    return implies(known & (b <= b2), c <= c2)


@law(expect=PROVED, requirement="SP-P5", source=SOURCE)
def ceiling_falls_with_free_run(x: Real, b: Real, t: Real, t2: Real, v1: Real, c: Real, c2: Real) -> Bit:
    """A longer free run, no higher ceiling."""
    known = (b > 0) & (t >= 0) & (v1 >= 0) & is_ceiling(c, x, b, t, v1) & is_ceiling(c2, x, b, t2, v1)
    return implies(known & (t <= t2), c >= c2)


@law(expect=PROVED, requirement="SP-P5", source=SOURCE)
def deceleration_rises_with_gradient(b: Real, i: Real, i2: Real, rho: Real, g: Real, e: Real, e2: Real) -> Bit:
    """More uphill, no less effective deceleration; so, with the law before, no lower ceiling."""
    known = (rho > -1) & (g >= 0) & is_effective(e, b, i, rho, g) & is_effective(e2, b, i2, rho, g)
    return implies(known & (i <= i2), e <= e2)


@law(expect=REFUTED, requirement="SP-P5", source=SOURCE, twin_of=deceleration_rises_with_gradient)
def deceleration_rises_with_gradient_of_any_mass(
    b: Real, i: Real, i2: Real, rho: Real, g: Real, e: Real, e2: Real
) -> Bit:
    """The same for any rotating mass.  False below -1."""
    known = (g >= 0) & is_effective(e, b, i, rho, g) & is_effective(e2, b, i2, rho, g)
    return implies(known & (i <= i2), e <= e2)


@law(expect=REFUTED, requirement="SP-P5", source=SOURCE, twin_of=ceiling_rises_with_distance)
def ceiling_rises_with_distance_without_a_brake(
    x: Real, x2: Real, b: Real, t: Real, v1: Real, c: Real, c2: Real
) -> Bit:
    """More distance left, no lower ceiling, for any deceleration.  False below 0."""
    known = (t >= 0) & (v1 >= 0) & is_ceiling(c, x, b, t, v1) & is_ceiling(c2, x2, b, t, v1)
    return implies(known & (x <= x2), c <= c2)


@law(expect=REFUTED, requirement="SP-P5", source=SOURCE, twin_of=ceiling_rises_with_deceleration)
def ceiling_rises_with_decelerations_below_zero(
    x: Real, b: Real, b2: Real, t: Real, v1: Real, c: Real, c2: Real
) -> Bit:
    """A better brake, no lower ceiling, for any deceleration.  False below 0."""
    known = (t >= 0) & (v1 >= 0) & is_ceiling(c, x, b, t, v1) & is_ceiling(c2, x, b2, t, v1)
    return implies(known & (b <= b2), c <= c2)


@law(expect=REFUTED, requirement="SP-P5", source=SOURCE, twin_of=ceiling_falls_with_free_run)
def ceiling_falls_with_free_run_without_a_brake(
    x: Real, b: Real, t: Real, t2: Real, v1: Real, c: Real, c2: Real
) -> Bit:
    """A longer free run, no higher ceiling, for any deceleration.  False below 0."""
    known = (t >= 0) & (v1 >= 0) & is_ceiling(c, x, b, t, v1) & is_ceiling(c2, x, b, t2, v1)
    return implies(known & (t <= t2), c >= c2)


# --- SP-P6: inverse --------------------------------------------------------------------------------------------------


@law(expect=PROVED, requirement="SP-P6", source=SOURCE)
def ceiling_at_the_distance_is_the_speed(v: Real, x: Real, b: Real, t: Real, v1: Real, c: Real) -> Bit:
    """v_p(d(v, v1), v1) = v, for speeds from v1 up."""
    known = (v >= v1) & (v1 >= 0) & (b > 0) & (t >= 0) & (2 * b * x == need(v, b, t, v1))
    return implies(known & is_ceiling(c, x, b, t, v1), c == v)


@law(expect=REFUTED, requirement="SP-P6", source=SOURCE, twin_of=ceiling_at_the_distance_is_the_speed)
def ceiling_at_the_distance_is_any_speed(v: Real, x: Real, b: Real, t: Real, v1: Real, c: Real) -> Bit:
    """The same below v1.  False: the ceiling is never below v1."""
    known = (v >= 0) & (v1 >= 0) & (b > 0) & (t >= 0) & (2 * b * x == need(v, b, t, v1))
    return implies(known & is_ceiling(c, x, b, t, v1), c == v)


@law(expect=PROVED, requirement="SP-P6", source=SOURCE)
def distance_at_the_ceiling_is_the_distance(x: Real, y: Real, b: Real, t: Real, v1: Real, c: Real) -> Bit:
    """d(v_p(x, v1), v1) = x, from x = v1 t up."""
    known = (b > 0) & (t >= 0) & (v1 >= 0) & (x >= v1 * t) & is_ceiling(c, x, b, t, v1)
    return implies(known & (2 * b * y == need(c, b, t, v1)), y == x)


@law(expect=REFUTED, requirement="SP-P6", source=SOURCE, twin_of=distance_at_the_ceiling_is_the_distance)
def distance_at_the_ceiling_is_any_distance(x: Real, y: Real, b: Real, t: Real, v1: Real, c: Real) -> Bit:
    """The same for any x.  False before v1 t: the ceiling stays at v1."""
    known = (b > 0) & (t >= 0) & (v1 >= 0) & is_ceiling(c, x, b, t, v1)
    return implies(known & (2 * b * y == need(c, b, t, v1)), y == x)


# --- warning ---------------------------------------------------------------------------------------------------------


@law(expect=PROVED, requirement="SP-P5", source=WARNING)
def warning_leaves_its_time(v: Real, x: Real, b: Real, t: Real, t_w: Real, v1: Real, s: Real) -> Bit:
    """At constant speed the brake is not asked for within the warning time of the last instant without a warning."""
    known = (b > 0) & (t >= 0) & (v >= 0) & (v1 >= 0) & (s >= 0) & (s <= t_w)
    return implies(known & permits(v, x, b, t + t_w, v1), permits(v, x - v * s, b, t, v1))


@law(expect=REFUTED, requirement="SP-P5", source=WARNING, twin_of=warning_leaves_its_time)
def warning_leaves_more_than_its_time(v: Real, x: Real, b: Real, t: Real, t_w: Real, v1: Real, s: Real) -> Bit:
    """The same for longer than the warning time.  False: then the brake comes."""
    known = (b > 0) & (t >= 0) & (v >= 0) & (v1 >= 0) & (s >= 0) & (t_w >= 0)
    return implies(known & permits(v, x, b, t + t_w, v1), permits(v, x - v * s, b, t, v1))


@law(expect=PROVED, requirement="SP-P5", source=WARNING)
def the_brake_never_comes_unwarned(v: Real, x: Real, b: Real, t: Real, t_w: Real, v1: Real) -> Bit:
    """Where the brake is asked for, there is a warning as well."""
    known = (v >= 0) & (v1 >= 0) & (b > 0) & (t_w >= 0)
    return implies(known & intervenes(v, x, b, t, v1), intervenes(v, x, b, t + t_w, v1))


@law(expect=REFUTED, requirement="SP-P5", source=WARNING, twin_of=the_brake_never_comes_unwarned)
def a_warning_is_never_without_the_brake(v: Real, x: Real, b: Real, t: Real, t_w: Real, v1: Real) -> Bit:
    """Where there is a warning, the brake is asked for as well.  False: it comes earlier."""
    known = (v >= 0) & (v1 >= 0) & (b > 0) & (t_w >= 0)
    return implies(known & intervenes(v, x, b, t + t_w, v1), intervenes(v, x, b, t, v1))
