"""What is known of a quantity: its value, how precisely, and where it comes from.

Tags: P printed, D derived, R reconstructed, A assumed; U where nothing fixes the value.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Literal

from safety.audit import text as texts
from safety.audit.exceptions import AuditError
from safety.audit.formula import decimal
from safety.audit.spans import Exact, Span, span

Tag = Literal["P", "D", "R", "A", "U"]


@dataclass(frozen=True, eq=False)
class Known:
    """A value and all values that it may stand for, in the unit of its symbol; an enclosure may be the value.

    `whole`: it counts something, so that only whole values are admissible.  `rests_on`: the assumed inputs of a value
    that was worked out elsewhere.
    """

    value: Span
    range: Span
    tag: Tag
    text: str
    whole: bool = False
    rests_on: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        ends = (self.range.low, self.range.high)
        if self.whole and any(end.denominator != 1 for end in ends):
            raise AuditError(f"{self.text}: a count has a whole number at either end of its range")

    def __str__(self) -> str:
        rests = f", resting on {', '.join(self.rests_on)} [A]" if self.rests_on else ""
        return (f"{self.text} [{self.tag}]" if self.tag != "U" else f"{self.text}, open") + rests

    def assumed(self, name: str) -> tuple[str, ...]:
        """The assumed inputs that it is, under a name, or rests on."""
        return (*((f"{name} = {self.text}",) if self.tag == "A" else ()), *self.rests_on)


def printed(text: str, digits: int | None = None, *, exact: bool = False) -> Known:
    """A printed number: it stands for all that rounds to it, or for itself where it is `exact`: a count, a setting.

    `digits` as in `text`.  Raises AuditError.
    """
    read = texts.text(text, digits)
    return Known(Span(read.value), Span(read.value) if exact else read.span, "P", read.text)


def derived(
    value: str | Exact | Span,
    low: str | Exact | None = None,
    high: str | Exact | None = None,
    *,
    rests_on: Mapping[str, Known] | Sequence[str] = (),
) -> Known:
    """A number that follows from printed ones: exact, or with all values that they leave it.

    `rests_on` names the assumed inputs, by symbol or in words, of a number that code elsewhere has worked out.
    Raises AuditError.
    """
    return replace(_given(value, low, high, "D"), rests_on=_rests(rests_on))


def reconstructed(value: str | Exact) -> Known:
    """A number read out of a damaged text, taken as exact.  Raises AuditError."""
    return _given(value, None, None, "R")


def assumed(value: str | Exact, low: str | Exact, high: str | Exact, *, whole: bool = False) -> Known:
    """A number that no source gives, with its lowest and highest admissible value; `whole` for a count.

    Raises AuditError.
    """
    found = _given(value, low, high, "A")
    if whole and found.value.low.denominator != 1:
        raise AuditError(f"{value} is no count; leave out whole=True, or give a whole number")
    return replace(found, whole=whole)


def unknown(low: str | Exact, high: str | Exact, *, whole: bool = False) -> Known:
    """A number of which only the range is known; `whole` for a count.  Raises AuditError."""
    ends = Span(_exact(low), _exact(high))
    middle = Span(ends.middle // 1) if whole else Span(ends.middle)
    return Known(middle, ends, "U", f"{low} .. {high}", whole)


def _given(value: str | Exact | Span, low: str | Exact | None, high: str | Exact | None, tag: Tag) -> Known:
    if (low is None) != (high is None):
        raise AuditError(f"{value}: give both ends of its range, or none")
    middle = value if isinstance(value, Span) else Span(_exact(value))
    ends = middle if low is None or high is None else Span(_exact(low), _exact(high))
    if not middle.within(ends):
        raise AuditError(f"{value} does not lie in its range, {low} .. {high}")
    shown = value if isinstance(value, str) else _shown(middle)
    return Known(middle, ends, tag, shown + (f" ({low} .. {high})" if low is not None else ""))


def _rests(on: Mapping[str, Known] | Sequence[str]) -> tuple[str, ...]:
    if not isinstance(on, Mapping):
        return (on,) if isinstance(on, str) else tuple(on)
    return tuple(text for name, known in on.items() for text in known.assumed(name))


def _shown(value: Span) -> str:
    return decimal(value.low) if value.exact else f"{float(value.low):.8g} .. {float(value.high):.8g}"


def _exact(value: str | Exact) -> Fraction:
    try:
        return Fraction(value) if isinstance(value, str) else span(value).low
    except (ValueError, ZeroDivisionError):
        raise AuditError(f"{value!r} is no exact number; write '0.311739', '1035/2' or a Fraction") from None
