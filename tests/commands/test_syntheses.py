"""The weakest safe parameters through the commands: prove, list, verify, the report and what is kept."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.commands.conftest import Run, document, put

SYNTHESES = '''
    """Pulse counter: how late the alarm may be."""
    from fractions import Fraction
    from models.counter import Counter
    from safety import Bit, Scenario, Seen, implies
    from safety.prove.bounds import Bound, between, reals
    from safety.prove.weakest import BELOW, weakest, weakest_real

    @weakest(Counter, "limit", safe=BELOW, within=(4, 12), unit="pulse", requirement="C-3", source="[A] limits",
             at={"pulses": "nine"}, scenarios=[Scenario(16, {"pulse": True})])
    def alarm_at_nine(s: Seen) -> Bit:
        """From nine pulses on there is an alarm."""
        return implies(s.n >= 9, s.alarm)

    (x,) = reals("x")
    area = Bound("area", "Area", x * x, (between(0, x, 3),), unit="m2")
    weakest_real(area, 2, x, safe=BELOW, within=(0, 3), gap=Fraction(1, 100), id="late.side")
'''


@pytest.fixture
def late(project: Path) -> Path:
    (project / "proofs/counter.py").unlink()
    put(project, "proofs/late.py", SYNTHESES)
    return project


def test_prove_finds_both_ends_and_keeps_them(run: Run, late: Path) -> None:
    called = run("prove", "--json", "out.json")
    assert called.code == 0, called.err
    assert "FOUND     late.alarm_at_nine  limit: proved up to 9, refuted at 10 pulse" in called.err
    real, whole = document(late / "out.json")["syntheses"]
    assert (whole["safe_from"], whole["refuted_at"], whole["exact"], whole["model"]) == (9, 10, True, "Counter")
    assert whole["proof"]["agreed_by"] == ["z3", "cvc5"]
    assert whole["counterexample"]["violated_at"] == 9
    assert real["safe_from"]["value"] ** 2 <= 2 < real["refuted_at"]["value"] ** 2
    again = run("prove", "--json", "again.json")
    assert again.code == 0 and "2 of 2 results are of an earlier run" in again.err
    assert [e["cached"] for e in document(late / "again.json")["syntheses"]] == [True, True]


def test_list_names_them(run: Run, late: Path) -> None:
    lines = run("list", "syntheses", "--req", "C-3").out.splitlines()[1:]
    assert [line.split()[:3] for line in lines] == [["synthesis", "late.alarm_at_nine", "Counter"]]


def test_what_is_not_near_enough_ends_with_4_and_what_is_nowhere_safe_with_1(run: Run, late: Path) -> None:
    put(late, "proofs/late.py", SYNTHESES.replace("Scenario(16", "Scenario(5"))
    called = run("prove", "-k", "nine")
    assert called.code == 4 and "no value is refuted; no run breaks it at 10 or at 12" in called.err
    put(late, "proofs/late.py", SYNTHESES.replace("within=(4, 12)", "within=(11, 12)"))
    called = run("prove", "-k", "nine")
    assert called.code == 1 and "no value is safe: 11 is not" in called.err


def test_an_error_stands_at_its_line(run: Run, late: Path) -> None:
    put(late, "proofs/late.py", SYNTHESES.replace('"limit", safe', '"limt", safe'))
    called = run("prove", "-k", "nine")
    assert called.code == 2 and "proofs/late.py:8: late.alarm_at_nine:" in called.err
    assert "did you mean limit" in called.err


def test_verify_puts_them_into_the_report(run: Run, late: Path) -> None:
    assert run("verify").code == 0
    page = (late / "reports/index.html").read_text(encoding="utf-8")
    assert '<h2 id="syntheses">Weakest safe parameters</h2>' in page
    row = page[page.index('id="syntheses-Counter-late.alarm_at_nine"') :]
    row = row[: row.index("</tr>")]
    for text in ("From nine pulses on there is an alarm.", "[A]", "pulses nine", "up to a value", ">exact<", "C-3"):
        assert text in row
    assert run("report", "--check").code == 0


def test_replay_runs_it_at_the_refuted_value(run: Run, late: Path) -> None:
    assert run("replay", "late.alarm_at_nine").code == 2
    run("prove", "-k", "late")
    called = run("replay", "late.alarm_at_nine")
    assert called.code == 0 and "reproduced: late.alarm_at_nine with limit 10 is false at step 9" in called.err
    assert run("replay", "late.side").code == 2
    put(late, "proofs/late.py", SYNTHESES.replace("implies(s.n >= 9", "implies(s.n >= 10"))
    called = run("replay", "late.alarm_at_nine")
    assert called.code == 1 and "NOT reproduced" in called.err


def test_what_is_looked_for_cannot_be_set(run: Run, late: Path) -> None:
    called = run("prove", "-k", "nine", "--set", "limit=20")
    assert called.code == 2 and "4..12" in called.err
    called = run("prove", "-k", "nine", "--set", "limit=12")
    assert called.code == 2
    assert "proofs/late.py:8: late.alarm_at_nine: limit = 12 is set, but it is left open here" in called.err


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("within=(4, 12)", "within=(4, 15)", "within=(4, 15), but limit lies in 4..12"),
        ("within=(4, 12)", "given=lambda s: s.limit <= 6, within=(4, 12)", "what is given leaves out limit 12"),
        ("within=(4, 12)", 'settings={"limit": 5}, within=(4, 12)', "limit = 5 is set, but it is left open here"),
    ],
)
def test_a_search_that_would_mislead_is_refused_at_its_line(
    run: Run, late: Path, old: str, new: str, words: str
) -> None:
    put(late, "proofs/late.py", SYNTHESES.replace(old, new))
    called = run("prove", "-k", "nine")
    assert called.code == 2 and "proofs/late.py:8: late.alarm_at_nine:" in called.err
    assert words in called.err
