"""Two-counter ATC: the error theory, equations (3) to (25) as exact functions.

Where a printed form is wrong it stands beside the corrected one, as `..._as_printed`.  Speeds km/h, frequencies Hz,
times s, accelerations km/h/s, k in Hz per km/h; fractions are exact, a square root is an enclosure.
Source: equation numbers of the paper [P]; corrected forms and the exact forms [D].

Main results: (6) and (7) are misprinted, (18) holds with K' = 3/2 + 4/n2E once the preparation is kept, the text at
(24) has its limit the wrong way round; at the optimum the total error does depend on the acceleration.
"""

from __future__ import annotations

from fractions import Fraction

from models.enclosure import Exact, Interval, root
from models.two_counter.numbers import PREPARATION_PULSES, READ_OUT_PULSES

HALF = Fraction(1, 2)
K = Fraction(3, 2)  # T''c / 2Ts + T''s / Ts without preparation


def positive_root(a: Exact, b: Exact, c: Exact) -> Interval:
    """The root from 0 up of a x^2 + b x = c, for a and b from 0 up and c above 0, not both a and b being 0.

    Raises ValueError for other numbers, for which there may be none or two.
    """
    if a < 0 or b < 0 or c <= 0 or a == b == 0:
        raise ValueError(f"{a} x^2 + {b} x = {c}; a and b are from 0 up, c is above 0, and a or b is, too")
    if a == 0:
        return Interval(Fraction(c) / b, Fraction(c) / b)
    return root(Fraction(b) ** 2 + 4 * a * c).scaled(1 / (2 * Fraction(a)), -Fraction(b) / (2 * a))


# --- counting: (3), (4), (17) ----------------------------------------------------------------------------------------


def counts(f1: Exact, n2e: Exact, f2: Exact) -> Fraction:
    """(3): oscillator pulses n1 while n2E speed pulses come."""
    return Fraction(f1) * n2e / f2


def brakes_as_printed(n1: int, n1f: int) -> bool:
    """(4): brake up to and including n1F; the circuit releases there."""
    return n1 <= n1f


def brakes(n1: int, n1f: int) -> bool:
    """The circuit: counter 1 has to reach n1F for a release."""
    return n1 < n1f


def decisive_count(f1: Exact, n2e: Exact, f2e: Exact) -> Fraction:
    """(17): n1F."""
    return counts(f1, n2e, f2e)


# --- static error: (5) -----------------------------------------------------------------------------------------------


def static_error(speed: Exact, n1f: int) -> Fraction:
    """(5): one count of n1F, to the first order."""
    return Fraction(speed) / n1f


def static_error_exact(speed: Exact, n1f: int) -> Fraction:
    """Excess from which every oscillator phase brakes: then n1 is at most n1F - 1."""
    return Fraction(speed) / (n1f - 1)


# --- times: (6), (7) -------------------------------------------------------------------------------------------------


def counting_time(n1f: Exact, f1: Exact) -> Fraction:
    """(7) corrected: Tc."""
    return Fraction(n1f) / f1


def sampling_time_as_printed(n1f: Exact, f1: Exact) -> Fraction:
    """(7): Ts = n1F / f1, which leaves out the preparation."""
    return Fraction(n1f) / f1


def sampling_time(n1f: Exact, f1: Exact, f2e: Exact) -> Fraction:
    """(6) and (7) corrected: Ts = Tp + Tc, Tp being four speed pulses."""
    return counting_time(n1f, f1) + Fraction(PREPARATION_PULSES) / f2e


# --- dynamic error: (8) to (14), (25) --------------------------------------------------------------------------------


def least_sure_speed(speed: Exact, static: Exact) -> Fraction:
    """(8): V'E, the speed from which a sample is sure to brake."""
    return Fraction(speed) + static


def gain(acceleration: Exact, time: Exact) -> Fraction:
    """(11): speed gained in a time; (10) is that of half a counting time."""
    return Fraction(acceleration) * time


def next_sampling_time(acceleration: Exact, sampling: Exact, v: Exact, vf: Exact) -> Interval:
    """(12): T''s at an acceleration from 0 up; `sampling` is T's, v is V'E, vf is VF."""
    return positive_root(Fraction(acceleration) / 2, vf, Fraction(sampling) * v)


def next_sampling_time_as_printed(acceleration: Exact, sampling: Exact, v: Exact, vf: Exact) -> Interval:
    """(12) as printed, for an acceleration above 0."""
    factor = Fraction(vf) / acceleration
    return root(1 + 2 * Fraction(acceleration) * sampling * v / Fraction(vf) ** 2).scaled(factor, -factor)


def dynamic_error(acceleration: Exact, counting: Exact, sampling: Exact, v: Exact) -> Interval:
    """(14): half a counting time T''c and then a sampling time in which the train goes on accelerating."""
    first = gain(acceleration, counting) / 2
    return next_sampling_time(acceleration, sampling, v, v + first).scaled(acceleration, first)


def dynamic_error_as_printed(acceleration: Exact, counting: Exact, sampling: Exact, v: Exact) -> Interval:
    """(14) as printed: alpha times VF / alpha cancels."""
    first = gain(acceleration, counting) / 2
    vf = v + first
    return root(1 + 2 * Fraction(acceleration) * sampling * v / vf**2).scaled(vf, first - vf)


def dynamic_error_tabled(acceleration: Exact, counting: Exact, f2e: Exact) -> Fraction:
    """The theory column of table 2(B): (13) with T''s = T''c + Tp, to the first order."""
    return Fraction(acceleration) * (K * counting + Fraction(PREPARATION_PULSES) / f2e)


def measured_error(acceleration: Exact, time: Exact, counting: Exact) -> Fraction:
    """(25) at a constant acceleration: time is t4 - t1, counting T''c."""
    return Fraction(acceleration) * (Fraction(time) - Fraction(counting) / 2)


# --- total error: (15), (16) -----------------------------------------------------------------------------------------


def total_error(speed: Exact, n1f: Exact, acceleration: Exact, counting: Exact, sampling: Exact) -> Fraction:
    """(16) with T''c = counting and T''s = sampling; Ts cancels."""
    return Fraction(speed) / n1f + Fraction(acceleration) * (Fraction(counting) / 2 + sampling)


# --- choice of n1F and f1: (18) to (24), figure 4 --------------------------------------------------------------------


def coefficient(n2e: Exact) -> Fraction:
    """K': K with the preparation kept, to the first order in the acceleration."""
    return K + Fraction(PREPARATION_PULSES) / n2e


def oscillator_hz(n1f: Exact, error: Exact, speed: Exact, acceleration: Exact = 1, k: Exact = K) -> Fraction:
    """(18): f1 that keeps the total error; ZeroDivisionError on the asymptote."""
    return k * Fraction(acceleration) * n1f**2 / speed / (Fraction(error) * n1f / speed - 1)


def total_error_of(n1f: Exact, f1: Exact, speed: Exact, acceleration: Exact = 1, k: Exact = K) -> Fraction:
    """(18) solved for the total error."""
    return Fraction(speed) / n1f + k * Fraction(acceleration) * n1f / f1


def best_count(share: Exact) -> Fraction:
    """(19): n* at which f1 is least for an error of this share of the speed."""
    return 2 / Fraction(share)


def least_oscillator_hz(share: Exact, speed: Exact, acceleration: Exact = 1, k: Exact = K) -> Fraction:
    """(20): fM, the least f1."""
    return 4 * k * Fraction(acceleration) / (speed * Fraction(share) ** 2)


def asymptote(share: Exact) -> Fraction:
    """(21): n1F at or below which no f1 serves."""
    return 1 / Fraction(share)


def least_oscillator_hz_of(n1f: Exact, speed: Exact, acceleration: Exact = 1, k: Exact = K) -> Fraction:
    """(22): fM at n* = n1F."""
    return k * Fraction(acceleration) * n1f**2 / speed


def error_at_best(n1f: Exact, speed: Exact) -> Fraction:
    """(23): the total error at n* = n1F; static and dynamic part are equal there."""
    return 2 * Fraction(speed) / n1f


def most_oscillator_hz(n1f: Exact, f2e: Exact, least_n2e: Exact) -> Fraction:
    """(24): f1 up to which n2E stays at or above its LOWER limit; the text calls it an upper one."""
    return Fraction(f2e) / least_n2e * n1f


def least_pulses(speed: Exact, setting_error: Exact) -> Fraction:
    """The lower limit of n2E that the setting accuracy V_E / n2E asks for."""
    return Fraction(speed) / setting_error


def crossing(share: Exact, ratio: Exact, speed: Exact, acceleration: Exact = 1, k: Exact = K) -> Fraction:
    """n1F at which (18) crosses f1 = ratio * n1F (the ratio is f2E / n2E, one over the counting time)."""
    return 1 / (Fraction(share) - k * Fraction(acceleration) / (Fraction(ratio) * speed))


# --- without approximation -------------------------------------------------------------------------------------------


def pulses_to_read_out(n2e: Exact) -> Fraction:
    """From the start of one count to the read-out of the next."""
    return 2 * Fraction(n2e) + PREPARATION_PULSES + READ_OUT_PULSES


def time_to_read_out(n2e: Exact, counting: Exact, k: Exact, acceleration: Exact) -> Interval:
    """t4 - t1 of the dynamic test: a constant rise, the first count just missed (its mean speed signal is f2E)."""
    rise = Fraction(k) * acceleration
    start = Fraction(n2e) / counting - rise * counting / 2
    return positive_root(rise / 2, start, pulses_to_read_out(n2e))


def response_time(n2e: Exact, counting: Exact) -> Fraction:
    """Most time to the brake of a speed that stays at or above what every phase brakes (property 4)."""
    return pulses_to_read_out(n2e) * counting / n2e


def shortest_safe_window(n1f: int, counting: Exact, ppm: Exact = 0) -> Fraction:
    """What the gate time of a sample read as safe exceeds: (n1F - 1) / f1, with f1 = n1F / Tc but for its error."""
    return Fraction(counting) * (n1f - 1) / n1f / (1 + Fraction(ppm) / 1_000_000)


def worst_excess(n2e: Exact, n1f: int, counting: Exact, k: Exact, acceleration: Exact, ppm: Exact = 0) -> Interval:
    """Supremum of the excess over f2E / k at the read-out that brakes, over phases and rises up to an acceleration.

    The window that still read safe lasted w, no more than it had to; the rise is the steepest all the way.  The
    oscillator is `ppm` off.
    """
    w, n, s = shortest_safe_window(n1f, counting, ppm), Fraction(n2e), Fraction(k) * acceleration
    rest = positive_root(s / 2, n / w + s * w / 2, n + PREPARATION_PULSES + READ_OUT_PULSES)
    return rest.scaled(s / k, ((n / w - n / counting) + s * w / 2) / k)


def acceleration_for(excess: Exact, n2e: Exact, n1f: int, counting: Exact, k: Exact) -> Interval:
    """The acceleration at which that supremum is `excess`; ValueError where the static error alone is as much."""
    w, n = shortest_safe_window(n1f, counting), Fraction(n2e)
    rest, f4 = n + PREPARATION_PULSES + READ_OUT_PULSES, n / counting + Fraction(k) * excess
    gained = f4 - n / w
    if gained <= 0:
        raise ValueError(f"{excess} km/h is no more than the static error {float((n / w - n / counting) / k):.6g}")
    a, b = f4 - gained / 2, rest - f4 * w / 2  # a t^2 - b t = rest w / 2
    time = root(b**2 + 2 * a * rest * w).scaled(1 / (2 * a), b / (2 * a))
    return Interval(*(gained / (t + w / 2) / k for t in reversed(time)))


def oscillator_error_for(
    excess: Exact, n2e: Exact, n1f: int, counting: Exact, k: Exact, acceleration: Exact
) -> Interval:
    """The oscillator error, ppm, at which that supremum is `excess`, at an acceleration above 0."""
    n, s = Fraction(n2e), Fraction(k) * acceleration
    f4, rest = n / counting + Fraction(k) * excess, n + PREPARATION_PULSES + READ_OUT_PULSES
    end, start = root(f4**2 - 2 * s * rest), root(f4**2 - 2 * s * (rest + n))  # of the window: its speed signals
    nominal = shortest_safe_window(n1f, counting) * s
    return Interval(*((nominal / w - 1) * 1_000_000 for w in (end.high - start.low, end.low - start.high)))
