"""Several ground markers: dimensioning, the overruns, what is refused, planted bugs."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest

from models.kinematics import KMH, distance
from models.patterns.marker_spacing import way_with_service_brake_on
from models.patterns.markers import (
    AS_DIMENSIONED,
    Markers,
    MarkersAsDrawn,
    Passed,
    Scheme,
    overrun,
)
from proofs.patterns_markers import NO_BRAKE_TO_3, from_2, rolling
from safety import Bit, ModelError, Real, Scenario, power_up, run
from safety.prove.weakest import declared
from safety.prove.weakest_search import find
from safety.tracing import trace
from tests.models.patterns.planted import judged
from tests.models.ts7.test_readings import direct_and_python_agree

NEAR = 1e-4


def at(scenario: Scenario) -> Callable[[int], dict[str, Any]]:
    """The speeds of a scenario as inputs of a run."""
    return lambda k: {"v": scenario.inputs["v"](k), "released": False, "acknowledged": False}


@pytest.mark.parametrize("model", [Markers, MarkersAsDrawn])
def test_direct_and_python_agree(model: Any) -> None:
    direct_and_python_agree(model)


def test_every_parameter_has_unit_range_and_source() -> None:
    assert all(s.unit and s.low <= s.value <= s.high and len(s.source) > 5 for s in trace(Markers).settings.values())


def test_sp_09_markers() -> None:
    scheme = Scheme()
    levels = [float(level.middle / KMH) for level in (scheme.fastest, scheme.a)]
    assert levels == pytest.approx([30.633, 74.677], rel=NEAR)
    places = [float(x.middle) for x in (scheme.x1, scheme.x2, scheme.x3)]
    assert places == pytest.approx([910.279, 608.980, 349.168], rel=NEAR)
    assert all(0 <= x.high - x.low < Fraction(1, 10**25) for x in (scheme.x1, scheme.x2, scheme.x3, scheme.a))
    laid = trace(Markers).settings
    assert float(laid["x2"].value) == pytest.approx(608.980, rel=NEAR)
    assert float(overrun(30 * KMH) + 50) == pytest.approx(48.214, rel=NEAR)


def test_laid_to_the_safe_side() -> None:
    """What is laid and set is no nearer and no faster than the exact values, by less than 0.1 mm."""
    scheme = Scheme()
    assert 0 <= AS_DIMENSIONED["x2"] - scheme.x2.high < Fraction(1, 10_000)
    assert abs(AS_DIMENSIONED["x3"] - scheme.x3.low) < Fraction(1, 10_000)  # of the level that was rounded down
    assert 0 <= scheme.a.low - AS_DIMENSIONED["level_a"] < Fraction(1, 10_000)


def test_sp_10_markers_as_drawn() -> None:
    """The run of the model: 31.623 km/h at 4 and 2.859 m beyond the signal; none if the service brake goes on."""
    drawn = Scheme(free_run=False)
    assert float(drawn.x2.middle) == pytest.approx(605.556, rel=NEAR)
    seen = run(MarkersAsDrawn, at(from_2(drawn.settings())), 3)
    assert (seen["service"], seen["emergency"]) == ([True, True, True], [False, False, True])
    v4 = seen["v"][2]
    assert float(v4 / KMH) == pytest.approx(31.623, rel=NEAR)
    assert round(float(overrun(v4)), 3) == 2.859
    assert float(way_with_service_brake_on(v4)) == pytest.approx(43.224, rel=NEAR)


def test_traction_between_2_and_4() -> None:
    seen = run(trace(Markers, {"gains": Fraction("0.8")}), at(NO_BRAKE_TO_3), 3)
    assert seen["service"] == [False, True, True]
    assert float(seen["v"][2] / KMH) == pytest.approx(74.933, rel=NEAR)
    assert float(overrun(seen["v"][2])) == pytest.approx(204.039, rel=NEAR)


def test_the_run_on_the_downgrade_passes_2_without_brake() -> None:
    speeds = [rolling().inputs["v"](k) for k in range(3)]
    assert speeds[0] < speeds[1] and speeds[2] > Scheme(stop_before=Fraction(60), gradient=-20).fastest.high


def test_point_x() -> None:
    """Who brakes at 1 and never eases stops 299.168 m before the signal, well before 4."""
    x = Scheme().x1.middle - distance(100 * KMH, Scheme().brakes[0], 2)
    assert float(x) == pytest.approx(299.168, rel=NEAR)


def test_spacing_is_stretched_by_the_gradient() -> None:
    down, level, up = (Scheme(stop_before=Fraction(60), gradient=i) for i in (-20, 0, 20))
    assert down.x2.low > level.x2.high > level.x2.low > up.x2.high


@pytest.mark.parametrize(
    ("what", "says"),
    [
        ({"b": 31 * KMH}, "nearest admissible value is 30.6326 km/h, or l = 51.0516 m"),
        ({"gradient": -20}, "nearest admissible value is 27.7993 km/h, or l = 57.24 m"),
        ({"gradient": -80}, "nearest admissible value is above -70.8"),
        ({"top": 20 * KMH}, "nearest admissible value is 30.6327 km/h"),
    ],
)
def test_what_cannot_be_honoured_is_refused(what: dict[str, Any], says: str) -> None:
    with pytest.raises(ModelError, match=says.replace(".", r"\.")):
        Scheme(**what)


@pytest.mark.parametrize(
    ("setting", "says"),
    [
        ({"x2": 600}, "service brake at 2 suffices from Vmax.*nearest admissible x2 is 608.981 m"),
        ({"x3": 340}, "service brake at 3 suffices from A.*nearest admissible x3 is 349.169 m"),
        ({"level_b": 9}, "B is not above v4max.*nearest admissible B is 8.50906 m/s"),
        ({"stop_before": 49}, "emergency brake at 4 stops from v4max.*nearest admissible l is 50 m"),
        ({"x3": 650}, "points in order.*nearest admissible x2 is 650 m"),
        ({"b_service": 5}, "nearest admissible value is 3"),
    ],
)
def test_parameters_that_do_not_fit_are_refused(setting: dict[str, Any], says: str) -> None:
    with pytest.raises(ModelError, match=says):
        trace(Markers, setting)


class ForgetsPoint2(Markers, event="passing of point 2, 3, 4"):
    """Planted: the service brake that was ordered at 2 is given up at 3."""

    braking: Bit = power_up(False)

    def step(self, v: Real, released: Bit, acknowledged: Bit) -> tuple[Markers, Passed]:
        """At 3 only what 3 orders."""
        after, seen = super().step(v, released, acknowledged)
        forgets = self.past_2 & ~self.past_3 & self.braking
        kept = {name: getattr(after, name) for name in ("past_2", "past_3", "before", "began_v", "began_x")}
        return type(self)(**kept, braking=after.braking & ~forgets), seen


FROM_VMAX = from_2(AS_DIMENSIONED)
LET_GO = Scenario(3, {"v": lambda k: FROM_VMAX.inputs["v"](min(k, 1))})


def test_a_planted_bug_is_found() -> None:
    assert judged("patterns_markers.no_train_passes_the_signal", ForgetsPoint2, LET_GO).verdict == "refuted"


def test_weakest_sizes() -> None:
    """The searches end next to the exact values, a proof on one side and a counterexample on the other."""
    found = {s.parameter: find(s) for s in declared() if s.id.startswith("patterns_markers.")}
    exact = {"x2": Scheme().x2, "x3": Scheme().x3, "a": Scheme().a}
    for name, value in exact.items():
        safe, refuted = found[name].safe_from, found[name].refuted_at
        assert safe is not None and refuted is not None
        assert min(safe, refuted) - Fraction(1, 1000) < value.middle < max(safe, refuted) + Fraction(1, 1000)
        assert found[name].settled
    assert float(found["ahead"].safe_from or 0) == pytest.approx(52.859, abs=0.01)
