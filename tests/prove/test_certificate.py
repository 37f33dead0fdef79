"""Certificates: what is written is checked anywhere, and nothing that was tampered with is."""

from __future__ import annotations

import json
import random
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import pytest

from safety.prove import certificate, check
from safety.prove.certificate import write_certificate
from safety.prove.claims import BITS
from safety.prove.lrat import NoProof
from safety.prove.problem import Problem, build_problem
from safety.system import ANY, ModelError, State
from safety.terms import implies, real, select
from safety.terms.graph import BIT, REAL, integer, uint, variable
from tests.prove.certified import packed, problem_of, unpacked
from tests.prove.small import asked, below_sixteen, passed_in_time
from tests.prove.tampering import forged

ACCEPTED = (check.CHECKED, check.REAL, check.WEAKER)


def passing(arithmetic: str = "integers") -> Problem:
    """The small counter: above 3, it is on."""
    return build_problem(
        asked(
            lambda s: implies(s.high, s.on) & (s.n <= 15), lemmas=[passed_in_time, below_sixteen], arithmetic=arithmetic
        )
    )


def adding() -> Problem:
    """An accumulator and its carries: their sum is what was added, all inputs and any phase."""
    acc: Any = variable("acc", uint(3))
    carries: Any = variable("carries", integer(0, 20))
    ticks: Any = variable("ticks", integer(0, 20))
    step: Any = variable("step", integer(2, 3))
    total = acc + step
    states = [
        State(acc, total.low(3), 0),
        State(carries, select(ticks < 20, (carries + (total >= 8).word()).clip(0, 20), carries), 0),
        State(ticks, (ticks + 1).clip(0, 20), 0),
    ]
    lemma = implies(ticks < 20, (8 * carries + acc >= 2 * ticks) & (8 * carries + acc <= 3 * ticks))
    holds = implies(ticks < 20, 8 * carries + 8 > 2 * ticks)
    return problem_of(states, [step], holds, {"between two rates": lemma})


def alternating() -> Problem:
    """Needs induction of depth 2: a wire that is never true twice in a row, from a phase that may be any."""
    x: Any = variable("x", BIT)
    y: Any = variable("y", BIT)
    quiet: Any = variable("quiet", BIT)
    return problem_of([State(x, y & ~x, False), State(y, ~x & quiet, ANY)], [quiet], ~(x & y) | quiet, {}, quiet)


def halving() -> Problem:
    """Reals: what is halved and topped up stays below 2."""
    r: Any = variable("r", REAL)
    more: Any = variable("more", REAL)
    states = [State(r, r * real("1/2") + more, real("1/3").attr)]
    return problem_of(states, [more], r < 2, {"in range": (r >= 0) & (r < 2)}, (more >= 0) & (more <= real("2/3")))


def braking() -> Problem:
    """Products of reals: a train that brakes at b or more for any time up to standstill never passes the point."""
    v, x, b, d, h = (cast(Any, variable(name, REAL)) for name in ["v", "x", "b", "d", "h"])
    states = [State(v, v - d * h, ANY), State(x, x - v * h + d * h * h / 2, ANY), State(b, b, ANY)]
    fits = (v * v <= 2 * b * x) & (v >= 0) & (b > 0)
    return replace(
        problem_of(states, [d, h], x >= 0, {"the stop fits": fits}, (d >= b) & (h >= 0) & (v >= d * h)), start=fits
    )


PROBLEMS: dict[str, tuple[Callable[[], Problem], int]] = {
    "passing": (passing, 1),
    "passing in bits": (lambda: passing(BITS), 0),
    "adding": (adding, 0),
    "alternating": (alternating, 2),
    "halving": (halving, 1),
    "braking": (braking, 0),
}


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A certificate of each problem."""
    folder = tmp_path_factory.mktemp("certificates")
    made = {name: folder / f"{name}.zip" for name in PROBLEMS}
    for name, (problem, depth) in PROBLEMS.items():
        write_certificate(problem(), depth, made[name], agreed_by=["z3", "cvc5"])
    return made


# --- what is written -------------------------------------------------------------------------------------------------


def test_certificates_are_checked(written: dict[str, Path]) -> None:
    verdicts = {name: check.examine(path)["verdict"] for name, path in written.items()}
    assert verdicts == dict.fromkeys(PROBLEMS, check.CHECKED) | dict.fromkeys(["halving", "braking"], check.REAL)


def test_every_obligation_is_in_the_report(written: dict[str, Path]) -> None:
    report = check.examine(written["passing"])
    assert [one["label"] for one in report["obligations"]] == [
        "lemma 'passed in time' at power-up",
        "lemma 'below sixteen' at power-up",
        "lemma 'passed in time' is kept by a step",
        "lemma 'below sixteen' is kept by a step",
        "the property follows",
        "the property at step 0",
    ]
    assert {(one["z3"], one["cvc5"], one["bits"]) for one in report["obligations"]} == {("unsat", "unsat", "proof")}
    assert report["claim"]["id"] == "test.claim" and report["lemmas"] == ["passed in time", "below sixteen"]


def test_the_same_problem_gives_the_same_certificate(written: dict[str, Path], tmp_path: Path) -> None:
    again = write_certificate(passing(), 1, tmp_path / "again.zip", agreed_by=["z3", "cvc5"])
    assert again.path.read_bytes() == written["passing"].read_bytes() and again.complete


def test_hashes_bind_the_model_and_the_claim_and_not_the_proof() -> None:
    def hashes(problem: Problem, depth: int = 1) -> tuple[str, str]:
        return check.hashes(certificate.described(problem, depth))

    same, other = passing(), build_problem(asked(lambda s: s.n <= 15))
    assert hashes(same) == hashes(passing(), 2)
    assert hashes(same)[0] == hashes(other)[0] and hashes(same)[1] != hashes(other)[1]
    assert hashes(same)[0] != hashes(adding())[0]


def test_a_false_lemma_gives_no_certificate(tmp_path: Path) -> None:
    problem = build_problem(asked(below_sixteen, lemmas=[lambda s: s.n < 7]))
    with pytest.raises(ModelError, match="is kept by a step: not so in bits"):
        write_certificate(problem, 0, tmp_path / "no.zip")
    assert not (tmp_path / "no.zip").exists()


def test_a_proof_that_takes_too_long_makes_the_certificate_weaker(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def late(clauses: Any, timeout: float) -> str:
        raise NoProof(f"not reached in {timeout:g} s")

    monkeypatch.setattr(certificate, "refutation", late)
    summary = write_certificate(adding(), 0, tmp_path / "late.zip", timeout=3)
    assert not summary.complete and summary.missing["the property follows"] == "bit level: not reached in 3 s"
    report = check.examine(summary.path)
    assert (report["verdict"], report["obligations"][0]["note"]) == (check.WEAKER, "bit level: not reached in 3 s")
    assert {one["bits"] for one in report["obligations"]} == {"no proof"}


def test_the_checker_runs_where_nothing_else_of_the_project_is(written: dict[str, Path], tmp_path: Path) -> None:
    shutil.copy(check.__file__, tmp_path / "check.py")
    command = [sys.executable, "-I", "-W", "error::DeprecationWarning:__main__", "check.py", str(written["adding"])]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert (ended.returncode, json.loads(ended.stdout)[0]["verdict"]) == (0, check.CHECKED), ended.stderr
    ended = subprocess.run([sys.executable, "-I", "check.py", "check.py"], cwd=tmp_path, capture_output=True, text=True)
    assert ended.returncode == 2 and "expected a zip" in ended.stdout


def test_the_checker_imports_nothing_of_ours() -> None:
    source = Path(check.__file__).read_text(encoding="utf-8")
    assert "safety" not in source and "eval(" not in source and "exec(" not in source


# --- what the solvers say --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("z3", "cvc5", "proof", "verdict", "code"),
    [
        ("unsat", "unsat", True, check.CHECKED, 0),
        ("unsat", "unsat", False, check.WEAKER, 4),
        ("unknown", "unsat", True, check.WEAKER, 4),
        ("not installed", "unknown", True, check.WEAKER, 4),
        ("not installed", "unknown", False, check.UNDECIDED, 3),
        ("sat", "unsat", True, check.DISAGREE, 6),
        ("sat", "unknown", True, check.DISAGREE, 6),
        ("sat", "sat", False, check.REJECTED, 1),
        ("unknown", "sat", False, check.REJECTED, 1),
    ],
)
def test_every_answer_has_its_own_word_and_code(
    z3: str, cvc5: str, proof: bool, verdict: str, code: int,
    written: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    files = unpacked(written["adding"])
    path = packed(
        {name: text for name, text in files.items() if proof or not name.endswith("lrat")}, tmp_path / "c.zip"
    )
    monkeypatch.setattr(check, "ask", lambda solver, text, seconds: {"z3": z3, "cvc5": cvc5}[solver])
    assert (check.examine(path)["verdict"], check.main([str(path)])) == (verdict, code)


# --- what was tampered with ------------------------------------------------------------------------------------------


def campaign(written: dict[str, Path], folder: Path, seeds: range) -> tuple[Counter[str], list[str]]:
    """How mutated certificates fared, and those that are invalid and were accepted all the same."""
    originals = {name: unpacked(path) for name, path in written.items()}
    fared: Counter[str] = Counter()
    wrong = []
    for seed in seeds:
        rng = random.Random(seed)
        name = rng.choice([*originals])
        done, files, invalid = forged(originals[name], rng)
        report = check.examine(packed(files, folder / "forged.zip"), 20)
        accepted = report["verdict"] in ACCEPTED
        fared[f"{'invalid' if invalid else 'valid'}, {report['verdict']}"] += 1
        if invalid and accepted:
            wrong.append(f"{seed}: {name}, {done}: {report}")
    return fared, wrong


def test_tampered_certificates_are_rejected(written: dict[str, Path], tmp_path: Path) -> None:
    fared, wrong = campaign(written, tmp_path, range(100))
    assert wrong == []
    assert sum(n for how, n in fared.items() if how.startswith("invalid")) > 60
    assert sum(n for how, n in fared.items() if how in ("valid, checked", "valid, checked (real)")) > 3


@pytest.mark.parametrize("believed", [["check_lrat"], ["check_lrat", "ask"], ["well_sorted", "check_lrat", "ask"]])
def test_a_checker_that_believes_is_found(
    believed: list[str], written: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in believed:
        monkeypatch.setattr(check, name, lambda *given: "unsat")
    assert campaign(written, tmp_path, range(30))[1] != []


@pytest.mark.slow
def test_a_thousand_tampered_certificates_are_rejected(written: dict[str, Path], tmp_path: Path) -> None:
    fared, wrong = campaign(written, tmp_path, range(10_000, 11_000))
    print(dict(fared))
    assert wrong == []
    assert sum(n for how, n in fared.items() if how.startswith("invalid")) > 700
