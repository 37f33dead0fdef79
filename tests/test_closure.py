"""Proof and simulation put together: what a proof covers, what is left to simulation, and when the two contradict."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import pytest

from safety.closure import compared, covers
from safety.faults import (
    ANY_TIME,
    FROM_START,
    INTERMITTENT,
    TRANSIENT,
    Fault,
    any_of_faults,
    at_most,
    byzantine,
    flip,
    frozen,
    stuck,
)
from safety.inject import Campaign, CampaignError, Group
from safety.inject.variants import Choice
from safety.model import Model, parameter, point, power_up
from safety.prove.claims import PROVED, Claim, Seen, claim, registered
from safety.prove.hazards import Hazard
from safety.report.closing import settled
from safety.report.standing import DISAGREE, standing
from safety.terms import U4, Bit, at_least, select
from safety.tracing import trace


class Vote(NamedTuple):
    stop: Bit


class Lane(Model, event="tick"):
    """Counts while `go`; asks for a stop from 8 on."""

    count: U4 = power_up(0)
    limit: U4 = parameter(8, unit="step", within=(6, 12), source="[A]")

    def step(self, go: Bit) -> tuple[Lane, Vote]:
        count = select(go, (self.count + 1).sat(4), self.count)
        return Lane(count=point("next", count)), Vote(stop=point("asks", self.count >= self.limit))


class Voter(Model, event="tick"):
    """Two of three lanes stop."""

    a: Lane
    b: Lane
    c: Lane

    def step(self, go: Bit) -> tuple[Voter, Vote]:
        (a, x), (b, y), (c, z) = self.a.step(go), self.b.step(go), self.c.step(go)
        return Voter(a=a, b=b, c=c), Vote(stop=point("out", at_least(2, x.stop, y.stop, z.stop)))


SYSTEM = trace(Voter)
FAULTS = [Fault(stuck(0), [f"{n}.asks"], ANY_TIME) for n in "abc"] + [Fault(stuck(0), ["out"], ANY_TIME)]


@pytest.fixture
def stops() -> Callable[..., Claim]:
    """Declares the claim that the vote is there, with faults of choice."""

    def declare(faults: Any, model: type[Model] = Voter, **more: Any) -> Any:
        @claim(model, expect=PROVED, faults=faults, **more)
        def stops_at_eight(s: Seen) -> Bit:
            """From eight on there is a stop."""
            return ~((s.a["count"] >= 8) & (s.b["count"] >= 8) & (s.c["count"] >= 8)) | s.stop

        return stops_at_eight

    return declare


def campaign(*proofs: Any, **more: Any) -> Campaign:
    groups = [
        Group("lanes", FAULTS[:3], rate_per_h="3e-6", source="[A]"),
        Group("out", FAULTS[3:], rate_per_h="1e-6", source="[A]"),
    ]
    given = {"faults": groups, "proofs": proofs, "stimulus": {"go": True}, "measured": 20, **more}
    return Campaign(
        id="voter_closure", model=Voter, observe={"stop": "stop"},
        wrong_side=lambda seen: seen.total("stop") < seen.healthy("stop"), detected=lambda seen: seen.total("stop") < 0,
        **given,
    )  # fmt: skip


def rows(one: Campaign, hazards: list[Hazard] | None = None) -> list[dict[str, Any]]:
    return compared(one, one.inject(), registered(), hazards or [])


def results(id_: str, verdict: str) -> dict[str, Any]:
    return {"claims": [{"id": id_, "verdict": verdict}]}


@pytest.mark.parametrize(
    ("wide", "narrow", "expected"),
    [
        (Fault(byzantine(), ["a.*"]), Fault(stuck(0), ["a.asks"], ANY_TIME), True),
        (Fault(byzantine(), ["a.*"], ANY_TIME), Fault(flip(), ["a.next", "a.asks"], TRANSIENT, ticks=3), True),
        (Fault(byzantine(), ["a.asks"], ANY_TIME), Fault(flip(), ["a.next", "a.asks"], TRANSIENT, ticks=3), False),
        (Fault(stuck(0), ["a.asks"], ANY_TIME), Fault(stuck(0), ["a.asks"], ANY_TIME, at=9), True),
        (Fault(stuck(0), ["a.asks"], ANY_TIME), Fault(stuck(0), ["a.asks"]), True),
        (Fault(stuck(0), ["a.asks"]), Fault(stuck(0), ["a.asks"], ANY_TIME, at=9), False),
        (Fault(stuck(0), ["a.asks"], ANY_TIME), Fault(stuck(1), ["a.asks"], ANY_TIME), False),
        (Fault(stuck(0, 1), ["a.next"], ANY_TIME), Fault(stuck(0, 2), ["a.next"], ANY_TIME), False),
        (Fault(stuck(0), ["a.asks"], ANY_TIME), Fault(stuck(0), ["a.asks"], TRANSIENT, ticks=1), False),
        (Fault(stuck(0), ["a.asks", "b.asks"], ANY_TIME), Fault(stuck(0), ["a.asks"], ANY_TIME), False),
        (Fault(flip(), ["a.asks"], TRANSIENT, ticks=2), Fault(flip(), ["a.asks"], TRANSIENT, at=4, ticks=2), True),
        (Fault(flip(), ["a.asks"], TRANSIENT, ticks=2), Fault(flip(), ["a.asks"], TRANSIENT, at=4, ticks=3), False),
        (Fault(byzantine(), ["a.*"], INTERMITTENT), Fault(stuck(0), ["a.asks"], ANY_TIME, at=3), True),
        (Fault(byzantine(), ["a.*"], TRANSIENT, ticks=1), Fault(stuck(0), ["a.asks"], ANY_TIME, at=3), False),
        (Fault(byzantine(), ["a.*"], TRANSIENT, ticks=1), Fault(flip(), ["a.asks"], TRANSIENT, ticks=1), False),
        (Fault(frozen(), ["a.next"], ANY_TIME), Fault(frozen(), ["a.next"], ANY_TIME, at=3), True),
        (Fault(frozen(), ["a.next"], FROM_START), Fault(frozen(), ["b.next"]), False),
    ],
)
def test_a_fault_covers_what_it_can_do_itself(wide: Fault, narrow: Fault, expected: bool) -> None:
    assert covers(wide, narrow, SYSTEM) is expected


def test_proved_simulated_and_nothing_else(stops: Any) -> None:
    proof = stops(at_most(1, "lane"))
    one = campaign(proof)
    found = rows(one)
    assert [row["dangerous"] for row in found] == [False, False, False, True]
    assert [list(row["by"].values()) for row in found] == [["a"], ["b"], ["c"], []]
    entry = settled(
        {"id": one.id, "exhaustive": True, "closure": {"faults": found}},
        results("test_closure.stops_at_eight", "proved"),
    )
    parts = entry["closure"]["parts"]
    assert (parts["proved"]["faults"], parts["simulated"]["faults"], parts["sampled"]["faults"]) == (3, 1, 0)
    assert parts["proved"]["share_of_rate"] == 0.75 and parts["simulated"]["rate_per_h"] == 1e-6
    assert entry["closure"]["contradictions"] == [] and entry["closure"]["open"] == []


@pytest.mark.parametrize("verdict", ["bounded", "refuted", "undecided", "vacuous"])
def test_only_a_proof_closes(stops: Any, verdict: str) -> None:
    found = rows(campaign(stops(at_most(1, "lane"))))
    entry = {"id": "c", "exhaustive": False, "closure": {"faults": found}}
    for given in (results("test_closure.stops_at_eight", verdict), {}):
        told = settled(entry, given)["closure"]
        assert told["parts"]["proved"]["faults"] == 0 and told["parts"]["sampled"]["faults"] == 4
        assert told["open"] == ["test_closure.stops_at_eight"]


def test_a_fault_proved_harmless_and_found_dangerous_is_a_contradiction(stops: Any) -> None:
    found = rows(campaign(stops(at_most(1, FAULTS))))  # false: the output stuck stops nothing
    entry = {"id": "c", "exhaustive": True, "closure": {"faults": found}}
    told = settled(entry, results("test_closure.stops_at_eight", "proved"))["closure"]
    assert told["contradictions"] == ["out stuck-at-0: harmless by test_closure.stops_at_eight, dangerous in c"]
    for as_expected in (True, False):
        stands = standing("campaigns", {**entry, "as_expected": as_expected, "closure": told})
        assert stands.code == DISAGREE and "out stuck-at-0" in stands.reason


def test_a_cut_set_of_one_fault_is_not_closed_as_harmless(stops: Any) -> None:
    found = rows(campaign(stops(any_of_faults(FAULTS))))
    id_ = "test_closure.stops_at_eight"
    cuts = [{"faults": ["out stuck-at-0"]}, {"faults": ["a.asks stuck-at-0", "b.asks stuck-at-0"]}]
    tree = {"id": id_, "complete_to_order": 1, "cut_sets": cuts, "minimal_cut_sets": {"count": 2}}
    entry = {"id": "c", "exhaustive": True, "closure": {"faults": found}}
    told = settled(entry, {"trees": [tree]})["closure"]
    assert told["parts"]["proved"]["faults"] == 3 and told["contradictions"] == []
    for short in ({"complete_to_order": 0}, {"minimal_cut_sets": {"count": 3}}):
        assert settled(entry, {"trees": [tree | short]})["closure"]["open"] == [id_]


def test_a_claim_covers_the_settings_that_it_is_proved_for_or_leaves_open(stops: Any) -> None:
    for claimed, open_, injected, agree in (
        ({}, (), {"a.limit": 9}, False),
        ({}, (), {"a.limit": 8}, True),
        ({"a.limit": 9}, (), {"a.limit": 9}, True),
        ({"a.limit": 9}, (), {}, False),
        ({}, ("a.limit",), {"a.limit": 9}, True),
        ({"b.limit": 7}, ("a.limit",), {"a.limit": 9}, False),
    ):
        one = campaign(stops(at_most(1, "lane"), settings=claimed, symbolic=open_), settings=injected)
        if agree:
            assert len([row for row in rows(one) if row["by"]]) == 3
        else:
            with pytest.raises(CampaignError, match="in the claim"):
                rows(one)


def test_a_setting_that_is_drawn_is_compared_in_every_scenario(stops: Any) -> None:
    drawn = {"vary": {"a.limit": Choice([8, 9])}, "scenarios": 6, "seed": 1}
    assert {campaign(**drawn).variant(k).values["a.limit"] for k in range(6)} == {8, 9}
    with pytest.raises(CampaignError, match="9 here and 8 in the claim"):
        rows(campaign(stops(at_most(1, "lane")), **drawn))
    assert rows(campaign(stops(at_most(1, "lane"), symbolic=("a.limit",)), **drawn))


def test_claims_that_say_nothing_about_the_campaign_are_refused(stops: Any) -> None:
    for more, why in (
        ({"faults": None}, "allows no fault"),
        ({"faults": at_most(0, FAULTS)}, "allows no fault"),
        ({"faults": at_most(1, FAULTS), "given": lambda s: s.go}, "under assumptions"),
        ({"faults": at_most(1, FAULTS), "start": lambda s: s.a["count"] == 0}, "under assumptions"),
        ({"faults": at_most(1, FAULTS), "steps_per_frame": 2}, "in other steps"),
    ):
        with pytest.raises(CampaignError, match=why):
            rows(campaign(stops(**more)))
    with pytest.raises(CampaignError, match="which is no claim"):
        rows(campaign(lambda s: s))
    with pytest.raises(CampaignError, match="2 at once"):
        rows(campaign(stops(at_most(1, FAULTS)), order=2))
