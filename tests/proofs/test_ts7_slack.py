"""Claims that say exactly what a part does: expected verdicts, and the changes of the model that only they notice."""

from __future__ import annotations

import inspect

import pytest

from models.ts7.ring import HeldPulses
from models.ts7.signals import Selection
from models.ts7.voting import disagree
from proofs import (
    ts7_delivered,
    ts7_slack,
    ts7_slack_channel,
    ts7_slack_relays,
    ts7_slack_ring,
    ts7_slack_variants,
    ts7_thresholds,
    ts7_variants,
)
from safety.prove.claims import registered
from safety.prove.mutants import EQUIVALENT, KILLED, SLACK, UNDECIDED, examine
from safety.prove.mutation_case import Subject
from safety.prove.prove import prove
from tests.proofs.verdicts import check, claims_of, without_twin

EXACT = (ts7_slack, ts7_slack_channel, ts7_slack_relays, ts7_slack_ring, ts7_slack_variants)
CLAIMS = {name: claim for module in (*EXACT, ts7_variants, ts7_delivered) for name, claim in claims_of(module).items()}


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    check(prove(CLAIMS[name]))


def test_each_has_a_twin() -> None:
    assert without_twin(CLAIMS) == []


BEFORE = ["ts7_thresholds.brakes_above_two", "ts7_thresholds.nobody_isolated_within_two"]
SAID = ["ts7_slack.just_who_stands_alone_is_isolated", "ts7_slack.brakes_just_by_rule_a"]


def kinds(names: list[str], line: int, least: int = 20) -> list[str]:
    """What becomes of the mutants of a line."""
    subject = Subject([c for c in registered() if c.id in names])
    here = [m for m in subject.mutants.mutants if m.place and m.place.line == line]
    assert len(here) > least
    return [fate.kind for fate in examine(subject, [m.number for m in here])]


DISAGREE = inspect.getsourcelines(disagree)[1] + 2


def test_what_disagreement_is_was_left_open_before() -> None:
    assert ts7_thresholds.brakes_above_two
    assert SLACK in kinds(BEFORE, DISAGREE)


def test_what_disagreement_is_is_said() -> None:
    found = kinds(BEFORE + SAID, DISAGREE)
    assert {SLACK, UNDECIDED} & set(found) == set()
    assert sum(kind in KILLED for kind in found) > 15


def test_the_rows_of_the_matrix_are_said() -> None:
    """All that a signal's selection computes: nothing of it could be written otherwise."""
    line = inspect.getsourcelines(Selection.chosen)[1] + 4
    assert set(kinds(["ts7_slack.lowest_signal_gives_its_word"], line)) <= set(KILLED)


def test_a_second_carry_in_a_frame_cannot_come() -> None:
    """Latched by OR or by exclusive OR, a pulse is the same: only the lemma of the exact claim says so."""
    line = inspect.getsourcelines(HeldPulses.hold)[1] + 3
    names = ["ts7_slack_ring.pulses_come_just_with_the_last_carry", "ts7_slack.ring_powers_up_without_pulses"]
    found = kinds(names, line)
    assert {SLACK, UNDECIDED} & set(found) == set()
    assert found.count(EQUIVALENT) >= 4
