"""The component table row by row: the cut sets are those that the table names, and each difference is explained."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import pytest

from models.ats.failures import rates_of, row_of, rows_of, table
from models.ats.stretch import LINE, Stretch
from proofs import ats_hazards_parts, position_hazards, radio_hazards
from proofs import component_hazards as proofs
from proofs.component_hazards import HAZARDS, NEVER, NO_PROOF, NOT_ASKED, PAIR, SINGLE, by_proof
from safety.prove.hazards import CONFIRMED, CutSets, Hazard, cut_sets, hazards, replay
from safety.system import ModelError
from safety.terms.graph import postorder
from safety.tracing import trace

DECLARED = {h.id: h for h in hazards()}
NEW = [h.id for h in HAZARDS if h.id.split(".")[0] not in ("ats_hazards", "dual_processor_hazards")]
SHOWN = {row[0]: row for row in proofs.rows()}


@cache
def sets(id: str) -> CutSets:
    return cut_sets(DECLARED[id])


@pytest.mark.parametrize("id", NEW)
def test_cut_sets_are_complete_minimal_and_replayed(id: str) -> None:
    found = sets(id)
    assert found.all_orders
    assert found.agreed_by == found.minimal_by == ["z3", "cvc5"]
    assert not found.not_minimal
    assert found.by_order() == found.by_order(CONFIRMED) == dict(DECLARED[id].expect)


@pytest.mark.parametrize("id", NEW)
def test_singles_are_those_the_table_names(id: str) -> None:
    stated = next(h for h in HAZARDS if h.id == id)
    assert {row_of(one.faults[0]) for one in sets(id).sets if len(one.faults) == 1} == stated.singles
    assert {row_of(name) for one in sets(id).sets if len(one.faults) > 1 for name in one.faults} == stated.pairs
    assert stated.singles <= stated.rows <= {mode.name for mode in table()}


@pytest.mark.parametrize("id", NEW)
def test_runs_keep_what_is_given(id: str) -> None:
    for one in sets(id).sets:
        assert all(replay(DECLARED[id], one)["claim.given"])


def test_every_row_has_a_cell_and_every_hazard_is_declared() -> None:
    assert list(SHOWN) == [mode.name for mode in table()]
    assert len(SHOWN) == 44
    assert {h.id for h in HAZARDS} <= set(DECLARED)


def test_rows_without_cut_sets_say_so() -> None:
    assert {name for name in SHOWN if by_proof(name) == NO_PROOF} == set(NOT_ASKED)
    assert all(SHOWN[name][-1] for name in NOT_ASKED)


@pytest.mark.parametrize(("point", "read"), [("ats.display", False), ("io_unit", True)])
def test_nothing_reads_the_display(point: str, read: bool) -> None:
    """No register of the stretch, and nothing that it shows of the train, depends on that point."""
    system = trace(Stretch, LINE)
    shown = [system.lookup(name) for name in ("passed", "ordered", "braking", "head")]
    terms = postorder([*(s.next for s in system.states), *shown])
    assert any(term.op == "point" and term.attr == point for term in terms) is read


def test_what_injection_finds_dangerous_is_single_by_proof() -> None:
    assert {by_proof(mode.name) for mode in table() if mode.wrong_side} == {SINGLE}


def test_singles_that_injection_does_not_find_are_those_explained() -> None:
    quiet = {mode.name for mode in table() if not mode.wrong_side}
    assert {name for name in quiet if by_proof(name) == SINGLE} == set(proofs.NOT_ON_THE_RIDES)


def test_dangerous_rows_of_the_table_that_are_no_singles_are_explained() -> None:
    other = {mode.name: mode for mode in table() if mode.direction == "D" and by_proof(mode.name) in (NEVER, PAIR)}
    assert set(other) == {m.name for m in table() if m.direction == "D" and not m.wrong_side}
    assert set(other) == {"comparator: stuck equal", "radio (ground, train): replay"}
    assert all(mode.why for mode in other.values())


# --- each can fail ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("id", "left_out"),
    [
        ("position_hazards.farther_or_faster_than_believed", "is_before_s_hi"),
        ("position_group_hazards.a_group_is_misread", "collected"),
        ("ats_hazards_parts.turnout_without_a_limit", "target_acts"),
        ("ats_hazards_parts.signal_is_passed", "fits"),
    ],
)
def test_a_lemma_left_out_leaves_a_set_that_no_run_confirms(id: str, left_out: str) -> None:
    hazard = DECLARED[id]
    kept = tuple(lemma for lemma in hazard.claim.lemmas if lemma.__name__ != left_out)
    assert len(kept) == len(hazard.claim.lemmas) - 1
    found = cut_sets(replace(hazard, claim=replace(hazard.claim, lemmas=kept)))
    assert () in {one.faults for one in found.sets}


def guarded_by(lemmas: list[Any], hazard: Hazard) -> Hazard:
    return replace(hazard, claim=replace(hazard.claim, lemmas=tuple(lemmas)))


def test_a_lemma_without_its_guard_is_refused() -> None:
    hazard = DECLARED["radio_hazards.the_leader_is_run_into"]
    with pytest.raises(ModelError, match="guard the lemma"):
        cut_sets(guarded_by(radio_hazards.TWO.lemmas(), hazard))
    chain = DECLARED["ats_hazards_parts.released_without_the_phase"]
    with pytest.raises(ModelError, match="guard the lemma"):
        cut_sets(guarded_by([ats_hazards_parts.ats_phase.counted], chain))


def test_rows_go_to_a_part_by_their_points() -> None:
    wheel = rows_of({"wheel.grip"}, {"axle.": "wheel."})
    assert [fault.name for fault in wheel] == ["wheel-rail: slide", "wheel-rail: slip", "wheel-rail: creep"]
    assert rows_of(set()) == []
    assert set(rates_of(wheel)) == {fault.name for fault in wheel}
    assert {fault.name for fault in position_hazards.FAULTS} == {*position_hazards.UNDER, *position_hazards.OVER}


def test_rates_of_a_row_are_shared_by_its_faults() -> None:
    shared = rates_of(ats_hazards_parts.BRAKE)
    assert [row_of(name) for name in shared].count(ats_hazards_parts.ENERGISED) == 2
    halves = [Fraction(rate) for name, (rate, _) in shared.items() if row_of(name) == ats_hazards_parts.ENERGISED]
    assert sum(halves) == Fraction(10, 10**9)
