"""Kinematics as laws: target speed, gradient and rotating mass (SP-P1), and a brake that builds up at a limited jerk.

For all real numbers, without any bound.  i gradient, rho rotating mass, e effective deceleration, v1 target speed;
tau the build-up time; other letters as in `kinematics`.
Source: speed patterns, common physics [D]; linear build-up [A].

Main results: the pattern with gradient, mass and target speed is safe wherever a stop is possible; half the build-up
time, counted as free run, is safe, and a third is not.
"""

from __future__ import annotations

from models.kinematics import (
    is_ceiling,
    is_effective,
    permits,
    permits_building_up,
    same_as_free_run,
)
from safety import PROVED, REFUTED, Bit, Real, implies
from safety.prove.laws import law

SOURCE = "[D] constant deceleration after a free run at constant speed; gradient in braking only"
BUILD_UP = "[A] the brake rises linearly, at a jerk of b / tau"


# --- gradient, rotating mass, target speed ---------------------------------------------------------------------------


def slows_on_the_gradient(v: Real, v1: Real, x: Real, t: Real, b: Real, i: Real, rho: Real, g: Real) -> Bit:
    """v t + (v^2 - v1^2) / 2 (b + g i / 1000 (1 + rho)) <= x, multiplied out."""
    mass = 1000 * (1 + rho)
    return mass * (v * v - v1 * v1) <= 2 * (x - v * t) * (mass * b + g * i)


@law(expect=PROVED, requirement="SP-P1", source=SOURCE)
def slowing_fits(v: Real, v1: Real, x: Real, t: Real, b: Real, i: Real, rho: Real, g: Real, e: Real, c: Real) -> Bit:
    """On any gradient, with any rotating mass: who is not above the ceiling is down to v1 within the distance left."""
    known = (v >= 0) & (v1 >= 0) & (t >= 0) & (rho > -1) & (e > 0) & (x >= v1 * t) & is_effective(e, b, i, rho, g)
    return implies(known & is_ceiling(c, x, e, t, v1) & (v <= c), slows_on_the_gradient(v, v1, x, t, b, i, rho, g))


@law(expect=REFUTED, requirement="SP-P1", source=SOURCE, twin_of=slowing_fits)
def slowing_fits_where_no_stop_is_possible(
    v: Real, v1: Real, x: Real, t: Real, b: Real, i: Real, rho: Real, g: Real, e: Real, c: Real
) -> Bit:
    """The same on any downgrade.  False where the brake does not hold the train: such a gradient is refused."""
    known = (v >= 0) & (v1 >= 0) & (t >= 0) & (rho > -1) & (x >= v1 * t) & is_effective(e, b, i, rho, g)
    return implies(known & is_ceiling(c, x, e, t, v1) & (v <= c), slows_on_the_gradient(v, v1, x, t, b, i, rho, g))


@law(expect=REFUTED, requirement="SP-P1", source=SOURCE, twin_of=slowing_fits)
def slowing_fits_too_near(
    v: Real, v1: Real, x: Real, t: Real, b: Real, i: Real, rho: Real, g: Real, e: Real, c: Real
) -> Bit:
    """The same nearer than v1 t.  False there: the ceiling is v1, which is held from now on, not reached by braking."""
    known = (v >= 0) & (v1 >= 0) & (t >= 0) & (rho > -1) & (e > 0) & is_effective(e, b, i, rho, g)
    return implies(known & is_ceiling(c, x, e, t, v1) & (v <= c), slows_on_the_gradient(v, v1, x, t, b, i, rho, g))


@law(expect=REFUTED, requirement="SP-P1", source=SOURCE, twin_of=slowing_fits)
def slowing_fits_backwards(
    v: Real, v1: Real, x: Real, t: Real, b: Real, i: Real, rho: Real, g: Real, e: Real, c: Real
) -> Bit:
    """The same for any speed.  False below 0."""
    known = (v1 >= 0) & (t >= 0) & (rho > -1) & (e > 0) & (x >= v1 * t) & is_effective(e, b, i, rho, g)
    return implies(known & is_ceiling(c, x, e, t, v1) & (v <= c), slows_on_the_gradient(v, v1, x, t, b, i, rho, g))


@law(expect=REFUTED, requirement="SP-P1", source=SOURCE, twin_of=slowing_fits)
def slowing_fits_after_a_free_run_below_zero(
    v: Real, v1: Real, x: Real, t: Real, b: Real, i: Real, rho: Real, g: Real, e: Real, c: Real
) -> Bit:
    """The same for any free run.  False below 0."""
    known = (v >= 0) & (v1 >= 0) & (rho > -1) & (e > 0) & (x >= v1 * t) & is_effective(e, b, i, rho, g)
    return implies(known & is_ceiling(c, x, e, t, v1) & (v <= c), slows_on_the_gradient(v, v1, x, t, b, i, rho, g))


@law(expect=REFUTED, requirement="SP-P1", source=SOURCE, twin_of=slowing_fits)
def slowing_fits_with_any_mass(
    v: Real, v1: Real, x: Real, t: Real, b: Real, i: Real, rho: Real, g: Real, e: Real, c: Real
) -> Bit:
    """The same for any rotating mass.  False below -1."""
    known = (v >= 0) & (v1 >= 0) & (t >= 0) & (e > 0) & (x >= v1 * t) & is_effective(e, b, i, rho, g)
    return implies(known & is_ceiling(c, x, e, t, v1) & (v <= c), slows_on_the_gradient(v, v1, x, t, b, i, rho, g))


@law(expect=REFUTED, requirement="SP-P1", source=SOURCE, twin_of=slowing_fits)
def slowing_fits_with_the_gradient_left_out(
    v: Real, v1: Real, x: Real, t: Real, b: Real, i: Real, rho: Real, g: Real, c: Real
) -> Bit:
    """The same with the ceiling of the level.  False downhill."""
    known = (v >= 0) & (v1 >= 0) & (rho > -1) & (b > 0) & (g > 0) & (x >= v1 * t) & (1000 * (1 + rho) * b + g * i > 0)
    return implies(known & is_ceiling(c, x, b, t, v1) & (v <= c), slows_on_the_gradient(v, v1, x, t, b, i, rho, g))


# --- build-up at a limited jerk --------------------------------------------------------------------------------------


@law(expect=PROVED, requirement="SP-P1", source=BUILD_UP)
def building_up_is_the_motion_with_the_full_brake(v: Real, x: Real, b: Real, t: Real, tau: Real, v1: Real) -> Bit:
    """Down to v1 after the full brake came: the rule says that the way to v - b tau / 2 and on to v1 fits."""
    reached, way = v - b * tau / 2, v * t + v * tau - b * tau * tau / 6
    known = (b > 0) & (tau >= 0) & (v > v1) & (reached >= v1)
    fits = reached * reached - v1 * v1 <= 2 * b * (x - way)
    return implies(known, permits_building_up(v, x, b, t, tau, v1) == fits)


@law(expect=PROVED, requirement="SP-P1", source=BUILD_UP)
def building_up_is_the_motion_before_the_full_brake(x: Real, j: Real, tau: Real, v1: Real, s: Real) -> Bit:
    """Down to v1 in s seconds at jerk j, before the full brake: the rule says that the way v s - j s^3 / 6 fits."""
    v, b = v1 + j * s * s / 2, j * tau
    known = (j > 0) & (v1 >= 0) & (s > 0) & (s < tau)
    return implies(known, permits_building_up(v, x, b, 0, tau, v1) == (v * s - j * s * s * s / 6 <= x))


@law(expect=PROVED, requirement="SP-P1", source=BUILD_UP)
def half_the_build_up_as_free_run_is_safe(v: Real, x: Real, b: Real, t: Real, tau: Real, v1: Real) -> Bit:
    """What the ceiling permits with half the build-up added to the free run, the exact one permits too."""
    known = (v >= 0) & (v1 >= 0) & (b > 0) & (tau >= 0)
    return implies(known & permits(v, x, b, same_as_free_run(t, tau), v1), permits_building_up(v, x, b, t, tau, v1))


@law(expect=REFUTED, requirement="SP-P1", source=BUILD_UP, twin_of=half_the_build_up_as_free_run_is_safe)
def a_third_of_the_build_up_as_free_run_is_safe(v: Real, x: Real, b: Real, t: Real, tau: Real, v1: Real) -> Bit:
    """The same with a third of the build-up.  False."""
    known = (v >= 0) & (v1 >= 0) & (b > 0) & (tau >= 0)
    return implies(known & permits(v, x, b, t + tau / 3, v1), permits_building_up(v, x, b, t, tau, v1))


@law(expect=REFUTED, requirement="SP-P1", source=BUILD_UP, twin_of=half_the_build_up_as_free_run_is_safe)
def a_full_brake_at_once_is_safe(v: Real, x: Real, b: Real, t: Real, tau: Real, v1: Real) -> Bit:
    """The same with the build-up left out.  False."""
    known = (v >= 0) & (v1 >= 0) & (b > 0) & (tau >= 0)
    return implies(known & permits(v, x, b, t, v1), permits_building_up(v, x, b, t, tau, v1))
