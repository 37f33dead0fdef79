"""Level-crossing warning time: 30.0, 93.30, 16.90 and 13.10 s, and what is dangerous."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from models.ats.crossing import (
    LINE_SPEED,
    WARNING,
    Crossing,
    NoPattern,
    notice_for,
    run_from_mark,
    start_point,
    stopping_warning,
)
from proofs import ats_crossing
from safety import PROVED, ModelError, run
from safety.prove.bounds.claims import declared
from safety.prove.weakest import declared as syntheses
from safety.prove.weakest_search import find
from tests.models.ts7.test_readings import direct_and_python_agree
from tests.proofs.verdicts import OWN_LEMMAS, check, claims_of, of

HUNDREDTH = Fraction(1, 100)


@pytest.mark.parametrize("model", [Crossing, NoPattern])
def test_direct_and_python_agree(model: Any) -> None:
    direct_and_python_agree(model)


def test_as_15_warning_times() -> None:
    assert start_point() / LINE_SPEED == 30
    for interval, seconds in ((stopping_warning(), "93.30"), (run_from_mark(), "16.90"), (notice_for(), "13.10")):
        assert abs(interval.middle - Fraction(seconds)) < HUNDREDTH


def drive(model: Any, *stamps: tuple[Any, ...]) -> Any:
    """A run from 100 m before the start point, from (seconds, metres, m/s, *what happens)."""
    says = ("stops", "lost", "announces", "departs")
    rows = [
        {"elapsed": s, "way": m, "reached": v} | {f"says.{name}": name in said for name in says}
        for s, m, v, *said in stamps
    ]
    return run(model, rows, start={"head": -start_point() - 100, "speed": LINE_SPEED})


def test_as_15_on_the_model_an_express_is_warned_of_for_30_s() -> None:
    seen = drive(Crossing, (Fraction("3.6"), 100, LINE_SPEED), (30, start_point(), LINE_SPEED), (0, 0, LINE_SPEED))
    assert seen["warning"] == [True, True, True]
    assert seen["head"][-1] == 0 and seen["warned"][-1] == WARNING and not any(seen["short"])


RUN = Fraction("16.9031")  # s, a little more than it takes from the mark
STOPS = [
    (Fraction(0), 0, LINE_SPEED, "stops"), (Fraction("3.6"), 100, LINE_SPEED), (60, start_point() - 100, 0),
    (20, 0, 0, "announces"), (Fraction("13.1"), 0, 0, "departs"), (RUN, 100, RUN * Fraction("0.7")), (0, 0, 5),
]  # fmt: skip


def test_as_15_on_the_model_a_stopping_train_is_warned_of_from_the_announcement_on() -> None:
    seen = drive(Crossing, *STOPS)
    assert seen["put_off"] == [False, True, True, False, False, False, False]
    assert seen["head"][-1] == 0 and seen["warned"][-1] == Fraction("13.1") + RUN


def test_a_lost_message_is_plain_control() -> None:
    stamps = [(*STOPS[0],), (*STOPS[1], "lost"), *STOPS[2:]]
    seen = drive(Crossing, *stamps)
    assert all(seen["warning"][1:]) and seen["warned"][-1] > 93


def test_as_15_without_the_pattern_the_warning_is_shorter_than_20_s() -> None:
    passing = [*STOPS[:2], (30, start_point(), LINE_SPEED, "announces"), (0, 0, LINE_SPEED)]
    seen = drive(NoPattern, *passing)
    assert seen["head"][-1] == 0 and seen["warned"][-1] < 20 and seen["short"][-1]
    with pytest.raises(ModelError, match="AV-1"):
        drive(Crossing, *passing)


def test_departure_without_notice_is_held() -> None:
    early = [*STOPS[:4], (10, 0, 0, "departs"), (RUN, 100, RUN * Fraction("0.7"))]
    with pytest.raises(ModelError, match="AV-1"):
        drive(Crossing, *early)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (lambda: run(Crossing, {}, 1, settings={"mark": 900}), "nearest admissible mark is any below 833.333 m"),
        (lambda: stopping_warning(mark=Fraction(300)), "nearest admissible value is 277.777 m"),
        (lambda: notice_for(Fraction(16)), "nearest admissible value is above 16.9031 s"),
        (lambda: run(Crossing, {}, 1, settings={"least": 0}), "nearest admissible value is 1"),
    ],
)
def test_what_cannot_be_honoured_is_refused(wrong: Any, says: str) -> None:
    with pytest.raises(ModelError, match=says):
        wrong()


def test_the_weakest_start_point_and_notice_for_20_s() -> None:
    found = {each.id: find(each) for each in syntheses() if each.id.startswith("ats_crossing.")}
    exact = {
        "ats_crossing.least_start_point": 20 * LINE_SPEED,
        "ats_crossing.least_notice_for_20_s": 20 - run_from_mark().middle,
    }
    for id, value in exact.items():
        assert found[id].refuted_at < value <= found[id].safe_from
        assert found[id].safe_from - found[id].refuted_at <= Fraction(1, 10)


def test_proofs_have_both_solvers() -> None:
    for claim in claims_of(ats_crossing).values():
        if claim.expect == PROVED:
            check(of(claim.formula, OWN_LEMMAS))


def test_bounds() -> None:
    for one in declared():
        if one.id.startswith("ats_crossing."):
            assert one.found(30)["verdict"] == one.expect, one.id
