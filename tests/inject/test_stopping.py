"""Campaigns that draw until they are sure: the right answer, by number and by rate, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest

from safety.faults import Fault, stuck
from safety.inject import CampaignError, Group, stuck_bits
from safety.inject.stopping import until_sure

Make = Callable[..., Any]


def rated(count: str = "8e-8", lamp: str = "2e-8") -> list[Group]:
    return [
        Group("count", stuck_bits("count"), rate_per_h=count, source="[A] invented"),
        Group("lamp", stuck_bits("lit"), rate_per_h=lamp, source="[A] invented"),
    ]


@pytest.mark.parametrize("figure", ["diagnostic_coverage", "safe_failure_fraction"])
@pytest.mark.parametrize("by_rate", [False, True])
def test_the_answer_agrees_with_injecting_everything(campaign: Make, figure: str, by_rate: bool) -> None:
    declared = campaign(faults=rated())
    result = declared.inject()
    truth = result.weighted(safe_too=figure != "diagnostic_coverage") if by_rate else getattr(result, figure)
    for target, answer in (
        (truth.exact - Fraction(1, 20), "sure above"),
        (truth.exact + Fraction(1, 20), "sure below"),
    ):
        found = until_sure(declared, target, figure=figure, by_rate=by_rate, seed=3)
        assert found.watch.answer == answer
        low, high = found.watch.bounds
        assert low < truth.exact < high
        assert found.watch.hits / found.watch.of == pytest.approx(float(truth.exact), abs=0.06)


def test_by_rate_a_frequent_mode_is_drawn_as_often_as_it_fails(campaign: Make) -> None:
    """The lamp has 2 faults of 10 and nine tenths of the rate; one of the two is dangerous and not detected."""
    declared = campaign(faults=rated("1e-8", "9e-8"))
    found = until_sure(declared, "0.999", by_rate=True, most=20_000)
    assert found.tally.injections <= 20_000 and found.by_rate
    everything = declared.inject().weighted()
    assert found.watch.bounds[0] < everything.exact < found.watch.bounds[1]


def test_it_ends_undecided_at_the_target_itself(campaign: Make) -> None:
    declared = campaign(faults=rated())
    found = until_sure(declared, declared.inject().diagnostic_coverage.exact, most=5000)
    assert (found.watch.answer, found.tally.injections) == ("go on", 5000)
    entry = found.to_json()
    assert entry["figure"] == "diagnostic_coverage" and entry["cells"] == found.tally.table
    assert entry["anytime"]["low"] < entry["fixed"]["low"]


def test_onsets_and_pairs_are_drawn_too(campaign: Make) -> None:
    for more in ({"onsets": range(0, 96, 3)}, {"order": 2}):
        declared = campaign(faults=rated(), **more)
        truth = declared.inject().diagnostic_coverage.exact
        found = until_sure(declared, truth / 2)
        assert found.watch.answer == "sure above"
        assert found.watch.bounds[0] < truth < found.watch.bounds[1]


def test_the_same_seed_draws_the_same(campaign: Make) -> None:
    declared = campaign(faults=rated())
    one, same, other = (until_sure(declared, "0.3", most=3000, seed=seed).tally for seed in (1, 1, 2))
    assert one == same != other


def test_the_campaign_itself_stays_as_it_is(campaign: Make) -> None:
    declared = campaign(faults=rated())
    until_sure(declared, "0.9")
    assert declared.space.exhaustive and declared.inject().exhaustive


@pytest.mark.parametrize(
    ("changes", "options", "message"),
    [
        ({}, {"figure": "coverage"}, "figure 'coverage'; did you mean diagnostic_coverage"),
        ({}, {"target": 0.99}, r"target 0\.99; give a number between 0 and 1 in quotes"),
        ({}, {"target": "1"}, "target '1'"),
        ({"sample": 3}, {}, "sample draws already; leave it out"),
        (
            {"faults": [Group("any", lambda pick: Fault(stuck(pick.randrange(2)), ["lit"]), drawn=3)]},
            {},
            "out of endlessly",
        ),
        ({"order": 2}, {"by_rate": True}, "by_rate is for single faults"),
        ({"faults": [Group("lamp", stuck_bits("lit"))]}, {"by_rate": True}, "no group has a failure rate"),
    ],
)
def test_what_cannot_be_meant_is_refused(
    campaign: Make, changes: dict[str, Any], options: dict[str, Any], message: str
) -> None:
    declared = campaign(**{"faults": rated(), **changes})
    with pytest.raises(CampaignError, match=message):
        until_sure(declared, options.pop("target", "0.5"), **options)
