"""Polynomials with rational coefficients, and exact intervals of their values over boxes.

A box is a list of intervals, one for each variable; an interval is a pair of rationals (FLINT), lowest first.  Ends are
exact: no rounding, so that a bound which is attained at a corner is seen to hold there.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import isqrt
from typing import Any

from flint import fmpq

Interval = tuple[fmpq, fmpq]
Box = list[Interval]
ZERO, ONE = fmpq(0), fmpq(1)


class Polynomial:
    """A FLINT polynomial in normal form, with what is asked of it again and again; equal where the polynomial is."""

    def __init__(self, source: Any) -> None:
        self.source = source
        self.terms = [
            (coefficient, tuple((i, int(power)) for i, power in enumerate(powers) if power))
            for powers, coefficient in zip(source.monoms(), source.coeffs(), strict=True)
        ]
        self._derivatives: dict[int, Polynomial] = {}
        self._shapes: dict[int, dict[int, Polynomial]] = {}

    @cached_property
    def _key(self) -> frozenset[Any]:
        return frozenset((powers, int(c.p), int(c.q)) for c, powers in self.terms)

    def __hash__(self) -> int:
        return hash(self._key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Polynomial) and self._key == other._key

    def __neg__(self) -> Polynomial:
        return Polynomial(-self.source)

    def __add__(self, other: Polynomial) -> Polynomial:
        return Polynomial(self.source + other.source)

    def __sub__(self, other: Polynomial) -> Polynomial:
        return Polynomial(self.source - other.source)

    def __mul__(self, other: Polynomial) -> Polynomial:
        return Polynomial(self.source * other.source)

    @cached_property
    def variables(self) -> tuple[int, ...]:
        """The numbers of the variables in it, in order."""
        return tuple(sorted({i for _, powers in self.terms for i, _ in powers}))

    @property
    def constant(self) -> fmpq | None:
        """Its value, if it has no variables."""
        if self.variables:
            return None
        return self.terms[0][0] if self.terms else ZERO

    def derivative(self, variable: int) -> Polynomial:
        """With respect to one variable."""
        if variable not in self._derivatives:
            self._derivatives[variable] = Polynomial(self.source.derivative(variable))
        return self._derivatives[variable]

    def in_powers_of(self, variable: int) -> dict[int, Polynomial]:
        """Its coefficients, free of the variable, by the power of the variable."""
        if variable not in self._shapes:
            context = self.source.context()
            parts: dict[int, dict[tuple[int, ...], fmpq]] = {}
            for powers, coefficient in zip(self.source.monoms(), self.source.coeffs(), strict=True):
                rest = tuple(0 if i == variable else int(p) for i, p in enumerate(powers))
                parts.setdefault(int(powers[variable]), {})[rest] = coefficient
            self._shapes[variable] = {k: Polynomial(context.from_dict(p)) for k, p in parts.items()}
        return self._shapes[variable]

    def at(self, point: Sequence[fmpq]) -> fmpq:
        """Its value at a point: one number for each variable."""
        value: fmpq = self.source(*point)
        return value

    def over(self, box: Sequence[Interval]) -> Interval:
        """An interval that holds all its values over a box."""
        low = high = ZERO
        for coefficient, powers in self.terms:
            part: Interval | None = None
            for i, power in powers:
                value = box[i] if power == 1 else raised(box[i], power)
                part = value if part is None else times(part, value)
            a, b = part or (ONE, ONE)
            if coefficient.p < 0:
                a, b = b, a
            low, high = low + coefficient * a, high + coefficient * b
        return low, high


def times(x: Interval, y: Interval) -> Interval:
    """The exact product."""
    (a, b), (c, d) = x, y
    if a.p >= 0:  # the sign of a rational is that of its numerator, and sooner known
        return (a if c.p >= 0 else b) * c, (b if d.p >= 0 else a) * d
    if b.p <= 0:
        return (a if d.p >= 0 else b) * d, (b if c.p >= 0 else a) * c
    if c.p >= 0:
        return a * d, b * d
    if d.p <= 0:
        return b * c, a * c
    return min(a * d, b * c), max(a * c, b * d)


def raised(x: Interval, power: int) -> Interval:
    """The exact power, from 1 up."""
    low, high = x
    if power == 1:
        return x
    if power % 2 or low.p >= 0:
        return low**power, high**power
    if high.p <= 0:
        return high**power, low**power
    return ZERO, max(low**power, high**power)


def quotient(x: Interval, y: Interval) -> Interval:
    """The exact quotient; `y` does not hold zero."""
    return times(x, (1 / y[1], 1 / y[0]))


def rounded(x: fmpq, up: bool, bits: int = 48) -> fmpq:
    """A rational of few digits just above (or below) one of many; the same where it is short already."""
    if x.height_bits() <= 2 * bits:
        return x
    size = bits - (int(x.p).bit_length() - int(x.q).bit_length())
    scaled = (int(x.p) << size, int(x.q)) if size >= 0 else (int(x.p), int(x.q) << -size)
    whole = -(-scaled[0] // scaled[1]) if up else scaled[0] // scaled[1]
    return fmpq(whole, 1 << size) if size >= 0 else fmpq(whole << -size)


def root(x: fmpq, up: bool, bits: int = 48) -> fmpq:
    """A rational just above (or below) the square root of a number from 0 up; the root itself where it is rational."""
    p, q = int(x.p), int(x.q)
    if isqrt(p) ** 2 == p and isqrt(q) ** 2 == q:
        return fmpq(isqrt(p), isqrt(q))
    shift = max(0, 2 * bits - p.bit_length() + q.bit_length())
    shift += shift % 2
    below = isqrt((p << shift) // q)
    return fmpq(below + up, 1 << shift // 2)
