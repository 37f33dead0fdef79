"""Which injections a campaign makes: all of them, or a sample that says so."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from safety.faults import Fault, every, flip, frozen
from safety.inject import CampaignError, Group, each_bit, stuck_bits, upsets
from safety.inject.enumeration import enumerate_space
from safety.system import ModelError, System
from safety.tracing import trace


@pytest.fixture
def system(timer: Any) -> System:
    return trace(timer)


def ids(space: Any) -> list[str]:
    return [injection.id for injection in space.injections]


def test_stuck_bits_are_both_values_of_each_bit_of_each_point(system: System) -> None:
    space = enumerate_space(system, [Group("g", stuck_bits("count", "l*"))])
    words = [f"count stuck-at-{value} bit {bit}" for bit in range(4) for value in (0, 1)]
    assert ids(space) == [*words, "lit stuck-at-0", "lit stuck-at-1"]
    assert (space.exhaustive, space.population, space.statement) == (True, 10, "all 10 single faults")


def test_upsets_are_each_bit_at_each_step(system: System) -> None:
    space = enumerate_space(system, [Group("g", upsets("count", at=range(3)))])
    assert space.population == 12
    assert ids(space)[0] == "count flip bit 0, transient at 0 for 1"


def test_kinds_of_bits_and_of_points_mix(system: System) -> None:
    groups = [Group("bits", each_bit(lambda bit: (flip(bit),), "sum")), Group("points", every(frozen(), "*"))]
    space = enumerate_space(system, groups)
    assert space.sizes == {"bits": 4, "points": 6}


def test_pairs_are_all_pairs_in_order(system: System) -> None:
    groups = [Group("a", stuck_bits("lit")), Group("b", stuck_bits("alarm"))]
    single, pairs = (enumerate_space(system, groups, order=order) for order in (1, 2))
    assert ids(pairs) == [f"{x} & {y}" for x, y in itertools.combinations(ids(single), 2)]
    assert [i.group for i in pairs.injections] == ["a", "a & b", "a & b", "a & b", "a & b", "b"]
    assert pairs.statement == "all 6 pairs of 4 faults"


@pytest.mark.parametrize("order", [1, 2])
def test_a_sample_is_drawn_from_the_whole_and_repeats_with_its_seed(system: System, order: int) -> None:
    groups = [Group("g", stuck_bits("*"))]
    whole = ids(enumerate_space(system, groups, order=order))
    samples = [enumerate_space(system, groups, order=order, sample=9, seed=seed) for seed in (1, 1, 2)]
    assert ids(samples[0]) == ids(samples[1]) != ids(samples[2])
    assert len(set(ids(samples[0]))) == 9 and set(ids(samples[0])) <= set(whole)
    assert not samples[0].exhaustive
    assert samples[0].statement.endswith("drawn with seed 1")
    assert ids(enumerate_space(system, groups, order=order, sample=len(whole))) == whole


@pytest.mark.parametrize(
    ("groups", "more", "message"),
    [
        ([], {}, "no group has a fault"),
        ([Group("g", [])], {}, "group 'g' has no fault"),
        ([Group("g", [Fault(flip(), ["lit"])])], {"order": 2}, "there is no pair"),
        ([Group("g", stuck_bits("lit"))], {"order": 4}, "order 4"),
        ([Group("g", stuck_bits("lit"))], {"sample": 3}, "sample=3 of 2 injections; choose 1 to 2"),
        ([Group("g", stuck_bits("lit")), Group("g", stuck_bits("sum"))], {}, "group 'g' is there twice"),
        ([Group("g", stuck_bits("lit", "lit"))], {}, None),
        ([Group("g", stuck_bits("lit")), Group("h", stuck_bits("lit"))], {}, "fault 'lit stuck-at-0' is there twice"),
        ([Group("g", stuck_bits("lti"))], {}, "no point 'lti'; did you mean lit"),
    ],
)
def test_a_list_that_cannot_be_meant_is_refused(system: System, groups: list[Group], more: Any, message: str) -> None:
    if message is None:
        assert enumerate_space(system, groups, **more).population == 2
        return
    with pytest.raises(ModelError, match=message):
        enumerate_space(system, groups, **more)


def test_a_rate_is_exact_and_says_where_it_comes_from() -> None:
    with pytest.raises(CampaignError, match="write it in quotes"):
        Group("g", [], rate_per_h=1e-8, source="[A] guess")  # type: ignore[arg-type]
    with pytest.raises(CampaignError, match=r"start it with \[P\]"):
        Group("g", [], rate_per_h="1e-8", source="a guess")
    assert Group("g", [], rate_per_h="1e-8", source="[A] a guess").tag == "A"


def test_an_unknown_injection_is_answered_with_near_ones(system: System) -> None:
    space = enumerate_space(system, [Group("g", stuck_bits("lit"))])
    assert space.find("lit stuck-at-1") == space.find(1) == 1
    with pytest.raises(CampaignError, match="did you mean lit stuck-at-"):
        space.find("lit stuck-at-2")
    with pytest.raises(CampaignError, match="numbered 0 to 1"):
        space.find(2)
