import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.commands.conftest import Run, document, put

KEYS = {
    "id", "model", "requirement", "source", "expect", "verdict", "as_expected", "strength", "faults", "method",
    "user_lemmas", "seconds", "certificate", "agreed_by", "counterexample",
}  # fmt: skip


def claim(name: str, body: str, expect: str = "PROVED", more: str = "") -> str:
    return f'''
    import os, signal, time
    from models.counter import Counter
    from safety import BOUNDED, PROVED, REFUTED, UNDECIDED, Bit, Seen, claim, implies

    @claim(Counter, expect={expect}{more})
    def {name}(s: Seen) -> Bit:
        """A claim."""
        {body}
    '''


def test_all_as_asked(run: Run, project: Path) -> None:
    called = run("prove", "--json", "out.json")
    assert called.code == 0, called.err
    results = document(project / "out.json")
    assert [(c["id"], c["verdict"]) for c in results["claims"]] == [
        ("counter.alarm_at_twelve", "proved"),
        ("counter.alarm_at_twelve_with_a_fault", "refuted"),
        ("counter.five_is_far", "bounded"),
        ("counter.nothing_said", "vacuous"),
    ]
    assert [KEYS - entry.keys() for entry in results["claims"]] == [set()] * 4
    assert (results["schema"], set(results["tool"]) >= {"rightside", "python", "z3"}) == ("rightside/1", True)
    assert {file["id"] for file in results["models"]} == {"models/counter.py", "proofs/counter.py"}
    assert called.out == ""


def test_a_line_says_verdict_strength_method_and_agreement(run: Run) -> None:
    lines = {line.split()[1]: line for line in run("prove", "-q").err.splitlines() if line.startswith("  ")}
    assert "PROVED" in lines["counter.alarm_at_twelve"]
    assert "agreed by z3, cvc5" in lines["counter.alarm_at_twelve"]
    assert "as expected  to 3 steps" in lines["counter.five_is_far"]
    assert "as it must be" in lines["counter.alarm_at_twelve_with_a_fault"]


def test_a_refuted_claim_is_shown_with_its_violated_step(run: Run) -> None:
    shown = run("prove", "-k", "with_a_fault").err
    assert "faults  alarm.out stuck-at-0" in shown
    assert "! violates counter.alarm_at_twelve_with_a_fault" in shown
    assert "claim.holds" not in run("prove", "-q", "-k", "with_a_fault").err


@pytest.mark.parametrize(
    ("body", "expect", "code", "reason"),
    [
        ("return ~s.alarm", "PROVED", 1, "refuted, expected proved"),
        ("return s.n <= 15", "REFUTED", 1, "must fail, but is proved"),
        ("return implies(s.n > 20, s.alarm)", "PROVED", 4, "vacuous, expected proved"),
        ("os.kill(os.getpid(), signal.SIGKILL); return s.alarm", "PROVED", 3, "for want of memory"),
        ("os.kill(os.getpid(), signal.SIGABRT); return s.alarm", "PROVED", 70, "ended by itself (signal 6)"),
    ],
)
def test_exit_codes(run: Run, project: Path, body: str, expect: str, code: int, reason: str) -> None:
    put(project, "proofs/other.py", claim("one", body, expect))
    called = run("prove", "-q", "-k", "other.one or alarm_at_twelve", "--json", "out.json")
    assert called.code == code
    assert "PROVED    counter.alarm_at_twelve " in called.err  # whatever happens to one, the others count
    assert reason in called.err + str(document(project / "out.json"))


def test_nothing_selected(run: Run) -> None:
    called = run("prove", "-k", "no_such_claim")
    assert (called.code, called.out) == (5, "")
    assert "nothing selected" in called.err


def test_selection_by_requirement_and_words(run: Run, project: Path) -> None:
    run("prove", "--req", "C-1", "-k", "not fault", "--json", "out.json")
    assert [entry["id"] for entry in document(project / "out.json")["claims"]] == ["counter.alarm_at_twelve"]


def test_the_last_failed_come_again_and_all_when_none_failed(run: Run, project: Path) -> None:
    put(project, "proofs/other.py", claim("one", "return ~s.alarm"))
    assert run("prove", "-q", "-k", "other or five").code == 1
    run("prove", "-q", "--lf", "--json", "out.json")
    assert [entry["id"] for entry in document(project / "out.json")["claims"]] == ["other.one"]
    put(project, "proofs/other.py", claim("one", "return s.n <= 15"))
    assert run("prove", "-q", "--lf").code == 0
    run("prove", "-q", "--lf", "-k", "other or five", "--json", "out.json")
    assert len(document(project / "out.json")["claims"]) == 2


def test_x_stops_at_the_first_that_is_not_as_asked(run: Run, project: Path) -> None:
    put(project, "proofs/a.py", claim("one", "return ~s.alarm"))
    assert run("prove", "-q", "-x", "-j", "1", "--json", "out.json").code == 1
    assert [entry["id"] for entry in document(project / "out.json")["claims"]] == ["a.one"]


def test_a_setting_changes_the_model(run: Run, project: Path) -> None:
    assert run("prove", "-q", "-k", "not fault and alarm", "--set", "limit=12", "--json", "out.json").code == 0
    results = document(project / "out.json")
    assert [p["value"] for p in results["claims"][0]["parameters"]] == [12]
    assert results["settings"] == {"limit": "12"}
    assert not (project / ".rightside").exists()  # results of another equipment are not the project's


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("limt=8", "did you mean limit"),
        ("limit=13", "the nearest admissible value is 12"),
        ("limit=3", "the nearest admissible value is 4"),
        ("limit=true", "limit"),
        ("limit=9/2", "limit"),
    ],
)
def test_a_wrong_setting_is_refused_before_anything_runs(run: Run, setting: str, said: str) -> None:
    called = run("prove", "--set", setting)
    assert called.code == 2
    assert said in called.err
    assert "PROVED" not in called.err


def test_a_configured_setting_holds(run: Run, project: Path) -> None:
    put(project, "pyproject.toml", "[tool.rightside]\nsettings = {limit = 11}\ntimeout = 20\njobs = 1\n")
    run("prove", "-q", "-k", "five", "--json", "out.json")
    assert document(project / "out.json")["claims"][0]["parameters"][0]["value"] == 11


BAD_MODEL = """
    from safety import U4, Model
    class Bad(Model, tick_s="1"):
        n: U4
        def step(self) -> "Bad":
            return Bad(n=self.n)
    Bad(n=0)
"""


@pytest.mark.parametrize(
    ("text", "place", "said"),
    [
        ("def x(:\n", "proofs/bad.py:1", "SyntaxError"),
        ("import os\nfrom models.counter import Countr\n", "proofs/bad.py:2", "Countr"),
        ("x = 1 / 0\n", "proofs/bad.py:1", "division by zero"),
        ("import sys\nsys.exit(3)\n", "proofs/bad.py:2", "ends the program"),
        ("from models.bad import Bad\n", "models/bad.py:6", "has no power-up value"),
        (claim("bad", "return s.alrm"), "proofs/bad.py:8", "did you mean alarm"),
        (claim("bad", "return s.n + 'x'"), "proofs/bad.py:8", ""),
        (claim("bad", "return s.n"), "proofs/bad.py:5", "a claim returns a Bit"),
    ],
)
def test_a_bad_file_is_named_with_its_line_and_the_others_count(
    run: Run, project: Path, text: str, place: str, said: str
) -> None:
    put(project, "models/bad.py", BAD_MODEL)
    put(project, "proofs/bad.py", text)
    called = run("prove", "-q", "-k", "five or bad", "--json", "out.json")
    assert called.code == 2
    assert f"x {place}: " in called.err and said in called.err
    assert "Traceback" not in called.err
    results = document(project / "out.json")
    assert [entry["id"] for entry in results["claims"]] == ["counter.five_is_far"]
    assert place in results["limits"][0]


def test_the_whole_way_to_an_error_is_shown_when_asked_for(run: Run, project: Path) -> None:
    put(project, "proofs/bad.py", "x = 1 / 0\n")
    assert "Traceback" in run("prove", "-k", "five", "--traceback").err


def test_an_id_that_is_taken_twice_is_refused(run: Run, project: Path) -> None:
    put(project, "proofs/sub/counter.py", claim("five_is_far", "return s.alarm"))
    called = run("prove", "-q")
    assert called.code == 2
    assert "two claims are called 'counter.five_is_far'" in called.err


def test_what_a_proof_file_prints_does_not_get_into_the_data(run: Run, project: Path) -> None:
    path = put(project, "proofs/other.py", claim("one", 'print("hello"); return s.n <= 15'))
    path.write_text(path.read_text() + 'print("hello")\n')
    called = run("prove", "-q", "-k", "other", "--json", "-")
    assert called.code == 0
    assert called.out.startswith("{") and "hello" not in called.out


def test_a_place_that_cannot_be_written_is_refused_before_the_work(run: Run, project: Path) -> None:
    (project / "file").write_text("")
    called = run("prove", "--json", "file/out.json")
    assert called.code == 2
    assert "cannot be written" in called.err
    assert "PROVED" not in called.err


@pytest.mark.parametrize("place", ["/proc/nope", "file"])
def test_a_folder_for_waveforms_that_cannot_be_written_is_refused_before_the_work(
    run: Run, project: Path, place: str
) -> None:
    (project / "file").write_text("")
    called = run("prove", "-k", "five", "--vcd", place, "--json", "out.json")
    assert called.code == 2
    assert f"{place}/*.vcd cannot be written" in called.err
    assert "BOUNDED" not in called.err


def test_an_error_in_the_middle_of_the_work_keeps_the_results_so_far(
    run: Run, project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(path: Path, text: str) -> None:
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr("safety.commands.session.write", full)
    called = run("prove", "-q", "-j", "1", "--vcd", "waves", "--json", "out.json")
    assert called.code == 2
    assert called.err.splitlines()[-1].endswith("No space left on device")
    assert "2 of 4 have a result, which is kept" in called.err
    for place in ("out.json", ".rightside/last.json"):
        results = document(project / place)
        assert [entry["id"] for entry in results["claims"]] == [
            "counter.alarm_at_twelve",
            "counter.alarm_at_twelve_with_a_fault",
        ]
        assert results["interrupted"]


def test_an_error_while_the_end_is_shown_keeps_the_results(
    run: Run, project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("safety.report.terminal.summary", lambda results: 1 / 0)
    called = run("prove", "-q", "-k", "five", "--json", "out.json")
    assert called.code == 70
    for place in ("out.json", ".rightside/last.json"):
        assert len(document(project / place)["claims"]) == 1


def test_a_full_disk_ends_with_2_and_leaves_no_part(run: Run, project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (project / "out.json").write_text("old")

    def full(path: str, *_: object) -> None:
        raise OSError(28, "No space left on device", path)

    monkeypatch.setattr("os.replace", full)
    called = run("prove", "-q", "-k", "five", "--json", "out.json")
    assert called.code == 2
    assert "No space left on device" in called.err
    assert (project / "out.json").read_text() == "old"
    assert [path.name for path in project.iterdir() if path.suffix not in ("", ".json", ".toml")] == []


def test_a_counterexample_as_a_waveform(run: Run, project: Path) -> None:
    run("prove", "-q", "-k", "with_a_fault", "--vcd", "waves")
    assert "$var wire 1" in (project / "waves/counter.alarm_at_twelve_with_a_fault.vcd").read_text()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_keeps_what_is_there_and_ends_the_workers(project: Path, number: signal.Signals) -> None:
    put(project, "proofs/slow.py", claim("one", 'open(f"busy-{os.getpid()}", "w"); time.sleep(600); return s.alarm'))
    start = "import sys; from safety.commands import main; sys.exit(main())"
    words = ["prove", "-q", "-j", "2", "-k", "slow or five", "--json", "out.json"]
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[2])}
    command = subprocess.Popen(
        [sys.executable, "-c", start, *words], cwd=project, env=environment, stderr=subprocess.PIPE, text=True
    )
    assert command.stderr is not None
    while not list(project.glob("busy-*")):
        assert command.poll() is None
        time.sleep(0.01)
    while "five" not in command.stderr.readline():
        assert command.poll() is None
    command.send_signal(number)
    _, told = command.communicate(timeout=120)  # the worker would take 600 s
    assert command.returncode == 130
    assert "1 of 2 have no result" in told
    for place in ("out.json", ".rightside/last.json"):
        results = document(project / place)
        assert ([entry["id"] for entry in results["claims"]], results["interrupted"]) == (["counter.five_is_far"], True)
    worker = int(next(project.glob("busy-*")).name.removeprefix("busy-"))
    with pytest.raises(ProcessLookupError):
        os.kill(worker, 0)
