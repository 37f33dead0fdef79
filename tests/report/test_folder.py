"""A committed report folder is what `write` writes; anything else is found and named."""

from pathlib import Path
from typing import Any

import pytest

from safety.report.folder import check, write
from safety.report.results import load

Results = dict[str, Any]


@pytest.fixture
def folder(tmp_path: Path, sample: Results) -> Path:
    target = tmp_path / "reports"
    write(sample, target)
    waveform = target / "traces" / "brakes_even_with_two.vcd"
    waveform.parent.mkdir()
    waveform.write_text("$end\n")
    return target


def found(results: Results, folder: Path) -> list[str]:
    return [str(difference) for difference in check(results, folder)]


def test_a_fresh_folder_is_fresh(sample: Results, folder: Path) -> None:
    assert found(sample, folder) == []


def test_another_machine_another_day_is_still_fresh(sample: Results, folder: Path) -> None:
    sample["runs"] = [{"machine": "another"}]
    sample["tool"]["z3"] = "99"
    sample["campaigns"][0]["seconds"] = 1e6
    assert found(sample, folder) == []


def test_the_committed_results_make_the_committed_folder(folder: Path) -> None:
    assert found(load(folder / "results.json"), folder) == []


def test_writing_twice_gives_the_same_bytes(sample: Results, folder: Path) -> None:
    before = {path: path.read_bytes() for path in folder.rglob("*.*") if path.is_file()}
    write(sample, folder)
    assert {path: path.read_bytes() for path in folder.rglob("*.*") if path.is_file()} == before


def test_a_verdict_that_changed_makes_the_folder_stale(sample: Results, folder: Path) -> None:
    claim = next(claim for claim in sample["claims"] if claim["id"] == "rate_is_exact")
    claim["verdict"] = "bounded"
    differences = {difference.file: difference for difference in check(sample, folder)}
    assert differences.keys() == {"results.json", "index.html", "junit.xml"}
    assert all(difference.kind == "stale" for difference in differences.values())
    place = "claims.models.ts7.Ring/rate_is_exact.verdict: committed 'proved', now 'bounded'"
    assert differences["results.json"].detail == place


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("index.html", "All ", "all "),
        ("index.html", "\n", "\r\n"),
        ("junit.xml", "testsuite", "suite"),
        ("results.json", '"refuted"', '"proved"'),
        ("results.json", "{", "{{"),
        ("results.json", ": ", ":  "),
    ],
)
def test_an_edited_file_is_stale(sample: Results, folder: Path, file: str, old: str, new: str) -> None:
    path = folder / file
    before = path.read_bytes()
    path.write_bytes(before.replace(old.encode(), new.encode(), 1) if old in before.decode() else before + b" ")
    assert [(difference.file, difference.kind) for difference in check(sample, folder)] == [(file, "stale")]


def test_bytes_that_are_no_text_are_stale(sample: Results, folder: Path) -> None:
    (folder / "index.html").write_bytes(b"\xff\xfe")
    assert found(sample, folder) == ["index.html: stale: not UTF-8 text"]


def test_missing_and_extra_files_are_named(sample: Results, folder: Path) -> None:
    (folder / "junit.xml").unlink()
    (folder / "traces" / "brakes_even_with_two.vcd").unlink()  # a waveform may be there or not
    (folder / "trees" / "old.svg").parent.mkdir(exist_ok=True)
    (folder / "trees" / "old.svg").write_text("<svg/>")
    assert [(d.file, d.kind) for d in check(sample, folder)] == [
        ("junit.xml", "missing"),
        ("trees/old.svg", "extra"),
    ]


def test_writing_removes_pictures_of_trees_that_are_gone_and_nothing_else(sample: Results, folder: Path) -> None:
    (folder / "trees").mkdir(exist_ok=True)
    (folder / "trees" / "old.svg").write_text("<svg/>")
    (folder / "note.txt").write_text("kept")
    write(sample, folder)
    assert not (folder / "trees" / "old.svg").exists()
    assert (folder / "note.txt").read_text() == "kept"


def test_a_folder_that_is_not_there_misses_everything(sample: Results, tmp_path: Path) -> None:
    assert {difference.kind for difference in check(sample, tmp_path / "none")} == {"missing"}


def test_a_report_with_times_is_not_the_committed_one(sample: Results, folder: Path) -> None:
    write(sample, folder, timings=True)
    assert {"results.json", "index.html", "junit.xml"} == {difference.file for difference in check(sample, folder)}


def test_every_tree_has_its_picture(sample: Results, folder: Path) -> None:
    assert [path.name for path in (folder / "trees").iterdir()] == ["no_brake_on_overspeed.svg"]
