"""A solver's formula over integers and wires back as terms."""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable, Mapping
from typing import Any, cast

from safety.terms import Bit, Term, UInt, implies, select
from safety.terms.graph import integer, uint
from safety.terms.values import all_of, any_of, bit, const


class NoTerm(ValueError):
    """The formula says something that terms cannot."""


def conjuncts(k: Any, formula: Any, leaves: Mapping[int, Term]) -> list[Bit]:
    """The conjuncts of a z3 formula whose variable number i stands for `leaves[i]`.

    Raises `NoTerm` for a part that no term says: a quantifier, a function without a meaning, a strange division.
    """
    read = _Reader(k, leaves)
    parts = formula.children() if k.is_and(formula) else [formula]
    return [read(part) for part in parts]


class _Reader:
    def __init__(self, k: Any, leaves: Mapping[int, Term]) -> None:
        self.k, self.known = k, dict[int, Any]()
        self.leaves = leaves
        self.rows: dict[int, Callable[..., Any]] = {
            k.Z3_OP_TRUE: lambda: bit(True),
            k.Z3_OP_FALSE: lambda: bit(False),
            k.Z3_OP_AND: all_of,
            k.Z3_OP_OR: any_of,
            k.Z3_OP_NOT: operator.invert,
            k.Z3_OP_IMPLIES: implies,
            k.Z3_OP_XOR: operator.xor,
            k.Z3_OP_IFF: _same,
            k.Z3_OP_EQ: _same,
            k.Z3_OP_DISTINCT: lambda x, y: ~_same(x, y),
            k.Z3_OP_LE: operator.le,
            k.Z3_OP_LT: operator.lt,
            k.Z3_OP_GE: operator.ge,
            k.Z3_OP_GT: operator.gt,
            k.Z3_OP_ADD: _folded(operator.add),
            k.Z3_OP_SUB: _folded(operator.sub),
            k.Z3_OP_MUL: _folded(operator.mul),
            k.Z3_OP_UMINUS: lambda x: 0 - x,
            k.Z3_OP_IDIV: _divided(operator.floordiv),
            k.Z3_OP_MOD: _divided(operator.mod),
            k.Z3_OP_ITE: select,
        }

    def __call__(self, formula: Any) -> Any:
        name = formula.get_id()
        if name not in self.known:
            self.known[name] = self._read(formula)
        return self.known[name]

    def _read(self, formula: Any) -> Any:
        k = self.k
        if k.is_var(formula):
            return self.leaves[k.get_var_index(formula)]
        if k.is_int_value(formula):
            number = formula.as_long()
            return const(number, integer(number, number) if number < 0 else uint(max(number.bit_length(), 1)))
        row = self.rows.get(formula.decl().kind()) if k.is_app(formula) else None
        found = None if row is None else row(*(self(argument) for argument in formula.children()))
        if found is None:
            raise NoTerm(f"its invariant says {str(formula)[:80]}, which no term does")
        return found


def _same(x: Any, y: Any) -> Bit:
    return ~(x ^ y) if isinstance(x, Bit) else cast(Bit, x == y)


def _folded(operation: Callable[[Any, Any], Any]) -> Callable[..., Any]:
    return lambda *numbers: functools.reduce(operation, numbers)


def _divided(operation: Callable[[UInt, int], UInt]) -> Callable[[Any, Any], UInt | None]:
    """A word by a constant above 0; nothing else has such a term."""

    def row(x: Any, divisor: Any) -> UInt | None:
        usual = isinstance(x, UInt) and divisor.is_const and divisor.attr > 0
        return operation(x, divisor.attr) if usual else None

    return row
