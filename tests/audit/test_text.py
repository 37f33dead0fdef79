"""Printed numbers: what rounds to them, and which slips of the pen lead to them."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety.audit import AuditError, Span
from safety.audit.text import DOUBLED, EXCHANGED, LOST, POINT, REPLACED, shown, slips, text


@pytest.mark.parametrize(
    ("printed", "digits", "low", "high"),
    [
        ("0.56422", None, "0.564215", "0.564225"),
        ("132,791", None, "132790.5", "132791.5"),
        ("1,234,567.8", None, "1234567.75", "1234567.85"),
        ("7\u202f313", None, "7312.5", "7313.5"),
        ("0.50", None, "0.495", "0.505"),
        ("30 000", 1, "25000", "35000"),
        ("30 000", 5, "29999.5", "30000.5"),
        ("−0.15", None, "-0.155", "-0.145"),
        ("+2", None, "1.5", "2.5"),
        ("0.00120", 2, "0.00115", "0.00125"),
    ],
)
def test_a_text_stands_for_what_rounds_to_it(printed: str, digits: int | None, low: str, high: str) -> None:
    span = text(printed, digits).span
    assert (span.low, span.high) == (Fraction(low), Fraction(high))


@pytest.mark.parametrize(
    ("printed", "digits"),
    [
        ("about 3", None), ("", None), ("1.2.3", None), ("12", 3), ("12", 0), ("0.00", 1), ("000", 1), ("0", 1),
        ("1,5", None), ("0,235", None), ("12,", None), ("1,,2", None), ("1 2", None), ("1234,567", None),
        ("1,234 567", None), ("12,3456", None), ("132.791,5", None), ("\u0661.5", None), ("1" * 60, None),
    ],
)  # fmt: skip
def test_what_is_no_printed_number_is_refused(printed: str, digits: int | None) -> None:
    with pytest.raises(AuditError, match=r"no printed number|does not fit"):
        text(printed, digits)


@pytest.mark.parametrize(
    ("printed", "meant", "kind"),
    [
        ("0.56422", "0.51422", REPLACED), ("1659.87", "1659.89", REPLACED), ("0.4723", "0.4732", EXCHANGED),
        ("132,791", "13279.1", POINT), ("7313", "731.3", POINT), ("0.25", "2.5", POINT), ("25", "0.025", POINT),
        ("0.4832", "0.48322", LOST), ("12", "112", LOST), ("16600.04", "1660.04", DOUBLED),
        ("-0.51", "-0.15", EXCHANGED),
    ],
)  # fmt: skip
def test_a_slip_is_found(printed: str, meant: str, kind: str) -> None:
    assert (text(meant).value, kind) in [(found.value, slip) for found, slip in slips(text(printed))]


@given(st.decimals(0, 1000, places=3), st.data())
def test_a_slip_is_never_what_is_printed(number: object, data: st.DataObject) -> None:
    printed = text(str(number))
    assert all(found.text.replace(".", "") != "" and found.text != printed.text for found, _ in slips(printed))


@pytest.mark.parametrize(
    ("value", "printed", "expected"),
    [
        (Span(Fraction("0.21473")), "0.235", "0.2147"), (Span(Fraction("0.51422")), "0.56422", "0.51422"),
        (Span(3, 5), "4", "3 .. 5"), (Span(1234), "1000", "1234"), (Span(Fraction("-0.1525")), "-0.15", "-0.152"),
    ],
)  # fmt: skip
def test_a_value_is_shown_with_one_digit_more(value: Span, printed: str, expected: str) -> None:
    assert shown(value, text(printed)) == expected
