"""The verdict on a printed number, from its text and the relation that gives it.

In this order: what leaves the value free; what an admissible value of an [A] input would change; then whether the
recomputed value rounds to the text; whether inputs within their own precision give it; whether one slip of the pen
explains it and independent evidence agrees; else the two contradict each other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from safety.audit.exceptions import AuditError, Undecided
from safety.audit.formula import decimal
from safety.audit.reach import Point, escapes, find, lasts
from safety.audit.spans import Span
from safety.audit.symbols import Bound
from safety.audit.text import Text, shown, slips
from safety.audit.verdict import CONFIRMED, INCONSISTENT, MISPRINT, NOT_DERIVABLE, ROUNDING, Judged

DECISIVE = 10  # how many times nearer evidence has to be to what was meant than to what is printed
TRIED = (Fraction(1, 1000), Fraction(1), Fraction(1000))  # values of a symbol of which nothing is known


def judge(printed: Text, by: Bound, also: Mapping[str, Bound]) -> Judged:
    """The verdict on a number.  Raises AuditError when its relation cannot be evaluated."""
    if by.free:
        return _free(printed, by)
    try:
        found = _with_ranges(printed, by, also)
    except Undecided as error:
        found = Judged(NOT_DERIVABLE, shown(_nominal(by), printed), f"not decided: {error}")
    free = found.verdict == NOT_DERIVABLE and by.ranges("U")
    return replace(found, assumed=by.assumed, value=None if free else _nominal(by))


def _with_ranges(printed: Text, by: Bound, also: Mapping[str, Bound]) -> Judged:
    open_ = by.ranges("U")
    if open_ and escapes(by.function, open_, by.start(), printed.span, by.whole) is not None:
        point = find(by.function, by.ranges("UPDRA"), by.start(), printed.span, by.whole)
        reach = shown(_everywhere(by, open_), printed)
        note = f"{', '.join(open_)} may be anything from {', '.join(by.inputs[n].text for n in open_)}: {reach}"
        return Judged(INCONSISTENT if point is None else NOT_DERIVABLE, reach, note)
    found = _settled(printed, by, also)
    ranged = any(not each.exact for each in by.ranges("A").values())
    return _under_assumptions(printed, by, also, found) if ranged else found


def _free(printed: Text, by: Bound) -> Judged:
    """With nothing known of some symbols: what other values of the first would give, the others being 1."""
    first, found = by.free[0], {}
    for value in TRIED:
        try:
            found[value] = by.function({**by.start(), **dict.fromkeys(by.free, Span(1)), first: Span(value)})
        except ArithmeticError:
            continue
    if len({(each.low, each.high) for each in found.values()}) < 2:
        raise AuditError(f"{first} has no value, but does not seem to matter in {by.text}; leave it out")
    told = (f"{first} = {decimal(value)} gives {shown(each, printed)}" for value, each in found.items())
    return Judged(NOT_DERIVABLE, "", f"nothing fixes {', '.join(by.free)}: {'; '.join(told)}", assumed=by.assumed)


def _nominal(by: Bound) -> Span:
    try:
        return by.nominal()
    except ArithmeticError as error:
        raise AuditError(f"{by.text} cannot be evaluated: {error}") from None


def _everywhere(by: Bound, ranges: Mapping[str, Span]) -> Span:
    try:
        return by.function({**by.start(), **ranges})
    except ArithmeticError as error:
        raise AuditError(f"{by.text} cannot be evaluated over the range of {', '.join(ranges)}: {error}") from None


def _settled(printed: Text, by: Bound, also: Mapping[str, Bound]) -> Judged:
    """The verdict with every input at its best value or within its precision."""
    value = _nominal(by)
    recomputed = shown(value, printed)
    if value.within(printed.span):
        tie = value.exact and value.low in (printed.span.low, printed.span.high)
        return Judged(CONFIRMED, recomputed, "a tie: it rounds either way" if tie else "")
    if value.meets(printed.span):
        return Judged(NOT_DERIVABLE, recomputed, "the relation leaves more room than the printed digits")
    point = find(by.function, by.ranges("PDR"), by.start(), printed.span, by.whole)
    if point is not None:
        return Judged(ROUNDING, recomputed, f"as printed for {by.moved(point)}")
    return _mended(printed, value, recomputed, also)


def _mended(printed: Text, value: Span, recomputed: str, also: Mapping[str, Bound]) -> Judged:
    """A misprint where one slip explains the text and evidence agrees; else a contradiction."""
    possible = [(text, slip) for text, slip in slips(printed) if value.within(text.span)]
    if not possible:
        return Judged(INCONSISTENT, recomputed, "no single slip of the pen explains it")
    evidence = {name: (bound.text, bound.everywhere()) for name, bound in also.items()}
    found = []
    for text, slip in possible:
        agreeing = [
            (abs(each.middle - text.value), f"{name}: {relation} = {shown(each, text)}")
            for name, (relation, each) in evidence.items()
            if _speaks_for(each, text, printed)
        ]
        if agreeing:
            found.append((min(agreeing)[0], text, slip, tuple(told for _, told in agreeing)))
    if not found:
        reason = "no independent relation speaks for that" if also else "no independent relation is known"
        return Judged(INCONSISTENT, recomputed, f"{possible[0][1]} would give {possible[0][0].text}, but {reason}")
    _, text, slip, told = min(found, key=lambda each: each[0])
    return Judged(MISPRINT, recomputed, "", text.text, slip, told)


def _speaks_for(evidence: Span, text: Text, printed: Text) -> bool:
    """Whether evidence excludes what is printed and is DECISIVE times nearer to another text."""
    off = evidence.distance(printed.span)
    return off > 0 and evidence.distance(text.span) * DECISIVE <= off


def _under_assumptions(printed: Text, by: Bound, also: Mapping[str, Bound], found: Judged) -> Judged:
    """The same verdict whatever the assumed inputs are within their ranges, or that it rests on them."""
    point = _otherwise(printed, by, also, found)
    if point is None:
        return found
    values = {name: value for name, value in point.items() if by.inputs[name].tag == "A"}
    other = _with_ranges(printed, by.at(values), also)
    return found.unless(other, f"{by.moved(values)}: {other.mended or other.recomputed}")


def _otherwise(printed: Text, by: Bound, also: Mapping[str, Bound], found: Judged) -> Point | None:
    """Admissible values of the assumed inputs that change the verdict; None where there are none."""
    ranges, start, whole = by.ranges("A"), by.start(), by.whole
    if found.verdict == CONFIRMED:
        return escapes(by.function, by.ranges("AU"), start, printed.span, whole)
    if found.verdict == NOT_DERIVABLE:
        return find(by.function, ranges, start, printed.span, whole)
    if found.verdict == ROUNDING:
        confirmed = find(by.function, ranges, start, printed.span, whole)
        return confirmed or lasts(by.function, ranges, by.ranges("PDR"), start, printed.span, whole)
    agrees = find(by.function, by.ranges("APDR"), start, printed.span, whole)
    if agrees is not None:
        return agrees
    if found.verdict == MISPRINT:
        meant = next(text for text, _ in slips(printed) if text.text == found.mended)
        return escapes(by.function, ranges, start, meant.span, whole)
    evidence = [bound.everywhere() for bound in also.values()]
    supported = (text for text, _ in slips(printed) if any(_speaks_for(each, text, printed) for each in evidence))
    return next(filter(None, (find(by.function, ranges, start, text.span, whole) for text in supported)), None)
