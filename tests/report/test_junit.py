"""JUnit XML in the shape that continuous-integration servers read."""

from typing import Any
from xml.etree import ElementTree as ET

import pytest

from safety.report.junit import junit

Results = dict[str, Any]
COUNTS = {"tests", "failures", "errors"}


def parsed(results: Results, timings: bool = False) -> ET.Element:
    return ET.fromstring(junit(results, timings))


def test_shape(sample: Results) -> None:
    root = parsed(sample)
    assert (root.tag, set(root.attrib)) == ("testsuites", {"name", *COUNTS})
    assert [suite.get("name") for suite in root] == ["claims", "campaigns", "trees", "rates", "figures"]
    for suite in root:
        assert (suite.tag, set(suite.attrib)) == ("testsuite", {"name", "skipped", *COUNTS})
        for case in suite:
            assert (case.tag, set(case.attrib)) == ("testcase", {"classname", "name"})
            assert {child.tag for child in case} <= {"failure", "error"}


def test_counts_are_those_of_the_cases(sample: Results) -> None:
    root = parsed(sample)
    for part in (root, *root):
        assert int(part.get("tests", "")) == len(part.findall(".//testcase"))
        assert int(part.get("failures", "")) == len(part.findall(".//failure"))
        assert int(part.get("errors", "")) == len(part.findall(".//error"))


def test_what_is_not_as_asked_fails_with_its_reason(sample: Results) -> None:
    failed = {case.get("name"): case[0].get("message") for case in parsed(sample).iter("testcase") if len(case)}
    assert failed == {
        "accuracy_at_zero": "undecided, expected refuted",
        "key_restarts": "vacuous, expected proved",
        "no_release_after_dual_failure": "bounded to 4096 steps, expected proved",
        "thr_wrong_release": "2.1e-09 1/h, target 1e-09 missed",
    }


@pytest.mark.parametrize("blame", [{"error": "kernel"}, {"disagreed_by": ["cvc5"]}])
def test_faults_of_the_tool_are_errors(blame: Results) -> None:
    root = parsed({"claims": [{"id": "c", "model": "m", "expect": "proved", "verdict": "proved", **blame}]})
    assert (root.get("errors"), root.get("failures")) == ("1", "0")


def test_an_unexpected_counterexample_is_told(sample: Results) -> None:
    claim = next(c for c in sample["claims"] if c["id"] == "brakes_even_with_two") | {"expect": "proved"}
    told = parsed({"claims": [claim]}).findtext(".//failure") or ""
    assert "a.output byzantine; b.output byzantine" in told
    assert "violated at tick 302" in told
    assert "rightside replay" in told


def test_a_campaign_fails_once_for_each_surprise() -> None:
    classes = {"safe": 0, "detected": 0, "dangerous_undetected": 2, "no_effect": 0}
    surprises = ["new dangerous undetected: a", "lost detection: b"]
    campaign = {"id": "c", "injections": 2, "exhaustive": True, "classes": classes, "surprises": surprises}
    root = parsed({"campaigns": [campaign | {"as_expected": False, "note": "2 surprises"}]})
    assert [failure.get("message") for failure in root.iter("failure")] == surprises
    assert (root.get("tests"), root.get("failures")) == ("1", "1")
    broken = parsed({"campaigns": [campaign | {"error": "kernel"}]})
    assert [error.get("message") for error in broken.iter("error")] == ["internal error: kernel"]


def test_times_are_given_only_on_demand(sample: Results) -> None:
    assert all(case.get("time") is None for case in parsed(sample).iter("testcase"))
    assert any(case.get("time") == "0.410" for case in parsed(sample, timings=True).iter("testcase"))


def test_hostile_text_stays_text() -> None:
    name = "<a>&\"'\x00\x1b\ud800]]>\ufffe"
    claim = {"id": name, "model": name, "expect": "proved", "verdict": "undecided", "statement": name}
    text = junit({"claims": [claim]})
    text.encode()
    assert next(ET.fromstring(text).iter("testcase")).get("name") == "<a>&\"'\ufffd\ufffd\ufffd]]>\ufffd"


def test_no_results_are_no_suites() -> None:
    assert list(parsed({})) == []
