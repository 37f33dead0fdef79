"""Planted bugs: with each wrong variant of TS-7 in all its places, a campaign of the gate is red.

It is red when the fault-free run is judged faulty, when the counts are not those declared, or when an injection is in
another class than on the model as it is.  12 of the variants pass the campaigns of proofs/; the small ones of `gate.py`
are there for them.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from safety.inject import Campaign, CampaignError
from safety.inject import campaign as declared
from safety.inject.judging import Judged
from safety.model import Model, parts
from tests.inject.gate import GATE
from tests.seeded import behind, channel, check, ring, signals, voting
from tests.seeded.planting import planted
from tests.seeded.table import TABLE

SEEN_BY: dict[str, list[type[Model]]] = {
    "ts7_channel_single_stuck": [
        channel.LatchesAtTwo, channel.NeverClears, channel.WrapsRound, channel.SignedCounter, channel.SwappedTrains,
        channel.DividesByEight, channel.NeverStartsAnew, channel.RaisesInsteadOfLowering, channel.SignedWord,
        channel.WheelWordOfSevenBits, channel.RollsBackForward, channel.StaticDrive, ring.J1EveryFrame, check.Blind,
        check.CountNotReset, behind.DividesByFifteen, behind.StopsAtTwo, behind.DoesNotHold, behind.NeverReverse,
        behind.JudgesBelowOnly, behind.JudgesAboveOnly, behind.ReferenceAtPulses, behind.LowersTwice,
    ],
    "ts7_ring_single_stuck": [ring.CarryNotCleared],
    "gate_ring_counts": [ring.CarryClearedLate],
    "gate_check_words": [check.QuarterIsNormal, check.HalfIsNormal, check.FaultForgotten, check.SignedCount],
    "gate_no_signal": [channel.OffsetAtStop],
    "gate_two_isolated": [voting.DualFaultRuns, voting.IgnoresReports],
    "gate_the_first_is_not_lowered": [voting.LowersAll, behind.NobodyIsFirst, behind.EndsWithoutVerdict],
    "gate_one_of_three_falls_silent": [voting.OnlyWhenOneStarts, behind.NeverIsolatesC],
    "gate_no_source": [voting.SupplyFromNowhere, behind.SupplyIsThere],
    "gate_short_dips": [behind.ReleasesAtOnce],
    "gate_two_see_no_roll_back": [voting.WithoutRevC],
    "ts7_roll_back_single_faults": [
        signals.HighestSignal, signals.LeastSignedWord, signals.NoLineIsNinety, voting.Inverted,
        voting.EnergisedToBrake, voting.ChannelUpWithoutSupply, voting.UpWithoutSupply, voting.IsolatesTheMajority,
        behind.ReleasesTooLate, behind.HoldsItself, behind.ThreeOfThree, behind.WithoutC, behind.OneIsolatedStops,
        behind.NoEmergencyForRollBack, behind.ForgetsWhoBraked, behind.WheelOfTheDrawing, behind.OneRowFurther,
        behind.SwapsTheRelays,
    ],
    "ts7_overspeed_single_faults": [voting.OneOfThree, behind.IsolatesWhoBrakes],
    "ts7_overspeed_channel_pairs": [voting.TwoOfTwo, voting.IsolatedRuns, voting.GoesOnAfterIsolation],
}  # fmt: skip
LONG = {"ts7_roll_back_single_faults", "ts7_overspeed_single_faults", "ts7_overspeed_channel_pairs"}
CASES = [
    pytest.param(name, variant, id=variant.__name__, marks=[pytest.mark.slow] if name in LONG else [])
    for name, variants in SEEN_BY.items()
    for variant in variants
]


@pytest.fixture(autouse=True)
def only_here(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Campaigns declared in a test are gone after it."""
    monkeypatch.setattr(declared, "_registry", dict(declared._registry))
    yield


def with_bug(campaign: Campaign, variant: type[Model]) -> Campaign:
    """The campaign on the model with the variant in the place of every part that it is a variant of."""
    part = next(base for base in variant.__mro__[1:] if base.__module__.startswith("models."))
    places = dict.fromkeys(found(campaign.model, part), variant)
    assert places, f"{campaign.id} has no {part.__name__}"
    return replace(campaign, id=f"{campaign.id} with {variant.__name__}", model=planted(campaign.model, places))


def found(model: type[Model], part: type[Model]) -> Iterator[str]:
    """Where a model has a part of a class; the place "" is all of it."""
    if model is part:
        yield ""
    for name, inner in parts(model).items():
        yield from (f"{name}.{place}".rstrip(".") for place in found(inner, part))


@functools.cache
def as_it_is(name: str) -> Judged:
    """How the injections of a campaign of the gate come out on the model as it is."""
    return GATE[name].inject().judged


def red(campaign: Campaign, name: str) -> str:
    """Why the gate does not let it pass; empty when it does."""
    try:
        result = campaign.inject()
    except CampaignError as error:
        return str(error) if "the fault-free run is judged" in str(error) else ""
    other = np.flatnonzero(result.judged.cells != as_it_is(name).cells)
    return "; ".join([*result.surprises(), *(["other injections than before"] if len(other) else [])])


@pytest.mark.parametrize(("name", "variant"), CASES)
def test_a_planted_bug_is_seen_by_a_campaign(name: str, variant: type[Model]) -> None:
    assert red(with_bug(GATE[name], variant), name)


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] if n in LONG else []) for n in GATE])
def test_the_model_as_it_is_passes(name: str) -> None:
    assert red(replace(GATE[name], id="again"), name) == ""


def test_every_planted_bug_is_there_once() -> None:
    listed = [variant for variants in SEEN_BY.values() for variant in variants]
    written = [v for v in vars(behind).values() if isinstance(v, type) and v.__module__ == behind.__name__]
    assert len(listed) >= 50
    assert sorted(v.__name__ for v in listed) == sorted(v.__name__ for v in {*(p.variant for p in TABLE), *written})
