"""Doubles that enclose reals: operations whose result lies on a given side of the exact one, for native code only.

A double is a word of 64 bits, its pattern.  `..._down` gives a double that is not above the exact result, `..._up` one
that is not below it, and the exact result itself where that is a double: the error of a rounded sum or product is
computed exactly (Knuth's TwoSum; a fused multiply-add), and only a result that was rounded to the wrong side takes a
step outward (Rump, Zimmermann, Boldo, Melquiond 2009).  Beyond the doubles the result is infinite or not a number, and
every comparison with a number that is none is false.  `mul_...` takes the bounds of two factors and gives that of all
products.
"""

from __future__ import annotations

import math
import struct
from fractions import Fraction
from typing import Any

from safety.terms.column_native import Code, Native, bit_of, bits_for, resized, splat, vector
from safety.terms.graph import BIT, Sort, Term, node, uint
from safety.terms.values import const

DOUBLE = uint(64)
SHARE, LEAST = 2.0**-53 + 2.0**-105, 2.0**-1021  # a step outward is |x| * SHARE + LEAST: one unit in the last place
SMALL, LARGE = 2.0**-900, 2.0**1000  # between these the error of a product, of a sum, is a double
EXACT_BITS = 53


def pattern(value: float) -> int:
    """A double as a word."""
    found: int = struct.unpack("<Q", struct.pack("<d", value))[0]
    return found


def value_of(word: int) -> float:
    """The double that a word is."""
    found: float = struct.unpack("<d", struct.pack("<Q", word))[0]
    return found


def enclosure(value: Fraction | int) -> tuple[int, int]:
    """The greatest double up to an exact value and the least one from it on: the same where it is one."""
    try:
        nearest = float(Fraction(value))
    except OverflowError:
        nearest = math.inf if value > 0 else -math.inf
    if nearest == value:
        return pattern(nearest + 0.0), pattern(nearest + 0.0)
    if nearest < value:
        return pattern(nearest), pattern(math.nextafter(nearest, math.inf))
    return pattern(math.nextafter(nearest, -math.inf)), pattern(nearest)


def encloses(low: int, high: int, value: Fraction | int) -> bool:
    """Whether an exact value lies between two doubles."""
    return value_of(low) <= value <= value_of(high)


def apply(op: str, *args: Term) -> Term:
    """An operation of this column on doubles, or the doubles next to a whole number."""
    return node(op, args, None, BIT if op in ("below", "up_to") else DOUBLE)


def constants(value: Fraction | int) -> tuple[Term, Term]:
    """The enclosure of a constant."""
    low, high = enclosure(value)
    return const(low, DOUBLE), const(high, DOUBLE)


# --- instructions --------------------------------------------------------------------------------------------------


def _kind(k: Code) -> str:
    return f"<{k.lanes} x double>"


def _all(value: float) -> str:
    return f"splat (double 0x{pattern(value):016X})"


def _double(k: Code, x: str) -> str:
    return k.op(f"bitcast {vector(k, 64)} {x} to {_kind(k)}")


def _word(k: Code, x: str) -> str:
    return k.op(f"bitcast {_kind(k)} {x} to {vector(k, 64)}")


def _is(k: Code, how: str, x: str, y: str) -> str:
    return k.op(f"fcmp {how} {_kind(k)} {x}, {y}")


def _both(k: Code, gate: str, x: str, y: str) -> str:
    return k.op(f"{gate} {vector(k, 1)} {x}, {y}")


def outward(k: Code, down: bool, x: str, error: str, known: str) -> str:
    """What was rounded to `x`, on the side asked for; `error` is the exact result minus `x` where that is `known`."""
    stays = _both(k, "and", _is(k, "oge" if down else "ole", error, _all(0.0)), known)
    size = k.call("fabs", _kind(k), x)
    step = k.op(f"fadd {_kind(k)} {k.op(f'fmul {_kind(k)} {size}, {_all(SHARE)}')}, {_all(LEAST)}")
    moved = k.op(f"{'fsub' if down else 'fadd'} {_kind(k)} {x}, {step}")
    return k.op(f"select {vector(k, 1)} {stays}, {_kind(k)} {x}, {_kind(k)} {moved}")


def rounded_sum(k: Code, down: bool, x: str, y: str) -> str:
    """The sum of two doubles."""
    kind = _kind(k)
    total = k.op(f"fadd {kind} {x}, {y}")
    second = k.op(f"fsub {kind} {total}, {x}")
    first = k.op(f"fsub {kind} {total}, {second}")
    error = k.op(f"fadd {kind} {k.op(f'fsub {kind} {x}, {first}')}, {k.op(f'fsub {kind} {y}, {second}')}")
    return outward(k, down, total, error, _is(k, "olt", k.call("fabs", kind, total), _all(LARGE)))


def rounded_product(k: Code, down: bool, x: str, y: str) -> str:
    """The product of two doubles."""
    kind = _kind(k)
    product = k.op(f"fmul {kind} {x}, {y}")
    error = k.call("fma", kind, x, y, k.op(f"fneg {kind} {product}"))
    zero = _both(k, "or", _is(k, "oeq", x, _all(0.0)), _is(k, "oeq", y, _all(0.0)))
    large = _is(k, "ogt", k.call("fabs", kind, product), _all(SMALL))
    return outward(k, down, product, error, _both(k, "or", zero, large))


def double_sum(down: bool, subtracts: bool) -> Native:
    """The sum or the difference of two bounds."""

    def entry(k: Code, t: Any, x: str, y: str) -> str:
        first, second = _double(k, x), _double(k, y)
        if subtracts:
            second = k.op(f"fneg {_kind(k)} {second}")
        return _word(k, rounded_sum(k, down, first, second))

    return entry


def double_product(down: bool) -> Native:
    """The least or the greatest product of two factors that lie between bounds; it is one of those of the bounds."""

    def entry(k: Code, t: Any, *bounds: str) -> str:
        a, b, c, d = (_double(k, x) for x in bounds)
        pairs = {
            (x, y): (p, q)
            for p, x in zip((a, b), bounds[:2], strict=True)
            for q, y in zip((c, d), bounds[2:], strict=True)
        }
        first, *others = (rounded_product(k, down, p, q) for p, q in pairs.values())
        for other in others:
            first = k.call("minimum" if down else "maximum", _kind(k), first, other)
        return _word(k, first)

    return entry


def fits(sort: Sort) -> bool:
    """Whether all values of a sort are doubles."""
    return all(abs(bound) <= 1 << EXACT_BITS for bound in sort.bounds)


def double_cast(down: bool) -> Native:
    """A whole number; one of more than 53 bits is the sum of its halves."""

    def entry(k: Code, t: Any, x: str) -> str:
        sort, kind = t.args[0].sort, _kind(k)
        own, negative = bits_for(sort)
        sign = "si" if negative else "ui"
        if fits(sort):
            return _word(k, k.op(f"{sign}tofp {vector(k, own)} {x} to {kind}"))
        x = resized(k, x, sort, 64)
        upper = k.op(f"{'ashr' if negative else 'lshr'} {vector(k, 64)} {x}, {splat(64, 32)}")
        upper = k.op(f"fmul {kind} {k.op(f'{sign}tofp {vector(k, 64)} {upper} to {kind}')}, {_all(2.0**32)}")
        lower = k.op(f"and {vector(k, 64)} {x}, {splat(64, 2**32 - 1)}")
        return _word(k, rounded_sum(k, down, upper, k.op(f"uitofp {vector(k, 64)} {lower} to {kind}")))

    return entry


def double_order(how: str) -> Native:
    """A comparison of two bounds, false where one is not a number."""
    return lambda k, t, x, y: bit_of(k, _is(k, how, _double(k, x), _double(k, y)))


DOUBLES: dict[str, Native] = {
    "add_down": double_sum(True, subtracts=False),
    "add_up": double_sum(False, subtracts=False),
    "sub_down": double_sum(True, subtracts=True),
    "sub_up": double_sum(False, subtracts=True),
    "mul_down": double_product(True),
    "mul_up": double_product(False),
    "cast_down": double_cast(True),
    "cast_up": double_cast(False),
    "below": double_order("olt"),
    "up_to": double_order("ole"),
}
