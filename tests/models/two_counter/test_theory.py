"""The error theory of the two-counter ATC gives the specification's numbers, and the printed ones if they are right."""

from __future__ import annotations

from fractions import Fraction

import pytest

from models.two_counter import inference
from models.two_counter.numbers import (
    ALLOWED_SHARE,
    CHECK_SPEEDS,
    COUNTING_S,
    COUNTING_S_OF_TABLE_2B,
    DYNAMIC,
    HZ_PER_KMH,
    N1F,
    N1F_RANGE,
    PRESETS,
    STATIC,
    pulses,
    rounds_to,
    scale_speed,
    threshold_hz,
)
from models.two_counter.theory import (
    K,
    acceleration_for,
    asymptote,
    best_count,
    brakes,
    brakes_as_printed,
    coefficient,
    counting_time,
    counts,
    crossing,
    decisive_count,
    dynamic_error,
    dynamic_error_as_printed,
    dynamic_error_tabled,
    error_at_best,
    least_oscillator_hz,
    least_oscillator_hz_of,
    least_pulses,
    least_sure_speed,
    measured_error,
    most_oscillator_hz,
    next_sampling_time,
    next_sampling_time_as_printed,
    oscillator_hz,
    positive_root,
    response_time,
    root,
    sampling_time,
    sampling_time_as_printed,
    static_error,
    static_error_exact,
    time_to_read_out,
    total_error,
    total_error_of,
    worst_excess,
)

OSCILLATOR_HZ = N1F / COUNTING_S
QUARTER = ALLOWED_SHARE
ERROR = QUARTER * 250  # 0.625 km/h


def near(value: Fraction, text: str) -> bool:
    """Whether a value is a decimal of the specification, to its digits."""
    return rounds_to(value, text)


def by_equation_14(speed: int) -> Fraction:
    """P10: V'E = f2E / k, static error 0, T''c = Tc, T's = Tc + 4 / f2E."""
    sampling = sampling_time(N1F, OSCILLATOR_HZ, threshold_hz(speed))
    return dynamic_error(1, COUNTING_S, sampling, scale_speed(speed)).middle


# --- what the tables tell: P1 to P5, P7, P8, P11 ---------------------------------------------------------------------


def test_p1_one_counting_time_fits_all_seven_rows() -> None:
    low, high = inference.counting_time_range()
    assert low < COUNTING_S < high
    assert (near(low, "0.3117388"), near(high, "0.3117396")) == (True, True)
    with pytest.raises(ValueError, match="no counting time fits"):
        inference.counting_time_range((1034, *PRESETS[1:]))


def test_p2_the_presets_are_the_only_ones_of_eleven_bits() -> None:
    assert inference.possible_presets() == [PRESETS] == [(1035, 875, 677, 477, 317, 157, 57)]
    doubled = tuple(2 * m for m in PRESETS)
    assert inference.possible_presets(2 * 1035) == [PRESETS, doubled]
    assert all(rounds_to(threshold_hz(row.speed), row.theory) for row in STATIC)


def test_p3_scale() -> None:
    assert near(HZ_PER_KMH, "6.41562")
    assert near(1 / COUNTING_S, "3.20781")


def test_p4_slopes_of_one_affine_law_of_the_presets() -> None:
    low, high = inference.slopes()
    assert near(low, "1.99355") and high == 2
    inside = (low + high) / 2
    for slope, fits in ((low, False), (inside, True), (Fraction("1.99913125"), True), (high, False)):
        ends = [(n - Fraction(1, 2) - slope * v) for v, n in ((v, pulses(v)) for v in CHECK_SPEEDS)]
        assert (max(ends) < min(ends) + 1) is fits  # there is a c with n2E = floor(s V + c) + 1/2 in every row
    ends = [pulses(v) - Fraction(1, 2) - Fraction("1.99913125") * v for v in CHECK_SPEEDS]
    assert (near(max(ends), "18.1390"), near(min(ends) + 1, "18.1824")) == (True, True)


def test_p5_one_crystal_error_explains_the_static_errors() -> None:
    times = inference.measured_counting_times()
    assert near(sum(times, Fraction(0)) / 7, "0.311771")
    assert (near(min(times), "0.311765"), near(max(times), "0.311778")) == (True, True)
    assert near(inference.crystal_error() * 10**6, "-102")
    for row in STATIC:
        error = Fraction(int(row.oscillator), 80) - Fraction(row.theory)
        assert abs(error - threshold_hz(row.speed) * inference.crystal_error()) < Fraction(2, 100)


def test_p7_least_squares_give_four_pulses() -> None:
    a, b = inference.preparation_pulses()
    assert abs(b - 4) < Fraction(1, 1000)
    assert abs(a - Fraction("0.467334")) < Fraction(1, 10**6)
    assert abs(a - K * COUNTING_S_OF_TABLE_2B) < Fraction(1, 10**5)
    with pytest.raises(ValueError, match="no line"):
        inference.least_squares([(Fraction(1), Fraction(1))])


def test_p8_the_5_km_h_measurement_is_misprinted() -> None:
    assert {speed: near(x, "0.15578") for speed, x in inference.subtracted()} == {
        **dict.fromkeys(CHECK_SPEEDS, True),
        5: False,
    }
    corrected = measured_error(1, Fraction(DYNAMIC[-1].time), 2 * Fraction("0.15578"))
    assert corrected == Fraction("0.51422")
    static = Fraction("0.15") / Fraction("1660.04") * 100
    assert near(corrected / 250 * 100 + static, "0.2147")
    assert near(static, "0.00904")


def test_p11_brake_test_leaves_a_range_of_n1f() -> None:
    assert inference.decisive_count_range() == (1884, 2355)
    assert N1F_RANGE == (1885, 2355) and N1F_RANGE[0] <= N1F <= N1F_RANGE[1]


# --- table 2(B) and the exact model: P6, P9, P10, P12, P14 to P16 ----------------------------------------------------


def test_p6_theory_column() -> None:
    found = [dynamic_error_tabled(1, COUNTING_S_OF_TABLE_2B, threshold_hz(v)) for v in CHECK_SPEEDS]
    wanted = ("0.46975", "0.47019", "0.47102", "0.47257", "0.47521", "0.48322", "0.51109")
    assert all(abs(x - Fraction(text)) < Fraction(6, 10**6) for x, text in zip(found, wanted, strict=True))
    off = [
        row.speed for row, x in zip(DYNAMIC, found, strict=True) if abs(x - Fraction(row.theory)) > Fraction(3, 10**5)
    ]
    assert off == [30]  # the misprint of that column


def test_p9_exact_time_to_the_read_out() -> None:
    times = {v: time_to_read_out(pulses(v), COUNTING_S, HZ_PER_KMH, 1).middle for v in CHECK_SPEEDS}
    assert abs(times[250] - Fraction("0.62611")) < Fraction(1, 10**5)
    assert abs(times[5] - Fraction("0.66976")) < Fraction(1, 10**5)
    assert max(abs(times[row.speed] - Fraction(row.time)) for row in DYNAMIC) < Fraction(25, 100_000)


def test_p10_equation_14_lies_below_the_theory_column() -> None:
    wanted = ("0.46964", "0.47001", "0.47071", "0.47200", "0.47421", "0.48086", "0.50332")
    assert all(near(by_equation_14(v), text) for v, text in zip(CHECK_SPEEDS, wanted, strict=True))


def test_p12_total_error_by_equation_16() -> None:
    preparation = 4 / threshold_hz(250)
    found = {
        n: total_error(250, n, 1, COUNTING_S_OF_TABLE_2B, COUNTING_S_OF_TABLE_2B + preparation) for n in (N1F, 2048)
    }
    assert near(found[N1F], "0.59475")
    assert (near(found[N1F] / 250 * 100, "0.2379"), near(found[2048] / 250 * 100, "0.2367")) == (True, True)
    assert max(found.values()) < ERROR
    dynamic = found[N1F] - Fraction(250, N1F)
    least, most = (dynamic + Fraction(250, n) for n in (2355, 1884))
    assert (near(least / 250 * 100, "0.2304"), near(most / 250 * 100, "0.2410")) == (True, True)
    assert [250 / (ERROR - dynamic) > n for n in (1610, 1611)] == [True, False]  # n1F that 0.625 km/h needs


def test_p14_sampling_times() -> None:
    times = [sampling_time(N1F, OSCILLATOR_HZ, threshold_hz(v)) for v in CHECK_SPEEDS]
    wanted = ("0.31415", "0.31459", "0.31542", "0.31697", "0.31961", "0.32762", "0.35549")
    assert all(near(x, text) for x, text in zip(times, wanted, strict=True))
    assert sampling_time_as_printed(N1F, OSCILLATOR_HZ) == counting_time(N1F, OSCILLATOR_HZ) == COUNTING_S < min(times)


def test_p15_response() -> None:
    assert near(response_time(pulses(250), COUNTING_S), "0.62649")
    assert near(response_time(pulses(5), COUNTING_S), "0.67817")


def test_p16_excess_that_every_phase_brakes() -> None:
    assert near(static_error_exact(scale_speed(250), N1F), "0.12944")
    assert near(static_error_exact(scale_speed(5), N1F), "0.00713")
    assert static_error(250, N1F) == Fraction(1, 8) < static_error_exact(250, N1F)


# --- figure 4: P13, P21 ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("share", "count", "hz", "crossings"),
    [
        ("0.0025", "800", "3840", ("2000", "769.23", "608.70", "526.32")),
        ("0.003", "666.67", "2666.67", ("1000", "555.56", "466.67", "416.67")),
        ("0.005", "400", "960", ("333.33", "263.16", "241.38", "227.27")),
        ("0.01", "200", "240", ("125", "113.64", "109.375", "106.38")),
    ],
)
def test_p13_figure_4(share: str, count: str, hz: str, crossings: tuple[str, ...]) -> None:
    r = Fraction(share)
    assert near(best_count(r), count) and near(least_oscillator_hz(r, 250), hz)
    assert all(near(crossing(r, c, 250), text) for c, text in zip((3, 5, 7, 10), crossings, strict=True))
    best = best_count(r)
    assert oscillator_hz(best, r * 250, 250) == least_oscillator_hz(r, 250) == least_oscillator_hz_of(best, 250)
    assert error_at_best(best, 250) == r * 250 == total_error_of(best, least_oscillator_hz(r, 250), 250)
    for beside in (best * Fraction(9, 10), best * Fraction(11, 10)):
        assert oscillator_hz(beside, r * 250, 250) > least_oscillator_hz(r, 250)
    for c in (3, 5, 7, 10):
        n = crossing(r, c, 250)
        assert oscillator_hz(n, r * 250, 250) == c * n
    assert asymptote(r) == best / 2
    with pytest.raises(ZeroDivisionError):
        oscillator_hz(asymptote(r), r * 250, 250)


def test_without_preparation_at_the_prototypes_counting_time() -> None:
    assert near(crossing(QUARTER, 1 / COUNTING_S, 250), "1588.4")


def test_p21_the_optimum_depends_on_the_acceleration() -> None:
    assert total_error_of(800, 3840, 250, 1) == ERROR
    assert total_error_of(800, 3840, 250, 2) == Fraction("0.9375")


# --- printed forms and corrected ones --------------------------------------------------------------------------------


@pytest.mark.parametrize("speed", CHECK_SPEEDS)
@pytest.mark.parametrize("acceleration", [Fraction(1, 10), Fraction(1), Fraction(3)])
def test_printed_forms_of_12_and_14_are_right(speed: int, acceleration: Fraction) -> None:
    sampling, v = sampling_time(N1F, OSCILLATOR_HZ, threshold_hz(speed)), scale_speed(speed)
    vf = v + acceleration * COUNTING_S / 2
    ours, printed = (f(acceleration, sampling, v, vf) for f in (next_sampling_time, next_sampling_time_as_printed))
    assert ours.low <= printed.high and printed.low <= ours.high
    t = ours.middle
    assert abs((vf + acceleration * t / 2) * t - sampling * v) < Fraction(1, 10**20)  # (9)
    one, other = (f(acceleration, COUNTING_S, sampling, v) for f in (dynamic_error, dynamic_error_as_printed))
    assert one.low <= other.high and other.low <= one.high


def test_without_acceleration_there_is_no_dynamic_error() -> None:
    sampling = sampling_time(N1F, OSCILLATOR_HZ, threshold_hz(250))
    assert dynamic_error(0, COUNTING_S, sampling, scale_speed(250)) == (0, 0)
    assert next_sampling_time(0, sampling, 250, 250) == (sampling, sampling)


def test_18_holds_with_the_preparation_kept_in_k() -> None:
    """T''s = T''c + 4 / f2E makes (16) the same as (18) with K', and not with K."""
    n2e, f1 = pulses(250), OSCILLATOR_HZ
    exact = total_error(250, N1F, 1, COUNTING_S, COUNTING_S + 4 / threshold_hz(250))
    assert total_error_of(N1F, f1, 250, 1, coefficient(n2e)) == exact != total_error_of(N1F, f1, 250)
    assert near(coefficient(n2e), "1.50773") and near(coefficient(pulses(5)), "1.64035")


def test_24_limits_n2e_from_below() -> None:
    least = least_pulses(250, 1)  # a setting error of 1 km/h at most
    most = most_oscillator_hz(N1F, threshold_hz(250), least)
    for f1, keeps in ((most, True), (most * Fraction(101, 100), False)):
        assert (threshold_hz(250) * counting_time(N1F, f1) >= least) is keeps


def test_counting() -> None:
    assert decisive_count(OSCILLATOR_HZ, pulses(250), threshold_hz(250)) == N1F
    assert counts(120, pulses(30), 5) == 1884
    assert [n for n in range(1998, 2003) if brakes(n, N1F) != brakes_as_printed(n, N1F)] == [N1F]
    assert all(brakes_as_printed(n, N1F) == brakes(n, N1F + 1) for n in range(1990, 2010))
    assert least_sure_speed(250, static_error(250, N1F)) == Fraction("250.125")


# --- the supremum ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("speed", CHECK_SPEEDS)
def test_supremum_is_what_the_specification_allows(speed: int) -> None:
    """Property 5: no more than the exact dynamic error and the quantisation, and less than 0.25 %."""
    worst = worst_excess(pulses(speed), N1F, COUNTING_S, HZ_PER_KMH, 1).high
    dynamic = time_to_read_out(pulses(speed), COUNTING_S, HZ_PER_KMH, 1).high - COUNTING_S / 2
    assert worst <= dynamic + static_error_exact(scale_speed(speed), N1F) < Fraction("0.5997") < ERROR


def test_acceleration_for_is_the_inverse_of_the_supremum() -> None:
    rise = acceleration_for(ERROR, pulses(250), N1F, COUNTING_S, HZ_PER_KMH)
    low, high = (worst_excess(pulses(250), N1F, COUNTING_S, HZ_PER_KMH, x).middle for x in rise)
    assert low - Fraction(1, 10**20) < ERROR < high + Fraction(1, 10**20)
    assert near(rise.middle, "1.054418")
    with pytest.raises(ValueError, match="no more than the static error"):
        acceleration_for(Fraction("0.1294"), pulses(250), N1F, COUNTING_S, HZ_PER_KMH)


@pytest.mark.parametrize("numbers", [(-1, 1, 1), (1, -1, 1), (1, 1, 0), (0, 0, 1)])
def test_positive_root_refuses_what_has_none_or_two(numbers: tuple[int, int, int]) -> None:
    with pytest.raises(ValueError, match="is above 0"):
        positive_root(*numbers)


@pytest.mark.parametrize("x", [Fraction(0), Fraction(1, 3), Fraction(2), Fraction(10**9, 7)])
def test_roots_are_enclosed(x: Fraction) -> None:
    low, high = root(x)
    assert low * low <= x <= high * high and high - low <= Fraction(1, 10**30)
