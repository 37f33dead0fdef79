"""The value classes: `Bit`, `UInt`, `Int` and `Real`, with Python's operators as exact operations.

Widths are exact: `a + b` is one bit wider than the wider operand, `.low(8)` wraps, `.bit(8)` is the carry, `.sat(8)`
saturates; `a - b` is a bounded integer, so nothing is lost below zero.  A value has no truth: `if`, `and`, `in`, `max`
raise and say what to write.  `==` gives a `Bit`; hashing is by identity.  A use without a meaning in every reading
raises `TermError`.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any, NoReturn, cast, overload

from safety.terms.construct import (
    add,
    build,
    cast_to,
    clamp,
    const,
    cut,
    lift,
    multiply,
    pair,
    show,
    subtract,
    whole,
    wire,
    word_beside,
)
from safety.terms.graph import BIT, REAL, Term, TermError, describe, integer, register_class, uint


def _refuse(what: str, remedy: str) -> Callable[..., NoReturn]:
    def refuse(self: Term, *_: object) -> NoReturn:
        raise TermError(f"{describe(self)} is a {self.sort} signal, not a Python value: {what}; write {remedy}")

    return refuse


class Value(Term):
    """What every value shares: no truth, no iteration, `==` as a term."""

    __slots__ = ()
    __array_ufunc__ = None  # a NumPy number beside a value leaves the operation, and the message, to the value
    __hash__ = object.__hash__
    __bool__ = _refuse(
        "`if`, `and`, `or`, `not`, `in`, `max`, `min`, `assert` and a < b < c cannot decide it",
        "select(...), &, |, ~ or implies(...)",
    )
    __contains__ = _refuse("`in` cannot decide it", "(x == a) | (x == b)")
    __iter__ = _refuse("it cannot be iterated over", ".bit(i) on a word, bit by bit")
    __len__ = _refuse("it has no Python length", "its width as a number")
    __index__ = _refuse("it cannot be an index or a range bound", "select(...) over the cases")
    __int__ = _refuse("it has no single number", "the term itself")
    __float__ = _refuse("it has no single number", "the term itself")
    __getitem__ = _refuse("it cannot be indexed", ".bit(i) or .slice(start, count)")

    def __eq__(self, other: object) -> Bit:  # type: ignore[override]
        return cast(Bit, build("eq", pair(self, other, "=="), None, BIT))

    def __ne__(self, other: object) -> Bit:  # type: ignore[override]
        return ~cast(Bit, build("eq", pair(self, other, "!="), None, BIT))


class Bit(Value):
    """One wire: true or false."""

    __slots__ = ()

    def _with(self, op: str, symbol: str, other: object) -> Bit:
        return cast(Bit, build(op, (self, wire(other, f"{show(self)} {symbol} {show(other)}")), None, BIT))

    def __and__(self, other: Bit | bool) -> Bit:
        return self._with("and", "&", other)

    def __or__(self, other: Bit | bool) -> Bit:
        return self._with("or", "|", other)

    def __xor__(self, other: Bit | bool) -> Bit:
        return self._with("xor", "^", other)

    def __invert__(self) -> Bit:
        return cast(Bit, build("not", (self,), None, BIT))

    __rand__, __ror__, __rxor__ = __and__, __or__, __xor__

    def word(self) -> UInt:
        """The wire as a word of 1 bit: 1 when true."""
        return cast(UInt, build("select", (self, const(1, uint(1)), const(0, uint(1))), None, uint(1)))


class Number(Value):
    """What words, bounded integers and reals share: comparison of the exact values, across widths and kinds."""

    __slots__ = ()

    def __lt__(self, other: Any) -> Bit:
        return cast(Bit, build("lt", pair(self, other, "<"), None, BIT))

    def __le__(self, other: Any) -> Bit:
        return cast(Bit, build("le", pair(self, other, "<="), None, BIT))

    def __gt__(self, other: Any) -> Bit:
        return cast(Bit, build("lt", pair(self, other, ">")[::-1], None, BIT))

    def __ge__(self, other: Any) -> Bit:
        return cast(Bit, build("le", pair(self, other, ">=")[::-1], None, BIT))

    def real(self) -> Real:
        """The same value as an exact real, in the unit it had."""
        return cast(Real, cast_to(self, REAL))


class UInt(Number):
    """An unsigned word; the annotation gives the width: `U8 = Annotated[UInt, 8]`."""

    __slots__ = ()

    @property
    def width(self) -> int:
        """Bits."""
        return self.sort.width

    @overload
    def __add__(self, other: UInt | int) -> UInt: ...
    @overload
    def __add__(self, other: Int) -> Int: ...
    @overload
    def __add__(self, other: Real | Fraction) -> Real: ...
    def __add__(self, other: Any) -> Any:
        return add(self, other)

    def __radd__(self, other: int) -> UInt:
        return self + other

    @overload
    def __sub__(self, other: UInt | Int | int) -> Int: ...
    @overload
    def __sub__(self, other: Real | Fraction) -> Real: ...
    def __sub__(self, other: Any) -> Any:
        return subtract(*pair(self, other, "-"))

    def __rsub__(self, other: int) -> Int:
        return cast(Int, subtract(*pair(lift(other, self, "-"), self, "-")))

    @overload
    def __mul__(self, other: UInt | int) -> UInt: ...
    @overload
    def __mul__(self, other: Int) -> Int: ...
    @overload
    def __mul__(self, other: Real | Fraction) -> Real: ...
    def __mul__(self, other: Any) -> Any:
        return multiply(self, other)

    def __rmul__(self, other: int) -> UInt:
        return self * other

    def __floordiv__(self, divisor: int) -> UInt:
        by = whole(divisor, 1, self, "a divisor")
        return cast(UInt, build("div", (self,), by, uint(max((self.sort.bounds[1] // by).bit_length(), 1))))

    def __mod__(self, divisor: int) -> UInt:
        by = whole(divisor, 1, self, "a divisor")
        return cast(UInt, build("mod", (self,), by, uint(max((by - 1).bit_length(), 1))))

    def _bitwise(self, op: str, symbol: str, other: UInt | int) -> UInt:
        return cast(UInt, build(op, (self, word_beside(self, other, symbol)), None, self.sort))

    def __and__(self, other: UInt | int) -> UInt:
        return self._bitwise("band", "&", other)

    def __or__(self, other: UInt | int) -> UInt:
        return self._bitwise("bor", "|", other)

    def __xor__(self, other: UInt | int) -> UInt:
        return self._bitwise("bxor", "^", other)

    __rand__, __ror__, __rxor__ = __and__, __or__, __xor__

    def __invert__(self) -> UInt:
        return self ^ self.sort.bounds[1]

    def __lshift__(self, count: int) -> UInt:
        count = whole(count, 0, self, "a shift")
        return self.concat(cast(UInt, const(0, uint(count)))) if count else self

    def __rshift__(self, count: int) -> UInt:
        count = whole(count, 0, self, "a shift")
        if count >= self.width:
            raise TermError(f"{show(self)} >> {count} leaves no bit; shift by {self.width - 1} at most")
        return self.slice(count, self.width - count)

    def low(self, width: int) -> UInt:
        """The lowest `width` bits, a word of `width` bits: the value modulo 2**width (the explicit wrap).

        Raises `TermError` unless `width` is 1 or more; a width above the word's own adds zeros.
        """
        return cast(UInt, cut(self, 0, whole(width, 1, self, "the width of .low")))

    def slice(self, start: int, count: int) -> UInt:
        """`count` bits from bit `start` up, a word of `count` bits; `TermError` for bits that the word has not."""
        start = whole(start, 0, self, "the first bit of .slice")
        count = whole(count, 1, self, "the number of bits of .slice")
        if start + count > self.width:
            raise TermError(f"{show(self)} has bits 0..{self.width - 1}, not bits {start}..{start + count - 1}")
        return cast(UInt, cut(self, start, count))

    def bit(self, number: int) -> Bit:
        """One bit, 0 the lowest; `TermError` for a bit that the word has not."""
        if whole(number, 0, self, "a bit's number") >= self.width:
            raise TermError(f"{show(self)} has bits 0..{self.width - 1}, not bit {number}")
        return cast(Bit, build("bit", (self,), number, BIT))

    def widen(self, width: int) -> UInt:
        """The same value in a word of `width` bits; `TermError` when that is narrower."""
        if whole(width, 1, self, "the width of .widen") < self.width:
            raise TermError(f"{show(self)}: .widen({width}) would cut it; write .low({width}) or .sat({width})")
        return cast(UInt, cast_to(self, uint(width)))

    def sat(self, width: int) -> UInt:
        """The value in a word of `width` bits, or that word's greatest value where it is greater.

        Raises `TermError` unless `width` is 1 or more.
        """
        return cast(UInt, clamp(self, uint(whole(width, 1, self, "the width of .sat"))))

    def sat_sub(self, other: UInt | int) -> UInt:
        """`self - other`, or 0 where that is negative; the width stays (nothing above it fits: it saturates)."""
        return (self - other).sat(self.width)

    def concat(self, low: UInt) -> UInt:
        """This word above another: `high.concat(low)`, as wide as both together; `TermError` unless `low` is a word."""
        if not isinstance(low, UInt):
            raise TermError(f"{show(self)}.concat({show(low)}): the lower part is a word; write .word() or word(v, n)")
        return cast(UInt, build("concat", (self, low), None, uint(self.width + low.width)))

    def int(self) -> Int:
        """The same value as a bounded integer with the word's range."""
        return cast(Int, cast_to(self, integer(*self.sort.bounds)))


class Int(Number):
    """A bounded integer, for differences and ghosts; its range follows from how it was made."""

    __slots__ = ()

    @overload
    def __add__(self, other: UInt | Int | int) -> Int: ...
    @overload
    def __add__(self, other: Real | Fraction) -> Real: ...
    def __add__(self, other: Any) -> Any:
        return add(self, other)

    def __radd__(self, other: int) -> Int:
        return self + other

    @overload
    def __sub__(self, other: UInt | Int | int) -> Int: ...
    @overload
    def __sub__(self, other: Real | Fraction) -> Real: ...
    def __sub__(self, other: Any) -> Any:
        return subtract(*pair(self, other, "-"))

    def __rsub__(self, other: int) -> Int:
        return cast(Int, subtract(*pair(lift(other, self, "-"), self, "-")))

    @overload
    def __mul__(self, other: UInt | Int | int) -> Int: ...
    @overload
    def __mul__(self, other: Real | Fraction) -> Real: ...
    def __mul__(self, other: Any) -> Any:
        return multiply(self, other)

    def __rmul__(self, other: int) -> Int:
        return self * other

    def __neg__(self) -> Int:
        return 0 - self

    def sat(self, width: int) -> UInt:
        """The value clamped into a word of `width` bits: 0 below, the greatest word above.

        Raises `TermError` unless `width` is 1 or more.
        """
        return cast(UInt, clamp(self, uint(whole(width, 1, self, "the width of .sat"))))

    def clip(self, low: int, high: int) -> Int:
        """The value clamped into `low..high`, an integer of that range; `TermError` unless the bounds are in order."""
        if type(low) is not int or type(high) is not int or low > high:
            raise TermError(f"{show(self)}.clip({show(low)}, {show(high)}): the bounds are whole constants, low first")
        return cast(Int, clamp(self, integer(low, high)))

    def low(self, width: int) -> UInt:
        """The value modulo 2**width, a word of `width` bits (two's complement wrap).

        Raises `TermError` unless `width` is 1 or more.
        """
        return cast(UInt, cut(self, 0, whole(width, 1, self, "the width of .low")))


class Real(Number):
    """An exact real number; constants are whole numbers and fractions, never floats."""

    __slots__ = ()

    def __add__(self, other: Any) -> Real:
        return cast(Real, add(self, other))

    def __sub__(self, other: Any) -> Real:
        return cast(Real, subtract(*pair(self, other, "-")))

    def __mul__(self, other: Any) -> Real:
        return cast(Real, multiply(self, other))

    def __rsub__(self, other: int | Fraction) -> Real:
        return cast(Real, subtract(*pair(lift(other, self, "-"), self, "-")))

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, divisor: int | Fraction) -> Real:
        if isinstance(divisor, bool) or not isinstance(divisor, int | Fraction) or divisor == 0:
            raise TermError(
                f"{show(self)} / {show(divisor)}: a real is divided by a whole number or Fraction other than 0"
            )
        return self * (Fraction(1) / divisor)

    def __neg__(self) -> Real:
        return 0 - self


_KINDS: dict[str, type[Value]] = {"bit": Bit, "uint": UInt, "int": Int, "real": Real}
for _kind, _class in _KINDS.items():
    register_class(_kind, _class)


_ARITHMETIC = "add radd sub rsub mul rmul neg pos abs"
_DIVISION = "truediv rtruediv floordiv rfloordiv mod rmod divmod rdivmod pow rpow"
_SHIFTS = "lshift rlshift rshift rrshift"
_BITWISE = "and rand or ror xor rxor invert"
_ROUNDING = "round floor ceil trunc"

_REFUSED: tuple[tuple[type[Value], str, str, str], ...] = (
    (Bit, "lt le gt ge", "a wire has no order", "~a & b for a < b, or .word()"),
    (Bit, _ARITHMETIC, "a wire has no arithmetic", ".word() to count it as 0 or 1, or count(...)"),
    (Bit, f"{_DIVISION} {_SHIFTS} {_ROUNDING}", "a wire has no arithmetic", ".word() to count it as 0 or 1"),
    (UInt, "neg", "a word has no negative", "0 - x"),
    (UInt, "truediv", "the quotient is not a word", "x // n for its whole part, or x.real() / n"),
    (UInt, _DIVISION, "only a word is divided, and by a whole constant", "x // n, x % n, or x * x for a power"),
    (UInt, _SHIFTS, "only a word is shifted, and by a whole constant", "x << n, or select(...) over the shifts"),
    (Int, _DIVISION, "only a word is divided", ".sat(width) or .low(width) first, or x.real() / n"),
    (Int, f"{_BITWISE} {_SHIFTS}", "an integer has no bits", ".low(width) for its two's complement, or x * 2**n"),
    (Real, _DIVISION, "a real is divided by a constant only", "x / n, x * Fraction(1, n), or x * x for a power"),
    (Real, f"{_BITWISE} {_SHIFTS}", "a real has no bits", "a comparison for a bit"),
    (Number, f"pos abs {_ROUNDING}", "it is exact and has a sign only as a term", "x, or select(x < 0, 0 - x, x)"),
)

for _cls, _names, _what, _remedy in _REFUSED:
    for _name in _names.split():
        if f"__{_name}__" not in vars(_cls):  # the type checker still sees no such operator
            setattr(_cls, f"__{_name}__", _refuse(_what, _remedy))
