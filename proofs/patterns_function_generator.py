"""Function generator with gradient bins: how far the stops lie from the curve, and from which deceleration on +-25 m.

Speeds m/s, distances m, gradients permille (uphill positive).  The brake is applied once, where speed and curve are
equal; free run is the same on every gradient and cancels.
Source: +-20 permille in five curves, about +-25 m, one curve often more than 100 m apart [P]; decelerations [A].

Main results (SP-G1): with 3.4374 km/h/s or more every stop from up to 100 km/h lies within 25 m of the curve, in all
five bins; at 3.0 km/h/s it may be 35.11 m too long.  A selector that is one bin off breaks it at any deceleration
there is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction

from models.kinematics import KMH, G, effective
from models.patterns.function_generator import (
    CENTRES,
    FROM,
    STEEPEST,
    WIDTH,
    BrakeStart,
    deviation,
    gradient_of_spread,
    least_level,
    spread,
)
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Scenario,
    Seen,
    all_of,
    any_of_faults,
    at_most,
    claim,
    dead,
    implies,
    offset,
    once,
    open_circuit,
    previous,
    struck,
    stuck,
)
from safety.exhibits import Column, Row, table
from safety.prove.bounds import Bound, between, claim_bound, claim_bracket, magnitude, reals
from safety.prove.weakest import ABOVE, weakest_real

ENOUGH = Fraction("3.4374") * KMH  # m/s^2 [D]
MOST = 3  # m/s^2, of any brake
PRINTED = 25  # m [P]
SOURCE = "[P] about +-25 m in five curves; deceleration [A]"
v, b, i, off = reals("v b i off")


def stop_off(centre: Fraction, lowest: Fraction, rho: Fraction = Fraction(0)) -> Bound:
    """How far a stop of one bin lies from its curve: v^2/2 (1/b_i - 1/b_c), the speed up to 100 km/h."""
    on_curve, real_one = effective(b, centre, rho), effective(b, i, rho)
    return Bound(
        f"patterns_function_generator.stop_off_in_bin_{centre}".replace("-", "minus_"),
        f"Stop from up to 100 km/h off the curve of the bin {centre} permille, deceleration {float(lowest / KMH):g} "
        "km/h/s or more",
        magnitude(v * v * (on_curve - real_one)),
        (between(0, v, FROM), between(lowest, b, MOST), between(centre - WIDTH / 2, i, centre + WIDTH / 2)),
        2 * on_curve * real_one,
        unit="m",
        requirement="SP-G1",
        source=SOURCE,
        assumed=(f"[A] rotating masses {float(rho):g}", "[A] equal bins"),
    )


for _centre in CENTRES:
    _bound = stop_off(_centre, ENOUGH)
    _kept = claim_bound(_bound, PRINTED, expect=PROVED)
    claim_bound(_bound, 11, id=f"{_bound.id}_is_less", expect=REFUTED, twin_of=_kept)
    if _centre == CENTRES[0]:
        claim_bound(stop_off(_centre, 3 * KMH), PRINTED, id="patterns_function_generator.stop_off_at_3_kmh_s",
                    expect=REFUTED, twin_of=_kept, defeat=True)  # fmt: skip
claim_bracket(stop_off(CENTRES[0], 3 * KMH), id="patterns_function_generator.worst_stop_at_3_kmh_s")

_one_curve = Bound(
    "patterns_function_generator.spread_of_one_curve", "Spread of the stops from 100 km/h, one curve, +-20 permille",
    FROM * FROM * 2 * effective(0 * b, STEEPEST), (between(4 * KMH, b, Fraction("4.4846") * KMH),),
    2 * effective(b, STEEPEST) * effective(b, -STEEPEST), unit="m", requirement="SP-G1",
    source="[P] often more than 100 m", assumed=("[A] deceleration 4.0 to 4.4846 km/h/s",),
)  # fmt: skip
claim_bracket(_one_curve)

for _name, _centre, _rho in (
    ("", CENTRES[0], Fraction(0)), ("_level_bin", CENTRES[2], Fraction(0)),
    ("_rotating_6_percent", CENTRES[0], Fraction("0.06")), ("_rotating_10_percent", CENTRES[0], Fraction("0.10")),
):  # fmt: skip
    weakest_real(
        stop_off(_centre, Fraction(3, 4), _rho), PRINTED, b, safe=ABOVE, within=(Fraction(3, 4), Fraction(3, 2)),
        gap=Fraction(1, 10_000), unit="m/s^2", id=f"patterns_function_generator.least_deceleration{_name}",
        at={"bin": f"{_centre} permille", "rotating masses": f"{float(_rho):g}"},
    )  # fmt: skip

# --- the equipment ---------------------------------------------------------------------------------------------------

OPEN = ("level", "gradient")


def in_its_bin(s: Seen) -> Bit:
    """The ground signals the bin of the gradient."""
    return all_of(s.gradient - s.ground <= WIDTH / 2, s.ground - s.gradient <= WIDTH / 2)


def at_equality(s: Seen) -> Bit:
    """Speed and curve are compared without a gap: the brake is applied where they are equal."""
    return implies(s.comparator & ~s.braking, s.speed_generator * s.speed_generator == 2 * s.generator * s.x)


def strong_enough(s: Seen) -> Bit:
    """Level deceleration 3.4374 km/h/s or more."""
    return all_of(s.level >= ENOUGH)


def usual(s: Seen) -> Bit:
    """Compared without a gap, the ground signals the bin of the gradient, level deceleration 3.4374 km/h/s or more."""
    return at_equality(s) & in_its_bin(s) & strong_enough(s)


def stops_near_the_curve(s: Seen) -> Bit:
    """Where the brake is applied, at up to 100 km/h, the stop lies 25 m or less from its place."""
    actual = effective(s.level, s.gradient)
    doubled = s.v * s.v - 2 * actual * s.x
    near = (doubled <= 2 * PRINTED * actual) & (doubled >= -2 * PRINTED * actual)
    return implies(s.now & (s.v <= FROM), near)


STARTED = {"at_point_1": True, "v": 20, "x": lambda k: 20 * 20 / (2 * ENOUGH) if k else 1000}


@claim(BrakeStart, expect=PROVED, given=usual, symbolic=OPEN, requirement="SP-G1", source=SOURCE,
       witness=Scenario(2, STARTED, {"level": ENOUGH}))  # fmt: skip
def brake_once_stops_near_the_curve(s: Seen) -> Bit:
    """Where the brake is applied, at up to 100 km/h, the stop lies 25 m or less from its place, whatever the gradient
    in the bin that is signalled, with 3.4374 km/h/s or more."""
    return stops_near_the_curve(s)


def weaker(s: Seen) -> Bit:
    """Compared without a gap, the ground signals the bin, level deceleration 3.0 km/h/s or more."""
    return all_of(at_equality(s), in_its_bin(s), s.level >= 3 * KMH)


def run_at(level: Fraction, gradient: int, signalled: int) -> Scenario:
    """From 100 km/h along the curve that is signalled, on a gradient, braked from the point where they are equal."""
    place = FROM * FROM / (2 * effective(level, signalled))
    inputs = {"at_point_1": True, "v": FROM, "ground": signalled, "x": lambda k: place if k else 2 * place}
    return Scenario(2, inputs, {"level": level, "gradient": gradient})


@claim(BrakeStart, expect=REFUTED, defeat=True, given=weaker, symbolic=OPEN, requirement="SP-G1", source=SOURCE,
       twin_of=brake_once_stops_near_the_curve, scenario=run_at(3 * KMH, -20, -16))  # fmt: skip
def brake_once_stops_near_the_curve_at_3_kmh_s(s: Seen) -> Bit:
    """The same with 3.0 km/h/s or more.  False: at -20 permille on the curve of -16 the stop is 35.11 m too long."""
    return brake_once_stops_near_the_curve(s)


def any_bin(s: Seen) -> Bit:
    """Compared without a gap, level deceleration 3.4374 km/h/s or more; any of the five bins is signalled."""
    return at_equality(s) & strong_enough(s)


@claim(BrakeStart, expect=REFUTED, given=any_bin, symbolic=OPEN, requirement="SP-G1", source="[P] gradient signal",
       twin_of=brake_once_stops_near_the_curve, scenario=run_at(ENOUGH, -20, 0))  # fmt: skip
def brake_once_stops_near_the_curve_in_any_bin(s: Seen) -> Bit:
    """The same whichever bin is signalled.  False: this is the one curve without gradient signal."""
    return brake_once_stops_near_the_curve(s)


def with_gaps(s: Seen) -> Bit:
    """The ground signals the bin of the gradient, level deceleration 3.4374 km/h/s or more."""
    return in_its_bin(s) & strong_enough(s)


@claim(BrakeStart, expect=REFUTED, given=with_gaps, symbolic=OPEN, requirement="SP-G1",
       source="[P] compared at equality", twin_of=brake_once_stops_near_the_curve,
       scenario=Scenario(2, {"at_point_1": True, "v": FROM}, {"level": ENOUGH}))  # fmt: skip
def brake_once_stops_near_the_curve_with_gaps(s: Seen) -> Bit:
    """The same where speed and curve are compared now and then.  False: the brake comes late."""
    return brake_once_stops_near_the_curve(s)


def failing(name: str, fault: Fault, scenario: Scenario, also: Callable[[Seen], Bit]) -> None:
    """A part that fails to the wrong side is not tolerated: no brake at equality, or a stop too far."""

    def formula(s: Seen) -> Bit:
        over = implies(s.running & (s.v * s.v >= 2 * effective(s.level, s.ground) * s.x), s.brake)
        return over & stops_near_the_curve(s)

    formula.__name__ = f"brake_comes_and_stops_near_the_curve_{name}"
    formula.__doc__ = f"With one part failing ({fault.name}) the brake comes at the curve and stops near it.  False."
    claim(BrakeStart, expect=REFUTED, defeat=True, faults=at_most(1, [fault]), given=also, symbolic=OPEN,
          requirement="SP-G1", source="[A] component table", twin_of=brake_once_stops_near_the_curve,
          scenario=Scenario(scenario.steps, scenario.inputs, scenario.start, [fault.name]))(formula)  # fmt: skip


def one_bin_off() -> Scenario:
    """The ground signals -16, the selector takes -8: the brake is applied on that curve."""
    run = run_at(ENOUGH, -20, -8)
    return Scenario(2, {**run.inputs, "ground": -16}, run.start)


AT_CURVE = run_at(ENOUGH, 0, 0)
failing("with_a_bin_off", Fault(offset(8), ["gradient_selector"], ANY_TIME, name="wrong bin"), one_bin_off(), usual)
failing("with_no_speed", Fault(dead(), ["speed_generator"], ANY_TIME, name="speed reads 0"), AT_CURVE, usual)
failing("with_a_high_curve", Fault(offset(Fraction(1, 2)), ["generator"], ANY_TIME, name="generator high"), AT_CURVE,
        usual)  # fmt: skip
failing("with_a_comparator_stuck", Fault(stuck(0), ["comparator"], ANY_TIME, name="stuck below"), AT_CURVE, usual)
failing("with_a_valve_that_holds", Fault(stuck(1), ["valve"], ANY_TIME, name="does not vent"), AT_CURVE, usual)


@claim(BrakeStart, expect=PROVED, symbolic=OPEN, requirement="SP-G1", source="[P] applied once, no correction")
def brake_stays_on(s: Seen) -> Bit:
    """Once applied the brake stays, whatever speed, distance and gradient signal do."""
    return implies(previous(s.brake, False), s.brake & ~s.now)


def kept(s: Seen) -> Bit:
    """The registers keep that the generator runs, and the brake."""
    return all_of(s.running == once(s.at_point_1), s.braking == previous(s.brake, False))


@claim(BrakeStart, expect=PROVED, lemmas=[kept], symbolic=OPEN, requirement="SP-G1", source=SOURCE)
def brake_is_applied_just_at_the_curve(s: Seen) -> Bit:
    """From point 1 on the brake is applied as soon as the train is at the curve of the bin that is signalled, no
    sooner, and stays."""
    reached = s.v * s.v >= 2 * s.x * (s.level + G * s.ground / 1000)
    brake = previous(s.brake, False) | ((once(s.at_point_1) | s.at_point_1) & reached)
    return all_of(s.brake == brake, s.now == (brake & ~previous(s.brake, False)))


@claim(BrakeStart, expect=REFUTED, requirement="SP-G1", twin_of=brake_is_applied_just_at_the_curve)
def brake_is_applied_at_point_1(s: Seen) -> Bit:
    """The brake is applied at point 1."""
    return implies(s.at_point_1, s.brake)


@claim(BrakeStart, expect=REFUTED, requirement="SP-G1", twin_of=brake_stays_on)
def brake_is_never_applied(s: Seen) -> Bit:
    """The brake is never applied."""
    return all_of(~s.brake)


@claim(BrakeStart, expect=PROVED, symbolic=OPEN, requirement="SP-F1", source="[A] energise to release",
       faults=any_of_faults([Fault(open_circuit(), ["valve"], ANY_TIME, name="valve open")]))  # fmt: skip
def lost_line_brakes(s: Seen) -> Bit:
    """A valve's line that has lost its current brakes."""
    return implies(struck(s, "valve open"), s.brake)


@claim(BrakeStart, expect=REFUTED, requirement="SP-F1", twin_of=lost_line_brakes)
def generator_that_never_started_brakes(s: Seen) -> Bit:
    """Before point 1 a train above the curve brakes.  False: a point 1 that is missing is not noticed."""
    return implies(s.v * s.v > 2 * s.generator * s.x, s.brake)


# --- the table -------------------------------------------------------------------------------------------------------

DECELERATIONS = ("2.5", "3.0", "3.5", "4.0")  # km/h/s [A]
OFF = [Column(f"{name} {centre}", "m", decimals=2, assumed=True) for centre in CENTRES for name in ("long", "short")]
COLUMNS = [
    Column("deceleration", "km/h/s"), *OFF, Column("one curve", "m", decimals=1, assumed=True),
    Column("100 m at", "permille", decimals=2, assumed=True), Column("within 25 m"),
]  # fmt: skip
NOTE = (
    "Too long and too short by bin, from 100 km/h; spread of the stops with one curve, gradient at which it is 100 m."
)


@table(id="patterns_function_generator.bins", title="Stops off the curve of their gradient bin", requirement="SP-G1",
       source="[P] +-20 permille in five curves", note=NOTE, assumed=("[A] deceleration, equal bins",),
       columns=COLUMNS, says_no=("2.5: within 25 m", "3.0: within 25 m"))  # fmt: skip
def bins() -> Iterator[Row]:
    """One row a deceleration."""
    for text in DECELERATIONS:
        level = Fraction(text) * KMH
        off_curve = [part for centre in CENTRES for part in deviation(level, centre)]
        steepest = gradient_of_spread(100, level).middle
        yield text, *off_curve, spread(level), steepest, level >= least_level(CENTRES[0], PRINTED).high
