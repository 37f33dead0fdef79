"""Closure through the commands: verdicts of the same run, of an earlier one, and none of another text."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from tests.commands.conftest import CAMPAIGN, Run, document, put

HEAD = "from safety.inject import"
CLOSED = CAMPAIGN.replace(HEAD, f"from proofs.counter_hazard import no_alarm\n    {HEAD}")
CLOSED = CLOSED.replace("measured=20,", "measured=20, proofs=[no_alarm],")
CLOSED = CLOSED.replace(
    'observe={"alarm": "alarm"}', 'observe={"quiet": lambda wires: (wires["n"] >= 12) & ~wires["alarm"]}'
)
CLOSED = CLOSED.replace('seen.total("alarm") < seen.healthy("alarm")', 'seen.ever("quiet")')
CLOSED = CLOSED.replace('seen.total("alarm") > seen.healthy("alarm")', 'seen.total("quiet") < 0')


def closure(project: Path) -> Any:
    (entry,) = document(project / "out.json")["campaigns"]
    return entry["closure"]


def test_an_unchanged_project_keeps_its_proofs(run: Run, whole: Path) -> None:
    put(whole, "proofs/counter_campaign.py", CLOSED)
    assert run("inject", "--json", "out.json").code == 0
    assert closure(whole)["open"] == ["counter_hazard.no_alarm: not proved in these results"]
    assert run("verify", "--json", "out.json").code == 0
    found = closure(whole)
    assert found["open"] == [] and found["contradictions"] == []
    covered = {row["id"] for row in found["faults"] if row["by"]}
    assert covered == {"alarm.out stuck-at-0", "seen stuck-at-0"}
    assert found["parts"]["proved"]["faults"] == 1  # a stuck pulse counts nothing, so there is nothing to warn of
    called = run("inject", "--json", "out.json")
    assert called.code == 0 and closure(whole)["parts"]["proved"]["faults"] == 1
    assert "single faults by what settles them: 1 proved, 3 simulated, 0 sampled" in called.err
    path = whole / "proofs/counter.py"
    path.write_text(path.read_text() + "# another text\n")
    assert run("inject", "--json", "out.json").code == 0
    assert closure(whole)["parts"]["proved"]["faults"] == 0
