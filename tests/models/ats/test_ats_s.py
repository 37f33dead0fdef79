"""ATS-S: the timer to the millisecond, every transition, the warning distance, what is not supervised."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from models.ats.ats_s import (
    ALARM,
    ALARM_S,
    CONFIRMED,
    EMERGENCY,
    IDLE,
    Approach,
    AtsS,
    Bench,
    fastest_warned,
    warning_distance,
)
from models.kinematics import B_EMERGENCY, T_EMERGENCY, kmh, mps
from proofs import ats_s
from safety import U2, ModelError, power_up, run
from tests.models.ts7.test_readings import direct_and_python_agree
from tests.proofs.verdicts import OWN_LEMMAS, check, claims_of, of


class Ready(AtsS, event="a change of its inputs, or a cycle"):
    """ATS-S after its reset."""

    state: U2 = power_up(IDLE)


class OnTheWay(Approach, event="a change of its inputs, or a cycle"):
    """A train whose ATS-S has been reset."""

    ats: Ready


QUIET: dict[str, Any] = dict.fromkeys(("stop_read", "proceed_read", "braking", "standing", "reset"), False)
STARTS: list[dict[str, Any]] = [  # from power-up to IDLE, and the stop balise
    QUIET | {"elapsed": 0, "healthy": True, "standing": True, "reset": True},
    QUIET | {"elapsed": 1, "healthy": True, "stop_read": True},
]


def after(*stamps: dict[str, Any]) -> int:
    """The state once these time stamps have come after a stop reading."""
    rows = [*STARTS, *(QUIET | {"healthy": True} | stamp for stamp in stamps)]
    return run(AtsS, [*rows, QUIET | {"elapsed": 0, "healthy": True}])["state"][-1]


@pytest.mark.parametrize("model", [AtsS, Bench, Approach])
def test_direct_and_python_agree(model: Any) -> None:
    direct_and_python_agree(model)


@pytest.mark.parametrize(
    ("v", "metres"),
    [(85, "440.18"), (95, "529.66"), (100, "577.38"), (110, "678.77"), (120, "788.10"), (130, "905.36")],
)
def test_as_01_warning_distance_on_the_model(v: int, metres: str) -> None:
    """The passive train comes to a stand exactly at the signal, and the distance is that of the table."""
    speed, needed = mps(v), warning_distance(mps(v))
    assert abs(needed - Fraction(metres)) < Fraction(1, 100)
    way = speed * speed / (2 * B_EMERGENCY)

    def row(elapsed: Fraction, free: Fraction, braked: Fraction, reached: Fraction) -> dict[str, Any]:
        gone = speed * free + braked
        motion = {"motion.gone": gone, "motion.braked": braked, "motion.free": free, "motion.speed": reached}
        return motion | {"elapsed": elapsed, "braking": False, "healthy": True}

    none = Fraction(0)
    rows = [
        row(none, none, none, speed), row(ALARM_S, ALARM_S, none, speed),
        row(T_EMERGENCY, T_EMERGENCY, none, speed), row(speed / B_EMERGENCY, none, way, none),
        row(none, none, none, none),
    ]  # fmt: skip
    start = {"to_go": needed, "speed": speed, "warned_at": speed, "way": way}
    trace = run(OnTheWay, rows, start=start)
    assert trace["ats.state"] == [IDLE, ALARM, EMERGENCY, EMERGENCY, EMERGENCY]
    assert trace["speed"][-1] == 0 and trace["to_go"][-1] == 0


def test_as_01_speeds_for_600_m() -> None:
    """102.30 km/h with the alarm, 117.83 km/h without; the alarm alone costs 138.89 m at 100 km/h."""
    assert abs(kmh(fastest_warned(Fraction(600)).middle) - Fraction("102.30")) < Fraction(1, 100)
    assert abs(kmh(fastest_warned(Fraction(600), alarm=Fraction(0)).middle) - Fraction("117.83")) < Fraction(1, 100)
    assert abs(mps(100) * ALARM_S - Fraction("138.89")) < Fraction(1, 100)


@pytest.mark.parametrize(("at", "state"), [("0", CONFIRMED), ("4.999", CONFIRMED), ("5.000", EMERGENCY)])
def test_as_02_the_answer_is_a_level_before_5_s(at: str, state: int) -> None:
    assert after({"elapsed": Fraction(at), "braking": True}) == state


def test_as_02_time_counts_by_stamps_not_by_cycles() -> None:
    """Ten stamps of half a second, or one thousand of five milliseconds."""
    for cycle in (Fraction(1, 2), Fraction(1, 200)):
        stamps = [{"elapsed": cycle}] * int(ALARM_S / cycle)
        assert after(*stamps[:-1]) == ALARM
        assert after(*stamps) == EMERGENCY


def test_as_02_the_search_finds_who_brakes_and_lets_go() -> None:
    outcome = of(ats_s.no_train_passes_a_stop_signal_as_searched, OWN_LEMMAS)
    assert outcome.verdict == "refuted" and "search" in outcome.method
    found = outcome.counterexample
    assert found is not None and True in found["braking"] and CONFIRMED in found["ats.state"]


@pytest.mark.parametrize(
    ("stamps", "state"),
    [
        ([{"elapsed": 3, "stop_read": True}, {"elapsed": 2}], EMERGENCY),  # the timer is not restarted
        ([{"elapsed": 3, "proceed_read": True}, {"elapsed": 1}], ALARM),
        ([{"elapsed": 1, "braking": True}, {"elapsed": 9}], CONFIRMED),
        ([{"elapsed": 1, "braking": True}, {"elapsed": 1, "stop_read": True}, {"elapsed": 4}], ALARM),
        ([{"elapsed": 1, "braking": True}, {"elapsed": 1, "stop_read": True}, {"elapsed": 5}], EMERGENCY),
        ([{"elapsed": 1, "braking": True}, {"elapsed": 1, "proceed_read": True}], IDLE),
        ([{"elapsed": 1, "healthy": False}], EMERGENCY),
        ([{"elapsed": 5}, {"elapsed": 1, "reset": True}], EMERGENCY),
        ([{"elapsed": 5}, {"elapsed": 1, "standing": True}], EMERGENCY),
        ([{"elapsed": 5}, {"elapsed": 1, "standing": True, "reset": True}], IDLE),
        ([{"elapsed": 5}, {"elapsed": 1, "standing": True, "reset": True, "healthy": False}], EMERGENCY),
        ([{"elapsed": 5}, {"elapsed": 1, "standing": True, "reset": True, "stop_read": True}], ALARM),
    ],
)
def test_transitions(stamps: list[dict[str, Any]], state: int) -> None:
    assert after(*stamps) == state


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (lambda: fastest_warned(Fraction(-1)), "nearest admissible value is 0"),
        (lambda: warning_distance(mps(100), Fraction(0)), "nearest admissible"),
        (lambda: run(AtsS, STARTS[:1], settings={"alarm_s": 11}), "nearest admissible value is 10"),
    ],
)
def test_what_it_cannot_honour_is_refused(wrong: Any, says: str) -> None:
    with pytest.raises(ModelError, match=says):
        wrong()


@pytest.mark.parametrize("name", list(claims_of(ats_s)))
def test_claims(name: str) -> None:
    check(of(getattr(ats_s, name), OWN_LEMMAS))
