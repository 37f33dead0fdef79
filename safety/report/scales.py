"""The scales of a plot's axes: where a value lies, and at which values there are ticks."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

ROOM = 0.04  # of the range of the values, left free at an end that is not given


class Scale(NamedTuple):
    """From `low` at pixel `start` to `high` at pixel `end`."""

    low: float
    high: float
    start: float
    end: float
    log: bool = False

    def at(self, value: float) -> float:
        """The pixel of a value."""
        low, high, it = (math.log10(v) if self.log else v for v in (self.low, self.high, value))
        return self.start + (it - low) / (high - low) * (self.end - self.start)

    def holds(self, value: float) -> bool:
        """Whether a value lies on the scale."""
        return self.low <= value <= self.high

    def ticks(self, most: int) -> list[float]:
        """Round values on the scale, at most so many or a few more: 1, 2, 5 times powers of ten."""
        return (self._log_ticks(most) if self.log else None) or self._linear_ticks(most)

    def _linear_ticks(self, most: int) -> list[float]:
        rough = (self.high - self.low) / most
        power = math.floor(math.log10(rough))
        digit = next(d for d in (1, 2, 5, 10) if d * 10.0**power >= rough * (1 - 1e-9))
        step = digit * 10.0**power
        first, last = math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9)
        return [float(f"{n * step:.12g}") for n in range(first, last + 1)]

    def _log_ticks(self, most: int) -> list[float]:
        """None unless two decades or nearly as much are there: then linear ones say more."""
        powers = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
        for digits in ((1, 2, 5), (1, 3), (1,)):
            found = [v for p in powers for d in digits if self.holds(v := float(f"{d}e{p}"))]
            if len(found) <= most and len(found) > 2:
                return found
        step = -(-len(powers) // most)
        found = [float(f"1e{p}") for p in powers if p % step == 0 and self.holds(float(f"1e{p}"))]
        return found if len(found) > 2 else []


def scale_of(axis: Mapping[str, Any], values: Iterable[float], start: float, end: float) -> Scale:
    """The scale of an axis: its own ends, else a little more than the values; one that falls starts at its high end."""
    values = [*values, *(v for v in (axis["low"], axis["high"]) if v is not None)]
    low, high = min(values), max(values)
    if axis["log"]:
        low, high = math.log10(low), math.log10(high)
    if low == high:
        aside = 0.5 if axis["log"] or not low else abs(low) / 20
        low, high = low - aside, high + aside
    room = (high - low) * ROOM
    low, high = low - room, high + room
    if axis["log"]:
        low, high = 10**low, 10**high
    low = low if axis["low"] is None else float(axis["low"])
    high = high if axis["high"] is None else float(axis["high"])
    start, end = (end, start) if axis.get("falling") else (start, end)
    return Scale(low, high, start, end, axis["log"])
