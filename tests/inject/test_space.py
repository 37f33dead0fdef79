"""Which injections a campaign makes: all of them, or a sample that says so."""

from __future__ import annotations

import itertools
from collections import Counter
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety.faults import Fault, every, flip, frozen
from safety.inject import CampaignError, Group, each_bit, ranks, stuck_bits, upsets
from safety.inject.enumeration import enumerate_space
from safety.inject.ranks import Combinations, drawn
from safety.inject.space import window
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


# --- by number --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("n", "order"), [(1, 1), (7, 1), (7, 2), (7, 3), (9, 4), (3, 3)])
def test_a_combination_is_that_of_its_position(n: int, order: int) -> None:
    whole = Combinations(n, order)
    naive = list(itertools.combinations(range(n), order))
    positions = np.arange(len(whole))
    members = whole.at(positions)
    assert [tuple(column) for column in members.T.tolist()] == naive
    assert whole.position(members).tolist() == positions.tolist()


@given(st.integers(3, 4000), st.data())
def test_positions_of_many_triples_come_back(n: int, data: st.DataObject) -> None:
    whole = Combinations(n, 3)
    positions = np.array(data.draw(st.lists(st.integers(0, len(whole) - 1), min_size=1, max_size=20)), dtype=np.int64)
    members = whole.at(positions)
    assert (np.diff(members, axis=0) > 0).all() and members.min() >= 0 and members.max() < n
    assert whole.position(members).tolist() == positions.tolist()


@given(st.integers(1, 400_000), st.data())
@settings(max_examples=20, deadline=None)
def test_what_is_drawn_is_all_different_and_within(population: int, data: st.DataObject) -> None:
    number = data.draw(st.integers(1, population))
    found = drawn(population, number, 3)
    assert len(found) == number == len(set(found.tolist()))
    assert found[0] >= 0 and found[-1] < population and (np.diff(found) > 0).all()
    assert (found == drawn(population, number, 3)).all()


def test_every_position_is_drawn_as_often(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ranks, "FEW", 0)  # the generator for large numbers
    for number in (2, 7):
        often = Counter(p for seed in range(3000) for p in drawn(10, number, seed).tolist())
        mean = 3000 * number / 10
        assert all(abs(count - mean) < 5 * mean**0.5 for count in often.values()) and len(often) == 10


def test_onsets_multiply_the_faults_and_come_in_the_id(system: System) -> None:
    space = enumerate_space(system, [Group("g", stuck_bits("lit"))], onsets=range(4, 10, 3), length=2)
    assert ids(space) == [f"lit stuck-at-{v}, transient at {at} for 2" for v in (0, 1) for at in (4, 7)]
    assert space.statement == "all 4 single faults at 2 onsets"
    forever = enumerate_space(system, [Group("g", stuck_bits("lit"))], order=2, onsets=range(2))
    assert ids(forever)[1] == "lit stuck-at-0 from step 1 & lit stuck-at-1 from step 1"


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("more", [{}, {"onsets": range(0, 9, 2)}, {"onsets": range(3), "length": 4}, {"scenarios": 3}])
def test_a_batch_is_its_injections(system: System, order: int, more: dict[str, Any]) -> None:
    space = enumerate_space(system, [Group("g", stuck_bits("count", "lit"))], order=order, **more)
    batch = space.batch(5, 17)
    for column, number in enumerate(range(5, min(17, len(space)))):
        injection = space.injection(number)
        assert tuple(batch.atoms[:, column]) == injection.places
        windows = [window(fault) for fault in injection.faults]
        assert list(zip(batch.first[:, column], batch.end[:, column], strict=True)) == windows
        assert space.find(injection.id) == number


def test_names_that_hold_the_sign_between_names_are_found(system: System) -> None:
    allowed = {  # so that no two injections have one id
        1: ["x & y", "x", "y", "y & x", "z from step 3"],
        2: ["x & y", "x", "y", "y & v", "z from step 3"],
        3: ["x & y", "x", "v", "y & x & w", "z from step 3"],
    }
    for order, more in itertools.product((1, 2, 3), ({}, {"onsets": range(7)})):
        faults = [Fault(flip(), ["lit"], name=name) for name in allowed[order]]
        space = enumerate_space(system, [Group("g", faults)], order=order, **more)  # type: ignore[arg-type]
        found = [space.find(i) for i in ids(space)]
        assert found == list(range(len(space)))


def test_an_injection_that_was_not_drawn_is_said_to_be_so(system: System) -> None:
    space = enumerate_space(system, [Group("g", stuck_bits("lit"))], sample=1, seed=0)
    (drawn_one,) = ids(space)
    other = f"lit stuck-at-{1 - int(drawn_one[-1])}"
    assert space.find(drawn_one) == 0
    with pytest.raises(CampaignError, match="was not drawn; 1 of 2 single faults, drawn with seed 0"):
        space.find(other)


def test_keys_name_the_groups(system: System) -> None:
    groups = [Group("a", stuck_bits("lit")), Group("b", stuck_bits("alarm")), Group("c", stuck_bits("run"))]
    for order in (1, 2, 3):
        space = enumerate_space(system, groups, order=order, onsets=range(2), scenarios=2)
        keys = space.keys(0, len(space)).tolist()
        assert [space.group_name(key % space.group_keys) for key in keys] == [i.group for i in space.injections]
        assert [key // space.group_keys for key in keys] == [i.scenario for i in space.injections]


def test_a_sample_by_group_has_so_many_of_each(system: System) -> None:
    groups = [Group("a", stuck_bits("count")), Group("b", stuck_bits("sum", "still"))]
    space = enumerate_space(system, groups, onsets=range(5), sample={"a": 7, "b": 3}, seed=4)
    assert Counter(i.group for i in space.injections) == {"a": 7, "b": 3}
    assert space.statement == "10 of 110 single faults at 5 onsets, drawn by group with seed 4"
    assert space.sizes == {"a": 40, "b": 70} and space.by_group


@pytest.mark.parametrize(
    ("sample", "more", "message"),
    [
        ({"a": 1}, {}, "sample=0 of 2 injections of 'b'; choose 1 to 2"),
        ({"a": 3, "b": 1}, {}, "sample=3 of 2 injections of 'a'; choose 1 to 2"),
        ({"a": 1, "b": 1, "bb": 1}, {}, "sample names the group 'bb'; did you mean b"),
        ({"a": 1, "b": 1}, {"order": 2}, "a sample by group is of single faults"),
    ],
)
def test_a_sample_by_group_that_cannot_be_meant_is_refused(
    system: System, sample: Any, more: Any, message: str
) -> None:
    groups = [Group("a", stuck_bits("lit")), Group("b", stuck_bits("alarm"))]
    with pytest.raises(CampaignError, match=message):
        enumerate_space(system, groups, sample=sample, **more)


def test_a_space_of_many_millions_is_only_numbers(system: System) -> None:
    space = enumerate_space(system, [Group("g", stuck_bits("*"))], order=3, onsets=range(60_000))
    assert len(space) == space.population > 10**8
    assert space.find(space.injection(len(space) - 1).id) == len(space) - 1
    assert space.batch(len(space) - 3, len(space)).runs == 3
