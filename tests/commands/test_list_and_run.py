from pathlib import Path

import pytest

from tests.commands.conftest import Run, document, put


def test_list_names_everything_with_a_result(run: Run, whole: Path) -> None:
    called = run("list")
    assert called.code == 0
    rows = [line.split()[:2] for line in called.out.splitlines()[1:]]
    assert rows == [
        ["claim", "counter.alarm_at_twelve"],
        ["claim", "counter.alarm_at_twelve_with_a_fault"],
        ["claim", "counter.five_is_far"],
        ["claim", "counter.nothing_said"],
        ["campaign", "counter_stuck"],
        ["hazard", "counter_hazard.no_alarm"],
        ["rate", "counter.life"],
    ]


def test_list_takes_a_selection_and_gives_json(run: Run, project: Path) -> None:
    run("list", "claims", "--req", "C-2", "--json", "list.json")
    rows = document(project / "list.json")["claims"]
    assert [(row["id"], row["expect"], row["requirement"]) for row in rows] == [
        ("counter.five_is_far", "bounded", "C-2")
    ]


def test_list_models_shows_parameters_with_unit_range_and_source(run: Run) -> None:
    rows = [line.split("  ") for line in run("list", "models").out.splitlines()]
    assert [cell.strip() for cell in rows[2] if cell] == [
        "counter.Counter", "limit", "8", "pulse", "4..12", "[P] table 1",
    ]  # fmt: skip


def test_list_points(run: Run) -> None:
    called = run("list", "points", "Counter")
    assert [line.split() for line in called.out.splitlines()[1:]] == [
        ["seen", "bit"],
        ["n.next", "u4"],
        ["alarm.out", "bit"],
    ]


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["points"], 2, "list points MODEL"),
        (["points", "Conter"], 2, "did you mean Counter"),
        (["claims", "Counter"], 2, "list points MODEL"),
        (["rates"], 5, "nothing to list"),
    ],
)
def test_list_says_what_is_wrong(run: Run, words: list[str], code: int, said: str) -> None:
    called = run("list", *words)
    assert (called.code, called.out) == (code, "")
    assert said in called.err


def test_a_broken_model_file_is_named_beside_the_list(run: Run, project: Path) -> None:
    put(project, "models/broken.py", "x = nothing\n")
    called = run("list", "models")
    assert called.code == 2
    assert "models/broken.py:1" in called.err
    assert "counter.Counter" in called.out


def test_run_shows_changes_and_names_what_stays(run: Run) -> None:
    called = run("run", "Counter", "pulse=1", "--steps", "3")
    assert called.code == 0
    assert [line.split() for line in called.out.splitlines()] == [
        ["step", "n", "n.next"], ["0", "0", "1"], ["1", "1", "2"], ["2", "2", "3"],
    ]  # fmt: skip
    assert "pulse=1" in called.err


def test_run_takes_a_pattern_for_inputs_and_the_later_value_wins(run: Run) -> None:
    assert (
        run("run", "Counter", "p*=0", "pulse=1", "--steps", "2").out
        == run("run", "Counter", "pulse=1", "--steps", "2").out
    )
    still = run("run", "Counter", "pulse=1", "p*=0", "--steps", "2", "--show", "pulse")
    assert [line.split() for line in still.out.splitlines()] == [["step", "pulse"], ["0", "0"]]


def test_run_takes_inputs_after_options_and_between_them(run: Run) -> None:
    called = run("run", "Counter", "pulse=1", "--steps", "3")
    for words in (["--steps", "3", "Counter", "pulse=1"], ["Counter", "--steps", "3", "pulse=1"],
                  ["Counter", "pulse=0", "--steps", "3", "pulse=1"]):  # fmt: skip
        assert (run("run", *words).code, run("run", *words).out) == (0, called.out)


def test_run_with_an_unknown_option_says_where_to_look(run: Run) -> None:
    called = run("run", "Counter", "--stps", "3", "pulse=1")
    assert called.code == 2
    assert "unrecognized arguments: --stps" in called.err and "`rightside run --help`" in called.err


def test_run_refuses_a_name_of_several_models_and_takes_the_full_one(run: Run, project: Path) -> None:
    put(project, "models/other.py", (project / "models/counter.py").read_text())
    called = run("run", "Counter", "pulse=1")
    assert (called.code, called.out) == (2, "")
    assert "counter.Counter, other.Counter; give one of these names" in called.err
    for name in ("other.Counter", "models.counter.Counter"):
        assert run("run", name, "pulse=1").code == 0


def test_run_takes_rows_settings_and_faults(run: Run, project: Path) -> None:
    put(project, "rows.csv", "pulse\n" + "1\ntrue\n0\n1\n1\n1\n1\n1\n")
    words = ["--csv", "rows.csv", "--set", "limit=4", "--fault", "stuck(0)@seen:1+1", "--fault", "stuck(0)@alarm.out:7"]
    run("run", "counter.Counter", *words, "--show", "n,alarm", "--json", "run.json")
    signals = {s["path"]: s for s in document(project / "run.json")["signals"]}
    assert document(project / "run.json")["steps"] == 8
    text = run("run", "Counter", *words, "--show", "n,alarm").out
    last = [line.split() for line in text.splitlines()][1:]
    assert [row[1] for row in last] == ["0", "1", "2", "3", "4", "5"]
    assert [row[2] for row in last] == ["0", ".", ".", ".", "1", "0"]
    assert set(signals) == {"n", "alarm"}


def test_run_writes_a_waveform(run: Run, project: Path) -> None:
    assert run("run", "Counter", "pulse=1", "--vcd", "waves/run.vcd").code == 0
    assert "$enddefinitions" in (project / "waves/run.vcd").read_text()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["Conter"], "did you mean Counter"),
        (["Counter"], "needs the input pulse (bit); write pulse=VALUE"),
        (["Counter", "pulse=2"], "pulse is bit: '2'"),
        (["Counter", "puls=1"], "did you mean pulse"),
        (["Counter", "q*=1"], "no input that fits 'q*'; it has pulse"),
        (["Counter", "pulse"], "NAME=VALUE"),
        (["Counter", "pulse=1", "--steps", "0"], "one step or more"),
        (["Counter", "pulse=1", "--csv", "none.csv"], "none.csv"),
        (["Counter", "--csv", "rows.csv", "--steps", "9"], "has 2 rows"),
        (["Counter", "--csv", "bad.csv"], "bad.csv:3: pulse is bit"),
        (["Counter", "--csv", "ragged.csv"], "ragged.csv:2"),
        (["Counter", "--csv", "empty.csv"], "has no rows"),
        (["Counter", "pulse=1", "--set", "limit=99"], "nearest admissible value is 12"),
        (["Counter", "pulse=1", "--show", "m"], "no such signal"),
        (["Counter", "pulse=1", "--start", "n=3"], "n"),
        (["Counter", "pulse=1", "--start", "m=3"], "there is n"),
        (["Counter", "pulse=1", "--fault", "stuck"], "KIND@POINT"),
        (["Counter", "pulse=1", "--fault", "stick(0)@seen"], "did you mean stuck"),
        (["Counter", "pulse=1", "--fault", "stuck(2)@seen"], "stuck(2)"),
        (["Counter", "pulse=1", "--fault", "stuck(0)@sen"], "did you mean seen"),
        (["Counter", "pulse=1", "--fault", "__import__('os')@seen"], "no kind '__import__'"),
        (["Counter", "pulse=1", "--fault", "stuck(open('x'))@seen"], "no fault kind"),
        (["Counter", "pulse=1", "--fault", "flip(bit=1, at=2)@seen"], "unexpected keyword"),
    ],
)
def test_run_says_what_is_wrong(run: Run, project: Path, words: list[str], said: str) -> None:
    put(project, "rows.csv", "pulse\n1\n0\n")
    put(project, "bad.csv", "pulse\n1\nhigh\n")
    put(project, "ragged.csv", "pulse\n1,0\n")
    put(project, "empty.csv", "pulse\n")
    called = run("run", *words)
    assert (called.code, called.out) == (2, "")
    assert said in called.err
