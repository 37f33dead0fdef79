"""Campaigns on the page: who detects and how soon, what a baseline says, failure modes with bounds and marks."""

from __future__ import annotations

import re
from typing import Any

from safety.report.html import html
from tests.report.test_html import Page, hostile

Results = dict[str, Any]
LATENCY = {"min": 1, "max": 9, "mean": 3.5, "unit": "frames", "histogram": [[1, 4], [10, 1]]}
GATED: Results = {
    "id": "gated", "model": "M", "injections": 1_000_000, "exhaustive": True, "faults": "all",
    "classes": {"safe": 1, "detected": 5, "dangerous_undetected": 2, "no_effect": 0},
    "detected_by": {
        "watchdog": {"count": 5, "latency": LATENCY},
        "never": {"count": 0, "latency": None},
    },
    "baseline": {"file": "b.json", "new": {"x": "safe"}, "lost": {}, "unclear": {}, "told": ["new: x"],
                 "better": ["3 better"]},
    "target_coverage": {"target": "9/10", "met": False, "told": "coverage 0.7, target 0.9 missed"},
    "reproducers": [{"of": "x y", "injection": "x y, transient at 3 for 1", "faults": 1, "runs": 9}],
    "replay": ["gated::x y", "gated::z"], "replay_of": 2, "surprises": ["coverage 0.7, target 0.9 missed", "new: x"],
    "as_expected": False, "note": "told above", "engine": "native", "seconds": 0.5, "injections_per_second": 2e6,
    "fmeda": [
        {"part": "p", "mode": "m", "faults": 8, "rate_per_h": 1e-7, "tag": "A", "lambda_du": 4e-9,
         "bounds": {"lambda_du": [3e-9, 6e-9]}, "diagnostic_coverage": None},
        {"part": "q", "mode": "m", "faults": 8, "rate_per_h": 2e-7, "tag": "P", "lambda_du": 0.0, "bounds": {}},
    ],
    "by_rate": {"lambda_du": 4e-9, "diagnostic_coverage": {"value": 0.7, "low": 0.6, "high": 0.8}},
}  # fmt: skip


def test_a_target_that_a_sample_leaves_open_is_undecided() -> None:
    aim = {"target": "9/10", "met": None, "told": "nothing known"}
    text = html({"schema": "rightside/1", "campaigns": [GATED | {"target_coverage": aim, "as_expected": True}]})
    assert '<dd>nothing known <span class="v v-undecided">undecided</span></dd>' in text


def test_a_campaign_shows_who_detects_and_what_a_baseline_says() -> None:
    text = html({"schema": "rightside/1", "campaigns": [GATED]})
    Page(text)
    for words in (
        "new: x", "1 new dangerous undetected", "3 better", "coverage 0.7, target 0.9 missed",
        "rightside replay &#39;gated::x y, transient at 3 for 1&#39;", "watchdog: 1 frames: 4",
        "2 dangerous undetected",
    ):  # fmt: skip
        assert words in text, words


def test_figures_of_failure_modes_have_their_bounds_and_marks() -> None:
    text = html({"schema": "rightside/1", "campaigns": [GATED]})
    rows = re.findall(r"<tr.*?</tr>", text[text.index('class="modes"') :], re.DOTALL)
    assert "3 × 10⁻⁹ to 6 × 10⁻⁹" in rows[1] and rows[1].count("[A]") == 2
    assert rows[2].count("[A]") == 0 and "[P]" in rows[2]
    assert "0.6 to 0.8" in rows[3] or "λDU" in rows[0]


def test_times_and_engines_stay_out_of_a_committed_page() -> None:
    document = {"schema": "rightside/1", "campaigns": [GATED]}
    assert "native" not in html(document) and "0.5 s" not in html(document)
    assert "on the native engine" in html(document, timings=True)
    slower = GATED | {"engine": "lanes", "engine_note": "no LLVM", "seconds": 9.0}
    assert html({"schema": "rightside/1", "campaigns": [slower]}) == html(document)


def test_hostile_text_of_a_campaign_stays_text() -> None:
    poisoned = hostile({"schema": "rightside/1", "campaigns": [GATED]})
    Page(html(poisoned))
    assert "<script>" not in html(poisoned)
