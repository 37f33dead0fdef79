"""Certificates of claims as they are proved: what `rightside prove --certify FOLDER` adds to the work on a claim."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from safety.prove.bounds.claims import RealClaim
from safety.prove.certificate import CAP, NotSo, write_certificate
from safety.prove.claims import BITS, PROVED
from safety.prove.outcome import Outcome
from safety.prove.problem import Problem
from safety.prove.solve import Disagreement
from safety.system import ModelError

_INDUCTION = re.compile(r"induction of depth (\d+),(.*, bits$)?")


def certified(
    outcome: Outcome, folder: Path, timeout: float, say: Callable[[str], None], warn: Callable[[str], None]
) -> dict[str, Any] | None:
    """Write `<claim id>.cert.zip`; the "certificate" of the claim's entry, None with a warning where there can be none.

    `timeout` is in seconds for the bit-level proof of each obligation.  Raises `Disagreement` where an obligation that
    was proved is not so in bits.
    """
    problem = outcome.problem
    if outcome.verdict != PROVED or problem is None:
        return None
    proof = _INDUCTION.match(outcome.method)
    if proof is None:
        warn(f"{outcome.claim.id}: no certificate; its proof is no induction but a {outcome.method}")
        return None
    if proof[2]:  # lemmas that were found may be proved in bits where the claim asks for integers
        problem = replace(problem, claim=replace(problem.claim, arithmetic=BITS))
    return _written(problem, int(proof[1]), outcome.agreed_by, folder, timeout, say, warn)


def certified_over_reals(
    claim: RealClaim, entry: dict[str, Any], folder: Path, timeout: float, say: Callable[[str], None],
    warn: Callable[[str], None],
) -> dict[str, Any] | None:  # fmt: skip
    """The same of a claim over reals, which is one obligation; its "certificate" then names the routes, too.

    Of a bracket, and of a claim that is shown for whole values of some variables only, the routes alone stand in the
    entry.
    """
    from safety.prove.bounds.routes import NLSAT

    routes: dict[str, Any] | None = entry["certificate"]
    if routes is None:
        return None
    try:
        problem = claim.problem()
    except ModelError as error:
        warn(f"{claim.id}: no certificate; {error}")
        return routes
    if claim.about.whole and NLSAT not in entry["agreed_by"]:
        warn(f"{claim.id}: no certificate; it holds for whole numbers, of which its form knows nothing")
        return routes
    made = _written(problem, 0, entry["agreed_by"], folder, timeout, say, warn)
    return routes | made if made else routes


def _written(
    problem: Problem, depth: int, agreed_by: Sequence[str], folder: Path, timeout: float, say: Callable[[str], None],
    warn: Callable[[str], None],
) -> dict[str, Any] | None:  # fmt: skip
    path = folder / f"{problem.claim.id}.cert.zip"
    try:
        made = write_certificate(problem, depth, path, agreed_by=agreed_by, timeout=min(timeout, CAP), say=say)
    except NotSo as error:
        raise Disagreement(str(error)) from None
    except ModelError as error:
        warn(f"no certificate: {error}")
        return None
    return {"file": str(path), "sha256": made.sha256, "kind": made.kind, "complete": made.complete}
