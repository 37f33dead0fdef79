"""Speed-distance diagrams: an equipment and a train in a closed loop, cycle by cycle, and what is drawn of it.

The equipment is a model that is run; the train moves by `models.kinematics`, exactly.  Distances are those to go to the
protected point, below 0 behind it.
Source: cycle, brakes, free-run times [A].
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, NamedTuple

from models.kinematics import (
    B_EMERGENCY,
    B_SERVICE,
    CYCLE,
    KMH,
    MARGIN,
    T_EMERGENCY,
    T_SERVICE,
    ceiling_float,
    moved,
    way_doubled,
)
from safety.exhibits import Axis, Curve, Mark, Points
from safety.trace import Live

SERVICE, EMERGENCY, WARNING = "service brake", "emergency brake", "warning"
LONG, BEYOND = 3000, Fraction(-190)  # cycles; m: as far as a run is followed
NEAR = 0.05  # m: as good as at the point
Place = tuple[Fraction, Fraction]  # m to go, km/h
Row = Mapping[str, Any]


class Gear(NamedTuple):
    """A brake: deceleration in m/s^2, free run in s."""

    b: Fraction
    t: Fraction


BRAKES = {SERVICE: Gear(B_SERVICE, T_SERVICE), EMERGENCY: Gear(B_EMERGENCY, T_EMERGENCY)}
SAMPLED = {name: Gear(gear.b, gear.t - 2 * CYCLE) for name, gear in BRAKES.items()}  # less sampling and processing


@dataclass
class Course:
    """A run: where the train was with what speed, and where which brake came on."""

    places: list[Place] = field(default_factory=list)
    began: list[tuple[str, Place]] = field(default_factory=list)

    @property
    def end(self) -> Place:
        """Where it stands, or was last seen."""
        return self.places[-1]

    def told(self) -> str:
        """Where it ended, in words."""
        x, v = (float(each) for each in self.end)
        if v > 0:
            return f"goes on at {v:.0f} km/h"
        if abs(x) < NEAR:
            return "stops at it"
        return f"stops {x:.1f} m before" if x >= 0 else f"stops {-x:.1f} m beyond"


def drawn(courses: Mapping[str, Course]) -> Iterator[Mark]:
    """Each run as a line, where the brakes came on in any of them, and how each ended."""
    for label, course in courses.items():
        yield Curve(label, course.places, marked=False)
    for kind in (WARNING, SERVICE, EMERGENCY):
        places = [place for course in courses.values() for name, place in course.began if name == kind]
        if places:
            yield Points(f"{kind} on", places)
    told = [f"{label}: {course.told()}" for label, course in courses.items()]
    yield Points("end of a run", [course.end for course in courses.values()], told)


def drive(
    live: Live,
    x: Fraction | int,
    v: Fraction,
    row: Callable[[Fraction, Fraction, Fraction], Row],
    brakes: Callable[[Row], Mapping[str, Gear]],
    power: Callable[[Fraction, Fraction], Fraction] = lambda x, v: Fraction(0),
) -> Course:
    """Run an equipment against a train at x with v (m/s) to standstill, or far beyond the point.

    `row` gives the inputs of a cycle at a time (s), place and speed, `brakes` those that are on by what the model
    shows, `power` the driver's acceleration, m/s^2.  A brake acts from its free run on; of several the strongest does.
    """
    course, since, left = Course(), dict[str, Fraction](), Fraction(x)
    for cycle in range(LONG):
        on = brakes(live.shown(row(cycle * CYCLE, left, v)))
        course.places.append((left, v / KMH))
        course.began += [(name, course.end) for name in on if name not in since]
        since = {name: since[name] + CYCLE if name in since else Fraction(0) for name in on}
        acting = [gear.b for name, gear in on.items() if since[name] >= gear.t]
        reached, moving = moved(v, -max(acting) if acting else power(left, v), CYCLE)
        left, v = left - Fraction(way_doubled(v, reached, moving)) / 2, reached
        if left < BEYOND or (v == 0 and (on or power(left, v) <= 0)):
            break
    course.places.append((left, v / KMH))
    return course


def lines(shown: Row, gears: Mapping[str, Gear], **names: str) -> dict[str, Gear]:
    """The brakes whose lines are shown as on, each by the name of its path."""
    return {name: gears[name] for path, name in names.items() if shown[path]}


def pattern(
    label: str,
    gear: Gear,
    far: int,
    b: Fraction | None = None,
    target: Fraction | int = 0,
    margin: Fraction | int = MARGIN,
) -> Curve:
    """The ceiling by the distance to go, in km/h; `b` on a gradient, `target` in m/s."""
    rate = float(gear.b if b is None else b)
    places = [far * n / 120 for n in range(121)]
    held = [ceiling_float(max(x - float(margin), 0.0), rate, float(gear.t), float(target)) for x in places]
    return Curve(label, [(x, v / float(KMH)) for x, v in zip(places, held, strict=True)])


def steps(label: str, limits: Sequence[tuple[Fraction | int, Fraction | int]]) -> Curve:
    """A limit in km/h that changes where the train passes a place: each from its place on to that of the next."""
    corners: list[tuple[Fraction | int, Fraction | int]] = []
    for (place, limit), (until, _) in zip(limits, [*limits[1:], (0, 0)], strict=True):
        corners += [(place, limit), (until, limit)]
    return Curve(label, corners, marked=False)


def to_go(far: int, beyond: int = 0, point: str = "the signal") -> Axis:
    """The axis of the distance: the train runs to the right."""
    return Axis(f"distance to {point}", "m", low=-beyond, high=far, falling=True)


def speed(high: int) -> Axis:
    """The axis of the speed."""
    return Axis("speed", "km/h", low=0, high=high)


class Once:
    """Whether the train has just passed a place: true in the first cycle that finds it there or behind."""

    def __init__(self, place: Fraction | int) -> None:
        self.place, self.passed = place, False

    def __call__(self, x: Fraction) -> bool:
        """With the train at x."""
        now = not self.passed and x <= self.place
        self.passed |= now
        return now
