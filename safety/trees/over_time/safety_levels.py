"""Safety integrity levels: the band of an average probability of failure on demand, or of a frequency of failure.

    SIL    average probability of failure on demand    frequency of dangerous failure per hour
           (low demand)                                (high demand or continuous)
    4      1e-5 <= x < 1e-4                            1e-9 <= x < 1e-8
    3      1e-4 <= x < 1e-3                            1e-8 <= x < 1e-7
    2      1e-3 <= x < 1e-2                            1e-7 <= x < 1e-6
    1      1e-2 <= x < 1e-1                            1e-6 <= x < 1e-5

Below the band of level 4 the level is still 4, as the standard has none above; from the upper end of level 1 on there
is none, 0 here. Limits are compared as rationals: 1/1000 itself is level 2. A figure known only to lie between two
numbers has the levels of both, and is undecided where they differ.

A frequency tells nothing of what is mostly unavailable, as what has failed cannot fail again: a high demand level is
given only up to MOST_UNAVAILABLE, from where on there is no level in low demand either.

Source: IEC 61508-1:2010, tables 2 and 3.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

HIGHEST = 4
UPPER_END = {"low demand": Fraction(1, 10), "high demand": Fraction(1, 10**5)}  # of level 1
MOST_UNAVAILABLE = Fraction(1, 10)  # of the time


@dataclass(frozen=True)
class Level:
    """The level of a figure between `low` and `high`."""

    mode: str  # a key of UPPER_END
    low: Fraction
    high: Fraction
    worst: int  # level at `high`, 0 for none
    best: int  # level at `low`
    why_none: str = ""  # why no level is given, whatever the figure

    @property
    def decided(self) -> int | None:
        """The level, None where both ends of what is known have different ones."""
        return self.worst if self.worst == self.best else None

    def plain(self) -> dict[str, Any]:
        """The entry of a results document; `sil` is None where the figure straddles `limit`."""
        entry: dict[str, Any] = {"mode": self.mode, "sil": self.decided, "sil_at_least": self.worst}
        if self.why_none:
            entry["why_none"] = self.why_none
        elif self.decided is None:
            entry["limit"] = float(UPPER_END[self.mode] / 10**self.worst)
        elif self.high < UPPER_END[self.mode] / 10**HIGHEST:
            entry["beyond"] = True  # better than the band of level 4 asks for
        return entry


def level(mode: str, low: Fraction | float, high: Fraction | float | None = None) -> Level:
    """The level of a figure, or of one known to lie between `low` and `high`; doubles count as they are.

    `mode` is "low demand" for an average probability of failure on demand, "high demand" for a frequency per hour.
    """
    first = Fraction(low)
    last = first if high is None else Fraction(high)
    return Level(mode, first, last, _of(mode, last), _of(mode, first))


def no_level(mode: str, low: float, high: float, why: str) -> Level:
    """No level for a figure between `low` and `high`, for a reason of another kind."""
    return Level(mode, Fraction(low), Fraction(high), 0, 0, why)


def _of(mode: str, figure: Fraction) -> int:
    found = 0
    while found < HIGHEST and figure < UPPER_END[mode] / 10**found:
        found += 1
    return found
