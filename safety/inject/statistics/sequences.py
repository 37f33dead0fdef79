"""Bounds that hold at all times at once, so that a campaign may stop as soon as it is sure.

Robbins' method of mixtures (Annals of Mathematical Statistics 41, 1970): if the share is p, the likelihood of what was
seen, averaged over a beta distribution of shares, divided by that under p, is a martingale that starts at 1.  It ever
reaches 1/a with a probability of at most a (Ville's inequality).  The p for which it is below 1/a are therefore an
interval which, with confidence 1 - a, holds the truth after every single trial, whatever decides when to stop.

Drawn without replacement, the same holds for the number of hits in the population, under the likelihood of the ordered
draw (Waudby-Smith and Ramdas, "Confidence sequences for sampling without replacement", NeurIPS 2020).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from safety.inject.statistics.hypergeometric import MOST
from safety.inject.statistics.shares import above, below, bounds
from safety.inject.statistics.tails import check_counts, one_tail

ROUNDING = 1e-15  # relative error of log-gamma, with room


def anytime(hits: int, of: int, confidence: float = 0.99, around: float = 0.5) -> tuple[float, float]:
    """Bounds on a probability that hold after every number of independent trials at once, rounded outward.

    They are narrowest near `around`, which is chosen before the first trial.
    Raises `ValueError` unless 0 <= hits <= of, of >= 1, 0 < confidence < 1 and 0 < around < 1.
    """
    check_counts(hits, of)
    log_mixture, error = _log_mixture(hits, of, around)
    bar = _bar(confidence)

    def excluded(p: float) -> bool:
        if (p <= 0 and hits) or (p >= 1 and hits < of):
            return True
        terms = [hits and hits * math.log(p), hits < of and (of - hits) * math.log1p(-p)]
        return log_mixture - sum(terms) >= bar + error - ROUNDING * sum(terms)

    middle = hits / of
    low = last_excluded(excluded, 0.0, middle) if hits else 0.0
    high = last_excluded(excluded, 1.0, middle) if hits < of else 1.0
    return low, high


def anytime_limits(
    hits: int, of: int, population: int, confidence: float = 0.99, around: float = 0.5
) -> tuple[int, int]:
    """Least and greatest number of hits in `population`, valid after every number of draws without replacement at once.

    Raises as `anytime`, and unless of <= population <= 10^9.
    """
    check_counts(hits, of)
    if not of <= population <= MOST:
        raise ValueError(f"population {population} with {of} draws: it is at least the draws and at most {MOST}")
    log_mixture, error = _log_mixture(hits, of, around)
    bar = _bar(confidence)

    def excluded(marked: int) -> bool:
        terms = [
            *_log_falling(marked, hits),
            *_log_falling(population - marked, of - hits),
            *(-term for term in _log_falling(population, of)),
        ]
        return log_mixture - math.fsum(terms) >= bar + error + ROUNDING * sum(map(abs, terms))

    least, greatest = hits, population - (of - hits)
    likeliest = min(max(hits * (population + 1) // of, least), greatest)
    return _first_kept(excluded, least, likeliest), _first_kept(excluded, greatest, likeliest)


def _log_mixture(hits: int, of: int, around: float) -> tuple[float, float]:
    """Log of the likelihood averaged over the beta distribution with mean `around`, and what it may be wrong by."""
    if not 0 < around < 1:
        raise ValueError(f"around {around}: the share expected lies between 0 and 1")
    a, b = (0.5, 0.5 * (1 - around) / around) if around <= 0.5 else (0.5 * around / (1 - around), 0.5)
    terms = [math.lgamma(x) for x in (a + hits, b + of - hits, a + b)]
    terms += [-math.lgamma(x) for x in (a + b + of, a, b)]
    return math.fsum(terms), ROUNDING * sum(map(abs, terms))


def _log_falling(n: int, k: int) -> tuple[float, float]:
    """Two terms whose sum is log(n (n-1) ... (n-k+1))."""
    return math.lgamma(n + 1), -math.lgamma(n - k + 1)


def _bar(confidence: float) -> float:
    return -math.log(float(2 * one_tail(confidence)))


def last_excluded(excluded: Callable[[float], bool], outer: float, kept: float) -> float:
    """The excluded number next to those that are kept, between `outer` and `kept`."""
    while (middle := (outer + kept) / 2) not in (outer, kept):
        if excluded(middle):
            outer = middle
        else:
            kept = middle
    return outer


def _first_kept(excluded: Callable[[int], bool], outer: int, kept: int) -> int:
    """The whole number nearest to `outer`, between it and `kept`, that is not excluded."""
    if not excluded(outer):
        return outer
    while abs(outer - kept) > 1:
        middle = (outer + kept) // 2
        if excluded(middle):
            outer = middle
        else:
            kept = middle
    return kept


@dataclass
class StopWhenSure:
    """Says after each batch whether a share is surely at least, or surely at most, `target`; else to go on.

    Looking often costs nothing: over all looks together a wrong answer has a probability of at most 1 - confidence.
    `population`: the draws are without replacement from so many.  Raises `ValueError` unless 0 < target < 1.
    """

    target: float | Fraction
    confidence: float = 0.99
    population: int | None = None
    answer: str = field(default="go on", init=False)
    hits: int = field(default=0, init=False)
    of: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        if not 0 < self.target < 1:
            raise ValueError(f"target {self.target}: it lies between 0 and 1, e.g. 0.99")
        one_tail(self.confidence)

    def look(self, hits: int, of: int) -> str:
        """ "sure above", "sure below" or "go on" after `hits` in `of` trials, counted from the first; an answer stays.

        Raises `ValueError` when the counts are less than before, or impossible.
        """
        check_counts(hits, of)
        if hits < self.hits or of - hits < self.of - self.hits:
            raise ValueError(
                f"{hits} hits of {of} after {self.hits} of {self.of}: give the counts from the first trial"
            )
        self.hits, self.of = hits, of
        if self.answer == "go on":
            low, high = self.bounds
            self.answer = "sure above" if low >= self.target else "sure below" if high <= self.target else "go on"
        return self.answer

    @property
    def bounds(self) -> tuple[float, float]:
        """Bounds on the share that hold at all times at once; 0 and 1 before the first trial."""
        if not self.of:
            return 0.0, 1.0
        around = float(self.target)
        if self.population is None:
            return anytime(self.hits, self.of, self.confidence, around)
        least, greatest = anytime_limits(self.hits, self.of, self.population, self.confidence, around)
        return below(Fraction(least, self.population)), above(Fraction(greatest, self.population))

    @property
    def bounds_at_fixed_size(self) -> tuple[float, float]:
        """Bounds that would hold had this number of trials been settled beforehand; to stand beside `bounds`."""
        if not self.of:
            return 0.0, 1.0
        low, high = bounds(self.hits, self.of, self.population, self.confidence)
        return below(low), above(high)

    def to_json(self) -> dict[str, Any]:
        """Keys target, confidence, answer, hits, of, anytime and fixed (low and high each)."""
        return {
            "target": float(self.target),
            "confidence": self.confidence,
            "answer": self.answer,
            "hits": self.hits,
            "of": self.of,
            "anytime": dict(zip(("low", "high"), self.bounds, strict=True)),
            "fixed": dict(zip(("low", "high"), self.bounds_at_fixed_size, strict=True)),
        }
