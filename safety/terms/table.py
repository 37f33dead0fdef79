"""The table of operations: a row is an operation, a column is a reading.

| column  | a value is                    | an entry is                                                          |
|---------|-------------------------------|----------------------------------------------------------------------|
| direct  | bool, int, Fraction           | function of the term and the argument values                         |
| python  | source text over the same     | function of the term and the argument texts                          |
| lanes   | source text over NumPy arrays | the same; numbers are int64, or objects beyond it                    |
| integer | solver term: Bool, Int, Real  | function of the solver's interface, the term and the solver terms    |
| vector  | solver term: Bool, bit-vector | the same; a real has no such reading (`TermError`)                   |
| native  | LLVM vector, a lane each      | function of the code written, the term and the argument names        |
| bits    | a bit term for each bit       | function of the term and the bits of the arguments                   |

The solver's interface is that of z3, or cvc5 under the same names: one text serves both.  The tests of the terms prove
the columns equal, and show for every entry that a wrong one is found.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NoReturn

from safety.terms.column_bits import (
    Entry,
    bits_add,
    bits_bit,
    bits_cast,
    bits_clip,
    bits_concat,
    bits_const,
    bits_div,
    bits_eq,
    bits_gate,
    bits_implies,
    bits_mod,
    bits_mul,
    bits_not,
    bits_order,
    bits_same,
    bits_select,
    bits_slice,
    bits_sub,
)
from safety.terms.column_native import (
    Native,
    native_arithmetic,
    native_bit,
    native_cast,
    native_clip,
    native_concat,
    native_const,
    native_div,
    native_gate,
    native_implies,
    native_mod,
    native_not,
    native_order,
    native_same,
    native_select,
    native_slice,
)
from safety.terms.column_solvers import (
    Solver,
    either,
    integer_bit,
    integer_bitwise,
    integer_cast,
    integer_clip,
    integer_concat,
    integer_const,
    integer_slice,
    masked,
    named,
    resize,
    vector_arithmetic,
    vector_bit,
    vector_bits,
    vector_cast,
    vector_clip,
    vector_const,
    vector_divide,
    vector_eq,
    vector_order,
    vector_select,
    vector_slice,
)
from safety.terms.column_texts import (
    Text,
    form,
    is_object,
    lane_cast,
    lane_clip,
    lane_concat,
    lane_divide,
    lane_numbers,
    lane_select,
    lane_slice,
    literal,
    python_cast,
    python_clip,
    python_concat,
    python_slice,
)
from safety.terms.gates import and_, or_, xor
from safety.terms.graph import Value

__all__ = ["OPERATIONS", "Operation", "is_object", "literal", "resize", "vector_bits"]


@dataclass(frozen=True)
class Operation:
    """One row."""

    direct: Callable[..., Value]
    python: Text
    lanes: Text
    integer: Solver
    vector: Solver
    native: Native
    bits: Entry


def _leaf(*_: Any) -> NoReturn:
    raise AssertionError("a variable is bound by the reading, not computed")


OPERATIONS: dict[str, Operation] = {
    "const": Operation(
        direct=lambda t: t.attr,
        python=lambda t: literal(t.attr),
        lanes=lambda t: literal(t.attr),
        integer=integer_const,
        vector=vector_const,
        native=native_const,
        bits=bits_const,
    ),
    "var": Operation(direct=_leaf, python=_leaf, lanes=_leaf, integer=_leaf, vector=_leaf, native=_leaf, bits=_leaf),
    "point": Operation(
        direct=lambda t, x: x,
        python=form("{0}"),
        lanes=form("{0}"),
        integer=either(lambda x: x),
        vector=either(lambda x: x),
        native=native_same,
        bits=bits_same,
    ),
    # bits
    "not": Operation(
        direct=lambda t, x: not x,
        python=form("(not {0})"),
        lanes=form("(~{0})"),
        integer=named("Not"),
        vector=named("Not"),
        native=native_not,
        bits=bits_not,
    ),
    "and": Operation(
        direct=lambda t, x, y: x and y,
        python=form("({0} & {1})"),
        lanes=form("({0} & {1})"),
        integer=named("And"),
        vector=named("And"),
        native=native_gate("and"),
        bits=bits_gate(and_),
    ),
    "or": Operation(
        direct=lambda t, x, y: x or y,
        python=form("({0} | {1})"),
        lanes=form("({0} | {1})"),
        integer=named("Or"),
        vector=named("Or"),
        native=native_gate("or"),
        bits=bits_gate(or_),
    ),
    "xor": Operation(
        direct=lambda t, x, y: x != y,
        python=form("({0} ^ {1})"),
        lanes=form("({0} ^ {1})"),
        integer=named("Xor"),
        vector=named("Xor"),
        native=native_gate("xor"),
        bits=bits_gate(xor),
    ),
    "implies": Operation(
        direct=lambda t, x, y: not x or y,
        python=form("(not {0} or {1})"),
        lanes=form("(np.logical_not({0}) | {1})"),
        integer=named("Implies"),
        vector=named("Implies"),
        native=native_implies,
        bits=bits_implies,
    ),
    # numbers
    "add": Operation(
        direct=lambda t, x, y: x + y,
        python=form("({0} + {1})"),
        lanes=lane_numbers("+"),
        integer=either(lambda x, y: x + y),
        vector=vector_arithmetic(lambda x, y: x + y),
        native=native_arithmetic("add"),
        bits=bits_add,
    ),
    "sub": Operation(
        direct=lambda t, x, y: x - y,
        python=form("({0} - {1})"),
        lanes=lane_numbers("-"),
        integer=either(lambda x, y: x - y),
        vector=vector_arithmetic(lambda x, y: x - y),
        native=native_arithmetic("sub"),
        bits=bits_sub,
    ),
    "mul": Operation(
        direct=lambda t, x, y: x * y,
        python=form("({0} * {1})"),
        lanes=lane_numbers("*"),
        integer=either(lambda x, y: x * y),
        vector=vector_arithmetic(lambda x, y: x * y),
        native=native_arithmetic("mul"),
        bits=bits_mul,
    ),
    "eq": Operation(
        direct=lambda t, x, y: x == y,
        python=form("({0} == {1})"),
        lanes=form("({0} == {1})"),
        integer=either(lambda x, y: x == y),
        vector=vector_eq,
        native=native_order("eq", "eq"),
        bits=bits_eq,
    ),
    "lt": Operation(
        direct=lambda t, x, y: x < y,
        python=form("({0} < {1})"),
        lanes=form("({0} < {1})"),
        integer=either(lambda x, y: x < y),
        vector=vector_order("ULT", lambda x, y: x < y),
        native=native_order("ult", "slt"),
        bits=bits_order(equal=False),
    ),
    "le": Operation(
        direct=lambda t, x, y: x <= y,
        python=form("({0} <= {1})"),
        lanes=form("({0} <= {1})"),
        integer=either(lambda x, y: x <= y),
        vector=vector_order("ULE", lambda x, y: x <= y),
        native=native_order("ule", "sle"),
        bits=bits_order(equal=True),
    ),
    "select": Operation(
        direct=lambda t, c, x, y: x if c else y,
        python=form("({1} if {0} else {2})"),
        lanes=lane_select,
        integer=named("If"),
        vector=vector_select,
        native=native_select,
        bits=bits_select,
    ),
    "cast": Operation(
        direct=lambda t, x: Fraction(x) if t.sort.kind == "real" else x,
        python=python_cast,
        lanes=lane_cast,
        integer=integer_cast,
        vector=vector_cast,
        native=native_cast,
        bits=bits_cast,
    ),
    "clip": Operation(
        direct=lambda t, x: min(max(x, t.sort.bounds[0]), t.sort.bounds[1]),
        python=python_clip,
        lanes=lane_clip,
        integer=integer_clip,
        vector=vector_clip,
        native=native_clip,
        bits=bits_clip,
    ),
    # words
    "slice": Operation(
        direct=lambda t, x: (x >> t.attr[0]) % (1 << t.attr[1]),
        python=python_slice,
        lanes=lane_slice,
        integer=integer_slice,
        vector=vector_slice,
        native=native_slice,
        bits=bits_slice,
    ),
    "bit": Operation(
        direct=lambda t, x: (x >> t.attr) % 2 == 1,
        python=form("({0} >> {attr} & 1 == 1)"),
        lanes=form("wires({0} >> {attr} & 1)"),
        integer=integer_bit,
        vector=vector_bit,
        native=native_bit,
        bits=bits_bit,
    ),
    "concat": Operation(
        direct=lambda t, x, y: x << t.args[1].sort.width | y,
        python=python_concat,
        lanes=lane_concat,
        integer=integer_concat,
        vector=named("Concat"),
        native=native_concat,
        bits=bits_concat,
    ),
    "div": Operation(
        direct=lambda t, x: x // t.attr,
        python=form("({0} // {attr})"),
        lanes=lane_divide("//"),
        integer=lambda k, t, x: x / t.attr,
        vector=vector_divide("UDiv"),
        native=native_div,
        bits=bits_div,
    ),
    "mod": Operation(
        direct=lambda t, x: x % t.attr,
        python=form("({0} % {attr})"),
        lanes=lane_divide("%"),
        integer=lambda k, t, x: x % t.attr,
        vector=vector_divide("URem"),
        native=native_mod,
        bits=bits_mod,
    ),
    "band": Operation(
        direct=lambda t, x, y: x & y,
        python=form("({0} & {1})"),
        lanes=form("({0} & {1})"),
        integer=masked("And"),
        vector=either(lambda x, y: x & y),
        native=native_gate("and"),
        bits=bits_gate(and_),
    ),
    "bor": Operation(
        direct=lambda t, x, y: x | y,
        python=form("({0} | {1})"),
        lanes=form("({0} | {1})"),
        integer=masked("Or"),
        vector=either(lambda x, y: x | y),
        native=native_gate("or"),
        bits=bits_gate(or_),
    ),
    "bxor": Operation(
        direct=lambda t, x, y: x ^ y,
        python=form("({0} ^ {1})"),
        lanes=form("({0} ^ {1})"),
        integer=integer_bitwise("Xor"),
        vector=either(lambda x, y: x ^ y),
        native=native_gate("xor"),
        bits=bits_gate(xor),
    ),
}
