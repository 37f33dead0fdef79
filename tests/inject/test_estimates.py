"""Fractions fit how the injections were chosen: exact, hypergeometric, by group, and never from part of a run."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from safety.faults import ANY_TIME, Fault, stuck
from safety.inject import Campaign, CampaignError, Group, Judged, Result, stuck_bits
from safety.inject import counting as counting_module
from safety.inject.classes import CELLS
from safety.inject.judging import UNMADE
from safety.kinds import offset

Make = Callable[..., Campaign]
WRONG, NEUTRAL, FOUND = (CELLS.index(cell) for cell in ("wrong/no", "neutral/no", "wrong/yes"))


@pytest.fixture
def uneven(campaign: Make) -> Make:
    """A large group without danger and a small one that is all dangerous."""
    groups = [Group("large", stuck_bits("count", "sum")), Group("small", stuck_bits("lit"))]

    def make(**changes: Any) -> Campaign:
        return campaign(**({"faults": groups, "onsets": range(40)} | changes))

    return make


def given(declared: Campaign) -> Result:
    """A result in which every injection of the small group is dangerous, half of them detected, and no other."""
    judged = Judged.alike(len(declared.space), NEUTRAL)
    small = declared.space.keys(0, len(declared.space)) == 1
    judged.cells[np.flatnonzero(small)] = WRONG
    judged.cells[np.flatnonzero(small)[::2]] = FOUND
    return Result.of(declared, judged)


def test_all_is_exact(uneven: Make) -> None:
    found = given(uneven())
    share = found.dangerous_undetected_of_all
    assert share is not None and share.exact == Fraction(40, 18 * 40)
    assert found.exhaustive and found.groups["small"].table == {"wrong/yes": 40, "wrong/no": 40}


def test_a_sample_by_group_weighs_each_group_as_it_is_large(uneven: Make) -> None:
    """Half of those drawn are of the small group: their share among the injections drawn says nothing of all."""
    found = given(uneven(sample={"large": 40, "small": 40}))
    share = found.dangerous_undetected_of_all
    assert share is not None and share.exact is None
    assert found.tally["wrong/no"] / found.tally.injections == 0.25
    assert share.value == pytest.approx(40 / 720) and share.low < 40 / 720 < share.high < 0.25
    coverage = found.diagnostic_coverage
    assert coverage is not None and coverage.low < 0.5 < coverage.high
    assert found.detected_of_effective is None


def test_a_group_drawn_whole_is_known(uneven: Make) -> None:
    found = given(uneven(sample={"large": 40, "small": 80}))
    coverage = found.diagnostic_coverage
    assert coverage is not None and coverage.value == 0.5


def test_a_plain_sample_is_of_a_known_population(uneven: Make) -> None:
    found = given(uneven(sample=700, seed=2))
    share = found.dangerous_undetected_of_all
    assert share is not None and share.exact is None
    hits, left = found.tally["wrong/no"], 20
    assert hits / 720 <= share.low + 1e-9 and share.high <= (hits + left) / 720 + 1e-9  # 20 were not drawn


def test_what_was_cut_short_has_counts_and_no_fraction(uneven: Make) -> None:
    declared = uneven()
    judged = given(declared).judged
    judged.cells[100:] = UNMADE
    found = Result.of(declared, judged, interrupted=True)
    assert (found.tally.injections, found.diagnostic_coverage, found.weighted()) == (100, None, None)
    assert found.surprises() == ["interrupted after 100 of 720 injections"]
    assert len(list(found.numbers())) == 100


def test_results_of_another_space_are_refused(uneven: Make) -> None:
    with pytest.raises(CampaignError, match="700 results for 720 injections"):
        Result.of(uneven(), Judged.alike(700, NEUTRAL))


def test_the_replay_list_is_cut_and_says_of_how_many(uneven: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("safety.inject.result.MOST_REPLAYS", 7)
    entry = given(uneven()).to_json()
    assert (len(entry["replay"]), entry["replay_of"]) == (7, 40)
    assert entry["replay"][0] == "timer::lit stuck-at-0 from step 1"


@pytest.mark.parametrize("most_keys", [0, 2**18])
@pytest.mark.parametrize("piece", [1, 7, 2**20])
def test_counts_are_the_same_however_they_are_added_up(
    uneven: Make, monkeypatch: pytest.MonkeyPatch, piece: int, most_keys: int
) -> None:
    naive = given(uneven())
    expected = {name: tally.table for name, tally in naive.groups.items()}
    monkeypatch.setattr(counting_module, "PIECE", piece)
    monkeypatch.setattr(counting_module, "MOST_KEYS", most_keys)
    again = given(uneven())
    assert {name: tally.table for name, tally in again.groups.items()} == expected
    assert again.effective == naive.effective


# --- faults drawn from endlessly many ---------------------------------------------------------------------------------


def some(pick: random.Random) -> Fault:
    """The sum too high by some number, from some step on."""
    return Fault(offset(pick.randrange(1, 8)), ["sum"], ANY_TIME, at=pick.randrange(60))


def test_faults_that_are_drawn_are_no_whole_space(campaign: Make) -> None:
    groups = [Group("lamp", stuck_bits("lit")), Group("sum", some, drawn=30)]
    declared = campaign(faults=groups, seed=3)
    assert declared.space.statement == "all 32 single faults, 30 of them drawn with seed 3"
    assert [i.id for i in declared.space.injections] == [i.id for i in campaign(faults=groups, seed=3).space.injections]
    assert len({i.faults[0].at for i in declared.space.injections}) > 10
    found = declared.inject()
    assert not found.exhaustive and found.to_json()["expect"] == {"exhaustive": False}
    share = found.dangerous_undetected_of_all
    assert share is not None and share.exact is None and share.low < share.value < share.high
    for number in range(0, 32, 5):
        assert declared.replay(number).cell == found.cell(number)


def test_rates_weigh_what_is_drawn_with_bounds(campaign: Make) -> None:
    groups = [
        Group("lamp", stuck_bits("lit"), rate_per_h="1e-8", source="[A] invented"),
        Group("sum", some, rate_per_h="1e-8", source="[A] invented", drawn=20),
    ]
    found = campaign(faults=groups).inject()
    first, second = (row.to_json() for row in found.rows)
    assert (first["exhaustive"], second["exhaustive"]) == (True, False)
    low, high = second["bounds"]["lambda_du"]
    assert low < second["lambda_du"] < high <= 1e-8


@pytest.mark.parametrize("changes", [{"order": 2}, {"onsets": range(9)}, {"sample": 3}])
def test_what_is_drawn_is_injected_once(campaign: Make, changes: dict[str, Any]) -> None:
    still = Group("still", lambda pick: Fault(stuck(pick.randrange(2)), ["lit"]), drawn=4)
    with pytest.raises(CampaignError, match="is injected once a fault, singly"):
        campaign(faults=[still], **changes).inject()
