"""Cut sets within limits on the command line, of trees with and without a diagram."""

import json
from pathlib import Path

import pytest

from safety.commands import main, tree_files
from safety.trees.cut_sets import truncated
from safety.trees.module_diagrams import TooLarge

TWO_OF_FOUR = {
    "format": "rightside/fault-tree/1", "name": "T", "top": "T",
    "gates": [{"name": "V", "kind": "vote", "k": 2, "inputs": ["a", "b", "c", "d"]},
              {"name": "W", "kind": "and", "inputs": ["x", "y", "z"]},
              {"name": "T", "kind": "or", "inputs": ["V", "W"]}],
    "basic_events": [{"name": name, "probability": "1/10"} for name in "abcdxyz"],
}  # fmt: skip
PROBABILITY = 1 - (1 - 0.0523) * (1 - 0.001)  # two or more of four: 1 - 0.9^4 - 4 * 0.1 * 0.9^3


def written(tmp_path: Path, **changes: object) -> str:
    path = tmp_path / "t.json"
    path.write_text(json.dumps(TWO_OF_FOUR | changes), encoding="utf-8")
    return str(path)


def entry(out: str) -> dict:
    return json.loads(out)["trees"][0]


@pytest.fixture
def no_diagram(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_: object) -> None:
        raise TooLarge("no diagram fits")

    monkeypatch.setattr(tree_files, "solve", refuse)


def test_limits_leave_out_cut_sets_and_say_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for options, limits, count in (
        (["--order", "2"], {"order": 2, "probability": None}, 6),
        (["--above", "0.005"], {"order": None, "probability": 0.005}, 6),
        (["--order", "1"], {"order": 1, "probability": None}, 0),
        (["--order", "2", "--above", "0.02"], {"order": 2, "probability": 0.02}, 0),
        (["--order", "3", "--likeliest"], None, 7),
        (["--above", "0.001"], None, 7),
    ):
        assert main(["tree", written(tmp_path), *options, "--json", "-"]) == 0
        found = entry(capsys.readouterr().out)
        sets = found["minimal_cut_sets"]
        assert (sets.get("limits"), sets["count"], len(sets["sets"])) == (limits, count, count)
        assert found["probability"] == pytest.approx(PROBABILITY, rel=1e-12)
    assert main(["tree", written(tmp_path), "--order", "2"]) == 0
    assert "; 6 minimal cut sets up to order 2: 6 of order 2" in capsys.readouterr().out


@pytest.mark.usefixtures("no_diagram")
def test_a_tree_without_a_diagram_has_cut_sets_and_bounds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for options, limits, count in (
        ([], None, 7),
        (["--order", "2"], {"order": 2, "probability": None}, 6),
        (["--above", "0.02"], {"order": None, "probability": 0.02}, 0),
    ):
        assert main(["tree", written(tmp_path), *options, "--json", "-"]) == 4
        found = entry(capsys.readouterr().out)
        sets = found["minimal_cut_sets"]
        assert (sets.get("limits"), sets["count"]) == (limits, count)
        assert found["probability_low"] <= PROBABILITY <= found["probability_high"]
        assert ("beyond the limits are not known" in found["note"]) == (limits is not None)


@pytest.mark.usefixtures("no_diagram")
def test_where_what_was_asked_for_does_not_fit_a_lower_order_is_given(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise TooLarge("order 3 needs more")

    monkeypatch.setattr(truncated, "truncated", refuse)
    assert main(["tree", written(tmp_path), "--order", "3", "--json", "-"]) == 4
    said = capsys.readouterr()
    assert "order 3 needs more; those up to a lower order are given" in said.err
    assert entry(said.out)["minimal_cut_sets"]["count"] == 7


@pytest.mark.usefixtures("no_diagram")
def test_without_probabilities_the_cut_sets_are_still_there(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    events = [{"name": name} for name in "abcdxyz"]
    assert main(["tree", written(tmp_path, basic_events=events), "--json", "-"]) == 4
    found = entry(capsys.readouterr().out)
    assert found["probability_low"] is None and found["minimal_cut_sets"]["by_order"] == {"2": 6, "3": 1}
    assert main(["tree", written(tmp_path, basic_events=events), "--above", "0.1"]) == 2
    assert "has no probability" in capsys.readouterr().err


@pytest.mark.usefixtures("no_diagram")
def test_a_tree_that_is_not_coherent_has_bounds_and_its_limits_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    gates = [{"name": "T", "kind": "xor", "inputs": ["a", "b", "c"]}]
    events = TWO_OF_FOUR["basic_events"][:3]
    path = written(tmp_path, gates=gates, basic_events=events)
    assert main(["tree", path, "--json", "-"]) == 4
    assert entry(capsys.readouterr().out)["minimal_cut_sets"] is None
    assert main(["tree", path, "--order", "2"]) == 2
    assert "not coherent" in capsys.readouterr().err


@pytest.mark.parametrize("options", [["--order", "-1"], ["--order", "x"], ["--above", "0"], ["--above", "nan"]])
def test_limits_that_make_no_sense_are_refused(tmp_path: Path, options: list[str]) -> None:
    assert main(["tree", written(tmp_path), f"{options[0]}={options[1]}"]) == 2
