"""Patterns of the 1961 paper: speed-distance diagrams of runs of the models, with the runs that overrun.

Source: limits, points, curves by gradient [P]; brakes, distances, ladder [A].

Main results: a red signal that is acknowledged is passed at 15 mph.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from math import sqrt

from models.kinematics import CYCLE, KMH, distance, effective, mps
from models.patterns.code_control import CLEAR, DECELERATION, FREE_RUN, LIMITS, CodeControl
from models.patterns.function_generator import CENTRES, FROM, BrakeStart
from models.patterns.ground_program import BASE, GroundProgram
from models.patterns.point_continuous import DECELERATION as BRAKED
from models.patterns.point_continuous import FREE_RUN as IDLE
from models.patterns.point_continuous import LIMITS as SOVIET_LIMITS
from models.patterns.point_continuous import WAYS, PointAndContinuous
from models.patterns.stepped_limiter import FREE_RUN as IDLING
from models.patterns.stepped_limiter import H_ON, LADDER, LENGTHS, SteppedLimiter
from models.patterns.stepped_limiter import PRINTED as SHORT
from proofs.patterns_drawn import EMERGENCY, SERVICE, Course, Gear, Once, Row, drawn, drive, lines, speed, steps, to_go
from safety.exhibits import Curve, Mark, Points, Rule, plot
from safety.trace import Live

# --- American code control -------------------------------------------------------------------------------------------

B_POINT, SLOWED, SLOWING = Fraction("137.61"), Fraction("293.50"), Fraction("1132.41")  # m: brake distances [A]
PLACES = (B_POINT, B_POINT + SLOWED, B_POINT + SLOWED + SLOWING)  # where red, approach, approach medium begin
CAB_GEAR = {name: Gear(DECELERATION, FREE_RUN) for name in (SERVICE, EMERGENCY)}
RUN_UP = 200  # m


def with_cab_signals(acknowledges: bool) -> Course:
    """A run to a stop signal; the driver coasts, and presses the button once red has come, or not."""
    red, live = Once(B_POINT), Live(CodeControl)
    live.step({"code": CLEAR, "button": False, "v": 0, "now": 0})

    def row(time: Fraction, x: Fraction, v: Fraction) -> Row:
        red(x)
        code = sum(x > place for place in PLACES)
        return {"code": code, "button": acknowledges and red.passed and x < B_POINT - 5, "v": v, "now": time}

    def on(shown: Row) -> dict[str, Gear]:
        return lines(shown, CAB_GEAR, brake=SERVICE, emergency=EMERGENCY)

    return drive(live, PLACES[-1] + RUN_UP, LIMITS[CLEAR], row, on)


@plot(id="patterns_plots.code_control", title="American code control: B point, acknowledgement, and who creeps on",
      requirement="SP-X3", assumed=("[A] 0.6 m/s^2 after 3 s, 6 s to acknowledge",), x=to_go(1800, 200), y=speed(160),
      source="[P] 90, 45, 25, 15 mph, B point; runs of the model")  # fmt: skip
def code_control() -> Iterator[Mark]:
    """Both drivers coast; one acknowledges the red signal and passes it at 15 mph."""
    limits = [(PLACES[-1] + RUN_UP, LIMITS[3]), (PLACES[2], LIMITS[2]), (PLACES[1], LIMITS[1]), (PLACES[0], LIMITS[0])]
    yield steps("limit", [(place, limit / KMH) for place, limit in limits])
    runs = {"no acknowledgement": with_cab_signals(False), "acknowledged": with_cab_signals(True)}
    yield from drawn(runs)
    yield Points("B point", [(B_POINT, 0)], ["B point"])
    yield Rule("stop signal", x=0)


# --- brake start with a function generator ---------------------------------------------------------------------------

LEVEL = mps(3)  # m/s^2, 3.0 km/h/s [A]: at which the bin that falls most is out by 35.11 m
SAMPLES = 40
START = Fraction(650)  # m


def with_generator(gradient: int, curve: Fraction) -> Course:
    """A run at 100 km/h on a gradient with the curve of a bin: the brake comes once, with constant force."""
    live = Live(BrakeStart, settings={"level": LEVEL, "gradient": gradient})
    met = FROM * FROM / (2 * effective(LEVEL, curve))
    compared = (START, met)
    shown = [live.shown({"v": FROM, "x": x, "at_point_1": True, "ground": curve}) for x in compared]
    (begun,) = (x for x, each in zip(compared, shown, strict=True) if each["now"])
    slowed = [FROM * n / SAMPLES for n in range(SAMPLES, -1, -1)]
    places = [(begun - distance(FROM, effective(LEVEL, gradient), 0, v), v / KMH) for v in slowed]
    return Course([(START, FROM / KMH), *places], [(SERVICE, places[0])])


@plot(id="patterns_plots.function_generator", title="Function generator: stops on other gradients than the curve's",
      requirement="SP-G1", assumed=("[A] 3.0 km/h/s", "[A] bins of 8 ‰"), x=to_go(650, 190, "the stop"), y=speed(110),
      source="[P] five curves, brake applied once with constant force; runs of the model")  # fmt: skip
def function_generator() -> Iterator[Mark]:
    """In the steepest bin the stop is up to 35.11 m beyond, or 31.26 m short; with the level curve far more."""
    for centre in CENTRES:
        speeds = [FROM * n / SAMPLES for n in range(SAMPLES + 1)]
        along = [(v * v / (2 * effective(LEVEL, centre)), v / KMH) for v in speeds]
        yield Curve(f"curve {int(centre)} ‰", along, marked=False)
    level, steep = CENTRES[2], CENTRES[0]
    runs = {"-20 ‰, curve -16": with_generator(-20, steep), "-12 ‰, curve -16": with_generator(-12, steep)}
    yield from drawn(runs | {"-20 ‰, curve 0": with_generator(-20, level)})
    yield Rule("the stop", x=0)


# --- Soviet point and continuous control -----------------------------------------------------------------------------

AT_D = sum(WAYS)  # m from A to D
INDUCTORS = {"a": AT_D, "b": AT_D - WAYS[0], "c": WAYS[2], "d": Fraction(0)}  # m before D
SOVIET_GEAR = {SERVICE: Gear(BRAKED, IDLE - CYCLE)}  # less the cycle of sampling


def with_inductors(missing: str = "") -> Course:
    """A run at 40 km/h past A; the channel says clear before it, and carries nothing behind D."""
    live = Live(PointAndContinuous)
    there = {name: Once(place) for name, place in INDUCTORS.items()}
    live.step({**{f"passed.{name}": False for name in there}, "clear": True, "current": True, "v": 0})

    def row(time: Fraction, x: Fraction, v: Fraction) -> Row:
        passed = {f"passed.{name}": once(x) and name not in missing for name, once in there.items()}
        return {**passed, "clear": x > AT_D, "current": x > 0, "v": v}

    return drive(live, AT_D + 40, mps(40), row, lambda shown: lines(shown, SOVIET_GEAR, brake=SERVICE))


@plot(id="patterns_plots.point_and_continuous", title="Soviet inductors: 40, 25, 15 km/h, stop; and with one missing",
      assumed=("[A] 0.5 m/s^2 after 2 s",), x=to_go(220, 100, "D"), y=speed(50),
      source="[P] limits and points; runs of the model")  # fmt: skip
def point_and_continuous() -> Iterator[Mark]:
    """With all inductors the train stands at D; with C missing it passes D, and the channel stops it."""
    yield from drawn({"all inductors": with_inductors(), "C missing": with_inductors("c")})
    names = [f"{name.upper()}: {int(v / KMH)}" for name, v in zip(INDUCTORS, SOVIET_LIMITS, strict=True)]
    yield Points("inductor and its limit", [(place, 0) for place in INDUCTORS.values()], names)
    yield Rule("D", x=0)


# --- stepped high-speed limiter --------------------------------------------------------------------------------------

PUSH = Fraction("0.3")  # m/s^2: the driver keeps at the highest speed that the limiter leaves


def with_limiter(lengths: Sequence[Fraction]) -> Course:
    """A run down the ladder; the driver draws power wherever the brake is off and does not yet come."""
    ends = [sum(lengths[k:], Fraction(0)) for k in range(len(lengths))]
    live = Live(SteppedLimiter)

    def limit(x: Fraction) -> Fraction:
        return LADDER[sum(x <= end for end in ends)]

    def on(shown: Row) -> dict[str, Gear]:
        return {SERVICE: Gear(shown["force"], IDLING - CYCLE)} if shown["brake"] else {}

    def power(x: Fraction, v: Fraction) -> Fraction:
        return PUSH if v + PUSH * CYCLE <= limit(x) + H_ON else Fraction(0)

    return drive(live, ends[0] + 300, LADDER[0] + H_ON, lambda time, x, v: {"signal": limit(x), "v": v}, on, power)


@plot(id="patterns_plots.limiter", title="Stepped limiter: sections from V + 2 km/h, and from V as in the ladder",
      requirement="SP-S1", assumed=("[A] ladder, forces, 2 s, dead band 2 and 1 km/h",), x=to_go(4200, 150, "the stop"),
      y=speed(230), source="[P] a brake force for each step; runs of the model")  # fmt: skip
def limiter() -> Iterator[Mark]:
    """Entered at 2 km/h above the limit before, as the dead band admits, the sections of the ladder are too short."""
    ends = [sum(LENGTHS[k:], Fraction(0)) for k in range(len(LENGTHS))]
    limits = [(end, v / KMH) for end, v in zip([ends[0] + 300, *ends], LADDER, strict=True)]
    yield steps("limit", limits)
    yield from drawn({"from V + 2 km/h": with_limiter(LENGTHS), "from V": with_limiter(SHORT)})
    yield Rule("the stop", x=0)


# --- ground program by pulse spacing ---------------------------------------------------------------------------------

POWER, BRAKE = 0.5, 0.7  # m/s^2 [A]
GRAIN = 10**6  # parts of a second in a time stamp
LAID = ((900, 60.0), (500, 60.0), (250, 30.0), (0, 30.0))  # m to the end of the program, km/h [A]


def program(x: float) -> float:
    """The speed that the program has laid at a place, km/h: v^2 falls evenly between two of its points."""
    for (far, before), (near, after) in pairwise(LAID):
        if x >= near:
            share = (x - near) / (far - near)
            return float(sqrt(after**2 + share * (before**2 - after**2)))
    return LAID[-1][1]


def with_program(start: float, every: int = 1) -> Course:
    """A run over the crossings from a speed in km/h; the receiver sees each of them, or every second one."""
    live, course, x, v, now = Live(GroundProgram), Course(), float(LAID[0][0]), start * float(KMH), 0.0
    shown: Row = {"power": False, "brake": False}
    crossing = 0
    while True:
        crossing += 1
        course.places.append((Fraction(x), Fraction(v) / KMH))
        way, a = program(x) * float(KMH * BASE), POWER if shown["power"] else -BRAKE if shown["brake"] else 0.0
        if x < way or v * v + 2 * a * way <= 0:
            return course
        v, before = sqrt(v * v + 2 * a * way), v
        now, x = now + 2 * way / (before + v), x - way
        seen = {"pulse": crossing % every == 0, "now": Fraction(round(now * GRAIN), GRAIN), "departs": crossing == 1}
        shown, braked = live.shown(seen), shown["brake"]
        if shown["brake"] and not braked:
            course.began.append((SERVICE, (Fraction(x), Fraction(v) / KMH)))


@plot(id="patterns_plots.ground_program", title="Ground program: the spacing of the crossings is the speed",
      requirement="SP-F1", assumed=("[A] 0.3 s, dead band 5 %, 0.5 and 0.7 m/s^2",), y=speed(120),
      x=to_go(900, 0, "the end of the program"), source="[P] spacing by program speed; runs of the model")  # fmt: skip
def ground_program() -> Iterator[Mark]:
    """From 75 and from 45 km/h the train comes to the program; with every second pulse missed it is far too fast."""
    yield Curve("program", [(x, program(x)) for x in range(LAID[0][0], -1, -5)])
    runs = {"from 75": with_program(75), "from 45": with_program(45), "pulses missed": with_program(60, 2)}
    yield from drawn(runs)
