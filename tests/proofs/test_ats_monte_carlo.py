"""ATS-S and ATS-SP with drawn drivers: the counts are those pinned, and change with the equipment."""

from __future__ import annotations

from fractions import Fraction

import pytest

from proofs import ats_monte_carlo as sampled
from proofs.ats_plots import SIGNAL
from safety.exhibits import declared
from safety.inject.statistics import clopper_pearson

FEW = 20


def test_as_many_drivers_pass_as_are_pinned() -> None:
    found = next(each for each in declared() if each.id == "ats.drivers_sampled").evaluate()
    assert found["as_expected"], found["note"]
    *_, (kind, missions, hits, low, high, supervised, most, _) = found["rows"]
    assert (kind, missions, supervised) == ("all", sampled.MISSIONS, 0)
    assert (low["value"], high["value"]) == clopper_pearson(hits, missions, sampled.CONFIDENCE)
    assert low["value"] < hits / missions < high["value"] and 0 < most["value"] < low["value"]


def test_an_alarm_of_8_s_lets_more_drivers_pass() -> None:
    found = sampled.passing(sampled.ATS_S, {"alarm_s": 8})
    assert found["does not answer"] > 0 and found["all"] > sampled.PASS["all"]


def test_a_signal_stored_40_m_too_far_lets_drivers_pass() -> None:
    assert sampled.passing(sampled.ATS_SP, {"signal_at": SIGNAL + 40}, FEW)["all"] > 0


@pytest.mark.parametrize(
    ("after", "held", "again", "at", "x", "brakes"),
    [
        ("4.9", "0.1", -1, "4.8", 400, False),
        ("4.9", "0.1", -1, "4.9", 400, True),
        ("4.9", "0.1", -1, "5", 400, False),
        ("4.9", "0.1", 300, "9", 300, True),
    ],
)
def test_a_driver_brakes_while_he_holds_the_handle_and_from_his_place_on(
    after: str, held: str, again: int, at: str, x: int, brakes: bool
) -> None:
    driver = sampled.Driver("lets go", 100, Fraction(1, 2), Fraction(after), Fraction(held), again)
    assert driver.brakes(Fraction(at), Fraction(x)) is brakes


def test_the_same_seed_draws_the_same_drivers() -> None:
    first = sampled.drivers()
    sampled.drivers.cache_clear()
    assert sampled.drivers() == first and {each.kind for each in first} == set(sampled.KINDS)
