"""Scenarios that are drawn: inputs, settings and open registers, anew for each, and bounds over the scenarios."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest

from safety.faults import Fault, stuck
from safety.inject import Campaign, CampaignError, Choice, Group, Uniform, clopper_pearson, stuck_bits
from safety.model import Model

Make = Callable[..., Campaign]


@pytest.fixture
def varied(campaign: Make) -> Make:
    """The timer started at a drawn count; which faults are dangerous depends on it."""

    def make(**changes: Any) -> Campaign:
        declared: dict[str, Any] = {"start": {}, "vary": {"count": Uniform(0, 15)}, "scenarios": 4, "run_in": 3}
        declared |= {"measured": 4, "block": 4, "safe_side": None, "seed": 1}
        declared["wrong_side"] = lambda counts: counts.total("lit") > counts.healthy("lit")
        declared["detected"] = lambda counts: counts.ever("alarm")
        return campaign(**(declared | changes))

    return make


def test_each_scenario_has_all_injections(varied: Make) -> None:
    declared = varied()
    assert len(declared.space) == 4 * 14
    assert declared.space.statement == "all 14 single faults in each of 4 drawn scenarios"
    found = declared.inject()
    assert [tally.injections for tally in found.by_scenario.values()] == [14] * 4
    assert not found.exhaustive
    entry = found.to_json()
    assert entry["scenarios"][0].keys() == {"drawn", "counts"} and entry["expect"] == {"exhaustive": False}


def test_what_is_drawn_repeats_with_its_seed_and_scenario(varied: Make) -> None:
    drawn = [[varied(seed=seed).variant(k).values["count"] for k in range(4)] for seed in (1, 1, 2)]
    assert drawn[0] == drawn[1] != drawn[2] and len(set(drawn[0])) > 1
    assert varied(scenarios=2).variant(1).values == varied().variant(1).values


def test_every_injection_replays_in_its_scenario(varied: Make) -> None:
    declared = varied()
    found = declared.inject()
    for number in range(0, 56, 5):
        injection = declared.space.injection(number)
        assert injection.id.endswith(f" in scenario {number // 14}")
        assert declared.space.find(injection.id) == number
        again = declared.replay(injection.id)
        assert again.cell == found.cell(number)
        assert again.trace.chosen == {"count": declared.variant(number // 14).values["count"]}


def test_ranges_may_cross_scenarios(varied: Make) -> None:
    declared = varied()
    whole = declared.judged(0, 56).cells.tolist()
    parts = [declared.judged(low, min(low + 9, 56)).cells.tolist() for low in range(0, 56, 9)]
    assert [cell for part in parts for cell in part] == whole == varied(collapsing=False).judged(0, 56).cells.tolist()


def test_a_sample_is_drawn_anew_in_each_scenario(varied: Make) -> None:
    declared = varied(sample=5)
    assert declared.space.statement == "5 of 14 single faults in each of 4 drawn scenarios, drawn with seed 1"
    chosen = [{int(p) % 14 for p in declared.space.positions(k, k + 5)} for k in range(0, 20, 5)]
    assert len({frozenset(one) for one in chosen}) > 1
    assert [t.injections for t in declared.inject().by_scenario.values()] == [5] * 4


def test_it_is_the_scenarios_that_are_trials(varied: Make) -> None:
    """Four scenarios of 14 faults are no 56 independent trials: the interval is that of four."""
    found = varied().inject()
    share = found.dangerous_undetected_of_all
    assert share is not None and share.exact is None
    of_trials = clopper_pearson(found.tally.dangerous_undetected, 56)
    assert share.low < of_trials[0] and share.high > of_trials[1]
    parts = [Fraction(t["wrong/no"], 14) for t in found.by_scenario.values()]
    assert share.value == pytest.approx(float(sum(parts) / 4))


def test_by_rate_too(varied: Make) -> None:
    groups = [
        Group("count", stuck_bits("count"), rate_per_h="8e-8", source="[A] invented"),
        Group("lamp", stuck_bits("lit"), rate_per_h="2e-8", source="[A] invented"),
    ]
    found = varied(faults=groups).inject()
    weighted, plain = found.weighted(), found.diagnostic_coverage
    assert weighted is not None and plain is not None
    assert weighted.exact is None and 0 <= weighted.low < 0.1 and 0.9 < weighted.high <= 1
    with pytest.raises(CampaignError, match=r"no fault of group '\w+', which has a rate"):
        varied(faults=groups, sample=1).inject().weighted()


# --- what can be drawn ------------------------------------------------------------------------------------------------


def test_an_input_that_is_drawn_is_constant_or_follows_its_function(campaign: Make, timer: type[Model]) -> None:
    def pauses(pick: random.Random) -> Any:
        first = pick.randrange(5, 20)
        return lambda frame: frame != first

    fixed = campaign(vary={"run": Choice([True])}, scenarios=2, stimulus={})
    assert list(fixed.system.inputs) == []
    moving = campaign(vary={"run": pauses}, scenarios=2, stimulus={})
    rows = [[moving.variant(k).inputs(frame)["run"] for frame in range(20)] for k in (0, 1)]
    assert [row.count(False) for row in rows] == [1, 1] and rows[0] != rows[1]


def test_fractions_are_drawn_exactly() -> None:
    found = [Uniform(Fraction(1, 3), Fraction(2, 3))(random.Random(seed)) for seed in range(50)]
    assert all(isinstance(v, Fraction) and Fraction(1, 3) <= v <= Fraction(2, 3) for v in found)
    assert {Uniform(2, 4)(random.Random(seed)) for seed in range(50)} == {2, 3, 4}
    assert {Choice("ab")(random.Random(seed)) for seed in range(50)} == {"a", "b"}


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        ({"cuont": Uniform(0, 3)}, "vary names 'cuont'; did you mean count"),
        ({"still": Uniform(0, 3)}, "vary names 'still'"),
        ({"run": Choice([7])}, "input run is bit: 7 is not a value of it"),
        ({"count": Choice([16])}, "16 is not a value of it"),
    ],
)
def test_what_cannot_be_drawn_is_refused(varied: Make, vary: Any, message: str) -> None:
    with pytest.raises(TypeError, match=message):
        varied(vary=vary).inject()


def test_a_scenario_whose_fault_free_run_is_faulty_is_refused(varied: Make) -> None:
    with pytest.raises(CampaignError, match=r"the fault-free run of scenario \d is judged wrong/no"):
        varied(wrong_side=lambda counts: counts.total("lit") > 2, faults=[Fault(stuck(1), ["lit"])]).inject()
