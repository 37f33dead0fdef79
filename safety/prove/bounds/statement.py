"""Bounds as they are stated: a quantity, what is given, and the words that both are written with."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import ClassVar, cast

from safety.prove.bounds.replay import Range, Witness, over
from safety.system import ModelError
from safety.terms import Bit, Real, real, select
from safety.terms.graph import REAL, Term, describe, variable, variables
from safety.terms.values import all_of

Exact = int | Fraction
WIDTH = Fraction(1, 10_000)  # of a bracket, relative


class Stated:
    """What is claimed of reals, as results show it; `assumed` are numbers that no source gives, in words with tags."""

    id: str
    requirement: str
    source: str
    assumed: tuple[str, ...]
    method: ClassVar[str]
    whole: tuple[Real, ...] = ()  # variables that take whole values only

    def assumptions(self) -> list[str]:
        """What is assumed, in words."""
        return list(self.assumed)


@dataclass(frozen=True, eq=False)
class Bound(Stated):
    """A quantity, over `per` (above zero) where it is a quotient, wherever all of `given` hold.

    `assumed` says in words, each with its tag, which of the numbers in it no source gives: "[A] 60 pulses a turn".
    Raises `ModelError` for a quantity that is no real, or a bound without a variable.
    """

    id: str
    statement: str
    quantity: Real
    given: tuple[Bit, ...]
    per: Real = field(default_factory=lambda: real(1))
    whole: tuple[Real, ...] = ()
    unit: str = ""
    requirement: str = ""
    source: str = ""
    assumed: tuple[str, ...] = ()
    method = "error bound over reals"

    def __post_init__(self) -> None:
        for name, term in (("quantity", self.quantity), ("per", self.per)):
            if not isinstance(term, Real):
                raise ModelError(f"{self.id}: {name}={term!r}; it is a Real, made of reals(...), + - * and select")
        for condition in self.given:
            if not isinstance(condition, Bit):
                raise ModelError(f"{self.id}: given={condition!r}; each is a Bit, such as x >= 0")
        if not variables([self.quantity, self.per, *self.given]):
            raise ModelError(f"{self.id} has no variable: it is {describe(self.quantity)} whatever happens")
        for number in self.whole:
            if not isinstance(number, Real) or number.op != "var":
                raise ModelError(f"{self.id}: whole={number!r}; name variables, made by reals(...)")

    def assumptions(self) -> list[str]:
        """What is assumed, in words: numbers that no source gives, then what is given."""
        whole = (f"{describe(v)} is a whole number" for v in self.whole)
        return [*self.assumed, *(describe(g, 6) for g in self.given), *whole]

    @property
    def situation(self) -> Bit:
        """All of `given` at once."""
        return all_of(*self.given)

    def sentence(self, limit: Fraction, strict: bool = False) -> str:
        """That the limit is kept, in words."""
        return f"{self.statement} {'<' if strict else '<='} {plain(limit)} {self.unit}".strip()

    def least(self) -> str:
        """What a bracket looks for, in words."""
        return f"Least upper bound: {self.statement}"

    def beyond(self, limit: Fraction, reached: bool = False) -> Bit:
        """The situations in which the limit is exceeded (or reached), or the quotient has no meaning."""
        most = self.per * limit
        exceeded = self.quantity >= most if reached else self.quantity > most
        return self.situation & (exceeded | (self.per <= 0))

    def at(self, witness: Witness) -> Range | None:
        """The value at a witness, of no width where all its values are fractions; None where `per` is not above 0.

        What the witness leaves open is 0.
        """
        zero = Fraction(0), Fraction(0)
        terms: list[Term] = [self.quantity, self.per]
        quantity, per = over(terms, {**dict.fromkeys(variables(terms), zero), **witness})
        assert isinstance(quantity, tuple) and isinstance(per, tuple)
        (low, high), (least, most) = quantity, per
        return (low / (most if low >= 0 else least), high / (least if high >= 0 else most)) if least > 0 else None


def reals(names: str) -> list[Real]:
    """Variables over the reals, by names with spaces between; `ModelError` for a name that comes twice."""
    found = names.split()
    if len(set(found)) < len(found):
        raise ModelError(f"reals({names!r}): two variables share a name; give one another")
    return [cast(Real, variable(name, REAL)) for name in found]


def plain(x: Fraction) -> str:
    """A fraction as a decimal where a short one is equal to it, else as p/q."""
    text = f"{float(x):.12g}"
    return text if "e" not in text and Fraction(text) == x else str(x)


def between(low: Exact, x: Real, high: Exact) -> Bit:
    """From low to high, both included; `ModelError` when they are not in order."""
    if low > high:
        raise ModelError(f"between({low}, {describe(x)}, {high}) holds nowhere; give the lower end first")
    return (x >= low) & (x <= high)


def magnitude(x: Real) -> Real:
    """The absolute value."""
    return select(x < 0, 0 - x, x)


def counted(ticks: Real, duration: Real, period: Exact | Real) -> Bit:
    """Ticks of a free-running clock in a duration: less than one tick more or less, whatever its phase.

    The tick's period is in the unit of the duration.
    """
    return (duration - period < ticks * period) & (ticks * period < duration + period)


def rounded_down(q: Real, x: Real, step: Exact = 1) -> Bit:
    """The largest multiple of the step that is at most x; any q within one step below it is admitted."""
    return (x - step < q) & (q <= x)
