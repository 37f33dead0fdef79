"""Speed patterns: what is injected is what is proved; the fault table, the comparison and the samples come out."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import pytest

from models.patterns.equipment import B_POINT
from proofs import patterns_campaign as campaigns
from proofs import patterns_hazards as hazards
from proofs import patterns_monte_carlo as sampled
from proofs import patterns_parts as parts
from proofs import patterns_transmission_compared as compared
from safety import PROVED, REFUTED, ModelError
from safety.exhibits import declared
from safety.inject.space import CampaignError
from safety.prove.claims import Claim, registered
from safety.prove.hazards import cut_sets
from safety.prove.hazards import hazards as all_hazards
from safety.prove.prove import Limits, prove

LIMITS = Limits(timeout=60)
HAZARDS = {h.claim.model: h for h in all_hazards() if h.id.startswith("patterns_hazards.")}
SETS = {way: one.cut_sets for way, one in hazards.PLAIN_ONES.items()}


@pytest.mark.parametrize("way", hazards.PLAIN_ONES)
def test_wrong_side_singles_are_exactly_the_single_cut_sets(way: str) -> None:
    wrong = {i.faults[0].name for i, cell in campaigns.STOP[way].inject().injections() if cell.startswith("wrong")}
    assert {(name,) for name in wrong} == set(SETS[way])


@pytest.mark.parametrize("way", hazards.PLAIN_ONES)
def test_wrong_side_pairs_have_a_wrong_side_single(way: str) -> None:
    result = campaigns.PAIRS[way].inject()
    assert not result.surprises()
    bad = {name for (name,) in SETS[way]}
    pairs = [{f.name for f in i.faults} for i, cell in result.injections() if cell.startswith("wrong")]
    assert pairs and all(pair & bad for pair in pairs)


EXPECTED = [
    *(pytest.param(one, id=one.id) for one in (*campaigns.STOP.values(), *campaigns.DETECTED.values())),
    *(pytest.param(one, id=one.id, marks=pytest.mark.slow) for one in campaigns.ELSEWHERE.values()),
]


@pytest.mark.parametrize("campaign", EXPECTED)
def test_counts_are_those_declared(campaign: campaigns.Campaign) -> None:
    assert not campaign.inject().surprises()


def test_cut_sets_are_complete_confirmed_and_those_declared() -> None:
    one = hazards.PLAIN_ONES["program"]
    found = cut_sets(HAZARDS[one.equipment], LIMITS)
    assert found.all_orders and found.agreed_by == ["z3", "cvc5"] and not found.not_minimal
    assert {s.faults for s in found.sets} == set(one.cut_sets)
    assert all(s.status == "confirmed" for s in found.sets)


def test_detectors_show_what_the_fault_table_says_of_them() -> None:
    """Each wrong-side mode with a detector on board is found in time; the magnet and the contact are not."""
    unseen = {row.name for row in parts.TABLE if row.direction == "D" and not parts.detected_in(row.name)}
    assert unseen == {hazards.MAGNET, hazards.BUTTON}  # the button is made harmless, not found
    contact = dict(parts.cells("point"))[hazards.WELDED]
    assert contact == "wrong/yes"  # the ground sees it, the train passes


@pytest.mark.slow
@pytest.mark.parametrize("one", [*hazards.PLAIN_ONES.values(), *hazards.CHECKED.values()],
                         ids=lambda one: str(one.equipment.__name__))  # fmt: skip
def test_all_cut_sets(one: hazards.Protection) -> None:
    found = cut_sets(HAZARDS[one.equipment], LIMITS)
    assert found.all_orders and not found.not_minimal
    assert {frozenset(s.faults) for s in found.sets} == {frozenset(names) for names in one.cut_sets}
    assert all(s.status == "confirmed" for s in found.sets)


def test_a_wrong_side_mode_that_the_lemmas_forget_is_noticed() -> None:
    program = hazards.PLAIN_ONES["program"]
    forgetful = replace(program, cut_sets=program.cut_sets[1:])
    declared_one = HAZARDS[program.equipment]
    planted = replace(declared_one, claim=replace(declared_one.claim, lemmas=tuple(forgetful.lemmas())))
    with pytest.raises(ModelError, match="the brake comes in time"):
        cut_sets(planted, Limits(timeout=10))


def test_a_pattern_without_its_reaction_time_is_caught_by_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """The bug planted: the comparator looks at the speed of the present cycle alone, without free run."""
    monkeypatch.setattr("models.patterns.stored_pattern.REACTION", 0)
    planted = replace(campaigns.STOP["point"], id="patterns_planted", expect=None)
    with pytest.raises(CampaignError, match="fault-free run"):
        planted.inject()


def test_exhibits_are_as_asked() -> None:
    assert parts.TABLE and compared.CASES
    made = [e.evaluate() for e in declared() if e.id in ("patterns.fault-table", "patterns.transmission")]
    assert len(made) == 2 and all(one["as_expected"] for one in made)


def test_each_proved_cell_of_the_comparison_has_both_its_premises_dropped() -> None:
    claims = [one for one in registered() if one.id.startswith("patterns_transmission_compared.")]
    dropped = Counter(one.twin_of for one in claims if one.expect == REFUTED and one.twin_of)
    assert dropped == {one.id: 2 for one in claims if one.expect == PROVED}
    assert len(dropped) == sum(case.right.count(True) for case in compared.CASES.values()) == 10


@pytest.mark.parametrize("twin", [one for one in registered() if one.id.startswith("patterns_transmission_compared.")
                                  and one.twin_of], ids=lambda one: one.formula.__name__)  # fmt: skip
def test_a_dropped_premise_is_refuted_by_a_replayed_run(twin: Claim) -> None:
    outcome = prove(twin, LIMITS)
    assert outcome.verdict == REFUTED and outcome.counterexample is not None


def test_samples_are_those_declared() -> None:
    for campaign in sampled.SAMPLED:
        assert not campaign.inject().surprises()


def test_b_point_leaves_room_for_a_weak_brake() -> None:
    """Why a weak brake is no cut set of the continuous equipment: the brake acts while red waits for an answer."""
    assert (hazards.FORCE,) not in SETS["continuous"] and B_POINT > 1200
