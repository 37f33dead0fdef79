"""Probabilities to the last digits: against exact fractions, and for large counts against whole-number arithmetic."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest

from safety.inject.statistics.tails import binomial, deviance, hypergeometric, one_tail, stirling_error


@pytest.mark.parametrize("n", [1, 3, 10, 15, 16, 17, 30, 170, 1000])
@pytest.mark.parametrize("p", [Fraction(1, 1000), Fraction(1, 3), Fraction(99, 100)])
def test_the_binomial_is_exact_to_twelve_digits(n: int, p: Fraction) -> None:
    for k in {0, 1, n // 3, n // 2, n - 1, n}:
        exact = math.comb(n, k) * p**k * (1 - p) ** (n - k)
        assert binomial(k, n, float(p)) == pytest.approx(float(exact), rel=3e-12, abs=1e-300)


@pytest.mark.parametrize(
    ("drawn", "marked", "population"), [(3, 4, 9), (20, 30, 60), (400, 900, 2000), (50, 50, 10**6)]
)
def test_the_hypergeometric_is_exact_to_eleven_digits(drawn: int, marked: int, population: int) -> None:
    for k in range(max(0, drawn + marked - population), min(drawn, marked) + 1, 7):
        ways = math.comb(marked, k) * math.comb(population - marked, drawn - k)
        exact = float(Fraction(ways, math.comb(population, drawn)))
        if exact > 1e-280:
            assert hypergeometric(k, drawn, marked, population) == pytest.approx(exact, rel=1e-11)
    assert hypergeometric(min(drawn, marked) + 1, drawn, marked, population) == 0


@pytest.mark.parametrize("n", [16, 20, 50, 200])
def test_stirlings_error_goes_on_where_the_series_begins(n: int) -> None:
    log_factorial = math.log(math.factorial(n))
    approximation = (n + 0.5) * math.log(n) - n + math.log(2 * math.pi) / 2
    assert stirling_error(n) == pytest.approx(log_factorial - approximation, abs=3e-13)
    series_and_gamma = stirling_error(15.0), stirling_error(math.nextafter(15, 16))
    assert series_and_gamma[0] == pytest.approx(series_and_gamma[1], abs=1e-14)


def test_the_deviance_is_exact_on_both_ways() -> None:
    from flint import arb, ctx

    ctx.prec = 200
    for x, mean in ((10.0, 10.5), (1e9, 1e9 + 1e4), (3.0, 90.0), (5.0, 5.0), (1e8, 1.2e8)):
        exact = arb(x) * (arb(x) / arb(mean)).log() + arb(mean) - arb(x)
        assert deviance(x, mean) == pytest.approx(float(exact.mid()), rel=1e-13, abs=1e-290)


def test_the_error_left_open_is_taken_as_it_is_written() -> None:
    assert one_tail(0.99) == one_tail(Fraction(99, 100)) == Fraction(1, 200)
    with pytest.raises(ValueError, match=r"confidence 1\.0"):
        one_tail(1.0)
