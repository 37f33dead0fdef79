"""The kinds of numbers that one expression is read in: doubles, rationals, intervals, first derivatives.

`Arithmetic` names what an expression needs besides + - * /; the vectors of samples are in `sampling`. Intervals are
rounded outwards, so that they enclose the real result whatever the rounding; functions of the math library are taken
to be good to 4 units in the last place. Source: R. E. Moore, "Interval Analysis" (1966).
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from fractions import Fraction
from typing import Any, NamedTuple

LARGEST_POWER = 100_000  # bits, in rational arithmetic
SLACK = 2.0**-50  # relative error granted to a function of the math library
TINY = 5e-324


class Irrational(Exception):
    """The value is no rational number, or none of a reasonable size."""


class Function(NamedTuple):
    """A function of one number in doubles, and its derivative from argument and value."""

    double: Callable[[float], float]
    slope: Callable[[float, float], float]


def decay(x: float) -> float:
    """(1 - exp(-x)) / x, the mean of exp(-y) for y of 0..x; 1 at 0."""
    return -math.expm1(-x) / x if x else 1.0


def _decay_slope(x: float, y: float) -> float:
    return (math.exp(-x) - y) / x if abs(x) > 1e-4 else -0.5 + x / 3 - x * x / 8


FUNCTIONS = {
    "exp": Function(math.exp, lambda x, y: y),
    "expm1": Function(math.expm1, lambda x, y: y + 1),
    "decay": Function(decay, _decay_slope),
    "log": Function(math.log, lambda x, y: 1 / x),
    "log10": Function(math.log10, lambda x, y: 1 / (x * math.log(10))),
    "sqrt": Function(math.sqrt, lambda x, y: 0.5 / y),
    "sin": Function(math.sin, lambda x, y: math.cos(x)),
    "cos": Function(math.cos, lambda x, y: -math.sin(x)),
    "tan": Function(math.tan, lambda x, y: 1 + y * y),
    "asin": Function(math.asin, lambda x, y: 1 / math.sqrt(1 - x * x)),
    "acos": Function(math.acos, lambda x, y: -1 / math.sqrt(1 - x * x)),
    "atan": Function(math.atan, lambda x, y: 1 / (1 + x * x)),
    "sinh": Function(math.sinh, lambda x, y: math.cosh(x)),
    "cosh": Function(math.cosh, lambda x, y: math.sinh(x)),
    "tanh": Function(math.tanh, lambda x, y: 1 - y * y),
    "floor": Function(lambda x: float(math.floor(x)), lambda x, y: 0.0),
    "ceil": Function(lambda x: float(math.ceil(x)), lambda x, y: 0.0),
}
EXACT = {"floor": math.floor, "ceil": math.ceil}  # of a rational, a rational
AT_ZERO = {"exp": 1, "expm1": 0, "decay": 1, "sin": 0, "cos": 1, "tan": 0, "sinh": 0, "cosh": 1, "tanh": 0, "atan": 0}
COMPARISONS: dict[str, Callable[[Any, Any], Any]] = {
    "eq": operator.eq,
    "df": operator.ne,
    "lt": operator.lt,
    "gt": operator.gt,
    "leq": operator.le,
    "geq": operator.ge,
}


class Doubles:
    """Double precision; a ValueError or ArithmeticError where there is no value."""

    def number(self, value: Fraction) -> Any:
        """A constant."""
        return float(value)

    def call(self, name: str, x: Any) -> Any:
        """One of FUNCTIONS at x."""
        return FUNCTIONS[name].double(x)

    def power(self, x: Any, y: Any) -> Any:
        """x to the y."""
        return math.pow(x, y)

    def remainder(self, x: Any, y: Any) -> Any:
        """What is left of x after whole multiples of y, with the sign of x."""
        return math.fmod(x, y)

    def absolute(self, x: Any) -> Any:
        """|x|."""
        return abs(x)

    def smallest(self, values: list[Any]) -> Any:
        """The least of `values`."""
        return min(values)

    def largest(self, values: list[Any]) -> Any:
        """The greatest of `values`."""
        return max(values)

    def compare(self, name: str, x: Any, y: Any) -> Any:
        """One of COMPARISONS, as 1 or 0."""
        return self.number(Fraction(int(COMPARISONS[name](x, y))))

    def choose(self, condition: Any, then: Callable[[], Any], other: Callable[[], Any]) -> Any:
        """`then()` where the condition is not 0, else `other()`; the other one is not evaluated."""
        return then() if condition != 0 else other()

    def known(self, value: Fraction, computed: Any) -> Any:
        """A number that was `computed` here and whose value is known exactly."""
        return self.number(value)

    def multiples_below(self, x: Any, y: Any) -> Any:
        """How many of 0, y, 2 y, ... are less than x, for y > 0, as the decimals they print as; None if uncertain."""
        return max(0, math.ceil(Fraction(repr(x)) / Fraction(repr(y))))


class Rationals(Doubles):
    """Exact; raises Irrational where the value is none or cannot be shown to be one."""

    def number(self, value: Fraction) -> Fraction:
        """A constant."""
        return value

    def call(self, name: str, x: Fraction) -> Fraction:
        """One of FUNCTIONS at x."""
        if name in EXACT:
            return Fraction(EXACT[name](x))
        if x == 0 and name in AT_ZERO:
            return Fraction(AT_ZERO[name])
        raise Irrational(name)

    def power(self, x: Fraction, y: Fraction) -> Fraction:
        """x to the y."""
        bits = x.numerator.bit_length() + x.denominator.bit_length()
        if y.denominator != 1 or abs(y) * bits > LARGEST_POWER:
            raise Irrational("pow")
        return x**y.numerator

    def remainder(self, x: Fraction, y: Fraction) -> Fraction:
        """What is left of x after whole multiples of y, with the sign of x."""
        return x - y * math.trunc(x / y)

    def multiples_below(self, x: Fraction, y: Fraction) -> int:
        """How many of 0, y, 2 y, ... are less than x, for y > 0."""
        return max(0, math.ceil(x / y))


class Interval(NamedTuple):
    """All numbers from `low` to `high`."""

    low: float
    high: float

    def __neg__(self) -> Interval:
        return Interval(-self.high, -self.low)

    def __add__(self, other: Any) -> Interval:
        return _outward(self.low + other.low, self.high + other.high)

    def __sub__(self, other: Interval) -> Interval:
        return self + -other

    def __mul__(self, other: Any) -> Interval:
        ends = [x * y if x and y else 0.0 for x in self for y in other]
        return _outward(min(ends), max(ends))

    def __truediv__(self, other: Interval) -> Interval:
        if other.low <= 0 <= other.high:
            return EVERYTHING
        return self * _outward(1 / other.high, 1 / other.low)


EVERYTHING = Interval(-math.inf, math.inf)
UNKNOWN = Interval(0.0, 1.0)


def _outward(low: float, high: float, slack: float = 0.0) -> Interval:
    if math.isnan(low) or math.isnan(high):
        return EVERYTHING
    low, high = (low - slack * abs(low), high + slack * abs(high)) if slack else (low, high)
    return Interval(
        low if math.isinf(low) else math.nextafter(low, -math.inf),
        high if math.isinf(high) else math.nextafter(high, math.inf),
    )


class Intervals(Doubles):
    """Enclosures; wide rather than wrong where a function is not monotone."""

    def number(self, value: Fraction) -> Interval:
        """A constant: itself where a double holds it, else the doubles around it."""
        double = float(value)
        return Interval(double, double) if Fraction(double) == value else _outward(double, double)

    def call(self, name: str, x: Interval) -> Interval:
        """One of FUNCTIONS over x."""
        function = FUNCTIONS[name]
        if name in ("sin", "cos"):
            middle, reach = x.low / 2 + x.high / 2, x.high - x.low  # their slope is at most 1
            value = function.double(middle) if math.isfinite(reach) else 0.0
            low, high = _outward(value - reach, value + reach, SLACK)
            return Interval(max(low, -1.0), min(high, 1.0))
        if name == "tan" and not _has_no_pole(x):
            return EVERYTHING
        if name == "cosh" and x.low < 0 < x.high:
            return self.call("cosh", Interval(0.0, max(-x.low, x.high)))
        ends = sorted(_end(name, end) for end in x)
        low, high = _outward(ends[0], ends[-1], 0.0 if name in EXACT else SLACK)
        return Interval(max(low, 0.0), high) if name in ("exp", "sqrt", "decay") else Interval(low, high)

    def power(self, x: Interval, y: Interval) -> Interval:
        """x to the y, for x >= 0 or a whole y that is one number."""
        whole = y.low == y.high and y.low.is_integer()
        if x.low < 0 and not (whole and (y.low >= 0 or x.high < 0)):
            return EVERYTHING
        bases = (*x, 0.0) if x.low < 0 < x.high else x
        ends = [_end("pow", base, exponent) for base in bases for exponent in y]
        low, high = _outward(min(ends), max(ends), SLACK)
        return Interval(max(low, 0.0), high) if x.low >= 0 else Interval(low, high)

    def remainder(self, x: Interval, y: Interval) -> Interval:
        """What is left of x after whole multiples of y, with the sign of x."""
        if x.low == x.high and y.low == y.high != 0:
            rest = math.fmod(x.low, y.low)  # exact
            return Interval(rest, rest)
        widest = max(abs(y.low), abs(y.high))
        return Interval(-widest if x.low < 0 else 0.0, widest if x.high > 0 else 0.0)

    def absolute(self, x: Interval) -> Interval:
        """|x|."""
        ends = sorted((abs(x.low), abs(x.high)))
        return Interval(0.0 if x.low <= 0 <= x.high else ends[0], ends[1])

    def smallest(self, values: list[Interval]) -> Interval:
        """The least of `values`."""
        return Interval(min(v.low for v in values), min(v.high for v in values))

    def largest(self, values: list[Interval]) -> Interval:
        """The greatest of `values`."""
        return Interval(max(v.low for v in values), max(v.high for v in values))

    def compare(self, name: str, x: Interval, y: Interval) -> Interval:
        """One of COMPARISONS: 1, 0, or the interval 0..1 where it may be either."""
        if name in ("eq", "df"):
            apart, same = x.high < y.low or y.high < x.low, x.low == x.high == y.low == y.high
            return UNKNOWN if not (apart or same) else self.number(Fraction(int(apart == (name == "df"))))
        verdicts = {COMPARISONS[name](a, b) for a, b in ((x.low, y.high), (x.high, y.low))}
        return UNKNOWN if len(verdicts) > 1 else self.number(Fraction(int(verdicts.pop())))

    def choose(self, condition: Interval, then: Callable[[], Interval], other: Callable[[], Interval]) -> Interval:
        """`then()` or `other()`, or what covers both where the condition may be either."""
        if not condition.low <= 0 <= condition.high:
            return then()
        if condition.low == condition.high:
            return other()
        return hull([then(), other()])

    def multiples_below(self, x: Interval, y: Interval) -> int | None:
        """How many of 0, y, 2 y, ... are less than x, for y > 0; None if that is uncertain."""
        least, most = (max(0.0, end) for end in (x.low / y.high, x.high / y.low))
        return math.ceil(least) if math.ceil(least) == math.ceil(most) else None


def _has_no_pole(x: Interval) -> bool:
    """Whether the tangent is finite all over `x`, told with room to spare."""
    if not (math.isfinite(x.low) and x.high - x.low < 3):
        return False
    branches = {math.floor(end / math.pi + 0.5) for end in x}
    return len(branches) == 1 and all(abs(math.cos(end)) > 1e-6 for end in x)


def hull(parts: list[Interval]) -> Interval:
    """The least interval that holds all of them."""
    return Interval(min(p.low for p in parts), max(p.high for p in parts))


def _end(name: str, *x: float) -> float:
    """A function at the end of an interval; its limit where it is none, and nan outside its domain."""
    try:
        if name == "decay":
            return 0.0 if x[0] == math.inf else decay(x[0])
        return math.pow(*x) if name == "pow" else FUNCTIONS[name].double(x[0])
    except OverflowError:
        return x[0] if name in EXACT else -math.inf if x[0] < 0 and name == "sinh" else math.inf
    except (ValueError, ZeroDivisionError):
        return -math.inf if x[0] == 0 and name in ("log", "log10") else math.nan


class Dual(NamedTuple):
    """A number and its derivative with respect to the one parameter looked at."""

    value: float
    slope: float

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.slope)

    def __add__(self, other: Any) -> Dual:
        return Dual(self.value + other.value, self.slope + other.slope)

    def __sub__(self, other: Dual) -> Dual:
        return Dual(self.value - other.value, self.slope - other.slope)

    def __mul__(self, other: Any) -> Dual:
        return Dual(self.value * other.value, self.slope * other.value + self.value * other.slope)

    def __truediv__(self, other: Dual) -> Dual:
        quotient = self.value / other.value
        return Dual(quotient, (self.slope - quotient * other.slope) / other.value)


class Duals(Doubles):
    """Values with first derivatives (forward differentiation), from the right where there is a kink."""

    def number(self, value: Fraction) -> Dual:
        """A constant."""
        return Dual(float(value), 0.0)

    def call(self, name: str, x: Dual) -> Dual:
        """One of FUNCTIONS at x."""
        value = FUNCTIONS[name].double(x.value)
        return Dual(value, FUNCTIONS[name].slope(x.value, value) * x.slope if x.slope else 0.0)

    def power(self, x: Dual, y: Dual) -> Dual:
        """x to the y."""
        value = math.pow(x.value, y.value)
        by_base = y.value * math.pow(x.value, y.value - 1) * x.slope if x.slope and y.value else 0.0
        by_exponent = value * math.log(x.value) * y.slope if y.slope and value else 0.0
        return Dual(value, by_base + by_exponent)

    def remainder(self, x: Dual, y: Dual) -> Dual:
        """What is left of x after whole multiples of y, with the sign of x."""
        return Dual(math.fmod(x.value, y.value), x.slope - math.trunc(x.value / y.value) * y.slope)

    def absolute(self, x: Dual) -> Dual:
        """|x|."""
        return max(x, -x)

    def compare(self, name: str, x: Dual, y: Dual) -> Dual:
        """One of COMPARISONS, of the values."""
        return self.number(Fraction(int(COMPARISONS[name](x.value, y.value))))

    def choose(self, condition: Dual, then: Callable[[], Dual], other: Callable[[], Dual]) -> Dual:
        """`then()` where the condition is not 0, else `other()`."""
        return then() if condition.value != 0 else other()

    def known(self, value: Fraction, computed: Dual) -> Dual:
        """A number that was `computed` here, with its derivative, and whose value is known exactly."""
        return Dual(float(value), computed.slope)

    def multiples_below(self, x: Dual, y: Dual) -> int:
        """How many of 0, y, 2 y, ... are less than x, for y > 0."""
        return int(super().multiples_below(x.value, y.value))
