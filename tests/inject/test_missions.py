"""Missions with several faults: against every mission there is, by other strata, and what is refused."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from safety.faults import Fault, stuck
from safety.inject import Campaign, CampaignError, Group, stuck_bits
from safety.inject.classes import CELLS
from safety.inject.engine import NEVER, NONE, Batch
from safety.inject.judging import judge, onset_frames
from safety.inject.missions import mission

Make = Callable[..., Campaign]
CHANCES = {"run": Fraction("1e-3"), "lamp": Fraction("2e-3"), "alarm": Fraction("5e-2")}


@pytest.fixture
def short(campaign: Make) -> Campaign:
    """20 ticks; the watchdog that should see a timer stand still can itself be stuck."""
    groups = [Group("run", stuck_bits("run")), Group("lamp", stuck_bits("lit")), Group("alarm", stuck_bits("alarm"))]
    return campaign(faults=groups, run_in=4, measured=16, block=16)


def every_mission(campaign: Campaign) -> Fraction:
    """The exact probability: each combination of faults and onsets run, and weighed."""
    space, frames = campaign.space, range(campaign.timing.frames)
    names = [group.name for group in space.groups]
    dangerous = Fraction(0)
    for count in range(1, len(names) + 1):
        for faulty in itertools.combinations(range(len(names)), count):
            own = [[i for i, group in enumerate(space.of_group) if group == one] for one in faulty]
            single = list(itertools.product(*(itertools.product(atoms, frames) for atoms in own)))
            missions = np.array(single, dtype=np.int32)  # shape (missions, faults, 2)
            atoms, first = missions[:, :, 0].T, missions[:, :, 1].T
            batch = Batch(atoms.copy(), first.copy(), np.full_like(first, NEVER))
            engine = campaign.engine_of()
            cells = judge(campaign, engine.run(batch), engine.golden, onset_frames(campaign, batch)).cells
            weight = Fraction(1)
            for place, name in enumerate(names):
                weight *= CHANCES[name] if place in faulty else 1 - CHANCES[name]
            dangerous += weight * Fraction(int((cells == CELLS.index("wrong/no")).sum()), len(single))
    return dangerous


def test_the_probability_is_that_of_every_mission_there_is(short: Campaign) -> None:
    exact = every_mission(short)
    assert 0 < exact < Fraction(1, 100)
    found = mission(short, CHANCES, runs=20_000, seed=1)
    assert found.probability.low < exact < found.probability.high
    assert found.probability.value == pytest.approx(float(exact), rel=0.2)  # 200 dangerous ones among those drawn
    assert found.left_out == 0 and sum(s.weight for s in found.strata.values()) == 1
    assert list(found.strata) == [0, 1, 2, 3] and found.strata[3].of == 20_000


def test_the_bounds_hold_over_many_seeds(short: Campaign) -> None:
    exact = every_mission(short)
    found = [mission(short, CHANCES, runs=100, seed=seed).probability for seed in range(60)]
    assert sum(one.low <= exact <= one.high for one in found) >= 59  # at 99 %, and the bounds are wider than that
    values = np.array([one.value for one in found])
    assert abs(values.mean() - float(exact)) < 3 * values.std() / 60**0.5


def test_strata_may_be_any_function_of_what_is_faulty(short: Campaign) -> None:
    exact = every_mission(short)
    by_pattern = mission(short, CHANCES, runs=2000, stratum=lambda faulty: " ".join(sorted(faulty)))
    assert set(by_pattern.tallies) == {"run", "lamp", "alarm", "alarm run", "alarm lamp", "lamp run", "alarm lamp run"}
    assert by_pattern.probability.low < exact < by_pattern.probability.high
    assert by_pattern.probability.value == pytest.approx(float(exact), rel=0.03)
    blind = mission(short, CHANCES, runs=2000, stratum=lambda faulty: "alarm" in faulty)
    assert blind.probability.low < exact < blind.probability.high


def test_a_stratum_left_out_counts_as_dangerous(short: Campaign) -> None:
    whole, part = mission(short, CHANCES, runs=500), mission(short, CHANCES, runs={1: 500, 2: 500})
    weight = CHANCES["run"] * CHANCES["lamp"] * CHANCES["alarm"]
    assert part.left_out == weight == part.strata[3].weight and 3 not in part.tallies
    assert part.probability.value > 0 and part.probability.high >= whole.probability.value - 1e-6
    only = mission(short, CHANCES, runs={3: 10})
    assert only.probability.low > 0.95 * float(only.left_out)


def test_faults_last_as_long_as_those_of_the_campaign(campaign: Make) -> None:
    """The lamp stuck for one tick is not lit for long enough to be wrong; stuck for good it may be."""
    groups = [Group("lamp", stuck_bits("lit"))]
    brief, lasting = (campaign(faults=groups, onsets=range(96), length=length) for length in (1, None))
    found = [mission(one, {"lamp": "1e-3"}, runs=500).tallies[1] for one in (brief, lasting)]
    assert found[0].dangerous_undetected < found[1].dangerous_undetected


def test_all_missions_may_be_one_stratum(short: Campaign) -> None:
    plain = mission(short, {name: "1e-6" for name in CHANCES}, runs=50, stratum=lambda faulty: "all")
    assert plain.probability.value == 0 and plain.tallies["all"].injections == 50


def test_a_fault_free_run_that_is_judged_faulty_is_refused(campaign: Make) -> None:
    wrong = campaign(faults=[Group("lamp", stuck_bits("lit"))], wrong_side=lambda counts: counts.total("lit") > 0)
    with pytest.raises(CampaignError, match="the fault-free run is judged faulty; correct the judges"):
        mission(wrong, {"lamp": "1e-3"}, runs=10)


def test_a_rare_mission_takes_few_runs(short: Campaign) -> None:
    rare = {"run": "1e-9", "lamp": "1e-9", "alarm": "1e-9"}
    found = mission(short, rare, runs=1000)
    assert found.probability.high < 4e-9
    assert found.plain_runs > 1000 * sum(s.of for s in found.strata.values())


def test_a_batch_has_the_faults_of_its_missions(short: Campaign) -> None:
    from safety.inject.missions import _batch

    missions = [frozenset({"lamp"}), frozenset({"run", "alarm"}), frozenset()]
    batch = _batch(short, missions, np.random.default_rng(1))
    assert batch.atoms.shape == (2, 3)
    names = [
        [short.space.groups[short.space.of_group[a]].name for a in column if a != NONE] for column in batch.atoms.T
    ]
    assert [set(name) for name in names] == [set(faulty) for faulty in missions]
    assert ((batch.first >= 0) & (batch.first < 20)).all()


@pytest.mark.parametrize(
    ("chances", "options", "message"),
    [
        ({"run": "1e-3"}, {}, r"the chances differ from the groups in '(lamp|alarm)'"),
        ({**CHANCES, "rnu": "1"}, {}, "'rnu'; did you mean run"),
        ({**CHANCES, "run": "2"}, {}, "part 'run': probability 2"),
        ({**CHANCES, "run": 0.1}, {}, "write it in quotes"),
        (CHANCES, {"runs": {7: 10}}, r"runs name no stratum 7; they are 0, 1, 2, 3"),
        (CHANCES, {"runs": 0}, r"runs=0 tries no stratum that has a fault"),
    ],
)
def test_what_cannot_be_meant_is_refused(
    short: Campaign, chances: dict[str, Any], options: dict[str, Any], message: str
) -> None:
    with pytest.raises(CampaignError, match=message):
        mission(short, chances, **{"runs": 10, **options})


def test_a_mission_draws_from_all_faults(campaign: Callable[..., Campaign]) -> None:
    few = Group("any", lambda pick: Fault(stuck(pick.randrange(2)), ["lit"]), drawn=2)
    with pytest.raises(CampaignError, match="out of endlessly many"):
        mission(campaign(faults=[few]), {"any": "1/2"}, runs=10)


def test_faults_that_outlast_every_number_stay(campaign: Callable[..., Campaign]) -> None:
    found = [
        mission(campaign(faults=stuck_bits("*"), onsets=range(1), length=length), {"faults": "1/2"}, runs=100).tallies
        for length in (None, 2**31, 10**20)
    ]
    assert found[0] == found[1] == found[2]
