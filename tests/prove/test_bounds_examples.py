"""Error bounds of the field, each with the bug that must be found: braking, speed from counted pulses, rounding."""

from __future__ import annotations

from fractions import Fraction as F

import pytest

from safety.prove.bounds import (
    Bound,
    between,
    bracket,
    check,
    counted,
    magnitude,
    reals,
    rounded_down,
)
from safety.prove.bounds.routes import BOXES, NLSAT
from safety.prove.claims import PROVED, REFUTED
from safety.terms import real
from safety.terms.direct import evaluate
from tests.prove.bounded import bound, narrow

# --- braking under sampled control -----------------------------------------------------------------------------------


def overrun(dropped: bool = False) -> Bound:
    """Speed squared above what still stops, after any acceleration for any part of the reaction time."""
    v, d, b, most, a, reaction, t = reals("v d b most a reaction t")
    at_end = v + most * reaction
    rising = real(0) if dropped else b * most * reaction * reaction
    rule = 2 * b * v * reaction + rising + at_end * at_end <= 2 * b * d
    speed, travel = v + a * t, v * t + a * t * t / 2
    return Bound(
        "braking.rule",
        "Overrun of the target when the rule has let the train go on",
        speed * speed - 2 * b * (d - travel),
        (
            between(0, v, 90),
            between(0, d, 20_000),
            between(F(7, 10), b, F(14, 10)),
            between(0, most, F(3, 2)),
            between(0, reaction, 5),
            (a >= 0) & (a <= most),
            (t >= 0) & (t <= reaction),
            rule,
        ),
    )


def test_the_braking_rule_stops_the_train() -> None:
    found = check(overrun(), 0)
    assert (found.verdict, found.agreed_by) == (PROVED, [NLSAT, BOXES])


def test_the_braking_rule_is_tight() -> None:
    found = bracket(overrun())
    assert (found.verdict, found.low, found.high) == (PROVED, 0, 0)


def test_a_term_dropped_from_the_braking_rule_is_found() -> None:
    found = check(overrun(dropped=True), 0)
    assert found.verdict == REFUTED and found.value is not None and found.value[0] > 0
    assert found.witness is not None
    exact = {v: low for v, (low, high) in found.witness.items() if low == high}
    assert evaluate([overrun(dropped=True).beyond(F(0))], exact) == [True]


def envelope(share: F) -> Bound:
    """Distance beyond the envelope that takes a share of the build-up time as free running, all effects at once."""
    v, delay, rise, nominal, adhesion, grade, least, b = reals("v delay rise nominal adhesion grade least b")
    true = v * (delay + rise) - b * rise * rise / 6  # the deceleration rises steadily to b, then stays
    after = v - b * rise / 2
    return Bound(
        "braking.envelope",
        "Stopping distance beyond the envelope",
        2 * b * least * (true - v * (delay + rise * share)) + least * after * after - b * v * v,
        (
            between(0, v, 45),
            between(0, delay, 2),
            between(0, rise, 4),
            between(F(1, 2), nominal, F(13, 10)),
            between(F(7, 10), adhesion, 1),
            between(F(-20, 1000), grade, F(20, 1000)),
            b == nominal * adhesion + F("9.80665") * grade,
            least == nominal * F(7, 10) - F("9.80665") * F(20, 1000),
            after >= 0,
        ),
    )


def test_the_envelope_with_jerk_delay_grade_and_adhesion_holds() -> None:
    assert check(envelope(F(1, 2)), 0).verdict == PROVED
    assert check(envelope(F(1, 3)), 0).verdict == REFUTED


# --- two counters --------------------------------------------------------------------------------------------------

WINDOW, TICK = F(1, 2), F(1, 10**6)


def speed_error(slipped: bool = False) -> Bound:
    """Speed from a counted time over half a metre against the true speed in its middle; rounding is any phase."""
    v0, v1, middle, a, time, ticks = reals("v0 v1 middle a time ticks")
    seconds = ticks * TICK
    tick = 10 * TICK if slipped else TICK
    return Bound(
        "speed.error",
        "Relative error of the measured speed",
        magnitude(WINDOW - middle * seconds),
        (
            between(3, v0, 90),
            between(F(-3, 2), a, F(3, 2)),
            (v1 >= 0) & (v1 * v1 == v0 * v0 + 2 * a * WINDOW),
            (middle >= 0) & (middle * middle == v0 * v0 + a * WINDOW),
            time * (v0 + v1) == 2 * WINDOW,
            (time - tick < seconds) & (seconds < time + tick) if slipped else counted(ticks, time, TICK),
        ),
        per=middle * seconds,
    )


@pytest.mark.parametrize("percent", ["0.25", "0.15"])
def test_the_two_counters_are_within_their_error(percent: str) -> None:
    found = check(speed_error(), F(percent) / 100)
    assert (found.verdict, found.agreed_by) == (PROVED, [NLSAT, BOXES])


def test_the_two_counters_are_not_within_too_small_an_error() -> None:
    found = check(speed_error(), F("0.08") / 100)
    assert found.verdict == REFUTED and found.value is not None and found.value[0] > F("0.08") / 100


def test_the_error_of_the_two_counters_is_known_to_four_digits() -> None:
    assert narrow(bracket(speed_error()), F("0.0010415"))


def test_a_slower_clock_is_found() -> None:
    slower = check(speed_error(slipped=True), F("0.00105"))
    assert slower.verdict == REFUTED and check(speed_error(), F("0.00105")).verdict == PROVED


PRESETS = {v: F(m, 2) for v, m in {250: 1035, 210: 875, 160: 677, 110: 477, 70: 317, 30: 157, 5: 57}.items()}
COUNTING, STANDARD = F("0.311739"), 2000  # s; counts of the standard oscillator (Konishi, two-counter method)


def excess_at_brake(preset: F, pulses: int = 5) -> Bound:
    """Excess (km/h) at the command to brake: a count just missed, then a whole sample, the speed rising steadily."""
    rise, time = reals("rise time")  # km/h/s, s
    slope, threshold = 2 / COUNTING, preset / COUNTING  # Hz per km/h, Hz
    begun = threshold - rise * (slope * COUNTING / 2)
    return Bound(
        "two_counter.accuracy",
        "Excess over the check speed when the brake is commanded",
        rise * (time - COUNTING / 2) + threshold / (STANDARD - 1) / slope,
        (
            between(0, rise, 1),
            between(0, time, 2),
            begun * time + rise * time * time * slope / 2 == 2 * preset + pulses,
        ),
        unit="km/h",
        source="[P] 0.25 % of 250 km/h; [D] pulses of the read-out; [A] 2000 counts",
    )


@pytest.mark.parametrize("preset", PRESETS.values(), ids=str)
def test_the_two_counters_command_the_brake_within_the_allowed_excess(preset: F) -> None:
    found = check(excess_at_brake(preset), F("0.625"))
    assert (found.verdict, found.agreed_by) == (PROVED, [NLSAT, BOXES])


def test_the_excess_at_the_highest_check_speed_is_as_computed() -> None:
    assert narrow(bracket(excess_at_brake(PRESETS[250])), F("0.59969"))
    assert check(excess_at_brake(PRESETS[250], pulses=100), F("0.625")).verdict == REFUTED


# --- rounding --------------------------------------------------------------------------------------------------------

STEP = F(1, 2**14)


def word_error(low: int = 3, whole: bool = False) -> Bound:
    v, n = reals("v n")
    return bound(v - n * STEP, between(low, v, 90), rounded_down(n * STEP, v, STEP), per=v, whole=(n,) if whole else ())


def test_a_word_of_fourteen_bits_after_the_point_keeps_the_speed() -> None:
    assert narrow(bracket(word_error()), STEP / 3 - F(1, 10**11))
    assert check(word_error(), STEP / 3, strict=True).verdict == PROVED
    assert check(word_error(low=2), STEP / 3).verdict == REFUTED


def test_whole_values_reach_as_far_as_any_phase_does() -> None:
    v, n = reals("v n")
    error = bound(v - n, between(0, v, 4), rounded_down(n, v), whole=(n,))
    assert check(error, 1, strict=True).verdict == PROVED
    refuted = check(error, F(9, 10))
    assert refuted.verdict == REFUTED and refuted.witness is not None
    assert refuted.witness[n][0].denominator == 1 and refuted.witness[n][0] == refuted.witness[n][1]


def test_whole_values_prove_what_reals_do_not() -> None:
    (n,) = reals("n")
    odd = bound(0 - (2 * n - 5) * (2 * n - 5), between(0, n, 5))
    assert check(odd, -1).verdict == REFUTED
    found = check(bound(odd.quantity, *odd.given, whole=(n,)), -1)
    assert found.verdict == PROVED and BOXES in found.agreed_by
