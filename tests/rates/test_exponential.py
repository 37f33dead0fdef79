"""The probability of what comes at a rate: its enclosure holds 1 - exp(-x), and says so where it is for x of 0..1."""

from __future__ import annotations

from fractions import Fraction

import flint
import pytest

from safety.rates.exceptions import NumericsFailed
from safety.rates.exponential import chance


@pytest.mark.parametrize("x", [Fraction(1, 10**12), Fraction(876, 10_000), Fraction(1, 2), Fraction(1)], ids=str)
def test_chance_encloses_the_exponential(x: Fraction) -> None:
    low, high = chance(x)
    with flint.ctx.workprec(1000):  # the narrowest is 1e-152 wide
        exact = 1 - (-flint.arb(flint.fmpq(x.numerator, x.denominator))).exp()
        assert flint.arb(flint.fmpq(low.numerator, low.denominator)) < exact
        assert exact < flint.arb(flint.fmpq(high.numerator, high.denominator))
    assert 0 < high - low < Fraction(3, 10**9)


def test_chance_of_nothing_is_nothing() -> None:
    assert chance(Fraction(0)) == (0, 0)


@pytest.mark.parametrize("x", [Fraction(-1, 10), Fraction(11, 10)], ids=str)
def test_chance_refuses_where_the_terms_do_not_fall(x: Fraction) -> None:
    with pytest.raises(NumericsFailed, match=f"not {float(x):.3g}; take a shorter time"):
        chance(x)
