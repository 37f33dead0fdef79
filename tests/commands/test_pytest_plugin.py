from pathlib import Path

import pytest

from tests.commands.conftest import put, with_plug_in

LOADED = """
    import sys
    def test_nothing_heavy_is_loaded():
        assert {"z3", "cvc5", "numpy", "msgspec", "jinja2", "safety.model"} & set(sys.modules) == set()
"""


def test_claims_and_campaigns_are_items_that_pass_when_as_asked(whole: Path) -> None:
    put(whole, "pytest.ini", "[pytest]\nrightside = true\n")
    done = with_plug_in(whole, "-v", "proofs")
    assert done.returncode == 0, done.stdout
    shown = " ".join(done.stdout.split())
    for text in (
        "counter.py::counter::alarm_at_twelve PASSED",
        "counter_campaign.py::counter_stuck PASSED",
        "5 passed",
    ):
        assert text in shown


def test_a_failure_tells_verdict_and_changed_cells_and_a_broken_file_its_line(project: Path) -> None:
    path = project / "proofs/counter.py"
    path.write_text(path.read_text().replace("s.n >= 12, s.alarm", "s.n >= 6, s.alarm"))
    put(project, "proofs/broken.py", "x = nothing\n")
    put(project, "proofs/wrong.py", path.read_text().replace("s.n != 5", "s.m != 5"))
    done = with_plug_in(project, "--rightside", "--continue-on-collection-errors", "-k", "not said", "proofs")
    assert done.returncode == 1
    for text in (
        "counter.alarm_at_twelve  refuted, expected proved",
        "From twelve pulses on there is an alarm.",
        "! violates counter.alarm_at_twelve",
        "proofs/broken.py:1: NameError",
        "no signal 'm'",
    ):
        assert text in done.stdout
    assert "Traceback" not in done.stdout


def test_other_test_runs_are_left_alone(project: Path) -> None:
    put(project, "test_own.py", LOADED)
    put(project, "proofs/broken.py", "x = nothing\n")
    done = with_plug_in(project, "--strict-config", "--strict-markers")
    assert done.returncode == 0, done.stdout
    assert "1 passed" in done.stdout


@pytest.mark.parametrize("words", [["--rightside"], []])
def test_files_outside_of_proofs_are_left_alone(project: Path, words: list[str]) -> None:
    put(project, "tests/test_own.py", "def test_own():\n    pass\n")
    done = with_plug_in(project, *words, "tests", "models")
    assert (done.returncode, "1 passed" in done.stdout) == (0, True), done.stdout
