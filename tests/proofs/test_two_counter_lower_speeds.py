"""Two-counter ATC below 250 km/h: what is wrong-side by injection is what is so by proof, and what is explained."""

from __future__ import annotations

import pytest

from models.two_counter.failures import component_faults
from proofs import two_counter_hazards_at_5 as at_5
from proofs.two_counter_hazards import SIMULATED
from proofs.two_counter_lower_speeds import LOWER_SPEEDS, lower_speed
from proofs.two_counter_rates import wrong_in
from proofs.two_counter_rides import LOWER, Ride
from proofs.two_counter_wrong_side import LOW, defeats, further, singles
from safety import REFUTED
from safety.prove.claims import registered
from safety.prove.hazards import CONFIRMED, cut_sets, hazards
from safety.prove.prove import Limits, prove

HAZARDS = {h.id.split(".")[1]: h for h in hazards() if h.id.startswith("two_counter_hazards_at_5.")}
CLAIMS = {c.id: c for c in registered() if c.id.startswith("two_counter_hazards_at_5.")}
LISTS = {
    "overspeed_without_brake_at_5": at_5.FUNCTIONAL,
    "overspeed_without_brake_by_a_stage_at_5": at_5.COUNTERS,
    "overspeed_without_brake_by_the_selection_at_5": at_5.SELECTION,
}
COSTLY = "overspeed_without_brake_by_the_selection_at_5"


@pytest.mark.parametrize("v", [5, *(pytest.param(v, marks=pytest.mark.slow) for v in LOWER if v != 5)])
def test_wrong_side_singles_are_those_that_are_explained(v: int) -> None:
    """Property 16 at each check speed: (15) and what stands in `further` with its reason; and the low generator."""
    wrong = wrong_in(LOWER_SPEEDS[v])
    assert wrong == {*singles(Ride(v).m), LOW}
    for campaign in LOWER_SPEEDS[v]:
        result = campaign.inject()
        assert result.exhaustive and not result.surprises() and result.tally.injections == len(component_faults())


@pytest.mark.slow
@pytest.mark.parametrize("v", LOWER)
def test_the_other_moments_show_no_further_one(v: int) -> None:
    assert wrong_in([lower_speed(v, when) for when in ("early", "midst")]) <= {*singles(Ride(v).m), LOW}


@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.slow) if n == COSTLY else n for n in HAZARDS])
def test_cut_sets_at_5(name: str) -> None:
    """Complete at every order, each confirmed; by name those that injection finds."""
    found = cut_sets(HAZARDS[name])
    assert found.by_order(CONFIRMED) == found.by_order() == dict(HAZARDS[name].expect)
    assert (found.all_orders, found.why, found.not_minimal, found.agreed_by) == (True, "", [], ["z3", "cvc5"])
    listed = {fault.name for fault in LISTS[name]}
    assert {one.faults[0] for one in found.sets if one.order == 1} == listed & set(at_5.SINGLES_AT_5)
    pairs = {frozenset(pair) for pair in at_5.PAIRS_AT_5 if listed.issuperset(pair)}
    assert {frozenset(one.faults) for one in found.sets if one.order > 1} == pairs


def test_every_fault_is_in_a_proof_at_5_or_named_as_simulated() -> None:
    listed = [f.name for some in (*LISTS.values(), at_5.STAGES_AT_0) for f in some]
    assert sorted([*listed, *SIMULATED]) == sorted(f.name for f in component_faults())


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    outcome = prove(CLAIMS[name], Limits(synthesis=0, simulation=0, portfolio=0))
    assert outcome.as_expected, outcome.why
    assert outcome.verdict == REFUTED or (outcome.agreed_by == ["z3", "cvc5"] and outcome.premise_at is not None)


def test_what_differs_between_the_check_speeds() -> None:
    """The wrap of counter 2 comes in time at 250 km/h only; bits of the preset are wrong-side where it has none."""
    assert [v for v in (250, *LOWER) if "counting gate at 0" not in further(Ride(v).m)] == [250]
    assert all("preset bit 0 at 1" not in defeats(Ride(v).m)["e"] for v in (250, *LOWER)), "all presets are odd"
    assert [len(singles(Ride(v).m)) for v in (250, *LOWER)] == [61, 59, 61, 58, 59, 59, 58]
