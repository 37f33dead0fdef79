"""Simple fractions of sets that are known by questions alone: in the set, and the same however it is written."""

from __future__ import annotations

import random
from fractions import Fraction as F

import pytest

from safety import REFUTED, Bit, Model, Real, Seen, claim
from safety.prove.claims import registered
from safety.prove.prove import prove
from safety.prove.simplest import simple_one, simplest
from safety.prove.solve import Solver

Piece = tuple[F, F]


def asked(*pieces: Piece, open_ends: bool = False) -> F | None:
    """The fraction found in a union of intervals, which is told only whether it meets another."""

    def meets(low: F, high: F) -> bool:
        if open_ends:
            return any(a < high and low < b for a, b in pieces)
        return any(a <= high and low <= b for a, b in pieces)

    return simple_one(meets)


@pytest.mark.parametrize(
    ("low", "high", "found"), [(F(1, 3), F(1, 2), F(1, 2)), (F(-5), F(-7, 2), F(-4)), (F(-1), F(1), F(0))]
)
def test_the_least_denominator_is_taken(low: F, high: F, found: F) -> None:
    assert simplest(low, high) == found


def test_it_lies_in_the_set_wherever_that_is() -> None:
    draw = random.Random(3)
    for _ in range(300):
        low = F(draw.randint(-(10**6), 10**6), draw.randint(1, 10**4))
        high = low + F(draw.randint(0, 50), draw.randint(1, 10**4))
        found = asked((low, high))
        assert found is not None and low <= found <= high


def test_a_single_fraction_and_open_ends_are_found() -> None:
    for only in (F(20009997, 10000), F(-1, 3), F(10**9 + 1, 7), F(1, 4), F(1024)):
        assert asked((only, only)) == only
    found = asked((F(1, 2), F(1, 2) + F(1, 1000)), open_ends=True)
    assert found is not None and F(1, 2) < found < F(1, 2) + F(1, 1000)


def test_from_zero_up_comes_first_and_then_the_lower_half() -> None:
    assert asked((F(-1), F(-1)), (F(9), F(10))) in (F(9), F(10), F(19, 2))
    assert asked((F(5), F(5)), (F(7), F(7))) == 5
    assert asked((F(0), F(0)), (F(7), F(7))) == 0


def test_of_nothing_there_is_none() -> None:
    assert asked() is None


class Two(Model, event="tick"):
    """Two reals that the surroundings choose."""

    def step(self, x: Real, y: Real) -> tuple[Two, Bit]:
        return Two(), (x > 4003) & (2000 * x < 8006001) & (y * y < x) & (17 * y > 1000)


@pytest.mark.parametrize("seed", range(4))
def test_a_run_over_reals_does_not_depend_on_the_models_of_the_solver(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = Solver.__post_init__

    def other(self: Solver) -> None:
        made(self)
        if self.name == "z3":
            self.raw.set("random_seed", seed)

    monkeypatch.setattr(Solver, "__post_init__", other)

    @claim(Two, expect=REFUTED, steps=1)
    def apart(s: Seen) -> Bit:
        """They never meet."""
        return ~s.out

    found = prove(next(c for c in registered() if c.formula is apart))
    assert found.counterexample is not None
    assert (found.counterexample["x"], found.counterexample["y"]) == ([F(8198145, 2048)], [F(60)])
