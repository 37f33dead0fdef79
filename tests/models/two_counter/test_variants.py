"""Variants of the two-counter ATC: P19, decoders, level on the reset line, watchdog; eq. (4) against the circuit."""

from __future__ import annotations

import pytest

from models.two_counter.equipment import Equipment
from models.two_counter.samples import Compared
from models.two_counter.variants import EqualityDecoder, LevelReset, NoDefault, SignalOneResets, SignalTwoSets, Watched
from safety.faults import ANY_TIME, Fault, stuck
from safety.model import Model
from tests.models.two_counter.runs import KMH, SPACING, brakes_from, ride, steps_with, threshold


@pytest.mark.parametrize(("model", "releases"), [(SignalTwoSets, True), (SignalOneResets, True), (Equipment, False)])
def test_p19_literal_readings_release_at_overspeed(model: type[Model], releases: bool) -> None:
    """20 km/h above the check speed from power-up on; the consistent reading brakes all the time."""
    seen = ride(threshold(250) + 20 * KMH, 6000, model=model)
    first = steps_with(seen, "signal1")[1]
    assert (False in seen["brake"]) is releases
    assert all(seen["brake"][first:]) is not releases


@pytest.mark.parametrize("model", [SignalTwoSets, SignalOneResets])
def test_literal_readings_keep_the_normal_case(model: type[Model]) -> None:
    """Below the check speed they release as the reference does."""
    seen, reference = (ride(threshold(250) - KMH, 6000, model=m)["brake"] for m in (model, Equipment))
    assert seen[-1] is reference[-1] is False


def lowered(model: type[Model]) -> tuple[list[int], list[bool]]:
    """Read-outs and brake when 160 km/h is selected at 240 km/h, counter 2 being past the new preset."""
    seen = ride(480_000 + 9000, 16_000, lambda k: 250 if k < 3700 else 160, model)
    assert seen["circuit.counter2.counting"][3700] and 677 < seen["circuit.counter2.n"][3700] < 1035
    return [k for k in steps_with(seen, "signal1") if k > 3700], seen["brake"][3700:]


def test_a_lower_preset_is_missed_by_the_equality_decoder() -> None:
    """Reference: brake by the second read-out; equality: counter 2 runs through 2048 states, the release is held."""
    at, brake = lowered(Equipment)
    assert at[0] - 3700 < 20 and brake.index(True) <= at[1] - 3700
    late, held = lowered(EqualityDecoder)
    assert late[0] - 3700 > 2000 and held.index(True) > 2000 + brake.index(True)


def test_without_selection_and_default_the_command_is_held() -> None:
    for model, holds in ((NoDefault, True), (Equipment, False)):
        seen = ride(lambda k: 480_000 if k < 5000 else 700_000, 16_000, lambda k: 250 if k < 5000 else 0, model)
        assert any(seen["signal1"][5100:]) is not holds
        assert seen["brake"][-1] is not holds


def test_level_on_the_reset_line() -> None:
    """AND3 at 1: strobed it is harmless, as a level it releases one step after each read-out that brakes."""
    and3 = Fault(stuck(1), ["circuit.and3"])
    speed = threshold(250) + 20 * KMH
    assert all(ride(speed, 8000, faults=[and3])["brake"])
    level = ride(speed, 8000, model=LevelReset, faults=[and3])
    assert [k for k, brake in enumerate(level["brake"]) if brake] == steps_with(level, "signal1")
    assert all(ride(speed, 8000, model=LevelReset)["brake"])


def test_watchdog() -> None:
    """T_w without a read-out: brake, until one comes; standstill is braked too, and so is a slow train."""
    dead = Fault(stuck(0), ["train.edge"], onset=ANY_TIME, at=5000)
    seen = ride(480_000, 9000, model=Watched, faults=[dead], settings={"patience": 2400})
    last = steps_with(seen, "signal1")[-1]
    assert seen["brake"].index(True, 4500) == last + 2401 and all(seen["brake"][last + 2401 :])
    assert any(ride(300_000, 9000, model=Watched, settings={"patience": 2400})["brake"][5000:])
    assert not any(ride(300_000, 9000)["brake"][5000:])
    same = [ride(480_000, 9000, model=m)["brake"] for m in (Watched, Equipment)]
    assert same[0] == same[1]


def test_equation_four_brakes_one_count_earlier_than_the_circuit() -> None:
    """A window of exactly n1F = 2000 pulses: the printed n1 <= n1F brakes, the circuit releases; else they agree."""
    seen = ride(threshold(250), 9000, model=Compared)
    at = steps_with(seen, "signal1")[1:]
    assert {seen["circuit.counter1.n"][k] for k in at} == {2000}
    assert not any(seen["circuit_brakes"][at[0] :]) and all(seen["equation_brakes"][at[0] :])
    for speed in (threshold(250) - KMH // 2, brakes_from(250), threshold(250) + KMH):
        other = ride(speed, 6500, model=Compared, phase=SPACING // 3)
        assert other["circuit_brakes"] == other["equation_brakes"]
