"""The figures of a failure-mode table: which injections each is made of, and what is known of it.

lambda_S, lambda_DD, lambda_DU and lambda of no effect divide the failure rate of a mode; diagnostic coverage is
lambda_DD / (lambda_DD + lambda_DU), the safe failure fraction (lambda_S + lambda_DD) / (lambda_S + lambda_DD +
lambda_DU) (IEC 61508-4:2010, 3.8.6 and 3.6.15).  A fault without effect counts in neither.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from safety.inject.classes import CELLS, CLASSES, Tally, class_of
from safety.inject.statistics import Share

SAFE = ("safe/yes", "safe/no", "neutral/yes")
RATES = {"lambda_s": SAFE, "lambda_dd": ("wrong/yes",), "lambda_du": ("wrong/no",), "lambda_no_effect": ("neutral/no",)}
GOOD = {"diagnostic_coverage": ("wrong/yes",), "safe_failure_fraction": (*SAFE, "wrong/yes")}
FIGURES = (*RATES, *GOOD)
BEHIND: Mapping[str, tuple[str, ...]] = {  # the cells whose injections each column is made of
    "faults": CELLS,
    **{name: tuple(cell for cell in CELLS if class_of(cell) == name) for name in CLASSES},
    "dangerous_detected": ("wrong/yes",),
    **RATES,
    **{name: (*cells, "wrong/no") for name, cells in GOOD.items()},
}


def count(tally: Tally, column: str) -> int:
    """How many injections are behind a column."""
    return sum(tally[cell] for cell in BEHIND[column])


def good(tally: Tally, fraction: str) -> int:
    """How many of the injections behind a fraction are on its good side."""
    return sum(tally[cell] for cell in GOOD[fraction])


@dataclass(frozen=True)
class Figure:
    """A value of the table with its bounds, all exact numbers; rates in 1/h."""

    value: Fraction
    low: Fraction
    high: Fraction

    @classmethod
    def of(cls, found: Share | None) -> Figure | None:
        """From a share, or a total of shares of rates."""
        if found is None:
            return None
        if found.exact is not None:
            return cls(found.exact, found.exact, found.exact)
        return cls(Fraction(found.value), Fraction(found.low), Fraction(found.high))

    def times(self, rate: Fraction) -> Figure:
        """The same share of a rate."""
        return Figure(rate * self.value, rate * self.low, rate * self.high)
