"""The total error of the two-counter ATC: proved bounds, closed form and the model's worst ride meet."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from models.two_counter import experiments
from models.two_counter.experiments import EARLY, dynamic_test, excess_from, static_test, worst_ride
from models.two_counter.inference import DIVIDED
from models.two_counter.motion import SPACING, Rise, inputs, instant, rise_per_step, train_phase
from models.two_counter.numbers import (
    CHECK_SPEEDS,
    COUNTING_S,
    DYNAMIC,
    HZ_PER_KMH,
    N1F,
    N1F_RANGE,
    STATIC,
    pulses,
    scale_speed,
    threshold_hz,
)
from models.two_counter.theory import (
    acceleration_for,
    oscillator_error_for,
    static_error_exact,
    time_to_read_out,
    worst_excess,
)
from proofs import (
    two_counter_accuracy,
    two_counter_comparison,
    two_counter_intervals,
    two_counter_plots,
    two_counter_tables,
)
from proofs.two_counter_accuracy import (
    ALLOWED,
    CRYSTAL,
    LEAST,
    SAFE_ERROR,
    SAFE_RISE,
    TOO_FAST,
    TOO_STEEP,
    excess,
)
from safety import PROVED, REFUTED, run
from safety.exhibits import declared as exhibits
from safety.prove.bounds import bracket, check
from safety.prove.bounds.claims import declared
from safety.prove.prove import prove
from safety.report.standing import standing
from tests.proofs import verdicts

TINY = Fraction(1, 10**6)


def supremum(speed: int, rise: Fraction | int = 1, n1f: int = N1F) -> Fraction:
    """The closed form."""
    return worst_excess(pulses(speed), n1f, COUNTING_S, HZ_PER_KMH, rise).middle


# --- claims ----------------------------------------------------------------------------------------------------------


def test_each_proved_bound_has_a_twin_that_fails_and_all_are_as_asked() -> None:
    claims = [claim for claim in declared() if claim.module == two_counter_accuracy.__name__]
    limited = [claim for claim in claims if claim.limit is not None]
    proved = {claim.id for claim in limited if claim.expect == PROVED}
    assert len(proved) == 12 and proved == {claim.twin_of for claim in limited if claim.expect == REFUTED}
    assert [standing("claims", claim.evaluate(20.0)).code for claim in claims] == [0] * 28
    assert {claim.bound.requirement for claim in claims} == {"TC-5"}


@pytest.mark.parametrize("speed", CHECK_SPEEDS)
def test_supremum_is_bracketed_by_both_routes_around_the_closed_form(speed: int) -> None:
    found = bracket(excess(speed))
    assert (found.verdict, len(found.agreed_by)) == (PROVED, 2)
    assert found.low is not None and found.high is not None and found.width is not None
    assert found.low <= supremum(speed) <= found.high and found.width <= Fraction(1, 10_000)
    assert supremum(speed) < Fraction(LEAST[speed]) < ALLOWED


def test_over_all_n1f_the_smallest_is_the_worst() -> None:
    (claim,) = (c for c in declared() if c.id == "two_counter_accuracy.worst_excess_any_n1f")
    found = bracket(claim.bound)
    assert found.low is not None and found.high is not None
    assert found.low <= supremum(250, 1, N1F_RANGE[0]) <= found.high < ALLOWED
    assert supremum(250, 1, N1F_RANGE[1]) < supremum(250) < supremum(250, 1, N1F_RANGE[0])


def test_the_rise_at_which_a_quarter_percent_fails() -> None:
    exact = acceleration_for(ALLOWED, pulses(250), N1F, COUNTING_S, HZ_PER_KMH).middle
    assert SAFE_RISE < exact < TOO_STEEP < SAFE_RISE + Fraction(2, 10_000)
    (claim,) = (c for c in declared() if c.id == "two_counter_accuracy.slowest_rise_that_fails")
    found = bracket(claim.bound, claim.width)
    assert found.low is not None and found.high is not None
    assert found.low <= 1 / exact <= found.high


def with_error(ppm: int) -> Fraction:
    """The closed form with an oscillator so much off, at 250 km/h and 1 km/h/s."""
    return worst_excess(pulses(250), N1F, COUNTING_S, HZ_PER_KMH, 1, ppm).middle


def test_the_oscillator_error_at_which_a_quarter_percent_fails() -> None:
    exact = oscillator_error_for(ALLOWED, pulses(250), N1F, COUNTING_S, HZ_PER_KMH, 1).middle
    assert SAFE_ERROR < exact < TOO_FAST == SAFE_ERROR + 1
    (claim,) = (c for c in declared() if c.id == "two_counter_accuracy.least_oscillator_error_that_fails")
    found = bracket(claim.bound, claim.width)
    assert found.low is not None and found.high is not None
    assert found.low <= 1 / (1 + exact / 1_000_000) <= found.high
    assert with_error(CRYSTAL) < with_error(SAFE_ERROR) < ALLOWED < with_error(TOO_FAST)


@pytest.mark.parametrize("ppm", [CRYSTAL, SAFE_ERROR, TOO_FAST])
def test_worst_ride_with_an_oscillator_that_is_off(ppm: int) -> None:
    """The model with the error set comes as near to the supremum, on the same side of 0.25 %."""
    run_to = worst_ride(250, error=ppm).excess
    assert 0 <= with_error(ppm) - run_to < TINY
    assert (run_to > ALLOWED) is (ppm == TOO_FAST)
    found = check(excess(250, ppm=ppm), ALLOWED)
    assert found.verdict == (REFUTED if ppm == TOO_FAST else PROVED)


def test_every_bound_says_what_it_takes_for_exact() -> None:
    for claim in (c for c in declared() if c.module == two_counter_accuracy.__name__ and "excess" in c.id):
        assert "oscillator" in claim.statement and any("oscillator" in each for each in claim.bound.assumed)
        assert two_counter_accuracy.WHEEL in claim.bound.assumed


def test_a_supremum_with_a_pulse_less_would_be_refuted(monkeypatch: pytest.MonkeyPatch) -> None:
    """The derivation counts: a read-out right at the end of the count would bring the brake earlier."""
    monkeypatch.setattr(two_counter_accuracy, "READ_OUT_PULSES", 0)
    too_good = bracket(excess(250)).high
    assert too_good is not None and too_good < worst_ride(250).excess
    monkeypatch.undo()
    assert check(excess(250), too_good).verdict == REFUTED


# --- the worst ride of the model -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("speed", "rise"), [*((speed, Fraction(1)) for speed in CHECK_SPEEDS), (250, SAFE_RISE), (250, TOO_STEEP)]
)
def test_worst_ride_comes_as_near_to_the_supremum_as_one_likes(speed: int, rise: Fraction) -> None:
    run_to = worst_ride(speed, rise).excess
    assert 0 <= supremum(speed, rise) - run_to < TINY
    assert (run_to > ALLOWED) is (rise == TOO_STEEP)
    later = worst_ride(speed, rise, early=Fraction(1, 2)).excess
    assert later < run_to


def test_replayed_witness_of_the_refutation() -> None:
    """The point at which 0.25 % is exceeded, ridden: its rise, from the window that it leaves."""
    found = check(excess(250, TOO_STEEP), ALLOWED)
    assert found.verdict == REFUTED and found.witness is not None and found.value is not None
    at = {str(v.attr): low for v, (low, _) in found.witness.items()}
    rise = at["a"] / COUNTING_S
    assert 0 <= supremum(250, rise) - worst_ride(250, rise).excess < TINY
    assert worst_ride(250, rise).excess > ALLOWED and abs(worst_ride(250, rise).excess - found.value[0]) < 50 * TINY


def test_p20_no_start_and_no_phase_does_worse_than_the_supremum() -> None:
    phases = (Fraction(0), Fraction(1, 2), 1 - EARLY)
    starts = [Fraction(n, 100) for n in (1, 12, 25)] + [Fraction("0.0264")]
    found = [excess_from(250, below, phase) for phase in phases for below in starts]
    assert supremum(250) - Fraction(1, 1000) < max(found) < supremum(250) < Fraction("0.5997")
    assert min(found) > 0


@pytest.mark.parametrize("edges", [1033, 1037])
def test_another_preset_than_the_theory_has_is_seen(monkeypatch: pytest.MonkeyPatch, edges: int) -> None:
    def changed(*args: Any, settings: dict[str, Any], **more: Any) -> Any:
        return run(*args, settings={**settings, "m250": edges}, **more)

    monkeypatch.setattr(experiments, "run", changed)
    with pytest.raises(ValueError, match="not the last safe one"):
        worst_ride(250)


def test_a_count_too_short_is_no_worst_ride() -> None:
    with pytest.raises(ValueError, match="not the last safe one"):
        worst_ride(250, early=Fraction(-1, 2))
    with pytest.raises(ValueError, match="standstill"):
        worst_ride(5, 300)


def test_motion_is_run_exactly() -> None:
    motion = Rise(Fraction(517_500), rise_per_step(1), Fraction(1, 3))
    way, speeds = train_phase(motion) + 1, inputs(motion)
    for step in range(1, 3000):
        way += next(speeds)
        assert way - 1 < motion.position(step) <= way
    assert motion.position(motion.start) == 8 * SPACING
    low, high = instant(motion, 8 + 1035)
    assert motion.position(low) <= (8 + 1035) * SPACING <= motion.position(high)
    assert high - low < Fraction(1, 10**15)


# --- the tests of section 6 ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("row", [STATIC[0], STATIC[6]])
def test_static_test_gives_the_threshold_and_the_band_above_it(row: Any) -> None:
    first, every = (static_test(row.speed, first=at_once) / DIVIDED for at_once in (True, False))
    assert 0 <= first - threshold_hz(row.speed) < Fraction(1, 1000)
    band = static_error_exact(scale_speed(row.speed), N1F) * HZ_PER_KMH
    assert abs(every - first - band) < Fraction(1, 1000)


@pytest.mark.parametrize("row", DYNAMIC)
def test_dynamic_test_gives_the_exact_time_within_a_period(row: Any) -> None:
    exact = time_to_read_out(pulses(row.speed), COUNTING_S, HZ_PER_KMH, 1)
    found = dynamic_test(row.speed)
    assert 0 <= exact.low - found.time < COUNTING_S / N1F
    assert abs(exact.middle - Fraction(row.time)) < Fraction(25, 100_000)
    assert abs(found.excess - (exact.middle - COUNTING_S / 2)) < TINY


def test_tables_are_as_asked_and_name_the_misprints() -> None:
    homes = {home.__name__ for home in (two_counter_tables, two_counter_plots, two_counter_comparison)}
    made = [one for one in exhibits() if one.make.__module__ in homes]
    assert len(made) == 9
    tables = [one.evaluate() for one in made if one.kind == "table"]
    assert [one["as_expected"] for one in tables] == [True] * 6
    expected = {no for one in made for no in one.says_no}
    assert {"250: eighth agrees", "30: theory agrees", "5: measured agrees", "(7): agree", "(18): agree"} <= expected


def test_a_wrong_optimum_crossing_or_time_is_a_no(monkeypatch: pytest.MonkeyPatch) -> None:
    share, by_hand = two_counter_plots.SHARES[0], two_counter_plots.OPTIMA[0]
    assert False not in two_counter_plots.figure_4_row(share, by_hand)
    assert False in two_counter_plots.figure_4_row(share, ("801", "3840"))
    monkeypatch.setattr(two_counter_plots, "crossing", lambda *_: Fraction(2001))
    assert False in two_counter_plots.figure_4_row(share, by_hand)
    late = time_to_read_out(pulses(250), COUNTING_S, HZ_PER_KMH, 1).scaled(1, Fraction(1, 1000))
    assert False not in two_counter_tables.dynamic_row(DYNAMIC[0])
    monkeypatch.setattr(two_counter_tables, "time_to_read_out", lambda *_: late)
    assert False in two_counter_tables.dynamic_row(DYNAMIC[0])


# --- the circuit's part ----------------------------------------------------------------------------------------------


def test_edges_between_the_events_of_a_sample() -> None:
    claims = verdicts.claims_of(two_counter_intervals)
    assert len(claims) == 4 and verdicts.without_twin(claims) == []
    for claim in claims.values():
        verdicts.check(prove(claim, verdicts.OWN_LEMMAS))
