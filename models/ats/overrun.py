"""Overrun prevention: where the timetable says stop, a pattern to the stop mark, until the train has stood there.

    made   on the approach, `approach` before the mark, if the timetable says stop and the stop is not yet made
    ended  standstill for 1 s within `window` of the mark, as estimated

Without a timetable there is no pattern: it is no safety function, but for what `crossing` builds on it.  The pattern of
a stop mark has no margin, and it holds the far end of the interval: so the window has to be wider than the estimate is
uncertain there, else the train can never stand within it.
Source: principle [P]; 1 km/h for 1 s, 5 m, 1000 m [A].
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple, Self

from models.kinematics import CYCLE, KMH, nearest
from models.position.odometer import Position, step_s
from safety import Bit, Model, Real, parameter, point, power_up, require, select


class Stop(NamedTuple):
    """What becomes of the pattern to the stop mark."""

    made: Bit
    ended: Bit


class StationStop(Model, tick_s=step_s):
    """The stop at one station."""

    served: Bit = power_up(False)
    still: Real = power_up(0)  # s for which the train has stood at the mark
    cycle: Real = parameter(CYCLE, unit="s", within=(Fraction(1, 1000), 1), source="[A] control cycle")
    approach: Real = parameter(1000, unit="m", within=(0, 5000), source="[A] before the mark")
    window: Real = parameter(5, unit="m", within=(0, 50), source="[A] on both sides of the mark")
    uncertain: Real = parameter(2, unit="m", within=(0, 50), source="[A] s_hi less the estimate at the mark")
    standstill: Real = parameter(KMH, unit="m/s", within=(0, 1), source="[A] below 1 km/h the train stands")
    patience: Real = parameter(1, unit="s", within=(Fraction(1, 1000), 10), source="[A] standstill for 1 s")

    def step(self, timetable_stop: Bit, known: Bit, where: Position, mark: Real) -> tuple[Self, Stop]:
        """One cycle; `known`: the position may be relied on; the stop mark, m."""
        require("the stop can be made within its window", self.window > self.uncertain,
                nearest("window", self.uncertain, "m", side="any above"))  # fmt: skip
        near = (where.guess - mark <= self.window) & (mark - where.guess <= self.window)
        stands = near & (where.fastest <= self.standstill) & known
        still = select(stands, self.still + self.cycle, 0)
        ended = point("ended", still >= self.patience)
        ahead = (where.high >= mark - self.approach) & (where.low < mark)
        made = point("made", point("timetable", timetable_stop) & known & ahead & ~self.served & ~ended)
        return type(self)(served=self.served | ended, still=still), Stop(made, ended)


class AnyStandstill(StationStop, tick_s=step_s):
    """The variant to be refuted: a standstill anywhere ends the pattern."""

    window: Real = parameter(10_000, unit="m", within=(0, 10_000), source="[A] a window without bounds")


class StopBench(Model, tick_s=step_s):
    """The stop at one station beside the truth: for how long the train has stood within the window."""

    station: StationStop
    stood: Real = power_up(0)  # s until the last cycle
    mark_at: Real = parameter(1000, unit="m", within=(-10_000, 10_000), source="[A] line data: stop mark")

    def step(self, timetable_stop: Bit, known: Bit, where: Position, pos: Real) -> tuple[Self, Stop]:
        """One cycle; `pos` is the true place of the head, m."""
        wide = self.station.window + self.station.uncertain
        near = (pos - self.mark_at <= wide) & (self.mark_at - pos <= wide)
        standing = select(near & (where.fastest <= self.station.standstill), self.stood + self.station.cycle, 0)
        station, stop = self.station.step(timetable_stop, known, where, self.mark_at)
        return type(self)(station=station, stood=point("standing", standing)), stop


class AnywhereBench(StopBench, tick_s=step_s):
    """With the variant."""

    station: AnyStandstill
