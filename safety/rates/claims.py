"""Rate statements: a figure, the routes that lead to it, and the target that it has to meet.

    rate(id="ts7.mtbf.no-repair", quantity="mean time to failure, two out of three, no repair", unit="h",
         source="TS-7 section 4 [P]", target=printed("30 000 h", digits=5), inputs={"channel": channel},
         routes={"closed form E8": lambda: mttf_without_repair(channel.per_hour),
                 "Markov chain, exact": lambda: mean_time(chain(channel.per_hour), {FAILED})})

A statement needs two routes that share as little as possible. Each gives a Fraction, infinity, an Enclosure or an
Estimate; a plain double is refused, since it says nothing about its error. Routes agree when exact values are equal and
enclosures, of at most WIDEST relative width, overlap.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations
from typing import Any, Final, NamedTuple, TypeAlias, get_args

from safety.rates.enclosure import INFINITE, Enclosure, Estimate, Extended
from safety.rates.exceptions import DeclarationError, NotExact, NumericsFailed, RoutesDisagree
from safety.rates.units import Quantity, Unit, quantity, read

Route: TypeAlias = Callable[[], Extended | Enclosure | Estimate]

WIDEST: Final = 1e-6  # an enclosure wider than this, relative, is too vague for its overlap to be evidence
_declared: dict[str, Rate] = {}
_places: dict[str, tuple[str, int]] = {}  # file and line of each declaration


class Target(NamedTuple):
    """The admissible range, ends included, in the base unit of `text`."""

    low: Extended
    high: Extended
    unit: Unit
    text: str

    def met(self, low: Extended, high: Extended) -> bool | None:
        """Does a figure that lies in [low, high] meet the target? None when it lies across an end."""
        if self.low <= low and high <= self.high:
            return True
        return False if high < self.low or self.high < low else None


def at_most(text: str) -> Target:
    """For instance a tolerable hazard rate: at_most("1e-9 /h"). Raises UnitError."""
    bound = quantity(text)
    return Target(Fraction(0), bound.value, bound.unit, f"at most {text}")


def at_least(text: str) -> Target:
    """For instance a required mean time: at_least("30 000 h"). Raises UnitError."""
    bound = quantity(text)
    return Target(bound.value, INFINITE, bound.unit, f"at least {text}")


def printed(text: str, digits: int | None = None) -> Target:
    """A published figure: met by what rounds to it, that is within half a unit of its last digit, ends included.

    `digits` is the number of significant digits. It may be left out where the text shows it, so not for "36 000 h",
    whose zeros may or may not count: DeclarationError. Raises UnitError for an unreadable text.
    """
    written = read(text)
    digits = digits or written.digits
    if digits is None:
        raise DeclarationError(f"{text!r} does not show which of its zeros count; say printed({text!r}, digits=...)")
    if written.number <= 0:
        raise DeclarationError(f"{text!r} has no leading digit to count from; use at_most")
    half = Fraction(10) ** (_leading_power(written.number) - digits + 1) / 2 * written.scale
    middle = written.number * written.scale
    return Target(middle - half, middle + half, written.unit, f"printed {text} ({digits} digits)")


def _leading_power(number: Fraction) -> int:
    """The p with 10^p <= number < 10^(p+1)."""
    power = 0
    while number >= Fraction(10) ** (power + 1):
        power += 1
    while number < Fraction(10) ** power:
        power -= 1
    return power


@dataclass(frozen=True)
class Rate:
    """A declared statement; see `rate` for the fields."""

    id: str
    quantity: str
    unit: Unit
    source: str
    routes: Mapping[str, Route]
    target: Target | None = None
    inputs: Mapping[str, Quantity] = field(default_factory=dict)

    def evaluate(self) -> dict[str, Any]:
        """Walks every route and returns the entry for "rates" of the results document (plain JSON values).

        Raises RoutesDisagree when two routes differ, NumericsFailed when an enclosure is wider than WIDEST, NotExact
        for a double, and whatever a route raises.
        """
        found = {name: _as_estimate(route(), f"{self.id}, route {name!r}") for name, route in self.routes.items()}
        for name, estimate in found.items():
            width = max(part.relative_width for part in estimate)
            if width > WIDEST:
                raise NumericsFailed(f"{self.id}: route {name!r} is known to {width:.1e} only, not {WIDEST}")
        for (one, first), (other, second) in combinations(found.items(), 2):
            if not all(a.overlaps(b) for a, b in zip(first, second, strict=True)):
                raise RoutesDisagree(
                    f"{self.id}: {one!r} gives {_show(first)}, {other!r} gives {_show(second)} "
                    f"{self.unit}; one of the two, or its input, is wrong"
                )
        method, best = min(found.items(), key=lambda item: max(part.relative_width for part in item[1]))
        low, high = best.low.low, best.high.high
        entry: dict[str, Any] = {
            "id": self.id,
            "quantity": self.quantity,
            "value": _json(best.value.middle),
            "low": _json(low, -INFINITE),
            "high": _json(high, INFINITE),
            "unit": self.unit,
            "method": method,
            "source": self.source,
            "target": self.target.text if self.target else None,
            "met": self.target.met(low, high) if self.target else None,
            "agreed_by": list(found),
            "assumed": [
                f"{name} = {given.text}" + (f": {given.about}" if given.about else "")
                for name, given in self.inputs.items()
                if given.source == "A"
            ],
        }
        if best.value.exact and isinstance(best.value.low, Fraction):
            entry["exact"] = f"{best.value.low.numerator}/{best.value.low.denominator}"
        return entry


def rate(
    *,
    id: str,
    quantity: str,
    unit: Unit,
    source: str,
    routes: Mapping[str, Route],
    target: Target | None = None,
    inputs: Mapping[str, Quantity] | None = None,
) -> Rate:
    """Declares a statement and registers it under its id.

    id: unique.  quantity: what it is, in words.  unit: "h", "1/h" or "1", the base unit of what the routes give.
    source: where the figure or its target comes from, with the tag.  routes: name of the method -> function of nothing.
    inputs: the quantities that enter; those tagged A are listed as assumed.
    Raises DeclarationError for fewer than two routes, a target of another unit, or an id that another line has taken.
    """
    if len(routes) < 2:
        raise DeclarationError(f"{id} has {len(routes)} route; give two that share as little as possible")
    if unit not in get_args(Unit):
        raise DeclarationError(f"{id} is in {unit!r}; use the base unit 'h', '1/h' or '1' that the routes give")
    if target is not None and target.unit != unit:
        raise DeclarationError(f"{id} is in {unit} but its target is {target.text!r} in {target.unit}")
    new = Rate(id, quantity, unit, source, dict(routes), target, dict(inputs or {}))
    caller = sys._getframe(1)
    where = (caller.f_code.co_filename, caller.f_lineno)
    if id in _declared and _places[id] != where:
        first, second = (f"{file}:{line}" for file, line in (_places[id], where))
        raise DeclarationError(f"{id} is declared twice, at {first} and {second}; ids are unique")
    _declared[id], _places[id] = new, where
    return new


def declared() -> tuple[Rate, ...]:
    """All statements declared so far, in order. A file that is imported again replaces its own."""
    return tuple(_declared.values())


def _as_estimate(result: Extended | Enclosure | Estimate, where: str) -> Estimate:
    if isinstance(result, Estimate):
        return result
    if isinstance(result, Enclosure):
        return Estimate.certain(result)
    if isinstance(result, Fraction) or result == INFINITE:
        return Estimate.certain(Enclosure.exactly(result))
    raise NotExact(f"{where} gives {result!r}, a {type(result).__name__}; return a Fraction or an Enclosure")


def _json(value: Extended, outward: float | None = None) -> float | str:
    """A double, rounded to nearest or, for an end of an interval, never inward; infinity is the text "inf"."""
    if value == INFINITE:
        return "inf"
    nearest = float(value)
    if outward is not None and (nearest > value if outward < 0 else nearest < value):
        return math.nextafter(nearest, outward)
    return nearest


def _show(estimate: Estimate) -> str:
    value, low, high = (f"{float(part.middle):.17g}" for part in estimate)
    return value if value == low == high else f"{value} [{low}, {high}]"
