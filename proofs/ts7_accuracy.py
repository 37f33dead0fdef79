"""TS-7: how far the speed at which a limit acts can lie from the limit, as bounds over reals.

The true speed at which the corrected pulses f_v equal the reference of a word: the generator gives 60 pulses a turn of
the wheel, whose switch stands at one of its nine steps, the oscillator is off by 100 ppm at most, and pi lies between
two fractions.  Speeds km/h.
Source: accuracy +-2.0 km/h, 780..860 mm in steps of 10 [P]; 60 pulses, divider 16, 100 ppm [A].

Main result: the worst is +0.593 km/h, at the 90 signal on a wheel of 785 mm set to 780; the envelope that adds the
worst of each cause (0.818) is never reached.  A switch two steps off is enough to leave the published accuracy.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from models.ts7.numbers import ACCURACY, BITS, DIVIDER, FRAME_HZ, PI, PULSES_A_REVOLUTION, WORD
from safety import PROVED, REFUTED
from safety.prove.bounds import Bound, between, claim_bound, claim_bracket, magnitude, reals

STEP_MM = 10
HALF_STEP_MM = Fraction(STEP_MM, 2)
DRIFT = Fraction(100, 1_000_000)
LEAST = {25: "0.187", 45: "0.524", 65: "0.455", 75: "0.561", 90: "0.593"}  # km/h, in steps of 0.001 [D]


def error_of_limit(signal: int, off_mm: Fraction | int = HALF_STEP_MM, drift: Fraction = DRIFT) -> Bound:
    """Error of the limit of one signal, the wheel being up to `off_mm` from what its switch is set to."""
    v, pi, step, true_mm, rate = reals("v pi step true_mm rate")
    overflow = Fraction(1, 2**BITS)
    pulses = v * (step * (STEP_MM * PULSES_A_REVOLUTION * overflow / 5))  # km/h by turns an hour over pi, wheel word
    reference = rate * (FRAME_HZ * WORD[signal] * overflow / DIVIDER)
    return Bound(
        f"ts7_accuracy.error_of_limit_{signal}",
        f"Error of the {signal} km/h limit, wheel within {off_mm} mm of its setting",
        magnitude(v - signal),
        (
            between(PI.low, pi, PI.high),
            between(78, step, 86),
            between(-off_mm, true_mm - STEP_MM * step, off_mm),
            between(1 - drift, rate, 1 + drift),
            between(0, v, 200),
            pulses == reference * pi * true_mm * Fraction(36, 10_000),
        ),
        whole=(step,),
        unit="km/h",
        requirement="TS7-3",
        source="[P] accuracy; TS-7 E5, E6",
        assumed=("[A] 60 pulses a turn of the wheel, divided by 16", "[A] oscillator off by 100 ppm at most"),
    )


for _signal, _least in LEAST.items():
    _error = error_of_limit(_signal)
    _within = claim_bound(_error, Fraction(_least), expect=PROVED)
    _less = Fraction(_least) - Fraction(1, 1000)
    claim_bound(_error, _less, id=f"{_error.id}_is_less", expect=REFUTED, twin_of=_within)

claim_bracket(error_of_limit(90), id="ts7_accuracy.worst_error")

one_step_off = claim_bound(
    error_of_limit(90, STEP_MM), ACCURACY, id="ts7_accuracy.switch_one_step_off_at_90", expect=PROVED
)
claim_bound(
    replace(error_of_limit(90, 2 * STEP_MM), requirement="TS7-16"),
    ACCURACY,
    id="ts7_accuracy.switch_two_steps_off_at_90",
    expect=REFUTED,
    twin_of=one_step_off,
    defeat=True,
)
