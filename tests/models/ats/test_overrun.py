"""Overrun prevention: when the pattern to the stop mark is made, and when it ends."""

from __future__ import annotations

from typing import Any

import pytest

from models.ats.overrun import StationStop, StopBench
from models.kinematics import KMH
from proofs import ats_overrun
from safety import ModelError, run
from tests.models.ts7.test_readings import direct_and_python_agree
from tests.proofs.verdicts import OWN_LEMMAS, check, claims_of, of


@pytest.mark.parametrize("model", [StationStop, StopBench])
def test_direct_and_python_agree(model: Any) -> None:
    direct_and_python_agree(model)


def stop(at: float, cycles: int, timetable: bool = True, known: bool = True, v: Any = 0) -> Any:
    """Cycles at a place at a speed."""
    where = dict.fromkeys(("where.low", "where.guess", "where.high"), at)
    inputs = {"timetable_stop": timetable, "known": known, "mark": 1000, "where.fastest": v, "where.slowest": 0}
    return run(StationStop, where | inputs, cycles)


@pytest.mark.parametrize(("at", "ends"), [(994, False), (995, True), (1005, True), (1006, False), (500, False)])
def test_a_second_at_the_mark_ends_it(at: int, ends: bool) -> None:
    assert True not in stop(at, 9)["ended"]
    assert (True in stop(at, 10)["ended"]) == ends
    assert True not in stop(at, 50, v=KMH * 2)["ended"]


@pytest.mark.parametrize(("at", "timetable", "known", "makes"), [
    (500, True, True, True), (500, False, True, False), (500, True, False, False), (1001, True, True, False),
    (-100, True, True, False),
])  # fmt: skip
def test_it_is_made_on_the_approach(at: int, timetable: bool, known: bool, makes: bool) -> None:
    assert (True in stop(at, 3, timetable, known, v=10)["made"]) == makes


def test_a_stop_that_has_been_made_is_not_asked_for_again() -> None:
    assert True not in stop(999, 30)["made"][10:]


def test_a_window_narrower_than_the_position_is_sure_is_refused() -> None:
    with pytest.raises(ModelError, match="nearest admissible window is any above 2 m"):
        run(StationStop, {}, 1, settings={"window": 1})


def test_claims() -> None:
    for claim in claims_of(ats_overrun).values():
        check(of(claim.formula, OWN_LEMMAS))
