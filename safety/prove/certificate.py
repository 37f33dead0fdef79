"""Certificates: what a stranger needs to check a proof without rightside; `safety.prove.check` defines their form.

    summary = write_certificate(problem, depth, Path("brakes.zip"))

A zip of `certificate.json` (system, claim, inductive invariant, depth) and, for each obligation of the induction, its
SMT-LIB text, its clauses and their LRAT proof; the same problem gives the same bytes but for the solver's choices.
"""

from __future__ import annotations

import hashlib
import json
import time
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safety.prove import check
from safety.prove.lrat import NoProof, refutation
from safety.prove.problem import Problem
from safety.system import ANY, ModelError
from safety.terms.graph import Sort, Term, postorder

CAP = 60.0  # seconds for the bit-level proof of one obligation
REALS = "reals have no bit level"


class NotSo(ModelError):
    """What is to be certified does not hold."""


@dataclass(frozen=True)
class Summary:
    """A certificate that was written: by obligation what is missing at the bit level (nothing where it is proved)."""

    path: Path
    sha256: str
    missing: dict[str, str]
    seconds: float

    @property
    def complete(self) -> bool:
        """Whether every obligation that has a bit level has its proof there."""
        return {*self.missing.values()} <= {"", REALS}

    @property
    def kind(self) -> str:
        """`bits`, or `real` where reals leave an obligation without a bit level."""
        return "real" if REALS in self.missing.values() else "bits"


def write_certificate(
    problem: Problem, depth: int, path: Path, *, agreed_by: Sequence[str] = (), timeout: float = CAP,
    say: Callable[[str], None] = lambda text: None,
) -> Summary:  # fmt: skip
    """Write the certificate that the problem's lemmas and an induction of a depth prove its claim.

    `timeout` is in seconds for the bit-level proof of each obligation; `say` is told which one is at work.  Raises
    `NotSo` where the clauses of an obligation are satisfiable, `ModelError` where a name or a size is beyond the form.
    """
    began = time.perf_counter()
    text = described(problem, depth)
    text["agreed_by"] = list(agreed_by)
    try:
        certificate = check.read(text)
    except check.Malformed as error:
        raise ModelError(f"{problem.claim.id} cannot be certified: {error}") from None
    files: dict[str, str] = {}
    missing: dict[str, str] = {}
    wanted = check.obligations(certificate)
    for i, one in enumerate(wanted, 1):
        say(f"certificate: obligation {i} of {len(wanted)}")
        files[f"{i}.smt2"] = check.smt(certificate, one)
        clauses = check.clauses(certificate, one)
        note = REALS
        if clauses is not None:
            files[f"{i}.cnf"] = check.dimacs(one.label, clauses)
            try:
                proof, note = refutation(clauses, timeout), ""
                check.check_lrat(clauses, proof)
                files[f"{i}.lrat"] = proof
            except NoProof as none:
                if none.satisfiable:
                    raise NotSo(f"{problem.claim.id}: {one.label}: not so in bits; nothing to certify") from None
                note = f"bit level: {none}"
            except check.Rejected as error:
                note = f"bit level: cvc5's proof is wrong: {error}"
        missing[one.label] = note
    text["obligations"] = [[label, note] for label, note in missing.items()]
    files = {check.MAIN: _json(text)} | files
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f"{path.name}.part")
    with zipfile.ZipFile(unfinished, "w") as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    unfinished.replace(path)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    return Summary(path, digest, missing, time.perf_counter() - began)


def unlike(report: Mapping[str, Any], problem: Problem) -> str:
    """In what a certificate, by the report on it, is not of a problem; nothing where it is."""
    model, claim = check.hashes(described(problem, 0))
    if report["model"]["sha256"] != model:
        return f"it is of another model: {report['model']['sha256'][:12]}, not {model[:12]} as in the project now"
    if report["claim"]["sha256"] != claim:
        return f"it is of another claim: {report['claim']['sha256'][:12]}, not {claim[:12]} as in the project now"
    return ""


def described(problem: Problem, depth: int) -> dict[str, Any]:
    """`certificate.json` without the outcome: the system, the claim's formulas, the lemmas, the obligations."""
    states, claim = problem.system.states, problem.claim
    formulas = [problem.given, problem.start, problem.holds, *problem.lemmas.values()]
    terms = postorder([*(s.var for s in states), *(s.next for s in states), *formulas])
    at = {term.uid: i for i, term in enumerate(terms)}
    text: dict[str, Any] = {
        "format": check.FORMAT,
        "claim": {"id": claim.id, "statement": claim.statement, "faults": [str(f) for f in problem.faults]},
        "model": {"name": problem.system.name},
        "arithmetic": claim.arithmetic,
        "depth": depth,
        "nodes": [[t.op, [at[a.uid] for a in t.args], _attribute(t), str(t.sort)] for t in terms],
        "registers": [
            [s.path, at[s.var.uid], at[s.next.uid], None if s.power_up is ANY else _value(s.power_up, s.var.sort)]
            for s in states
        ],
        "inputs": sorted(str(v.attr) for v in problem.system.inputs.values()),
        "given": at[problem.given.uid],
        "start": at[problem.start.uid],
        "holds": at[problem.holds.uid],
        "lemmas": [[name, at[lemma.uid]] for name, lemma in problem.lemmas.items()],
        "obligations": [],
        "agreed_by": [],
    }
    text["model"]["sha256"], text["claim"]["sha256"] = check.hashes(text)
    return text


def _value(value: Any, sort: Sort) -> Any:
    return str(value) if sort.kind == "real" else value


def _attribute(term: Term) -> Any:
    if term.op == "const":
        return _value(term.attr, term.sort)
    return list(term.attr) if term.op == "slice" else term.attr


def _json(text: dict[str, Any]) -> str:
    """The json, a line for each entry of a list."""
    parts = []
    for key, value in text.items():
        if isinstance(value, list):
            rows = ",\n  ".join(json.dumps(row, ensure_ascii=False) for row in value)
            parts.append(f"{json.dumps(key)}: [\n  {rows}\n ]" if value else f"{json.dumps(key)}: []")
        else:
            parts.append(f"{json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}")
    return "{\n " + ",\n ".join(parts) + "\n}\n"
