"""Results of earlier runs at the command line: what is taken, what is proved again, and that no report shows it."""

from __future__ import annotations

import json
import os
import time
from argparse import Namespace
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from safety.canonical import digest
from safety.commands.earlier import Earlier
from safety.commands.options import share
from safety.project import open_project
from tests.commands.conftest import CLAIMS, MODEL, Run, document, put

CLAIM_IDS = {
    "counter.alarm_at_twelve", "counter.alarm_at_twelve_with_a_fault", "counter.five_is_far", "counter.nothing_said",
}  # fmt: skip


@pytest.fixture
def prove(run: Run, project: Path) -> Callable[..., dict[str, Any]]:
    """Prove, and give the entries by id."""

    def call(*words: str, code: int = 0) -> dict[str, Any]:
        called = run("prove", "-q", "-j", "1", *words, "--json", "out.json")
        assert called.code == code, called.err
        return {entry["id"]: entry for entry in document(project / "out.json").get("claims", ())}

    return call


def cached(entries: dict[str, Any]) -> set[str]:
    return {name for name, entry in entries.items() if entry.get("cached")}


def plain(entries: dict[str, Any]) -> dict[str, Any]:
    return {name: {k: v for k, v in entry.items() if k != "cached"} for name, entry in entries.items()}


def append(project: Path, name: str, text: str) -> None:
    path = project / name
    path.write_text(path.read_text() + text)


def records(project: Path) -> list[Path]:
    return sorted((project / ".rightside/cache").glob("*.json"))


def test_the_second_run_takes_all_results_and_says_so(run: Run, prove: Any, project: Path) -> None:
    first = prove()
    assert cached(first) == set()
    second = prove()
    assert cached(second) == CLAIM_IDS
    assert plain(second) == first  # with the seconds that the proofs took
    called = run("prove", "-q")
    assert "4 of 4 results are of an earlier run (cached); --no-cache works them out anew" in called.err
    assert sum(line.endswith("cached") for line in called.err.splitlines()) == 4


def test_nothing_is_traced_or_loaded_when_no_file_has_changed(
    prove: Any, project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    prove()
    monkeypatch.setattr("safety.project.Project.load_proofs", lambda self: 1 / 0)
    monkeypatch.setattr("safety.commands.session.Workers", lambda *args: 1 / 0)
    assert cached(prove()) == CLAIM_IDS


def test_a_comment_changes_no_problem(prove: Any, project: Path) -> None:
    first = prove()
    append(project, "models/counter.py", "# a comment\n")
    second = prove()
    assert cached(second) == CLAIM_IDS
    assert plain(second) == first


def test_an_edited_rule_proves_what_it_touches_again_and_no_more(prove: Any, project: Path) -> None:
    put(project, "models/other.py", MODEL.replace("Counter", "Other"))
    put(project, "proofs/other.py", CLAIMS.replace("models.counter", "models.other").replace("Counter", "Other"))
    prove()
    path = project / "models/other.py"
    path.write_text(path.read_text().replace("self.n < 15", "self.n < 14"))
    assert cached(prove()) == CLAIM_IDS
    put(project, "proofs/other.py", (project / "proofs/other.py").read_text().replace("s.n >= 12", "s.n >= 13"))
    entries = prove()
    touched = {"other.alarm_at_twelve", "other.alarm_at_twelve_with_a_fault"}
    assert entries.keys() - cached(entries) == touched


def test_words_are_those_of_today(prove: Any, project: Path) -> None:
    prove()
    path = project / "proofs/counter.py"
    path.write_text(path.read_text().replace('requirement="C-2"', 'requirement="C-9"').replace("do not come", "never"))
    entries = prove()
    assert cached(entries) == CLAIM_IDS
    five = entries["counter.five_is_far"]
    assert (five["requirement"], five["statement"]) == ("C-9", "Five pulses never in three steps.")


def test_an_expectation_that_changes_is_judged_anew(prove: Any, project: Path) -> None:
    first = prove()
    path = project / "proofs/counter.py"
    before = path.read_text()
    path.write_text(before.replace("expect=BOUNDED", "expect=PROVED"))
    entries = prove(code=1)  # another expectation, another plan: the claim is looked at again, and does not hold
    assert cached(entries) == CLAIM_IDS - {"counter.five_is_far"}
    assert entries["counter.five_is_far"]["verdict"] == "refuted"
    assert not entries["counter.five_is_far"]["as_expected"]
    path.write_text(before)
    assert plain(prove()) == first


def test_an_edit_that_is_taken_back_finds_the_old_results(prove: Any, project: Path) -> None:
    first = prove()
    path = project / "models/counter.py"
    before = path.read_text()
    path.write_text(before.replace("self.n < 15", "self.n < 14"))
    prove()
    path.write_text(before)
    assert plain(prove()) == first


def test_no_cache_neither_reads_nor_keeps(prove: Any, project: Path) -> None:
    assert cached(prove("--no-cache")) == set()
    assert records(project) == []
    prove()
    assert cached(prove("--no-cache")) == set()


def test_another_parameter_is_another_question_and_is_not_kept(prove: Any, project: Path) -> None:
    prove()
    before = records(project)
    entries = prove("--set", "limit=4", "-k", "twelve and not fault")
    assert cached(entries) == set()
    assert [p["value"] for p in entries["counter.alarm_at_twelve"]["parameters"]] == [4]
    assert records(project) == before
    put(project, "pyproject.toml", "[tool.rightside]\nsettings = {limit = 5}\n")
    entries = prove("-k", "twelve and not fault")
    assert cached(entries) == set()
    assert [p["value"] for p in entries["counter.alarm_at_twelve"]["parameters"]] == [5]


def test_changed_selects_what_has_no_result(run: Run, prove: Any, project: Path) -> None:
    assert prove("--changed").keys() == CLAIM_IDS
    called = run("prove", "--changed")
    assert (called.code, "nothing selected" in called.err) == (5, True)
    append(project, "models/counter.py", "# a comment\n")
    assert run("prove", "--changed").code == 5
    path = project / "proofs/counter.py"
    path.write_text(path.read_text().replace("s.n != 5", "s.n != 6"))
    assert prove("--changed").keys() == {"counter.five_is_far"}


def test_changed_shows_a_claim_that_cannot_be_read(run: Run, prove: Any, project: Path) -> None:
    prove()
    path = project / "proofs/counter.py"
    path.write_text(path.read_text().replace("s.n != 5", "s.m != 5"))
    called = run("prove", "--changed")
    assert (called.code, "has no signal 'm'" in called.err) == (2, True)


def test_damaged_records_are_named_and_proved_again(run: Run, prove: Any, project: Path) -> None:
    first = prove()
    for path in records(project):
        path.write_bytes(path.read_bytes().replace(b"proved", b"PROVED").replace(b"refuted", b"proved "))
    called = run("prove", "-q", "-j", "1", "--json", "out.json")
    assert called.code == 0
    assert "is damaged" in called.err and "worked out anew" in called.err
    entries = {entry["id"]: entry for entry in document(project / "out.json")["claims"]}
    assert {name: entry["verdict"] for name, entry in entries.items()} == {
        name: entry["verdict"] for name, entry in first.items()
    }
    assert "counter.alarm_at_twelve_with_a_fault" not in cached(entries)


def planted(project: Path, name: str, claims: dict[str, Any]) -> None:
    """Let every record of a claim say `proved`, checksums right: what a faulty prover would have left."""
    for path in records(project):
        record = json.loads(path.read_bytes().partition(b"\n")[2])
        if record.get("stimulus") is not None:
            record |= {"stimulus": None, "settled": True}
            record["outcome"] |= {"verdict": "proved", "steps": None, "agreed_by": ["z3", "cvc5"]}
        elif "entries" in record and f"claims {name}" in record["entries"]:
            record["entries"][f"claims {name}"]["entry"] |= {"verdict": "proved", "counterexample": None}
        content = json.dumps(record).encode()
        path.write_bytes(digest([path.stem, content]).encode() + b"\n" + content)


def test_recheck_finds_a_record_that_is_wrong(run: Run, prove: Any, project: Path) -> None:
    name = "counter.alarm_at_twelve_with_a_fault"
    planted(project, name, prove())
    believed = prove(code=1)
    assert (believed[name]["verdict"], believed[name]["cached"]) == ("proved", True)
    called = run("prove", "-q", "-j", "1", "--recheck", "100%", "--json", "out.json")
    assert called.code == 6
    assert "refuted, but the cache (proved) disagree" in called.err
    entries = {entry["id"]: entry for entry in document(project / "out.json")["claims"]}
    assert {each for each, entry in entries.items() if entry.get("rechecked")} == CLAIM_IDS - {name}
    after = prove()  # the wrong record is gone
    assert (after[name]["verdict"], after[name].get("cached")) == ("refuted", None)


def test_recheck_proves_its_share_again(run: Run, prove: Any, project: Path) -> None:
    prove()
    entries = prove("--recheck", "30%")
    again = {name for name, entry in entries.items() if entry.get("rechecked")}
    assert len(again) == 2 and again | cached(entries) == CLAIM_IDS
    assert "2 cached results proved again, with the same outcome" in run("prove", "--recheck", "30%").err


def test_the_draw_depends_on_the_seed_alone(run: Run, prove: Any, project: Path) -> None:
    prove()
    opened, found = open_project(project), {}
    for seed in ("", "1", "2", "3", "4", "5"):
        args = Namespace(recheck=(Fraction(1, 4), seed), changed=False, timeout=None)
        for _ in range(2):
            earlier = Earlier(opened, args)
            earlier.chosen(opened, earlier.items(opened, ["claims"]))
            found.setdefault(seed, set()).add(tuple(earlier.again))
    assert {len(draws) for draws in found.values()} == {1}
    drawn = {next(iter(draws)) for draws in found.values()}
    assert {len(names) for names in drawn} == {1} and len(drawn) > 1


@pytest.mark.parametrize("text", ["0", "0%", "101%", "2", "x", "1/0", "-5%", "%", "", "@1", "nan"])
def test_a_share_that_is_none_is_refused(run: Run, text: str) -> None:
    called = run("prove", f"--recheck={text}")
    assert (called.code, "give a share" in called.err) == (2, True)


def test_shares() -> None:
    assert [str(share(text)[0]) for text in ("5%", "1/20", "0.05", "100%", "1", "2.5%")] == [
        "1/20", "1/20", "1/20", "1", "1", "1/40",
    ]  # fmt: skip
    assert share("5%@a@b")[1] == "a@b"


@pytest.mark.parametrize("words", [["--changed", "--no-cache"], ["--recheck", "5%", "--set", "limit=9"]])
def test_options_that_contradict_are_refused(run: Run, words: list[str]) -> None:
    called = run("prove", *words)
    assert (called.code, "leave out --no-cache" in called.err) == (2, True)


def test_a_waveform_of_an_earlier_refutation(prove: Any, project: Path) -> None:
    prove("--vcd", "fresh")
    entries = prove("--vcd", "again")
    assert cached(entries) == CLAIM_IDS
    name = "counter.alarm_at_twelve_with_a_fault.vcd"
    assert (project / "fresh" / name).read_bytes() == (project / "again" / name).read_bytes()


def test_a_result_of_an_earlier_run_can_be_replayed(run: Run, prove: Any) -> None:
    prove()
    prove()
    assert run("replay", "counter.alarm_at_twelve_with_a_fault").code == 0


def tree(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_a_report_is_the_same_with_and_without_earlier_results(run: Run, whole: Path) -> None:
    assert run("verify", "--to", "fresh").code == 0
    assert run("verify", "--to", "again", "--json", "out.json").code == 0
    results = document(whole / "out.json")
    assert all(e["cached"] for section in ("claims", "campaigns", "trees", "rates") for e in results[section])
    for path in records(whole):
        if b'"entries"' in path.read_bytes():
            path.unlink()  # what is left goes by problem
    called = run("verify", "--to", "by problem")
    assert (called.code, "4 of 7 results are of an earlier run" in called.err) == (0, True)
    assert tree(whole / "fresh") == tree(whole / "again") == tree(whole / "by problem")
    assert b"cached" not in b"".join(tree(whole / "again").values())


@pytest.mark.parametrize("before", ["none", "damaged"])
def test_compiled_code_is_made_and_not_read(
    run: Run, whole: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch, before: str
) -> None:
    """A campaign looks for its compiled code and leaves it there: no reason to doubt the results."""
    kept = tmp_path_factory.mktemp("kept")
    monkeypatch.setenv("XDG_CACHE_HOME", str(kept))
    if before == "damaged":
        assert run("verify", "-k", "counter_stuck", "--no-cache").code == 0
        for path in (kept / "rightside/native").iterdir():
            path.write_bytes(b"damaged")
    assert run("verify", "-k", "counter_stuck").code == 0
    assert any((kept / "rightside/native").iterdir())
    assert run("verify", "-k", "counter_stuck", "--json", "out.json").code == 0
    assert [entry.get("cached") for entry in document(whole / "out.json")["campaigns"]] == [True]


def test_a_file_read_beside_the_project_counts(prove: Any, project: Path) -> None:
    (project / "limit.txt").write_text("5")
    text = CLAIMS.replace("s.n != 5", 's.n != int(open("limit.txt").read())')
    put(project, "proofs/counter.py", text)
    assert prove(code=0)["counter.five_is_far"]["verdict"] == "bounded"
    assert cached(prove()) == CLAIM_IDS
    (project / "limit.txt").write_text("2 ")
    later = time.time() + 5
    os.utime(project / "limit.txt", (later, later))
    entries = prove(code=1)
    assert entries["counter.five_is_far"]["verdict"] == "refuted"
    assert cached(entries) == CLAIM_IDS - {"counter.five_is_far"}


def test_a_file_that_is_not_python_counts(prove: Any, project: Path) -> None:
    put(project, "models/limit.txt", "5")
    path = project / "proofs/counter.py"
    path.write_text(path.read_text().replace("s.n != 5", 's.n != int(open("models/limit.txt").read())'))
    prove()
    put(project, "models/limit.txt", "2")
    assert prove(code=1)["counter.five_is_far"]["verdict"] == "refuted"


def test_a_file_that_changes_while_it_runs_leaves_no_result_of_two_texts(prove: Any, project: Path) -> None:
    path = project / "proofs/counter.py"
    text = path.read_text()
    path.write_text(
        text.replace("return s.n != 5", 'open("models/counter.py", "a").write("# later\\n"); return s.n != 5')
    )
    prove("-k", "five")
    path.write_text(text)
    assert not any("entries" in json.loads(p.read_bytes().partition(b"\n")[2]) for p in records(project))


def test_results_that_cannot_be_kept_are_shown_all_the_same(run: Run, prove: Any, project: Path) -> None:
    put(project, ".rightside/cache", "in the way")
    entries = prove()
    assert (entries.keys(), cached(entries)) == (CLAIM_IDS, set())
    assert "cannot be kept" in run("prove").err


def test_up_to_the_first_that_is_not_as_asked_goes_in_order(prove: Any, project: Path) -> None:
    put(project, "proofs/a.py", CLAIMS.replace("expect=BOUNDED", "expect=PROVED"))
    first = prove("-x", code=1)
    assert plain(prove("-x", code=1)) == plain(first)
    assert first.keys() == {"a.alarm_at_twelve", "a.alarm_at_twelve_with_a_fault", "a.five_is_far"}
