"""Pictures of uncertainty: what they show lies where the numbers say."""

from __future__ import annotations

import itertools
import re
from fractions import Fraction
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from safety.report.gaps import gaps
from safety.report.html import html
from safety.report.numbers import number
from safety.report.results import ResultsError
from safety.report.uncertainty_svg import SHOWN, distribution_svg, tornado_svg
from safety.trees.expressions.distributions import Lognormal
from safety.trees.expressions.expression import Parameter
from safety.trees.solve import solve
from safety.trees.tree import BasicEvent, FaultTree, Gate
from safety.trees.uncertainty import propagation as uncertainty
from safety.trees.uncertainty import sensitivity
from safety.trees.uncertainty.sampling import Plan

SVG = "{http://www.w3.org/2000/svg}"


def found(*edges: float) -> dict[str, Any]:
    bins = [{"low": a, "high": b, "samples": n} for n, (a, b) in enumerate(itertools.pairwise(edges), 5)]
    quantiles = [{"level": 0.05, "value": edges[0]}, {"level": 0.95, "value": edges[-1]}]
    uncertainty = {"samples": 11, "mean": edges[1], "histogram": bins, "quantiles": quantiles}
    return {"id": "<top>", "uncertainty": uncertainty}


def moved(*bars: dict[str, Any]) -> dict[str, Any]:
    return {"id": "t", "probability": 0.3, "sensitivity": {"tornado": list(bars), "derivatives": []}}


@pytest.mark.parametrize(("edges", "tick"), [((0.1, 0.2, 0.3), "0.15"), ((1e-5, 1e-4, 1e-3), "1 × 10⁻⁴")])
def test_the_axis_is_logarithmic_where_the_bins_are(edges: tuple[float, ...], tick: str) -> None:
    picture = ET.fromstring(distribution_svg(found(*edges), "d"))
    assert tick in [each.text for each in picture.iter(f"{SVG}text")]
    words = [each.text for each in picture.iter(f"{SVG}text")]
    assert "11 samples" in words and "5 % to 95 %" in words
    assert picture.get("aria-label", "").startswith("Uncertainty of <top>.")


BARS = [
    {"name": "rate & <co>", "low": 1.0, "high": 9.0, "top_low": 0.1, "top_high": 0.5},
    {"name": "repair", "low": 1.0, "high": 2.0, "top_low": 0.4, "top_high": 0.2},
]


def test_bars_go_from_the_present_value_to_that_at_either_end() -> None:
    picture = ET.fromstring(tornado_svg(moved(*BARS)))
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
    assert "3 narrower bars are not shown" in tornado_svg(moved(*BARS[:1] * (SHOWN + 3)))
    assert tornado_svg(moved()) == ""
    flat = {"name": "x", "low": 0.0, "high": 1.0, "top_low": 0.3, "top_high": 0.3}
    assert ET.fromstring(tornado_svg(moved(flat))) is not None


def test_equal_data_make_equal_text() -> None:
    assert tornado_svg(moved(*BARS)) == tornado_svg(moved(*BARS))


def solved(source: str = "") -> dict[str, Any]:
    """The entry of a tree of which one figure carries the source tag."""
    p = Parameter("p & <q>", Lognormal("1e-3", 3, "0.95"))
    events = (BasicEvent("a", expression=p), BasicEvent("b", Fraction("0.1"), source=source))
    tree = FaultTree("t", "top", (Gate("top", "or", ("a", "b")),), events)
    solution = solve(tree)
    return {
        "id": "t",
        "probability": solution.probability,
        "importance": [{"event": event.name, "source": event.source} for event in events],
        "uncertainty": uncertainty.fields(uncertainty.propagate(solution, Plan(1000))),
        "sensitivity": sensitivity.fields(solution),
    }


def test_the_page_shows_the_uncertainty_and_what_rests_on_assumed_inputs() -> None:
    plain, assumed = (html({"schema": "rightside/1", "trees": [solved(source)]}) for source in ("P", "A"))
    for page in (plain, assumed):
        assert "1000 samples" in page.replace("1 000", "1000") and "p &amp; &lt;q&gt;" in page
        assert 'class="plot"' in page and 'class="tornado"' in page and "With confidence" in page
    mean = solved()["uncertainty"]["mean"]
    assert f"<dd>{number(mean)}, standard error" in plain
    assert re.search(rf"<dd>{number(mean)} <span[^>]*>\[A\]</span>, standard error", assumed)
    assert f">mean {number(mean)} [A]<" in assumed and f">mean {number(mean)}<" in plain
    assert "What moves t [A]." in assumed and "What moves t." in plain
    assert "<h4>" not in html({"schema": "rightside/1", "trees": [{"id": "t"}]})


def test_samples_are_a_gap_since_they_are_not_all() -> None:
    found = {gap.title: [item.label for item in gap.items] for gap in gaps({"trees": [solved(), {"id": "exact"}]})}
    assert found["Sampled"] == ["t"]


def test_samples_out_of_range_are_said_on_the_page() -> None:
    entry = solved()
    entry["uncertainty"]["set_to_range"] = {"pump": 12}
    assert "12 samples of pump, set to the nearer end of the range" in html({"schema": "rightside/1", "trees": [entry]})


def test_fields_that_are_none_are_refused() -> None:
    entry = solved()
    entry["uncertainty"]["histogram"] = [{"low": "x"}]
    with pytest.raises(ResultsError, match=r"trees \(t\)"):
        html({"schema": "rightside/1", "trees": [entry]})
