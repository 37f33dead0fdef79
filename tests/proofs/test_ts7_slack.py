"""Claims that say exactly what a part does: expected verdicts, and the changes of the model that only they notice."""

from __future__ import annotations

import inspect

import pytest

from models.ts7.voting import disagree
from proofs import ts7_slack, ts7_thresholds
from safety.prove.claims import registered
from safety.prove.mutants import KILLED, SLACK, UNDECIDED, Subject
from safety.prove.prove import prove
from tests.proofs.verdicts import check, claims_of, without_twin

CLAIMS = claims_of(ts7_slack)


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    check(prove(CLAIMS[name]))


def test_each_has_a_twin() -> None:
    assert without_twin(CLAIMS) == []


BEFORE = ["ts7_thresholds.brakes_above_two", "ts7_thresholds.nobody_isolated_within_two"]
SAID = ["ts7_slack.just_who_stands_alone_is_isolated", "ts7_slack.brakes_just_by_rule_a"]


def kinds(names: list[str]) -> list[str]:
    """What becomes of the mutants of the line that says whether channels disagree."""
    subject = Subject([c for c in registered() if c.id in names])
    line = inspect.getsourcelines(disagree)[1] + 2
    here = [m for m in subject.mutants.mutants if m.place and m.place.line == line and "voting" in m.place.file]
    assert len(here) > 20
    return [fate.kind for fate in subject.examine([m.number for m in here])]


def test_what_disagreement_is_was_left_open_before() -> None:
    assert ts7_thresholds.brakes_above_two
    assert SLACK in kinds(BEFORE)


def test_what_disagreement_is_is_said() -> None:
    found = kinds(BEFORE + SAID)
    assert {SLACK, UNDECIDED} & set(found) == set()
    assert sum(kind in KILLED for kind in found) > 15
