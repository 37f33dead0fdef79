"""Refusals: what is told as the nearest admissible value is admitted."""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import pytest

from models.kinematics import KMH, at_least, at_most, ceiling, effective
from models.patterns.marker_spacing import Scheme
from models.patterns.markers import Markers
from models.patterns.step_supervision import check_sections
from safety import ModelError
from safety.tracing import trace

MARKS = {"x2": "x2", "x3": "x3", "l": "stop_before", "B": "level_b"}  # as told: as set


@pytest.mark.parametrize("value", [Fraction(2, 3), Fraction(-2, 3), Fraction(125, 2), Fraction(10**9, 7), Fraction(0)])
def test_a_value_is_rounded_to_its_own_side(value: Fraction) -> None:
    low, high = Fraction(at_most(value)), Fraction(at_least(value))
    assert low <= value <= high
    assert high - low <= abs(value) / 10**5


@pytest.mark.parametrize(
    "settings",
    [
        {"x2": Fraction(600)},
        {"x3": Fraction(340)},
        {"level_b": Fraction(9)},
        {"level_a": Fraction(21)},
        {"top": Fraction(30)},
        {"fastest": Fraction(9)},
    ],
)
def test_the_nearest_marker_or_level_is_admitted(settings: Mapping[str, Any]) -> None:
    with pytest.raises(ModelError) as told:
        trace(Markers, settings)
    found = re.search(r"nearest admissible (\w+) is ([\d.]+)", str(told.value))
    assert found is not None
    trace(Markers, {**settings, MARKS[found[1]]: Fraction(found[2])})


def test_the_nearest_section_scheme_and_gradient_are_admitted() -> None:
    with pytest.raises(ModelError, match=r"is 122\.223 m"):
        check_sections([457, 189, 122, 58])
    check_sections([457, 189, Fraction("122.223"), 58])
    with pytest.raises(ModelError, match=r"is 30\.6326 km/h"):
        Scheme(b=Fraction(9))
    Scheme(b=Fraction("30.6326") * KMH)
    with pytest.raises(ModelError, match=r"above -50\.9858 permille"):
        effective(Fraction(1, 2), -60)
    assert effective(Fraction(1, 2), Fraction("-50.9858")) > 0


def test_masses_below_zero_and_doubles_in_an_enclosure_are_refused() -> None:
    for share in (-1, -2):
        with pytest.raises(ModelError, match="share of rotating masses"):
            effective(Fraction(1, 2), -60, share)
    for x in (0.5, float("inf"), "a"):
        with pytest.raises(ModelError, match="is not exact"):
            ceiling(x, 1, 1)  # type: ignore[arg-type]
