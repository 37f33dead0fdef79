"""Shards: what is written comes back, the same answers make the same bytes, no damage is believed, all is small."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from hypothesis.extra.numpy import arrays

from safety.inject.classes import CELLS
from safety.inject.judging import NO_LATENCY, UNDETECTED, Judged
from safety.inject.store import shards
from safety.inject.store.shards import DamagedError, decode, encode, head

KEY = "0123456789ab" + "c" * 52


def same(one: Judged, other: Judged) -> bool:
    pairs = zip(one.arrays, other.arrays, strict=True)
    return all(a.dtype == b.dtype and np.array_equal(a, b) for a, b in pairs)


def mixed(number: int, seed: int = 1) -> Judged:
    """Answers at random: 36 % detected, by one of seven, after up to 13 000 frames."""
    pick = np.random.default_rng(seed)
    found = pick.random(number) < 0.36
    cells = np.where(found, pick.choice([0, 2, 4], number), pick.choice([1, 3, 5], number, p=[0.8, 0.195, 0.005]))
    by = np.where(found, pick.integers(0, 7, number), UNDETECTED)
    latency = np.where(found, pick.integers(0, 13_000, number), NO_LATENCY)
    return Judged(cells.astype(np.uint8), by.astype(np.uint8), latency.astype(np.uint32))


def upsets(number: int) -> Judged:
    """As single-event upsets come out: by bit and tick, found at the next check of so many ticks."""
    site, tick = np.divmod(np.arange(number), 8000)
    found = site % 3 == 0
    cells = np.where(found, np.where(site % 2, 4, 2), 1)
    latency = np.where(found, 256 - tick % 256 + site % 60, NO_LATENCY)
    return Judged(
        cells.astype(np.uint8), np.where(found, site % 7, UNDETECTED).astype(np.uint8), latency.astype(np.uint32)
    )


def file(judged: Judged, lo: int = 0) -> bytes:
    return encode("timer", KEY, lo, 10**8, judged)[1]


@given(some.integers(1, 300).flatmap(lambda n: some.tuples(
    arrays(np.uint8, n, elements=some.integers(0, 5)), arrays(np.uint8, n), arrays(np.uint32, n),
)))  # fmt: skip
def test_answers_come_back_whatever_they_are(planes: tuple[np.ndarray, ...]) -> None:
    judged = Judged(*planes)
    header, data = encode("timer", KEY, 7, 10**8, judged)
    read, back = decode(data)
    assert same(back, judged)
    assert read == header == head(data)
    assert (header.lo, header.hi, header.of) == (7, 7 + len(judged), 10**8)
    assert sum(header.histogram.values()) == len(judged)
    assert header.undetected == int((judged.cells == CELLS.index("wrong/no")).sum())


def test_the_same_answers_make_the_same_bytes() -> None:
    views = Judged(*(np.stack([plane, plane], axis=1)[:, 0] for plane in mixed(5000).arrays))  # not contiguous
    assert file(mixed(5000)) == file(views)
    assert len({file(mixed(5000)), file(mixed(5000, seed=2)), file(mixed(5000), lo=1), file(mixed(4999))}) == 4


def test_the_digest_is_of_the_answers_not_of_how_they_are_packed(monkeypatch: pytest.MonkeyPatch) -> None:
    header, data = encode("timer", KEY, 0, 10**8, mixed(5000))
    monkeypatch.setattr(shards, "LEVEL", 1)
    other, packed = encode("timer", KEY, 0, 10**8, mixed(5000))
    assert data != packed and header.digest == other.digest and same(decode(packed)[1], mixed(5000))


def test_no_damage_is_overlooked() -> None:
    data = file(mixed(64))
    for n in range(len(data)):
        for damaged in (data[:n] + bytes([data[n] ^ 1]) + data[n + 1 :], data[:n]):
            with pytest.raises(DamagedError):
                head(damaged)
    for damaged in (data + b"\n", b""):
        with pytest.raises(DamagedError):
            decode(damaged)


def test_a_planted_packing_error_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """The checksum of the file is right, for the wrong answers: their own digest tells."""
    monkeypatch.setattr(shards, "_order", lambda kinds: np.arange(len(kinds)))
    data = file(mixed(100))
    monkeypatch.undo()
    with pytest.raises(DamagedError, match="answers"):
        decode(data)


def test_a_planted_missing_checksum_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    class Blind:
        def hexdigest(self) -> str:
            return "0" * 64

        def update(self, data: bytes) -> None:
            pass

    monkeypatch.setattr(shards.hashlib, "sha256", lambda data=b"": Blind())
    with pytest.raises(BaseException, match=r"DID NOT RAISE|Expecting|Invalid"):
        test_no_damage_is_overlooked()


@pytest.mark.parametrize(("answers", "most"), [(upsets, 0.02), (mixed, 1.2)])
def test_an_injection_takes_little_room(answers: object, most: float) -> None:
    number = 1 << 18
    assert callable(answers)
    assert len(file(answers(number))) / number < most


def test_names_stand_in_the_order_of_ranges() -> None:
    header, _ = encode("timer", KEY, 0, 10**12, mixed(4))
    names = [replace(header, lo=lo, hi=lo + 4).name for lo in (0, 4, 10_000_000, 99_999_996, 100_000_000, 999_999_999)]
    assert names == sorted(names)
