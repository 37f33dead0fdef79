"""Printed figures on the command line: listed, judged, reported, and at fault where their file is."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from tests.commands.conftest import Run, document, put

FIGURES = '''
    """Pulse counter: what its paper prints."""
    from safety.audit import Paper, assumed, derived, printed

    paper = Paper("counter", "A pulse counter, 1960")
    paper.symbol("pulse", "ms", "between two pulses", printed("10", exact=True))
    paper.symbol("limit", "1", "pulses to the alarm", derived(8))
    paper.symbol("load", "1", "slows the counter", assumed("0.1", "0", "0.2"))
    paper.symbol("T", "ms", "time to the alarm", by="limit*pulse")
    paper.symbol("seen", "s", "the same in table 2", printed("0.080"))
    paper.figure("time", "80", "ms", where="table 1", by="T")
    paper.figure("slip", "0.030", "s", where="text", by="T", also={"table 2": "seen"})
    paper.figure("slow", "88", "ms", where="text", by="T*(1 + load)")
    paper.equation("eq1", "T = pulse/limit", where="(1)")
    paper.decided("alarm", "an alarm at the limit", where="text", claim="counter.alarm_at_twelve")
'''
TITLE = "A pulse counter, 1960"


@pytest.fixture
def figures(project: Path) -> Path:
    return put(project, "proofs/figures.py", FIGURES)


def test_figures_are_listed(run: Run, figures: Path) -> None:
    rows = [line.split()[:2] for line in run("list", "figures").out.splitlines()[1:]]
    assert rows == [["figure", f"counter.{name}"] for name in ("time", "slip", "slow", "eq1", "alarm")]


def test_what_is_wrong_in_print_stands_first_and_fails_nothing(run: Run, figures: Path) -> None:
    called = run("audit", "--json", "out.json")
    assert called.code == 3, called.err  # the claim of counter.alarm was not run
    lines = called.out.splitlines()
    assert [line.split()[0] for line in lines[1:-2]] == [
        f"counter.{name}" for name in ("slip", "eq1", "slow", "time", "alarm")
    ]
    assert re.search(r"counter\.slip +0\.030 +0\.080 +s +misprint +one digit replaced", called.out)
    assert re.search(r"counter\.slow +88 +88 \[A\] +ms +assumed", called.out)
    assert lines[-2] == "1 misprint, 1 inconsistent, 1 assumed, 1 confirmed"
    assert lines[-1] == "1 not run: `rightside verify`, or `rightside prove -k counter.alarm_at_twelve`"
    assert re.search(r"NOT JUDGED +counter\.alarm +not run: .*prove -k", called.err)
    entries = {entry["id"]: entry for entry in document(figures.parents[1] / "out.json")["figures"]}
    slip = entries["counter.slip"]
    assert entries["counter.alarm"]["verdict"] is None
    assert entries["counter.time"]["value"] == {"value": 80.0, "exact": "80"}
    assert (slip["paper"], slip["printed"], slip["mended"], slip["how"]) == (TITLE, "0.030", "0.080", "T")
    assert slip["inputs"] == ["limit = 8 [D]", "pulse = 10 [P]"]


def test_the_verdict_of_a_claim_decides_words_once_it_is_there(run: Run, figures: Path) -> None:
    first = run("audit", "-k", "alarm")
    assert (first.code, "not run: `rightside verify`" in first.out) == (3, True)
    run("prove", "-k", "alarm_at_twelve and not fault")
    second = run("audit", "-k", "alarm")
    assert re.search(r"counter\.alarm .* confirmed", second.out) and second.code == 0
    assert re.search(r"CONFIRMED +counter\.alarm", second.err) and "NOT JUDGED" not in second.err
    run("verify", "-k", "alarm", "--json", "out.json", "--no-cache")
    (entry,) = document(figures.parents[1] / "out.json")["figures"]
    assert (entry["verdict"], entry["recomputed"]) == ("confirmed", "counter.alarm_at_twelve is proved")


def test_words_that_deny_a_claim_fall_with_its_proof(run: Run, figures: Path) -> None:
    put(figures.parents[1], "proofs/figures.py", FIGURES.replace('at_twelve")', 'at_twelve", denies=True)'))
    run("prove", "-k", "alarm_at_twelve and not fault")
    assert re.search(r"counter\.alarm .* inconsistent", run("audit", "-k", "counter.alarm").out)
    run("verify", "-k", "alarm", "--json", "out.json", "--no-cache")
    (entry,) = document(figures.parents[1] / "out.json")["figures"]
    assert (entry["verdict"], entry["denies"]) == ("inconsistent", True)


def test_one_paper_is_chosen_by_its_name(run: Run, figures: Path) -> None:
    other = FIGURES.replace('Paper("counter"', 'Paper("other"')
    put(figures.parents[1], "proofs/others.py", other)
    assert run("audit", "--paper", "other").out.count("other.") >= 5
    assert "counter." not in run("audit", "--paper", "other", "-k", "slip").out
    called = run("audit", "--paper", "third")
    assert (called.code, "there is counter, other" in called.err) == (2, True)


def test_json_goes_to_stdout_alone(run: Run, figures: Path) -> None:
    called = run("audit", "-k", "time", "--json", "-")
    assert called.out.startswith("{") and '"confirmed"' in called.out


def test_settings_of_models_are_refused(run: Run, figures: Path) -> None:
    called = run("audit", "--set", "limit=5")
    assert (called.code, "figures have none" in called.err) == (2, True)


def test_without_figures_nothing_is_selected(run: Run) -> None:
    assert run("audit").code == 5


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"80", "ms"', '"80 ms", "ms"', r"proofs/figures\.py:10: '80 ms' is no printed number"),
        ('by="T")', 'by="T + limit")', r"proofs/figures\.py:10: counter\.time: .*cannot be added"),
        ('by="T")', 'by="T/(limit - 8)")', r"proofs/figures\.py:10: counter\.time: .*cannot be evaluated"),
        ("counter.alarm_at_twelve", "counter.alarm_at_tea", r"there is no claim 'counter\.alarm_at_tea'"),
    ],
)
def test_a_figure_that_cannot_be_judged_is_an_error_at_its_line(
    run: Run, figures: Path, old: str, new: str, said: str
) -> None:
    figures.write_text(figures.read_text().replace(old, new))
    called = run("audit")
    assert called.code == 2
    assert re.search(said, called.err), called.err


def test_routes_that_disagree_end_with_their_own_code(run: Run, figures: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    figures.write_text(figures.read_text().replace("from safety", "from safety.audit import algebra\nfrom safety"))
    with figures.open("a") as file:
        file.write("\nalgebra.true_at = lambda each, at: True\n")
    monkeypatch.setattr("safety.audit.algebra.true_at", None)  # what the file puts there is gone after the test
    called = run("audit", "-k", "eq1", "--json", "out.json")
    assert called.code == 6, called.err
    (entry,) = document(figures.parents[1] / "out.json")["figures"]
    assert "but there it holds" in entry["disagreed_by"][0]


def test_the_report_has_them_by_paper_with_what_they_rest_on(run: Run, figures: Path) -> None:
    assert run("verify", "-k", "counter and not (alarm or five or nothing)", "--to", "made").code == 0
    folder = figures.parents[1] / "made"
    page = (folder / "index.html").read_text()
    assert f"<h3>{TITLE}</h3>" in page
    assert "recomputed: 1 misprint, 1 inconsistent" in page
    assert page.index('id="figures-counter.slip"') < page.index('id="figures-counter.time"')
    assert "speaks for it: table 2: seen = 0.0795 .. 0.0805" in page
    assert "misprint, printed 0.030 for 0.080" in page  # among the gaps
    assert 'title="rests on assumed inputs"' in page
    suite = next(each for each in ET.parse(folder / "junit.xml").getroot() if each.get("name") == "figures")
    assert (suite.get("tests"), suite.get("failures")) == ("4", "0")
    assert {case.get("classname") for case in suite} == {f"figures.{TITLE}"}
