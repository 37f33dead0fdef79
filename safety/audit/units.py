"""Units: what a number is multiplied by to be in the coherent system, and of what dimension it is.

Units are written as formulas of the names below: `km/h/s`, `Hz/(km/h)`, `1`, `%`.  Conversions are exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import isqrt

from safety.audit.exceptions import AuditError
from safety.audit.formula import Formula, Reading, formula

Dimension = tuple[tuple[str, Fraction], ...]  # base and exponent, in order of name; nothing for a pure number


class Mismatch(AuditError):
    """Quantities of different dimensions are added or compared."""


def _product(a: Dimension, b: Dimension, sign: int) -> Dimension:
    powers = dict(a)
    for base, power in b:
        powers[base] = powers.get(base, Fraction(0)) + sign * power
    return tuple(sorted((base, power) for base, power in powers.items() if power))


@dataclass(frozen=True)
class Unit:
    """A scale and a dimension; + and - refuse what differs in dimension."""

    scale: Fraction
    dimension: Dimension = ()

    def __mul__(self, other: Unit) -> Unit:
        return Unit(self.scale * other.scale, _product(self.dimension, other.dimension, 1))

    def __truediv__(self, other: Unit) -> Unit:
        return Unit(self.scale / other.scale, _product(self.dimension, other.dimension, -1))

    def __add__(self, other: Unit) -> Unit:
        if self.dimension != other.dimension:
            raise Mismatch(f"{self.named()} and {other.named()} cannot be added")
        return self

    __sub__ = __add__

    def __neg__(self) -> Unit:
        return self

    def root(self) -> Unit:
        """Of the square root."""
        top, bottom = isqrt(self.scale.numerator), isqrt(self.scale.denominator)
        return Unit(Fraction(top, bottom), tuple((base, power / 2) for base, power in self.dimension))

    def named(self) -> str:
        """The dimension in words: `m s^-2`."""
        return " ".join(base if power == 1 else f"{base}^{power}" for base, power in self.dimension) or "a pure number"


ONE = Unit(Fraction(1))
_BASES = {"m": "m", "s": "s", "g": "g", "V": "V", "A": "A", "K": "K"}
_NAMES = {name: Unit(Fraction(1), ((base, Fraction(1)),)) for name, base in _BASES.items()}
_NAMES |= {
    "Hz": ONE / _NAMES["s"],
    "percent": Unit(Fraction(1, 100)),
    "ppm": Unit(Fraction(1, 1_000_000)),
    "min": Unit(Fraction(60)) * _NAMES["s"],
    "h": Unit(Fraction(3600)) * _NAMES["s"],
    "mile": Unit(Fraction("1609.344")) * _NAMES["m"],
    "day": Unit(Fraction(86400)) * _NAMES["s"],
    "W": _NAMES["V"] * _NAMES["A"],
    "ohm": _NAMES["V"] / _NAMES["A"],
}
_PREFIXES = {
    name: Fraction(text)
    for name, text in {"k": "1e3", "M": "1e6", "c": "0.01", "m": "1e-3", "u": "1e-6", "μ": "1e-6"}.items()
}
UNITS = Reading(lambda number: ONE, Unit.root)
_SCALES = Reading(Unit, Unit.root)


@cache
def unit(text: str) -> Unit:
    """A unit by its text.  Raises AuditError for a name that is no unit."""
    read = formula(text.replace("%", "percent").replace("VA", "V*A").replace("c/s", "Hz").replace("°C", "K"))
    names = {name: _named(name, text) for name in read.names}
    found: Unit = read.over(_SCALES, names)
    return found


def _named(name: str, text: str) -> Unit:
    if name in _NAMES:
        return _NAMES[name]
    if name[:1] in _PREFIXES and name[1:] in _NAMES:
        return Unit(_PREFIXES[name[0]]) * _NAMES[name[1:]]
    raise AuditError(f"unit {text!r}: there is no {name!r}; there are {', '.join(_NAMES)}, with k M c m u before them")


def dimension(of: Formula, units: dict[str, Unit]) -> Dimension:
    """The dimension of a formula.  Raises Mismatch where unlike quantities are added."""
    found: Unit = of.over(UNITS, units)
    return found.dimension
