"""Numbers as an engineer writes them."""

from typing import Any

import pytest

from safety.report.bars_svg import classes_bar, interval_svg
from safety.report.numbers import clean, faults_text, number, tags_of


@pytest.mark.parametrize(
    ("value", "written"),
    [
        (None, "unknown"),
        ("inf", "∞"),
        (float("inf"), "∞"),
        (True, "yes"),
        (0, "0"),
        (-12, "−12"),
        (4096, "4096"),
        (1234567, "1\u202f234\u202f567"),
        (0.0, "0"),
        (2.0, "2"),
        (0.58779, "0.5878"),
        (30000.0, "30\u202f000"),
        (2.77778e-05, "2.778 × 10⁻⁵"),
        (1e-9, "1 × 10⁻⁹"),
        (-4e12, "−4 × 10¹²"),
        (999.96, "1000"),
        ("77/131", "77/131"),
    ],
)
def test_number(value: Any, written: str) -> None:
    assert number(value) == written


def test_tags() -> None:
    assert tags_of("[A] window, [R] read so, [X] no tag") == {"A", "R"}


def test_clean_keeps_all_other_text() -> None:
    assert clean("速度 ⌊x⌋\n\t✓") == "速度 ⌊x⌋\n\t✓"


def test_a_single_fault_in_a_million_is_still_seen() -> None:
    bar = classes_bar({"safe": 10**6, "detected": 0, "dangerous_undetected": 1, "no_effect": 0}, "h")
    assert 'x="636.8" y="0" width="3.2"' in bar
    assert "dangerous, undetected 1" in bar


@pytest.mark.parametrize("values", [(None, None, None), ("inf", None, "inf"), (0.0, 0.0, 1e-9)])
def test_no_line_is_drawn_where_a_logarithm_has_no_meaning(values: tuple[Any, ...]) -> None:
    assert interval_svg(*values) == ""


@pytest.mark.parametrize(
    ("faults", "words"),
    [
        (None, "none"),
        ("any one", "any one"),
        ({"most": 0, "of": []}, "none"),
        ({"most": 1, "of": ["a.trip byzantine", "b.trip byzantine"]}, "at most 1 of 2"),
    ],
)
def test_faults(faults: Any, words: str) -> None:
    assert faults_text(faults) == words
