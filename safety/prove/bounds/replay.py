"""The interval reading of terms, in fractions: what a formula says all over a point that is known to lie in intervals.

Independent of the polynomials with which such points are found.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from safety.system import ModelError
from safety.terms import Bit
from safety.terms.graph import Term, TermError, describe, postorder

Range = tuple[Fraction, Fraction]
Witness = dict[Term, Range]  # each variable's value; a range of no width, save for roots that no fraction is


def shown(witness: Witness) -> dict[str, str]:
    """A witness as text, in order of name: fractions, and `[low, high]` for a root between fractions."""
    found = {str(v.attr): str(low) if low == high else f"[{low}, {high}]" for v, (low, high) in witness.items()}
    return dict(sorted(found.items()))


def read(text: str) -> Range:
    """A value of a witness back from its text; raises `ModelError` for what is none."""
    low, _, high = text.removeprefix("[").removesuffix("]").partition(", ")
    try:
        return Fraction(low), Fraction(high or low)
    except (ValueError, ZeroDivisionError):
        raise ModelError(f"{text!r} is no value of a point: expected a fraction, or [low, high]") from None


def over(terms: list[Term], values: Mapping[Term, Range]) -> list[Range | bool | None]:
    """Of each real the range of its values, of each bit whether it holds; None where that is open.

    `values` gives each variable a range.  Raises `TermError` for a variable without one, and for other operations.
    """
    known: dict[int, Range | bool | None] = {v.uid: r for v, r in values.items()}
    for term in postorder(terms, known):
        known[term.uid] = _value(term, [known[a.uid] for a in term.args])
    return [known[t.uid] for t in terms]


def holds(formula: Bit, values: Mapping[Term, Range]) -> bool:
    """Whether every conjunct holds; an equality is taken to hold where a variable in it is known in a range only.

    (Such a variable is the root of that equality: it lies in the range by a change of sign.)
    """
    loose = {v.uid for v, (low, high) in values.items() if low < high}
    parts, edge = [], [formula]
    while edge:
        term = edge.pop()
        if term.op == "and":
            edge += [a for a in term.args if isinstance(a, Bit)]
        else:
            parts.append(term)
    return all(
        found is True or (found is None and part.op == "eq" and any(t.uid in loose for t in postorder([part])))
        for part, found in zip(parts, over(list(parts), values), strict=True)
    )


def _value(term: Term, args: list[Range | bool | None]) -> Range | bool | None:
    op = term.op
    if op == "const":
        return (term.attr, term.attr) if term.sort.kind == "real" else bool(term.attr)
    if op == "point":
        return args[0]
    if op == "select":
        return _chosen(args)
    ranges = [a for a in args if isinstance(a, tuple)]
    if len(ranges) == len(args) == 2:
        return _of_numbers(term, *ranges)
    bits = [a for a in args if not isinstance(a, tuple)]
    if len(bits) == len(args) and op in ("not", "and", "or", "xor", "eq", "implies"):
        return _of_bits(op, bits)
    raise TermError(f"{describe(term)} ({op}) has no interval reading; state it with reals, + - *, select, comparisons")


def _of_numbers(term: Term, x: Range, y: Range) -> Range | bool | None:
    (a, b), (c, d) = x, y
    if term.op == "add":
        return a + c, b + d
    if term.op == "sub":
        return a - d, b - c
    if term.op == "mul":
        if term.args[0] is term.args[1]:
            return (Fraction(0) if a <= 0 <= b else min(a * a, b * b)), max(a * a, b * b)
        corners = [p * q for p in x for q in y]
        return min(corners), max(corners)
    if term.op == "lt":
        return True if b < c else False if a >= d else None
    if term.op == "le":
        return True if b <= c else False if a > d else None
    if term.op == "eq":
        return True if a == b == c == d else False if b < c or d < a else None
    raise TermError(f"{describe(term)} ({term.op}) has no interval reading; state it with + - * and comparisons")


def _of_bits(op: str, args: list[bool | None]) -> bool | None:
    if op == "not":
        return None if args[0] is None else not args[0]
    x, y = args
    if op in ("xor", "eq"):
        return None if x is None or y is None else (x == y) is (op == "eq")
    if op == "implies":
        x, op = (None if x is None else not x), "or"
    deciding = op == "or"
    if x is deciding or y is deciding:
        return deciding
    return None if x is None or y is None else not deciding


def _chosen(args: list[Range | bool | None]) -> Range | bool | None:
    condition, then, otherwise = args
    if condition is not None:
        return then if condition else otherwise
    if isinstance(then, tuple) and isinstance(otherwise, tuple):
        return min(then[0], otherwise[0]), max(then[1], otherwise[1])
    return then if then == otherwise else None
