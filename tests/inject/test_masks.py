"""Masks say the same as the fault kinds they are read off."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety.faults import (
    Fault,
    Kind,
    Seat,
    byzantine,
    delayed,
    extra,
    flip,
    frozen,
    missing,
    open_circuit,
    stuck,
    welded,
)
from safety.inject.masks import Mask, changes_nothing, mask_of, masks
from safety.system import ModelError, System, substitute
from safety.terms.graph import BIT, Sort, integer, uint, variable
from safety.terms.values import bit, const
from safety.tracing import trace

WIDTH = 8
WORD_KINDS = st.builds(stuck, st.sampled_from([0, 1]), st.none() | st.integers(0, WIDTH - 1)) | st.builds(
    flip, st.none() | st.integers(0, WIDTH - 1)
)
WIRE_KINDS = st.sampled_from([stuck(0), stuck(1), flip(), open_circuit(), welded()])


def seen(kind: Kind, sort: Sort, healthy: int) -> int:
    """The effect of a kind on a value, as its definition has it."""
    var = variable("any value", sort)
    term = kind.effect(Seat("", bit(True)), var)
    value = bool(healthy) if sort == BIT else healthy
    return int(substitute([term], {var.uid: const(value, sort)})[0].attr)


@given(st.lists(WORD_KINDS, min_size=1, max_size=4), st.integers(0, 2**WIDTH - 1))
def test_masks_of_words_one_after_the_other_are_their_effects(kinds: list[Kind], healthy: int) -> None:
    check(kinds, uint(WIDTH), healthy)


@given(st.lists(WIRE_KINDS, min_size=1, max_size=4), st.integers(0, 1))
def test_masks_of_wires_one_after_the_other_are_their_effects(kinds: list[Kind], healthy: int) -> None:
    check(kinds, BIT, healthy)


def check(kinds: list[Kind], sort: Sort, healthy: int) -> None:
    whole, value = Mask(sort.bounds[1], 0), healthy
    for kind in kinds:
        mask = mask_of(kind, sort)
        assert mask is not None
        whole, value = mask.after(whole), seen(kind, sort, value)
    assert (healthy & whole.keep) ^ whole.turn == value


def counts_one_more() -> Kind:
    return Kind("one more", "a word that is one too high", lambda _, healthy: (healthy + 1).low(WIDTH), ("uint",))  # type: ignore[operator]


@pytest.mark.parametrize("kind", [frozen(), delayed(2), byzantine(), counts_one_more()])
def test_memory_choice_and_arithmetic_have_no_mask(kind: Kind) -> None:
    assert mask_of(kind, uint(WIDTH)) is None


@pytest.mark.parametrize(("kind", "sort"), [(missing(), BIT), (extra(), BIT), (stuck(1), integer(-3, 3))])
def test_pulses_and_integers_have_no_mask(kind: Kind, sort: Sort) -> None:
    assert mask_of(kind, sort) is None


@pytest.fixture
def system(timer: Any) -> System:
    return trace(timer)


def test_a_pattern_is_masked_at_each_of_its_points(system: System) -> None:
    found = masks(system, Fault(stuck(1), ["l*", "alarm"]))
    assert found == {"lit": Mask(0, 1), "alarm": Mask(0, 1)}


def test_a_kind_that_does_not_fit_and_a_point_that_is_not_there_are_named(system: System) -> None:
    with pytest.raises(ModelError, match=r"missing pulse.* does not apply to count, a u4"):
        masks(system, Fault(missing(), ["count"]))
    with pytest.raises(ModelError, match=r"no point 'cuont'; did you mean count"):
        masks(system, Fault(stuck(1), ["cuont"]))
    with pytest.raises(ModelError, match=r"bits 0\.\.3, not bit 4"):
        masks(system, Fault(stuck(1, bit=4), ["count"]))


def test_a_cell_stuck_at_what_it_stores_changes_nothing(campaign: Callable[..., Any]) -> None:
    system = campaign(constant={"run": True}, stimulus={}).system
    assert changes_nothing(system, {"run": Mask(0, 1)})
    assert not changes_nothing(system, {"run": Mask(0, 0)})
    assert not changes_nothing(system, {"count": Mask(15, 0), "lit": Mask(0, 1)})
