"""Two-counter ATC: cut sets of "too fast and no brake", against the known defeats and by runs without a solver."""

from __future__ import annotations

from dataclasses import replace

import pytest

from models.two_counter.equipment import Equipment
from models.two_counter.failures import component_faults
from proofs import two_counter_hazards as proofs
from proofs.two_counter_brake_chain import Chain
from safety import PROVED, REFUTED
from safety.faults import instrument, schedule
from safety.prove.claims import registered
from safety.prove.hazards import CONFIRMED, CutSets, cut_sets, hazards
from safety.prove.prove import Limits, prove
from safety.system import ModelError
from safety.trace import run
from safety.tracing import trace

HAZARDS = {h.id.split(".")[1]: h for h in hazards() if h.id.startswith("two_counter_hazards.")}
CLAIMS = {c.id: c for c in registered() if c.id.startswith("two_counter_hazards.")}
OWN = Limits(synthesis=0, simulation=0, portfolio=0)


@pytest.fixture(scope="module")
def found() -> dict[str, CutSets]:
    return {name: cut_sets(hazard) for name, hazard in HAZARDS.items()}


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    outcome = prove(CLAIMS[name], OWN)
    assert outcome.as_expected, outcome.why
    assert outcome.verdict == REFUTED or (outcome.agreed_by == ["z3", "cvc5"] and outcome.premise_at is not None)


def test_each_list_is_complete_at_every_order_and_each_set_is_confirmed(found: dict[str, CutSets]) -> None:
    assert len(found) == 3
    for name, sets in found.items():
        assert sets.by_order() == sets.by_order(CONFIRMED) == dict(HAZARDS[name].expect)
        assert (sets.all_orders, sets.why, sets.not_minimal) == (True, "", [])
        assert sets.agreed_by == ["z3", "cvc5"]


def test_single_cut_sets_are_the_known_defeats_and_those_that_are_explained(found: dict[str, CutSets]) -> None:
    """Property 16: the set contains all of property 15; each other member stands in FURTHER with its reason."""
    singles = {one.faults[0] for sets in found.values() for one in sets.sets if one.order == 1}
    known = {name for names in proofs.DEFEATS.values() for name in names}
    assert known <= singles
    assert singles - known == set(proofs.FURTHER)
    assert sorted(proofs.DEFEATS) == list("abcdefghijkl"), "(m) needs a selection without default"
    assert all(reason for reason in proofs.FURTHER.values())


def test_pairs_are_those_of_the_highest_preset_bit(found: dict[str, CutSets]) -> None:
    pairs = {one.faults for sets in found.values() for one in sets.sets if one.order > 1}
    assert {frozenset(pair) for pair in pairs} == {frozenset(pair) for pair in proofs.PAIRS}


def test_every_fault_is_in_a_proof_or_named_as_simulated() -> None:
    proved = {f.name for some in (proofs.FUNCTIONAL, proofs.COUNTERS, proofs.STAGES_AT_0) for f in some}
    proved |= {f.name for f in proofs.SELECTION}
    assert {fault.name for fault in component_faults()} == proved | set(proofs.SIMULATED)


@pytest.mark.parametrize("missing", ["AND2 at 0", "signal 3 missing", "FF6 flips"])
def test_a_defeat_that_is_not_excused_is_found_out(missing: str) -> None:
    """Without the excuse of a wrong-side fault the invariants do not hold, and the list is refused."""
    hazard = HAZARDS["overspeed_without_brake"]
    excused = [f for f in proofs.FUNCTIONAL if f.name != missing]
    lemmas = tuple(proofs.chain(excused).lemmas())
    with pytest.raises(ModelError, match="not shown for every combination"):
        cut_sets(replace(hazard, claim=replace(hazard.claim, lemmas=lemmas)))


# --- without a solver ------------------------------------------------------------------------------------------------


def braked(name: str, strike: int, begins: int) -> bool:
    """Whether the brake is there at every one of the last 100 steps of overspeed."""
    (fault,) = (f for f in component_faults() if f.name == name)
    at = begins - 1 - (fault.ticks or 0) if fault.ticks else strike
    onset = fault.onset if fault.ticks else "any time"
    built = instrument(trace(Equipment), [replace(fault, onset=onset, at=at)])
    choices = schedule(built)
    speeds = [500_000] * begins + [517_759] * (4019 + 100)
    lines = {f"lines.s{v}": v == 250 for v in (250, 210, 160, 110, 70, 30, 5)}
    seen = run(
        built.system, lambda k: {**lines, "speed": speeds[k], **choices(k)}, len(speeds), keep=["brake"]
    )["brake"]  # fmt: skip
    return all(seen[-100:])


@pytest.mark.parametrize(
    "name", ["generator open or short", "AND2 at 0", "counter 1: stage 3 at 1", "signal 2 missing"]
)
def test_a_cut_set_by_a_plain_run(name: str) -> None:
    assert not braked(name, 3000, 4182)


@pytest.mark.parametrize(
    "name", ["oscillator stops", "AND3 at 1", "AND1 at 0", "FF6 at 0", "counter 1: stage 3 at 0", "power dips"]
)
def test_what_is_no_cut_set_by_a_plain_run(name: str) -> None:
    assert braked(name, 3000, 4182) and braked(name, 5900, 5901)


def test_response_is_that_of_property_4() -> None:
    """(2 n2E + 5)/f2E seconds: at 250 km/h 0.62649, at 5 km/h 0.67817; a step is 155.8695 us, one is the reading."""
    for m, seconds in ((1035, 0.62649), (57, 0.67817)):
        assert Chain(m).braked * 155.8695e-6 == pytest.approx(seconds, abs=2 * 155.8695e-6 + 0.0005 * seconds)


def test_claims_are_expected_to_be_proved_or_are_defeats() -> None:
    assert [c.expect for c in CLAIMS.values()].count(PROVED) == 11
