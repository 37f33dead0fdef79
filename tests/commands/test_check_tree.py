"""`rightside check` on certificates of fault trees, which are JSON where those of proofs are zip files."""

import json
from pathlib import Path

import pytest

from safety.trees import BasicEvent, FaultTree, Gate, solve
from safety.trees.certificate import write
from tests.commands.conftest import Run

TREE = FaultTree("pair", "top", (Gate("top", "and", ("a", "b")),), (BasicEvent("a", "0.5"), BasicEvent("b", "0.25")))


@pytest.fixture
def certificate(tmp_path: Path) -> Path:
    write(solve(TREE), tmp_path / "pair.json")
    return tmp_path / "pair.json"


def test_a_tree_is_checked_and_what_it_certifies_is_said(run: Run, certificate: Path) -> None:
    called = run("check", str(certificate), "--json", "-")
    assert called.code == 0
    assert "pair: fault tree, 1 minimal cut set" in called.err
    assert called.err.rstrip().endswith("pair.json: checked")
    (report,) = json.loads(called.out)["certificates"]
    assert report["verdict"] == "checked" and report["cut_sets_by_order"] == [0, 0, 1]
    assert report["probability"][0] <= 0.125 <= report["probability"][1]


def test_a_forged_one_is_rejected(run: Run, certificate: Path) -> None:
    document = json.loads(certificate.read_text())
    certificate.write_text(json.dumps(document | {"cut_sets_by_order": [0, 1, 1]}))
    called = run("check", str(certificate))
    assert called.code == 1
    assert "rejected: the minimal cut sets by order are [0, 0, 1]" in called.err


def test_json_of_another_sort_and_a_missing_file_are_no_certificates(run: Run, tmp_path: Path) -> None:
    (tmp_path / "other.json").write_text('{"format": "something else"}')
    assert run("check", str(tmp_path / "other.json")).code == 2
    assert run("check", str(tmp_path / "absent.json")).code == 2


def test_against_is_for_claims_only(run: Run, certificate: Path) -> None:
    called = run("check", str(certificate), "--against")
    assert called.code == 2 and "--against is for claims of the project" in called.err
