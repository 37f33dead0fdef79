"""Faults that come at any time, and lines that touch: verdicts, planted bugs, and latencies by running the ring."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import combinations

import pytest

from models.ts7.bench import CheckedRing, Strobed
from models.ts7.numbers import SPEEDS, WORD
from models.ts7.parts import CheckWindow
from models.ts7.ring import BITS_A_FRAME
from models.ts7.signals import Selection, WiredOr
from proofs import ts7_late_faults as late
from proofs import ts7_wired_lines as lines
from proofs.ts7_ring import FULL, HALF, SILENT
from safety import ANY_TIME
from safety.faults import Fault, instrument, schedule
from safety.prove.claims import Claim
from safety.prove.prove import prove
from safety.terms import Bit
from safety.trace import run
from safety.tracing import trace
from tests.proofs.planted import refuted
from tests.proofs.verdicts import check, claims_of, without_twin
from tests.seeded.check import Blind, FaultForgotten
from tests.seeded.signals import HighestSignal

CLAIMS = {**claims_of(late), **claims_of(lines)}


@pytest.mark.parametrize("claim", CLAIMS.values(), ids=CLAIMS)
def test_verdict(claim: Claim) -> None:
    check(prove(claim))


def test_every_proved_requirement_has_a_claim_that_fails() -> None:
    assert without_twin(CLAIMS) == []


class CountsTwice(Strobed, tick_s="3.90625e-6"):
    """Each overflow counts for two."""

    def step(self, overflow: Bit, strobe: Bit) -> tuple[Strobed, Bit]:
        following, fault = super().step(overflow, strobe)
        count = (following.count + following.count).low(8)
        return type(self)(frame=following.frame, count=count, faulty=following.faulty), fault


@pytest.mark.parametrize("variant", [Blind, FaultForgotten])
def test_a_window_that_does_not_keep_a_fault_is_refuted(variant: type[CheckWindow]) -> None:
    assert refuted(late.wrong_cell_is_found_whenever_it_comes, {"a.check": variant})


def test_a_wrong_count_is_refuted() -> None:
    assert refuted(late.a_frame_begins_as_the_proof_of_the_ring_starts, {"check": CountsTwice})


def test_the_highest_signal_is_refuted() -> None:
    assert refuted(lines.lines_that_touch_permit_no_more, {"": HighestSignal}, TOUCH_90)


TOUCH_90 = lines.together("s65", fault="s65 and s90 wired-OR")


# --- the ring, by running it ---------------------------------------------------------------------------------------

LATEST = 511 * BITS_A_FRAME + BITS_A_FRAME - 1  # bit times: 63.996 ms


def latency(fault: Fault, onset: int, ring: int) -> int:
    """Bit times from the first with the fault to the report."""
    late_one = Fault(fault.kind, fault.points, ANY_TIME, at=onset, name=fault.name)
    faulted = instrument(trace(CheckedRing), [late_one])
    rows = {"d0": 138, "d1": 164, "d2": 85, "d3": 11, "pulse": False}
    choices = schedule(faulted)
    seen = run(
        faulted.system, lambda k: {**rows, **choices(k)}, onset + LATEST + 1, start={"ring.ring": ring}, keep=["fault"]
    )
    return seen["fault"].index(True) - onset + 1


def test_a_fault_that_comes_within_a_frame_is_found_within_64_ms() -> None:
    rng = random.Random(64)
    for fault in rng.sample([*SILENT, *FULL], 4):
        assert latency(fault, rng.randrange(256 * BITS_A_FRAME), ring=rng.randrange(2**32)) <= LATEST


def test_the_latest_of_all() -> None:
    """A carry stuck at 1 from the second bit time of the first frame on: that block ends with 127."""
    assert latency(HALF, BITS_A_FRAME, ring=0) == 511 * BITS_A_FRAME
    assert (LATEST + 1) * Fraction(1, 256_000) == Fraction(64, 1000)


# --- lines together ------------------------------------------------------------------------------------------------

VALUES = {0: 0, **WORD}


def read(model: type[Selection], *active: int) -> int:
    return run(model, {f"lines.s{v}": v in active for v in (0, *SPEEDS)}, 1)["word"][0]


def test_which_pairs_of_lines_permit_more_than_either() -> None:
    """P11 for all pairs: 45 with 90 even reads as 255, 120 km/h; the reference reads each pair as the lower."""
    worse = {}
    for pair in combinations(VALUES, 2):
        assert read(Selection, *pair) == min(VALUES[v] for v in pair)
        if read(WiredOr, *pair) > max(VALUES[v] for v in pair):
            worse[pair] = read(WiredOr, *pair)
    assert worse == {(25, 45): 127, (25, 65): 191, (25, 75): 191, (45, 65): 223, (45, 75): 223, (45, 90): 255}
