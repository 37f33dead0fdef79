"""Braking as both audited papers need it: symbols, and relations as text.

Neither paper prints a deceleration, a free-run time or a margin.  The references are assumed, and so are the ranges in
which a verdict must stand if it is not to rest on them.
Source: speed patterns, section 1 [A]; relations [D].
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise

from safety.audit import Known, Paper, Span, assumed, derived

STOP = "V*t + V^2/(2*b)"  # with constant speed during the free run
CEILING = "sqrt((b*t)^2 + V1^2 + 2*b*X) - b*t"  # the inverse of slowing down to V1, in V
CONSERVATIVE = "sqrt((b*t)^2 + 2*b*(X + a*t^2/2)) - b*t - a*t"  # traction during the free run
FASTEST = "sqrt((b*t)^2 + 2*b*l) - b*t"  # from which the train stops within l
OF_BIN = "v0^2/2*(1/(b - g*p) - 1/(b - g*q))"  # stopping distances on downgrades p and q, subtracted

GRAVITY = assumed("9.80665", "9.78", "9.84")
BRAKES = {
    "b_s": assumed("2.5", "1.5", "4.5"),
    "b_e": assumed("3.5", "2", "5"),
    "t_s": assumed("2.0", "0.5", "4"),
    "t_e": assumed("1.5", "0.3", "3"),
}
MARGIN = assumed("10", "0", "100")

SYMBOLS: tuple[tuple[str, str, str, Known | None, str], ...] = (  # name, unit, what it is, value, definition
    ("g", "m/s^2", "gravity", GRAVITY, ""),
    ("b_s", "km/h/s", "service deceleration, level", BRAKES["b_s"], ""),
    ("b_e", "km/h/s", "emergency deceleration, level", BRAKES["b_e"], ""),
    ("t_s", "s", "free-run time of the service brake", BRAKES["t_s"], ""),
    ("t_e", "s", "of the emergency brake", BRAKES["t_e"], ""),
    ("m", "m", "margin before the protected point", MARGIN, ""),
    ("a", "m/s^2", "traction that may last through the free run", assumed("0.8", "0.3", "1.2"), ""),
    ("V", "km/h", "speed", None, ""),
    ("V1", "km/h", "lower speed", None, ""),
    ("b", "km/h/s", "deceleration", None, ""),
    ("t", "s", "free-run time", None, ""),
    ("x", "m", "distance to the protected point", None, ""),
    ("X", "m", "the same less the margin", None, "x - m"),
    ("l", "m", "distance from the last marker to the signal", None, ""),
    ("v0", "km/h", "speed at which the brake comes on", None, ""),
    ("p", "m/km", "downgrade", None, ""),
    ("q", "m/km", "a less steep one", None, ""),
)
SIGNED = ("p", "q")
STANDING = derived(0)
METRE = Fraction(18, 5)  # km/h times s in one metre


def declare(paper: Paper) -> None:
    """Declare the symbols of braking in a paper."""
    for name, unit, about, known, by in SYMBOLS:
        paper.symbol(name, unit, about, known, by=by, signed=name in SIGNED)


def through(speeds: Sequence[Fraction | int], name: str = "") -> Callable[..., Span]:
    """The way in m through a ladder of limits in km/h, one after the other, as a relation of `b` (km/h/s) and `t` (s).

    Each limit takes a free run and a braking of its own.
    """

    def way(b: Span, t: Span) -> Span:
        parts = [high * t + (high * high - low * low) / (2 * b) for high, low in pairwise(map(Fraction, speeds))]
        return sum(parts[1:], parts[0]) / METRE

    way.__doc__ = name or f"free run and braking for each of {' -> '.join(f'{float(v):.6g}' for v in speeds)} km/h"
    return way
