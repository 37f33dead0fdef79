"""Patterns: speed-distance diagrams of runs of the models, with the runs that overrun.

Source: principles [P]; brakes, distances, ladders [A].

Main results: under its ceiling the supervised train stops before the point, with traction in the reaction too; under
the plain ceiling it does not.  Markers as dimensioned stop every train, as drawn they do not, by 2.859 m.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from models.kinematics import (
    ACCELERATION,
    B_SERVICE,
    KMH,
    MARGIN,
    T_SERVICE,
    T_WARNING,
    ceiling_accelerating,
    effective,
    mps,
    root,
)
from models.patterns.markers import AS_DIMENSIONED, DRAWN, STOP_BEFORE, TOP, Markers, MarkersAsDrawn
from models.patterns.supervisor import Supervisor
from proofs.patterns_drawn import (
    BRAKES,
    EMERGENCY,
    SAMPLED,
    SERVICE,
    WARNING,
    Course,
    Gear,
    Once,
    Place,
    Row,
    drawn,
    drive,
    lines,
    pattern,
    speed,
    to_go,
)
from safety import run
from safety.exhibits import Curve, Mark, Points, Rule, plot
from safety.trace import Live, Trace

PLAIN = ("[A] b_s 2.5 km/h/s, t_s 2 s", "[A] b_e 3.5 km/h/s, t_e 1.5 s", "[A] margin 10 m", "[A] 100 km/h")

# --- discrete supervisor, one-stage pattern ---------------------------------------------------------------------------


def supervised(
    far: int,
    v: Fraction,
    settings: dict[str, Fraction | int],
    power: Fraction = ACCELERATION,
    margin: Fraction | int = 0,
) -> Course:
    """A run under the discrete-time supervisor, intervals of no width; the driver draws power until the brake acts."""
    live, warned, acted = Live(Supervisor, settings=settings), list[Place](), Once(0)

    def row(time: Fraction, x: Fraction, v: Fraction) -> Row:
        seen = {"v_lo": v, "v_hi": v, "x_lo": x - margin, "x_hi": x - margin, "acknowledged": False}
        return {f"seen.{name}": value for name, value in seen.items()}

    def on(shown: Row) -> dict[str, Gear]:
        acted.passed |= shown["service"]
        if shown["warning"] and not warned:
            warned.append((shown["seen.x_lo"] + margin, shown["seen.v_hi"] / KMH))
        return lines(shown, SAMPLED, service=SERVICE)

    def drives(x: Fraction, v: Fraction) -> Fraction:
        return power if v < TOP and (not acted.passed or live.state["braking"]) else Fraction(0)

    course = drive(live, far, v, row, on, drives)
    course.began += [(WARNING, place) for place in warned]
    return course


@plot(id="patterns_plots.one_stage", title="One-stage pattern: warning, service and emergency curve, gradients",
      requirement="SP-P1", assumed=PLAIN, x=to_go(900, 50, "the protected point"), y=speed(130),
      source="[P] target speed and distance; ceilings [D]")  # fmt: skip
def one_stage() -> Iterator[Mark]:
    """The ceilings, on the level and at 20 permille; a driver who coasts is warned, braked, and stands before it."""
    service = BRAKES[SERVICE]
    yield pattern("emergency", BRAKES[EMERGENCY], 900)
    yield pattern("service", service, 900)
    yield pattern("warning, 5 s before", Gear(service.b, service.t + T_WARNING), 900)
    yield pattern("service, 20 ‰ down", service, 900, Fraction(effective(B_SERVICE, -20)))
    yield pattern("service, 20 ‰ up", service, 900, Fraction(effective(B_SERVICE, 20)))
    yield pattern("service, to 65 km/h", service, 900, target=mps(65))
    yield from drawn({"driver passive": supervised(900, TOP, {"a": 0}, Fraction(0), MARGIN)})
    yield Rule("protected point", x=0)


# --- several ground markers ------------------------------------------------------------------------------------------

SAMPLES, FAR_BEYOND = 40, Fraction(-1000)  # of a stretch; m, beyond all stops


def braked(v: Fraction, x: Fraction, gear: Gear, until: Fraction) -> list[Place]:
    """From a place on: free run, then the brake, to another place or to standstill; m to go, km/h."""
    begins, last = x - v * gear.t, at_point(v, x, gear, until)
    speeds = [v + (last - v) * n / SAMPLES for n in range(SAMPLES + 1)]
    return [(x, v / KMH), *((begins - (v * v - each * each) / (2 * gear.b), each / KMH) for each in speeds)]


def at_point(v: Fraction, x: Fraction, gear: Gear, place: Fraction) -> Fraction:
    """The speed at a place of a train braked from x on, m/s; 0 where it stands before."""
    way = x - v * gear.t - place
    return v if way <= 0 else root(max(v * v - 2 * gear.b * way, Fraction(0))).low


def marker_run(model: type[Markers], laid: dict[str, Fraction], traction: Fraction = Fraction(0)) -> Course:
    """The worst driver: at Vmax into point 2, or with traction at A into it and at Vmax into point 3.

    What brakes is read off a run of the model, which also says whether it admits these speeds.
    """
    service, emergency = BRAKES[SERVICE], BRAKES[EMERGENCY]
    x2, x3 = laid["x2"], laid["x3"]
    if traction:
        speeds = [laid["level_a"], TOP, at_point(TOP, x3, service, STOP_BEFORE)]
    else:
        speeds = [TOP, at_point(TOP, x2, service, x3), at_point(TOP, x2, service, STOP_BEFORE)]
    rows = [{"v": v, "released": False, "acknowledged": False} for v in speeds]
    seen = run(model, rows, settings={**laid, "gains": traction})
    start = max(x for x, on in zip(seen["at"], seen["service"], strict=True) if on)
    v = speeds[seen["at"].index(start)]
    places = [(x2 + 100, speeds[0] / KMH), (x2, speeds[0] / KMH)]
    if traction:
        gained = [speeds[0] + (v - speeds[0]) * n / SAMPLES for n in range(SAMPLES + 1)]
        places += [(x2 - (each**2 - speeds[0] ** 2) / (2 * traction), each / KMH) for each in gained]
    places += braked(v, start, service, STOP_BEFORE) + braked(speeds[2], STOP_BEFORE, emergency, FAR_BEYOND)
    began = [(SERVICE, (start, v / KMH)), *((EMERGENCY, (x, speeds[2] / KMH)) for x in braking_at(seen))]
    return Course(places, began)


def braking_at(seen: Trace) -> list[Fraction]:
    """Where the emergency brake came, by the model."""
    return [x for x, on in zip(seen["at"], seen["emergency"], strict=True) if on]


def worst_runs() -> dict[str, Course]:
    """The worst driver of each scheme."""
    return {"as dimensioned": marker_run(Markers, AS_DIMENSIONED), "as drawn": marker_run(MarkersAsDrawn, DRAWN)}


OF_MARKERS = (*PLAIN[:2], "[A] l 50 m, B 30 km/h, Vmax 100 km/h")
LAID = [(AS_DIMENSIONED[x], AS_DIMENSIONED[level] / KMH) for x, level in (("x2", "level_a"), ("x3", "level_b"))]


@plot(id="patterns_plots.markers", title="Several ground markers: as dimensioned, as drawn, and with traction",
      requirement="SP-M1", assumed=OF_MARKERS, x=to_go(750, 230), y=speed(110),
      source="[P] points and levels; runs of the model")  # fmt: skip
def markers() -> Iterator[Mark]:
    """As dimensioned the train stops at the signal; as drawn, and with traction from A at point 2, beyond it."""
    yield from drawn(worst_runs() | {"traction": marker_run(Markers, AS_DIMENSIONED, ACCELERATION)})
    yield Points("check speed", LAID, ["2: A", "3: B"])
    yield Rule("4: stop here", x=STOP_BEFORE)
    yield Rule("signal", x=0)


@plot(id="patterns_plots.markers_near", title="Several ground markers: the last 60 m", requirement="SP-M1",
      assumed=OF_MARKERS, x=to_go(60, 10), y=speed(40),
      source="[P] point 2 where the standard curve meets the top speed; runs of the model")  # fmt: skip
def markers_near() -> Iterator[Mark]:
    """As drawn, point 4 is passed at 31.6 km/h, and the stop lies 2.859 m beyond the signal."""
    yield from drawn(worst_runs())
    yield Rule("4: stop here", x=STOP_BEFORE)
    yield Rule("signal", x=0)


# --- supervisor ------------------------------------------------------------------------------------------------------


@plot(id="patterns_plots.supervisor", title="Discrete supervisor: conservative and plain ceiling under traction",
      requirement="SP-P3", assumed=(*PLAIN[:2], "[A] traction 0.8 m/s^2"), x=to_go(500, 100, "the protected point"),
      y=speed(110), source="[A] supervisor with a cycle of 0.1 s; runs of the model")  # fmt: skip
def supervisor() -> Iterator[Mark]:
    """Traction goes on until the brake acts: the conservative ceiling allows for it, the plain one does not."""
    yield pattern("plain ceiling", BRAKES[SERVICE], 500, margin=0)
    yield Curve("conservative ceiling", [(x, conservative(x)) for x in range(500, -1, -5)])
    yield from drawn({"conservative": supervised(500, mps(50), {}), "plain": supervised(500, mps(50), {"a": 0})})
    yield Rule("protected point", x=0)


def conservative(x: int) -> float:
    """The conservative ceiling in km/h, cut at 0."""
    held = ceiling_accelerating(x, B_SERVICE, T_SERVICE, ACCELERATION, digits=6)
    return max(float(held.middle / KMH), 0.0)
