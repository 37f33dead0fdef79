"""Braking to a speed at a point: the rule that everything here supervises with, in one text for all kinds of numbers.

Whatever has + - * and comparison will do: Fraction, float, an arb ball, a Real term of a model or law; do not mix kinds
other than with whole numbers and Fractions.  A decision is a bool, of terms a Bit, and is free of quotients and square
roots.  Of balls it is true only where it surely holds, so `permits` and `intervenes` may both be false.
All speeds from 0 up.

    v   speed, m/s                       x   distance left before v1 must be held (margin taken off), m
    v1  speed to be held from there, m/s b   effective deceleration, m/s^2, above 0
    t   free run before b acts, s        a   acceleration until then at most, m/s^2
    i   gradient, permille, uphill positive      rho  share of rotating masses

Source: speed patterns, common physics [D]; speed constant in free run, gradient in braking only [A].
Main results: 100 km/h stop in 611.111 m (service) and 438.492 m (emergency); at -20 permille in 829.775 m.
"""

from __future__ import annotations

from typing import Any

from models.kinematics.refusal import at_least, not_negative, refuse, shown
from models.kinematics.units import G
from safety.terms import Term

Quantity = Any  # Fraction, float, arb ball or Real term
Decision = Any  # bool, or Bit of terms


# --- deceleration ----------------------------------------------------------------------------------------------------


def effective(b: Quantity, i: Quantity = 0, rho: Quantity = 0, g: Quantity = G) -> Quantity:
    """Deceleration on a gradient, of a brake that gives b on the level.

    Raises ModelError where no stop is possible, with the downgrade that bounds it; a model requires it of terms.
    """
    not_negative("share of rotating masses", rho, "")
    result = b + i * g / (1000 * (1 + rho))
    if not isinstance(result, Term) and not result > 0:
        refuse("gradient", i, "permille", f"a brake of {shown(b)} m/s^2 stops no train there",
               f"above {at_least(-1000 * (1 + rho) * b / g)} permille")  # fmt: skip
    return result


def is_effective(b_eff: Quantity, b: Quantity, i: Quantity, rho: Quantity, g: Quantity = G) -> Decision:
    """Whether `b_eff` is the effective deceleration; the same without a quotient."""
    return (b_eff - b) * (1 + rho) * 1000 == g * i


# --- the ceiling -----------------------------------------------------------------------------------------------------


def need(v: Quantity, b: Quantity, t: Quantity, v1: Quantity = 0) -> Quantity:
    """2 b times the way from v down to v1, free run included."""
    return 2 * b * v * t + v * v - v1 * v1


def permits(v: Quantity, x: Quantity, b: Quantity, t: Quantity, v1: Quantity = 0) -> Decision:
    """v <= v_p(x, v1): the ceiling is kept.  Below v1 everything is permitted, wherever the point is."""
    return (v <= v1) | (need(v, b, t, v1) <= 2 * b * x)


def intervenes(v: Quantity, x: Quantity, b: Quantity, t: Quantity, v1: Quantity = 0) -> Decision:
    """v > v_p(x, v1): the brake is asked for.  Equality does not intervene."""
    return (v > v1) & (need(v, b, t, v1) > 2 * b * x)


def stops_within(v: Quantity, x: Quantity, b: Quantity, t: Quantity, v1: Quantity = 0) -> Decision:
    """v t + (v^2 - v1^2) / 2b <= x: free run and braking to v1 fit."""
    return need(v, b, t, v1) <= 2 * b * x


def is_ceiling(c: Quantity, x: Quantity, b: Quantity, t: Quantity, v1: Quantity = 0) -> Decision:
    """c = v_p(x, v1), its definition: -b t + sqrt((b t)^2 + v1^2 + 2 b x) from x = v1 t up, before that v1."""
    root = c + b * t
    return ((x >= v1 * t) & (root >= 0) & (root * root == b * t * b * t + v1 * v1 + 2 * b * x)) | (
        (x < v1 * t) & (c == v1)
    )


# --- the conservative ceiling ----------------------------------------------------------------------------------------


def permits_accelerating(v: Quantity, x: Quantity, b: Quantity, t: Quantity, a: Quantity, v1: Quantity = 0) -> Decision:
    """v <= v_pc(x, v1): the ceiling is kept even when the train goes on accelerating by a during t.

    With v1 = 0 and x < 0 nothing is permitted, not even standstill: traction cut, brake held.
    """
    return ((v1 > 0) & (v + a * t <= v1)) | stops_accelerating(v, x, b, t, a, v1)


def intervenes_accelerating(
    v: Quantity, x: Quantity, b: Quantity, t: Quantity, a: Quantity, v1: Quantity = 0
) -> Decision:
    """v > v_pc(x, v1)."""
    return ((v1 <= 0) | (v + a * t > v1)) & (need_accelerating(v, b, t, a) - v1 * v1 > 2 * b * x)


def stops_accelerating(v: Quantity, x: Quantity, b: Quantity, t: Quantity, a: Quantity, v1: Quantity = 0) -> Decision:
    """(v + a t)^2 - v1^2 <= 2 b (x - v t - a t^2 / 2): acceleration during t and braking to v1 fit."""
    return need_accelerating(v, b, t, a) - v1 * v1 <= 2 * b * x


def is_ceiling_accelerating(c: Quantity, x: Quantity, b: Quantity, t: Quantity, a: Quantity) -> Decision:
    """c = v_pc(x): w - a t with w = -b t + sqrt((b t)^2 + 2 b (x + a t^2 / 2)); below 0 it stays below 0."""
    root = c + a * t + b * t
    return (root >= 0) & (root * root == b * t * b * t + 2 * b * x + a * b * t * t)


def need_accelerating(v: Quantity, b: Quantity, t: Quantity, a: Quantity) -> Quantity:
    """2 b times the way from v to a stop: traction at a for t more seconds, then the brake."""
    reached = v + a * t
    return reached * reached + b * t * (2 * v + a * t)


# --- build-up of the brake -------------------------------------------------------------------------------------------


def permits_building_up(
    v: Quantity, x: Quantity, b: Quantity, t: Quantity, build_up: Quantity, v1: Quantity = 0
) -> Decision:
    """The exact ceiling of a brake limited in jerk: after t it rises linearly to b within `build_up` seconds [A].

    The jerk is b / build_up.  A train that reaches v1 earlier never has the full brake.
    """
    rest = x - v * t
    lost = v - v1
    full = 24 * b * rest >= 12 * (v * v - v1 * v1) + 12 * b * build_up * v - b * b * build_up * build_up
    earlier = (rest >= 0) & (9 * b * rest * rest >= 2 * build_up * lost * (2 * v + v1) * (2 * v + v1))
    return (lost <= 0) | ((2 * lost >= b * build_up) & full) | ((2 * lost < b * build_up) & earlier)


def same_as_free_run(t: Quantity, build_up: Quantity) -> Quantity:
    """A free run that is no less safe: half the build-up added (law: the ceiling with it is never above the exact)."""
    return t + build_up / 2
