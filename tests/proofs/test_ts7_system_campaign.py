"""The campaigns over the whole of TS-7: expectations made by hand, and no contradiction to the proved cut sets."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from dataclasses import replace
from fnmatch import fnmatchcase
from itertools import combinations, product
from pathlib import Path

import pytest

from models.ts7.failures import component_faults, component_modes
from models.ts7.system import Ts7
from proofs.ts7_hazards import overspeed_without_brake
from proofs.ts7_system_campaign import STRIKE, TOO_FAST, overspeed, pairs, roll_back
from safety import ANY_TIME
from safety.faults import Fault
from safety.inject import Group
from safety.inject.classes import Tally
from safety.inject.result import Result
from safety.prove.hazards import cut_sets, hazards

SINGLES = {
    "NB output welded",
    "shared oscillator fast",
    "signal lines wire-ORed with 25",
    "speed generator dead",
    "wheel switch on 780 mm",
    "wheel switch open",
    "wrong row in all channels",
}
SILENT = (  # the ways in which a channel's vote says "released" though the train is too fast
    "?.ring.select.j1 stuck-at-0",  # no wheel word, no speed
    "?.ring.matrix.j1 stuck-at-0 bit 5",  # wheel 132 instead of 164: 68.8 km/h look like 55
    "?.ring.matrix.j1 stuck-at-0 bit 7",  # wheel 36
    "?.ring.matrix.j0 stuck-at-1 bit 4",  # limit 154 words, 72.6 km/h
    "?.ring.matrix.j0 stuck-at-1 bit 5",  # 170
    "?.ring.matrix.j0 stuck-at-1 bit 6",  # 202
    "?.ring.overflow.o0 stuck-at-1",  # a reference pulse in every frame
    "?.ring.overflow.o1 stuck-at-0",  # no speed pulse
    "?.div0.n stuck-at-1 bit 3",  # divides by 8, twice the limit
    "?.comparator.u stuck-at-0",
    "?.comparator.latch stuck-at-0",
    "output amplifier ? oscillates",
    "common.?.nbrr_relay contact welded",
    "oscillator ? fast",  # 11 %: 146 words seem 131
    "row ? wrong",  # limit 191 words
    "row ? and that of 25",  # 138 OR 53 is 191
)
BY_HAND = [  # fault, against overspeed, against roll-back, why
    ("a.ring.matrix.j0 stuck-at-0 bit 7", "neutral/yes", "neutral/yes", "limit 10 words: brakes alone at 63, isolated"),
    ("a.ring.matrix.j0 stuck-at-1 bit 2", "neutral/no", "neutral/no", "limit 142 words: brakes with the others at 146"),
    ("b.ring.matrix.j1 stuck-at-0 bit 2", "neutral/no", "neutral/no", "wheel 160: 146 words seem 142, it brakes too"),
    ("c.ring.matrix.j2 stuck-at-1 bit 5", "neutral/no", "neutral/no", "check word 117, within the window"),
    ("c.ring.matrix.j2 stuck-at-1 bit 7", "neutral/yes", "neutral/yes", "check word 213, outside"),
    ("oscillator a fast", "neutral/yes", "neutral/no", "146 words seem 131: outvoted; 8 km/h backward seem 7.2"),
    ("row c wrong", "neutral/yes", "neutral/no", "limit 191 words: outvoted"),
    ("row of all and that of 25", "wrong/no", "neutral/no", "limit 138 OR 53 in every channel"),
    ("oscillator of all fast", "wrong/no", "neutral/no", "146 words seem 136.9"),
    ("oscillator b stops", "neutral/yes", "neutral/yes", "no AC: NBRR falls, isolated"),
    ("b.comparator.latch stuck-at-0", "neutral/yes", "neutral/no", "silent, outvoted by the two that brake"),
    ("a.rollback.latch stuck-at-0", "neutral/no", "neutral/no", "one report of three is enough"),
    ("c.check.faulty stuck-at-0", "neutral/no", "neutral/no", "dead detector: nothing to detect yet"),
    ("common.a.chr_relay coil open", "neutral/yes", "neutral/yes", "counts as isolated, the two others go on"),
    ("common.a.chr_relay contact welded", "neutral/no", "neutral/no", "nothing to isolate yet"),
    ("common.eb_relay coil open", "safe/no", "safe/no", "emergency brake at once"),
    ("common.eb_relay contact welded", "neutral/no", "wrong/no", "normal brake remains; roll-back has no other"),
    ("common.nb_relay contact welded", "wrong/no", "neutral/no", "roll-back has the emergency brake"),
    ("axle.backward flip", "safe/no", "wrong/no", "forward looks like roll-back, and roll-back like forward"),
    ("wheel_switch reads 172", "safe/no", "safe/no", "63 km/h look like 66.1"),
    ("power.inverter stuck-at-0", "safe/yes", "safe/yes", "50 ms without supply until change-over: relays fall"),
    ("power.mg stuck-at-0", "neutral/no", "neutral/no", "standby not needed"),
]


@pytest.fixture(scope="module")
def known() -> list[Fault]:
    """The 39 faults over which the cut sets are proved, striking as in the campaign."""
    return [replace(fault, onset=ANY_TIME, at=STRIKE) for fault in component_faults()]


@pytest.fixture(scope="module")
def both(known: list[Fault]) -> Result:
    """The 392 faults of the campaign and the 39 of the proof, side by side."""
    proof = Group("proof", known, rate_per_h="1e-9", source="[A] not used: all groups have a rate, or none has")
    return replace(overspeed, id="both", faults=[*overspeed.faults, proof], proofs=(), expect=None).inject()


@pytest.fixture(scope="module")
def backward() -> Result:
    return roll_back.inject()


@pytest.fixture(scope="module")
def sample() -> Result:
    return pairs.inject()


def cells(result: Result) -> dict[str, str]:
    """Cell of each single fault by its name."""
    return {injection.faults[0].name: cell for injection, cell in result.injections()}


def test_every_failure_mode_is_in_one_row() -> None:
    modes = [fault.name for faults in component_modes().values() for fault in faults]
    rows = [fault.name for group in overspeed.faults for fault in group.faults]  # type: ignore[union-attr]
    assert len(modes) == 392 and len(component_modes()) == 54
    assert Counter(rows) == Counter(modes)


def test_overspeed_is_as_declared(both: Result) -> None:
    tally = Tally.of([cell for injection, cell in both.injections() if injection.group != "proof"])
    found = tally.classes | tally.cells
    assert {name: found.get(name, 0) for name in overspeed.expect or {}} == overspeed.expect
    assert tally.injections == 392


def test_roll_back_is_as_declared(backward: Result) -> None:
    assert backward.surprises() == []
    assert (backward.tally.injections, backward.exhaustive) == (392, True)


@pytest.mark.parametrize(("fault", "fast", "back"), [case[:3] for case in BY_HAND])
def test_a_fault_comes_to_what_was_told_by_hand(
    both: Result, backward: Result, fault: str, fast: str, back: str
) -> None:
    assert (cells(both)[fault], cells(backward)[fault]) == (fast, back)


def test_dangerous_single_faults_lie_in_what_the_channels_share(both: Result, backward: Result) -> None:
    found = [
        {i.faults[0].name for i, _ in result.injections("dangerous_undetected") if i.group != "proof"}
        for result in (both, backward)
    ]
    blind = {"axle.pulse stuck-at-0", "wheel_switch reads 0"}
    rows = {"row of all wrong", "row of all and that of 25"}
    also = {"wheel_switch reads 156", "common.nb_relay contact welded", "oscillator of all fast"}
    assert found[0] == blind | rows | also
    assert found[1] == blind | {"axle.backward flip", "common.eb_relay contact welded"}


# --- proof and simulation ---------------------------------------------------------------------------------------------


def effect(fault: Fault) -> tuple[str, tuple[str, ...]]:
    """What a fault does, whatever its name; an open contact reads 0, a welded one 1."""
    kinds = {"open": "stuck-at-0", "welded": "stuck-at-1"}
    return kinds.get(str(fault.kind), str(fault.kind)), tuple(fault.points)


def name_of(known: list[Fault], fault: Fault) -> str | None:
    """Under which name the proof has this fault, if it has it."""
    return next((other.name for other in known if effect(other) == effect(fault)), None)


def test_dangerous_single_faults_are_the_proved_cut_sets(both: Result, known: list[Fault]) -> None:
    hazard = next(h for h in hazards() if h.id.endswith(f".{overspeed_without_brake.__name__}"))
    proved = cut_sets(replace(hazard, most=1))
    assert proved.complete_to == 1
    assert {name for one in proved.sets for name in one.faults} == SINGLES
    wrong = [i.faults[0].name for i, cell in both.injections() if cell.startswith("wrong") and i.group == "proof"]
    assert set(wrong) == SINGLES


def test_every_dangerous_single_mode_is_a_single_cut_set(both: Result, known: list[Fault]) -> None:
    """A mode that defeats the brake alone and is not among the faults of the hazard would come out as None."""
    modes = [(i.faults[0], cell) for i, cell in both.injections() if i.group != "proof"]
    dangerous = {fault.name: name_of(known, fault) for fault, cell in modes if cell.startswith("wrong")}
    assert [name for name, cut in dangerous.items() if cut not in SINGLES] == []
    assert set(dangerous.values()) == SINGLES and len(dangerous) == len(SINGLES)


def test_the_same_effect_comes_to_the_same_cell_under_both_names(both: Result, known: list[Fault]) -> None:
    twins = {i.faults[0].name: name_of(known, i.faults[0]) for i, _ in both.injections() if i.group != "proof"}
    twins = {name: twin for name, twin in twins.items() if twin}
    assert len(twins) == 32
    assert {name: cells(both)[name] for name in twins} == {name: cells(both)[twin] for name, twin in twins.items()}


def minimal_pairs(faults: list[Fault]) -> set[frozenset[str]]:
    """All pairs that defeat the brake, but for those with a fault that does so alone."""
    result = replace(overspeed, id="pairs of 39", faults=faults, order=2, expect=None).inject()
    assert (result.tally.injections, result.exhaustive) == (741, True)
    wrong = [{f.name for f in i.faults} for i, cell in result.injections() if cell.startswith("wrong")]
    assert len(wrong) == 353
    return {frozenset(names) for names in wrong if not names & SINGLES}


def test_dangerous_pairs_are_two_silent_channels(known: list[Fault]) -> None:
    modes = ("no f_v", "f_p in every frame", "wrong word", "comparator at 0", "latch at release", "NBRR welded")
    two = combinations("abc", 2)
    naive = {frozenset((f"{m}: {x}", f"{n}: {y}")) for m, n in two for x, y in product(modes, modes)}
    assert len(naive) == 108
    assert minimal_pairs(known) == naive


@pytest.mark.slow
def test_dangerous_pairs_are_the_proved_cut_sets(known: list[Fault]) -> None:
    hazard = next(h for h in hazards() if h.id.endswith(f".{overspeed_without_brake.__name__}"))
    proved = cut_sets(replace(hazard, most=2))
    assert proved.complete_to == 2
    assert {frozenset(one.faults) for one in proved.sets if one.order == 2} == minimal_pairs(known)


# --- the sample of pairs ----------------------------------------------------------------------------------------------


def channel_of(fault: Fault) -> str | None:
    """The channel that a fault silences."""
    return next((n for n in "abc" for p in SILENT if fault.name == p.replace("?", n)), None)


def test_the_sample_is_as_declared_and_says_that_it_is_one(sample: Result) -> None:
    assert sample.surprises() == []
    entry = sample.to_json()
    assert (entry["exhaustive"], entry["expect"]) == (False, {"exhaustive": False})
    assert entry["faults"] == "1000 of 66795 pairs of 366 faults, drawn with seed 1"


def test_a_sampled_pair_is_dangerous_when_it_silences_two_channels(sample: Result) -> None:
    for injection, cell in sample.injections():
        silent = {channel_of(fault) for fault in injection.faults} - {None}
        assert cell.startswith("wrong") == (len(silent) == 2), injection.id


def test_the_interval_holds_the_share_of_all_pairs(sample: Result) -> None:
    modes = [f.name for faults in component_modes().values() for f in faults]
    assert all(sum(fnmatchcase(name, pattern) for name in modes) == 3 for pattern in SILENT)
    found = sample.dangerous_undetected_of_all
    assert found is not None and found.exact is None
    assert found.low < 3 * len(SILENT) ** 2 / 66795 < found.high < 0.024


# --- the failure-mode table -------------------------------------------------------------------------------------------


def test_rates_are_invented_and_say_so(backward: Result) -> None:
    rows = [row.to_json() for row in backward.rows]
    assert len(rows) == 43
    assert all(row["tag"] == "A" and "invented" in row["source"] for row in rows)
    total, parts = sum(row["rate_per_h"] for row in rows), sum(backward.to_json()["by_rate"][k] for k in LAMBDAS)
    assert parts < total < 1 / 30_000  # no effect counts nowhere; the published MTBF


LAMBDAS = ("lambda_s", "lambda_dd", "lambda_du")


def test_lambda_du_of_roll_back_is_the_sum_of_its_four_faults(backward: Result) -> None:
    by_rate = backward.to_json()["by_rate"]
    assert by_rate["lambda_du"] == pytest.approx(1e-8 + 2e-7 + 1e-8 + 1e-7, rel=1e-12)
    assert (by_rate["lambda_dd"], by_rate["diagnostic_coverage"]["exact"]) == (0, "0")


# --- the ride and the judges ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("fault", ["common.nb_relay contact welded", "wheel_switch reads 156", "oscillator a stops"])
def test_an_injection_replays_to_its_cell(both: Result, fault: str) -> None:
    name = next(i.id for i, _ in both.injections() if i.faults[0].name == fault)
    assert overspeed.replay(name).cell == cells(both)[fault]


def test_the_healthy_ride_brakes_at_overspeed_only() -> None:
    braked = overspeed.replay(None, keep=["nb", "eb"]).trace
    fast = STRIKE + TOO_FAST.measured - 17 * TOO_FAST.block
    assert not any(braked["nb"][STRIKE:fast]) and not any(braked["eb"][STRIKE:])
    assert braked["nb"][fast:].index(True) < TOO_FAST.allowed
    assert all(braked["nb"][fast + TOO_FAST.allowed :])


def test_less_time_than_the_brake_needs_is_noticed() -> None:
    hasty = replace(TOO_FAST, allowed=16 * 32)
    declared = replace(overspeed, id="hasty", stimulus=hasty, measured=hasty.measured, block=hasty.block)
    assert declared.replay(None).cell == "wrong/no"


def test_declaring_loads_neither_numpy_nor_a_solver() -> None:
    code = "import sys, proofs.ts7_system_campaign; print(sorted({'numpy', 'z3', 'cvc5'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], cwd=Path(__file__).parents[2], capture_output=True, text=True)
    assert (done.stdout.strip(), done.stderr) == ("[]", "")


def test_the_equipment_is_the_reference_one() -> None:
    assert {campaign.model for campaign in (overspeed, roll_back, pairs)} == {Ts7}
