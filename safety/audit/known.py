"""What is known of a quantity: its value, how precisely, and where it comes from.

Tags: P printed, D derived, R reconstructed, A assumed; U where nothing fixes the value.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from safety.audit import text as texts
from safety.audit.exceptions import AuditError
from safety.audit.formula import decimal
from safety.audit.spans import Exact, Span, span

Tag = Literal["P", "D", "R", "A", "U"]


@dataclass(frozen=True, eq=False)
class Known:
    """A value and all values that it may stand for, in the unit of its symbol; an enclosure may be the value."""

    value: Span
    range: Span
    tag: Tag
    text: str

    def __str__(self) -> str:
        return f"{self.text} [{self.tag}]" if self.tag != "U" else f"{self.text}, open"


def printed(text: str, digits: int | None = None, *, exact: bool = False) -> Known:
    """A printed number: it stands for all that rounds to it, or for itself where it is `exact`: a count, a setting.

    `digits` as in `text`.  Raises AuditError.
    """
    read = texts.text(text, digits)
    return Known(Span(read.value), Span(read.value) if exact else read.span, "P", read.text)


def derived(value: str | Exact | Span, low: str | Exact | None = None, high: str | Exact | None = None) -> Known:
    """A number that follows from printed ones: exact, or with all values that they leave it.  Raises AuditError."""
    return _given(value, low, high, "D")


def reconstructed(value: str | Exact) -> Known:
    """A number read out of a damaged text, taken as exact.  Raises AuditError."""
    return _given(value, None, None, "R")


def assumed(value: str | Exact, low: str | Exact, high: str | Exact) -> Known:
    """A number that no source gives, with its lowest and highest admissible value.  Raises AuditError."""
    return _given(value, low, high, "A")


def unknown(low: str | Exact, high: str | Exact) -> Known:
    """A number of which only the range is known.  Raises AuditError."""
    ends = Span(_exact(low), _exact(high))
    return Known(Span(ends.middle), ends, "U", f"{low} .. {high}")


def _given(value: str | Exact | Span, low: str | Exact | None, high: str | Exact | None, tag: Tag) -> Known:
    if (low is None) != (high is None):
        raise AuditError(f"{value}: give both ends of its range, or none")
    middle = value if isinstance(value, Span) else Span(_exact(value))
    ends = middle if low is None or high is None else Span(_exact(low), _exact(high))
    if not middle.within(ends):
        raise AuditError(f"{value} does not lie in its range, {low} .. {high}")
    shown = value if isinstance(value, str) else _shown(middle)
    return Known(middle, ends, tag, shown + (f" ({low} .. {high})" if low is not None else ""))


def _shown(value: Span) -> str:
    return decimal(value.low) if value.exact else f"{float(value.low):.8g} .. {float(value.high):.8g}"


def _exact(value: str | Exact) -> Fraction:
    try:
        return Fraction(value) if isinstance(value, str) else span(value).low
    except (ValueError, ZeroDivisionError):
        raise AuditError(f"{value!r} is no exact number; write '0.311739', '1035/2' or a Fraction") from None
