"""Planted bugs: each wrong variant of TS-7 is refuted by a named claim of proofs/, with a replayed run.

A variant takes the place of the healthy part in the claim's own model; claim, faults and lemmas stay as they are.
"""

from __future__ import annotations

import functools
import importlib
import re
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from models.ts7.train import PER_WORD
from safety import BOUNDED, PROVED, REFUTED, Scenario
from safety.model import Model
from safety.prove.claims import Claim, registered
from safety.prove.prove import Outcome, prove
from tests.seeded import channel, check, ring, signals, voting
from tests.seeded.planting import planted

README = Path(__file__).parent / "seeded" / "README.md"


@dataclass(frozen=True)
class Plant:
    """A wrong part at some places of the model of a claim, and a run for the claim where its own does not show it."""

    variant: type[Model]
    places: tuple[str, ...]
    claim: str
    run: Scenario | None = None

    def __str__(self) -> str:
        return self.variant.__name__

    @property
    def wrong(self) -> str:
        """What is wrong, in one line."""
        return " ".join((self.variant.__doc__ or "").split())

    def refuting(self) -> Claim:
        """The claim about the variant; a run shows it, else the search for what is expected comes first."""
        healthy = claim(self.claim)
        model = planted(healthy.model, dict.fromkeys(self.places, self.variant))
        return replace(healthy, model=model, scenario=self.run or healthy.witness, expect=REFUTED)


def claim(name: str) -> Claim:
    """The claim of an id."""
    importlib.import_module(f"proofs.{name.partition('.')[0]}")
    return next(c for c in registered() if c.id == name)


@functools.cache
def healthy(name: str) -> Outcome:
    """What is found out about the claim on the model as it is."""
    return prove(claim(name))


def run_of(name: str) -> Scenario | None:
    """The run of another claim, one that is to fail on the healthy model."""
    return claim(name).scenario


def checked(word: int) -> Scenario:
    """The check window over four blocks with a check word."""
    return Scenario(1024, {"word": 138, "wheel": 164, "true_wheel": 164}, {"a.check_word": word})


def one_silent(steps: int) -> Scenario:
    """Signal 65: released, then 8 words too fast, while channel a never asks for the brake."""
    speed = {"speed": lambda k: PER_WORD * (30 if k < 2700 else 138 + 8)}
    toggling = {"a.output.level": lambda k: k % 2 == 1}
    return Scenario(2700 + steps, {"lines.s65": True, "inverter": True, **speed}, {}, ("a",), toggling, at=2500)


def rolling_forward() -> Scenario:
    """Forward at 30 words, signal 65."""
    return Scenario(6000, {"word": 138, "wheel": 164, "true_wheel": 164, "speed": 30 * PER_WORD})


def all_then_two() -> Scenario | None:
    """All three brake, then channel c falls silent."""
    return run_of("ts7_synchronisation.silence_ends_in_isolation_by_the_edge_rule")


def a_alone(then_b: bool = False) -> Scenario:
    """Channel a brakes for good; channel b, if at all, when a has been isolated."""
    drives = {"a.drive": lambda k: k < 1000, "b.drive": lambda k: k < 8000 or not then_b, "c.drive": True}
    return Scenario(16_000, {"supply": True, **drives}, {"sync.frames": 4000})


def supply_lost(*present: str, **power: object) -> Scenario:
    """Signal 65 at 30 words; faults, or the loss of sources, from frame 1000 on."""
    inputs = {"lines.s65": True, "speed": 30 * PER_WORD, "inverter": True, "mg": True, **power}
    return Scenario(6000, inputs, present=present, at=1000)


def change_over_then_nothing() -> Scenario:
    """The inverter fails, the motor-generator takes over, then it fails too."""
    return supply_lost(inverter=lambda k: k < 1000, mg=lambda k: k < 3000)


COMPARATOR, DIVIDER, WINDOW, LINES = ("a.comparator",), ("a.div0",), ("a.check",), ("lines_a", "lines_b", "lines_c")
BRAKES, RELEASES = "ts7_channel.brakes_two_kmh_above", "ts7_channel.releases_two_kmh_below"
NO_SIGNAL = "ts7_channel.brakes_without_signal_after_three_pulses"
FALSELY = "ts7_channel.never_brakes_falsely"
PASSES = "ts7_window.window_passes_65_to_127"
LOWERS = "ts7_voting.lowering_only_lowers"
ONE_BROKEN = "ts7_voting.brakes_with_one_channel_broken"
OPENS_IN_A = "ts7_power.what_opens_in_a_channel_votes_to_brake"
UNPOWERED = "ts7_power.stops_a_frame_after_the_release_time"
CARRY = "ts7_ring.ring_adds_four_words"
EB_CIRCUIT = "ts7_contacts.eb_circuit_needs_two_in_service_and_no_reverse"
SYNC = "ts7_synchronisation"

TABLE = [
    Plant(channel.LatchesAtTwo, COMPARATOR, FALSELY, run_of("ts7_channel.two_counts_would_do")),
    Plant(channel.NeverClears, COMPARATOR, RELEASES),
    Plant(channel.WrapsRound, COMPARATOR, BRAKES),
    Plant(channel.SignedCounter, COMPARATOR, NO_SIGNAL),
    Plant(channel.SwappedTrains, COMPARATOR, BRAKES),
    Plant(channel.DividesByEight, DIVIDER, BRAKES),
    Plant(channel.NeverStartsAnew, DIVIDER, BRAKES),
    Plant(channel.RaisesInsteadOfLowering, ("a", "b", "c"), LOWERS),
    Plant(channel.SignedWord, ("a",), RELEASES),
    Plant(channel.OffsetAtStop, ("a",), NO_SIGNAL),
    Plant(channel.WheelWordOfSevenBits, ("a",), BRAKES),
    Plant(channel.RollsBackForward, ("a",), "ts7_rollback.forward_is_no_roll_back", rolling_forward()),
    Plant(channel.StaticDrive, ("a.output",), "ts7_boundaries.an_output_that_stands_still_drops_the_drive"),
    Plant(ring.J1EveryFrame, ("a.ring",), FALSELY),
    Plant(ring.CarryNotCleared, ("",), CARRY),
    Plant(ring.CarryClearedLate, ("",), CARRY),
    Plant(check.Blind, WINDOW, PASSES, checked(0)),
    Plant(check.QuarterIsNormal, WINDOW, PASSES, checked(64)),
    Plant(check.HalfIsNormal, WINDOW, PASSES, checked(128)),
    Plant(check.SignedCount, WINDOW, PASSES, checked(190)),
    Plant(check.CountNotReset, WINDOW, "ts7_window.healthy_channel_is_never_found_faulty", checked(85)),
    Plant(check.FaultForgotten, WINDOW, PASSES, checked(21)),
    Plant(signals.HighestSignal, LINES, LOWERS),
    Plant(signals.LeastSignedWord, LINES, LOWERS),
    Plant(signals.NoLineIsNinety, LINES, LOWERS),
    Plant(voting.TwoOfTwo, ("common",), ONE_BROKEN, run_of("ts7_voting.brakes_by_rule_b")),
    Plant(voting.OneOfThree, ("common",), ONE_BROKEN, one_silent(5200)),
    Plant(voting.Inverted, ("common",), ONE_BROKEN),
    Plant(voting.EnergisedToBrake, ("common.nb_relay",), ONE_BROKEN),
    Plant(voting.IsolatedRuns, ("common.a",), OPENS_IN_A),
    Plant(voting.ChannelUpWithoutSupply, ("common.a",), OPENS_IN_A, supply_lost("supply of channel a lost")),
    Plant(voting.UpWithoutSupply, ("common",), UNPOWERED),
    Plant(voting.SupplyFromNowhere, ("power",), UNPOWERED, change_over_then_nothing()),
    Plant(voting.DualFaultRuns, ("",), "ts7_power.two_isolated_channels_apply_eb"),
    Plant(voting.WithoutRevC, ("",), EB_CIRCUIT),
    Plant(voting.IgnoresReports, ("sync",), "ts7_boundaries.a_channel_that_reports_its_fault_is_isolated"),
    Plant(voting.LowersAll, ("common.sync",), "ts7_boundaries.the_first_to_brake_is_not_lowered"),
    Plant(voting.IsolatesTheMajority, ("sync",), f"{SYNC}.a_pair_that_agrees_is_not_isolated", a_alone()),
    Plant(voting.GoesOnAfterIsolation, ("sync",), f"{SYNC}.synchronisation_isolates_at_most_one", a_alone(True)),
    Plant(voting.OnlyWhenOneStarts, ("sync",), f"{SYNC}.silence_ends_in_isolation", all_then_two()),
]
LONG = {CARRY}  # the bit-serial ring against four adders: minutes


@pytest.mark.parametrize("plant", TABLE, ids=str)
def test_a_planted_bug_is_refuted_by_its_claim(plant: Plant) -> None:
    outcome = prove(plant.refuting())
    assert outcome.verdict == REFUTED, outcome.why
    assert outcome.counterexample is not None
    assert outcome.counterexample["claim.holds"][-1] is False
    assert all(outcome.counterexample["claim.given"])


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=pytest.mark.slow if n in LONG else ()) for n in sorted({plant.claim for plant in TABLE})],
)
def test_the_healthy_model_keeps_the_claim(name: str) -> None:
    outcome = healthy(name)
    assert outcome.as_expected, f"{outcome.verdict}: {outcome.why}"
    assert outcome.verdict in (PROVED, BOUNDED)
