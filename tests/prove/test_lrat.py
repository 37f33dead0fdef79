"""LRAT proofs: those that are made are accepted, and nothing that does not follow is."""

from __future__ import annotations

import random
from typing import Any

import pytest

from safety.prove import check
from safety.prove.lrat import NoProof, refutation
from tests.prove.certified import edited, follows

PIGEONS = [(1, 2), (3, 4), (5, 6)] + [
    (-a, -b) for hole in ((1, 3, 5), (2, 4, 6)) for a, b in zip(hole, hole[1:] + hole[:1], strict=True)
]


def accepted(clauses: Any, proof: str) -> bool:
    try:
        check.check_lrat(clauses, proof)
    except check.Rejected:
        return False
    return True


def test_a_proof_is_accepted_and_no_edit_that_breaks_it_is() -> None:
    proof = refutation(PIGEONS, 20)
    assert accepted(PIGEONS, proof) and follows(PIGEONS, proof)
    rng = random.Random(7)
    edits = [edited(proof, rng) for _ in range(2000)]
    valid = [follows(PIGEONS, edit) for edit in edits]
    assert valid.count(False) > 1000 and valid.count(True) > 10
    assert [edit for edit, ok in zip(edits, valid, strict=True) if accepted(PIGEONS, edit) and not ok] == []


@pytest.mark.parametrize(
    ("proof", "clauses"),
    [
        ("", [(1,), (-1,)]),  # nothing derived
        ("3 0 1 0", [(1,), (-1,)]),  # no contradiction yet
        ("3 0 1 2", [(1,), (-1,)]),  # no end
        ("2 0 1 2 0", [(1,), (-1,)]),  # a number that is taken
        ("3 0 1 4 0", [(1,), (-1,)]),  # an unknown clause
        ("3 0 3 0", [(1,), (2,)]),  # itself
        ("3 1 0 1 0\n4 0 3 2 0", [(1, 2), (-1,)]),  # a clause that does not follow
        ("3 d 1 0\n3 0 1 2 0", [(1,), (-1,)]),  # deletions are not needed
        ("3 0 -1 2 0", [(1,), (-1,)]),  # no resolution on a literal
        ("x", [(1,), (-1,)]),
    ],
)
def test_what_is_no_proof_is_rejected(proof: str, clauses: Any) -> None:
    assert not accepted(clauses, proof)
    assert accepted([(1,), (-1,)], "3 0 1 2 0\n")


def test_clauses_that_can_be_satisfied_have_no_proof() -> None:
    with pytest.raises(NoProof, match="can be satisfied") as none:
        refutation([(1, 2), (-1,)], 20)
    assert none.value.satisfiable
