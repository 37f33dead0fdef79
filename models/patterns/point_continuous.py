"""Point and continuous control together: track inductors tell the distance left, the rails that the section is clear.

                A         B         C         D  red signal
    line speed  |<= 40    |<= 25    |<= 15    |  0                km/h [P]

Passing an inductor the train has to be at its limit, and is slowed to the next one: from C to a stop at D.  The limit
only ever falls until the continuous channel says that the section is clear.  The channel alone admits `approach` in the
section before the stop signal, and nothing behind it, whatever inductors are missing.
`PointAndContinuous` is the equipment, `InductorApproach` a train with it, a step of which is the way to the next point.
Every line that prevents braking is held: de-energised brakes.
Source: limits, stop at D, principle [P]; braking 0.5 m/s^2 after a free run of 2 s, what the channel alone admits [A].

Main results: C-D, B-D, A-D 25.694, 70.448, 167.901 m; the train stands at D.  With an inductor missing it passes D,
at most at 40 km/h, and the channel stops it.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import NamedTuple

from models.kinematics import KMH, distance
from safety import Bit, Model, Real, assume, parameter, point, power_up, select

LIMITS = tuple(kmh * KMH for kmh in (40, 25, 15, 0))  # at A, B, C, D, m/s [P]
LINE = 100 * KMH  # line speed, m/s [A]
DECELERATION, FREE_RUN = Fraction("0.5"), Fraction(2)  # m/s^2, s [A]
WAYS = tuple(distance(v, DECELERATION, FREE_RUN, w) for v, w in pairwise(LIMITS))  # A-B, B-C, C-D
NEXT_POINT = "end of the clear section, then passing of A, B, C, D"


class Inductors(NamedTuple):
    """Which inductor is passed in this step."""

    a: Bit
    b: Bit
    c: Bit
    d: Bit


class Control(NamedTuple):
    """What the equipment decides."""

    limit: Real  # m/s, from here on to be reached by the next point
    brake: Bit


class OnBoard(Model, event=NEXT_POINT):
    """FREE, L40, L25, L15 or STOP, as the limit to which the train is being slowed; STOP at power-up."""

    held: Real = power_up(0)  # limit of the last step, m/s
    approach: Real = parameter(LIMITS[0], unit="m/s", within=(0, LINE), source="[A] admitted by the channel alone")

    def step(self, passed: Inductors, clear: Bit, current: Bit, v: Real) -> tuple[OnBoard, Control]:
        """Inductors, what the rails carry: the section is clear; there is current at all (section before the stop)."""
        carries, free = point("track_current", current), point("receiver", clear)
        limit = select(self.held <= self.approach, self.held, self.approach)
        for name, found, to in zip("abcd", passed, (*LIMITS[1:], LIMITS[-1]), strict=True):
            seen = point(f"inductor_{name}", found)
            limit = select(seen & (limit > to), to, limit)
        limit = select(carries, select(free, LINE, limit), 0)
        brake = ~point("valve", (v <= limit) & carries)
        return type(self)(held=limit), Control(limit, brake)


class PointAndContinuous(OnBoard, tick_s="0.1"):
    """The equipment by itself, looking every 0.1 s."""


class Place(NamedTuple):
    """Where the train is when a step ends, and what the equipment decides there."""

    way: Real  # m, from the last point to this one
    at_signal: Bit  # at D
    limit: Real
    brake: Bit


class InductorApproach(Model, event=NEXT_POINT):
    """A train that comes from a clear section and passes the inductors; the surroundings choose its speed at each."""

    onboard: OnBoard
    entered: Bit = power_up(False)
    past_a: Bit = power_up(False)
    past_b: Bit = power_up(False)
    past_c: Bit = power_up(False)
    before: Real = power_up(0)  # speed at the last point, m/s
    way_ab: Real = parameter(WAYS[0], unit="m", within=(1, 1000), source="[A] 40 to 25 km/h, 0.5 m/s^2, 2 s")
    way_bc: Real = parameter(WAYS[1], unit="m", within=(1, 1000), source="[A] 25 to 15 km/h, 0.5 m/s^2, 2 s")
    way_cd: Real = parameter(WAYS[2], unit="m", within=(1, 1000), source="[A] 15 to 0 km/h, 0.5 m/s^2, 2 s")

    def step(self, v: Real) -> tuple[InductorApproach, Place]:
        """The next point is passed at a speed, m/s; the rails carry nothing behind D."""
        assume("runs forward, no faster than the line", (v >= 0) & (v <= LINE))
        at = Inductors(
            self.entered & ~self.past_a, self.past_a & ~self.past_b, self.past_b & ~self.past_c, self.past_c
        )  # fmt: skip
        onboard, control = self.onboard.step(at, ~self.entered, ~at.d, v)
        way = select(at.b, self.way_ab, select(at.c, self.way_bc, select(at.d, self.way_cd, 0)))
        after = type(self)(
            onboard=onboard, entered=~at.d, past_a=self.entered & ~at.d, past_b=self.past_a & ~at.d,
            past_c=self.past_b & ~at.d, before=v,
        )  # fmt: skip
        return after, Place(way, at.d, control.limit, control.brake)
