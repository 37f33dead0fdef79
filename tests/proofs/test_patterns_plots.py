"""The speed-distance diagrams show runs of the models: they intervene where the ceiling is, and end where they must."""

from __future__ import annotations

from fractions import Fraction

import pytest

from models.ats.supervision import Events, Orders, Supervision
from models.kinematics import (
    ACCELERATION,
    B_EMERGENCY,
    B_SERVICE,
    CYCLE,
    KMH,
    MARGIN,
    T_SERVICE,
    ceiling,
    ceiling_accelerating,
    distance,
    mps,
)
from models.patterns.follow_up import WithoutMargin
from models.patterns.markers import AS_DIMENSIONED, DRAWN, Markers, MarkersAsDrawn
from models.patterns.step_supervision import WORST, Sections, ShortSections, sections
from models.patterns.stepped_limiter import LENGTHS, PRINTED
from models.position.odometer import Position, step_s
from proofs import ats_plots, patterns_plots, patterns_plots_follow_up, patterns_plots_steps, patterns_plots_systems
from proofs.patterns_drawn import BEYOND, EMERGENCY, SERVICE, WARNING, Course
from safety import ModelError
from safety.exhibits import Exhibit, declared
from safety.report.plot_svg import plot_svg

FILES = (ats_plots, patterns_plots, patterns_plots_follow_up, patterns_plots_steps, patterns_plots_systems)
PLOTS = [each for each in declared() if each.id.startswith(("ats_plots.", "patterns_plots."))]
A_CYCLE = mps(100) * CYCLE  # m at 100 km/h


@pytest.mark.parametrize("each", PLOTS, ids=lambda each: each.id)
def test_a_diagram_has_units_a_falling_distance_and_an_end_for_every_run(each: Exhibit) -> None:
    entry = each.evaluate()
    assert (entry["x"]["unit"], entry["x"]["falling"], entry["y"]["unit"]) == ("m", True, "km/h")
    assert entry["assumed"] and all(text.startswith("[A]") for text in entry["assumed"])
    ends = [mark for mark in entry["marks"] if mark.get("label") == "end of a run"]
    assert all(entry["x"]["low"] <= x <= entry["x"]["high"] for mark in ends for x, _ in mark["points"])
    assert "NaN" not in plot_svg(entry, "i")


class Blind(Supervision, tick_s=step_s):
    """Reads no stop."""

    def step(self, events: Events, where: Position) -> tuple[Supervision, Orders]:
        return super().step(events._replace(stop_read=events.reset & ~events.reset), where)


def kinds(course: Course) -> list[str]:
    """Which brakes came on, in their order."""
    return [kind for kind, _ in course.began]


# --- ATS -------------------------------------------------------------------------------------------------------------


def test_a_passive_driver_with_ats_s_stands_at_the_signal() -> None:
    course = ats_plots.with_ats_s(lambda x: False)
    (kind, (x, v)), (end, last) = course.began[0], course.end
    assert (kind, v, last) == (EMERGENCY, 100, 0) and 0 <= end < Fraction(1, 20)
    assert x == ats_plots.WARNED - mps(100) * 5 == distance(mps(100), B_EMERGENCY, Fraction(3, 2))


def test_who_lets_go_passes_the_signal() -> None:
    course = ats_plots.with_ats_s(lambda x: x == ats_plots.WARNED - mps(100) * Fraction("4.9"))
    assert (course.began, course.end[1]) == ([], 100) and course.end[0] < 0


def test_ats_sp_intervenes_in_the_first_cycle_above_its_pattern() -> None:
    course = ats_plots.with_ats_sp(ats_plots.coasts)
    kind, (x, v) = course.began[0]
    held = distance(v * KMH, B_SERVICE, T_SERVICE) + MARGIN
    assert kind == SERVICE and held - mps(95) * CYCLE <= x < held
    assert MARGIN <= course.end[0] < MARGIN + 1 and course.end[1] == 0


def test_a_released_pattern_does_not_come_back() -> None:
    by_phase = ats_plots.with_ats_sp(ats_plots.obeys, phase_released=ats_plots.phase_read(ats_plots.CLEARS))
    assert by_phase.began == [] and by_phase.end[0] < BEYOND
    slowest = min(v for _, v in by_phase.places)
    assert next(x for x, v in by_phase.places if v == slowest) < ats_plots.CLEARS


def test_a_planted_model_is_seen_in_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pattern that is never made: the run does not stop."""

    monkeypatch.setattr(ats_plots, "Supervision", Blind)
    assert ats_plots.with_ats_sp(ats_plots.coasts).end[1] > 0


# --- patterns --------------------------------------------------------------------------------------------------------


def test_markers_stop_the_train_but_for_those_drawn_and_traction() -> None:
    good, drawn = patterns_plots.marker_run(Markers, AS_DIMENSIONED), patterns_plots.marker_run(MarkersAsDrawn, DRAWN)
    pushed = patterns_plots.marker_run(Markers, AS_DIMENSIONED, ACCELERATION)
    assert 0 <= good.end[0] < Fraction(1, 1000)
    assert -drawn.end[0] == pytest.approx(2.859, abs=5e-4) and -pushed.end[0] == pytest.approx(204.039, abs=5e-3)
    assert kinds(good) == kinds(drawn) == kinds(pushed) == [SERVICE, EMERGENCY]
    assert [x for _, (x, _) in pushed.began] == [AS_DIMENSIONED["x3"], 50]


def test_a_run_that_the_marker_model_does_not_admit_is_no_picture() -> None:
    laid = {**AS_DIMENSIONED, "x2": AS_DIMENSIONED["x2"] - 10}
    with pytest.raises(ModelError):
        patterns_plots.marker_run(Markers, laid)


def test_the_supervisor_intervenes_at_its_ceiling_and_the_plain_one_overruns() -> None:
    held, plain = (patterns_plots.supervised(500, mps(50), each) for each in ({}, {"a": 0}))
    (x, v), (y, w) = (next(place for kind, place in each.began if kind == SERVICE) for each in (held, plain))
    conservative = ceiling_accelerating(x, B_SERVICE, T_SERVICE, ACCELERATION, digits=9).middle
    assert 0 < v * KMH - conservative < ACCELERATION * CYCLE + Fraction(1, 4)
    assert 0 < w * KMH - ceiling(y, B_SERVICE, T_SERVICE, digits=9).middle < ACCELERATION * CYCLE + Fraction(1, 4)
    assert 0 <= held.end[0] < 2 and plain.end[0] < -40


def test_without_acknowledgement_the_train_stops_and_with_it_creeps_past() -> None:
    silent, creeps = (patterns_plots_systems.with_cab_signals(each) for each in (False, True))
    assert silent.end[1] == 0 and 0 <= silent.end[0] < 1 and EMERGENCY in kinds(silent)
    assert creeps.end[0] < 0 and 20 < creeps.end[1] <= Fraction("24.15") and EMERGENCY not in kinds(creeps)


@pytest.mark.parametrize(("gradient", "curve", "off"), [(-20, -16, -35.11), (-12, -16, 31.26), (-16, -16, 0)])
def test_stops_in_the_steepest_bin_are_off_by_what_the_specification_says(
    gradient: int, curve: int, off: float
) -> None:
    course = patterns_plots_systems.with_generator(gradient, Fraction(curve))
    assert float(course.end[0]) == pytest.approx(off, abs=5e-3) and kinds(course) == [SERVICE]


def test_a_missing_inductor_is_passed_and_the_channel_stops_the_train() -> None:
    whole, without = patterns_plots_systems.with_inductors(), patterns_plots_systems.with_inductors("c")
    assert 0 <= whole.end[0] < 1 and whole.end[1] == 0
    assert without.end[0] < -20 and without.end[1] == 0 and without.began[-1][1][0] <= 0


def test_the_limiter_stops_the_train_but_for_the_sections_of_the_ladder() -> None:
    long, short = (patterns_plots_systems.with_limiter(each) for each in (LENGTHS, PRINTED))
    assert 0 <= long.end[0] < 10 and short.end[0] < -2 and long.end[1] == short.end[1] == 0


def test_the_warning_comes_five_seconds_before_the_brake() -> None:
    course = patterns_plots.supervised(900, mps(100), {"a": 0}, Fraction(0), MARGIN)
    places = {kind: x for kind, (x, _) in reversed(course.began)}
    assert abs(places[WARNING] - places[SERVICE] - 5 * mps(100)) <= A_CYCLE
    assert MARGIN <= course.end[0] < MARGIN + 2


def test_the_ground_program_is_kept_unless_pulses_are_missed() -> None:
    for start in (45, 60, 75):
        course = patterns_plots_systems.with_program(start)
        settled = [(v, patterns_plots_systems.program(float(x))) for x, v in course.places if x < 700]
        assert all(0.94 * held <= v <= 1.1 * held for v, held in settled)
    assert max(v for _, v in patterns_plots_systems.with_program(60, every=2).places) > 90


def test_the_regulator_keeps_the_train_at_its_curve_where_the_effort_leaves_a_margin() -> None:
    down, selected, up = patterns_plots_follow_up.runs().values()
    for passed, most in ((down, 2.12), (selected, 0.43), (up, 2.12)):
        assert max(abs(each.v - each.curve) for each in passed) <= most
        assert max(abs(each.v - each.curve - each.error) for each in passed) < 1e-5  # the model against the motion
    leaves = patterns_plots_follow_up.along(WithoutMargin, -20, patterns_plots_follow_up.STRONG)
    assert max(each.error for each in leaves) > 6


def test_steps_stop_the_worst_train_at_the_signal_and_in_shorter_sections_beyond_it() -> None:
    laid, short = sections(), sections(b=patterns_plots_steps.BETTER)
    worst, better = (patterns_plots_steps.through(Sections, laid, b) for b in (WORST, patterns_plots_steps.BETTER))
    beyond = patterns_plots_steps.through(ShortSections, short, WORST)
    assert worst.end == (0, 0) and worst.began[0][1] == (825, 100) and len(worst.began) == 4
    assert better.end[0] > 10 and better.end[1] == 0
    assert beyond.end[0] < -50 and beyond.end[1] == 0
    with pytest.raises(ModelError, match="long enough for the worst-braked train"):
        patterns_plots_steps.through(Sections, short, WORST)


def test_the_two_stage_pattern_stops_the_train_but_for_balises_that_lie_nearer() -> None:
    good, bad = patterns_plots_steps.two_stages(), patterns_plots_steps.two_stages(patterns_plots_steps.NEARER)
    assert MARGIN <= good.end[0] < MARGIN + 2 * A_CYCLE  # sampling and processing are in the budget
    assert good.end[0] - bad.end[0] == pytest.approx(patterns_plots_steps.NEARER, abs=3) and bad.end[0] < 0
    assert kinds(good)[0] == kinds(bad)[0] == SERVICE
