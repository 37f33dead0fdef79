from pathlib import Path

from tests.commands.conftest import Run, document, put


def test_verify_does_everything_and_ends_with_the_path_of_the_report(run: Run, whole: Path) -> None:
    called = run("verify", "--json", "out.json")
    assert called.code == 0, called.err
    assert called.out.splitlines()[-1] == str(whole / "reports/index.html")
    assert document(whole / "out.json")["figures"] == []
    results = document(whole / "reports/results.json")
    assert [len(results[section]) for section in ("claims", "campaigns", "trees", "rates", "parameters")] == [
        4,
        1,
        1,
        1,
        1,
    ]
    assert {"junit.xml", "trees"} <= {path.name for path in (whole / "reports").iterdir()}
    assert run("report", "--check").code == 0


def test_a_report_is_the_same_again(run: Run, whole: Path) -> None:
    run("verify", "-j", "1")
    run("verify", "--to", "again", "-j", "2")
    first, again = (
        {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
        for folder in (whole / "reports", whole / "again")
    )
    assert first == again


def test_a_part_writes_no_report_unless_told_where(run: Run, project: Path) -> None:
    assert run("verify", "-k", "five").code == 0
    assert not (project / "reports").exists()
    assert run("verify", "-k", "five", "--to", "part").out.strip() == "part/index.html"
    assert len(document(project / "part/results.json")["claims"]) == 1


def test_a_broken_file_keeps_the_old_report(run: Run, project: Path) -> None:
    run("verify")
    before = (project / "reports/results.json").read_bytes()
    put(project, "proofs/bad.py", "x = nothing\n")
    called = run("verify")
    assert (called.code, called.out) == (2, "")
    assert "no report" in called.err
    assert (project / "reports/results.json").read_bytes() == before


def test_a_stale_report_is_found(run: Run, project: Path) -> None:
    run("verify")
    (project / "reports/index.html").write_text("edited")
    called = run("report", "--check")
    assert called.code == 1
    assert "stale: index.html" in called.err


def test_a_report_of_an_older_text_is_stale_also_without_last_results(run: Run, project: Path) -> None:
    run("verify")
    (project / ".rightside/last.json").unlink()
    assert run("report", "--check").code == 0
    path = project / "models/counter.py"
    path.write_text(path.read_text() + "# changed\n")
    called = run("report", "--check")
    assert called.code == 1
    assert "stale: models/counter.py" in called.err


def test_without_a_report_check_says_so(run: Run) -> None:
    called = run("report", "--check")
    assert called.code == 1
    assert "there is no report" in called.err


def test_results_of_two_texts_make_no_report(run: Run, project: Path) -> None:
    run("prove", "-q")
    path = project / "proofs/counter.py"
    path.write_text(path.read_text() + "# changed\n")
    assert "proofs/counter.py changed" in run("report").err
    run("prove", "-q", "-k", "five")
    called = run("report")
    assert called.code == 2
    assert "3 results are of an older text" in called.err
    run("prove", "-q")
    assert run("report").code == 0


def test_report_out_of_kept_results(run: Run, project: Path) -> None:
    run("prove", "-q", "-k", "five", "--json", "a.json")
    run("prove", "-q", "-k", "twelve", "--json", "b.json")
    assert run("report", "--from", "a.json", "b.json", "--to", "out").code == 0
    assert len(document(project / "out/results.json")["claims"]) == 3


def test_report_says_what_is_wrong(run: Run, project: Path) -> None:
    put(project, "bad.json", '{"schema": "other/1"}')
    for words, said in [
        ([], "no last results"),
        (["--from", "none.json"], "no such file"),
        (["--from", "bad.json"], "schema"),
    ]:
        called = run("report", *words)
        assert (called.code, called.out) == (2, "")
        assert said in called.err


def test_a_folder_that_cannot_be_written(run: Run, project: Path) -> None:
    (project / "file").write_text("")
    called = run("verify", "--to", "file/reports")
    assert called.code == 2
    assert "cannot be written" in called.err


def test_last_results_that_cannot_be_kept_are_a_warning(run: Run, project: Path) -> None:
    (project / ".rightside").write_text("in the way")
    called = run("prove", "-q", "-k", "five")
    assert called.code == 0
    assert "could not be kept" in called.err
