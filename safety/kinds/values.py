"""Kinds for quantities: a reading that is off by a constant, wanders away, or is noisy."""

from __future__ import annotations

import zlib
from fractions import Fraction
from typing import Any, cast

from safety.kinds.kind import NUMBERS, Draw, Kind, Seat
from safety.system import ModelError
from safety.terms import Int, Real, UInt, real, select
from safety.terms.construct import clamp
from safety.terms.graph import REAL, Sort, Term, integer, uint

FINE = 1 << 10  # steps between 0 and the amplitude in which a run draws the noise of a real


def offset(by: int | Fraction) -> Kind:
    """Sensor offset: the reading is off by a constant; a word or integer stays at its bounds."""
    distance = _amount(by, f"offset({by!r})", "an offset other than 0")
    name = f"off by {_signed(distance)}"

    def effect(_: Seat, healthy: Term) -> Term:
        return _plus(healthy, distance if healthy.sort == REAL else _ones(distance, healthy.sort, name))

    return Kind(name, "reads too much or too little by a constant", effect, NUMBERS, unit="unit of the point")


def drift(rate: int | Fraction) -> Kind:
    """Drift: at the n-th step of its being active the reading is off by `n * rate`, rounded towards 0.

    A word or integer stays at its bounds, a real goes on for ever; a new onset starts anew.
    """
    speed = _amount(rate, f"drift({rate!r})", "a rate other than 0")
    up, down = abs(speed).as_integer_ratio()

    def effect(seat: Seat, healthy: Term) -> Term:
        if healthy.sort == REAL:
            gone = cast(Real, seat.register("gone", REAL, 0))
            seat.then(gone, select(seat.active, gone + speed, real(0)))
            return _plus(healthy, gone + speed)
        low, high = healthy.sort.bounds
        parts = cast(UInt, seat.register("gone", uint(max((high - low) * down, 1).bit_length()), 0))
        now = (parts + up).sat(parts.width)
        seat.then(parts, select(seat.active, now, 0))
        distance = (now // down).int()
        return _plus(healthy, distance if speed > 0 else 0 - distance)

    meaning = "wanders away from the healthy value, step by step"
    return Kind(
        f"drift by {_signed(speed)} a step",
        meaning,
        effect,
        NUMBERS,
        unit="unit of the point per step",
        reference="IEC 61508-2:2010 table A.1 (drift and oscillation)",
    )


def noise(amplitude: int | Fraction, seed: int = 0) -> Kind:
    """Noise: at every step the reading is off by anything from `-amplitude` to `amplitude`, within its bounds.

    A proof leaves the deviation open at every step and point.  A run takes one of these: what `Fault.values` says at
    the point, else pseudo-random numbers that `seed`, point and step decide, so that a run can be repeated.
    """
    most = _amount(amplitude, f"noise({amplitude!r})", "an amplitude above 0")
    if most < 0:
        raise ModelError(f"noise({amplitude!r}): write an amplitude above 0")
    if type(seed) is not int:
        raise ModelError(f"noise(..., seed={seed!r}): a seed is a whole number")
    name = f"noise of {amplitude}"

    def effect(seat: Seat, healthy: Term) -> Term:
        if healthy.sort == REAL:
            chosen = cast(Real, seat.free("value", REAL, _drawn(seed, FINE, most / FINE)))
            bounded = select(chosen > most, real(most), select(chosen < -most, real(-most), chosen))
            return _plus(healthy, bounded)
        ones = _ones(most, healthy.sort, name)
        return _plus(healthy, seat.free("value", integer(-ones, ones), _drawn(seed, ones, 1)))

    return Kind(name, f"off by up to {amplitude}, anew at every step", effect, NUMBERS, unit="unit of the point")


def _amount(value: Any, call: str, wanted: str) -> Fraction:
    if isinstance(value, bool) or not isinstance(value, int | Fraction) or value == 0:
        raise ModelError(f"{call}: write {wanted}, a whole number or an exact Fraction")
    return Fraction(value)


def _signed(value: Fraction) -> str:
    return f"+{value}" if value > 0 else str(value)


def _ones(value: Fraction, sort: Sort, name: str) -> int:
    """An amount as a whole number; `ModelError` where a point of whole values cannot be off by it."""
    if value.denominator != 1:
        raise ModelError(f"{name}: a point of {sort} is off by whole numbers only")
    return int(value)


def _plus(healthy: Term, more: Term | int | Fraction) -> Term:
    """The sum; of whole values the nearest one that the sort has."""
    if healthy.sort == REAL:
        return cast(Real, healthy) + more
    value = cast(UInt, healthy).int() if healthy.sort.kind == "uint" else cast(Int, healthy)
    total: Term = value + cast(Any, more)
    return clamp(total, healthy.sort)


def _drawn(seed: int, most: int, unit: int | Fraction) -> Draw:
    """Whole numbers from `-most` to `most` times a unit, by point and step: SplitMix64 (Steele, Lea, Flood 2014)."""

    def draw(point: str, step: int) -> int | Fraction:
        z = (zlib.crc32(point.encode()) + (seed << 32) + (step + 1) * 0x9E3779B97F4A7C15) % 2**64
        z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9 % 2**64
        z = (z ^ z >> 27) * 0x94D049BB133111EB % 2**64
        return ((z ^ z >> 31) % (2 * most + 1) - most) * unit

    return draw
