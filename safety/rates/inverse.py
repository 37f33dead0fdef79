"""Inverse problems: which rate meets a target? Answers are brackets whose ends are checked in exact arithmetic."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import isqrt

from safety.rates.enclosure import Enclosure, Extended
from safety.rates.exceptions import Unreachable

_MOST_DOUBLINGS = 400


def solve_decreasing(
    mean_time: Callable[[Fraction], Extended], target: Fraction, relative: Fraction = Fraction(1, 10**12)
) -> Enclosure:
    """Brackets the rate x >= 0 with mean_time(x) = target by bisection: mean_time(low) >= target >= mean_time(high).

    `mean_time` must fall as the rate rises, as the mean time to failure of any coherent structure does. Target in
    hours, answer per hour. Raises Unreachable when rate 0 is not enough, or no rate is too much.
    """
    at_zero = mean_time(Fraction(0))
    if at_zero < target:
        raise Unreachable(f"{float(target):g} h is out of reach: rate 0 gives {float(at_zero):g} h; lower another rate")
    if at_zero == target:
        return Enclosure.exactly(Fraction(0))
    high = 1 / target
    for _ in range(_MOST_DOUBLINGS):
        if mean_time(high) <= target:
            break
        high *= 2
    else:
        raise Unreachable(f"{float(target):g} h is exceeded at all rates up to {float(high):.0e} /h; it has no say")
    low = high
    while mean_time(low) < target:
        low /= 2
    while high - low > relative * high:
        middle = (low + high) / 2
        if mean_time(middle) >= target:
            low = middle
        else:
            high = middle
    return Enclosure(low, high)


def larger_root(a: Fraction, b: Fraction, c: Fraction, what: str) -> Enclosure:
    """Encloses the larger root of a x^2 + b x + c with a > 0 >= c, which is not negative; exact when it is rational.

    Raises Unreachable, saying that no rate gives `what`, when c > 0.
    """
    if c > 0:
        raise Unreachable(f"no rate gives {what}; lower another rate")
    low, high = square_root(b * b - 4 * a * c)
    return Enclosure((low - b) / (2 * a), (high - b) / (2 * a))


def square_root(x: Fraction, bits: int = 256) -> tuple[Fraction, Fraction]:
    """Lower and upper bound of the root of x >= 0: equal when it is rational, else some 2^-bits of it apart."""
    radicand = x.numerator * x.denominator
    root = isqrt(radicand)
    if root * root == radicand:
        return Fraction(root, x.denominator), Fraction(root, x.denominator)
    scaled = isqrt(radicand << 2 * bits)
    return Fraction(scaled, x.denominator << bits), Fraction(scaled + 1, x.denominator << bits)
