"""The table of operations: a row is an operation, a column is a reading.

| column  | a value is                          | a row's entry                                     |
|---------|-------------------------------------|---------------------------------------------------|
| direct  | bool, int, Fraction                 | function of the term and the argument values      |
| python  | source text over the same           | function of the term and the argument texts       |
| lanes   | source text over NumPy arrays       | the same; words are int64, or object beyond it    |
| integer | solver term: Bool, Int, Real        | function of the solver's module, term, arguments  |
| vector  | solver term: Bool, bit-vector       | the same; reals have no such reading              |

The solver's module is z3 or `cvc5.pythonic`: one text serves both.  `tests/terms` proves the columns equal.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from safety.terms.graph import Sort, Term, TermError, Value

Text = Callable[..., str]
Solver = Callable[..., Any]


@dataclass(frozen=True)
class Operation:
    """One row."""

    direct: Callable[..., Value]
    python: Text
    lanes: Text
    integer: Solver
    vector: Solver


# --- words and ranges as bit-vectors -------------------------------------------------------------------------------


def vector_bits(sort: Sort) -> int:
    """Bits of a sort as a bit-vector: a word has its width, a bounded integer is two's complement."""
    if sort.kind == "uint":
        return sort.width
    if sort.kind == "real":
        raise TermError("a real has no bit-vector reading: prove this claim in the integer reading")
    low, high = sort.bounds
    return max((-low - 1).bit_length() if low < 0 else 0, high.bit_length()) + 1


def resize(k: Any, x: Any, sort: Sort, bits: int) -> Any:
    """The bit-vector of a value of `sort`, extended by its own sign rule (or cut) to `bits`."""
    have = vector_bits(sort)
    if bits == have:
        return x
    if bits < have:
        return k.Extract(bits - 1, 0, x)
    return (k.ZeroExt if sort.kind == "uint" else k.SignExt)(bits - have, x)


def _signed_bits(*sorts: Sort) -> int:
    return max(vector_bits(s) + (s.kind == "uint") for s in sorts)


def _arithmetic(f: Callable[[Any, Any], Any]) -> Solver:
    def row(k: Any, t: Term, x: Any, y: Any) -> Any:
        bits = vector_bits(t.sort)
        return f(resize(k, x, t.args[0].sort, bits), resize(k, y, t.args[1].sort, bits))

    return row


def _comparison(unsigned: str, signed: Callable[[Any, Any], Any]) -> Solver:
    def row(k: Any, t: Term, x: Any, y: Any) -> Any:
        a, b = t.args[0].sort, t.args[1].sort
        if a.kind == b.kind == "uint":
            bits = max(a.width, b.width)
            return getattr(k, unsigned)(resize(k, x, a, bits), resize(k, y, b, bits))
        bits = _signed_bits(a, b)
        return signed(resize(k, x, a, bits), resize(k, y, b, bits))

    return row


def _vector_eq(k: Any, t: Term, x: Any, y: Any) -> Any:
    a, b = t.args[0].sort, t.args[1].sort
    if a.kind == "bit":
        return x == y
    bits = _signed_bits(a, b)
    return resize(k, x, a, bits) == resize(k, y, b, bits)


def _vector_select(k: Any, t: Term, c: Any, x: Any, y: Any) -> Any:
    if t.sort.kind == "bit":
        return k.If(c, x, y)
    bits = vector_bits(t.sort)
    return k.If(c, resize(k, x, t.args[1].sort, bits), resize(k, y, t.args[2].sort, bits))


def _vector_slice(k: Any, t: Term, x: Any) -> Any:
    start, count = t.attr
    source = t.args[0].sort
    x = resize(k, x, source, max(vector_bits(source), start + count))
    return k.Extract(start + count - 1, start, x)


def _vector_bit(k: Any, t: Term, x: Any) -> Any:
    return k.Extract(t.attr, t.attr, x) == k.BitVecVal(1, 1)


def _vector_clip(k: Any, t: Term, x: Any) -> Any:
    source = t.args[0].sort
    bits = _signed_bits(source, t.sort)
    low, high = (k.BitVecVal(b, bits) for b in t.sort.bounds)
    x = resize(k, x, source, bits)
    return k.Extract(vector_bits(t.sort) - 1, 0, k.If(x < low, low, k.If(x > high, high, x)))


def _vector_const(k: Any, t: Term) -> Any:
    return k.BoolVal(t.attr) if t.sort.kind == "bit" else k.BitVecVal(t.attr, vector_bits(t.sort))


# --- words as integers ---------------------------------------------------------------------------------------------


def _integer_const(k: Any, t: Term) -> Any:
    if t.sort.kind == "bit":
        return k.BoolVal(t.attr)
    return k.RealVal(str(t.attr)) if t.sort.kind == "real" else k.IntVal(t.attr)


def _integer_slice(k: Any, t: Term, x: Any) -> Any:
    start, count = t.attr
    low, high = t.args[0].sort.bounds
    size = 1 << count
    if start == 0 and 0 <= low and high < size:
        return x
    if start == 0 and 0 <= low and high < 2 * size:  # one carry: no division
        return k.If(x >= size, x - size, x)
    if start == 0 and -size <= low and high < size:  # one borrow
        return k.If(x < 0, x + size, x)
    return (x / (1 << start)) % size


def _integer_bit(k: Any, t: Term, x: Any) -> Any:
    low, high = t.args[0].sort.bounds
    if low >= 0 and high < 2 << t.attr:
        return x >= (1 << t.attr)
    return (x / (1 << t.attr)) % 2 == 1


def _integer_bitwise(choose: Callable[[Any, Any, Any], Any]) -> Solver:
    def row(k: Any, t: Term, x: Any, y: Any) -> Any:
        pairs = [((x / (1 << i)) % 2 == 1, (y / (1 << i)) % 2 == 1) for i in range(t.sort.width)]
        return sum((k.If(choose(k, a, b), k.IntVal(1 << i), k.IntVal(0)) for i, (a, b) in enumerate(pairs)), k.IntVal(0))

    return row


def _integer_clip(k: Any, t: Term, x: Any) -> Any:
    low, high = t.sort.bounds
    return k.If(x < low, k.IntVal(low), k.If(x > high, k.IntVal(high), x))


def _integer_cast(k: Any, t: Term, x: Any) -> Any:
    return k.ToReal(x) if t.sort.kind == "real" and t.args[0].sort.kind != "real" else x


def _integer_select(k: Any, t: Term, c: Any, x: Any, y: Any) -> Any:
    return k.If(c, x, y)


# --- texts ---------------------------------------------------------------------------------------------------------


def literal(value: Value) -> str:
    """Source text of a constant."""
    return f"Fraction({value.numerator}, {value.denominator})" if isinstance(value, Fraction) else repr(value)


def is_object(sort: Sort) -> bool:
    """Whether lanes of this sort need Python objects: reals, and numbers beyond 64-bit integers."""
    return sort.kind == "real" or (sort.kind != "bit" and not (-(2**63) <= sort.bounds[0] and sort.bounds[1] < 2**63))


def _lanes_as(text: str, term: Term, want_object: bool) -> str:
    """The lanes of a term as object lanes or as int64 lanes; constants broadcast as they are."""
    if is_object(term.sort) == want_object or term.is_const:
        return text
    return f"{text}.astype({'object' if want_object else 'np.int64'})"


def _lane_word(text: str, t: Term, wide: bool) -> str:
    """The result of an object computation as lanes of the term's own sort."""
    return f"{text}.astype(np.int64)" if wide and not is_object(t.sort) else text


def _infix(symbol: str) -> Text:
    return lambda t, x, y: f"({x} {symbol} {y})"


def _lane_numbers(symbol: str) -> Text:
    def text(t: Term, x: str, y: str) -> str:
        wide = any(is_object(s) for s in (t.sort, *(a.sort for a in t.args)))
        x, y = (_lanes_as(v, a, wide) for v, a in zip((x, y), t.args, strict=True))
        return _lane_word(f"({x} {symbol} {y})", t, wide)

    return text


def _lane_compare(symbol: str) -> Text:
    def text(t: Term, x: str, y: str) -> str:
        wide = any(is_object(a.sort) for a in t.args)
        x, y = (_lanes_as(v, a, wide) for v, a in zip((x, y), t.args, strict=True))
        return f"({x} {symbol} {y}).astype(bool)" if wide else f"({x} {symbol} {y})"

    return text


def _lane_slice(t: Term, x: str) -> str:
    start, count = t.attr
    wide = is_object(t.args[0].sort)
    text = f"(({x} >> {start}) & {(1 << count) - 1})" if start else f"({x} & {(1 << count) - 1})"
    return _lane_word(text, t, wide)


def _lane_clip(t: Term, x: str) -> str:
    low, high = t.sort.bounds
    return _lane_word(f"np.minimum(np.maximum({x}, {low}), {high})", t, is_object(t.args[0].sort))


def _lane_select(t: Term, c: str, x: str, y: str) -> str:
    if t.sort.kind == "bit":
        return f"np.where({c}, {x}, {y})"
    wide = is_object(t.sort)
    x, y = (_lanes_as(v, a, wide) for v, a in zip((x, y), t.args[1:], strict=True))
    return f"np.where({c}, {x}, {y})"


def _lane_cast_row(t: Term, x: str) -> str:
    if t.sort.kind == "real":
        return f"fractions({x})"
    return _lanes_as(x, t.args[0], is_object(t.sort))


def _lane_concat(t: Term, x: str, y: str) -> str:
    high, low = (_lanes_as(v, a, is_object(t.sort)) for v, a in zip((x, y), t.args, strict=True))
    return f"({high} << {t.args[1].sort.width} | {low})"


def _lane_divide(symbol: str) -> Text:
    return lambda t, x: _lane_word(f"({x} {symbol} {t.attr})", t, is_object(t.args[0].sort))


def _python_clip(t: Term, x: str) -> str:
    low, high = t.sort.bounds
    return f"min(max({x}, {low}), {high})"


def _python_slice(t: Term, x: str) -> str:
    start, count = t.attr
    return f"({x} >> {start} & {(1 << count) - 1})" if start else f"({x} & {(1 << count) - 1})"


def _same(t: Term, x: Any) -> Any:
    return x


def _solver_same(k: Any, t: Term, x: Any) -> Any:
    return x


def _connective(name: str) -> Solver:
    return lambda k, t, x, y: getattr(k, name)(x, y)


def _unused(*_: Any) -> Any:
    raise AssertionError("leaves are bound by the reading, not computed")


OPERATIONS: dict[str, Operation] = {
    "const": Operation(lambda t: t.attr, lambda t: literal(t.attr), lambda t: literal(t.attr), _integer_const, _vector_const),
    "var": Operation(_unused, _unused, _unused, _unused, _unused),
    "point": Operation(_same, _same, _same, _solver_same, _solver_same),
    # bits
    "not": Operation(lambda t, x: not x, lambda t, x: f"(not {x})", lambda t, x: f"~{x}", lambda k, t, x: k.Not(x), lambda k, t, x: k.Not(x)),
    "and": Operation(lambda t, x, y: x and y, _infix("&"), _infix("&"), _connective("And"), _connective("And")),
    "or": Operation(lambda t, x, y: x or y, _infix("|"), _infix("|"), _connective("Or"), _connective("Or")),
    "xor": Operation(lambda t, x, y: x != y, _infix("^"), _infix("^"), _connective("Xor"), _connective("Xor")),
    "implies": Operation(
        lambda t, x, y: not x or y, lambda t, x, y: f"(not {x} or {y})", lambda t, x, y: f"(~{x} | {y})",
        _connective("Implies"), _connective("Implies"),
    ),
    # numbers
    "add": Operation(lambda t, x, y: x + y, _infix("+"), _lane_numbers("+"), lambda k, t, x, y: x + y, _arithmetic(lambda x, y: x + y)),
    "sub": Operation(lambda t, x, y: x - y, _infix("-"), _lane_numbers("-"), lambda k, t, x, y: x - y, _arithmetic(lambda x, y: x - y)),
    "mul": Operation(lambda t, x, y: x * y, _infix("*"), _lane_numbers("*"), lambda k, t, x, y: x * y, _arithmetic(lambda x, y: x * y)),
    "eq": Operation(lambda t, x, y: x == y, _infix("=="), _lane_compare("=="), lambda k, t, x, y: x == y, _vector_eq),
    "lt": Operation(lambda t, x, y: x < y, _infix("<"), _lane_compare("<"), lambda k, t, x, y: x < y, _comparison("ULT", lambda x, y: x < y)),
    "le": Operation(lambda t, x, y: x <= y, _infix("<="), _lane_compare("<="), lambda k, t, x, y: x <= y, _comparison("ULE", lambda x, y: x <= y)),
    "select": Operation(lambda t, c, x, y: x if c else y, lambda t, c, x, y: f"({x} if {c} else {y})", _lane_select, _integer_select, _vector_select),
    "cast": Operation(
        lambda t, x: Fraction(x) if t.sort.kind == "real" else x,
        lambda t, x: f"Fraction({x})" if t.sort.kind == "real" else x,
        _lane_cast_row, _integer_cast, lambda k, t, x: resize(k, x, t.args[0].sort, vector_bits(t.sort)),
    ),
    "clip": Operation(lambda t, x: min(max(x, t.sort.bounds[0]), t.sort.bounds[1]), _python_clip, _lane_clip, _integer_clip, _vector_clip),
    # words
    "slice": Operation(lambda t, x: (x >> t.attr[0]) % (1 << t.attr[1]), _python_slice, _lane_slice, _integer_slice, _vector_slice),
    "bit": Operation(
        lambda t, x: (x >> t.attr) % 2 == 1, lambda t, x: f"({x} >> {t.attr} & 1 == 1)", lambda t, x: f"(({x} >> {t.attr}) & 1 != 0).astype(bool)",
        _integer_bit, _vector_bit,
    ),
    "concat": Operation(
        lambda t, x, y: x << t.args[1].sort.width | y, lambda t, x, y: f"({x} << {t.args[1].sort.width} | {y})",
        _lane_concat,
        lambda k, t, x, y: x * (1 << t.args[1].sort.width) + y, lambda k, t, x, y: k.Concat(x, y),
    ),
    "div": Operation(lambda t, x: x // t.attr, lambda t, x: f"({x} // {t.attr})", _lane_divide("//"),
        lambda k, t, x: x / t.attr, lambda k, t, x: resize(k, k.UDiv(x, k.BitVecVal(t.attr, t.args[0].sort.width)), t.args[0].sort, t.sort.width)),
    "mod": Operation(lambda t, x: x % t.attr, lambda t, x: f"({x} % {t.attr})", _lane_divide("%"),
        lambda k, t, x: x % t.attr, lambda k, t, x: resize(k, k.URem(x, k.BitVecVal(t.attr, t.args[0].sort.width)), t.args[0].sort, t.sort.width)),
    "band": Operation(lambda t, x, y: x & y, _infix("&"), _infix("&"), _integer_bitwise(lambda k, a, b: k.And(a, b)), lambda k, t, x, y: x & y),
    "bor": Operation(lambda t, x, y: x | y, _infix("|"), _infix("|"), _integer_bitwise(lambda k, a, b: k.Or(a, b)), lambda k, t, x, y: x | y),
    "bxor": Operation(lambda t, x, y: x ^ y, _infix("^"), _infix("^"), _integer_bitwise(lambda k, a, b: k.Xor(a, b)), lambda k, t, x, y: x ^ y),
}  # fmt: skip
