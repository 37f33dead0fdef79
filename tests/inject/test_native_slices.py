"""Mistakes planted in the native engine whose lanes are bits: those of the driver, and some of its own."""

from __future__ import annotations

import pytest

from safety.inject.native.planes import Planes
from safety.terms import ternary
from safety.terms.column_bits import size_of
from safety.terms.llvm import host
from tests.inject.test_native_mistakes import MISTAKES, Plant, expect_found, short_stretches

__all__ = ["short_stretches"]  # a fixture that every test here uses

OF_WORDS = {name for name in MISTAKES if "register" in name or name.startswith("equal digests")}
OF_SLICES: dict[str, Plant] = {
    "masks are not looked at": lambda patch: patch.setattr(Planes, "_masked", lambda self, k, point, healthy: healthy),
    "lanes are not taken": lambda patch: patch.setattr(Planes, "take_lanes", lambda *args: None),
    "lanes are not given": lambda patch: patch.setattr(Planes, "give_lanes", lambda *args: None),
    "a square is not turned": lambda patch: patch.setattr(
        Planes, "take_lanes", lambda self, k, state, records: self.give_lanes(k, records, state, "")
    ),
    "half of the planes are restored": lambda patch: patch.setattr(Planes, "_planes_used", property(half)),
    "every bit of an input is its lowest": lambda patch: patch.setattr(
        Planes, "_spread_bit", lambda self, k, term, i, right=Planes._spread_bit: right(self, k, term, 0)
    ),
    "bits lie the other way round": lambda patch: patch.setattr(
        Planes, "_place",
        lambda self, s, i, right=Planes._place: right(self, s, size_of(s.var.sort) - 1 - i),
    ),
    "inputs of a function change places": lambda patch: patch.setattr(ternary, "COLUMNS", (0xCC, 0xF0, 0xAA)),
    "a gate is another": lambda patch: patch.setitem(ternary.GATES, "or", lambda x, y: x ^ y),
}  # fmt: skip


def half(self: Planes) -> int:
    return sum(size_of(s.var.sort) for s in self.registers) // 2


SHARED = [name for name in MISTAKES if name not in OF_WORDS]
OF_FUNCTIONS = {"inputs of a function change places", "a gate is another"}


@pytest.mark.parametrize("name", SHARED)
def test_a_mistake_of_the_driver_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    expect_found(MISTAKES[name], "sliced", monkeypatch)


@pytest.mark.parametrize("name", OF_SLICES)
def test_a_mistake_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if name in OF_FUNCTIONS and not host().in_slices().ternary:
        pytest.skip("this processor has no instructions of three operands")
    expect_found(OF_SLICES[name], "sliced", monkeypatch)
