"""What is worked out from a paper and does not stand in it is judged as well, and counted apart."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.commands.conftest import Run, document, put

FIGURES = '''
    """Pulse counter: what its paper prints, and what follows from it."""
    from safety.audit import Paper, derived

    paper = Paper("counter", "A pulse counter, 1960")
    ours = Paper("counter_ours", "Pulse counter: worked out from its paper", published=False)
    for each in (paper, ours):
        each.symbol("limit", "1", "pulses to the alarm", derived(8))
    paper.figure("limit", "8", "1", where="table 1", by="limit")
    ours.figure("twice", "16", "1", where="here", by="2*limit")
    ours.statement("few", "at most 10 pulses", where="here", holds="limit <= 10")
'''


@pytest.fixture
def figures(project: Path) -> Path:
    return put(project, "proofs/figures.py", FIGURES)


def test_it_is_counted_apart(run: Run, figures: Path) -> None:
    called = run("audit", "--json", "out.json")
    assert called.code == 0, called.err
    assert called.out.splitlines()[-2:] == ["1 confirmed", "worked out here, not in print: 2 confirmed"]
    marks = {each["id"]: each.get("published") for each in document(figures.parents[1] / "out.json")["figures"]}
    assert marks == {"counter.limit": None, "counter_ours.twice": False, "counter_ours.few": False}


def test_the_report_counts_what_is_printed_and_marks_the_rest(run: Run, figures: Path) -> None:
    assert run("audit", "--json", "out.json").code == 0
    called = run("report", "--from", "out.json", "--to", "page")
    assert called.code == 0, called.err
    page = (figures.parents[1] / "page/index.html").read_text(encoding="utf-8")
    assert '<b>1</b><span><a href="#figures">printed figures</a> recomputed: 0 misprint, 0 inconsistent' in page
    assert "<b>1</b> confirmed. Another <b>2</b> stand in no source" in " ".join(page.split())
    assert page.count("not in print") == 2
