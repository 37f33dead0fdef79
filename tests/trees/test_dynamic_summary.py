"""The entry of a dynamic tree in a results document: plain values, enclosing bounds, words for people."""

import json

import pytest

from safety.trees import TreeError
from safety.trees.dynamic import summary as dynamic_summary_module
from safety.trees.dynamic.solve import solve_dynamic
from safety.trees.dynamic.summary import dynamic_lines, dynamic_summary
from safety.trees.formats.galileo import read_galileo

PLANT = """toplevel T; T or P C; P csp A B;
A lambda=1e-3; B lambda=1e-3; C lambda=1e-5;"""


def entry(text=PLANT, time=100, **more):
    return dynamic_summary(read_galileo(text.encode(), "plant.dft"), time, source="plant.dft", **more)


def test_everything_of_a_tree_in_parts():
    found = entry(read_s=0.5)
    json.dumps(found, allow_nan=False)
    assert (found["id"], found["gates"], found["basic_events"], found["exact"]) == ("T", 2, 3, None)
    assert found["probability_low"] < found["probability"] < found["probability_high"]
    assert found["probability"] == pytest.approx(1 - 0.9953211598395555 * 0.9990004998333750, rel=1e-12)
    assert found["minimal_cut_sets"]["by_order"] == {"1": 2}
    assert [row["event"] for row in found["importance"]] == ["P", "C"]
    dynamic = found["dynamic"]
    assert dynamic["elements"] == ["P"] and dynamic["ever"]["exact"] == "1"
    assert [(part["gate"], part["states"], part["mean_time_h"]["exact"]) for part in dynamic["parts"]] == [
        ("P", 3, "2000")
    ]
    sequences = dynamic["parts"][0]["cut_sequences"]
    assert sequences["sets"] == [{"events": ["A", "B"], "any_order": False, "orders": [["A", "B"]]}]
    assert dynamic_lines(found)[-1] == "  A, then B"
    assert dynamic["curve"]["probability"][0] == 0 and dynamic["curve"]["probability"][-1] == found["probability"]
    assert dynamic["curve"]["hours"][-1] == 100
    assert read_galileo(dynamic["galileo"].encode(), "").gates[0].name == "T"
    assert found["seconds"]["total"] >= 0.5


def test_without_a_mission_time_and_without_end():
    found = entry("toplevel T; T pand A B; A lambda=1; B lambda=1;", None)
    json.dumps(found, allow_nan=False)
    assert found["probability"] is None and found["minimal_cut_sets"] is None and found["importance"] == []
    assert found["dynamic"]["mean_time_h"]["value"] == "inf"
    assert "infinite, as the top may never fail" in "\n".join(dynamic_lines(found))
    assert "ever fails with probability 0.5" in dynamic_lines(found)


def test_a_mean_time_that_takes_too_many_states_is_said(monkeypatch):
    units = "".join(f"U{i} lambda={i + 1}e-3;" for i in range(9))
    text = f"toplevel T; T and P {' '.join(f'U{i}' for i in range(9))}; P csp A B; A lambda=1; B lambda=1;" + units
    monkeypatch.setattr(dynamic_summary_module, "MEAN_BUDGET", 50)
    found = entry(text)
    mean = found["dynamic"]["mean_time_h"]
    exact = solve_dynamic(read_galileo(text.encode(), "")).mean_time()
    assert mean["value"] is None and mean["low"] < exact.low == exact.high < mean["high"] < 1.01 * mean["low"]
    assert 'h (dynamic tree "T" has more than 50 states' in "\n".join(dynamic_lines(found))


def test_what_is_refused():
    with pytest.raises(TreeError, match="mission_time_h is -1"):
        entry(time=-1)
    tie = "toplevel T; T pand B C; F fdep A B C; A lambda=1; B lambda=1; C lambda=1;"
    with pytest.raises(TreeError, match=r"^plant.dft: .* simultaneously"):
        entry(tie)
    assert entry(tie, ties="as written")["dynamic"]["ties"] == "as written"
