"""Histograms show every value there is, at its place and in proportion."""

from __future__ import annotations

from xml.etree import ElementTree as ET

import pytest

from safety.report.histogram_svg import HIGH, LEAST, WIDEST, Bin, bins, histogram_svg

SVG = "{http://www.w3.org/2000/svg}"


def columns(found: list[Bin]) -> list[float]:
    """Heights of the columns, in order."""
    root = ET.fromstring(histogram_svg(found, "frames", "watchdog"))
    return [float(rect.get("height", "")) for rect in root.iter(f"{SVG}rect") if rect.get("class") == "column"]


def test_bins_between_the_first_and_the_last_are_there_without_a_count() -> None:
    assert bins({2: 3, 20: 7}) == [Bin(2, 2, 3), Bin(3, 5, 0), Bin(6, 10, 0), Bin(11, 20, 7)]
    assert bins({0: 1}) == [Bin(0, 0, 1)]
    assert bins({}) == []


@pytest.mark.parametrize("edge", [0, 1, 5, 10**6, 5 * 10**9])
def test_one_bin_is_no_wall(edge: int) -> None:
    found = bins({edge: 4})
    assert [(one.high, one.values) for one in found] == [(edge, 4)]
    root = ET.fromstring(histogram_svg(found, "frames", "w"))
    assert float(root.get("width", "")) < 2 * WIDEST


def test_heights_go_by_count_and_the_rarest_is_seen() -> None:
    assert columns(bins({1: 500_000, 2: 1_000_000, 10: 1})) == [HIGH / 2, HIGH, 0, LEAST]


def test_what_is_drawn_is_said_in_words() -> None:
    root = ET.fromstring(histogram_svg(bins({1: 2, 10: 1}), "frames", "<watch> & dog"))
    assert root.get("aria-label") == "<watch> & dog: 1 frames: 2, 6–10 frames: 1"
    assert "10" in [each.text for each in root.iter(f"{SVG}text")]


def test_nothing_is_no_picture() -> None:
    assert histogram_svg([], "frames", "w") == ""
