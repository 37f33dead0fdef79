"""The threshold model: public checks P15-P17 over the whole grids, properties 8 and 9 on samples."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterable
from fractions import Fraction
from functools import cache
from itertools import product
from typing import Any

import pytest

from models.ts7.threshold import BothRemaining, Thresholds
from safety.faults import Fault, instrument, stuck
from safety.trace import Stepper, initial_state, run
from safety.tracing import trace

JUST = Fraction(1, 100)


def grid(step: Fraction) -> list[Fraction]:
    return [step * k for k in range(int(-2 / step), int(2 / step) + 1)]


Seen = dict[str, list[Any]]
LIMITS = ("e_a", "e_b", "e_c")


@cache
def compiled(model: Any, silent: str) -> Stepper:
    """The model with its limits left open, and channels that never brake."""
    faults = [Fault(stuck(0), [f"brakes_{n}", f"follows_{n}"]) for n in silent]
    return Stepper.of(instrument(trace(model, symbolic=LIMITS), faults).system)


def windows(
    e: Iterable[Fraction], xs: Iterable[Fraction], model: type[Thresholds] = Thresholds, silent: str = ""
) -> Seen:
    stepper: Stepper = compiled(model, silent)  # type: ignore[arg-type]
    state, _ = initial_state(stepper.system, dict(zip(LIMITS, e, strict=True)))
    seen: Seen = {path: [] for path in stepper.observed}
    for x in xs:
        after = stepper.function(*state, x)
        state, now = after[: len(state)], after[len(state) :]
        for path, value in zip(stepper.observed, now, strict=False):
            seen[path].append(value)
    return seen


def isolated(seen: Seen) -> str:
    return "".join(n for n in "abc" if seen[f"cut.{n}"][-1])


def test_p15_wrong_isolations_of_healthy_channels() -> None:
    """Speed just above the lowest limit, 729 triples: 90 isolate the early channel, 270 a late one."""
    kinds: Counter[str] = Counter()
    for e in product(grid(Fraction(1, 2)), repeat=3):
        cut = isolated(windows(e, [min(e) + JUST]))
        early = cut and e["abc".index(cut)] == min(e)
        kinds["early" if early else "late" if cut else "none"] += 1
        assert bool(cut) is (max(e) - min(e) > 2)
    assert kinds == {"none": 369, "early": 90, "late": 270}


@pytest.mark.parametrize(("model", "lost"), [(Thresholds, 0), (BothRemaining, 72)])
def test_p16_a_never_braking_channel(model: type[Thresholds], lost: int) -> None:
    """Speed rises past each limit to V_E+2.25, 289 pairs of healthy limits: rule (a) always brakes, rule (b) not."""
    without = 0
    for e in product(grid(Fraction(1, 4)), repeat=2):
        seen = windows((*e, Fraction(0)), [min(e) + JUST, max(e) + JUST, Fraction(9, 4)], model, silent="c")
        without += not seen["nb"][-1]
    assert without == lost


def test_p17_two_never_braking_channels_isolate_the_healthy_one() -> None:
    seen = windows([Fraction(0)] * 3, [Fraction(1), Fraction(3)], silent="bc")
    assert (isolated(seen), seen["nb"], seen["eb"]) == ("a", [False, False], [False, False])


def test_property_8_lowering_only_lowers() -> None:
    rng = random.Random(8)
    for _ in range(200):
        e = [Fraction(rng.randint(-20, 20), 10) for _ in range(3)]
        seen = windows(e, [Fraction(rng.randint(-50, 50), 10) for _ in range(6)])
        for n, own in zip("abc", e, strict=True):
            assert set(seen[f"limit.{n}"]) <= {own, own - 2}


def test_property_9_no_spurious_brake_below_the_lowered_band() -> None:
    """A channel that brakes at random never brakes the train up to V_E-4; just above, a lowered one may follow."""
    for at, nb in ((-5, False), (-4, False), (-4 + JUST, True)):
        made = trace(Thresholds, {"e_b": -1, "e_c": -2})
        early = instrument(made, [Fault(stuck(1), ["brakes_a"])]).system
        assert run(early, [{"x": Fraction(at)}])["nb"] == [nb]


def test_after_an_isolation_there_is_no_lowering() -> None:
    seen = windows([Fraction(-2), Fraction(2), Fraction(2)], [Fraction(-1), Fraction(1), Fraction(3)])
    assert [[seen[f"limit.{n}"][k] for n in "abc"] for k in range(3)] == [[-2, 0, 0], [-2, 2, 2], [-2, 2, 2]]
    assert (isolated(seen), seen["nb"]) == ("a", [False, False, True])
