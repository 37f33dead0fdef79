"""The published fault campaign of the TS-7 ring, told a second time: naive, bit by bit, and using nothing of ours.

`naive` follows the words of the definition: 32 stages shifted one place a bit time, one adder, one carry; a fault is a
test in the place where it acts.  Its table has to be the campaign's, fault by fault.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import pytest

from proofs.ts7_campaign import channel_single_stuck, ring_single_stuck
from safety.inject import CampaignError, stuck_bits
from safety.inject.result import Result

WORDS = (138, 164, 85, 11)
Place = tuple[str, int, int]  # what, which (stage, bit, word; cell: 8 * word + bit), stuck at

TABLE = {  # direction/detected by class of fault, as published for this campaign
    "stage": {"safe/yes": 32, "wrong/yes": 32},
    "carry": {"safe/yes": 1, "wrong/yes": 1},
    "sum": {"safe/yes": 1, "wrong/yes": 1},
    "data": {"safe/yes": 1, "wrong/yes": 1},
    "column": {"neutral/no": 8, "safe/no": 3, "wrong/no": 3, "neutral/yes": 2},
    "cell J0": {"neutral/no": 11, "safe/no": 2, "wrong/no": 3},
    "cell J1": {"neutral/no": 11, "safe/no": 3, "wrong/no": 2},
    "cell J2": {"neutral/no": 14, "neutral/yes": 2},
    "cell J3": {"neutral/no": 16},
    "carry clear": {"neutral/no": 1},
    "word select": {"safe/no": 1, "wrong/no": 1, "neutral/yes": 1, "neutral/no": 1},
    "overflow": {"safe/no": 2, "wrong/no": 2, "neutral/yes": 2, "neutral/no": 2},
}


def places() -> Iterator[tuple[str, Place | None]]:
    """The 163 faults by the campaign's names."""
    for stage in range(32):
        yield from ((f"ring stuck-at-{v} bit {stage}", ("stage", stage, v)) for v in (0, 1))
    for what, point in (("carry", "carry.in+carry.out"), ("sum", "sum"), ("data", "data")):
        yield from ((f"{point} stuck-at-{v}", (what, 0, v)) for v in (0, 1))
    for bit in range(8):
        yield from ((f"column stuck-at-{v} bit {bit}", ("column", bit, v)) for v in (0, 1))
    for word in range(4):
        for bit in range(8):
            yield from ((f"matrix.j{word} stuck-at-{v} bit {bit}", ("cell", 8 * word + bit, v)) for v in (0, 1))
        yield f"select.j{word} stuck-at-0", ("select", word, 0)
        yield from ((f"overflow.o{word} stuck-at-{v}", ("overflow", word, v)) for v in (0, 1))
    yield "carry.clear stuck-at-0", ("clear", 0, 0)


def naive(place: Place | None) -> tuple[list[int], list[int]]:
    """Overflows of each word over the 4096 measured frames, and of the check word in each 256 of them."""
    what, which, value = place or ("", 0, 0)
    ring, carry = [0] * 32, 0
    totals, blocks = [0, 0, 0, 0], [0] * 16
    for frame in range(512 + 4096):
        for word in range(4):
            enabled = word != 1 or frame % 16 == 15
            datum = WORDS[word]
            if what == "cell" and which // 8 == word:
                datum = datum & ~(1 << which % 8) | value << which % 8
            if what == "select" and which == word:
                datum = 0
            if what == "column":
                datum = datum & ~(1 << which) | value << which
            for bit in range(8):
                if what == "stage":
                    ring[which] = value
                if bit == 0 and what != "clear":
                    carry = 0
                if what == "carry":
                    carry = value
                a = ring.pop(0)
                d = datum >> bit & 1 if enabled else 0
                if what == "data":
                    d = value
                ring.append(value if what == "sum" else a ^ d ^ carry)
                carry = 1 if a + d + carry >= 2 else 0
                if what == "carry":
                    carry = value
            pulse = carry if enabled else 0
            if what == "overflow" and which == word:
                pulse = value
            if frame >= 512:
                totals[word] += pulse
                if word == 2:
                    blocks[(frame - 512) // 256] += pulse
    return totals, blocks


def judged(totals: list[int], blocks: list[int]) -> str:
    """Direction and detection as the definition has them; reference counts are 0.512 s of the reference rates."""
    reference = [4312.5 * 0.512, 320.3125 * 0.512]
    if totals[0] == 0:
        permitted = 0.0
    elif totals[1] == 0:
        permitted = float("inf")
    else:
        permitted = 65 * (totals[0] / reference[0]) / (totals[1] / reference[1])
    direction = "wrong" if permitted > 67 else "safe" if permitted < 63 else "neutral"
    return direction + ("/no" if all(64 < n < 128 for n in blocks) else "/yes")


@pytest.fixture(scope="module")
def result() -> Result:
    return ring_single_stuck.inject()


def test_the_published_table_is_reproduced_class_by_class(result: Result) -> None:
    assert {name: dict(tally.cells) for name, tally in result.groups.items()} == TABLE
    assert result.surprises() == []


def test_77_of_163_are_detected_46_wrong_sided_and_11_of_these_undetected(result: Result) -> None:
    tally = result.tally
    assert (tally.injections, result.exhaustive, result.effective) == (163, True, 131)
    assert tally.classes == {"safe": 11, "detected": 77, "dangerous_undetected": 11, "no_effect": 64}
    assert (tally.dangerous_detected, tally.dangerous_undetected) == (35, 11)


def test_the_fractions_by_either_definition(result: Result) -> None:
    shares = [result.detected_of_all, result.detected_of_effective, result.diagnostic_coverage]
    shares += [result.safe_failure_fraction, result.weighted(), result.weighted(safe_too=True)]
    assert [str(s.exact) for s in shares if s] == ["77/163", "77/131", "35/46", "8/9", "5/6", "82/89"]


def test_all_70_faults_of_the_shared_path_are_detected(result: Result) -> None:
    shared = [result.groups[name] for name in ("stage", "carry", "sum", "data")]
    assert sum(t.injections for t in shared) == sum(t.classes["detected"] for t in shared) == 70


def test_the_check_word_stays_in_its_window_but_for_its_two_highest_bits(result: Result) -> None:
    found = [i.id for i, cell in result.injections("detected") if i.group == "cell J2"]
    assert found == ["matrix.j2 stuck-at-0 bit 6", "matrix.j2 stuck-at-1 bit 7"]  # words 21 and 213


def test_the_fault_free_run_has_the_rates_of_the_words() -> None:
    assert naive(None) == ([2208, 164, 1360, 176], [85] * 16)
    healthy = {name: counts[:, 0].tolist() for name, counts in ring_single_stuck.healthy.counts.items()}
    assert (sum(healthy["observed o0"]), sum(healthy["observed o1"]), healthy["observed o2"]) == (2208, 164, [85] * 16)


def test_the_naive_ring_has_the_same_163_faults(result: Result) -> None:
    assert {i.id for i, _ in result.injections()} == dict(places()).keys()


SAMPLE = random.Random(7).sample(sorted(dict(places())), 16)


def test_the_naive_ring_agrees_on_a_sample(result: Result) -> None:
    compare(result, SAMPLE)


@pytest.mark.slow
def test_the_naive_ring_agrees_on_every_fault(result: Result) -> None:
    compare(result, list(dict(places())))


def compare(result: Result, names: list[str]) -> None:
    cells = {injection.id: cell for injection, cell in result.injections()}
    where = dict(places())
    assert {name: judged(*naive(where[name])) for name in names} == {name: cells[name] for name in names}


@pytest.mark.parametrize("name", ["select.j1 stuck-at-0", "ring stuck-at-1 bit 17"])
def test_a_ring_fault_replays_to_its_cell(result: Result, name: str) -> None:
    replay = ring_single_stuck.replay(name)
    assert replay.cell == {i.id: cell for i, cell in result.injections()}[name]


@pytest.mark.slow
def test_every_dangerous_undetected_ring_fault_replays(result: Result) -> None:
    for injection, cell in result.injections("dangerous_undetected"):
        assert ring_single_stuck.replay(injection.id).cell == cell


@pytest.mark.parametrize(("check_word", "normal"), [(64, False), (65, True), (127, True), (128, False)])
def test_the_window_is_open_between_64_and_128(check_word: int, normal: bool) -> None:
    declared = replace(
        ring_single_stuck, id="window", constant={**ring_single_stuck.constant, "d2": check_word},
        faults=stuck_bits("column"), sample=1, expect=None,
    )  # fmt: skip
    if normal:
        assert declared.inject().tally.injections == 1
    else:
        with pytest.raises(CampaignError, match="fault-free run is judged neutral/yes"):
            declared.inject()


def test_a_window_shifted_by_one_is_noticed() -> None:
    shifted = replace(
        ring_single_stuck,
        id="shifted",
        detected=lambda counts: ((counts["o2"] <= 69) | (counts["o2"] >= 127)).any(axis=0),
    )
    assert [line for line in shifted.inject().surprises() if line.startswith("cell J2")]


# --- the channel on the bench -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def channel() -> Result:
    return channel_single_stuck.inject()


def test_the_channel_is_as_declared(channel: Result) -> None:
    assert channel.surprises() == []
    assert (channel.tally.injections, channel.exhaustive) == (144, True)


def test_the_window_finds_no_dangerous_fault_outside_the_shared_path(channel: Result) -> None:
    coverage = channel.diagnostic_coverage
    assert coverage is not None and (coverage.low, coverage.high) == (0, 0)
    parts = Counter(i.id.split()[0] for i, _ in channel.injections("detected"))
    assert parts == {"a.ring.matrix.j2": 2, "a.ring.select.j2": 1, "a.ring.overflow.o2": 2, "a.check.faulty": 1}


@pytest.mark.parametrize("position", [0, 60, 100, 139])
def test_a_channel_fault_replays_to_its_cell(channel: Result, position: int) -> None:
    assert channel_single_stuck.replay(position).cell == channel.cell(position)


def test_rates_are_assumed_and_say_so(channel: Result, result: Result) -> None:
    rows = [row.to_json() for found in (channel, result) for row in found.rows]
    assert {row["tag"] for row in rows} == {"A"}
    assert all("invented" in row["source"] for row in rows)
