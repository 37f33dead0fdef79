"""Public checks P1-P6, P11, P14 on the published numbers, and P19, P20 on the formulas."""

from __future__ import annotations

from fractions import Fraction

import pytest

from models.ts7 import numbers
from models.ts7.numbers import DIAMETERS_MM, SPEEDS, WORD


def near(value: Fraction, printed: str) -> bool:
    """Equal to a printed decimal, to its last place."""
    return abs(value - Fraction(printed)) <= Fraction(1, 2 * 10 ** len(printed.partition(".")[2]))


def test_p1_frame_and_the_factor_two() -> None:
    assert numbers.frame_s() == Fraction(125, 1_000_000) == 1 / Fraction(numbers.FRAME_HZ)
    assert 1 / numbers.frame_s(periods_a_bit=1) == 16_000
    assert Fraction(numbers.OSCILLATOR_HZ, 2) == 256_000


def test_p2_words_and_pattern_rates() -> None:
    assert list(WORD.values()) == [53, 95, 138, 159, 191]
    printed = ["103.5156", "185.5469", "269.5312", "310.5469", "373.0469"]
    assert all(near(numbers.pattern_hz(w), p) for w, p in zip(WORD.values(), printed, strict=True))
    assert [float(numbers.overflow_hz(w)) for w in WORD.values()] == [1656.25, 2968.75, 4312.5, 4968.75, 5968.75]


def test_p3_rate_per_speed_is_the_same_for_every_wheel() -> None:
    for d in DIAMETERS_MM:
        for low_high in (numbers.corrected_hz(1, d, numbers.wheel_word(d)), numbers.HZ_PER_KMH):
            assert all(near(x, "4.144660") for x in low_high)
    assert all(near(x, "0.47124") for x in numbers.KMH_PER_WORD)
    assert {v for v in SPEEDS if abs(numbers.word_error(v).low) > Fraction(1, 10)} == {45}
    assert near(-numbers.word_error(45).low, "0.2323")


@pytest.mark.parametrize(
    ("speed", "is_", "error"),
    [
        (25, "24.9757", "-0.0243"),
        (45, "44.7677", "-0.2323"),
        (65, "65.0310", "0.0310"),
        (75, "74.9270", "-0.0730"),
        (90, "90.0066", "0.0066"),
    ],
)
def test_table_of_words(speed: int, is_: str, error: str) -> None:
    assert near(numbers.speed_of(WORD[speed]).low, is_)
    assert near(numbers.word_error(speed).low, error)


def test_p4_wheel_words_are_exact() -> None:
    words = [numbers.wheel_word(d) for d in DIAMETERS_MM]
    assert words == list(range(156, 173, 2))
    assert all(w * 1280 == 256 * d for w, d in zip(words, DIAMETERS_MM, strict=True))
    rounded = [numbers.full_scale_wheel_word(d) for d in DIAMETERS_MM]
    assert rounded == list(range(231, 256, 3))
    errors = [abs(Fraction(w * 860, 255 * d) - 1) for w, d in zip(rounded, DIAMETERS_MM, strict=True)]
    assert near(max(errors) * 100, "0.1207")


def test_p5_without_divider_a_word_is_too_coarse() -> None:
    assert near(numbers.speed_of(1, divider=1).low, "7.54")


def test_p6_rollback_words() -> None:
    low, high = numbers.ROLLBACK_RANGE
    for word, speed in ((numbers.ROLLBACK_WORD, "5.184"), (numbers.ROLLBACK_WORD_OF_TABLE, "6.126")):
        assert near(numbers.speed_of(word).low, speed) and low < numbers.speed_of(word).low < high


def test_p7_check_frequency() -> None:
    assert numbers.check_hz() == Fraction("2656.25")
    assert numbers.FRAME_HZ // 4 < numbers.check_hz() < numbers.FRAME_HZ // 2
    assert near((1 - numbers.check_hz() / Fraction(8000, 3)) * 100, "0.39")
    assert [numbers.in_window(n) for n in (64, 65, 85, 127, 128)] == [False, True, True, True, False]


def test_p11_wired_or_is_more_permissive_than_either() -> None:
    assert WORD[25] | WORD[65] == 191
    assert near(numbers.speed_of(191).low, "90.01")


def test_p14_error_envelope_and_wheel_steps() -> None:
    assert near(numbers.error_envelope(), "0.818") and numbers.error_envelope() < numbers.ACCURACY
    assert [near(x, p) for x, p in zip(numbers.too_small_wheel(1), ("1.059", "1.154"), strict=True)] == [True, True]
    assert [near(x, p) for x, p in zip(numbers.too_small_wheel(2), ("2.143", "2.308"), strict=True)] == [True, True]
    assert near(numbers.permitted(90, 785, 780) - 90, "0.577")


def test_p19_p20_mean_times() -> None:
    assert numbers.mttf_two_of_three(Fraction("2.77778e-5")) == pytest.approx(30_000, rel=1e-6)
    assert numbers.mttf_two_of_three(Fraction(1, 36_000)) == numbers.MTBF_H
    assert numbers.mttf_two_of_three(Fraction(1, 2019), Fraction(1, 24)) == pytest.approx(30_000, rel=1e-3)
    with_common = numbers.mttf_two_of_three(Fraction(1, 10_000), Fraction(1, 24), Fraction("3.1911e-5"))
    assert with_common == pytest.approx(30_000, rel=1e-4)


def test_beats() -> None:
    tenths = Fraction(3, 10)
    assert near(1 / numbers.surplus(1, tenths).low, "0.804") and near(2 / numbers.surplus(1, tenths).low, "1.608")
