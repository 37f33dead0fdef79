"""Shrinking ends where no smaller neighbour does the same harm, and a planted larger answer is told from it."""

from __future__ import annotations

import itertools
import random
from collections.abc import Callable, Sequence

import pytest

from safety.inject import shrink as shrinking
from safety.inject.shrink import Acting, Candidate, shrink, size, smaller

STEPS = 24


def acting(place: int = 0, first: int = 0, end: int = STEPS) -> Acting:
    return Acting(place, first, end)


def each(rule: Callable[[Candidate], bool]) -> shrinking.Harmful:
    """A judge of many out of a rule for one; every candidate has windows within the run."""

    def harmful(candidates: Sequence[Candidate]) -> list[bool]:
        for one in itertools.chain.from_iterable(candidates):
            assert 0 <= one.first < one.end <= STEPS
        return [rule(candidate) for candidate in candidates]

    return harmful


def covers(first: int, end: int) -> Callable[[Candidate], bool]:
    return lambda candidate: any(one.first <= first and end <= one.end for one in candidate)


def places(candidate: Candidate) -> list[int]:
    return [one.place for one in candidate]


def test_the_fewest_faults_stay() -> None:
    found = shrink(tuple(map(acting, range(6))), each(lambda c: {1, 4} <= set(places(c)) or places(c) == [0, 1, 2]))
    assert places(found) == [1, 4]


def test_many_faults_are_dropped_one_by_one_first() -> None:
    found = shrink(tuple(map(acting, range(12))), each(lambda c: {3, 10} <= set(places(c))))
    assert places(found) == [3, 10]


def test_a_permanent_fault_becomes_the_shortest_transient() -> None:
    (found,) = shrink((acting(),), each(covers(7, 12)))
    assert (found.first, found.end) == (7, 12)


def test_the_window_goes_to_the_earliest_steps() -> None:
    (found,) = shrink((acting(0, 9, 20),), each(lambda c: c[0].length >= 3 and c[0].first >= 2))
    assert (found.first, found.end) == (2, 5)


def test_what_has_to_stay_stays_permanent() -> None:
    (found,) = shrink((acting(),), each(lambda c: c[0].end == STEPS and c[0].first <= 5))
    assert found == acting(first=5)
    (found,) = shrink((acting(),), each(lambda c: c[0].length == STEPS))
    assert found == acting()


def test_windows_are_whole_frames() -> None:
    (found,) = shrink((acting(),), each(covers(7, 12)), grid=4)
    assert (found.first, found.end) == (4, 12)


def test_what_does_no_harm_is_refused() -> None:
    with pytest.raises(ValueError, match="nothing to shrink"):
        shrink((acting(),), each(lambda c: False))


def random_rule(seed: int) -> Callable[[Candidate], bool]:
    """Harm without any order in it: a longer window, an earlier one, more faults may each do less."""

    def rule(candidate: Candidate) -> bool:
        text = str([(one.place, one.first, one.end) for one in candidate])
        return random.Random(f"{seed} {text}").random() < 0.3 or size(candidate)[1] == STEPS * len(candidate)

    return rule


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.parametrize("wide", [3, 256])
def test_the_result_has_no_smaller_harmful_neighbour(seed: int, wide: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shrinking, "WIDE", wide)
    rule = random_rule(seed)
    start = tuple(map(acting, range(1 + seed % 3)))
    found = shrink(start, each(rule))
    assert rule(found) and size(found) <= size(start)
    assert [one for one in smaller(found) if rule(one)] == []


@pytest.mark.parametrize("seed", range(20))
def test_where_more_is_always_worse_the_result_is_the_least_of_all(seed: int) -> None:
    """Against brute force: all windows of one fault, where harm is to cover one of some windows of equal length."""
    pick = random.Random(seed)
    length, firsts = pick.randrange(1, 6), sorted(pick.sample(range(STEPS - 6), 3))
    rule = each(lambda c: any(covers(first, first + length)(c) for first in firsts))
    windows = [(acting(0, a, b),) for a in range(STEPS) for b in range(a + 1, STEPS + 1)]
    least = min(size(one) for one, bad in zip(windows, rule(windows), strict=True) if bad)
    assert size(shrink((acting(),), rule))[:2] == least[:2]


def test_smaller_neighbours_are_all_there_are() -> None:
    pair = (acting(0, 2, 4), acting(1, 0, 1))
    found = {tuple((one.place, one.first, one.end) for one in each_one) for each_one in smaller(pair)}
    assert found == {
        ((1, 0, 1),), ((0, 2, 4),), ((0, 2, 3), (1, 0, 1)), ((0, 3, 4), (1, 0, 1)),
        ((0, 1, 3), (1, 0, 1)),
    }  # fmt: skip
