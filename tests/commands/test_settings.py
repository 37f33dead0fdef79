"""Parameters on the command line and in pyproject.toml: who gets them, and what is refused, where it stands."""

from pathlib import Path

import pytest

from tests.commands.conftest import FILES, Run, document, put, with_plug_in

OTHER = '''
    """Another model, with a parameter of its own."""
    from __future__ import annotations
    from safety import U4, Bit, Model, parameter, power_up

    class Lamp(Model, tick_s="1/100"):
        """Lights for some steps."""
        lit: U4 = power_up(0)
        most: U4 = parameter(3, unit="step", within=(1, 9), source="[A]")
        def step(self) -> tuple[Lamp, Bit]:
            return Lamp(lit=(self.lit + 1).low(4)), self.lit < self.most
'''
VERBS = {
    "run": ("run", "Counter", "pulse=1", "--steps", "3"),
    "prove": ("prove", "-q"),
    "inject": ("inject",),
    "tree": ("tree",),
    "rate": ("rate",),
    "verify": ("verify", "--no-cache"),
    "export": ("export", "counter.alarm_at_twelve", "--format", "smtlib"),
    "replay": ("replay", "counter.alarm_at_twelve_with_a_fault"),
}


def configure(project: Path, *lines: str) -> None:
    put(project, "pyproject.toml", "\n".join(["[tool.rightside]", 'title = "x"', "[tool.rightside.settings]", *lines]))


@pytest.fixture
def both(whole: Path) -> Path:
    put(whole, "models/lamp.py", OTHER)
    return whole


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("limit = nan", "nan"),
        ("limit = -inf", "-inf"),
        ('limit = "8"', "8"),
        ("limit = 1e999999999", "1e999999999"),
        ("limit = [8]", "[8]"),
    ],
)
def test_what_is_no_value_is_refused_with_its_line(run: Run, project: Path, text: str, shown: str) -> None:
    configure(project, "# limits", text)
    called = run("run", "Counter", "pulse=1")
    assert called.code == 2 and called.out == ""
    assert f"pyproject.toml:5: setting limit = {shown!r} is no value; write a whole number" in called.err.replace(
        "[8]", "'[8]'"
    )


@pytest.mark.parametrize("verb", VERBS)
def test_a_name_that_no_model_has_is_refused_by_every_command(run: Run, both: Path, verb: str) -> None:
    configure(both, "limit = 8", "limt = 8")
    called = run(*VERBS[verb])
    assert called.code == 2
    assert "pyproject.toml:5: setting limt: no model of the project has a parameter 'limt'; did you mean limit" in (
        called.err
    )
    assert "--set" not in called.err and "PROVED" not in called.err


def test_pytest_refuses_it_too(both: Path) -> None:
    configure(both, "limt = 8")
    called = with_plug_in(both, "--rightside", "proofs")
    assert "pyproject.toml:4: setting limt: no model of the project" in called.stdout, called.stdout
    assert called.returncode == 2


@pytest.mark.parametrize("verb", ["run", "export", "verify"])
def test_a_setting_of_another_model_is_none_of_this_ones_business(run: Run, both: Path, verb: str) -> None:
    configure(both, "most = 5")
    called = run(*VERBS[verb])
    assert called.code == 0, called.err


def test_a_setting_goes_to_every_model_that_has_it(run: Run, both: Path) -> None:
    configure(both, "most = 2", "limit = 4")
    assert run("run", "Lamp", "--steps", "4", "--show", "out", "--json", "lamp.json").code == 0
    assert document(both / "lamp.json")["signals"][0]["changes"] == [[0, True], [2, False]]
    assert run("prove", "-q", "-k", "five", "--json", "out.json").code == 0
    assert document(both / "out.json")["claims"][0]["parameters"][0]["value"] == 4


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("limit = 13", "limit = 13 pulse lies outside 4..12 pulse; the nearest admissible value is 12 ([P] table 1)"),
        ("limit = 8.5", "limit = 17/2 pulse is no whole number; write one in 4..12 pulse, e.g. 8"),
        ("limit = true", "limit = True pulse is not a value of u4; write an exact number in 4..12 pulse"),
    ],
)
@pytest.mark.parametrize("verb", ["run", "prove", "inject", "tree", "export", "verify"])
def test_a_value_that_does_not_fit_is_refused_where_it_stands(
    run: Run, whole: Path, text: str, said: str, verb: str
) -> None:
    configure(whole, text)
    called = run(*VERBS[verb])
    assert called.code == 2 and f"pyproject.toml:4: setting limit: {said}" in called.err


@pytest.mark.parametrize("text", ["12.0", "0xc"])
def test_a_whole_number_in_any_exact_way(run: Run, project: Path, text: str) -> None:
    assert run("prove", "-q", "-k", "five", "--set", f"limit={text}", "--json", "out.json").code == 0
    assert document(project / "out.json")["claims"][0]["parameters"][0]["value"] == 12


@pytest.mark.parametrize("text", ["nan", "inf", "1/0", "1e999999999", "eight"])
def test_no_value_on_the_command_line(run: Run, text: str) -> None:
    called = run("prove", "--set", f"limit={text}")
    assert called.code == 2 and f"'{text}' is no value: write a whole number" in called.err


def test_the_command_line_has_to_fit_what_is_worked_on(run: Run, both: Path) -> None:
    called = run("prove", "--set", "most=5")
    assert called.code == 2 and "--set: Counter has no parameter 'most'" in called.err
    called = run("rate", "--set", "mots=5")
    assert (
        called.code == 2 and "--set: no model of the project has a parameter 'mots'; did you mean most?" in called.err
    )


# --- claims whose numbers follow from parameters ----------------------------------------------------------------------

NUMBERS = '''
    """Claims with numbers of their own."""
    from models.counter import Counter
    from safety import PROVED, REFUTED, Bit, Scenario, Seen, claim, implies, written_for

    written_for("numbers.*", but="numbers.free", limit=8)

    @claim(Counter, expect=PROVED)
    def at_eight(s: Seen) -> Bit:
        """The alarm comes with the eighth pulse."""
        return ~(s.alarm ^ (s.n >= 8))

    @claim(Counter, expect=PROVED, settings={"limit": 9})
    def at_nine(s: Seen) -> Bit:
        """With the limit 9 it comes with the ninth."""
        return ~(s.alarm ^ (s.n >= 9))

    @claim(Counter, expect=PROVED, symbolic=["limit"])
    def at_any(s: Seen) -> Bit:
        """It comes at the limit."""
        return ~(s.alarm ^ (s.n >= s.limit))

    @claim(Counter, expect=PROVED)
    def free(s: Seen) -> Bit:
        """From twelve on there is an alarm."""
        return implies(s.n >= 12, s.alarm)
'''


def verdicts(path: Path) -> dict[str, str]:
    return {entry["id"].partition(".")[2]: entry["verdict"] for entry in document(path)["claims"]}


@pytest.mark.parametrize("value", ["10", "9"])
def test_a_claim_is_not_judged_by_numbers_of_other_parameters(run: Run, project: Path, value: str) -> None:
    put(project, "proofs/numbers.py", NUMBERS)
    called = run("prove", "-q", "-k", "numbers", "--set", f"limit={value}", "--json", "out.json")
    assert called.code == 3
    assert verdicts(project / "out.json") == {
        "at_eight": "undecided", "at_nine": "proved", "at_any": "proved", "free": "proved",
    }  # fmt: skip
    assert f"its numbers are written for limit = 8; with limit = {value} it is not judged" in called.err
    assert run("export", "numbers.at_eight", "--format", "smtlib", "--set", f"limit={value}").code == 3


def test_its_own_parameters_judge_it(run: Run, project: Path) -> None:
    put(project, "proofs/numbers.py", NUMBERS)
    assert run("prove", "-q", "-k", "numbers", "--set", "limit=8.0", "--json", "out.json").code == 0
    assert set(verdicts(project / "out.json").values()) == {"proved"}


def test_without_that_word_the_claim_would_be_called_refuted(run: Run, project: Path) -> None:
    put(project, "proofs/numbers.py", NUMBERS.replace('written_for("', 'written_for("no_'))
    assert run("prove", "-q", "-k", "at_eight", "--set", "limit=10", "--json", "out.json").code == 1
    assert verdicts(project / "out.json") == {"at_eight": "refuted"}


def test_hazards_and_campaigns_are_not_judged_either(run: Run, whole: Path) -> None:
    for name, text in (("hazard", "no_alarm"), ("campaign", "Campaign(")):
        file = f"proofs/counter_{name}.py"
        put(whole, file, FILES[file] + '\n    from safety import written_for\n    written_for("counter_*", limit=8)\n')
        assert text in FILES[file]
    for verb in ("tree", "inject"):
        called = run(verb, "--set", "limit=10", "--json", "out.json")
        assert called.code == 3
        assert "its numbers are written for limit = 8; with limit = 10 it is not judged" in " ".join(called.err.split())
        assert run(verb, "--set", "limit=8").code == 0
