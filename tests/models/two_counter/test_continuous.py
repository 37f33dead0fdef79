"""The equipment against a reference in continuous time, event by event in fractions: nothing is quantised."""

from __future__ import annotations

import itertools
import random
from collections.abc import Callable, Iterator
from fractions import Fraction

import pytest

from models.two_counter.equipment import Equipment
from models.two_counter.samples import Samples
from models.two_counter.variants import EqualityDecoder, SignalTwoSets
from safety.model import Model
from tests.models.two_counter.runs import (
    KMH,
    PRESET,
    SPACING,
    TC,
    Motion,
    Sample,
    ride,
    sample_equation,
    steps_with,
    threshold,
)

STEPS = 9000


def journey(rng: random.Random, check: int, spacing: int, meeting: bool, per_mille: int = 0) -> Motion:
    """Speeds around the threshold with any fractions, or such that edges and pulses often meet."""
    pieces = []
    for _ in range(rng.randint(1, 5)):
        factor = Fraction(1000 + per_mille + rng.randint(-2, 2), 1000)
        speed = threshold(check) * factor + Fraction(rng.randint(0, 96), 97)
        ratio = Fraction(PRESET[check], 2000).limit_denominator(rng.choice((40, 60, 80)))
        pieces.append((Fraction(rng.randint(1, 40_000), 11), ratio * spacing if meeting else speed))
    start = Fraction(rng.randint(1, 2), 2) * spacing
    start -= 0 if meeting else Fraction(rng.randint(0, 88_000), 89)
    return Motion(start, [*pieces, (Fraction(STEPS), speed)])


def read_outs(
    motion: Motion, check: Callable[[int], int], n1f: int = 2000, model: type[Model] = Equipment, slip: int = 0
) -> tuple[list[Sample], list[Sample]]:
    """Read-outs of the model, its phase off by `slip`, and those of the reference."""
    phase, speeds = -(-motion.start // 1) - 1 + slip, motion.inputs(STEPS)
    seen = ride(speeds.__getitem__, STEPS, check, model, phase=phase, settings={"n1f": n1f})
    expected = sample_equation(motion.edges(500 * n1f), lambda k: PRESET[check(min(k, STEPS - 1))], n1f)
    in_time = itertools.takewhile(lambda s: s.step < STEPS, expected)
    return (
        [Sample(k, seen["circuit.counter1.n"][k], seen["brake"][k]) for k in steps_with(seen, "signal1")],
        [Sample(s.step, s.n1 % 2048, s.brake) for s in in_time],
    )


@pytest.mark.parametrize("meeting", [False, True], ids=["any instants", "edges meet pulses"])
@pytest.mark.parametrize("check", [250, 160, 5])
def test_every_read_out_is_that_of_continuous_time(check: int, meeting: bool) -> None:
    rng = random.Random(check + meeting)
    decisions = set()
    for per_mille in (-3, 3):
        n1f = rng.randint(1990, 2010)
        found, expected = read_outs(journey(rng, check, 500 * n1f, meeting, per_mille), lambda _: check, n1f)
        assert found == expected and len(found) >= 3
        decisions |= {s.brake for s in found[1:]}
    assert meeting or decisions == {False, True}


def changing(model: type[Model]) -> Iterator[tuple[list[Sample], list[Sample]]]:
    """Read-outs of two journeys on which the check speed changes every 900 steps."""
    rng = random.Random(7)
    for check in (250, 110):
        checks = [rng.choice(list(PRESET)) for _ in range(STEPS // 900)]
        yield read_outs(journey(rng, check, SPACING, False), lambda k, c=checks: c[k // 900], model=model)  # type: ignore[misc]


def test_changes_of_the_check_speed_are_those_of_continuous_time() -> None:
    """A lower preset that has been passed ends the count at the next edge."""
    for found, expected in changing(Equipment):
        assert found == expected and len(found) >= 3


@pytest.mark.parametrize("model", [EqualityDecoder, SignalTwoSets])
def test_a_circuit_that_is_another_is_found(model: type[Model]) -> None:
    assert any(found != expected for found, expected in changing(model))


def test_a_tie_that_goes_the_other_way_is_found() -> None:
    """A phase one unit on, a millionth of an edge: every edge that meets a pulse comes before it."""
    meeting = Motion(Fraction(999_999), [(Fraction(1), Fraction(1)), (Fraction(STEPS), Fraction(500_000))])
    for slip, agrees in ((0, True), (1, False)):
        found, expected = read_outs(meeting, lambda _: 250, slip=slip)
        assert (found == expected) is agrees


def test_a_pulse_at_the_start_is_not_counted_and_one_at_the_end_is() -> None:
    """250 km/h scaled so that an edge comes every two periods, at the pulses: 2070 pulses in (start, end]."""
    motion = Motion(Fraction(1_000_000), [(Fraction(STEPS), Fraction(500_000))])
    found, expected = read_outs(motion, lambda _: 250)
    assert found == expected
    assert {s.n1 for s in found[1:]} == {2070 - 2048}
    assert [s.step for s in found[:2]] == [2, 2 + 2 * 1043]


def test_the_ideal_machine_decides_the_same() -> None:
    rng = random.Random(3)
    speeds = [threshold(250) + rng.randint(-KMH, KMH) // 2 for _ in range(5)]
    brakes = [ride(lambda k: speeds[k * 5 // STEPS], STEPS, 250, model)["brake"] for model in (Equipment, Samples)]
    assert brakes[0] == brakes[1] and len(set(brakes[0])) == 2


def test_the_step_is_a_two_thousandth_of_the_counting_time() -> None:
    from models.two_counter import step_s

    assert step_s() == TC / 2000 and step_s(2047) == TC / 2047 and step_s(error=10_000) == TC / 2020


@pytest.mark.slow
def test_many_journeys_over_all_check_speeds() -> None:
    rng = random.Random(1967)
    for _ in range(100):
        check, n1f, meeting = rng.choice(list(PRESET)), rng.randint(1885, 2047), rng.random() < 0.5
        found, expected = read_outs(journey(rng, check, 500 * n1f, meeting, rng.randint(-5, 5)), lambda _: check, n1f)  # noqa: B023
        assert found == expected
