"""`rightside export`: the file, the words on stderr, and what it refuses."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from safety.export import FORMATS
from tests.commands.conftest import Run

ROOT = Path(__file__).resolve().parent.parent.parent


@pytest.mark.parametrize("form", [form for form in FORMATS if form != "aiger"])
def test_text_goes_to_stdout_and_words_to_stderr(run: Run, form: str) -> None:
    called = run("export", "counter.alarm_at_twelve", "--format", form)
    assert called.code == 0
    assert "alarm" not in called.out.splitlines()[0]
    assert called.err.splitlines()[0] == ("counter.alarm_at_twelve: From twelve pulses on there is an alarm.")
    assert f"{form} ({FORMATS[form].text})" in called.err
    assert called.out == run("export", "counter.alarm_at_twelve", "--format", form).out


@pytest.mark.parametrize("form", FORMATS)
def test_the_ending_of_a_file_names_the_format(run: Run, project: Path, form: str) -> None:
    to = f"out/claim{FORMATS[form].ending}"
    assert run("export", "counter.five_is_far", "--to", to).code == 0
    assert (project / to).stat().st_size > 100
    if form != "aiger":
        assert (project / to).read_text() == run("export", "counter.five_is_far", "--format", form).out


def test_binary_into_a_pipe(run: Run, project: Path) -> None:
    run("export", "counter.five_is_far", "--to", "claim.aig")
    start = "import sys; from safety.commands import main; sys.exit(main(sys.argv[1:]))"
    words = [sys.executable, "-c", start, "export", "counter.five_is_far", "--format", "aiger"]
    called = subprocess.run(words, capture_output=True, cwd=project, env={**os.environ, "PYTHONPATH": str(ROOT)})
    assert called.stdout == (project / "claim.aig").read_bytes()


def test_a_setting_changes_the_file_and_the_arithmetic_does(run: Run) -> None:
    words = ["export", "counter.alarm_at_twelve", "--format", "vmt"]
    plain = run(*words).out
    assert "Int" in plain and "BitVec" not in plain
    assert run(*words, "--set", "limit=9").out != plain
    assert "BitVec" in run(*words, "--arithmetic", "bits").out


def test_lemmas_are_named_or_said_to_be_left_out(run: Run, project: Path) -> None:
    path = project / "proofs/counter.py"
    path.write_text(
        path.read_text().replace("expect=BOUNDED, steps=3,", "expect=BOUNDED, steps=3, lemmas=[lambda s: s.n < 16],")
    )
    words = ["export", "counter.five_is_far", "--format", "smtlib"]
    without, with_ = run(*words), run(*words, "--lemmas")
    assert "(of its 1 lemmas none; --lemmas adds them)" in without.err
    assert "the claim and its 1 lemmas, to be shown together" in with_.err
    assert without.out != with_.out
    assert "it has no lemmas" in run("export", "counter.alarm_at_twelve", "--format", "smtlib", "--lemmas").err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["counter.alarm", "--format", "vmt"], "no claim 'counter.alarm'; did you mean counter.alarm_at_twelve"),
        (["counter.five_is_far"], "which format? Give --format (aiger, aag, btor2, smtlib, vmt, verilog)"),
        (["counter.five_is_far", "--to", "claim.txt"], "or --to with one of the endings .aig, .aag, .btor2"),
        (["counter.five_is_far", "--to", "proofs", "--format", "vmt"], "it is a folder; give a file in it"),
        (["counter.five_is_far", "--format", "lustre"], "invalid choice: 'lustre'"),
    ],
)
def test_what_is_refused(run: Run, words: list[str], said: str) -> None:
    called = run("export", *words)
    assert (called.code, called.out) == (2, "")
    assert said in " ".join(called.err.split())


def test_a_binary_is_not_poured_onto_a_terminal(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    called = run("export", "counter.five_is_far", "--format", "aiger")
    assert (called.code, called.out) == (2, "")
    assert "aiger is a binary format; give --to FILE, or --format aag" in called.err
