import os
import subprocess
import sys
from pathlib import Path

import pytest

from safety.commands import VERBS, main

START = "import sys; from safety.commands import main; sys.exit(main())"
HERE = Path(__file__).resolve().parents[2]


def test_help_names_every_verb(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    shown = capsys.readouterr().out
    assert [verb for verb in VERBS if f"\n  {verb} " not in shown] == []


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_help_with_examples(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([verb, "--help"]) == 0
    assert f"rightside {verb}" in capsys.readouterr().out.partition("examples:")[2]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["prov"], "did you mean prove"),
        (["frobnicate"], "verbs: verify"),
        (["--project", "x", "prove"], "before the verb"),
        (["prove", "--no-such"], "--no-such"),
        (["prove", "a.claim"], "choose claims with -k NAME"),
        (["rate", "-j", "1", "mtbf"], "choose rates with -k NAME"),
        (["prove", "-j", "0"], "1 or more"),
        (["prove", "--timeout", "soon"], "seconds"),
        (["prove", "--set", "k"], "NAME=VALUE"),
        (["prove", "--set", "k=x"], "whole number"),
        (["prove", "--project", "no/such/folder"], "no such folder"),
        (["list", "frogs"], "frogs"),
        (["run"], "MODEL"),
    ],
)
def test_a_wrong_call_ends_with_2_and_says_why(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 2
    assert said in capsys.readouterr().err


def test_outside_of_a_project_the_next_step_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["prove", "--project", str(tmp_path)]) == 2
    assert "--project DIR" in capsys.readouterr().err


def test_without_a_verb_the_help_is_shown_and_the_call_is_wrong(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 2
    assert "verbs:" in capsys.readouterr().err


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.strip()


def test_an_internal_error_asks_for_a_report(
    project: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("safety.project.find_root", lambda start: 1 / 0)
    assert main(["prove", "--project", str(project)]) == 70
    assert "Please report it" in capsys.readouterr().err


def test_a_reader_that_goes_away_is_no_error(project: Path) -> None:
    command = [sys.executable, "-c", START, "list", "--project", str(project)]
    environment = {**os.environ, "PYTHONPATH": str(HERE)}
    listing = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
    assert listing.stdout is not None and listing.stderr is not None
    listing.stdout.close()
    assert (listing.stderr.read(), listing.wait()) == ("", 0)
    listing.stderr.close()
