"""`rightside check`: the table, the report, the exit code, and the comparison with the project."""

import json
from pathlib import Path

import pytest

from safety.prove import check
from safety.prove.certificate import write_certificate
from safety.prove.claims import registered
from safety.prove.problem import build_problem
from tests.commands.conftest import Run
from tests.prove.certified import changed, packed, unpacked

NAME = "counter.alarm_at_twelve"


@pytest.fixture
def certificate(run: Run, project: Path) -> Path:
    """That of a claim of the project."""
    assert run("list").code == 0
    (claim,) = (claim for claim in registered() if claim.id == NAME)
    return write_certificate(build_problem(claim), 1, project / "alarm.zip").path


def test_a_certificate_is_checked_obligation_by_obligation(run: Run, certificate: Path) -> None:
    called = run("check", str(certificate), "--json", "-")
    assert called.code == 0
    assert f"{NAME}: 'From twelve pulses on there is an alarm.'" in called.err
    assert "checked the property follows unsat unsat proof" in " ".join(called.err.split())
    assert called.err.rstrip().endswith("alarm.zip: checked")
    (report,) = json.loads(called.out)["certificates"]
    assert report["verdict"] == "checked" and len(report["obligations"]) == 2


def test_it_is_compared_with_the_claim_of_the_project(run: Run, project: Path, certificate: Path) -> None:
    assert run("check", str(certificate), "--against").code == 0
    model = project / "models/counter.py"
    model.write_text(model.read_text().replace("self.n >= self.limit", "self.n > self.limit"))
    assert run("check", str(certificate)).code == 0
    called = run("check", str(certificate), "--against")
    assert called.code == 1 and "another claim" in called.err
    model.write_text(model.read_text().replace("self.n < 15", "self.n < 14"))
    called = run("check", str(certificate), "--against")
    assert called.code == 1 and "another model" in called.err


def test_a_claim_that_the_project_does_not_have(run: Run, project: Path, certificate: Path) -> None:
    claims = project / "proofs/counter.py"
    claims.write_text(claims.read_text().replace("alarm_at_twelve", "alarm_at_noon"))
    called = run("check", str(certificate), "--against")
    assert called.code == 1 and "did you mean counter.alarm_at_noon" in called.err


def test_the_worst_file_gives_the_exit_code(run: Run, project: Path, certificate: Path) -> None:
    files = unpacked(certificate)
    weaker = packed({name: text for name, text in files.items() if name != "1.lrat"}, project / "weaker.zip")
    lying = packed(changed(files, depth=0), project / "lying.zip")
    assert run("check", str(certificate), str(weaker)).code == 4
    assert run("check", str(lying), str(weaker)).code == 2  # the obligations are those of another depth
    called = run("check", "no.zip", str(certificate))
    assert called.code == 2 and "not a certificate: no.zip: expected a zip of texts" in called.err


def test_what_is_shown_of_a_file_cannot_drive_a_terminal(run: Run, project: Path, certificate: Path) -> None:
    files = unpacked(certificate)
    said = json.loads(files[check.MAIN])["claim"] | {"id": "\x1b[2J"}
    called = run("check", str(packed(changed(files, claim=said), project / "rude.zip")))
    assert called.code == 2 and "\x1b" not in called.err and "printable" in called.err
