"""The page: offline, escaped, reproducible, well-formed, and honest about what comes first."""

import re
from collections import Counter
from html.parser import HTMLParser
from typing import Any

import pytest

from safety.report.html import SCRIPT, html, slugs
from safety.report.results import ResultsError, canonical, validate

Results = dict[str, Any]
HOSTILE = "</title><script>alert(1)</script>\"'&<img src=x onerror=y>{{ 7*7 }}\x00"
VOID = {"meta", "br", "img", "input", "hr", "link"}


class Page(HTMLParser):
    """All elements, with their nesting checked."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def all(self, attribute: str) -> list[str]:
        return [value for _, attrs in self.elements if (value := attrs.get(attribute)) is not None]


def hostile(value: Any, key: str = "") -> Any:
    """The same document with every free text poisoned."""
    if isinstance(value, dict):
        return {name: hostile(item, name) for name, item in value.items()}
    if isinstance(value, list):
        return [hostile(item, key) for item in value]
    fixed = {
        "schema",
        "verdict",
        "expect",
        "role",
        "kind",
        "tag",
        "tags",
        "tick_s",
        "status",
        "exact",
        "inputs",
        "name",
        "top",
        "probability",
        "rate_per_hour",
        "mission_time_h",
    }
    free = isinstance(value, str) and key not in fixed and value not in ("inf", *"PDAR")
    return value + HOSTILE if free else value


def test_the_page_is_well_formed_and_every_link_leads_somewhere(sample: Results) -> None:
    page = Page(html(sample))
    ids = Counter(page.all("id"))
    assert [name for name, count in ids.items() if count > 1] == []
    assert {target for target in page.all("href")} <= {f"#{name}" for name in ids}
    assert {name for names in page.all("aria-labelledby") for name in names.split()} <= ids.keys()


def test_nothing_is_fetched_and_nothing_runs_but_the_script_of_the_trees(sample: Results) -> None:
    text = html(sample)
    page = Page(text)
    assert not {"link", "img", "iframe", "object", "base", "form"} & {tag for tag, _ in page.elements}
    assert [attributes for tag, attributes in page.elements if tag == "script"] == [{}]
    assert page.all("src") == []
    assert not re.search(r"@import|url\((?!#)|\son\w+=", text)
    assert not re.search(r"https?://(?!www\.w3\.org/2000/svg)", text)
    assert "default-src 'none'" in text


def test_every_text_is_escaped(sample: Results) -> None:
    poisoned = validate(hostile(sample))
    text = html(poisoned)
    page = Page(text)
    assert "img" not in {tag for tag, _ in page.elements}
    assert re.findall(r"<script>(.*?)</script>", text, re.DOTALL) == [SCRIPT]
    assert "alert(1)" in text
    assert "{{ 7*7 }}" in text
    assert "\x00" not in text
    text.encode()


def test_equal_results_give_an_equal_page(sample: Results) -> None:
    turned = {
        name: value[::-1] if isinstance(value, list) and name != "limits" else value for name, value in sample.items()
    }
    turned["runs"] = [{"machine": "another"}]
    turned["tool"] = {"z3": "6", "rightside": "0.1.0"}
    turned["claims"] = [claim | {"seconds": 99.5} for claim in turned["claims"]]
    assert html(turned) == html(sample) == html(canonical(sample))


def test_times_and_machines_are_shown_only_on_demand(sample: Results) -> None:
    plain, timed = html(sample), html(sample, timings=True)
    for volatile in ("build-7", "5.4.0", "61.2", "0.41 s"):
        assert volatile not in plain
        assert volatile in timed


def test_what_is_not_shown_comes_before_what_is(sample: Results) -> None:
    text = html(sample)
    headings = re.findall(r'<h2 id="(\w+)"', text)
    assert headings[:3] == ["gaps", "overview", "claims"]
    assert text.index("4 of 19 results are not as asked") < text.index('<h2 id="gaps"')


def test_every_entry_is_on_the_page(sample: Results) -> None:
    text = html(sample)
    for section in ("claims", "campaigns", "trees", "rates", "figures", "parameters"):
        for entry in sample[section]:
            assert re.search(rf'id="{section}-[^"]*{re.escape(entry["id"])}"', text), entry["id"]


def test_a_twin_stands_below_its_claim(sample: Results) -> None:
    ids = re.findall(r'<tbody id="claims-models.ts7.TwoOutOfThree-(\w+)"', html(sample))
    assert ids.index("brakes_even_with_two") == ids.index("brakes_on_overspeed") + 1


@pytest.mark.parametrize(
    "missing", ["claims", "campaigns", "trees", "rates", "figures", "parameters", "models", "tool"]
)
@pytest.mark.parametrize("timings", [False, True])
def test_any_section_may_be_absent(sample: Results, missing: str, timings: bool) -> None:
    del sample[missing]
    Page(html(sample, timings=timings))


def test_the_smallest_entries_are_enough() -> None:
    classes = {"safe": 0, "detected": 0, "dangerous_undetected": 0, "no_effect": 0}
    trace = {"steps": 0, "violated_at": None, "replayed": True, "signals": []}
    least = {
        "schema": "rightside/1",
        "claims": [{"id": "c", "model": "m", "expect": "proved", "verdict": "refuted", "counterexample": trace}],
        "campaigns": [{"id": "k", "injections": 0, "exhaustive": True, "classes": classes}],
        "trees": [{"id": "t"}],
        "rates": [{"id": "r", "quantity": "q"}],
        "figures": [{"id": "f", "verdict": "assumed"}],
        "parameters": [{"id": "p"}],
        "requirements": [{"id": "q"}],
        "models": [{"id": "m"}],
    }
    Page(html(validate(least)))
    Page(html(validate(least), timings=True))


def test_an_empty_document_says_so() -> None:
    assert "Nothing was selected: this report holds no evidence." in html({"schema": "rightside/1"})


def test_all_as_asked_is_said(sample: Results) -> None:
    good = sample | {"claims": [c for c in sample["claims"] if c["id"] == "rate_is_exact"], "rates": []}
    assert "All 6 results are as asked." in html(good)


def test_two_hundred_claims_stay_below_a_megabyte(sample: Results) -> None:
    claims = [claim | {"id": f"{claim['id']}_{n}"} for claim in sample["claims"] for n in range(20)]
    assert len(html(sample | {"claims": claims}).encode()) < 1_000_000


def test_slugs_are_unique_even_without_case_and_safe_as_file_names() -> None:
    names = slugs([{"id": name} for name in ("a/b", "A b", "a-b", "../x", "", "<script>", ".", "日本", "a-b-2")])
    assert len({name.casefold() for name in names}) == len(names)
    assert all(re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]*", name) for name in names)


@pytest.mark.parametrize("structure", [{"top": "t"}, {"top": "t", "gates": []}, {"top": "t", "gates": [3]}])
def test_a_structure_that_is_none_is_refused(structure: Any) -> None:
    with pytest.raises(ResultsError, match=r"trees \(t\): structure: cannot be drawn"):
        html({"schema": "rightside/1", "trees": [{"id": "t", "structure": structure}]})


TAGGED = '<span class="tag tag-A" title="rests on assumed inputs">[A]</span>'


def part(text: str, name: str) -> str:
    """The section of the page with this heading."""
    return text.partition(f'<section aria-labelledby="{name}">')[2].partition("</section>")[0]


def tree_of(source: str) -> Results:
    events = [
        {"name": "x", "rate_per_hour": "1/1000", "mission_time_h": "1", "source": source},
        {"name": "y", "probability": "1/10", "source": "P"},
    ]
    structure = {
        "format": "rightside/fault-tree/1", "name": "t", "top": "t", "basic_events": events,
        "gates": [{"name": "t", "kind": "or", "inputs": ["x", "y"]}],
    }  # fmt: skip
    sets = [{"events": ["x"], "probability": 0.001}, {"events": ["y"], "probability": 0.1}]
    return {
        "id": "t", "probability": 0.1009, "probability_low": 0.1009, "probability_high": 0.1009,
        "minimal_cut_sets": {"count": 2, "by_order": {"1": 2}, "sets": sets}, "structure": structure,
        "importance": [{"event": "x", "probability": 0.001, "source": source}], "complete_to_order": 2,
        "complete_at_all_orders": True, "faults_listed": 29,
    }  # fmt: skip


def test_figures_of_a_tree_on_assumed_events_are_marked_and_others_are_not() -> None:
    text = html({"schema": "rightside/1", "trees": [tree_of("A")]})
    assert f"0.101 {TAGGED}" in part(text, "overview")
    trees = part(text, "trees")
    assert f"0.001 {TAGGED}</td><td>from the tree" in trees
    assert "0.1</td><td>from the tree" in trees
    assert re.search(rf"<dt>probability</dt>.*{re.escape(TAGGED)}</dd>", trees)
    assert f"on assumed inputs {TAGGED}" in trees
    assert "P = 0.101 [A]" in trees
    assert "[A]" not in html({"schema": "rightside/1", "trees": [tree_of("P")]}).replace("Assumed inputs [A]", "")


def test_complete_at_all_orders_says_over_which_faults() -> None:
    text = part(html({"schema": "rightside/1", "trees": [tree_of("P")]}), "trees")
    assert "complete at all orders over the 29 listed faults" in text


@pytest.mark.parametrize(
    ("more", "marked"), [({"assumed": ["r = 1e-6/h"]}, True), ({"source": "parts list [A]"}, True), ({}, False)]
)
def test_a_rate_on_assumed_inputs_is_marked(more: Results, marked: bool) -> None:
    rate = {"id": "r", "quantity": "q", "value": 5.0, "low": 5.0, "high": 5.0, "target": "at most 6", "met": True}
    text = html({"schema": "rightside/1", "rates": [rate | more]})
    assert (f"5 {TAGGED}" in part(text, "rates")) == marked
    assert (f"1 of 1 {TAGGED}" in part(text, "overview")) == marked
    assert ("assumes r = 1e-6/h" in text) == ("assumed" in more)


def campaign_of(exhaustive: bool) -> Results:
    mode = {"part": "p", "mode": "m", "faults": 3, "rate_per_h": 1e-7, "tag": "A", "dangerous_undetected": 1}
    return {
        "id": "k", "injections": 3, "exhaustive": exhaustive, "expect": {"exhaustive": exhaustive}, "fmeda": [mode],
        "classes": {"safe": 1, "detected": 1, "dangerous_undetected": 1, "no_effect": 0}, "confidence": 0.95,
        "dangerous_undetected_of_all": {"value": 0.125, "low": 0.0625, "high": 0.25},
        "by_rate": {"diagnostic_coverage": {"value": 0.5}, "lambda_du": 1e-8},
    }  # fmt: skip


def test_a_sample_shows_the_share_of_dangerous_undetected_with_its_interval() -> None:
    drawn, whole = (html({"schema": "rightside/1", "campaigns": [campaign_of(all_)]}) for all_ in (False, True))
    assert "dangerous, undetected, of all</dt><dd>0.125, 0.0625 to 0.25 (confidence 0.95)" in drawn
    assert "dangerous, undetected, of all" not in whole


def test_assumed_failure_rates_are_marked() -> None:
    text = html({"schema": "rightside/1", "campaigns": [campaign_of(True)]})
    assert f"1 × 10⁻⁷ {TAGGED}" in part(text, "campaigns")
    assert f"/h {TAGGED}" in part(text, "campaigns")
    assert "1 × 10⁻⁷ /h [A]" in part(text, "gaps")


def test_twin_and_defeat_are_explained() -> None:
    claim = {"id": "c", "model": "m", "expect": "proved", "verdict": "proved", "role": "claim"}
    twins = html({"schema": "rightside/1", "claims": [claim]})
    assert "is a neighbouring sentence that must fail: it shows that the claim can fail at all." in twins
    assert "the equipment falls short" not in twins
    assert "the equipment falls short" in html({"schema": "rightside/1", "claims": [claim | {"role": "defeat"}]})
