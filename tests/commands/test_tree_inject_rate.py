import json
import math
import re
from pathlib import Path
from types import SimpleNamespace

import pytest

from safety.commands import main
from tests.commands.conftest import Run, document, put

TREE = {
    "format": "rightside/fault-tree/1", "name": "T", "top": "T",
    "gates": [{"name": "T", "kind": "and", "inputs": ["A", "B"]}],
    "basic_events": [{"name": "A", "probability": "1/10", "source": "P"}, {"name": "B", "rate_per_hour": "1e-3"}],
}  # fmt: skip


def test_the_tree_of_a_hazard(run: Run, whole: Path) -> None:
    called = run("tree", "--json", "out.json", "--svg", "tree.svg")
    assert called.code == 0, called.err
    assert "1 minimal cut set: 1 of order 1" in called.out
    assert "complete at all orders over the 2 listed faults; 1 confirmed by a run, 0 candidates" in called.out
    assert "Q = 1 - exp(-rate x hours)" in called.out
    assert re.search(r"\nprobability 9\S+ × 10⁻⁴ \[A\], enclosed", called.out)
    assert re.search(r"#0 +alarm.out stuck-at-0 +9\S+ × 10⁻⁴ \[A\]", called.out)
    assert re.search(r"\nalarm.out stuck-at-0 +1 \[A\] +1 \[A\] +\[A\]", called.out)
    assert re.search(r"SOLVED.*probability 9\S+ × 10⁻⁴ \[A\]", called.err)
    (entry,) = document(whole / "out.json")["trees"]
    assert entry["probability_low"] <= -math.expm1(-1e-3) <= entry["probability_high"]
    assert entry["minimal_cut_sets"]["sets"][0]["status"] == "confirmed"
    assert (entry["id"], entry["as_expected"], entry["confirmed"]) == ("counter_hazard.no_alarm", True, {"1": 1})
    assert (whole / "tree.svg").read_text().startswith("<svg")


def test_another_number_of_cut_sets_than_declared_is_not_as_asked(run: Run, whole: Path) -> None:
    path = whole / "proofs/counter_hazard.py"
    path.write_text(path.read_text().replace("expect={1: 1}", "expect={1: 2}"))
    called = run("tree")
    assert called.code == 1
    assert "cut sets by order 1 of order 1, expected 2 of order 1" in called.err


def test_a_rate_of_no_fault_is_refused(run: Run, whole: Path) -> None:
    path = whole / "proofs/counter_hazard.py"
    path.write_text(path.read_text().replace('"seen stuck-at-0":', '"sen stuck-at-0":'))
    called = run("tree")
    assert called.code == 2
    assert "did you mean seen stuck-at-0" in called.err


def test_a_tree_file_needs_no_project(run: Run, project: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    path = put(elsewhere, "t.json", json.dumps(TREE))
    called = run("tree", str(path), "--hours", "10", "--json", "-")
    assert called.code == 0
    (entry,) = json.loads(called.out)["trees"]
    assert (entry["basic_events"], entry["minimal_cut_sets"]["count"]) == (2, 1)
    assert entry["probability"] == pytest.approx(0.1 * 0.00995016625)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["none.json"], "none.json"),
        (["t.json"], "no mission time"),
        (["t.json", "--hours", "x"], "--hours is 'x'"),
        (["t.json", "-k", "x"], "-k"),
        (["--hours", "3"], "give a FILE"),
        (["bad.json"], "bad.json:1"),
    ],
)
def test_tree_says_what_is_wrong(run: Run, project: Path, words: list[str], said: str) -> None:
    put(project, "t.json", json.dumps(TREE))
    put(project, "bad.json", "{")
    called = run("tree", *words)
    assert (called.code, called.out) == (2, "")
    assert said in called.err


def test_a_campaign(run: Run, whole: Path) -> None:
    called = run("inject", "--json", "out.json")
    assert called.code == 0, called.err
    (entry,) = document(whole / "out.json")["campaigns"]
    assert (entry["injections"], entry["exhaustive"]) == (4, True)
    assert entry["classes"] == {"safe": 0, "detected": 1, "dangerous_undetected": 2, "no_effect": 1}
    assert called.out.splitlines()[0].startswith("campaign")
    assert "counter_stuck" in called.out


def test_assumed_rates_of_failure_modes_are_marked(
    whole: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    modes = [
        {"part": "a", "mode": "stuck", "faults": 2, "rate_per_h": 1e-7, "tag": "A", "dangerous_undetected": 1},
        {"part": "b", "mode": "open", "faults": 2, "rate_per_h": 2e-7, "tag": "P", "safe": 1},
    ]
    entry = {"id": "k", "injections": 4, "classes": {}, "fmeda": modes, "by_rate": {"lambda_du": 5e-8}}
    session = SimpleNamespace(results={"campaigns": [entry]}, code=0)
    monkeypatch.setattr("safety.commands.inject.work", lambda *_, **options: session)
    assert main(["inject", "--project", str(whole)]) == 0
    head, every, one, other = capsys.readouterr().out.splitlines()
    assert head.endswith("rate /h")
    assert every.endswith("5 × 10⁻⁸ [A] dangerous undetected")
    assert one.endswith("1 × 10⁻⁷ [A]")
    assert other.endswith("2 × 10⁻⁷")


def test_a_rate(run: Run, whole: Path) -> None:
    called = run("rate", "--json", "out.json")
    assert called.code == 0, called.err
    (entry,) = document(whole / "out.json")["rates"]
    assert (entry["value"], entry["exact"], entry["unit"]) == (1e6, "1000000/1", "h")
    assert re.search(r"counter.life +1 × 10⁶ \[A\] ", called.out)
    assert re.search(r"FOUND.* \[A\]", called.err)


def test_an_entry_out_of_shape_does_not_cost_the_others(run: Run, whole: Path) -> None:
    path = whole / "proofs/counter_rate.py"
    path.write_text(path.read_text().replace('source="[A]"', "source=5"))
    called = run("verify", "-k", "life or five", "--json", "out.json")
    assert called.code == 70
    assert [entry["id"] for entry in document(whole / "out.json")["claims"]] == ["counter.five_is_far"]


@pytest.mark.parametrize(
    ("route", "code", "said"),
    [
        ("lambda: Fraction(10**7)", 6, "two independent routes"),
        ("lambda: 0.1", 2, "a float"),
        ("lambda: 1 / 0", 2, "division by zero"),
    ],
)
def test_a_rate_that_cannot_be_relied_on(run: Run, whole: Path, route: str, code: int, said: str) -> None:
    path = whole / "proofs/counter_rate.py"
    path.write_text(path.read_text().replace("lambda: Fraction(10**6)", route))
    called = run("rate")
    assert called.code == code
    assert said in called.err
