"""Claims of bounds through the commands: prove, verify, list, replay, the report and the pytest plug-in."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.commands.conftest import Run, document, put, with_plug_in

BOUNDS = '''
    """Pulse counter: how far it runs on."""
    from fractions import Fraction
    from safety import PROVED, REFUTED
    from safety.prove.bounds import Bound, between, claim_bound, claim_bracket, reals

    v, t = reals("v t")
    way = Bound("slide.way", "Way run before the stop", v * t, (between(0, v, 25), between(0, t, Fraction(1, 3))),
                unit="m", requirement="B-1", source="[P] table 2")
    kept = claim_bound(way, LIMIT, expect=PROVED)
    claim_bound(way, Fraction(25, 3), strict=True, id="slide.less", expect=REFUTED, twin_of=kept)
    claim_bracket(way, id="slide.least")
'''
KEYS = {
    "id", "model", "requirement", "source", "statement", "role", "expect", "verdict", "as_expected", "strength",
    "faults", "method", "user_lemmas", "seconds", "certificate", "agreed_by", "counterexample",
}  # fmt: skip


@pytest.fixture
def slide(project: Path) -> Path:
    put(project, "proofs/slide.py", BOUNDS.replace("LIMIT", "Fraction(25, 3)"))
    return project


def by_id(path: Path) -> dict[str, Any]:
    return {entry["id"]: entry for entry in document(path)["claims"]}


def test_prove_shows_verdicts_points_and_brackets_and_writes_the_keys(run: Run, slide: Path) -> None:
    called = run("prove", "-k", "slide", "--json", "out.json")
    assert called.code == 0, called.err
    found = by_id(slide / "out.json")
    assert {id_: entry["verdict"] for id_, entry in found.items()} == {
        "slide.way": "proved", "slide.less": "refuted", "slide.least": "proved",
    }  # fmt: skip
    assert [KEYS - entry.keys() for entry in found.values()] == [set()] * 3
    assert {entry["model"] for entry in found.values()} == {None}
    assert found["slide.least"]["bracket"]["low"]["exact"] == found["slide.least"]["bracket"]["high"]["exact"] == "25/3"
    for text in ("agreed by z3 nlsat, exact boxes", "[25/3 = 8.33333, 25/3 = 8.33333] m", "exceeded  25/3 = 8.33333"):
        assert text in called.err
    assert "v         25\n" in called.err and "t         1/3\n" in called.err


def test_a_bound_that_does_not_hold_ends_with_1_and_a_twin_that_holds_too(run: Run, slide: Path) -> None:
    put(slide, "proofs/slide.py", BOUNDS.replace("LIMIT", "8"))
    called = run("prove", "-q", "-k", "slide.way")
    assert called.code == 1 and "x REFUTED" in called.err and "refuted, expected proved" in called.err
    put(slide, "proofs/slide.py", BOUNDS.replace("LIMIT", "9").replace("strict=True", "strict=False"))
    called = run("prove", "-q", "-k", "slide.less")
    assert called.code == 1 and "must fail, but is proved" in called.err


def test_errors_of_the_file_stand_at_their_line(run: Run, slide: Path) -> None:
    put(slide, "proofs/slide.py", BOUNDS.replace("LIMIT", "0.5"))
    called = run("prove", "-k", "slide")
    assert called.code == 2 and "proofs/slide.py:9: slide.way: limit=0.5 is not exact" in called.err
    put(slide, "proofs/slide.py", BOUNDS.replace("LIMIT", "9").replace('"m", req', '"m", per=t, req'))
    called = run("prove", "-k", "slide.way")
    assert called.code == 2 and "proofs/slide.py:9: slide.way: per=t is not above zero" in called.err


def test_an_id_that_a_claim_about_a_model_has_is_refused(run: Run, slide: Path) -> None:
    put(slide, "proofs/slide.py", BOUNDS.replace("LIMIT", "9").replace("slide.least", "counter.alarm_at_twelve"))
    called = run("prove")
    assert called.code == 2 and "'counter.alarm_at_twelve'; give the bound another id" in called.err


def test_list_and_selection_by_requirement(run: Run, slide: Path) -> None:
    out = run("list", "claims", "--req", "B-1").out
    assert [line.split()[1] for line in out.splitlines()[1:]] == ["slide.way", "slide.less", "slide.least"]
    assert "Way run before the stop <= 25/3 m" in out and "Way run before the stop < 25/3 m" in out


def test_replay_computes_the_point_again(run: Run, slide: Path) -> None:
    assert run("replay", "slide.less").code == 2
    run("prove", "-q", "-k", "slide.less")
    called = run("replay", "slide.less")
    assert called.code == 0 and "reproduced: slide.less is broken at this point" in called.err
    assert called.out.split() == ["name", "value", "t", "1/3", "v", "25"]
    put(slide, "proofs/slide.py", BOUNDS.replace("LIMIT", "9").replace("strict=True", "strict=False"))
    called = run("replay", "slide.less")
    assert called.code == 1 and "NOT reproduced: slide.less is not broken at this point" in called.err


def test_verify_reports_them_and_a_second_run_takes_them_from_the_snapshot(run: Run, slide: Path) -> None:
    (slide / "proofs/counter.py").unlink()
    assert run("verify").code == 0
    page = (slide / "reports/index.html").read_text(encoding="utf-8")
    for text in ("Bounds over reals", "slide.least", "[25/3 = 8.33333, 25/3 = 8.33333] m", "v = 25", "of kind real"):
        assert text in page
    assert 'name="slide.less"' in (slide / "reports/junit.xml").read_text(encoding="utf-8")
    again = run("verify", "--recheck", "1")
    assert again.code == 0 and "results are of an earlier run" in again.err
    lines = {line.split()[1]: line for line in again.err.splitlines() if line.startswith("  ")}
    assert all(lines[id_].endswith("cached") for id_ in ("slide.way", "slide.less", "slide.least"))
    assert run("report", "--check").code == 0
    put(slide, "proofs/slide.py", BOUNDS.replace("LIMIT", "8"))
    assert run("verify").code == 1  # nothing of the earlier run counts for a changed file
    story = (slide / "reports/junit.xml").read_text(encoding="utf-8")
    assert "refuted, expected proved" in story and "v = " in story and "rightside replay slide.way" in story


def test_mutants_are_judged_by_claims_about_models_alone(run: Run, slide: Path) -> None:
    assert run("prove", "--mutants", "-k", "slide").code == 5


def test_a_bound_has_no_model_to_export(run: Run, slide: Path) -> None:
    called = run("export", "slide.way", "--to", "slide.smt2")
    assert called.code == 2 and "slide.way is a bound over reals" in called.err


def test_the_plug_in_makes_them_items(slide: Path) -> None:
    done = with_plug_in(slide, "--rightside", "-v", "proofs/slide.py")
    assert done.returncode == 0 and "3 passed" in done.stdout, done.stdout + done.stderr
