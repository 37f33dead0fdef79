"""The verdict on a sentence with numbers in it: `error <= limit`, `4 <= v <= 8`, with every quantity known.

A sentence holds where each of its relations does.  An inequality is confirmed when it holds for all that the printed
inputs may stand for, rounding when for the inputs as they are printed and not for all that round to them, not derivable
when not for those but for some others; an equality is rounding when inputs within their own precision make it true.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from safety.audit.exceptions import AuditError, Undecided
from safety.audit.formula import Formula
from safety.audit.reach import Point, escapes, find, lasts
from safety.audit.spans import Span
from safety.audit.symbols import Bound
from safety.audit.verdict import CONFIRMED, INCONSISTENT, NOT_DERIVABLE, ROUNDING, Judged, Verdict

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
    sign: str
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
    return Part(text, sign, _TARGETS[sign], whole, (left, right))


def judge(parts: Sequence[Part]) -> Judged:
    """The verdict on a sentence of several parts.  Raises AuditError when one cannot be evaluated."""
    free = sorted({name for each in parts for name in each.difference.free})
    if free:
        return Judged(NOT_DERIVABLE, "", f"nothing fixes {', '.join(free)}")
    assumed = tuple(dict.fromkeys(text for each in parts for text in each.difference.assumed))
    recomputed = "; ".join(dict.fromkeys(text for each in parts for text in _sides(each)))
    try:
        for each in parts:
            _comparable(each)
        found = _under_assumptions(parts, _settled(parts))
    except Undecided as error:
        found = Judged(NOT_DERIVABLE, "", f"not decided: {error}")
    except ArithmeticError as error:
        raise AuditError(f"{'; '.join(each.text for each in parts)} cannot be evaluated: {error}") from None
    return replace(found, recomputed=recomputed, assumed=assumed)


def _settled(parts: Sequence[Part]) -> Judged:
    """The verdict with every assumed input at its best value."""
    verdicts = [_verdict(each) for each in parts]
    found = _worst(verdicts)
    wrong = "; ".join(each.text for each, verdict in zip(parts, verdicts, strict=True) if verdict != CONFIRMED)
    return Judged(found, "", f"{_TOLD[found]}: {wrong}" if wrong else "")


def _comparable(each: Part) -> None:
    """Refuse sides that are too far apart, or too close together, to be compared.  Raises AuditError."""
    ends = each.difference.nominal()
    if any(abs(end) > FAR or (each.sign in "<>" and 0 < abs(end) < 1 / FAR) for end in (ends.low, ends.high)):
        raise AuditError(
            f"{each.text}: sides that differ by {_short(ends)} are not compared; divide both, or take roots"
        )


_TOLD = {
    ROUNDING: "holds within the precision of the inputs",
    NOT_DERIVABLE: "holds for some of the values that the inputs may have",
    INCONSISTENT: "not so",
    CONFIRMED: "",
}


def _worst(verdicts: Sequence[Verdict]) -> Verdict:
    order: tuple[Verdict, ...] = (INCONSISTENT, NOT_DERIVABLE, ROUNDING, CONFIRMED)
    return next(verdict for verdict in order if verdict in verdicts)


def _verdict(each: Part) -> Verdict:
    by, target = each.difference, each.target
    start, open_, ranges = by.start(), by.ranges("U"), by.ranges("PDR")
    if open_ and escapes(by.function, open_, start, target, by.whole) is not None:
        some = find(by.function, open_ | ranges, start, target, by.whole) is not None
        return NOT_DERIVABLE if some else INCONSISTENT
    if by.nominal().within(target):
        always = each.sign == "=" or escapes(by.function, ranges | open_, start, target, by.whole) is None
        return CONFIRMED if always else ROUNDING
    if find(by.function, ranges, start, target, by.whole) is None:
        return INCONSISTENT
    return ROUNDING if each.sign == "=" else NOT_DERIVABLE


def _under_assumptions(parts: Sequence[Part], found: Judged) -> Judged:
    """The same verdict whatever the assumed inputs are within their ranges, or that it rests on them."""
    if not any(each.difference.ranges("A") for each in parts):
        return found
    points = [(each, point) for each in parts if (point := _otherwise(each, found.verdict)) is not None]
    if found.verdict == INCONSISTENT and len(points) < sum(_verdict(each) == INCONSISTENT for each in parts):
        return found  # one of the signs is wrong whatever is assumed
    for changed, point in points:
        other = _settled([_at(each, point) for each in parts])
        if other.verdict != found.verdict:
            return found.unless(other, changed.difference.moved(point))
    if points:
        raise Undecided("whether one admissible value changes the verdict of all its signs at once stays open")
    return found


def _otherwise(each: Part, verdict: Verdict | None) -> Point | None:
    """Admissible values of the assumed inputs that may change a verdict; None where there are none."""
    by, target = each.difference, each.target
    start, whole, ranges = by.start(), by.whole, by.ranges("A")
    if verdict == CONFIRMED:
        others = by.ranges("U" if each.sign == "=" else "UPDR")
        point = escapes(by.function, ranges | others, start, target, whole)
    elif verdict == ROUNDING and each.sign == "=":
        point = lasts(by.function, ranges, by.ranges("PDR"), start, target, whole)
    elif verdict == ROUNDING:
        point = escapes(by.function, ranges, start, target, whole)
    elif verdict == NOT_DERIVABLE:
        point = None if by.nominal().within(target) else find(by.function, ranges, start, target, whole)
    else:
        wrong = _verdict(each) == INCONSISTENT
        point = find(by.function, by.ranges("AUPDR"), start, target, whole) if wrong else None
    return None if point is None else {name: value for name, value in point.items() if name in ranges}


def _at(each: Part, point: Point) -> Part:
    mine = {name: value for name, value in point.items() if name in each.difference.inputs}
    return replace(each, difference=each.difference.at(mine))


def _sides(each: Part) -> list[str]:
    """The sides that are more than a number, each with its value."""
    return [f"{side.text} = {_short(side.nominal())}" for side in each.sides if side.inputs]


def _short(value: Span) -> str:
    low, high = (f"{float(end):.{DIGITS}g}" for end in (value.low, value.high))
    return low if low == high else f"{low} .. {high}"


def main_side(sides: Sequence[Formula]) -> Formula:
    """The side that says in which unit a sentence is compared: the first that has a symbol."""
    return next((side for side in sides if side.names), sides[0])
