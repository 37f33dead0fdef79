"""Expressions: how the probability of a basic event follows from parameters and the mission time.

An expression is an immutable tree in the sense of the Open-PSA Model Exchange Format; here are its constants,
parameters, operations and the mission time, in `lifetimes` the laws of repairable and tested parts, in `distributions`
the distributions of what is not known for certain. One formula for each is read in several arithmetics: doubles,
rationals, intervals, derivatives (`arithmetics`) and vectors of samples (`sampling`).

Units: rates per hour, times in hours, probabilities 0..1. Source: Open-PSA Model Exchange Format 2.0d, chapter 5.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from fractions import Fraction
from typing import Any, ClassVar

from safety.trees.as_written import Rational, TreeError, exact
from safety.trees.expressions.arithmetics import (
    COMPARISONS,
    FUNCTIONS,
    Doubles,
    Duals,
    Intervals,
    Irrational,
    Rationals,
)
from safety.trees.expressions.readings import NOTHING, Reading, Supports

DOMAINS = {
    "any number": lambda x: x == x,
    "0 or more": lambda x: x >= 0,
    "more than 0": lambda x: x > 0,
    "between 0 and 1": lambda x: (x >= 0) & (x <= 1),
    "more than 0 and less than 1": lambda x: (x > 0) & (x < 1),
    "1 or more": lambda x: x >= 1,
}
DEEPEST = 100  # levels of expressions in one another, parameters included
Domains = tuple[tuple[str, str], ...]  # for each argument its name and one of DOMAINS


class Expression:
    """Base of all: a `tag`, the element's name in the format, over `arguments` in the format's order.

    An argument given as a number becomes a Constant. Raises TreeError: wrong number of arguments, or one whose value
    is known without the mission time and out of its domain.
    """

    tag: str = ""
    domains: ClassVar[Mapping[int, Domains]] = {}  # by number of arguments; empty: not checked here
    is_certain = True  # whether no distribution stands in it
    __slots__ = ("_hash", "arguments", "depth", "mean", "uses_mission_time")

    def __init__(self, *arguments: Expression | Rational) -> None:
        self.arguments = tuple(a if isinstance(a, Expression) else Constant(a) for a in arguments)
        if self.domains and len(arguments) not in self.domains:
            expected = " or ".join(
                f"{count} ({', '.join(name for name, _ in each)})" for count, each in sorted(self.domains.items())
            )
            raise TreeError(f"<{self.tag}> has {len(arguments)} arguments, expected {expected}; correct it")
        self._finish()

    def _finish(self) -> None:
        self.depth: int = 1 + max((a.depth for a in self.arguments), default=0)
        if self.depth > DEEPEST:
            raise TreeError(f"<{self.tag}> stands above {self.depth} levels of expressions, at most {DEEPEST} are read")
        self.uses_mission_time: bool = any(a.uses_mission_time for a in self.arguments)
        self._hash = hash((self.tag, self._key(), self.arguments))
        self.mean: float | None = None  # the value, where it needs no mission time
        means = [argument.mean for argument in self.arguments]
        if self.uses_mission_time or None in means:
            return
        self.check(means)
        # What has no value is refused when it is evaluated, which need not be: it may stand in the branch not taken.
        with suppress(ArithmeticError, ValueError):
            self.mean = self.formula(Doubles(), *means)

    def _key(self) -> Any:
        """What distinguishes it besides class and arguments."""
        return ()

    def __eq__(self, other: object) -> bool:
        return self is other or (
            type(self) is type(other)
            and isinstance(other, Expression)
            and self._hash == other._hash
            and (self.tag, self._key(), self.arguments) == (other.tag, other._key(), other.arguments)
        )

    def __hash__(self) -> int:
        return self._hash

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(map(repr, (*self._shown(), *self.arguments)))})"

    def _shown(self) -> tuple[Any, ...]:
        return ()

    def __add__(self, other: Expression | Rational) -> Expression:
        return Operation("add", self, other)

    def __sub__(self, other: Expression | Rational) -> Expression:
        return Operation("sub", self, other)

    def __mul__(self, other: Expression | Rational) -> Expression:
        return Operation("mul", self, other)

    def __truediv__(self, other: Expression | Rational) -> Expression:
        return Operation("div", self, other)

    def __neg__(self) -> Expression:
        return Operation("neg", self)

    def check(self, values: Any) -> None:
        """Raise TreeError if an argument's value (a number, or all samples of it) is outside its domain."""
        for (name, domain), value in zip(self.domains.get(len(values), ()), values, strict=False):
            self.require(name, domain, value)

    def require(self, name: str, domain: str, value: Any) -> None:
        """Raise TreeError if `value`, a number or samples, is outside the domain."""
        inside = DOMAINS[domain](value)
        if isinstance(inside, bool):
            if not inside:
                raise TreeError(f"{name} of <{self.tag}> is {value:g}, expected {domain}; correct it")
        elif not inside.all():
            raise TreeError(
                f"{name} of <{self.tag}> is {value[~inside][0]:g} in {(~inside).sum()} of {inside.size} samples, "
                f"expected {domain}; give it a distribution that stays there"
            )

    def formula(self, a: Doubles, *values: Any) -> Any:
        """The value from those of the arguments, in the arithmetic `a`."""
        raise NotImplementedError

    def read(self, reading: Reading, path: str) -> Any:
        """The value in a reading; `path` names the place of this expression."""
        values = [reading.of(argument, f"{path}/{n}") for n, argument in enumerate(self.arguments, 1)]
        reading.check(self, values)
        return self.formula(reading.arithmetic, *values)

    def value(self, mission_time_h: Rational | None = None, parameters: Mapping[str, Rational] = NOTHING) -> float:
        """The value in doubles, each distribution at its mean; `parameters` replaces parameters by name.

        Raises TreeError: a mission time is needed and missing, an argument is out of its domain, or there is no value.
        """
        return float(Reading(Doubles(), mission_time_h, parameters).of(self))

    def exact(
        self, mission_time_h: Rational | None = None, parameters: Mapping[str, Rational] = NOTHING
    ) -> Fraction | None:
        """The same as a rational, or None if it is irrational."""
        try:
            return Fraction(Reading(Rationals(), mission_time_h, parameters).of(self))
        except Irrational:
            return None

    def chance(
        self, mission_time_h: Rational | None = None, parameters: Mapping[str, Rational] = NOTHING
    ) -> tuple[float, float]:
        """The value as a probability, and 1 minus it."""
        value = self.value(mission_time_h, parameters)
        return value, 1 - value

    def enclosure(
        self, mission_time_h: Rational | None = None, parameters: Mapping[str, Rational] = NOTHING
    ) -> tuple[float, float]:
        """Doubles that enclose the real number for which `value` stands, whatever the rounding."""
        low, high = Reading(Intervals(), mission_time_h, parameters).of(self)
        return low, high

    def interval(self, mission_time_h: Rational | None = None) -> tuple[float, float]:
        """Doubles that enclose all values that it takes as its distributions range over theirs."""
        low, high = Supports(Intervals(), mission_time_h).of(self)
        return low, high

    def derivative(
        self, name: str, mission_time_h: Rational | None = None, parameters: Mapping[str, Rational] = NOTHING
    ) -> float:
        """The derivative of `value` with respect to the parameter `name`, or to MISSION_TIME (per hour)."""
        return float(Reading(Duals(), mission_time_h, parameters, name).of(self).slope)

    def below(self) -> Iterator[Expression]:
        """This expression and all within it, definitions of parameters once each."""
        agenda, met = [self], set()
        while agenda:
            each = agenda.pop()
            yield each
            if isinstance(each, Parameter):
                if each.name not in met:
                    met.add(each.name)
                    agenda.append(each.definition)
            else:
                agenda += each.arguments

    @property
    def parameters(self) -> dict[str, Parameter]:
        """The parameters within it by name."""
        return {each.name: each for each in self.below() if isinstance(each, Parameter)}

    @property
    def is_assumed(self) -> bool:
        """Whether a parameter within it has the source tag A."""
        return any(each.source == "A" for each in self.below() if isinstance(each, Parameter))


class Constant(Expression):
    """A number, kept as written."""

    tag = "float"
    __slots__ = ("number",)

    def __init__(self, number: Rational) -> None:
        self.number = exact(number, "a number in an expression")
        super().__init__()

    def _key(self) -> Any:
        return self.number

    def _shown(self) -> tuple[Any, ...]:
        return (str(self.number),)

    def formula(self, a: Doubles, *values: Any) -> Any:
        """The number."""
        return a.number(self.number)


class MissionTime(Expression):
    """The mission time (hours)."""

    tag = "system-mission-time"
    __slots__ = ()

    def _finish(self) -> None:
        super()._finish()
        self.uses_mission_time, self.mean = True, None

    def formula(self, a: Doubles, *values: Any) -> Any:
        """Nothing: only a reading knows it."""
        raise ValueError("no mission time")

    def read(self, reading: Reading, path: str) -> Any:
        """The mission time of the reading."""
        return reading.mission_time()


class Parameter(Expression):
    """A named quantity with its definition: one and the same variable wherever the name stands."""

    tag = "parameter"
    __slots__ = ("name", "source", "unit")

    def __init__(self, name: str, definition: Expression | Rational, unit: str = "", source: str = "") -> None:
        self.name, self.unit, self.source = name, unit, source  # unit and source tag are for the reader
        super().__init__(definition)

    @property
    def definition(self) -> Expression:
        """What it stands for."""
        return self.arguments[0]

    def _key(self) -> Any:
        return self.name, self.unit

    def _shown(self) -> tuple[Any, ...]:
        return (self.name,)

    def formula(self, a: Doubles, *values: Any) -> Any:
        """Its definition's value."""
        return values[0]

    def read(self, reading: Reading, path: str) -> Any:
        """Read once, under its own name."""
        return reading.parameter(self)


COUNTS = {  # of arguments, least and most
    **dict.fromkeys(("add", "sub", "mul", "div", "min", "max", "mean", "and", "or", "switch"), (1, None)),
    **dict.fromkeys(("neg", "abs", "not", *(f for f in FUNCTIONS if f not in ("expm1", "decay"))), (1, 1)),
    **dict.fromkeys(("mod", "pow", *COMPARISONS), (2, 2)),
    "pi": (0, 0),
    "ite": (3, 3),
}


class Operation(Expression):
    """An arithmetic, Boolean or conditional operation, by its `tag`, a key of COUNTS; truth is 1 and falsehood 0.

    "switch" takes conditions and values in turn and, last, the value if no condition holds. Angles are in radians.
    """

    __slots__ = ("tag",)

    def __init__(self, tag: str, *arguments: Expression | Rational) -> None:
        if tag not in COUNTS:
            raise TreeError(f"<{tag}> is no operation, expected one of {', '.join(sorted(COUNTS))}; rewrite it")
        least, most = COUNTS[tag]
        count = len(arguments)
        if count < least or (most is not None and count > most) or (tag == "switch" and count % 2 == 0):
            expected = f"{least}" if least == most else "an odd number" if tag == "switch" else f"{least} or more"
            raise TreeError(f"<{tag}> has {count} arguments, expected {expected}; correct it")
        self.tag = tag
        super().__init__(*arguments)

    def _shown(self) -> tuple[Any, ...]:
        return (self.tag,)

    def formula(self, a: Doubles, *values: Any) -> Any:
        """The value from those of the arguments."""
        return self._choose(a, [lambda value=value: value for value in values])

    def read(self, reading: Reading, path: str) -> Any:
        """As any other, but a branch that is not taken is not evaluated."""
        return self._choose(
            reading.arithmetic,
            [
                lambda n=n, argument=argument: reading.of(argument, f"{path}/{n}")
                for n, argument in enumerate(self.arguments, 1)
            ],
        )

    def _choose(self, a: Doubles, arguments: list[Any]) -> Any:
        if self.tag not in ("ite", "switch"):
            return _operate(a, self.tag, [argument() for argument in arguments])

        def from_case(n: int) -> Any:
            if n == len(arguments) - 1:
                return arguments[n]()
            return a.choose(arguments[n](), arguments[n + 1], lambda: from_case(n + 2))

        return from_case(0)


def _operate(a: Doubles, tag: str, values: list[Any]) -> Any:
    zero, one = a.number(Fraction(0)), a.number(Fraction(1))
    if tag in FUNCTIONS:
        return a.call(tag, values[0])
    if tag in COMPARISONS:
        return a.compare(tag, *values)
    if tag == "pi":
        return a.call("acos", -one)
    if tag == "mean":
        return _operate(a, "add", values) / a.number(Fraction(len(values)))
    first, *others = values
    match tag:
        case "neg":
            return -first
        case "add" | "sub" | "mul" | "div":
            for other in others:
                if tag == "add":
                    first = first + other
                elif tag == "sub":
                    first = first - other
                else:
                    first = first * other if tag == "mul" else first / other
            return first
        case "abs":
            return a.absolute(first)
        case "min":
            return a.smallest(values)
        case "max":
            return a.largest(values)
        case "mod":
            return a.remainder(*values)
        case "pow":
            return a.power(*values)
        case "not":
            return a.compare("eq", first, zero)
        case _:
            truths = [a.compare("df", value, zero) for value in values]
            return a.smallest(truths) if tag == "and" else a.largest(truths)


def draws(expression: Expression) -> bool:
    """Whether a distribution stands in it outside of parameters, so that it is a random variable of its own."""
    if isinstance(expression, Parameter):
        return False
    return not expression.is_certain or any(draws(argument) for argument in expression.arguments)
