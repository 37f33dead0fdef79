"""What is refused when it is declared, and says what to write instead."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from safety.faults import ANY_TIME, Fault, stuck
from safety.inject import Campaign, CampaignError, Group

Make = Callable[..., Campaign]


@pytest.mark.parametrize("drawn", [0, -1, 2.5, True])
def test_a_group_draws_a_fault_or_more(drawn: Any) -> None:
    with pytest.raises(CampaignError, match=f"group 'any': drawn={drawn}; draw 1 fault or more"):
        Group("any", lambda pick: Fault(stuck(0), ["lit"]), drawn=drawn)


@pytest.mark.parametrize("rate", ["abc", "nan", "inf", "1/0", "", [1]])
def test_a_rate_is_a_number(rate: Any) -> None:
    with pytest.raises(CampaignError, match=r"group 'lamp': rate .* is no number; write e.g. '6.4e-8'"):
        Group("lamp", [Fault(stuck(0), ["lit"])], rate_per_h=rate, source="[A] invented")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"measured": 2.5}, "timer: measured=2.5 is no whole number"),
        ({"run_in": 1.0}, "run_in=1.0 is no whole number"),
        ({"block": 16.0}, "block=16.0 is no whole number"),
        ({"steps_per_frame": "2"}, "steps_per_frame='2' is no whole number"),
        ({"scenarios": 1.5}, "scenarios=1.5 is no whole number"),
        ({"order": 1.5}, "order=1.5 is no whole number"),
        ({"confidence": 1.5}, "confidence=1.5 lies between 0 and 1"),
        ({"onsets": [1, 2]}, r"onsets=\[1, 2\], length=None: write range\(first, end, step\)"),
        ({"onsets": range(2), "length": 1.5}, "length=1.5: write range"),
    ],
)
def test_a_number_that_is_none_is_refused(campaign: Make, changes: dict[str, Any], message: str) -> None:
    with pytest.raises(CampaignError, match=message):
        _ = campaign(**changes).space


# --- ids --------------------------------------------------------------------------------------------------------------


def named(*names: str, **schedule: Any) -> list[Fault]:
    points = ("count", "lit", "run", "alarm", "sum")
    return [Fault(stuck(0), [point], name=name, **schedule) for name, point in zip(names, points, strict=False)]


@pytest.mark.parametrize(
    ("faults", "more"),
    [
        (named("a", "b", "a & b", "b & c", "c"), {"order": 2}),
        (named("a", "b & c", "a & b", "c"), {"order": 2}),
        (named("a", "b & c", "d", "a & b", "c"), {"order": 3}),
        (named("a", "b & c", "a from step 3 & b", "c"), {"order": 2, "onsets": range(3, 5)}),
        (named("a", "b & c", "a from step 3 & b", "c", onset=ANY_TIME, at=3), {"order": 2}),
    ],
)
def test_names_that_give_two_pairs_one_id_are_refused(
    campaign: Make, faults: list[Fault], more: dict[str, Any]
) -> None:
    with pytest.raises(CampaignError, match=r"begins with the name of fault 'a.*', so that ids could mean two"):
        _ = campaign(faults=faults, **more).space


@pytest.mark.parametrize(
    ("faults", "more"),
    [
        (named("a", "b", "a & b", "b & c", "c"), {}),
        (named("a", "a & b", "c"), {"order": 2}),
        (named("a & b", "b & a", "c & d"), {"order": 2}),
        (named("a", "a & b", "b"), {"order": 2}),
        (named("a", "a & b", "c"), {"order": 3}),
    ],
)
def test_every_id_of_other_names_is_found(campaign: Make, faults: list[Fault], more: dict[str, Any]) -> None:
    space = campaign(faults=faults, **more).space
    ids = [injection.id for injection in space.injections]
    assert len(set(ids)) == len(ids) and [space.find(each) for each in ids] == list(range(len(ids)))
