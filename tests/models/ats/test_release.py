"""Release balises: delays, spacing, the signal that returns to stop."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from models.ats.release import Following, OnlyByBalise, OnlyByPhase, balises, detection_delay
from models.kinematics import B_EMERGENCY, T_EMERGENCY, ceiling, kmh, mps
from proofs import ats_release
from safety import ModelError, run
from safety.prove.bounds.claims import declared
from safety.prove.weakest import declared as syntheses
from safety.prove.weakest_search import find
from tests.models.ts7.test_readings import direct_and_python_agree
from tests.proofs.verdicts import OWN_LEMMAS, check, claims_of, of


def test_direct_and_python_agree() -> None:
    direct_and_python_agree(Following)


@pytest.mark.parametrize(("v", "seconds"), [(45, "16.0"), (25, "28.8")])
def test_delay_over_200_m(v: int, seconds: str) -> None:
    assert detection_delay(Fraction(200), mps(v)) == Fraction(seconds)


def test_as_11_an_emergency_brake_from_100_m_out() -> None:
    """45.22 km/h is the last speed with two decimals that stops within 100 m."""
    limit = ceiling(Fraction(100), B_EMERGENCY, T_EMERGENCY)
    assert Fraction("45.22") < kmh(limit.low) and kmh(limit.high) < Fraction("45.23")
    check(of(ats_release.an_emergency_brake_100_m_out_suffices, OWN_LEMMAS))
    beyond = of(ats_release.an_emergency_brake_100_m_out_suffices_at_45_23, OWN_LEMMAS)
    check(beyond)


@pytest.mark.parametrize("model", [Following, OnlyByPhase])
def test_a_release_balise_at_stop_makes_the_pattern_again(model: Any) -> None:
    """The signal clears at step 30 and returns to stop at 60; release balises are passed at 50 and 100."""

    def row(k: int) -> dict[str, Any]:
        where = dict.fromkeys(("where.low", "where.guess", "where.high"), Fraction(2 * k))
        speed = {"where.fastest": 20 * (k > 0), "where.slowest": 0}
        balise = {"passed.signal": k == 1, "passed.release": k in (50, 100)}
        phase = {"phase.n": False, "phase.r": False, "phase.changed": False, "phase.age": 0}
        return where | speed | balise | phase | {"stop": not 30 <= k < 60, "reset": k == 0}

    pattern = run(model, row, 130)["sp.home.target.pattern"]
    again = model is Following
    assert pattern == [False] + [True] * 49 + [False] * 50 + [again] * 30


@pytest.mark.parametrize("model", [Following, OnlyByBalise])
def test_the_phase_back_at_stop_makes_the_pattern_again(model: Any) -> None:
    def row(k: int) -> dict[str, Any]:
        where, clear = dict.fromkeys(("where.low", "where.guess", "where.high"), Fraction(20 + k)), 10 <= k < 20
        phase = {"phase.n": clear, "phase.r": not clear, "phase.changed": False, "phase.age": 0}
        speed = {"where.fastest": 20 * (k > 0), "where.slowest": 0}
        return where | speed | phase | {"passed.signal": k == 1, "passed.release": False, "stop": not clear,
                                        "reset": k == 0}  # fmt: skip

    pattern = run(model, row, 30)["sp.home.target.pattern"]
    assert pattern == [False] + [True] * 11 + [False] * 8 + [model is Following] * 10


def test_as_11_a_signal_that_returns_to_stop_leaves_no_pattern_and_no_brake() -> None:
    """After the release the train may have any speed in front of the stop signal: nothing intervenes."""

    def row(k: int) -> dict[str, Any]:
        at = min(Fraction(599), Fraction(4 * k))
        where = dict.fromkeys(("where.low", "where.guess", "where.high"), at)
        fast = {"where.fastest": 0 if k == 0 else mps(130), "where.slowest": 0}
        balise = {"passed.signal": k == 1, "passed.release": k == 40}
        phase = {"phase.n": False, "phase.r": True, "phase.changed": False, "phase.age": 0}
        signal = {"stop": not 30 <= k < 60, "reset": k == 0}
        return where | (fast if k > 40 or k == 0 else fast | {"where.fastest": mps(20)}) | balise | phase | signal

    seen = run(Following, row, 160)
    assert seen["sp.home.target.pattern"][39] and not any(seen["sp.home.target.pattern"][41:])
    assert seen["approaching"][149] and seen["stop"][149] and seen["where.fastest"][149] == mps(130)
    assert not any(seen["service"][41:]) and not any(seen["emergency"][1:])


def test_spacing() -> None:
    assert balises(Fraction(0), Fraction(600), Fraction(200)) == [200, 400]
    assert balises(Fraction(0), Fraction(600), Fraction(250)) == [250, 500]


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (lambda: balises(Fraction(0), Fraction(600), Fraction(600)), "any below 600 m"),
        (lambda: balises(Fraction(0), Fraction(600), Fraction(0)), "any above 0"),
        (lambda: detection_delay(Fraction(200), Fraction(0)), "any above 0"),
    ],
)
def test_what_cannot_be_honoured_is_refused(wrong: Any, says: str) -> None:
    with pytest.raises(ModelError, match=says):
        wrong()


def test_the_widest_spacing_for_20_s_is_that_of_25_km_h() -> None:
    (asked,) = (each for each in syntheses() if each.id == "ats_release.widest_spacing_for_20_s")
    found = find(asked)
    assert found.safe_from is not None and found.refuted_at is not None
    assert found.safe_from <= 20 * mps(25) < found.refuted_at
    assert found.refuted_at - found.safe_from <= Fraction(1, 100)


def test_claims() -> None:
    for claim in claims_of(ats_release).values():
        check(of(claim.formula, OWN_LEMMAS))
    for one in declared():
        if one.id.startswith("ats_release."):
            assert one.found(30)["verdict"] == one.expect, one.id
