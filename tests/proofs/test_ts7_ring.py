"""Claims about the ring: verdicts, the fault set that campaign and proof share, and checks that can fail."""

from __future__ import annotations

import pytest

from models.ts7.ring import Ring
from proofs import ts7_campaign, ts7_formulas
from proofs import ts7_ring as ring
from safety import PROVED, Fault, at_most, stuck
from safety.faults import expand
from safety.prove.claims import Claim
from safety.prove.prove import prove
from safety.tracing import trace
from tests.proofs.verdicts import OWN_LEMMAS, SHORT, check, claims_of, of, without_twin

CLAIMS = claims_of(ring)


@pytest.mark.parametrize("claim", CLAIMS.values(), ids=list(CLAIMS))
def test_verdict(claim: Claim) -> None:
    check(prove(claim))


def test_every_proved_requirement_has_a_claim_that_fails() -> None:
    assert without_twin(CLAIMS) == []


def what(fault: Fault, prefix: str = "") -> tuple[str, tuple[str, ...]]:
    return str(fault.kind), tuple(p.removeprefix(prefix) for p in fault.points)


def test_the_faults_proved_include_those_injected() -> None:
    shared = [g for g in ts7_campaign.ring_single_stuck.faults if g.name in ("stage", "carry", "sum", "data")]
    injected = {what(f) for group in shared for f in expand(trace(Ring), [group.faults])}
    assert len(injected) == 70
    proved = {what(f, "ring.") for f in [*ring.SILENT, *ring.FULL, ring.HALF, ring.DOWN]}
    assert proved - injected == {(f"stuck-at-{v}", (f"carry.{end}",)) for v in (0, 1) for end in ("in", "out")}
    assert injected <= proved


def test_a_stage_that_is_left_out_of_the_lemma_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ring, "STAGES", range(31))
    assert of(ring.every_shared_fault_is_found, OWN_LEMMAS, steps=1).verdict != PROVED


def test_a_fault_that_the_lemma_does_not_know_is_noticed() -> None:
    with_column = at_most(1, [*ring.SILENT, *ring.FULL, ring.HALF, ring.DOWN, ring.at(1, "column", bit=5)])
    assert of(ring.every_shared_fault_is_found, OWN_LEMMAS, faults=with_column, steps=1).verdict != PROVED


def test_two_faults_are_more_than_one() -> None:
    both = at_most(2, [*ring.SILENT, *ring.FULL, ring.HALF, ring.DOWN])
    assert of(ring.every_shared_fault_is_found, OWN_LEMMAS, faults=both, steps=1).verdict != PROVED


@pytest.mark.parametrize("point", ["overflow.strobe", "carry.out", "data", "matrix.j2", "select.j3"])
def test_a_broken_ring_does_not_do_what_the_words_do(point: str) -> None:
    found = of(ring.ring_adds_four_words, faults=at_most(1, [Fault(stuck(0), [point])]))
    assert found.verdict == "refuted"


def test_a_pulse_more_or_less_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ring, "SPEED_FRACTION", ts7_formulas.SPEED_FRACTION - 1)
    assert of(ring.way_of_a_pulse_is_the_same_for_all_wheels, SHORT, steps=1).verdict != PROVED
