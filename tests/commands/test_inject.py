"""`inject` as a gate: what is worse than a baseline or below a target fails by name, what cannot be used is refused."""

from __future__ import annotations

import csv
import json
import socket
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree as ET

import pytest

from safety.commands.injecting import pace
from safety.inject.reproduce import Unconfirmed
from tests.commands.conftest import Called, Run, document, put

HERE = ("--store", "st", "--executor", "serial")  # in this process
ALARM = "counter_stuck::alarm.out stuck-at-1"


def campaign(whole: Path, old: str, new: str) -> None:
    path = whole / "proofs/counter_campaign.py"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


@pytest.fixture
def baseline(run: Run, whole: Path) -> Path:
    called = run("inject", "--write-baseline", "b.json", *HERE)
    assert called.code == 0, called.err
    assert "baseline of 1 campaigns: b.json" in called.err
    return whole / "b.json"


# --- baselines -------------------------------------------------------------------------------------------------------


def test_an_unchanged_project_is_as_its_baseline(run: Run, baseline: Path) -> None:
    called = run("inject", "--baseline", "b.json", "--write-baseline", "again.json", "--json", "out.json")
    assert called.code == 0, called.err
    assert baseline.read_bytes() == baseline.with_name("again.json").read_bytes()
    (entry,) = document(baseline.with_name("out.json"))["campaigns"]
    assert (entry["baseline"]["new"], entry["baseline"]["told"], entry["as_expected"]) == ({}, [], True)
    assert "record" not in entry and entry["declared"] == {"file": "proofs/counter_campaign.py", "line": 5}


def test_a_lost_detection_fails_by_name_in_every_output(run: Run, baseline: Path) -> None:
    campaign(baseline.parent, "detected=lambda seen: seen.total", "detected=lambda seen: 2 + seen.total")
    campaign(baseline.parent, "> seen.healthy", "> 99 + seen.healthy")
    called = run("inject", "--baseline", "b.json", "--sarif", "out.sarif", "--junit", "out.xml")
    told = f"lost detection: alarm.out stuck-at-1 (now no effect); rightside replay '{ALARM}'"
    assert called.code == 1
    assert told in called.err and "1 lost detection against b.json" in called.err
    failures = [failure.get("message") for failure in ET.parse(baseline.with_name("out.xml")).iter("failure")]
    assert failures == [told]
    (run_,) = document(baseline.with_name("out.sarif"))["runs"]
    found = {(one["ruleId"], one["baselineState"]) for one in run_["results"]}
    assert found == {("lost-detection", "new"), ("dangerous-undetected", "unchanged")}
    assert run_["results"][0]["locations"][0]["physicalLocation"]["region"]["startLine"] == 5


def test_a_new_dangerous_undetected_fault_fails_by_name(run: Run, baseline: Path) -> None:
    campaign(baseline.parent, "< seen.healthy", "!= seen.healthy")
    campaign(baseline.parent, "> seen.healthy", "> 99 + seen.healthy")
    called = run("inject", "--baseline", "b.json", "--shrink", "1", "--json", "out.json", *HERE)
    told = f"new dangerous undetected: alarm.out stuck-at-1 (was detected); rightside replay '{ALARM}'"
    assert called.code == 1 and told in called.err
    (entry,) = document(baseline.with_name("out.json"))["campaigns"]
    assert [one["of"] for one in entry["reproducers"]] == ["alarm.out stuck-at-1"]  # the new one comes first
    replayed = run("replay", f"counter_stuck::{entry['reproducers'][0]['injection']}", "--from", "out.json")
    assert replayed.code == 0, replayed.err
    assert "is dangerous undetected" in replayed.err


def test_what_became_better_is_no_failure(run: Run, baseline: Path) -> None:
    campaign(baseline.parent, "> seen.healthy", "!= seen.healthy")
    called = run("inject", "--baseline", "b.json", "--json", "out.json", *HERE)
    assert called.code == 0, called.err
    (entry,) = document(baseline.with_name("out.json"))["campaigns"]
    assert entry["baseline"]["better"] == [
        "2 no longer dangerous undetected: seen stuck-at-0, alarm.out stuck-at-0",
        "2 newly detected: seen stuck-at-0, alarm.out stuck-at-0",
    ]
    assert "better than b.json: 2 no longer dangerous undetected" in called.err
    assert "--write-baseline b.json` keeps it" in called.err


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("measured=20", "measured=19", "campaign 'counter_stuck' is another one: all 4 single faults as before"),
        ('"seen", "alarm.out"', '"seen"', "its faults was 'all 4 single faults', is 'all 2 single faults'"),
        ('id="counter_stuck"', 'id="counter_other"', "b.json has no campaign 'counter_other'; it has counter_stuck"),
    ],
)
def test_a_baseline_of_another_campaign_is_refused(run: Run, baseline: Path, old: str, new: str, said: str) -> None:
    campaign(baseline.parent, old, new)
    called = run("inject", "--baseline", "b.json")
    assert (called.code, called.out) == (2, "")
    assert said in called.err and "--write-baseline b.json" in called.err


def test_a_campaign_that_is_gone_is_missed(run: Run, baseline: Path) -> None:
    records = document(baseline)
    records["campaigns"]["of old"] = records["campaigns"]["counter_stuck"]
    baseline.write_text(json.dumps(records))
    called = run("inject", "--baseline", "b.json")
    assert called.code == 2
    assert "b.json has the campaign 'of old', which the project no longer declares" in called.err
    assert run("inject", "-k", "counter", "--baseline", "b.json", *HERE).code == 0


@pytest.mark.parametrize(("text", "said"), [('{\n "schema": 1\n]', "b.json:3: no JSON"), ("\xff", "no JSON")])
def test_a_garbled_baseline_is_refused_and_not_written_over(run: Run, baseline: Path, text: str, said: str) -> None:
    baseline.write_text(text)
    called = run("inject", "--baseline", "b.json")
    assert called.code == 2 and said in called.err
    called = run("inject", "--write-baseline", "b.json")
    assert called.code == 2 and "b.json is there and is no baseline; it is not written over" in called.err
    assert run("inject", "-k", "counter", "--write-baseline", "b.json").code == 2
    assert baseline.read_text() == text


def test_a_part_leaves_the_records_of_the_others(run: Run, baseline: Path) -> None:
    text = (baseline.parent / "proofs/counter_campaign.py").read_text()
    put(baseline.parent, "proofs/other_campaign.py", text.replace("counter_stuck", "other"))
    assert run("inject", "-k", "other", "--write-baseline", "b.json", *HERE).code == 0
    assert list(document(baseline)["campaigns"]) == ["counter_stuck", "other"]


def test_a_reproducer_that_python_denies_is_a_disagreement(
    run: Run, whole: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def denied(*_: object) -> None:
        raise Unconfirmed("alarm.out is wrong/no on the native engine, safe/no on the Python reading")

    monkeypatch.setattr("safety.inject.reproduce.reproducer", denied)
    called = run("inject", "--shrink", "1", "--json", "out.json", *HERE)
    assert called.code == 6, called.err
    assert "engines disagree: alarm.out is wrong/no on the native engine" in called.err
    (entry,) = document(whole / "out.json")["campaigns"]
    assert entry["injections"] == 4


# --- targets ---------------------------------------------------------------------------------------------------------


def test_a_target_that_is_missed_fails(run: Run, whole: Path) -> None:
    called = run("inject", "--target-coverage", "0.5", *HERE)
    assert called.code == 1
    assert "diagnostic coverage 0, target 0.5 missed" in called.err
    assert run("inject", "--target-coverage", "counter_stuck=1%", *HERE).code == 1


def test_a_target_of_the_declaration_counts_unless_another_is_given(run: Run, whole: Path) -> None:
    campaign(whole, "measured=20", "target_coverage='1/3', measured=20")
    campaign(whole, "> seen.healthy", "!= seen.healthy")
    assert run("inject", "--json", "out.json", *HERE).code == 0
    (entry,) = document(whole / "out.json")["campaigns"]
    assert entry["target_coverage"] == {
        "target": "1/3",
        "met": True,
        "told": "diagnostic coverage 1, target 0.3333 met",
    }
    campaign(whole, "'1/3'", "'4/3'")
    called = run("inject", *HERE)
    assert called.code == 2
    assert "target_coverage is '4/3'; write a share from 0 to 1 in quotes" in called.err


def test_a_target_is_met_where_no_injection_is_dangerous(run: Run, whole: Path) -> None:
    campaign(whole, "< seen.healthy", "< 0 * seen.healthy")
    called = run("inject", "--target-coverage", "0.1", "--json", "out.json", *HERE)
    assert called.code == 0, called.err
    (entry,) = document(whole / "out.json")["campaigns"]
    told = "no injection is dangerous, target 0.1 met"
    assert entry["target_coverage"] == {"target": "1/10", "met": True, "told": told}


def test_a_sample_without_a_dangerous_injection_decides_no_target(run: Run, whole: Path) -> None:
    campaign(whole, "< seen.healthy", "< 0 * seen.healthy")
    campaign(whole, "measured=20", "sample=3, measured=20")
    called = run("inject", "--target-coverage", "0.1", "--sarif", "out.sarif", "--junit", "out.xml", *HERE)
    told = "no injection drawn is dangerous, target 0.1 undecided: draw more"
    assert called.code == 3 and told in called.err
    assert [failure.get("message") for failure in ET.parse(whole / "out.xml").iter("failure")] == [told]
    (log,) = document(whole / "out.sarif")["runs"]
    (note,) = log["invocations"][0]["toolExecutionNotifications"]
    assert log["results"] == [] and note["message"]["text"] == f"counter_stuck: {told}"
    assert run("inject", *HERE).code == 0, "without a target, nothing is left open"


# --- stores ----------------------------------------------------------------------------------------------------------


def test_parts_come_together_to_the_whole(run: Run, baseline: Path) -> None:
    campaign(baseline.parent, "measured=20", "onsets=range(20), length=1, measured=20")
    for part in ("1/2", "2/2"):
        called = run("inject", "--store", f"s{part[0]}", "--shard", part, "--executor", "serial", "--json", "part.json")
        assert called.code in (0, 1), called.err
    whole_ = run("inject", "--store", "all", "--merge", "s1", "--merge", "s2", "--executor", "serial")
    assert whole_.code == 0, whole_.err
    assert "80 injections (all)" in whole_.err


def test_what_is_kept_is_not_run_again(run: Run, baseline: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("safety.inject.campaign.judged", lambda *_: 1 / 0)
    called = run("inject", "--resume", "--baseline", "b.json", *HERE)
    assert called.code == 0, called.err
    assert run("inject", *HERE).code == 70


def test_a_merge_of_other_shards_injects_nothing(run: Run, whole: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert run("inject", "--store", "s1", "--executor", "serial").code == 0
    text = (whole / "proofs/counter_campaign.py").read_text()
    put(whole, "proofs/other_campaign.py", text.replace("counter_stuck", "other").replace("=20", "=19"))
    monkeypatch.setattr("safety.inject.campaign.judged", lambda *_: 1 / 0)
    called = run("inject", "--store", "all", "--merge", "s1", "--executor", "serial")
    assert called.code == 2, called.err
    assert "no shard of other is there to merge: give the stores of parts" in called.err
    assert run("inject", "-k", "counter_stuck", "--store", "all", "--merge", "s1", "--executor", "serial").code == 0


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--shard", "5/3"], "shard 5/3: write i/n with i from 1 to n"),
        (["--shard", "x"], "shard 'x': write i/n"),
        (["--executor", "slurm"], "executor 'slurm': give one of serial, processes"),
        (["--executor", "dask://nowhere"], "write dask://HOST:PORT"),
        (["--store", "models/counter.py"], "models/counter.py"),
        (["--merge", "none"], "none: no such folder"),
        (["--shard", "1/2", "--write-baseline", "b.json"], "--write-baseline needs the whole campaign, --shard 1/2"),
        (["--shard", "1/2", "--baseline", "b.json"], "make all parts without it, then put them together with --merge"),
        (["--shard", "1/2", "--target-coverage", "0.9"], "--target-coverage needs the whole campaign"),
        (["--shard", "1/2", "--sarif", "o"], "--sarif needs the whole campaign"),
        (["--shard", "1/2", "--junit", "o"], "--junit needs the whole campaign"),
        (["--shard", "1/2", "--csv", "o"], "--csv needs the whole campaign"),
        (["--baseline", "none.json"], "none.json: cannot be read"),
        (["--baseline", "b.json", "--write-baseline", "b.json"], "compare first, then accept"),
        (["--baseline", "b.json", "--write-baseline", "./b.json"], "compare first, then accept"),
        (["--baseline", "b.json", "--sarif", "models/../b.json"], "--baseline and --sarif are both models/../b.json"),
        (["--sarif", "o", "--json", "./o"], "--sarif and --json are both ./o; give each a file of its own"),
        (["--junit", "o", "--csv", "o"], "--junit and --csv are both o"),
        (["--sarif", "-"], "--sarif -: only --json goes to stdout"),
        (["--write-baseline", "-"], "--write-baseline -: only --json goes to stdout"),
        (["--baseline", ""], "--baseline is empty; write its value, or leave it out"),
        (["--json", ""], "--json is empty"),
        (["--merge", ""], "--merge is empty"),
        (["--timeout", "5"], "unrecognized arguments: --timeout"),
        (["--target-coverage", "counter=0.9"], "no campaign 'counter'; did you mean counter_stuck"),
        (["--target-coverage", "1.5"], "give a share"),
        (["--shrink", "-1"], "--shrink"),
        (["--engine", "verilator"], "invalid choice"),
        (["--sarif", "models/counter.py/x"], "cannot be written"),
    ],
)
def test_what_cannot_be_done_is_refused(run: Run, whole: Path, words: list[str], said: str) -> None:
    called = run("inject", *words)
    assert (called.code, called.out) == (2, "")
    assert said in called.err and "Traceback" not in called.err


def test_a_scheduler_that_does_not_answer_is_named(run: Run, whole: Path) -> None:
    pytest.importorskip("distributed", reason="needs the extra [cluster]")
    called = run("inject", "--executor", f"dask://127.0.0.1:{free_port()}")
    assert called.code == 2 and "no scheduler answers" in called.err


# --- other outputs ---------------------------------------------------------------------------------------------------


def test_failure_modes_go_to_files(run: Run, whole: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl", reason="needs the extra [xlsx]")
    called = run("inject", "--csv", "modes.csv", "--xlsx", "modes.xlsx", *HERE)
    assert called.code == 0, called.err
    assert "failure modes: modes.csv" in called.err
    with (whole / "modes.csv").open(encoding="utf-8", newline="") as file:
        assert [row["faults"] for row in csv.DictReader(file)] == ["4"]
    assert "FMEDA" in openpyxl.load_workbook(whole / "modes.xlsx").sheetnames
    text = (whole / "proofs/counter_campaign.py").read_text()
    put(whole, "proofs/other_campaign.py", text.replace("counter_stuck", "other"))
    assert run("inject", "--csv", "modes.csv", *HERE).code == 0
    assert {path.name for path in whole.glob("modes*.csv")} == {
        "modes.csv", "modes-counter_stuck.csv", "modes-other.csv",
    }  # fmt: skip


def test_without_the_extra_a_workbook_is_refused_before_the_work(
    run: Run, whole: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "openpyxl", None)
    called = run("inject", "--xlsx", "modes.xlsx")
    assert (called.code, called.out) == (2, "")
    assert "pip install rightside[xlsx]" in called.err


def test_collapsing_and_engines_can_be_chosen(run: Run, whole: Path) -> None:
    entries = []
    for words in (["--engine", "lanes"], ["--no-collapse"], ["--audit"]):
        assert run("inject", *words, "--json", "out.json", *HERE).code == 0
        entries += document(whole / "out.json")["campaigns"]
    assert entries[0]["engine"] == "lanes" and entries[1]["collapsed"] is None
    assert len({json.dumps(entry["cells"]) for entry in entries}) == 1


def test_progress_tells_rate_and_time_left() -> None:
    told: list[str] = []
    tell = pace(SimpleNamespace(space=range(1_000_000)), told.append)  # type: ignore[arg-type]
    tell(0.25, 0.5)
    tell(0.0, 0.0)
    assert told == ["25%, 500\u202f000/s, 2 s left", "0%, 0/s, 0 s left"]


def test_a_name_of_several_lines_stays_in_its_row(run: Run, whole: Path) -> None:
    groups = 'faults=[Group("a", stuck_bits("seen"), part="two\\nlines\\x1b[2J"), Group("b", stuck_bits("alarm.out"))]'
    campaign(whole, 'faults=stuck_bits("seen", "alarm.out")', groups)
    campaign(whole, "import Campaign", "import Campaign, Group")
    called = run("inject", *HERE)
    assert called.code == 0, called.err
    assert len(called.out.splitlines()) == 4
    assert "two lines\ufffd[2J" in called.out and "\x1b" not in called.out


def test_examples_of_the_help_can_be_given(called_examples: list[Called]) -> None:
    assert [called.err for called in called_examples if "unrecognized" in called.err or "usage:" in called.err] == []


@pytest.fixture
def called_examples(run: Run, whole: Path) -> list[Called]:
    import shlex

    from safety.commands.inject import EXAMPLES

    words = [shlex.split(line.partition("  ")[0])[1:] for line in EXAMPLES.strip().splitlines()]
    return [run(*each, "--project", "elsewhere") for each in words]


def test_a_full_disk_costs_no_result(run: Run, whole: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, text: str) -> None:
        if path.suffix == ".sarif":
            raise OSError(28, "No space left on device", str(path))
        path.write_text(text)

    monkeypatch.setattr("safety.commands.inject.write", full)
    called = run("inject", "--sarif", "out.sarif", "--junit", "out.xml", "--json", "out.json", *HERE)
    assert called.code == 2
    assert "out.sarif cannot be written: No space left on device; the results are kept" in called.err
    assert (whole / "out.xml").exists() and document(whole / "out.json")["campaigns"]
    monkeypatch.setattr("safety.inject.write_csv", lambda rows, path: full(path.with_suffix(".sarif"), ""))
    called = run("inject", "--csv", "out.csv", *HERE)
    assert called.code == 1 and "failure modes cannot be written" in called.err


def test_an_engine_that_is_not_there_is_named(run: Run, whole: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(*_: object) -> None:
        raise ImportError("No module named 'llvmlite'")

    monkeypatch.setattr("safety.inject.campaign.engine_for", missing)
    called = run("inject", "--engine", "native", *HERE)
    assert called.code == 2
    assert "counter_stuck: engine native: No module named 'llvmlite'; give --engine lanes" in called.err
