"""Cut sets of "too fast and no brake": their number, complete at every order over the 39 listed faults.

The same by brute force without a solver: `braked` builds faults into the equipment by list, with no budget and no
claim, and runs it on the Python reading; the speed and the brakes are read off the run by plain arithmetic.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import pytest

from models.ts7.failures import component_faults
from models.ts7.system import Ts7
from proofs import ts7_hazards, ts7_rates
from safety.faults import ANY_TIME, instrument, schedule
from safety.prove.hazards import CONFIRMED, CutSets, Hazard, cut_sets, hazards
from safety.system import ModelError
from safety.trace import run
from safety.tracing import trace
from safety.trees.from_model import tree_entry

Names = frozenset[str]

WORD = 4096  # speed input for each word of 0.47124 km/h
SLOW, FAST = 30 * WORD, (138 + 8) * WORD  # signal 65 is word 138
STRIKES, SPEEDS_UP = 2300, 2500
FRAMES = 5104  # of overspeed, 0.638 s
LISTED = {fault.name: fault for fault in component_faults()}


@pytest.fixture(scope="module")
def hazard() -> Hazard:
    return next(h for h in hazards() if h.id == "ts7_hazards.overspeed_without_brake")


@pytest.fixture(scope="module")
def found(hazard: Hazard) -> CutSets:
    return cut_sets(hazard)


@pytest.fixture(scope="module")
def sets(found: CutSets) -> set[Names]:
    return {frozenset(one.faults) for one in found.sets}


def braked(names: Iterable[str]) -> bool:
    """Whether NB or EB is applied at any of the last 100 of 5204 frames too fast, after these faults have struck."""
    chosen = [replace(LISTED[name], onset=ANY_TIME, at=STRIKES) for name in sorted(names)]
    built = instrument(trace(Ts7, {"wheel": 172}), chosen)
    choices = schedule(built)
    usual: dict[str, Any] = {name: 0 if "speed" in name else False for name in built.system.inputs}
    usual |= {"lines.s65": True, "inverter": True, "mg": True}
    phases = {
        start: usual | {"speed": FAST if start == SPEEDS_UP else SLOW} | choices(start)
        for start in (0, STRIKES, SPEEDS_UP)
    }
    steps = SPEEDS_UP + FRAMES + 100
    seen = run(built.system, lambda k: phases[max(s for s in phases if s <= k)], steps, keep=("nb", "eb"))
    assert not any(seen["nb"][STRIKES - 100 : STRIKES])
    return any(seen["nb"][-100:]) or any(seen["eb"][-100:])


# --- what was found ------------------------------------------------------------------------------------------------


def test_the_list_is_complete_at_every_order_and_each_set_is_confirmed(found: CutSets, hazard: Hazard) -> None:
    assert len(LISTED) == 39
    assert found.by_order() == found.by_order(CONFIRMED) == dict(hazard.expect) == {1: 7, 2: 108, 3: 36, 4: 3}
    assert (found.complete_to, found.all_orders, found.why) == (4, True, "")


def test_no_set_contains_another(sets: set[Names]) -> None:
    assert not [(small, large) for small in sets for large in sets if small < large]


def test_the_sets_are_those_described_with_the_rates(sets: set[Names]) -> None:
    """A shared failure, or two channels each silenced by one failure or by a standing ring and its dead detector."""
    assert sets == {frozenset(one) for one in ts7_rates.cut_sets()}


def test_the_tree_of_the_model_gives_the_probability_of_the_rate_statement(found: CutSets, hazard: Hazard) -> None:
    entry = tree_entry(found, hazard)
    low, high = (float(ts7_rates.too_fast_and_no_brake(end)) for end in (0, 1))
    assert entry["as_expected"]
    assert entry["probability_low"] <= high
    assert low <= entry["probability_high"]
    assert entry["probability"] == pytest.approx(0.0038641, rel=1e-4)


# --- without a solver ----------------------------------------------------------------------------------------------


def test_every_single_fault_by_simulation(sets: set[Names]) -> None:
    defeats = {name for name in LISTED if not braked([name])}
    assert defeats == {name for one in sets if len(one) == 1 for name in one}


def sample(sets: set[Names], order: int, number: int) -> list[Names]:
    return random.Random(7).sample(sorted((s for s in sets if len(s) == order), key=sorted), number)


def test_a_sample_of_larger_sets_defeats_the_equipment_and_no_part_of_them_does(sets: set[Names]) -> None:
    for chosen in [*sample(sets, 2, 5), *sample(sets, 3, 2), *sample(sets, 4, 1)]:
        assert not braked(chosen), chosen
        for name in chosen:
            assert braked(chosen - {name}), chosen - {name}


def pairs() -> list[Names]:
    names = list(LISTED)
    return [frozenset((a, b)) for i, a in enumerate(names) for b in names[i + 1 :]]


def covered(pair: Names, sets: set[Names]) -> bool:
    return any(one <= pair for one in sets)


def test_a_sample_of_pairs_by_simulation(sets: set[Names]) -> None:
    compare(random.Random(11).sample(pairs(), 12), sets)


@pytest.mark.slow
def test_every_pair_by_simulation(sets: set[Names]) -> None:
    compare(pairs(), sets)


def compare(chosen: Sequence[Names], sets: set[Names]) -> None:
    assert {pair: not braked(pair) for pair in chosen} == {pair: covered(pair, sets) for pair in chosen}


# --- a wrong guard is noticed --------------------------------------------------------------------------------------


@pytest.mark.parametrize("forgotten", ["no f_v", "latch at release", "ring stuck"])
def test_a_lemma_that_forgets_a_fault_is_refused(
    forgotten: str, hazard: Hazard, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = ts7_hazards.struck

    def forgetful(s: Any, *names: str) -> Any:
        return real(s, *(name for name in names if name != f"a: {forgotten}"))

    monkeypatch.setattr(ts7_hazards, "struck", forgetful)
    with pytest.raises(ModelError, match=r"not shown for every combination of faults"):
        cut_sets(hazard)
