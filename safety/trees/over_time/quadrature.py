"""Integrals over time of what a tree does, with a certified error: Gauss's rule on panels.

Between tests every unavailability q_i is a sum of exponentials, hence analytic, and so is that of the top, Q, a sum
over states of products of q_i and 1 - q_i. On a panel of width h, in the ellipse around it whose half axes add up to
R h / 2, |Q| is at most M = product of max(|q_i| + |1 - q_i|). Gauss's rule of n points is exact for degree 2n - 1, and
a Chebyshev series cut there leaves at most 2 M R^-(2n-1) / (R - 1), so the rule errs by at most
4 h M R^-(2n-1) / (R - 1). R = 3 + 2 sqrt(2) is taken, for which the ellipse of a panel [a, 2a] just keeps to real
parts of 0 or more: panels that double their width reach from the shortest time constant to the longest.

Source: L. N. Trefethen, "Is Gauss quadrature better than Clenshaw-Curtis?", SIAM Review 50 (2008), theorem 4.5 and its
proof.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Collection, Iterator
from fractions import Fraction
from functools import cache
from typing import NamedTuple

from safety.trees.over_time.behaviour import LARGEST, Behaviour
from safety.trees.solve import Solution

R = 3 + 2 * math.sqrt(2)
EXTRA_POINTS = 40  # of the rule on one panel for what its events grow by; where more are needed the panel is halved
HALF_ULP = 2.0**-53  # the largest relative error of one rounding
LEAST = 1e-300  # scale of what is integrated, below which it counts as zero
READ_BITS = 200  # of a rational that is written out: 60 digits
TOLERANCE = 1e-15  # of the integral, aimed at
ROUNDINGS = (
    200  # half ulps per event or module; all but a few are for exp(-x), up to the x that matter (e^-40 is 4e-18)
)


class Bounds(NamedTuple):
    """A figure lies between the two."""

    low: float
    high: float

    @classmethod
    def of(cls, exact: Fraction) -> Bounds:
        """The doubles next to a rational that is not negative."""
        if exact > sys.float_info.max:
            return cls(sys.float_info.max, math.inf)
        nearest = float(exact)
        return cls(
            nearest if nearest <= exact else math.nextafter(nearest, -math.inf),
            nearest if nearest >= exact else math.nextafter(nearest, math.inf),
        )

    def times(self, factor: float) -> Bounds:
        """Both multiplied by a positive number, outwards."""
        return Bounds(math.nextafter(self.low * factor, 0.0), math.nextafter(self.high * factor, math.inf))

    def plain(self) -> dict[str, float]:
        """The entry of a results document."""
        return {"value": (self.low + self.high) / 2, "low": self.low, "high": self.high}


class Panel(NamedTuple):
    """From `low` to `high` hours after `base`, the beginning or a test."""

    base: Fraction
    low: float
    high: float

    @property
    def middle(self) -> float:
        """Hours after `base`."""
        return (self.low + self.high) / 2

    @property
    def width(self) -> float:
        """Hours."""
        return self.high - self.low


class Rule(NamedTuple):
    """Gauss's rule of `points` points on a panel, whose error is at most `cut`."""

    panel: Panel
    points: int
    cut: float

    def places(self) -> Iterator[tuple[tuple[Fraction, float], float]]:
        """Each place, a time and the hours after it, with its weight in hours."""
        base, half = self.panel.base, self.panel.width / 2
        for x, weight in gauss(self.points):
            yield (base, self.panel.middle + half * x), weight * half


def written(exact: Fraction | None) -> str | None:
    """A rational as text, None where it has more digits than are read."""
    if exact is None or exact.numerator.bit_length() + exact.denominator.bit_length() > READ_BITS:
        return None
    return str(exact)


def rounding(solution: Solution, tests: int = 0) -> float:
    """A bound of the relative error by rounding of the probability at a time, and of an integral over it.

    For coherent trees: there the relative error of the top is at most the sum of those of the events, which may rise
    from one of their `tests` to the next.
    """
    return HALF_ULP * (ROUNDINGS + 20 * tests) * (2 * len(solution.events) + len(solution.parts) + 10)


def doubling(base: Fraction, length: float, shortest: float) -> Iterator[Panel]:
    """Panels over `length` hours from `base` on, the first `shortest` long and each as long as all before."""
    low, high = 0.0, min(length, shortest)
    while low < length:
        yield Panel(base, low, high)
        low, high = high, min(length, 2 * high)


def rules(events: Collection[Behaviour], panel: Panel, scale: float, factor: float = 1.0) -> Iterator[Rule]:
    """Rules that together cover `panel`, whose cut is about TOLERANCE * scale * its width.

    `scale` is a typical value of what is integrated, at most `factor` times M on the ellipse.
    """
    level = math.log(max(1.0, factor) * 4 / (R - 1)) - math.log(TOLERANCE * max(scale, LEAST))
    agenda = [panel]
    while agenda:
        part = agenda.pop()
        half, growth = part.width / 2, 0.0
        for event in events:
            begin, piece = event.piece(part.base + Fraction(part.middle))
            growth += piece.growth(float(part.base - begin) + part.middle - 3 * half, 2 * math.sqrt(2) * half)
        if growth > 2 * EXTRA_POINTS * math.log(R) and part.low < part.middle < part.high:
            agenda += [Panel(part.base, part.middle, part.high), Panel(part.base, part.low, part.middle)]
            continue
        points = math.ceil(((level + min(growth, LARGEST)) / math.log(R) + 1) / 2)
        bound = math.exp(growth - (2 * points - 1) * math.log(R)) if growth <= LARGEST else math.inf
        yield Rule(part, points, 4 * part.width * bound / (R - 1))


@cache
def gauss(n: int) -> list[tuple[float, float]]:
    """Points and weights of Gauss's rule over [-1, 1], correctly rounded."""
    from flint import arb, ctx

    with ctx.workprec(200):
        pairs = [arb.legendre_p_root(n, k, weight=True) for k in range(n)]
        return [(float(x.mid()), float(w.mid())) for x, w in pairs]
