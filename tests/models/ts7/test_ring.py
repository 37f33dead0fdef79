"""The ring: bit-serial against word by word, exact rate, and the fault places of the published campaign."""

from __future__ import annotations

import random
from collections import Counter
from fractions import Fraction

import pytest

from models.ts7.ring import BITS_A_FRAME, Overflow, Ring, Words
from safety.faults import Fault, instrument, stuck
from safety.system import repeat
from safety.trace import run
from safety.tracing import trace

FRAME = repeat(trace(Ring), BITS_A_FRAME)
OUT = Overflow._fields


def test_p1_clocks() -> None:
    assert trace(Words).clock.period == FRAME.clock.period == Fraction(1, 8000)
    assert 1 / (trace(Ring).clock.period or 0) == 256_000


def test_places_for_faults() -> None:
    rows = [f"{kind}.j{w}" for kind in ("matrix", "select") for w in range(4)]
    gates = [f"overflow.o{w}" for w in range(4)]
    serial = ["carry.clear", "carry.in", "carry.out", "column", "data", "overflow.strobe", "ring", "sum"]
    assert sorted(trace(Ring).points) == sorted(rows + gates + serial)
    assert sorted(trace(Words).points) == sorted(rows + gates)


@pytest.mark.parametrize("seed", range(4))
def test_ring_and_words_agree_frame_by_frame(seed: int) -> None:
    rng = random.Random(seed)
    data = {f"d{w}": rng.choice((0, 255, rng.randrange(256))) for w in range(4)}
    rows = [{**data, "d0": rng.randrange(256), "pulse": rng.random() < 0.5} for _ in range(200)]
    start = rng.randrange(2**32)
    serial = run(FRAME, rows, start={"ring": start, "carry": True})
    words = run(Words, rows, start={f"j{w}": start >> 8 * w & 255 for w in range(4)})
    for w in range(4):
        assert serial[f"o{w}"] == words[f"o{w}"]
        assert [r >> 8 * w & 255 for r in serial["ring"]] == words[f"j{w}"]


def test_words_are_sums_modulo_256() -> None:
    rng = random.Random(3)
    rows = [{f"d{w}": rng.randrange(256) for w in range(4)} | {"pulse": rng.random() < 0.5} for _ in range(500)]
    seen = run(Words, rows)
    totals = [0, 0, 0, 0]
    for k, row in enumerate(rows):
        for w in range(4):
            totals[w] += row[f"d{w}"] if w != 1 or row["pulse"] else 0
            assert sum(seen[f"o{w}"][: k + 1]) == totals[w] // 256


@pytest.mark.parametrize("word", [0, 1, 53, 85, 138, 164, 191, 255])
def test_property_4_exact_rate(word: int) -> None:
    seen = run(Words, {"d0": word, "d1": word, "d2": 85, "d3": 11, "pulse": True}, steps=768, start={"j0": 201})["o0"]
    for n in (1, 7, 100, 255, 256, 500):
        exact = Fraction(n * word, 256)
        counts = {sum(seen[k : k + n]) for k in range(768 - n)}
        assert counts <= {exact.__floor__(), exact.__ceil__()}


def test_all_information_passes_the_serial_output() -> None:
    """Advantage 8: the ring's output over 32 bit times is the whole of its state."""
    row = {"d0": 0, "d1": 0, "d2": 0, "d3": 0, "pulse": False}
    seen = run(Ring, row, steps=32, start={"ring": 0x12345678})["ring"]
    assert sum((r & 1) << k for k, r in enumerate(seen)) == 0x12345678


FAULTS = {
    "healthy": ([], "neutral"),
    "ring stage 5 at 0": ([Fault(stuck(0, bit=5), ["ring"])], "safe detected"),
    "ring stage 5 at 1": ([Fault(stuck(1, bit=5), ["ring"])], "wrong detected"),
    "carry at 0": ([Fault(stuck(0), ["carry.in", "carry.out"])], "safe detected"),
    "sum at 1": ([Fault(stuck(1), ["sum"])], "wrong detected"),
    "serial data at 1": ([Fault(stuck(1), ["data"])], "wrong detected"),
    "carry clear missing": ([Fault(stuck(0), ["carry.clear"])], "neutral"),
    "J1 not selected": ([Fault(stuck(0), ["select.j1"])], "wrong"),
    "J2 not selected": ([Fault(stuck(0), ["select.j2"])], "neutral detected"),
    "O1 at 1": ([Fault(stuck(1), ["overflow.o1"])], "safe"),
    "O1 at 0": ([Fault(stuck(0), ["overflow.o1"])], "wrong"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_few_faults_of_the_campaign(name: str) -> None:
    """The whole campaign of 163 faults stands with the injections; here a few on the plain run."""
    faults, expected = FAULTS[name]
    made = instrument(FRAME, faults).system
    rows = ({"d0": 138, "d1": 164, "d2": 85, "d3": 11, "pulse": k % 16 == 15} for k in range(512 + 4096))
    seen = run(made, rows, keep=OUT)
    total = Counter({o: sum(seen[o][512:]) for o in OUT})
    blocks = [sum(seen["o2"][k : k + 256]) for k in range(512, 4608, 256)]
    reference, speed = Fraction(total["o0"], 2208), Fraction(total["o1"], 164)
    direction = "neutral"
    if not reference or (speed and 65 * reference / speed < 63):
        direction = "safe"
    elif not speed or 65 * reference / speed > 67:
        direction = "wrong"
    detected = "" if all(64 < n < 128 for n in blocks) else " detected"
    assert direction + detected == expected
