"""Pictures of uncertainty: what they show lies where the numbers say."""

from __future__ import annotations

import itertools
import re
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from safety.report.uncertainty_svg import SHOWN, distribution_svg, tornado_svg

SVG = "{http://www.w3.org/2000/svg}"


def found(*edges: float) -> dict[str, Any]:
    bins = [{"low": a, "high": b, "samples": n} for n, (a, b) in enumerate(itertools.pairwise(edges), 5)]
    quantiles = [{"level": 0.05, "value": edges[0]}, {"level": 0.95, "value": edges[-1]}]
    return {"samples": 11, "mean": edges[1], "histogram": bins, "quantiles": quantiles}


@pytest.mark.parametrize(("edges", "tick"), [((0.1, 0.2, 0.3), "0.15"), ((1e-5, 1e-4, 1e-3), "1 × 10⁻⁴")])
def test_the_axis_is_logarithmic_where_the_bins_are(edges: tuple[float, ...], tick: str) -> None:
    picture = ET.fromstring(distribution_svg(found(*edges), "d", "<top>"))
    assert tick in [each.text for each in picture.iter(f"{SVG}text")]
    words = [each.text for each in picture.iter(f"{SVG}text")]
    assert "11 samples" in words and "5 % to 95 %" in words
    assert picture.get("aria-label", "").startswith("<top>")


BARS = [
    {"name": "rate & <co>", "low": 1.0, "high": 9.0, "top_low": 0.1, "top_high": 0.5},
    {"name": "repair", "low": 1.0, "high": 2.0, "top_low": 0.4, "top_high": 0.2},
]


def test_bars_go_from_the_present_value_to_that_at_either_end() -> None:
    picture = ET.fromstring(tornado_svg(BARS, 0.3, "what matters"))
    rects = [(r.get("class"), float(r.get("x", 0)), float(r.get("width", 0))) for r in picture.iter(f"{SVG}rect")]
    line = next(each for each in picture.iter(f"{SVG}path"))
    present = float(re.match(r"M([\d.]+)", line.get("d", ""))[1])  # type: ignore[index]
    scale = (rects[1][2]) / 0.2
    assert [look for look, *_ in rects] == ["down", "up", "down", "up"]
    for (_, x, wide), end in zip(rects, (0.1, 0.5, 0.4, 0.2), strict=True):
        assert wide == pytest.approx(abs(end - 0.3) * scale, abs=0.2)
        assert (x if end > 0.3 else x + wide) == pytest.approx(present, abs=0.2)
    assert "rate & <co>: 1 gives 0.1 to 9 gives 0.5" in [each.text for each in picture.iter(f"{SVG}title")]


def test_bars_left_out_are_said_and_none_make_no_picture() -> None:
    assert "3 narrower bars are not shown" in tornado_svg(BARS[:1] * (SHOWN + 3), 0.3, "t")
    assert tornado_svg([], 0.3, "t") == ""
    flat = [{"name": "x", "low": 0.0, "high": 1.0, "top_low": 0.3, "top_high": 0.3}]
    assert ET.fromstring(tornado_svg(flat, 0.3, "t")) is not None


def test_equal_data_make_equal_text() -> None:
    assert tornado_svg(BARS, 0.3, "t") == tornado_svg(BARS, 0.3, "t")
