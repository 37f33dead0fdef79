"""Stepped high-speed limiter: lengths, scatter, dead band, what is refused, planted bugs."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from models.kinematics import KMH, distance
from models.patterns.stepped_limiter import (
    FORCES,
    H_ON,
    LADDER,
    LENGTHS,
    PRINTED,
    DeadBandAtZero,
    Limiter,
    PrintedSections,
    Sections,
    SteppedLimiter,
    length,
    longer_by_reading,
)
from safety import Bit, ModelError, Real, Scenario, run
from safety.tracing import trace
from tests.models.patterns.planted import judged
from tests.models.ts7.test_readings import direct_and_python_agree

NEAR = 1e-4


@pytest.mark.parametrize("model", [Limiter, SteppedLimiter, DeadBandAtZero, Sections, PrintedSections])
def test_direct_and_python_agree(model: Any) -> None:
    direct_and_python_agree(model)


def test_every_parameter_has_unit_range_and_source() -> None:
    assert all(s.unit and s.low <= s.value <= s.high and len(s.source) > 5 for s in trace(Sections).settings.values())


def test_sp_12_lengths_and_scatter() -> None:
    model = [trace(PrintedSections).settings[f"l{k}"].value for k in range(1, 6)]
    assert [float(x) for x in model] == pytest.approx([1829.63, 1026.39, 477.78, 237.30, 61.31], rel=NEAR)
    assert float(sum(model)) == pytest.approx(3632.41, rel=NEAR)
    without = sum(length(k, Fraction(0), Fraction(0)) for k in range(5))
    assert float(without) == pytest.approx(3310.19, rel=NEAR)
    assert float(distance(LADDER[0], FORCES[0], 0)) == pytest.approx(4083.33, rel=NEAR)
    assert float(LADDER[0] / 2) == pytest.approx(29.17, rel=2e-4)


def test_reading_error_lengthens_the_braking() -> None:
    longer, braking = longer_by_reading(Fraction(1, 100)), length(0, Fraction(0), Fraction(0))
    assert float(longer) == pytest.approx(82.08, rel=NEAR)
    assert float(braking) == pytest.approx(1712.96, rel=NEAR)
    assert float(longer / braking) == pytest.approx(0.048, abs=0.0005)


def test_lengths_for_the_dead_band_are_longer() -> None:
    assert all(longer > printed for longer, printed in zip(LENGTHS, PRINTED, strict=True))


def test_the_dead_band() -> None:
    """On above 162 km/h, off at 159, at the step of 160."""
    speeds = [Fraction(v) for v in ("150", "161", "162", "162.1", "161", "159.1", "159", "161")]
    seen = run(SteppedLimiter, lambda k: {"v": speeds[k] * KMH, "signal": LADDER[1]}, len(speeds))
    assert seen["brake"] == [False, False, False, True, True, True, False, False]


def test_forces_of_the_steps() -> None:
    seen = run(SteppedLimiter, lambda k: {"v": 0, "signal": LADDER[k]}, 6)
    assert seen["force"] == [FORCES[0], *FORCES]
    assert seen["brake"][-1] and seen["emergency"][1] == FORCES[0] * Fraction(7, 5)


@pytest.mark.parametrize(("number", "setting"), [(1, {"l1": PRINTED[0]}), (5, {"l5": 61}), (3, {"l3": 480})])
def test_sections_that_are_too_short_are_refused(number: int, setting: dict[str, Any]) -> None:
    with pytest.raises(ModelError, match=f"section {number} is too short for the dead band.*nearest admissible length"):
        trace(Sections, setting)


class NoDeadBandOff(SteppedLimiter, tick_s="0.1"):
    """Planted: the brake goes off as soon as the speed is no longer above the dead band."""

    def at_zero(self, limit: Real, above: Bit) -> Bit:
        """Forgets step 0."""
        return above


@pytest.mark.parametrize("model", [NoDeadBandOff, DeadBandAtZero])
def test_a_planted_dead_band_at_zero_is_found(model: Any) -> None:
    creep = Scenario(3, {"v": lambda k: H_ON if k else 0, "signal": lambda k: 0 if k else LADDER[4]})
    assert judged("patterns_stepped_limiter.no_signal_brakes_at_any_speed", model, creep).verdict == "refuted"
