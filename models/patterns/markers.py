"""Several ground markers: the driver's braking is checked at points 2 and 3, the stop at point 4.

    1 brake!      2 v <= A?      3 v <= B?      4 stop here      signal
    x1            x2             x3             l                0          metres before the signal

Passing 2 faster than A, or 3 faster than B, brings the service brake, until the speed is B or less; passing 4 without
an acknowledged stop brings the emergency brake.  One step is the passing of the next point.
Every line that prevents braking is held: de-energised brakes.
Source: points, levels, one release level, emergency brake at 4, spacing stretched with the gradient [P]; dimensioning
[A], as the paper gives no numbers.

Main results: v4max = 30.633 km/h, A = 74.677 km/h, x1, x2, x3 = 910.279, 608.980, 349.168 m.  With point 2 as it is
drawn, on the standard curve without free run, 605.556 m, the signal is overrun by 2.859 m.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from models.kinematics import (
    B_EMERGENCY,
    B_SERVICE,
    T_EMERGENCY,
    T_SERVICE,
    at_least,
    at_most,
    distance,
    need,
    stops_within,
)
from models.patterns.marker_spacing import AS_DIMENSIONED, DRAWN, RELEASE, STOP_BEFORE, TOP, Scheme, overrun
from safety import Bit, Model, Real, assume, parameter, point, power_up, require, select

__all__ = ["AS_DIMENSIONED", "DRAWN", "RELEASE", "STOP_BEFORE", "TOP", "Markers", "MarkersAsDrawn", "Scheme", "overrun"]

NEXT_POINT = "passing of point 2, 3, 4"


class Passed(NamedTuple):
    """What the passing of a point brings."""

    service: Bit
    emergency: Bit
    at: Real  # m before the signal


class Sizes(Model, event=NEXT_POINT):
    """Where the points lie, the levels, the brakes."""

    top: Real = parameter(TOP, unit="m/s", within=(5, 100), source="[A] Vmax 100 km/h")
    stop_before: Real = parameter(STOP_BEFORE, unit="m", within=(10, 1000), source="[A] l, point 4 before the signal")
    level_b: Real = parameter(RELEASE, unit="m/s", within=(0, 100), source="[A] B, 30 km/h")
    level_a: Real = parameter(AS_DIMENSIONED["level_a"], unit="m/s", within=(0, 100), source="[A] A, dimensioned")
    fastest: Real = parameter(AS_DIMENSIONED["fastest"], unit="m/s", within=(0, 100), source="[A] v4max, dimensioned")
    x2: Real = parameter(AS_DIMENSIONED["x2"], unit="m", within=(10, 20000), source="[A] x2, dimensioned")
    x3: Real = parameter(AS_DIMENSIONED["x3"], unit="m", within=(10, 20000), source="[A] x3, dimensioned")
    b_service: Real = parameter(B_SERVICE, unit="m/s^2", within=(Fraction(1, 10), 3), source="[A] b_s, at least")
    t_service: Real = parameter(T_SERVICE, unit="s", within=(0, 10), source="[A] t_s, free run")
    b_emergency: Real = parameter(B_EMERGENCY, unit="m/s^2", within=(Fraction(1, 10), 3), source="[A] b_e, at least")
    t_emergency: Real = parameter(T_EMERGENCY, unit="s", within=(0, 10), source="[A] t_e, free run")
    gains: Real = parameter(0, unit="m/s^2", within=(0, 2), source="[A] no traction from point 2 to 4")

    def moves(self, v: Real, before: Real, way: Real, from_2: Bit) -> None:
        """What traction and line admit between two points."""
        assume("runs forward, no faster than the line", (v >= 0) & (v <= self.top))
        assume("traction gives no more than it has", ~from_2 | (v * v <= before * before + 2 * self.gains * way))


class Laid(Sizes, event=NEXT_POINT):
    """The sizes as they have to be: the dimensioning, as inequalities; what is safer is admitted, too."""

    def requirements(self) -> None:
        """The dimensioning, as inequalities: what is safer is admitted, too."""
        b, t, x = self.b_service, self.t_service, self.stop_before
        ordered = (self.x2 >= self.x3) & (self.x3 >= x)
        require("points in order", ordered, lambda: f"the nearest admissible x2 is {at_least(_number(self.x3))} m")
        stops = stops_within(self.fastest, x, self.b_emergency, self.t_emergency)
        least = self.fastest, self.b_emergency, self.t_emergency
        require("emergency brake at 4 stops from v4max", stops, lambda: f"the nearest admissible l is {_way(*least)} m")
        released = self.level_b <= self.fastest
        require("B is not above v4max", released,
                lambda: f"the nearest admissible B is {at_most(_number(self.fastest))} m/s")  # fmt: skip
        self.point_2(b, t, x)
        from_a = need(self.level_a, b, t, self.fastest) <= 2 * b * (self.x3 - x)
        require("service brake at 3 suffices from A", from_a,
                lambda: f"the nearest admissible x3 is {_way(self.level_a, b, t, self.fastest, x)} m")  # fmt: skip

    def point_2(self, b: Real, t: Real, x: Real) -> None:
        """Point 2 lies far enough out."""
        from_top = need(self.top, b, t, self.fastest) <= 2 * b * (self.x2 - x)
        require("service brake at 2 suffices from Vmax", from_top,
                lambda: f"the nearest admissible x2 is {_way(self.top, b, t, self.fastest, x)} m")  # fmt: skip


class Markers(Laid, event=NEXT_POINT):
    """Train and markers: the surroundings choose the speed at each point, within what traction and line admit.

    What the service brake, once ordered, takes away is for a proof to state: that it acts may be what is in question.
    """

    past_2: Bit = power_up(False)
    past_3: Bit = power_up(False)
    before: Real = power_up(0)  # speed at the last point
    braking: Bit = power_up(False)  # service brake on when the last point was left
    began_v: Real = power_up(0)  # speed and place at which the service brake was ordered
    began_x: Real = power_up(0)

    def step(self, v: Real, released: Bit, acknowledged: Bit) -> tuple[Markers, Passed]:
        """The next point is passed at a speed, m/s.

        `released`: the service brake has come down to B on the way; at 4 the driver may have acknowledged the stop.
        """
        self.requirements()
        at = select(self.past_3, self.stop_before, select(self.past_2, self.x3, self.x2))
        self.moves(v, self.before, select(self.past_3, self.x3, self.x2) - at, self.past_2)
        fast_2, fast_3 = point("comparator_2", v > self.level_a), point("comparator_3", v > self.level_b)
        ordered = ~self.past_3 & select(self.past_2, fast_3, fast_2)
        goes_on = self.braking & ~released & (v > self.level_b)
        service = ~point("service_valve", ~(ordered | goes_on))
        emergency = ~point("emergency_valve", ~point("point_4", self.past_3 & ~acknowledged))
        after = type(self)(
            past_2=~self.past_3, past_3=self.past_2 & ~self.past_3, before=v, braking=service & ~self.past_3,
            began_v=select(goes_on, self.began_v, v), began_x=select(goes_on, self.began_x, at),
        )  # fmt: skip
        return after, Passed(service, emergency, at)


class MarkersAsDrawn(Markers, event=NEXT_POINT):
    """Point 2 as it is drawn: where the standard curve meets the top speed, without free run.  To be refuted."""

    level_a: Real = parameter(DRAWN["level_a"], unit="m/s", within=(0, 100), source="[A] A, point 2 as drawn [P]")
    x2: Real = parameter(DRAWN["x2"], unit="m", within=(10, 20000), source="[P] standard curve at the top speed")
    x3: Real = parameter(DRAWN["x3"], unit="m", within=(10, 20000), source="[A] x3, point 2 as drawn [P]")

    def point_2(self, b: Real, t: Real, x: Real) -> None:
        """Point 2 lies on the curve."""
        on_curve = self.top * self.top <= 2 * b * (self.x2 - x)
        require("point 2 on the standard curve", on_curve,
                lambda: f"the nearest admissible x2 is {_way(self.top, b, 0 * t, 0 * x, x)} m")  # fmt: skip


def _way(v: Real, b: Real, t: Real, reached: Real | int = 0, beyond: Real | int = 0) -> str:
    """A braking way and what lies beyond it, of parameters that are set."""
    numbers = (_number(each) for each in (v, b, t, reached))
    return at_least(_number(beyond) + distance(*numbers))


def _number(value: Real | int) -> Fraction:
    return Fraction(value if isinstance(value, int) else value.attr)
