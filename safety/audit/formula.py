"""Formulas as a paper prints them: parsed once, then read as numbers, as units, as terms for a solver.

    relation("T''s = (sqrt(1 + 2*α*T's*V'E/VF^2) - 1)*VF/α")     sides, and the signs between them

Names may have Greek letters, digits and primes; decimals are exact; `·` is `*`, `−` is `-`, `µ` is `μ`, `^` and `**`
are powers with a whole exponent.  There is no call but sqrt(...), and nothing is ever evaluated as Python.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

from safety.audit.exceptions import AuditError

_TOKEN = re.compile(r"([0-9]+(?:\.[0-9]+)?)|([^\W\d][\w']*)|(\*\*|<=|>=|[-+*/^()=<>])")
_SAME = str.maketrans({"µ": "μ", "·": "*", "×": "*", "−": "-", "′": "'", "’": "'", "≤": "\u2264", "≥": "\u2265"})
SIGNS = ("=", "<=", ">=", "<", ">")
MOST_SIGNS, MOST_BRACKETS, MOST_DIGITS = 400, 40, 40  # of a formula as written
MOST_PLACES, MOST_POWER = 4000, 1000  # with all definitions put in


@dataclass(frozen=True)
class Formula:
    """A number, a name, or an operation: `op` is number, name, sqrt, neg, +, -, *, / or ^ (exponent in `number`)."""

    op: str
    parts: tuple[Formula, ...] = ()
    name: str = ""
    number: Fraction = Fraction(0)

    def __str__(self) -> str:
        return _text(self)

    @property
    def names(self) -> set[str]:
        """All symbols in it."""
        return set(self.places())

    def places(self) -> Iterator[str]:
        """The symbols from left to right, once for each place."""
        if self.op == "name":
            yield self.name
        for part in self.parts:
            yield from part.places()

    def numbers(self) -> Iterator[Fraction]:
        """The numbers from left to right; exponents are none."""
        if self.op == "number":
            yield self.number
        for part in self.parts:
            yield from part.numbers()

    @property
    def power(self) -> int:
        """At most so many factors stand in one product."""
        parts = [part.power for part in self.parts]
        if self.op in ("*", "/"):
            return sum(parts)
        return abs(int(self.number)) * parts[0] if self.op == "^" else max(parts, default=1)

    def replaced(self, by: Mapping[str, Formula]) -> Formula:
        """Other formulas in place of symbols, wherever they stand."""
        if self.op == "name":
            return by.get(self.name, self)
        return Formula(self.op, tuple(part.replaced(by) for part in self.parts), self.name, self.number)

    def slipped(self) -> Iterator[tuple[str, Callable[[str], Formula]]]:
        """For each place of a symbol: the symbol there, and what the formula becomes with another one in it."""
        if self.op == "name":
            yield self.name, symbol
        for n, part in enumerate(self.parts):
            for name, put in part.slipped():
                yield name, lambda other, n=n, put=put: self._with(n, put(other))  # type: ignore[misc]

    def _with(self, n: int, part: Formula) -> Formula:
        return Formula(self.op, (*self.parts[:n], part, *self.parts[n + 1 :]), self.name, self.number)

    def over(self, reading: Reading, values: Mapping[str, Any]) -> Any:
        """The value in a reading, by the operators of the values themselves.  Raises KeyError for an unknown symbol."""
        if self.op == "number":
            return reading.number(self.number)
        if self.op == "name":
            return values[self.name]
        parts = [part.over(reading, values) for part in self.parts]
        if self.op == "sqrt":
            return reading.root(parts[0])
        if self.op == "^":
            return _power(reading, parts[0], int(self.number))
        return _OPERATIONS[self.op](*parts)


@dataclass(frozen=True)
class Reading:
    """How a formula is read: what a number is, and a square root; the rest are the operators of the values."""

    number: Callable[[Fraction], Any]
    root: Callable[[Any], Any]


@dataclass(frozen=True)
class Relation:
    """Formulas with signs between them: `a <= b < c` has three sides and two signs."""

    sides: tuple[Formula, ...]
    signs: tuple[str, ...]

    def __str__(self) -> str:
        rest = (f" {sign} {side}" for sign, side in zip(self.signs, self.sides[1:], strict=True))
        return str(self.sides[0]) + "".join(rest)

    @property
    def pairs(self) -> list[tuple[Formula, str, Formula]]:
        """Each sign with the sides beside it."""
        return list(zip(self.sides, self.signs, self.sides[1:], strict=False))

    def replaced(self, by: Mapping[str, Formula]) -> Relation:
        """Other formulas in place of symbols."""
        return Relation(tuple(side.replaced(by) for side in self.sides), self.signs)

    def slipped(self) -> Iterator[tuple[str, Callable[[str], Relation]]]:
        """As of a formula."""
        for n, side in enumerate(self.sides):
            for name, put in side.slipped():
                yield name, lambda other, n=n, put=put: self._with(n, put(other))  # type: ignore[misc]

    def _with(self, n: int, side: Formula) -> Relation:
        return Relation((*self.sides[:n], side, *self.sides[n + 1 :]), self.signs)


def symbol(name: str) -> Formula:
    """A symbol as a formula."""
    return Formula("name", name=name)


def constant(number: Fraction | int) -> Formula:
    """A number as a formula."""
    return Formula("number", number=Fraction(number))


@cache
def formula(text: str) -> Formula:
    """One formula.  Raises AuditError for what cannot be read, or a sign of relation in it."""
    found = relation(text)
    if found.signs:
        raise AuditError(f"{text!r} has {found.signs[0]!r} in it; a single formula is wanted here")
    return found.sides[0]


@cache
def relation(text: str) -> Relation:
    """A formula or several with signs between.  Raises AuditError that shows the place where reading ended."""
    tokens = _tokens(text)
    parser = _Parser(text, tokens)
    sides, signs = [parser.sum()], []
    while parser.next in SIGNS:
        signs.append(parser.take())
        sides.append(parser.sum())
    if parser.next:
        raise parser.stopped(f"{parser.next!r} is not expected")
    for side in sides:
        not_too_large(side)
    return Relation(tuple(sides), tuple(signs))


def spelled(name: str) -> str:
    """A name in the one spelling of letters that look alike."""
    return name.translate(_SAME)


def not_too_large(each: Formula) -> None:
    """Refuse powers that no exact evaluation would come to the end of.  Raises AuditError."""
    if each.power > MOST_POWER:
        raise AuditError(f"a product of {each.power} factors is too large to be evaluated; {MOST_POWER} are the most")


def _tokens(text: str) -> list[str]:
    plain, at = spelled(text).replace("\u2264", "<=").replace("\u2265", ">="), 0
    found: list[str] = []
    while plain[at:].strip():
        at += len(plain[at:]) - len(plain[at:].lstrip())
        token = _TOKEN.match(plain, at)
        if token is None:
            raise AuditError(f"{text!r}: {plain[at]!r} cannot be read; formulas have names, decimals, + - * / ^ sqrt()")
        if len(found) == MOST_SIGNS or (token[1] and len(token[1]) > MOST_DIGITS):
            raise AuditError(
                f"{text[:MOST_DIGITS]!r}... is too long: formulas have up to {MOST_SIGNS} names, numbers and signs, "
                f"numbers up to {MOST_DIGITS} digits; define symbols for parts of it"
            )
        found.append(token[0])
        at = token.end()
    return found


class _Parser:
    """Sums of products of powers; the token ahead is `next`, empty at the end."""

    def __init__(self, text: str, tokens: Sequence[str]) -> None:
        self.text, self.tokens, self.at, self.brackets = text, tokens, 0, 0

    @property
    def next(self) -> str:
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def take(self, wanted: str = "") -> str:
        if wanted and self.next != wanted:
            raise self.stopped(f"{wanted!r} is missing")
        self.at += 1
        return self.tokens[self.at - 1]

    def stopped(self, why: str) -> AuditError:
        return AuditError(f"{self.text!r}: after {' '.join(self.tokens[: self.at])!r}: {why}; products need a *")

    def sum(self) -> Formula:
        left = self.product()
        while self.next in ("+", "-"):
            left = Formula(self.take(), (left, self.product()))
        return left

    def product(self) -> Formula:
        left = self.factor()
        while self.next in ("*", "/"):
            left = Formula(self.take(), (left, self.factor()))
        return left

    def factor(self) -> Formula:
        if self.next == "-":
            self.take()
            return Formula("neg", (self.factor(),))
        base = self.atom()
        if self.next not in ("^", "**"):
            return base
        self.take()
        sign = -1 if self.next == "-" and self.take() else 1
        if not self.next.isdecimal() or len(self.next) > len(str(MOST_POWER)):
            raise self.stopped(f"the exponent is a whole number up to {MOST_POWER}")
        return Formula("^", (base,), number=Fraction(sign * int(self.take())))

    def atom(self) -> Formula:
        if self.next == "(":
            self.take()
            self.brackets += 1
            if self.brackets > MOST_BRACKETS:
                raise AuditError(f"{self.text[:MOST_DIGITS]!r}... has more than {MOST_BRACKETS} brackets open at once")
            inner = self.sum()
            self.take(")")
            self.brackets -= 1
            return inner
        if self.next[:1].isdecimal():
            return constant(Fraction(self.take()))
        if not self.next or not (self.next[0].isalpha() or self.next[0] == "_"):
            raise self.stopped(f"{self.next!r} is no operand" if self.next else "something is missing at the end")
        name = self.take()
        if name == "sqrt" and self.next == "(":
            return Formula("sqrt", (self.atom(),))
        return symbol(name)


def _power(reading: Reading, base: Any, exponent: int) -> Any:
    result = reading.number(Fraction(1))
    for _ in range(abs(exponent)):
        result = result * base
    return reading.number(Fraction(1)) / result if exponent < 0 else result


_OPERATIONS: Mapping[str, Callable[..., Any]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "neg": lambda a: -a,
}
_BINDS = {"+": 1, "-": 1, "neg": 2, "*": 3, "/": 3, "^": 4}


def _text(each: Formula, room: int = 0) -> str:
    """As it could be written again; brackets only where they are needed."""
    if each.op == "name":
        return each.name
    if each.op == "number":
        text = decimal(each.number)
        return f"({text})" if room > 2 and "/" in text else text
    if each.op == "sqrt":
        return f"sqrt({each.parts[0]})"
    own = _BINDS[each.op]
    if each.op == "neg":
        text = f"-{_text(each.parts[0], own)}"
    elif each.op == "^":
        text = f"{_text(each.parts[0], own + 1)}^{each.number}"
    else:
        gap = " " if own == 1 else ""
        right = own + (each.op in "-/")
        text = f"{_text(each.parts[0], own)}{gap}{each.op}{gap}{_text(each.parts[1], right)}"
    return f"({text})" if own < room else text


def decimal(number: Fraction) -> str:
    """A fraction as a decimal where it ends, else as p/q."""
    rest, places = number.denominator, 0
    for prime in (2, 5):
        count = 0
        while rest % prime == 0:
            rest, count = rest // prime, count + 1
        places = max(places, count)
    if rest != 1 or places > 12:
        return str(number)
    sign, digits = (
        "-" if number < 0 else "",
        f"{abs(number.numerator) * 10**places // number.denominator:0{places + 1}d}",
    )
    return sign + (f"{digits[:-places]}.{digits[-places:]}" if places else digits)
