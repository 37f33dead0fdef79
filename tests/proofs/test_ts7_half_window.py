"""The other reading of the check window: verdicts, the campaigns, and what it misses that the reference finds."""

from __future__ import annotations

import pytest

from models.ts7.half_window import HalfBench, HalfChannel, HalfWindow
from models.ts7.ring import BITS_A_FRAME, Ring
from models.ts7.train import PER_WORD
from proofs import ts7_half_window as half
from proofs import ts7_ring as ring
from proofs.ts7_campaign import ring_single_stuck
from proofs.ts7_formulas import Formula
from proofs.ts7_window import found, four_blocks, has_acted
from safety import PROVED, Bit, Seen, UInt, implies
from safety.faults import Fault, instrument, stuck
from safety.inject.result import Result
from safety.prove.claims import Claim
from safety.prove.prove import prove
from safety.system import repeat
from safety.trace import run
from safety.tracing import trace
from tests.proofs.planted import refuted
from tests.proofs.verdicts import OWN_LEMMAS, check, claims_of, of, without_twin

CLAIMS = claims_of(half)
LONG = ("every_shared_fault_but_one_is_found_by_half", "half_window_passes_65_to_191")


@pytest.mark.parametrize(
    "claim", [pytest.param(c, marks=[pytest.mark.slow] if n in LONG else []) for n, c in CLAIMS.items()], ids=CLAIMS
)
def test_verdict(claim: Claim) -> None:
    check(prove(claim))


def test_every_proved_requirement_has_a_claim_that_fails() -> None:
    assert without_twin(CLAIMS) == []


class ThreeQuartersIsNormal(HalfWindow, tick_s="125e-6"):
    """The upper end belongs to the window."""

    def normal(self, counted: UInt) -> Bit:
        return (counted > 64) & (counted <= 192)


class FindsNothing(HalfWindow, tick_s="125e-6"):
    """Whatever is counted is normal."""

    def normal(self, counted: UInt) -> Bit:
        return counted >= 0


@pytest.mark.parametrize(
    ("variant", "claim", "word"),
    [
        (ThreeQuartersIsNormal, half.half_window_passes_65_to_191, 192),
        (FindsNothing, half.half_window_passes_65_to_191, 0),
        (FindsNothing, half.dead_check_word_128_is_found, None),
        (FindsNothing, half.wrong_cell_of_bit_7_or_6_is_found_by_half, None),
    ],
)
def test_a_planted_bug_is_refuted(variant: type[HalfWindow], claim: Formula, word: int | None) -> None:
    run = None if word is None else four_blocks(**{"a.check_word": word})
    assert refuted(claim, {"a.check": variant}, run)


@pytest.mark.parametrize("word", [129, 130, 132, 136, 144, 160, 65, 191])
def test_words_that_stay_in_the_window(word: int) -> None:
    assert not any(bench_with(word))


@pytest.mark.parametrize("word", [0, 64, 192, 255])
def test_words_that_leave_the_window(word: int) -> None:
    assert bench_with(word).index(True) == 255


def bench_with(word: int) -> list[bool]:
    """Fault reports of 600 frames with a check word."""
    inputs = {"word": 138, "speed": 100 * PER_WORD, "true_wheel": 164, "wheel": 164, "lowered": False}
    rows = {**inputs, "backward": False}
    return run(HalfBench, rows, 600, settings={"check_word": word}, keep=["fault"])["fault"]


def test_the_matrix_holds_128() -> None:
    assert trace(HalfChannel).settings["check_word"].value == 128


@pytest.fixture(scope="module")
def result() -> Result:
    return half.half_window_ring.inject()


def test_the_campaign_is_as_declared(result: Result) -> None:
    assert result.surprises() == []
    assert (result.tally.injections, result.exhaustive) == (165, True)


def test_by_counts_the_two_readings_are_alike(result: Result) -> None:
    """Of the 163 faults either finds 77; of the 46 wrong-sided ones this reading 36, the reference 35."""
    reference = {i.id: cell for i, cell in ring_single_stuck.inject().injections()}
    here = {i.id: cell for i, cell in result.injections() if i.id in reference}
    assert len(here) == 163
    detected = [sum(cell.endswith("yes") for cell in cells.values()) for cells in (reference, here)]
    wrong = [sum(cell == "wrong/yes" for cell in cells.values()) for cells in (reference, here)]
    assert (detected, wrong) == ([77, 77], [35, 36])
    assert {name for name in here if here[name] != reference[name]} == {
        "column stuck-at-0 bit 6", "column stuck-at-1 bit 6", "column stuck-at-0 bit 7", "column stuck-at-1 bit 7",
        "matrix.j2 stuck-at-0 bit 6", "matrix.j2 stuck-at-1 bit 6", "matrix.j2 stuck-at-0 bit 7",
        "matrix.j2 stuck-at-1 bit 7",
    }  # fmt: skip


def test_a_lost_carry_is_wrong_sided_and_missed_here_but_found_by_the_reference(result: Result) -> None:
    assert {i.id: cell for i, cell in result.injections() if i.group == "carry into the adder"} == {
        "carry.in stuck-at-0": "wrong/no", "carry.in stuck-at-1": "wrong/yes",
    }  # fmt: skip
    assert half.NO_CARRY.name in {f.name for f in ring.SHARED.faults}
    assert [overflows(word) for word in (85, 128)] == [0, 128]


def overflows(word: int) -> int:
    """Overflows of a check word in 256 frames whose carry never reaches the adder."""
    made = instrument(repeat(trace(Ring), BITS_A_FRAME), [Fault(stuck(0), ["carry.in"])]).system
    seen = run(made, {"d0": 138, "d1": 164, "d2": word, "d3": 11, "pulse": False}, 256, keep=["o2"])
    return sum(seen["o2"])


def test_the_channel_campaign_is_that_of_the_reference() -> None:
    assert half.half_window_channel.inject().surprises() == []


def test_one_frame_less_is_not_proved() -> None:
    def sooner(s: Seen) -> Bit:
        return implies(has_acted(s, 382), found(s))

    assert of(half.dead_check_word_128_is_found, OWN_LEMMAS, formula=sooner, steps=4).verdict != PROVED
