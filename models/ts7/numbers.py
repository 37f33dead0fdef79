"""TS-7: the published numbers and the formulas behind them, exact.

Independent of the models on purpose: the models never compute with this file, tests and claims compare with it.
Speeds km/h, lengths m unless named mm, rates Hz, times s; fractions are exact, what contains pi is an enclosure.
Source: 512 kHz, 4 words of 8 bits, 8 kHz, 780..860 mm, +-2.0 km/h, 0.3 s, 5 and 6.0 +- 2.0 km/h [P]; factor 2, window
[R]; 60 pulses a revolution, divider 16 [A]; the rest [D].
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

OSCILLATOR_HZ, WORDS, BITS = 512_000, 4, 8
FRAME_HZ = 8_000
DIVIDER = 16
PULSES_A_REVOLUTION = 60
SPEEDS = (25, 45, 65, 75, 90)
DIAMETERS_MM = tuple(range(780, 861, 10))
ACCURACY, RESPONSE_S = Fraction(2), Fraction(3, 10)
LOWERING, LOWERING_WORDS = Fraction(2), 4
CHECK_WORD, ROLLBACK_WORD, ROLLBACK_WORD_OF_TABLE = 85, 11, 13
ROLLBACK_RANGE = (4, 8)
MTBF_H = 30_000


class Bounds(NamedTuple):
    """An enclosure: the value lies between both, which differ by less than 1e-15 of it."""

    low: Fraction
    high: Fraction

    def times(self, factor: Fraction | int) -> Bounds:
        """Multiplied by a factor from 0 up."""
        return Bounds(self.low * factor, self.high * factor)

    def inverse(self) -> Bounds:
        """Of one over the value (above 0)."""
        return Bounds(1 / self.high, 1 / self.low)


PI = Bounds(Fraction("3.14159265358979323846"), Fraction("3.14159265358979323847"))


def frame_s(periods_a_bit: int = 2) -> Fraction:
    """E1: one frame; the printed 8 kHz needs two oscillator periods a bit, one gives 16 kHz."""
    return Fraction(WORDS * BITS * periods_a_bit, OSCILLATOR_HZ)


def overflow_hz(word: int, rate_hz: Fraction | int = FRAME_HZ) -> Fraction:
    """E2: overflows of a word added at a rate."""
    return Fraction(rate_hz) * word / 256


def pattern_hz(word: int, divider: int = DIVIDER) -> Fraction:
    """E3: reference frequency f_p of a word."""
    return overflow_hz(word) / divider


def wheel_word(diameter_mm: int) -> Fraction:
    """D_w: the wheel word that makes f_v independent of the diameter; whole for all nine steps."""
    return Fraction(diameter_mm, 5)


def full_scale_wheel_word(diameter_mm: int) -> int:
    """The alternative words 231..255, which round."""
    return round(Fraction(255 * diameter_mm, 860))


def generator_hz(speed: Fraction | int, diameter_mm: int) -> Bounds:
    """f_s: generator frequency at a speed, wheel diameter in mm."""
    per_turn = PI.times(Fraction(36, 10) * Fraction(diameter_mm, 1000))
    return per_turn.inverse().times(Fraction(speed) * PULSES_A_REVOLUTION)


def corrected_hz(speed: Fraction | int, true_mm: int, word: Fraction | int) -> Bounds:
    """E4: f_v at a speed with a true diameter and a wheel word."""
    return generator_hz(speed, true_mm).times(Fraction(word) / 256)


HZ_PER_KMH = corrected_hz(1, 860, wheel_word(860))
KMH_PER_WORD = HZ_PER_KMH.inverse().times(pattern_hz(1))


def speed_of(word: Fraction | int, divider: int = DIVIDER) -> Bounds:
    """E5: the speed at which f_v equals the reference of a word."""
    return KMH_PER_WORD.times(Fraction(word) * Fraction(DIVIDER, divider))


def word_of(speed: Fraction | int) -> int:
    """The word nearest to a speed."""
    exact = KMH_PER_WORD.inverse().times(speed)
    low, high = round(exact.low), round(exact.high)
    assert low == high, f"{speed} km/h lies between two words"
    return low


WORD = {speed: word_of(speed) for speed in SPEEDS}


def word_error(speed: int) -> Bounds:
    """Speed of the word minus speed of the signal."""
    low, high = speed_of(WORD[speed])
    return Bounds(low - speed, high - speed)


def indicated(speed: Fraction | int, true_mm: int, set_mm: int) -> Fraction:
    """E6: what the equipment takes the speed for."""
    return Fraction(speed) * set_mm / true_mm


def permitted(speed: Fraction | int, true_mm: int, set_mm: int) -> Fraction:
    """E6: the true speed at which the limit is reached."""
    return Fraction(speed) * true_mm / set_mm


def check_hz(word: int = CHECK_WORD) -> Fraction:
    """E7: check frequency."""
    return overflow_hz(word)


def in_window(overflows: int) -> bool:
    """Check window over 256 frames: strictly between 1/4 and 1/2 of the frames."""
    return 64 < overflows < 128


def error_envelope(ppm: int = 100) -> Fraction:
    """Worst word, half a wheel step at 90 km/h and an oscillator off by some ppm, added; upper bound."""
    words = max(max(abs(low), abs(high)) for low, high in (word_error(v) for v in SPEEDS))
    half_step = max(permitted(90, d + 5, d) - 90 for d in DIAMETERS_MM[:-1])
    return words + half_step + Fraction(90 * ppm, 1_000_000)


def too_small_wheel(steps: int, speed: int = 90) -> tuple[Fraction, Fraction]:
    """Least and greatest excess when the wheel switch stands some steps too small."""
    excess = [permitted(speed, d + 10 * steps, d) - speed for d in DIAMETERS_MM if d + 10 * steps <= 860]
    return min(excess), max(excess)


def mttf_two_of_three(failure: Fraction, repair: Fraction = Fraction(0), common: Fraction = Fraction(0)) -> Fraction:
    """E8, E9, E10: mean time to failure in h of two-out-of-three with a common part; rates per h."""
    up, down = 3 * failure + common, 2 * failure + common
    return (down + repair + 3 * failure) / (up * down + repair * common)


def surplus(excess: Fraction | int, seconds: Fraction) -> Bounds:
    """E11: pulses of f_v above f_p after a time at an excess speed."""
    return HZ_PER_KMH.times(Fraction(excess) * seconds)


BRAKE_AREA = 19_120  # word frames: from any state the brake comes once the integral of the excess has passed this


def brake_frames(margin: int) -> int:
    """Frames of a speed `margin` words above the limit after which the brake is there, from any state."""
    return -(-BRAKE_AREA // margin)
