"""The verdict on a sentence with numbers in it: `error <= limit`, `4 <= v <= 8`, with every quantity known.

A sentence holds where each of its relations does, at the best values of all inputs; where inputs within their own
precision are needed for it, that is rounding.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from safety.audit.formula import Formula, decimal
from safety.audit.reach import find
from safety.audit.spans import Span
from safety.audit.symbols import Bound
from safety.audit.verdict import ASSUMED, CONFIRMED, INCONSISTENT, NOT_DERIVABLE, ROUNDING, Judged, Verdict

FAR = Fraction(10) ** 60  # beyond all differences
_TARGETS = {
    "=": Span(0),
    "<=": Span(-FAR, 0),
    ">=": Span(0, FAR),
    "<": Span(-FAR, -1 / FAR),
    ">": Span(1 / FAR, FAR),
}
DIGITS = 6


@dataclass(frozen=True)
class Part:
    """One sign of a sentence: the difference of its sides is to lie in the target; the sides are there to be shown."""

    text: str
    target: Span
    difference: Bound
    sides: tuple[Bound, Bound]


def part(left: Bound, sign: str, right: Bound) -> Part:
    """Two sides in one unit with a sign between them."""

    def difference(at: Mapping[str, Span]) -> Span:
        mine, other = ({name: at[name] for name in side.inputs} for side in (left, right))
        return left.function(mine) - right.function(other)

    text = f"{left.text} {sign} {right.text}"
    free = (*left.free, *right.free)
    whole = Bound(text, {**left.inputs, **right.inputs}, free, difference)
    return Part(text, _TARGETS[sign], whole, (left, right))


def judge(parts: Sequence[Part]) -> Judged:
    """The verdict on a sentence of several parts.  Raises AuditError when one cannot be evaluated."""
    free = sorted({name for each in parts for name in each.difference.free})
    if free:
        return Judged(NOT_DERIVABLE, "", f"nothing fixes {', '.join(free)}")
    verdicts = [_verdict(each) for each in parts]
    found = _worst(verdicts)
    recomputed = "; ".join(dict.fromkeys(text for each in parts for text in _sides(each)))
    wrong = [each.text for each, verdict in zip(parts, verdicts, strict=True) if verdict != CONFIRMED]
    note = "" if found == CONFIRMED else f"{'open' if found == NOT_DERIVABLE else 'not so'}: {'; '.join(wrong)}"
    note = f"holds within the precision of the inputs: {'; '.join(wrong)}" if found == ROUNDING else note
    return _under_assumptions(parts, Judged(found, recomputed, note))


def _worst(verdicts: Sequence[Verdict]) -> Verdict:
    order: tuple[Verdict, ...] = (INCONSISTENT, NOT_DERIVABLE, ROUNDING, CONFIRMED)
    return next(verdict for verdict in order if verdict in verdicts)


def _verdict(each: Part) -> Verdict:
    by = each.difference
    open_ = by.ranges("U")
    if open_ and not by.function({**by.start(), **open_}).within(each.target):
        return NOT_DERIVABLE if find(by.function, open_, by.start(), each.target) is not None else INCONSISTENT
    if by.nominal().within(each.target):
        return CONFIRMED
    ranges = by.ranges("PDR")
    return ROUNDING if find(by.function, ranges, by.start(), each.target) is not None else INCONSISTENT


def _under_assumptions(parts: Sequence[Part], found: Judged) -> Judged:
    inputs = {n: known for each in parts for n, known in each.difference.inputs.items() if known.tag == "A"}
    told = tuple(f"{name} = {known.text}" for name, known in inputs.items())
    for name, known in inputs.items():
        for end in (known.range.low, known.range.high):
            fixed = replace(known, value=Span(end), range=Span(end))
            other = _worst([_verdict(_with(each, {name: fixed})) for each in parts])
            if other != found.verdict:
                note = f"{found.verdict} with the reference, {other} with {name} = {decimal(end)}"
                return Judged(ASSUMED, found.recomputed, note, assumed=told)
    return replace(found, assumed=told)


def _with(each: Part, fixed: Mapping[str, object]) -> Part:
    inputs = {name: fixed.get(name, known) for name, known in each.difference.inputs.items()}
    return replace(each, difference=replace(each.difference, inputs=inputs))  # type: ignore[arg-type]


def _sides(each: Part) -> list[str]:
    """The sides that are more than a number, each with its value."""
    return [f"{side.text} = {_short(side.nominal())}" for side in each.sides if side.inputs]


def _short(value: Span) -> str:
    low, high = (f"{float(end):.{DIGITS}g}" for end in (value.low, value.high))
    return low if low == high else f"{low} .. {high}"


def main_side(sides: Sequence[Formula]) -> Formula:
    """The side that says in which unit a sentence is compared: the first that has a symbol."""
    return next((side for side in sides if side.names), sides[0])
