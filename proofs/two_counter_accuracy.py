"""Two-counter ATC: total error at the read-out that brakes, for all phases and all accelerations, as bounds over reals.

The circuit gives two facts, proved of the equipment in `two_counter_decision` (released just after n1F pulses or more)
and `two_counter_intervals` (edges of a count, and from one to the next read-out).  Let sample i be the first to command
the brake after a release, t3 the end of its predecessor's gate time, t4 its own read-out (signal 1), f the frequency of
the speed signal, which rises by at most s = alpha k (it may fall, too).

1. The predecessor released, so counter 1 reached n1F while its gate was open.  A window of length W lets in
   floor(phase + f1 W) oscillator pulses, phase < 1, so f1 W > n1F - 1: it lasted longer than w = (n1F - 1) / f1.
   Over it counter 2 counted n2E pulses, hence at most n2E over its last w.
2. From t3 to t4 come 4 pulses of preparation, n2E of the next count and 1 to signal 1: n2E + 5.

As f rises by at most s, f(t) >= f4 - s (t4 - t) at every t up to t4, whatever the profile; below zero that says nothing
wrong.  With tau = t4 - t3, the pulses under this line are no more than those that come:

    over the last w of the window   n2E     >= f4 w   - s (w tau + w^2 / 2)
    from its end to the read-out    n2E + 5 >= f4 tau - s tau^2 / 2

The second one says little for a long tau, but tau < 2 Tc: else the line alone would have 2 f4 Tc - 2 s Tc^2 pulses in
the last 2 Tc, which for any excess is more than n2E + 5 (first claim).  With that the first gives f4 < 2 f2E (second
claim).

Nothing else is used, and a steady rise at s with a window only just longer than w turns both into equalities: the bound
is a supremum.  It is not attained (W > w), but the equipment comes as near as one likes.

Time is in counting times Tc here, which makes f = 2 V (V = f / k in km/h) and f1 = n1F: `y` is V at t4, `tau` and `w`
are in Tc, `a` is the speed gained in a Tc.
f1 = n1F / Tc means an exact oscillator; one that is e off makes w shorter by the factor 1 + e.
Source: 250 km/h, 0.25 %, 1 km/h/s [P]; presets, Tc, 4 pulses, read-out after 1 [D]; n1F = 2000, exact oscillator, wheel
[A].

Main results: at 250 km/h the excess stays below 0.5995 km/h, at the other checks below 0.580; with any n1F that the
brake test leaves below 0.6074.  0.25 % is first exceeded at 1.0544 km/h/s, and at 1 km/h/s with an oscillator that
is 99 ppm fast.
"""

from __future__ import annotations

from fractions import Fraction

from models.two_counter.inference import crystal_error
from models.two_counter.numbers import (
    ACCELERATION,
    ALLOWED_SHARE,
    CHECK_SPEEDS,
    COUNTING_S,
    N1F,
    N1F_RANGE,
    PREPARATION_PULSES,
    READ_OUT_PULSES,
    pulses,
    scale_speed,
)
from safety import PROVED, REFUTED, Bit, real
from safety.prove.bounds import Bound, between, claim_bound, claim_bracket, reals

ALLOWED = ALLOWED_SHARE * max(CHECK_SPEEDS)  # 0.625 km/h
LONGEST = 2  # Tc; tau is shorter
STEEPEST = 2  # km/h/s, of all that is looked at here
LEAST = {250: "0.5995", 210: "0.580", 160: "0.557", 110: "0.533", 70: "0.516", 30: "0.505", 5: "0.521"}  # km/h [D]
SAFE_RISE, TOO_STEEP = Fraction("1.0544"), Fraction("1.0545")  # km/h/s, around 1.054418 [D]
SOURCE = "[P] 0.25 % at 1 km/h/s; two counters, property 5"
ASSUMED = f"[A] n1F = {N1F}"
WHEEL = "[A] wheel as the equipment assumes"

EXACT = ("[A] oscillator exact", WHEEL)
PPM = Fraction(1, 1_000_000)
CRYSTAL = round(crystal_error() / PPM)  # -102, explains the errors of table 2(A) [D]
FASTEST_PPM = 20_000  # of all that is looked at here
SAFE_ERROR, TOO_FAST = 98, 99  # ppm, around 98.9 [D]
SLOW_LEAST = Fraction("0.573")  # km/h, exceeded with the crystal error

y, tau, a, w, n = reals("y tau a w n")


def after_window(speed: int) -> Fraction:
    """Pulses from the end of a window to the read-out of the next."""
    return pulses(speed) + PREPARATION_PULSES + READ_OUT_PULSES


def shortest_window(n1f: int, ppm: int = 0) -> Fraction:
    """w in counting times."""
    return Fraction(n1f - 1, n1f) / (1 + ppm * PPM)


def brake_after_release(
    speed: int, rise: Fraction | int, n1f: tuple[int, int] = (N1F, N1F), ppm: int = 0
) -> tuple[Bit, ...]:
    """What the circuit leaves of the read-out that brakes, above a check speed; n1F anything in a range."""
    return rise_after_release(speed, rise, between(shortest_window(n1f[0], ppm), w, shortest_window(n1f[1], ppm)))


def rise_after_release(speed: int, rise: Fraction | int, windows: Bit) -> tuple[Bit, ...]:
    """The same, w being as said."""
    return (
        between(0, a, rise * COUNTING_S),
        windows,
        between(0, tau, LONGEST),
        between(scale_speed(speed), y, 2 * scale_speed(speed)),
        pulses(speed) >= 2 * y * w - a * (2 * w * tau + w * w),
        after_window(speed) >= 2 * y * tau - a * tau * tau,
    )


def excess(speed: int, rise: Fraction | int = ACCELERATION, ppm: int = 0) -> Bound:
    """Speed above the check at the read-out that brakes, the oscillator being so much off."""
    oscillator = f"oscillator {ppm:+d} ppm off" if ppm else "oscillator exact"
    return Bound(
        f"two_counter_accuracy.excess_at_{speed}",
        f"Excess over the {speed} km/h check at the read-out that brakes, rising by at most {float(rise):g} km/h/s, "
        f"{oscillator}, wheel as assumed",
        y - scale_speed(speed),
        brake_after_release(speed, rise, ppm=ppm),
        unit="km/h",
        requirement="TC-5",
        source=SOURCE,
        assumed=(ASSUMED, f"[A] {oscillator}", WHEEL),
    )


# --- tau is short ----------------------------------------------------------------------------------------------------


FASTEST = pulses(250)  # km/h; no train is as fast
ANY_PRESET = (
    between(0, a, STEEPEST * COUNTING_S),
    between(pulses(5), n, pulses(250)),
    between(scale_speed(5), y, FASTEST),
    2 * y >= n,
)


def pulses_missing(longest: int) -> Bound:
    """The pulses to the next read-out that a time before it does not have."""
    return Bound(
        f"two_counter_accuracy.next_read_out_within_{longest}_tc",
        f"Pulses from a window to the next read-out, less those of the {longest} Tc before it, any preset",
        n + PREPARATION_PULSES + READ_OUT_PULSES - (2 * y * longest - a * longest**2),
        ANY_PRESET,
        unit="pulses",
        requirement="TC-5",
        source=SOURCE,
    )


_near = claim_bound(pulses_missing(LONGEST), 0, strict=True, expect=PROVED)
claim_bound(pulses_missing(1), 0, strict=True, expect=REFUTED, twin_of=_near)

_twice = Bound(
    "two_counter_accuracy.less_than_twice_the_check",
    "Speed at the read-out that brakes, less twice the check, any preset, any n1F, oscillator up to 2 % fast",
    y - n,
    (
        *ANY_PRESET,
        between(shortest_window(N1F_RANGE[0], FASTEST_PPM), w, shortest_window(N1F_RANGE[1], CRYSTAL)),
        between(0, tau, LONGEST),
        n >= 2 * y * w - a * (2 * w * tau + w * w),
    ),
    unit="km/h",
    requirement="TC-5",
    source=SOURCE,
    assumed=(WHEEL,),
)
_under = claim_bound(_twice, 0, strict=True, expect=PROVED)
claim_bound(_twice, -13, id=f"{_twice.id}_by_13_kmh", expect=REFUTED, twin_of=_under)

# --- all check speeds at 1 km/h/s ------------------------------------------------------------------------------------

for _speed, _least in LEAST.items():
    _bound = excess(_speed)
    _within = claim_bound(_bound, Fraction(_least), expect=PROVED)
    _less = Fraction(_least) - Fraction(1, 1000)
    claim_bound(_bound, _less, id=f"{_bound.id}_is_less", expect=REFUTED, twin_of=_within)

claim_bracket(excess(250), id="two_counter_accuracy.worst_excess", width=Fraction(1, 100_000))

# --- any n1F that the brake test leaves ------------------------------------------------------------------------------

claim_bracket(
    Bound(
        "two_counter_accuracy.worst_excess_any_n1f",
        f"Excess over the 250 km/h check at the read-out that brakes, any n1F from {N1F_RANGE[0]} to {N1F_RANGE[1]}, "
        "oscillator exact",
        y - scale_speed(250),
        brake_after_release(250, ACCELERATION, N1F_RANGE),
        unit="km/h",
        requirement="TC-5",
        source=SOURCE,
        assumed=EXACT,
    )
)

# --- where 0.25 % fails ----------------------------------------------------------------------------------------------

_kept = claim_bound(excess(250, SAFE_RISE), ALLOWED, id="two_counter_accuracy.total_error_is_kept", expect=PROVED)
claim_bound(
    excess(250, TOO_STEEP),
    ALLOWED,
    id="two_counter_accuracy.total_error_fails_beyond",
    expect=REFUTED,
    twin_of=_kept,
    defeat=True,
)

claim_bracket(
    Bound(
        "two_counter_accuracy.slowest_rise_that_fails",
        "Seconds for 1 km/h of the slowest rise with which the excess at 250 km/h can pass 0.25 %, oscillator exact",
        Fraction(1) * COUNTING_S + 0 * y,
        (*brake_after_release(250, STEEPEST), y > scale_speed(250) + ALLOWED),
        per=a,
        unit="s per km/h",
        requirement="TC-5",
        source=SOURCE,
        assumed=(ASSUMED, *EXACT),
    ),
    width=Fraction(1, 100_000),
)

# --- an oscillator that is off ---------------------------------------------------------------------------------------

_slow = excess(250, ppm=CRYSTAL)
_kept = claim_bound(_slow, ALLOWED, id="two_counter_accuracy.total_error_is_kept_slow_as_in_table_2a", expect=PROVED)
claim_bound(
    _slow,
    SLOW_LEAST,
    id="two_counter_accuracy.excess_slow_as_in_table_2a_is_less",
    expect=REFUTED,
    twin_of=_kept,
)
_kept = claim_bound(
    excess(250, ppm=SAFE_ERROR),
    ALLOWED,
    id=f"two_counter_accuracy.total_error_is_kept_{SAFE_ERROR}_ppm_fast",
    expect=PROVED,
)
claim_bound(
    excess(250, ppm=TOO_FAST),
    ALLOWED,
    id=f"two_counter_accuracy.total_error_fails_{TOO_FAST}_ppm_fast",
    expect=REFUTED,
    twin_of=_kept,
    defeat=True,
)

claim_bracket(
    Bound(
        "two_counter_accuracy.least_oscillator_error_that_fails",
        "Period of the slowest oscillator with which the excess at 250 km/h can pass 0.25 % at 1 km/h/s, in periods of "
        "the exact one, wheel as assumed",
        w,
        (
            *rise_after_release(
                250, ACCELERATION, between(shortest_window(N1F, FASTEST_PPM), w, shortest_window(N1F, CRYSTAL))
            ),
            y > scale_speed(250) + ALLOWED,
        ),
        per=real(shortest_window(N1F)),
        unit="periods",
        requirement="TC-5",
        source=SOURCE,
        assumed=(ASSUMED, WHEEL),
    ),
    width=PPM,
)
