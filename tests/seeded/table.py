"""Which wrong variant goes where, which claim refutes it, and by which run."""

from __future__ import annotations

import importlib
from dataclasses import dataclass, replace

from models.ts7.train import PER_WORD
from safety import REFUTED, Scenario
from safety.model import Model
from safety.prove.claims import Claim, registered
from tests.seeded import channel, check, ring, signals, voting
from tests.seeded.planting import planted


@dataclass(frozen=True)
class Plant:
    """A wrong part at some places of the model of a claim.

    `run` refutes the claim: a scenario, or that of the claim of this id; by default the claim's own witness, and
    without one the search finds it.
    """

    variant: type[Model]
    places: tuple[str, ...]
    claim: str
    run: Scenario | str | None = None

    def __str__(self) -> str:
        return self.variant.__name__

    @property
    def wrong(self) -> str:
        """What is wrong, in one line."""
        return " ".join((self.variant.__doc__ or "").split())

    def refuting(self) -> Claim:
        """The claim about the wrong model, with faults, assumptions and lemmas as they are."""
        healthy = claim(self.claim)
        model = planted(healthy.model, dict.fromkeys(self.places, self.variant))
        run = claim(self.run).scenario if isinstance(self.run, str) else self.run
        return replace(healthy, model=model, scenario=run or healthy.witness, expect=REFUTED)


def claim(name: str) -> Claim:
    """The claim of an id."""
    importlib.import_module(f"proofs.{name.partition('.')[0]}")
    return next(c for c in registered() if c.id == name)


# --- runs ----------------------------------------------------------------------------------------------------------

SLOWLY = {"speed": 30 * PER_WORD}
RUNS = {"lines.s65": True, "inverter": True, "mg": True, **SLOWLY}
ON_THE_BENCH = {"word": 138, "wheel": 164, "true_wheel": 164, **SLOWLY}
FORWARD = Scenario(6000, ON_THE_BENCH)
CHECK_WORD_85 = Scenario(1024, ON_THE_BENCH)
A_LOSES_ITS_SUPPLY = Scenario(6000, RUNS, present=["supply of channel a lost"], at=1000)
CHANGE_OVER_THEN_NOTHING = Scenario(6000, {**RUNS, "inverter": lambda k: k < 1000, "mg": lambda k: k < 3000})
A_NEVER_ASKS = Scenario(
    7900, {**RUNS, "speed": lambda k: PER_WORD * (30 if k < 2700 else 138 + 8)}, present=["a"], at=2500,
    values={"a.output.level": lambda k: k % 2 == 1},
)  # fmt: skip
ALL_IN_SERVICE = {"supply": True, "b.drive": True, "c.drive": True, "a.drive": lambda k: k < 1000}
A_BRAKES_ALONE = Scenario(16_000, ALL_IN_SERVICE, {"sync.frames": 4000})
THEN_B_ALONE = Scenario(16_000, {**ALL_IN_SERVICE, "b.drive": lambda k: k < 8000}, {"sync.frames": 4000})


def check_word(value: int) -> Scenario:
    """Another word in place of 85, over four blocks."""
    return Scenario(1024, ON_THE_BENCH, {"a.check_word": value})


# --- table ---------------------------------------------------------------------------------------------------------

COMPARATOR, DIVIDER, WINDOW, LINES = ("a.comparator",), ("a.div0",), ("a.check",), ("lines_a", "lines_b", "lines_c")
WHOLE = ("",)
BRAKES, RELEASES = "ts7_channel.brakes_two_kmh_above", "ts7_channel.releases_two_kmh_below"
NO_SIGNAL, FALSELY = "ts7_channel.brakes_without_signal_after_three_pulses", "ts7_channel.never_brakes_falsely"
PASSES, NEVER_FAULTY = "ts7_window.window_passes_65_to_127", "ts7_window.healthy_channel_is_never_found_faulty"
FORWARD_ROLLS = "ts7_rollback.forward_is_no_roll_back"
CARRY = "ts7_ring.ring_adds_four_words"
LOWERS, ONE_BROKEN = "ts7_voting.lowering_only_lowers", "ts7_voting.brakes_with_one_channel_broken"
OPENS_IN_A, UNPOWERED = (
    "ts7_power.what_opens_in_a_channel_votes_to_brake",
    "ts7_power.stops_a_frame_after_the_release_time",
)
DUAL_FAULT = "ts7_power.two_isolated_channels_apply_eb"
EB_CIRCUIT = "ts7_contacts.eb_circuit_needs_two_in_service_and_no_reverse"
AC_DRIVE = "ts7_boundaries.an_output_that_stands_still_drops_the_drive"
REPORTS = "ts7_boundaries.a_channel_that_reports_its_fault_is_isolated"
FIRST_STAYS = "ts7_boundaries.the_first_to_brake_is_not_lowered"
PAIR_STAYS = "ts7_synchronisation.a_pair_that_agrees_is_not_isolated"
ONE_ISOLATED = "ts7_synchronisation.synchronisation_isolates_at_most_one"
SILENCE_ENDS = "ts7_synchronisation.silence_ends_in_isolation"
BY_THE_EDGE_RULE = f"{SILENCE_ENDS}_by_the_edge_rule"

TABLE = [
    Plant(channel.LatchesAtTwo, COMPARATOR, FALSELY, "ts7_channel.two_counts_would_do"),
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
    Plant(channel.RollsBackForward, ("a",), FORWARD_ROLLS, FORWARD),
    Plant(channel.StaticDrive, ("a.output",), AC_DRIVE),
    Plant(ring.J1EveryFrame, ("a.ring",), FALSELY),
    Plant(ring.CarryNotCleared, WHOLE, CARRY),
    Plant(ring.CarryClearedLate, WHOLE, CARRY),
    Plant(check.Blind, WINDOW, PASSES, check_word(0)),
    Plant(check.QuarterIsNormal, WINDOW, PASSES, check_word(64)),
    Plant(check.HalfIsNormal, WINDOW, PASSES, check_word(128)),
    Plant(check.SignedCount, WINDOW, PASSES, check_word(190)),
    Plant(check.CountNotReset, WINDOW, NEVER_FAULTY, CHECK_WORD_85),
    Plant(check.FaultForgotten, WINDOW, PASSES, check_word(21)),
    Plant(signals.HighestSignal, LINES, LOWERS),
    Plant(signals.LeastSignedWord, LINES, LOWERS),
    Plant(signals.NoLineIsNinety, LINES, LOWERS),
    Plant(voting.TwoOfTwo, ("common",), ONE_BROKEN, "ts7_voting.brakes_by_rule_b"),
    Plant(voting.OneOfThree, ("common",), ONE_BROKEN, A_NEVER_ASKS),
    Plant(voting.Inverted, ("common",), ONE_BROKEN),
    Plant(voting.EnergisedToBrake, ("common.nb_relay",), ONE_BROKEN),
    Plant(voting.IsolatedRuns, ("common.a",), OPENS_IN_A),
    Plant(voting.ChannelUpWithoutSupply, ("common.a",), OPENS_IN_A, A_LOSES_ITS_SUPPLY),
    Plant(voting.UpWithoutSupply, ("common",), UNPOWERED),
    Plant(voting.SupplyFromNowhere, ("power",), UNPOWERED, CHANGE_OVER_THEN_NOTHING),
    Plant(voting.DualFaultRuns, WHOLE, DUAL_FAULT),
    Plant(voting.WithoutRevC, WHOLE, EB_CIRCUIT),
    Plant(voting.IgnoresReports, ("sync",), REPORTS),
    Plant(voting.LowersAll, ("common.sync",), FIRST_STAYS),
    Plant(voting.IsolatesTheMajority, ("sync",), PAIR_STAYS, A_BRAKES_ALONE),
    Plant(voting.GoesOnAfterIsolation, ("sync",), ONE_ISOLATED, THEN_B_ALONE),
    Plant(
        voting.OnlyWhenOneStarts,
        ("sync",),
        SILENCE_ENDS,
        "ts7_synchronisation.silence_ends_in_isolation_by_the_edge_rule",
    ),
]
