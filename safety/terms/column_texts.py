"""The text columns of the table: Python source on numbers, and on NumPy lanes.

An entry takes the term and the texts of its arguments.  Lanes of a bit are bool, of a number int64, of a number beyond
64 bits and of a real Python objects; `words`, `objects` and `wires` (int64, object, bool) make them so.  A constant
argument is a plain literal, beside one at least that is not: the generator computes what reads no input.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from safety.terms.graph import Sort, Term, Value

Text = Callable[..., str]

LEAST_INT64, GREATEST_INT64 = -(2**63), 2**63 - 1


def literal(value: Value) -> str:
    """Source text of a constant."""
    return f"Fraction({value.numerator}, {value.denominator})" if isinstance(value, Fraction) else repr(value)


def form(pattern: str) -> Text:
    """A pattern with `{0}`, `{1}`, ... for the arguments and `{attr}` for the attribute."""
    return lambda t, *args: pattern.format(*args, attr=t.attr)


def _mask(bits: int) -> int:
    return (1 << bits) - 1


# --- Python --------------------------------------------------------------------------------------------------------


def python_cast(t: Term, x: str) -> str:
    """The same value; a real is always a Fraction."""
    return f"Fraction({x})" if t.sort.kind == "real" else x


def python_clip(t: Term, x: str) -> str:
    """The value clamped into the result's range."""
    low, high = t.sort.bounds
    return f"min(max({x}, {low}), {high})"


def python_slice(t: Term, x: str) -> str:
    """Some bits; Python's integers are two's complement of any length."""
    start, count = t.attr
    return f"({x} >> {start} & {_mask(count)})" if start else f"({x} & {_mask(count)})"


def python_concat(t: Term, x: str, y: str) -> str:
    """The upper word above the lower."""
    return f"({x} << {t.args[1].sort.width} | {y})"


# --- lanes ---------------------------------------------------------------------------------------------------------


def is_object(sort: Sort) -> bool:
    """Whether lanes of this sort need Python objects: reals, and numbers beyond 64-bit integers."""
    if sort.kind == "real":
        return True
    return sort.bounds[0] < LEAST_INT64 or sort.bounds[1] > GREATEST_INT64


def _as(text: str, sort: Sort, wide: bool) -> str:
    """Lanes of a sort as objects (`wide`) or as int64."""
    if is_object(sort) == wide:
        return text
    return f"objects({text})" if wide else f"words({text})"


def _result(text: str, t: Term, wide: bool) -> str:
    """A result computed in objects as lanes of the term's own sort."""
    return f"words({text})" if wide and not is_object(t.sort) else text


def lane_numbers(symbol: str) -> Text:
    """Arithmetic, in objects as soon as an operand or the result needs them."""

    def text(t: Term, x: str, y: str) -> str:
        a, b = t.args[0].sort, t.args[1].sort
        wide = any(map(is_object, (t.sort, a, b)))
        return _result(f"({_as(x, a, wide)} {symbol} {_as(y, b, wide)})", t, wide)

    return text


def lane_select(t: Term, c: str, x: str, y: str) -> str:
    """A choice; NumPy would take two literals beyond 64 bits for floats."""
    return f"np.where({c}, objects({x}), objects({y}))" if is_object(t.sort) else f"np.where({c}, {x}, {y})"


def lane_cast(t: Term, x: str) -> str:
    """The same value in the lanes of another sort."""
    return f"fractions({x})" if t.sort.kind == "real" else _as(x, t.args[0].sort, is_object(t.sort))


def lane_clip(t: Term, x: str) -> str:
    """The value clamped into the result's range."""
    low, high = t.sort.bounds
    source = t.args[0].sort
    wide = is_object(source) or is_object(t.sort)
    return _result(f"np.minimum(np.maximum({_as(x, source, wide)}, {low}), {high})", t, wide)


def lane_slice(t: Term, x: str) -> str:
    """Some bits; NumPy's integers are two's complement too."""
    source = t.args[0].sort
    wide = is_object(source) or is_object(t.sort)
    return _result(python_slice(t, _as(x, source, wide)), t, wide)


def lane_concat(t: Term, x: str, y: str) -> str:
    """The upper word above the lower."""
    wide = is_object(t.sort)
    return python_concat(t, _as(x, t.args[0].sort, wide), _as(y, t.args[1].sort, wide))


def lane_divide(symbol: str) -> Text:
    """Division by a constant, in objects where word, divisor or result need them."""

    def text(t: Term, x: str) -> str:
        source = t.args[0].sort
        wide = is_object(source) or is_object(t.sort) or t.attr > GREATEST_INT64
        return _result(f"({_as(x, source, wide)} {symbol} {t.attr})", t, wide)

    return text
