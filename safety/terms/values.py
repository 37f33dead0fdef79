"""The values a model is written with: `Bit`, `UInt`, `Int`, `Real`, and the functions on them.

Widths are exact: `a + b` is one bit wider than the wider operand, `.low(8)` wraps, `.bit(8)` is the carry, `.sat(8)`
saturates; `a - b` is a bounded integer, so nothing is lost below zero.  A value has no truth: `if`, `and`, `in`, `max`
raise and say what to write.  `==` gives a `Bit`; hashing is by identity.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any, NoReturn, TypeVar, cast, overload

from safety.terms import graph
from safety.terms.graph import BIT, REAL, Sort, Term, TermError, describe, integer, register_class, uint
from safety.terms.table import OPERATIONS

AnyTerm = TypeVar("AnyTerm", "Bit", "UInt", "Int", "Real")


def build(op: str, args: tuple[Term, ...], attr: Any, sort: Sort) -> Term:
    """A term, folded when every argument is a constant, with the few rewrites that keep fault-free graphs small."""
    if args and all(a.is_const for a in args):
        row = OPERATIONS[op]
        probe = graph.node(op, args, attr, sort)
        return const(row.direct(probe, *(a.attr for a in args)), sort)
    simpler = _simplify(op, args)
    return graph.node(op, args, attr, sort) if simpler is None else simpler


def const(value: bool | int | Fraction, sort: Sort) -> Term:
    """A constant of a sort."""
    if not sort.admits(value):
        raise TermError(f"{value!r} is not a value of {sort}")
    return graph.node("const", (), Fraction(value) if sort.kind == "real" else value, sort)


def _simplify(op: str, args: tuple[Term, ...]) -> Term | None:
    if op == "not" and args[0].op == "not":
        return args[0].args[0]
    if op == "select":
        if args[0].is_const:
            taken = args[1] if args[0].attr else args[2]
            return taken if args[1].sort == args[2].sort else None
        return args[1] if args[1] is args[2] else None
    if op in ("and", "or"):
        absorbing = op == "or"
        for x, y in (args, args[::-1]):
            if x.is_const:
                return x if x.attr is absorbing else y
        return args[0] if args[0] is args[1] else None
    return None


def _refuse(what: str, remedy: str) -> Callable[..., NoReturn]:
    def refuse(self: Term, *_: object) -> NoReturn:
        raise TermError(f"{describe(self)} is a {self.sort} signal, not a Python value: {what}; write {remedy}")

    return refuse


class Value(Term):
    """What every value shares: no truth, no iteration, `==` as a term."""

    __slots__ = ()
    __hash__ = object.__hash__
    __bool__ = _refuse("`if`, `and`, `or`, `not`, `max` and `assert` cannot decide it", "select(...), &, |, ~ or implies(...)")
    __contains__ = _refuse("`in` cannot decide it", "(x == a) | (x == b)")
    __iter__ = _refuse("it cannot be iterated over", ".bit(i) for each bit")
    __len__ = _refuse("it has no Python length", "its width as a number")
    __index__ = _refuse("it cannot be an index or a range bound", "select(...) over the cases")
    __int__ = _refuse("it has no single number", "the term itself")
    __float__ = _refuse("it has no single number", "the term itself")
    __getitem__ = _refuse("it cannot be indexed", ".bit(i) or .slice(start, count)")

    def __eq__(self, other: object) -> Bit:  # type: ignore[override]
        x, y = _pair(self, other, "==")
        return cast(Bit, build("eq", (x, y), None, BIT))

    def __ne__(self, other: object) -> Bit:  # type: ignore[override]
        return ~(self == other)


class Bit(Value):
    """One wire: true or false."""

    __slots__ = ()

    def __and__(self, other: Bit | bool) -> Bit:
        return cast(Bit, build("and", (self, _bit(other, self, "&")), None, BIT))

    def __or__(self, other: Bit | bool) -> Bit:
        return cast(Bit, build("or", (self, _bit(other, self, "|")), None, BIT))

    def __xor__(self, other: Bit | bool) -> Bit:
        return cast(Bit, build("xor", (self, _bit(other, self, "^")), None, BIT))

    def __invert__(self) -> Bit:
        return cast(Bit, build("not", (self,), None, BIT))

    __rand__, __ror__, __rxor__ = __and__, __or__, __xor__

    def word(self) -> UInt:
        """The wire as a word of one bit: 1 when true."""
        return cast(UInt, build("select", (self, const(1, uint(1)), const(0, uint(1))), None, uint(1)))


class Number(Value):
    """What words, bounded integers and reals share: exact arithmetic and comparison."""

    __slots__ = ()

    def __lt__(self, other: Any) -> Bit:
        return cast(Bit, build("lt", _pair(self, other, "<"), None, BIT))

    def __le__(self, other: Any) -> Bit:
        return cast(Bit, build("le", _pair(self, other, "<="), None, BIT))

    def __gt__(self, other: Any) -> Bit:
        return cast(Bit, build("lt", _pair(self, other, ">")[::-1], None, BIT))

    def __ge__(self, other: Any) -> Bit:
        return cast(Bit, build("le", _pair(self, other, ">=")[::-1], None, BIT))

    def real(self) -> Real:
        """The same value as an exact real."""
        return cast(Real, _cast(self, REAL))

    def _clip(self, sort: Sort) -> Term:
        low, high = self.sort.bounds
        want_low, want_high = sort.bounds
        return _cast(self, sort) if want_low <= low and high <= want_high else build("clip", (self,), None, sort)


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
        return _add(self, other)

    def __radd__(self, other: int) -> UInt:
        return self + other

    @overload
    def __sub__(self, other: UInt | Int | int) -> Int: ...
    @overload
    def __sub__(self, other: Real | Fraction) -> Real: ...
    def __sub__(self, other: Any) -> Any:
        return _sub(self, other)

    def __rsub__(self, other: int) -> Int:
        return cast(Int, _sub(_lift(other, self, "-"), self))

    @overload
    def __mul__(self, other: UInt | int) -> UInt: ...
    @overload
    def __mul__(self, other: Int) -> Int: ...
    @overload
    def __mul__(self, other: Real | Fraction) -> Real: ...
    def __mul__(self, other: Any) -> Any:
        return _mul(self, other)

    def __rmul__(self, other: int) -> UInt:
        return self * other

    def __floordiv__(self, divisor: int) -> UInt:
        return cast(UInt, build("div", (self,), _divisor(divisor, self), uint(max((self.sort.bounds[1] // divisor).bit_length(), 1))))

    def __mod__(self, divisor: int) -> UInt:
        return cast(UInt, build("mod", (self,), _divisor(divisor, self), uint(max((divisor - 1).bit_length(), 1))))

    def _bitwise(self, op: str, symbol: str, other: UInt | int) -> UInt:
        y = const(other, self.sort) if isinstance(other, int) and self.sort.admits(other) else other
        if not isinstance(y, UInt) or y.sort != self.sort:
            have = y.sort if isinstance(y, Term) else repr(y)
            raise TermError(
                f"width mismatch: {describe(self)}: {self.sort} {symbol} {describe(y) if isinstance(y, Term) else y}: {have}; "
                f"bring both to one width with .low(n) (cuts) or .widen(n) (adds zeros)"
            )
        return cast(UInt, build(op, (self, y), None, self.sort))

    def __and__(self, other: UInt | int) -> UInt:
        return self._bitwise("band", "&", other)

    def __or__(self, other: UInt | int) -> UInt:
        return self._bitwise("bor", "|", other)

    def __xor__(self, other: UInt | int) -> UInt:
        return self._bitwise("bxor", "^", other)

    def __invert__(self) -> UInt:
        return self ^ self.sort.bounds[1]

    def __lshift__(self, count: int) -> UInt:
        return self.concat(cast(UInt, const(0, uint(count)))) if count else self

    def __rshift__(self, count: int) -> UInt:
        return self.slice(count, self.width - count)

    def low(self, width: int) -> UInt:
        """The lowest `width` bits: the value modulo 2**width (the explicit wrap)."""
        return _slice(self, 0, width)

    def slice(self, start: int, count: int) -> UInt:
        """`count` bits from bit `start` up."""
        if start + count > self.width:
            raise TermError(f"{describe(self)} has {self.width} bits: it has no bits {start}..{start + count - 1}")
        return _slice(self, start, count)

    def bit(self, number: int) -> Bit:
        """One bit, 0 the lowest."""
        if not 0 <= number < self.width:
            raise TermError(f"{describe(self)} has bits 0..{self.width - 1}, not bit {number}")
        return cast(Bit, build("bit", (self,), number, BIT))

    def widen(self, width: int) -> UInt:
        """The same value in a word of `width` bits."""
        if width < self.width:
            raise TermError(f"{describe(self)} has {self.width} bits; .widen({width}) would cut it: write .low({width}) or .sat({width})")
        return cast(UInt, _cast(self, uint(width)))

    def sat(self, width: int) -> UInt:
        """The value, or the greatest word of `width` bits where it is greater."""
        return cast(UInt, self._clip(uint(width)))

    def sat_sub(self, other: UInt | int) -> UInt:
        """`self - other`, or 0 where that is negative; the width stays."""
        return (self - other).sat(self.width)

    def concat(self, low: UInt) -> UInt:
        """This word above another: `high.concat(low)`."""
        return cast(UInt, build("concat", (self, low), None, uint(self.width + low.width)))

    def int(self) -> Int:
        """The same value as a bounded integer."""
        return cast(Int, _cast(self, integer(*self.sort.bounds)))


class Int(Number):
    """A bounded integer, for differences and ghosts; its range follows from how it was made."""

    __slots__ = ()

    @overload
    def __add__(self, other: UInt | Int | int) -> Int: ...
    @overload
    def __add__(self, other: Real | Fraction) -> Real: ...
    def __add__(self, other: Any) -> Any:
        return _add(self, other)

    def __radd__(self, other: int) -> Int:
        return self + other

    @overload
    def __sub__(self, other: UInt | Int | int) -> Int: ...
    @overload
    def __sub__(self, other: Real | Fraction) -> Real: ...
    def __sub__(self, other: Any) -> Any:
        return _sub(self, other)

    def __rsub__(self, other: int) -> Int:
        return cast(Int, _sub(_lift(other, self, "-"), self))

    @overload
    def __mul__(self, other: UInt | Int | int) -> Int: ...
    @overload
    def __mul__(self, other: Real | Fraction) -> Real: ...
    def __mul__(self, other: Any) -> Any:
        return _mul(self, other)

    def __rmul__(self, other: int) -> Int:
        return self * other

    def __neg__(self) -> Int:
        return 0 - self

    def sat(self, width: int) -> UInt:
        """The value clamped into a word of `width` bits: 0 below, the greatest word above."""
        return cast(UInt, self._clip(uint(width)))

    def clip(self, low: int, high: int) -> Int:
        """The value clamped into `low..high`."""
        return cast(Int, self._clip(integer(low, high)))

    def low(self, width: int) -> UInt:
        """The value modulo 2**width (two's complement wrap)."""
        return _slice(self, 0, width)


class Real(Number):
    """An exact real number; constants are whole numbers and fractions, never floats."""

    __slots__ = ()

    def __add__(self, other: Any) -> Real:
        return cast(Real, _add(self, other))

    def __sub__(self, other: Any) -> Real:
        return cast(Real, _sub(self, other))

    def __mul__(self, other: Any) -> Real:
        return cast(Real, _mul(self, other))

    def __rsub__(self, other: int | Fraction) -> Real:
        return cast(Real, _sub(_lift(other, self, "-"), self))

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, divisor: int | Fraction) -> Real:
        if isinstance(divisor, bool) or not isinstance(divisor, int | Fraction) or divisor == 0:
            raise TermError(f"{describe(self)} / {divisor!r}: a real is divided by a constant other than 0 only")
        return self * (Fraction(1) / divisor)

    def __neg__(self) -> Real:
        return 0 - self


for _kind, _cls in (("bit", Bit), ("uint", UInt), ("int", Int), ("real", Real)):
    register_class(_kind, _cls)


def _lift(x: object, other: Term, symbol: str) -> Term:
    """A Python number beside a term, as a constant term."""
    if isinstance(x, Term):
        return x
    if isinstance(x, float):
        raise TermError(f"{describe(other)} {symbol} {x}: floats are not exact; write Fraction('{x}')")
    if isinstance(x, Fraction):
        return const(x, REAL)
    if isinstance(x, int) and not isinstance(x, bool):
        if other.sort.kind == "real":
            return const(x, REAL)
        return const(x, uint(max(x.bit_length(), 1)) if x >= 0 else integer(x, x))
    raise TermError(f"{describe(other)} {symbol} {x!r}: a {other.sort} does not combine with {type(x).__name__}")


def _pair(x: Term, other: object, symbol: str) -> tuple[Term, Term]:
    """Two operands of one kind; words, integers and reals mix, bits do not."""
    if x.sort == BIT:
        return x, _bit(other, x, symbol)
    y = _lift(other, x, symbol)
    if y.sort == BIT:
        raise TermError(f"{describe(x)}: {x.sort} {symbol} {describe(y)}: bit; write {describe(y)}.word() to count a wire as 0 or 1")
    if REAL in (x.sort, y.sort):
        return _cast(x, REAL), _cast(y, REAL)
    return x, y


def _bit(x: object, other: Term, symbol: str) -> Term:
    if isinstance(x, bool):
        return const(x, BIT)
    if isinstance(x, Bit):
        return x
    have = f"{describe(x)}: {x.sort}" if isinstance(x, Term) else repr(x)
    raise TermError(f"{describe(other)}: bit {symbol} {have}; both sides must be bits: write a comparison, .bit(i) or True/False")


def _cast(x: Term, sort: Sort) -> Term:
    return x if x.sort == sort else build("cast", (x,), None, sort)


def _both_words(x: Term, y: Term) -> bool:
    return x.sort.kind == y.sort.kind == "uint"


def _add(a: Term, other: object) -> Term:
    x, y = _pair(a, other, "+")
    if x.sort == REAL:
        return build("add", (x, y), None, REAL)
    if _both_words(x, y):
        return build("add", (x, y), None, uint(max(x.sort.width, y.sort.width) + 1))
    (al, ah), (bl, bh) = x.sort.bounds, y.sort.bounds
    return build("add", (x, y), None, integer(al + bl, ah + bh))


def _sub(a: Term, other: object) -> Term:
    x, y = _pair(a, other, "-")
    if x.sort == REAL:
        return build("sub", (x, y), None, REAL)
    (al, ah), (bl, bh) = x.sort.bounds, y.sort.bounds
    return build("sub", (x, y), None, integer(al - bh, ah - bl))


def _mul(a: Term, other: object) -> Term:
    x, y = _pair(a, other, "*")
    if x.sort == REAL:
        return build("mul", (x, y), None, REAL)
    if _both_words(x, y):
        return build("mul", (x, y), None, uint(x.sort.width + y.sort.width))
    corners = [p * q for p in x.sort.bounds for q in y.sort.bounds]
    return build("mul", (x, y), None, integer(min(corners), max(corners)))


def _slice(x: Term, start: int, count: int) -> UInt:
    if count < 1 or start < 0:
        raise TermError(f"{describe(x)}: a slice has 1 bit or more from bit 0 up, not {count} from {start}")
    if x.sort.kind == "uint" and start == 0 and count >= x.sort.width:
        return cast(UInt, _cast(x, uint(count)))
    return cast(UInt, build("slice", (x,), (start, count), uint(count)))


def _divisor(divisor: object, x: Term) -> int:
    if isinstance(divisor, bool) or not isinstance(divisor, int) or divisor < 1:
        raise TermError(f"{describe(x)}: a word is divided by a whole constant from 1 up only, not by {divisor!r}")
    return divisor


# --- functions -----------------------------------------------------------------------------------------------------


@overload
def select(condition: Bit, then: Bit | bool, otherwise: Bit) -> Bit: ...
@overload
def select(condition: Bit, then: Bit, otherwise: bool) -> Bit: ...
@overload
def select(condition: Bit, then: UInt | int, otherwise: UInt) -> UInt: ...
@overload
def select(condition: Bit, then: UInt, otherwise: int) -> UInt: ...
@overload
def select(condition: Bit, then: Int | UInt | int, otherwise: Int) -> Int: ...
@overload
def select(condition: Bit, then: Int, otherwise: UInt | int) -> Int: ...
@overload
def select(condition: Bit, then: Real, otherwise: Real | int | Fraction) -> Real: ...
@overload
def select(condition: Bit, then: int | Fraction, otherwise: Real) -> Real: ...
def select(condition: Bit, then: Any, otherwise: Any) -> Any:
    """`then` where `condition` holds, else `otherwise`; a literal takes the sort of the other branch.

    Raises `TermError` when two words differ in width.
    """
    c = _bit(condition, const(True, BIT), "select") if not isinstance(condition, Bit) else condition
    if not isinstance(then, Term) and not isinstance(otherwise, Term):
        raise TermError(f"select({describe(c)}, {then!r}, {otherwise!r}): one branch must be a term; write word({then!r}, width)")
    x, y = _branch(then, otherwise), _branch(otherwise, then)
    if x.sort == y.sort:
        return build("select", (c, x, y), None, x.sort)
    if REAL in (x.sort, y.sort) and BIT not in (x.sort, y.sort):
        return build("select", (c, _cast(x, REAL), _cast(y, REAL)), None, REAL)
    if BIT in (x.sort, y.sort) or _both_words(x, y):
        raise TermError(
            f"select({describe(c)}, {describe(x)}: {x.sort}, {describe(y)}: {y.sort}): the branches differ; "
            "bring both to one width with .low(n), .sat(n) or .widen(n)"
        )
    (al, ah), (bl, bh) = x.sort.bounds, y.sort.bounds
    hull = integer(min(al, bl), max(ah, bh))
    return build("select", (c, _cast(x, hull), _cast(y, hull)), None, hull)


def _branch(x: Any, other: Any) -> Term:
    if isinstance(x, Term):
        return x
    sort = other.sort
    if sort.admits(x) and sort.kind in ("bit", "uint", "real"):
        return const(x, sort)
    if sort.kind == "int" and isinstance(x, int) and not isinstance(x, bool):
        return const(x, integer(x, x))
    raise TermError(f"select(..., {describe(other)}: {sort}, {x!r}): {x!r} is not a value of {sort}")


def implies(premise: Bit, conclusion: Bit) -> Bit:
    """Where the premise holds, so does the conclusion (kept visible, so that the premise can be shown reachable)."""
    return cast(Bit, build("implies", (_bit(premise, conclusion, "implies"), _bit(conclusion, premise, "implies")), None, BIT))


def word(value: int, width: int) -> UInt:
    """A constant word."""
    return cast(UInt, const(value, uint(width)))


def bit(value: bool) -> Bit:
    """A constant wire."""
    return cast(Bit, const(value, BIT))


def real(value: int | Fraction | str) -> Real:
    """A constant real, e.g. `real("2.5")` or `real(Fraction(1, 3))`."""
    if isinstance(value, float):
        raise TermError(f"floats are not exact; write real('{value}')")
    return cast(Real, const(Fraction(value), REAL))


def all_of(*bits: Bit) -> Bit:
    """The conjunction; true of none."""
    total = bit(True)
    for b in bits:
        total = total & b
    return total


def any_of(*bits: Bit) -> Bit:
    """The disjunction; false of none."""
    total = bit(False)
    for b in bits:
        total = total | b
    return total


def count(*bits: Bit) -> UInt:
    """How many of the wires are true, in a word just wide enough."""
    if not bits:
        raise TermError("count() needs at least one bit")
    total: UInt = bits[0].word()
    for b in bits[1:]:
        total = total + b.word()
    return total.sat(len(bits).bit_length())


def at_least(k: int, *bits: Bit) -> Bit:
    """Whether at least `k` of the wires are true (the k-out-of-n vote)."""
    return count(*bits) >= k
