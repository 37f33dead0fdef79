"""Nothing that is open goes unsaid."""

from typing import Any

from safety.report.gaps import LIMITS, gaps, parameters

Results = dict[str, Any]


def labels(results: Results, title: str) -> list[str]:
    (gap,) = [gap for gap in gaps(results) if gap.title == title]
    return [item.label for item in gap.items]


def test_every_open_end_of_the_sample_is_named(sample: Results) -> None:
    assert {gap.title: [item.label for item in gap.items] for gap in gaps(sample)[:-1]} == {
        "Not as asked": ["thr_wrong_release", "accuracy_at_zero", "no_release_after_dual_failure", "key_restarts"],
        "Known defeats": ["isolates_no_healthy_channel"],
        "Faults that are dangerous and not detected": [
            "data matrix: column line stuck",
            "data matrix: cell J0",
            "data matrix: cell J1",
            "word select: missing",
            "overflow gate: output stuck",
        ],
        "Undecided": ["accuracy_at_zero"],
        "Bounded": ["no_release_after_dual_failure"],
        "Vacuous": ["key_restarts"],
        "Sampled": [],
        "Requirements without evidence": ["TS7-1"],
        "User lemmas": ["reverse_stops_train"],
        "One engine only": ["reverse_stops_train"],
        "Assumed inputs [A]": [
            "Z",
            "T_sync",
            "brakes_on_overspeed, isolates_no_healthy_channel",
            "ring_single_stuck",
            "no_brake_on_overspeed",
            "thr_no_brake",
        ],
        "Reconstructed inputs [R]": ["isolates_no_healthy_channel"],
        "Published figures not confirmed": ["ts7-clock", "ts7-mtbf"],
        "Limits of trees and rates": ["no_brake_on_overspeed", "mttf_2oo3", "mttf_unpowered"],
    }


def test_the_limits_of_the_method_are_always_said() -> None:
    assert [item.text for item in gaps({})[-1].items] == list(LIMITS)


def test_an_expected_bound_is_still_a_gap() -> None:
    claim = {"id": "c", "model": "m", "expect": "bounded", "verdict": "bounded", "strength": {"steps": 40}}
    (item,) = next(gap.items for gap in gaps({"claims": [claim]}) if gap.title == "Bounded")
    assert item.text.startswith("40 steps: ")


def test_a_proof_whose_premise_was_never_reached_is_a_gap() -> None:
    claim = {"id": "c", "model": "m", "expect": "proved", "verdict": "proved", "agreed_by": ["cvc5"]}
    assert labels({"claims": [claim | {"vacuity": {"premise_reached_at": None}}]}, "Vacuous") == ["c"]
    assert labels({"claims": [claim | {"vacuity": {"premise_reached_at": 0}}]}, "Vacuous") == []
    assert labels({"claims": [claim | {"vacuity": None}]}, "Vacuous") == []


def test_a_twin_that_fails_is_no_defeat() -> None:
    claim = {"id": "c", "model": "m", "expect": "refuted", "verdict": "refuted"}
    assert labels({"claims": [claim | {"role": "twin"}]}, "Known defeats") == []
    assert labels({"claims": [claim]}, "Known defeats") == ["c"]


def test_dangerous_faults_are_counted_where_no_table_names_them() -> None:
    classes = {"safe": 5, "detected": 0, "dangerous_undetected": 2, "no_effect": 0}
    campaign = {"id": "k", "injections": 7, "exhaustive": False, "classes": classes}
    assert labels({"campaigns": [campaign]}, "Faults that are dangerous and not detected") == ["k"]
    assert labels({"campaigns": [campaign]}, "Sampled") == ["k"]


def test_an_interrupted_run_leads() -> None:
    assert labels({"interrupted": True}, "Not as asked") == ["interrupted"]


def test_parameters_that_only_claims_name_are_collected_once() -> None:
    used = {"name": "T_sync", "value": "1/2", "unit": "s", "low": None, "high": None, "source": "[A] not printed"}
    claim = {"model": "m", "expect": "proved", "verdict": "proved", "parameters": [used]}
    results = {
        "claims": [claim | {"id": "a"}, claim | {"id": "b"}],
        "parameters": [{"id": "Z", "model": "m", "tag": "P"}],
    }
    assert [(entry["id"], entry["tag"]) for entry in parameters(results)] == [("T_sync", "A"), ("Z", "P")]
    assert labels(results, "Assumed inputs [A]") == ["T_sync"]


def test_cut_sets_that_are_not_complete_or_not_replayed_are_gaps() -> None:
    found = [{"faults": ["a"], "status": "confirmed"}, {"faults": ["b", "c"], "status": "candidate"}]
    tree = {"id": "t", "probability": 0.1, "cut_sets": found, "complete_to_order": 2, "complete_at_all_orders": False}
    assert labels({"trees": [tree]}, "Limits of trees and rates") == ["t", "t"]


def test_an_open_verdict_says_why() -> None:
    claim = {"id": "c", "model": "m", "expect": "proved", "verdict": "undecided", "why": "time is up"}
    (item,) = next(gap.items for gap in gaps({"claims": [claim]}) if gap.title == "Undecided")
    assert "time is up" in item.text


def test_an_assumed_input_of_many_parts_is_one_row() -> None:
    same = {"value": 0.5, "unit": "s", "tag": "A", "note": "[A] not printed"}
    used = {"name": "window", "value": "1/2", "unit": "s", "source": "[A] not printed"}
    claim = {"id": "c", "model": "Bench", "expect": "proved", "verdict": "proved", "parameters": [used]}
    results = {
        "claims": [claim],
        "parameters": [
            same | {"id": "a.window", "model": "Ts7"},
            same | {"id": "b.window", "model": "Ts7"},
            same | {"id": "c.window", "model": "Ts7", "value": 0.6},
        ],
    }
    items = next(gap.items for gap in gaps(results) if gap.title == "Assumed inputs [A]")
    assert sorted((item.label, item.text) for item in items) == [
        ("c.window", "0.6 s: [A] not printed (in Ts7.c)"),
        ("window", "1/2 s: [A] not printed (in Bench, Ts7.a, Ts7.b)"),
    ]


def test_an_assumed_rate_of_a_dangerous_fault_is_marked() -> None:
    row = {"part": "p", "mode": "m", "faults": 2, "dangerous_undetected": 1, "rate_per_h": 1e-7}
    classes = {"safe": 1, "detected": 0, "dangerous_undetected": 1, "no_effect": 0}
    for more, marked in (({"tag": "A"}, True), ({"tag": "P"}, False), ({"source": "[A] parts list"}, True)):
        campaign = {"id": "k", "injections": 2, "exhaustive": True, "classes": classes, "fmeda": [row | more]}
        (item,) = next(g.items for g in gaps({"campaigns": [campaign]}) if g.title.startswith("Faults that are"))
        assert ("/h [A]" in item.text) == marked
