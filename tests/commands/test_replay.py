import shlex
from pathlib import Path

import pytest

from tests.commands.conftest import Run, document


def test_a_counterexample_comes_out_again_without_a_solver(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    run("prove", "-q", "-k", "with_a_fault")
    monkeypatch.setattr("safety.prove.solve.Solver.check", lambda self: pytest.fail("a solver was asked"))
    called = run("replay", "counter.alarm_at_twelve_with_a_fault")
    assert called.code == 0
    assert "reproduced: counter.alarm_at_twelve_with_a_fault is false at step 12" in called.err
    assert called.out.splitlines()[0].split()[0] == "step"


def test_a_scripted_counterexample_is_run_from_the_proof_file(run: Run, project: Path) -> None:
    path = project / "proofs/counter.py"
    script = 'scenario=Scenario(steps=20, inputs={"pulse": True}, present=["alarm.out stuck-at-0"])'
    text = path.read_text().replace("faults=alarm_stuck,", f"faults=alarm_stuck, {script},")
    path.write_text(text.replace("VACUOUS, Bit,", "VACUOUS, Bit, Scenario,"))
    run("prove", "-q", "-k", "fault", "--json", "out.json")
    assert document(project / "out.json")["claims"][0]["counterexample"]["stimulus"] is None
    assert run("replay", "counter.alarm_at_twelve_with_a_fault").code == 0
    path.write_text(path.read_text().replace('"pulse": True', '"pulse": False'))
    assert run("replay", "counter.alarm_at_twelve_with_a_fault").code == 1


def test_out_of_kept_results_as_json_and_waveform(run: Run, project: Path) -> None:
    run("prove", "-q", "--json", "out.json")
    (project / ".rightside/last.json").unlink()
    words = ["--from", "out.json", "--json", "run.json", "--vcd", "run.vcd", "--show", "n,claim.*"]
    assert run("replay", "counter.alarm_at_twelve_with_a_fault", *words).code == 0
    assert document(project / "run.json")["steps"] == 13
    assert "$enddefinitions" in (project / "run.vcd").read_text()


def test_a_mended_model_does_not_reproduce(run: Run, project: Path) -> None:
    run("prove", "-q")
    path = project / "models/counter.py"
    path.write_text(path.read_text().replace("alarm=point(", "alarm=(self.n >= 10) | point("))
    called = run("replay", "counter.alarm_at_twelve_with_a_fault")
    assert called.code == 1
    assert "NOT reproduced" in called.err


def test_a_cut_set_and_an_injection(run: Run, whole: Path) -> None:
    run("verify")
    called = run("replay", "counter_hazard.no_alarm#0", "--show", "n,alarm")
    assert (called.code, called.err.count("reproduced: ")) == (0, 1)
    assert "alarm.out stuck-at-0" in called.err
    assert run("replay", "counter_hazard.no_alarm::seen stuck-at-0").code == 1  # the count stands still: no hazard
    called = run("replay", "counter_stuck#2")
    assert called.code == 0
    assert "alarm.out stuck-at-0 is dangerous undetected" in called.err
    assert run("replay", "counter_stuck::seen stuck-at-1").code == 0


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("counter.alarm_at_twelv", "did you mean counter.alarm_at_twelve"),
        ("counter.alarm_at_twelve", "is proved: there is no run to show"),
        ("counter.nothing_said", "has no result yet"),
        ("counter_stuck", "write counter_stuck#0"),
        ("counter_stuck#99", "numbered 0 to 3"),
        ("counter_stuck::sen", "no injection 'sen'"),
        ("counter_stuck#x", "a number follows #"),
        ("counter_hazard.no_alarm", "`rightside tree -k counter_hazard.no_alarm` finds them"),
    ],
)
def test_replay_says_what_is_wrong(run: Run, whole: Path, name: str, said: str) -> None:
    run("prove", "-q", "-k", "alarm_at_twelve and not fault")
    called = run("replay", name)
    assert (called.code, called.out) == (2, "")
    assert said in called.err


def test_an_injection_is_shrunk_and_its_reproducer_replayed(run: Run, whole: Path) -> None:
    run("inject", "-k", "stuck")
    called = run("replay", "counter_stuck::alarm.out stuck-at-0", "--shrink", "--vcd", "least.vcd")
    assert called.code == 0, called.err
    assert "$enddefinitions" in (whole / "least.vcd").read_text()
    (line,) = [line for line in called.err.splitlines() if line.startswith("minimal reproducer")]
    words = shlex.split(line.partition("rightside ")[2])
    assert words == ["replay", "counter_stuck::alarm.out stuck-at-0, transient at 8 for 1"]
    again = run(*words)
    assert again.code == 0 and "is dangerous undetected; the results do not list it" in again.err


def test_an_injection_may_have_any_schedule(run: Run, whole: Path) -> None:
    called = run("replay", "counter_stuck::alarm.out stuck-at-0 from step 19 & seen stuck-at-1, transient at 2 for 3")
    assert called.code == 0, called.err
    assert "is dangerous undetected; there is no earlier result" in called.err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ["counter_stuck::alarm.out stuck-at-1", "--shrink"],
            "not dangerous and undetected: there is nothing to shrink",
        ),
        (["counter_hazard.no_alarm#0", "--shrink"], "--shrink is for an injection of a campaign"),
        (["counter_stuck::alarm.out stuck-at-0 from step 20"], "begins at step 20, outside the run (0 to 19)"),
        (["counter_stuck::alarm.out stuck-at-0, transient at 2 for 0"], "transient fault needs its greatest length"),
        (["counter_stuck::alarm.out stuck-at-0 for 3"], "no injection"),
    ],
)
def test_an_injection_that_cannot_be_is_refused(run: Run, whole: Path, words: list[str], said: str) -> None:
    called = run("replay", *words)
    assert (called.code, called.out) == (2, "")
    assert said in called.err
