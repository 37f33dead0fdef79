"""`rightside prove --certify`: a certificate of each proved claim, which `rightside check` accepts."""

import hashlib
import json
from pathlib import Path
from typing import Any

import pytest

from safety.commands.certify import certified
from safety.prove import certificate, check
from safety.prove.claims import BOUNDED, PROVED
from safety.prove.lrat import NoProof
from safety.prove.outcome import Outcome
from safety.prove.problem import build_problem
from safety.prove.solve import Disagreement
from safety.system import State
from safety.terms import real
from safety.terms.graph import BIT, REAL, variable
from tests.commands.conftest import Run
from tests.prove.certified import problem_of, unpacked
from tests.prove.small import asked, below_sixteen

NAME = "counter.alarm_at_twelve"


def claims(run: Run, *words: str) -> dict[str, Any]:
    assert run("prove", *words, "--json", "out.json").code == 0
    return {entry["id"]: entry["certificate"] for entry in json.loads(Path("out.json").read_text())["claims"]}


def test_each_proved_claim_has_a_certificate_that_is_checked(run: Run, project: Path) -> None:
    assert not any(claims(run).values())
    made = claims(run, "--certify", "made")
    path = project / f"made/{NAME}.cert.zip"
    assert [*(project / "made").iterdir()] == [path] and [name for name in made if made[name]] == [NAME]
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    assert made[NAME] == {"file": f"made/{NAME}.cert.zip", "sha256": digest, "kind": "bits", "complete": True}
    assert run("check", str(path), "--against").code == 0


def test_a_result_of_an_earlier_run_is_certified_and_does_not_keep_it(run: Run, project: Path) -> None:
    first = claims(run, "--certify", "made")
    (project / f"made/{NAME}.cert.zip").unlink()
    assert not any(claims(run).values())
    assert claims(run, "--certify", "made") == first
    assert (project / f"made/{NAME}.cert.zip").exists()


def test_a_folder_that_cannot_be_written_is_refused_before_the_work(run: Run, project: Path) -> None:
    (project / "file").write_text("")
    called = run("prove", "--certify", "file")
    assert called.code == 2 and "cannot be written" in called.err


SAID: list[str] = []


def made_of(problem: Any, folder: Path, method: str, verdict: str = PROVED) -> Any:
    outcome = Outcome(problem.claim, verdict, problem, method)
    return certified(outcome, folder, 20, SAID.append, SAID.append)


def counting(formula: Any = below_sixteen, **changes: Any) -> Any:
    return build_problem(asked(formula, **changes))


def test_what_is_no_induction_has_no_certificate(tmp_path: Path) -> None:
    SAID.clear()
    assert made_of(counting(), tmp_path, "closed form of 9 steps, 4 events sampled, integers") is None
    assert made_of(counting(), tmp_path, "bounded search of 9 steps", BOUNDED) is None
    assert len(SAID) == 1 and "its proof is no induction but a closed form of 9 steps" in SAID[0]
    assert not [*tmp_path.iterdir()]


def test_its_form_is_that_of_the_proof(tmp_path: Path) -> None:
    def arithmetic(method: str) -> Any:
        made = made_of(counting(), tmp_path, method)
        return json.loads(unpacked(Path(made["file"]))[check.MAIN])["arithmetic"]

    assert arithmetic("induction of depth 0, 3 found lemmas, bits") == "bits"
    assert arithmetic("induction of depth 0, no lemmas, integers") == "integers"
    assert arithmetic("induction of depth 0, 2 lemmas found by pdr") == "integers"


def test_a_proof_that_is_none_in_bits_is_a_disagreement(tmp_path: Path) -> None:
    with pytest.raises(Disagreement, match="not so in bits"):
        made_of(counting(lambda s: s.n < 15), tmp_path, "induction of depth 0, no lemmas, integers")


def test_a_proof_that_the_bits_do_not_reach_is_incomplete(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def late(clauses: Any, timeout: float) -> str:
        raise NoProof("not reached")

    monkeypatch.setattr(certificate, "refutation", late)
    made = made_of(counting(), tmp_path, "induction of depth 0, no lemmas, integers")
    assert (made["kind"], made["complete"]) == ("bits", False)


def test_reals_are_certified_by_two_solvers(tmp_path: Path) -> None:
    r: Any = variable("r", REAL)
    problem = problem_of([State(r, r * real("1/2"), real("1/3").attr)], [], r < 2, {"in range": (r >= 0) & (r < 1)})
    made = made_of(problem, tmp_path, "induction of depth 0, 1 lemmas, integers")
    assert (made["kind"], made["complete"]) == ("real", True)
    assert check.examine(Path(made["file"]))["verdict"] == check.REAL


def test_a_name_that_no_certificate_can_hold_is_said(tmp_path: Path) -> None:
    SAID.clear()
    x: Any = variable("x|y", BIT)
    assert (
        made_of(problem_of([State(x, x, False)], [], ~x), tmp_path, "induction of depth 0, no lemmas, integers") is None
    )
    assert "test.claim cannot be certified" in SAID[-1]
