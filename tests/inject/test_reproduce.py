"""Minimal reproducers of a small model, against every neighbour and every window, and ids that make the run again."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from safety.faults import Fault, flip, stuck
from safety.inject import Campaign, CampaignError, Group, stuck_bits
from safety.inject import reproduce as module
from safety.inject.reproduce import HARM, Unconfirmed, read, reproducer
from safety.inject.shrink import Acting, smaller
from safety.inject.space import window

Make = Callable[..., Campaign]


def cell(campaign: Campaign, *windows: Acting) -> str:
    """What faults with these windows come to on the Python reading."""
    steps = campaign.timing.frames * campaign.timing.steps
    faults = tuple(module._lasting(campaign.space.singles[one.place], one.first, one.end, steps) for one in windows)
    return campaign.replay(module._made(campaign, faults, tuple(one.place for one in windows), 0)).cell


def acting(campaign: Campaign, injection: Any) -> tuple[Acting, ...]:
    steps = campaign.timing.frames * campaign.timing.steps
    windows = (window(fault) for fault in injection.faults)
    return tuple(Acting(p, a, min(b, steps)) for p, (a, b) in zip(injection.places, windows, strict=True))


@pytest.mark.parametrize("order", [1, 2])
def test_every_reproducer_is_locally_minimal_and_does_the_harm(campaign: Make, order: int) -> None:
    declared = campaign(order=order, faults=stuck_bits("count", "lit") if order == 1 else stuck_bits("lit", "run"))
    dangerous = [one for one, _ in declared.inject().injections("dangerous_undetected")]
    assert dangerous
    for injection in dangerous:
        found = reproducer(declared, injection).injection
        assert declared.replay(found).cell == HARM
        neighbours = list(smaller(acting(declared, found)))
        assert [one for one in neighbours if cell(declared, *one) == HARM] == []


def test_a_permanent_fault_comes_down_to_one_tick(campaign: Make) -> None:
    """The lamp is lit for 8 of 16 ticks; stuck at the first dark one after the run-in, at 39, it is lit for 9."""
    found = reproducer(campaign(), read(campaign(), "lit stuck-at-1"))
    assert found.injection.id == "lit stuck-at-1, transient at 39 for 1"
    assert found.to_json() | {"runs": 0} == {
        "of": "lit stuck-at-1", "injection": "lit stuck-at-1, transient at 39 for 1", "faults": 1, "runs": 0,
    }  # fmt: skip


def test_no_window_at_all_is_shorter(campaign: Make) -> None:
    """Against brute force, where a longer window only adds harm."""
    declared = campaign(wrong_side=lambda counts: (counts["lit"] > 10).any(axis=0))
    found = reproducer(declared, read(declared, "lit stuck-at-1"))
    (one,) = acting(declared, found.injection)
    place, steps = one.place, declared.timing.frames
    harmful = [
        first
        for length in range(1, one.length + 1)
        for first in range(steps - length + 1)
        if cell(declared, Acting(place, first, first + length)) == HARM
    ]
    assert min(harmful) == one.first and one.length == 3


def test_faults_that_do_not_matter_are_dropped(campaign: Make) -> None:
    declared = campaign(order=3, faults=stuck_bits("lit", "still"))
    injection = read(declared, "lit stuck-at-1 & still stuck-at-0 bit 0 & still stuck-at-0 bit 1")
    assert reproducer(declared, injection).injection.id == "lit stuck-at-1, transient at 39 for 1"


def test_windows_are_whole_frames(campaign: Make) -> None:
    declared = campaign(
        steps_per_frame=4, measured=64, block=16, wrong_side=lambda c: c.total("lit") > c.healthy("lit")
    )
    found = reproducer(declared, read(declared, "lit stuck-at-1")).injection
    assert [step % 4 for fault in found.faults for step in window(fault)] == [0, 0]


def test_what_is_not_dangerous_is_refused(campaign: Make) -> None:
    with pytest.raises(CampaignError, match="timer::lit stuck-at-0: the faults given are not dangerous"):
        reproducer(campaign(), read(campaign(), "lit stuck-at-0"))


def test_an_engine_that_disagrees_with_the_python_reading_is_found_out(
    campaign: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    declared = campaign()
    monkeypatch.setattr(declared, "replay", lambda injection: SimpleNamespace(cell="safe/no"))
    with pytest.raises(Unconfirmed, match=r"is wrong/no on the .* engine, safe/no on the Python reading"):
        reproducer(declared, read(declared, "lit stuck-at-1"))


# --- ids -------------------------------------------------------------------------------------------------------------


def test_an_id_may_give_a_fault_any_schedule(campaign: Make) -> None:
    declared = campaign()
    for key in (
        "lit stuck-at-1", "lit stuck-at-1 from step 5", "lit stuck-at-1, transient at 39 for 1",
        "lit stuck-at-1, intermittent at 7", "lit stuck-at-1, transient at 4 for 9 & run stuck-at-0 from step 3",
    ):  # fmt: skip
        assert read(declared, key).id == key
    assert read(declared, 3) == declared.space.injection(3)


def test_a_name_may_hold_the_sign_between_names(campaign: Make) -> None:
    odd = [Fault(stuck(1), ["lit"], name="a & b"), Fault(flip(), ["lit"], name="c, transient at 3 for 1")]
    declared = campaign(faults=[Group("g", odd)])
    found = read(declared, "a & b, transient at 3 for 2 & c, transient at 3 for 1 from step 9")
    assert found.places == (0, 1) and [window(fault)[0] for fault in found.faults] == [3, 9]


@pytest.mark.parametrize("key", ["lit stuck-at-2", "lit stuck-at-1, transiently at 3 for 1", "", " & ", 99])
def test_an_id_that_means_nothing_is_refused(campaign: Make, key: str | int) -> None:
    with pytest.raises(CampaignError, match="injection"):
        read(campaign(), key)


@pytest.mark.parametrize("key", ["lit stuck-at-1 from step 96", "lit stuck-at-1, transient at 3 for 0"])
def test_a_schedule_that_cannot_be_is_refused(campaign: Make, key: str) -> None:
    with pytest.raises(CampaignError, match=r"begins at step 96, outside the run|a transient"):
        read(campaign(), key)
