"""Phase release: 0.29 s and 0.31 s, joints, sections, a lost phase."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from models.ats.phase import AnySection, LostPhaseReleases, NoJointRule, PhaseBench, PhaseReceiver
from proofs import ats_phase
from safety import ModelError, run
from tests.models.ts7.test_readings import direct_and_python_agree
from tests.proofs.verdicts import OWN_LEMMAS, check, claims_of, of

FAST = Fraction(1, 100)  # s, a cycle


def released(
    lasts: str, *, model: Any = PhaseReceiver, cycle: Fraction = FAST, begins: Fraction = FAST / 2, at: int = 300,
    instead: str = "r", steps: int = 60,
) -> bool:  # fmt: skip
    """Whether N that begins so long after a cycle, and lasts so many seconds, releases; R or NONE before and after."""
    first = 5 * cycle + begins
    ends = first + Fraction(lasts)

    def row(k: int) -> dict[str, Any]:
        now, before = k * cycle, (k - 1) * cycle
        n = first <= now < ends
        edges = [edge for edge in (first, ends) if before < edge <= now]
        here = dict.fromkeys(("where.low", "where.guess", "where.high"), at)
        phase = {"phase.n": n, "phase.r": instead == "r" and not n}
        age = now - edges[-1] if edges else 0
        return phase | here | {"phase.changed": bool(edges), "phase.age": age, "where.fastest": 20, "where.slowest": 20}

    settings = {"cycle": cycle}
    return True in run(model, row, steps, settings=settings)["released"]


@pytest.mark.parametrize("model", [PhaseReceiver, PhaseBench])
def test_direct_and_python_agree(model: Any) -> None:
    direct_and_python_agree(model)


@pytest.mark.parametrize("begins", [Fraction(k, 1000) for k in range(0, 10, 3)])
def test_as_10_n_for_0_29_s_does_not_release_0_31_s_does(begins: Fraction) -> None:
    assert not released("0.29", begins=begins)
    assert released("0.31", begins=begins)


@pytest.mark.parametrize("begins", [Fraction(k, 100) for k in range(10)])
def test_as_10_in_cycles_of_0_1_s_the_time_is_still_that_of_the_stamps(begins: Fraction) -> None:
    """Never for 0.29 s, always for 0.4 s; what ends between two cycles is not released afterwards."""
    slow = Fraction(1, 10)
    assert not released("0.29", cycle=slow, begins=begins)
    assert released("0.4", cycle=slow, begins=begins)


def test_as_10_no_phase_never_releases() -> None:
    assert not released("0", instead="none", steps=500)
    assert released("0", instead="none", model=LostPhaseReleases)


@pytest.mark.parametrize(("at", "releases"), [(9, False), (10, True), (590, True), (591, False)])
def test_as_10_within_10_m_of_a_joint_does_not_release(at: int, releases: bool) -> None:
    assert released("0.5", at=at) == releases
    assert released("0.5", at=at, model=NoJointRule)


@pytest.mark.parametrize("at", [-200, 800])
def test_another_section_does_not_release(at: int) -> None:
    assert not released("0.5", at=at)
    assert released("0.5", at=at, model=AnySection)


@pytest.mark.parametrize(
    ("phases", "at", "tells"),
    [("NR", 300, [1]), ("N-R", 300, [2]), ("RR", 300, []), ("-R", 300, []), ("NRR", 300, [1]), ("NR", 5, [])],
)
def test_the_phase_back_to_r_tells_stop_once(phases: str, at: int, tells: list[int]) -> None:
    def row(k: int) -> dict[str, Any]:
        here = dict.fromkeys(("where.low", "where.guess", "where.high"), at)
        phase = {"phase.n": phases[k] == "N", "phase.r": phases[k] == "R", "phase.changed": False, "phase.age": 0}
        return phase | here | {"where.fastest": 20, "where.slowest": 20}

    told = run(PhaseReceiver, row, len(phases))["back_at_stop"]
    assert [k for k, back in enumerate(told) if back] == tells


def test_a_section_of_joint_zones_is_refused() -> None:
    with pytest.raises(ModelError, match=r"longer than both joint zones.*nearest admissible ends is any above 20 m"):
        run(PhaseReceiver, {}, 1, settings={"ends": 20})


@pytest.mark.parametrize("name", list(claims_of(ats_phase)))
def test_claims(name: str) -> None:
    check(of(getattr(ats_phase, name), OWN_LEMMAS))
