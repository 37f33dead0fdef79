"""Bounds on how many of a finite population are hits, after a draw without replacement.

The test of every possible number is inverted, as Clopper and Pearson do for the binomial (Buonaccorsi, The American
Statistician 41, 1987): the limits are whole numbers and the coverage is never below the stated confidence.
"""

from __future__ import annotations

from fractions import Fraction

from safety.inject.statistics.tails import check_counts, one_tail, reaches

MOST = 10**9


def hypergeometric_limits(hits: int, of: int, population: int, confidence: float = 0.99) -> tuple[int, int]:
    """Least and greatest number of hits in `population` after `hits` in `of` draws without replacement.

    For a one-sided limit at confidence c ask for 2c - 1 and take one end.
    Raises `ValueError` unless 0 <= hits <= of, 1 <= of <= population <= 10^9 and 0 < confidence < 1.
    """
    check_counts(hits, of)
    if not of <= population <= MOST:
        raise ValueError(f"population {population} with {of} draws: it is at least the draws and at most {MOST}")
    tail = one_tail(confidence)
    return _least(hits, of, population, tail), population - _least(of - hits, of, population, tail)


def _least(hits: int, of: int, population: int, tail: Fraction) -> int:
    """The least number of hits in all under which `hits` or more are drawn with a probability above `tail`."""
    low, high = hits, population - (of - hits)
    while low < high:
        middle = (low + high) // 2
        if reaches(hits, of, middle, population, tail):
            high = middle
        else:
            low = middle + 1
    return low
