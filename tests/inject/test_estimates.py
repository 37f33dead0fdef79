"""Shares of a campaign have the bounds that fit how its injections were chosen."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest

from safety.inject import Campaign, Group, Uniform, stuck_bits
from safety.inject.estimates import estimate
from safety.inject.statistics import Stratum, any_population, bounds, clustered, clustered_ratio, weighted

Make = Callable[..., Campaign]


def ends(found: Any) -> tuple[float, float]:
    return found.low, found.high


@pytest.fixture
def drawn(campaign: Make) -> Campaign:
    """The timer started at a drawn count, in five scenarios."""
    return campaign(
        start={}, vary={"count": Uniform(0, 15)}, scenarios=5, run_in=3, measured=4, block=4, safe_side=None,
        wrong_side=lambda counts: counts.total("lit") != counts.healthy("lit"),
    )  # fmt: skip


def test_under_drawn_scenarios_the_bounds_are_those_of_the_scenarios(drawn: Campaign) -> None:
    result = drawn.inject()
    tallies = list(result.by_scenario.values())
    found, missed = (
        [Fraction(tally[cell], tally.injections) for tally in tallies] for cell in ("wrong/yes", "wrong/no")
    )
    assert ends(result.dangerous_undetected_of_all) == clustered(missed, 0.99)
    assert ends(result.diagnostic_coverage) == clustered_ratio(found, missed, 0.99)


def test_that_nothing_else_was_seen_does_not_make_a_part_the_whole(drawn: Campaign) -> None:
    """Where each scenario had only cells that are asked for, others may still come in scenarios that were not drawn."""
    result = drawn.inject()
    seen = [cell for cell in result.tally.table if cell != "wrong/no"]
    part, whole = (
        estimate(result, cells, ["wrong/no"])
        for cells in (seen, [c for c in ("neutral/yes", "neutral/no", "safe/yes", "safe/no", "wrong/yes")])
    )
    assert part is not None and whole is not None and part.value == whole.value
    assert part.low < whole.low


def test_a_sample_of_all_is_bounded_by_its_population(campaign: Make) -> None:
    result = campaign(sample=9, seed=3).inject()
    low, high = bounds(result.tally.dangerous_undetected, 9, 14)
    assert ends(result.dangerous_undetected_of_all) == pytest.approx((float(low), float(high)), rel=1e-15)
    dangerous = result.tally.dangerous_detected + result.tally.dangerous_undetected
    assert ends(result.diagnostic_coverage) == any_population(result.tally.dangerous_detected, dangerous, 0.99)


def test_a_sample_by_group_is_bounded_by_strata(campaign: Make) -> None:
    groups = [
        Group("count", stuck_bits("count"), rate_per_h="1e-8", source="[A] x"),
        Group("lamp", stuck_bits("lit"), rate_per_h="9e-8", source="[A] x"),
    ]
    result = campaign(faults=groups, sample={"count": 5, "lamp": 1}, onsets=range(0, 96, 32)).inject()

    def strata(*weights: str) -> list[Stratum]:
        return [
            Stratum(
                r.group.name, Fraction(w), r.tally.injections, 0, r.tally["wrong/yes"], r.tally["wrong/no"], False, r.of
            )
            for r, w in zip(result.rows, weights, strict=True)
        ]

    assert result.diagnostic_coverage == weighted(strata("24", "6"), safe_too=False)
    assert result.weighted() == weighted(strata("1e-8", "9e-8"), safe_too=False)
