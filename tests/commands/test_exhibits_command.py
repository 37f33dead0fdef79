"""Tables and plots on the command line: listed, made with the rest, kept, and at fault where their file is."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.commands.conftest import Run, document, put

TABLES = '''
    """Pulse counter: tables and plots."""
    from models.counter import Counter
    from safety import run
    from safety.exhibits import Axis, Column, Curve, plot, table

    def alarm(pulses):
        return bool(run(Counter, {"pulse": True}, pulses + 1)["alarm"][-1])

    @table(id="counter.alarms", title="Alarms", source="[D]", requirement="C-1",
           columns=[Column("pulses"), Column("alarm")], says_no=["7: alarm"])
    def alarms():
        for pulses in (7, 8):
            yield pulses, alarm(pulses)

    @plot(id="counter.counts", title="Counts", source="[D]", x=Axis("pulses"), y=Axis("count"),
          assumed=["[A] none lost"])
    def counts():
        yield Curve("count", [(n, n) for n in range(4)])
'''


@pytest.fixture
def exhibits(project: Path) -> Path:
    return put(project, "proofs/tables.py", TABLES)


def test_they_are_listed(run: Run, exhibits: Path) -> None:
    rows = [line.split() for line in run("list", "exhibits").out.splitlines()[1:]]
    assert rows == [
        ["exhibit", "counter.alarms", "-", "C-1", "-", "Alarms"],
        ["exhibit", "counter.counts", "-", "-", "-", "Counts"],
    ]
    assert "exhibit" in run("list").out


def test_verify_makes_them_and_the_report_stays_true(run: Run, project: Path, exhibits: Path) -> None:
    called = run("verify", "--json", "out.json")
    assert called.code == 0, called.err
    assert "table of 2 rows" in called.err and "plot [A]" in called.err
    table, plot = document(project / "out.json")["exhibits"]
    assert [row[1] for row in table["rows"]] == [False, True] and plot["marks"][0]["label"] == "count"
    assert (project / "reports/plots/counter.counts.svg").is_file()
    assert run("report", "--check").code == 0
    again = run("verify", "--json", "out.json")
    assert again.code == 0 and all(one["cached"] for one in document(project / "out.json")["exhibits"])


def test_a_table_that_says_otherwise_fails(run: Run, project: Path, exhibits: Path) -> None:
    put(project, "proofs/tables.py", TABLES.replace("7: alarm", "8: alarm"))
    called = run("verify", "-k", "alarms", "--to", "part")
    assert called.code == 1 and "no in 7: alarm; expected in 8: alarm" in called.err


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("yield pulses, alarm(pulses)", "yield pulses,", "proofs/tables.py:.*a row of 1 cells"),
        ("yield pulses, alarm(pulses)", "yield pulses, nothing", "proofs/tables.py:13: .*NameError"),
        ("columns=[Column", "columns=[] and [Column", "proofs/tables.py:.* has no columns"),
    ],
)
def test_an_error_is_named_at_its_line(run: Run, project: Path, exhibits: Path, old: str, new: str, said: str) -> None:
    put(project, "proofs/tables.py", TABLES.replace(old, new))
    called = run("verify")
    assert called.code == 2 and re.search(said, called.err), called.err
