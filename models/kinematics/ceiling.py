"""Distances and ceilings as numbers: exact where they are rational, else certified enclosures or doubles.

`distance` works on all kinds of numbers that can be divided.  A ceiling has a square root: `ceiling` gives rational
ends as near as wanted, `ceiling_float` a double.  For the letters, see `braking`.

Main results: at 400 m with 10 m margin the service ceiling is 78.934 km/h, 67.477 at -20 and 88.687 at +20 permille;
the conservative one 73.346.
"""

from __future__ import annotations

from fractions import Fraction
from math import sqrt

from models import enclosure
from models.enclosure import DIGITS, Exact, Interval
from models.kinematics.braking import Quantity
from models.kinematics.refusal import exact, not_negative, positive, refuse, shown


def root(x: Exact, digits: int = DIGITS) -> Interval:
    """Square root as an enclosure; ModelError below 0, and for what is no exact number."""
    exact("radicand", x, "")
    not_negative("radicand", x, "")
    return enclosure.root(x, digits)


def distance(v: Quantity, b: Quantity, t: Quantity, v1: Quantity = 0) -> Quantity:
    """Way from v down to v1, free run included; ModelError unless v >= v1 >= 0, b > 0 and t >= 0."""
    _refuse_bad(b, t, v1)
    if not v >= v1:
        refuse("speed", v, "m/s", f"it is below the {shown(v1)} m/s it is to be slowed to", f"{shown(v1)} m/s")
    if isinstance(b, int):
        b = Fraction(b)  # whole numbers stay exact
    return v * t + (v * v - v1 * v1) / (2 * b)


def ceiling(x: Exact, b: Exact, t: Exact, v1: Exact = 0, digits: int = DIGITS) -> Interval:
    """v_p(x, v1), m/s: the greatest speed that `permits` admits; ModelError unless b > 0, t >= 0 and v1 >= 0."""
    _refuse_bad(b, t, v1)
    for what, value, unit in (("distance", x, "m"), ("deceleration", b, "m/s^2"), ("free run", t, "s")):
        exact(what, value, unit)
    if x < v1 * t:
        return Interval(Fraction(v1), Fraction(v1))
    return root((b * t) ** 2 + v1 * v1 + 2 * b * x, digits).shifted(-b * t)


def ceiling_float(x: float, b: float, t: float, v1: float = 0.0) -> float:
    """The same in doubles."""
    _refuse_bad(b, t, v1)
    return sqrt((b * t) ** 2 + v1 * v1 + 2 * b * x) - b * t if x >= v1 * t else v1


def ceiling_accelerating(x: Exact, b: Exact, t: Exact, a: Exact, v1: Exact = 0, digits: int = DIGITS) -> Interval:
    """v_pc(x, v1), m/s: the greatest speed that `permits_accelerating` admits.

    Below 0 it means that traction is cut and the brake held at every speed; it is not to be clamped to 0.  With v1 = 0
    there is none at x < 0, which is refused.
    """
    _refuse_bad(b, t, v1)
    not_negative("acceleration", a, "m/s^2")
    if v1 == 0:
        not_negative("distance", x, "m (behind the point the brake is held at every speed)")
    inside = (b * t) ** 2 + v1 * v1 + 2 * b * (x + Fraction(a * t * t) / 2)
    if v1 > 0 and inside <= (b * t + v1) ** 2:
        return Interval(v1 - Fraction(a) * t, v1 - Fraction(a) * t)
    return root(inside, digits).shifted(-b * t - a * t)


def distance_building_up(
    v: Exact, b: Exact, t: Exact, build_up: Exact, v1: Exact = 0, digits: int = DIGITS
) -> Interval:
    """Way from v down to v1 under a brake that rises linearly to b within `build_up` seconds after t [A]."""
    not_negative("build-up time", build_up, "s")
    distance(v, b, t, v1)  # refuses what it refuses
    lost, b = Fraction(v) - v1, Fraction(b)
    if 2 * lost >= b * build_up:
        way = distance(v, b, t + Fraction(build_up) / 2, v1) - b * build_up * build_up / 24
        return Interval(way, way)
    return root(2 * lost * build_up / b, digits).scaled((2 * Fraction(v) + v1) / 3).shifted(v * t)


def _refuse_bad(b: Quantity, t: Quantity, v1: Quantity) -> None:
    positive("deceleration", b, "m/s^2")
    not_negative("free run", t, "s")
    not_negative("target speed", v1, "m/s")
