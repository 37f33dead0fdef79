"""The exhaustive campaigns over TS-7: pinned counts, other readings on a sample, and what the single faults say."""

from __future__ import annotations

import importlib.util
import random
import re
import subprocess
import sys
from dataclasses import replace
from itertools import combinations, product
from pathlib import Path

import pytest

from proofs.ts7_brake_chain import RELEASE
from proofs.ts7_exhaustive_campaign import STRIKE, WITHIN, stuck_pairs, upsets
from proofs.ts7_system_campaign import TOO_FAST
from safety.faults import Fault, stuck
from safety.inject import Campaign
from safety.inject.classes import CELLS
from safety.inject.judging import UNDETECTED

DANGEROUS = {  # the only single stuck bits that defeat the brake
    "axle.pulse stuck-at-0",  # no speed pulse at all
    "wheel_switch stuck-at-0 bit 5",  # wheel word 132 instead of 164: 68.8 km/h look like 55
    "wheel_switch stuck-at-0 bit 7",  # wheel word 36
    "common.nb_relay.coil stuck-at-1",  # against overspeed there is no other brake
    "common.nb_relay.contact stuck-at-1",
}

native = pytest.mark.skipif(importlib.util.find_spec("llvmlite") is None, reason="the native engine needs llvmlite")


@pytest.fixture(scope="module")
def singles() -> Campaign:
    return replace(stuck_pairs, id="singles", order=1, expect=None)


def test_the_spaces_are_what_the_module_says() -> None:
    assert [len(c.space) for c in (upsets, stuck_pairs)] == [294 * 8000, 588 * 587 // 2]
    assert upsets.space.statement == "all 2352000 single faults at 8000 onsets"
    assert stuck_pairs.space.statement == "all 172578 pairs of 588 faults at step 2500"


@pytest.mark.parametrize("campaign", [upsets, stuck_pairs], ids=lambda c: c.id)
def test_a_random_sample_comes_out_the_same_on_the_python_reading(campaign: Campaign) -> None:
    pick = random.Random(5)
    for number in (pick.randrange(len(campaign.space)) for _ in range(2)):
        found, again = campaign.judged(number, number + 1), campaign.replay(number)
        by = None if found.detector[0] == UNDETECTED else list(campaign.detectors)[found.detector[0]]
        assert (CELLS[found.cells[0]], by) == (again.cell, again.detected_by), again.injection.id
        assert again.latency in (None, int(found.latency[0]))


@native
@pytest.mark.slow
@pytest.mark.parametrize("campaign", [upsets, stuck_pairs], ids=lambda c: c.id)
def test_a_larger_sample_comes_out_the_same_on_the_lanes(campaign: Campaign) -> None:
    engines = [replace(campaign, id=e, engine=e, sample=1500, seed=7, expect=None) for e in ("native", "lanes")]
    found = [each.inject().judged for each in engines]
    assert found[0].same(found[1]).all()


@native
@pytest.mark.slow
@pytest.mark.parametrize("campaign", [upsets, stuck_pairs], ids=lambda c: c.id)
def test_the_collapsed_space_is_the_whole_one(campaign: Campaign) -> None:
    assert replace(campaign, id="audited", audit=True).inject().surprises() == []


@native
def test_every_upset_is_as_declared() -> None:
    found = upsets.inject()
    assert found.surprises() == [] and found.exhaustive
    assert found.tally["wrong/yes"] == 0
    target = found.detected_by["target"]
    assert target["count"] == 47_046
    assert (target["latency"]["min"], target["latency"]["max"]) == (159, 159)  # the relay's time, and no more


def test_five_single_stuck_bits_defeat_the_brake(singles: Campaign) -> None:
    found = singles.inject()
    assert {i.faults[0].name for i, cell in found.injections() if cell.startswith("wrong")} == DANGEROUS
    assert found.tally["wrong/yes"] == 0


@native
def test_dangerous_pairs_are_two_silent_channels_or_have_a_dangerous_single() -> None:
    found = stuck_pairs.inject()
    assert found.surprises() == [] and found.exhaustive
    pairs = [
        tuple(fault.name for fault in injection.faults) for injection, cell in found.injections() if cell[0] == "w"
    ]
    silent = [pair for pair in pairs if not DANGEROUS & {*pair}]
    assert (len(pairs), len(silent)) == (2366 + 2687, 3 * 27**2)
    ways = {n: {name for pair in silent for name in pair if channel_of(name) == n} for n in "abc"}
    assert [len(names) for names in ways.values()] == [27, 27, 27]
    naive = {frozenset(pair) for m, n in combinations("abc", 2) for pair in product(ways[m], ways[n])}
    assert {frozenset(pair) for pair in silent} == naive


def channel_of(fault: str) -> str:
    """The channel that a fault is in: `a.f_v`, `lines_a.word` and `common.a.supply` are in a."""
    found = re.match(r"(?:lines_|common\.sync\.isolate_|common\.)?([abc])\b", fault)
    assert found, fault
    return found[1]


def test_collapsing_changes_nothing(singles: Campaign) -> None:
    audited = replace(singles, id="audited", audit=True).inject()
    assert audited.judged.same(singles.inject().judged).all()
    counts = singles.collapse().to_json()
    assert counts == {"single_faults": 588, "run": 386, "cannot_show": 141}


def test_the_hazard_waits_for_the_allowed_time(singles: Campaign) -> None:
    trace = singles.replay("axle.pulse stuck-at-0 from step 2500").trace
    assert trace["observed hazard"].index(True) == STRIKE + WITHIN + TOO_FAST.allowed - 1


@pytest.mark.parametrize(("length", "cell"), [(RELEASE - 1, "neutral/no"), (RELEASE, "wrong/no")])
def test_the_hazard_waits_for_a_relay(length: int, cell: str) -> None:
    contact = [Fault(stuck(1), ["common.nb_relay.contact"])]
    late = STRIKE + WITHIN + TOO_FAST.allowed + 100
    held = replace(upsets, id="held", faults=contact, onsets=range(late, late + 1), length=length, expect=None)
    assert [found for _, found in held.inject().injections()] == [cell]


def test_declaring_loads_neither_numpy_nor_a_solver() -> None:
    code = "import sys, proofs.ts7_exhaustive_campaign; print(sorted({'numpy', 'z3', 'cvc5'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], cwd=Path(__file__).parents[2], capture_output=True, text=True)
    assert (done.stdout.strip(), done.stderr) == ("[]", "")
