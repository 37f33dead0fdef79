"""Several ground markers: no train passes the signal, whatever the driver does, if point 2 allows for the free run.

Speeds m/s, distances m before the signal.  A step is the passing of a point; the speed there is anything that brakes,
traction and line admit, and the markers follow each other for ever.
Source: points and levels [P]; dimensioning, brakes [A].

Main results (SP-M1): for all values of l, Vmax, A, B, brakes and free runs that keep the inequalities of the
dimensioning no train passes 4 faster than v4max, and from there the emergency brake stops it before the signal.  With
point 2 as drawn the signal is overrun by 2.859 m, with traction between 2 and 4 by 204.039 m.  On a downgrade the
stretched spacing does not help a train that rolls.  x2, x3, A cannot be eased by 1 cm or 1 mm/s.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

from models.kinematics import (
    ACCELERATION,
    B_EMERGENCY,
    B_SERVICE,
    T_EMERGENCY,
    T_SERVICE,
    G,
    need,
    root,
    stops_within,
)
from models.patterns.markers import AS_DIMENSIONED, DRAWN, RELEASE, STOP_BEFORE, TOP, Markers, MarkersAsDrawn, Scheme
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Real,
    Scenario,
    Seen,
    all_of,
    at_most,
    claim,
    implies,
    real,
    select,
    stuck,
)
from safety.prove.bounds import Bound, between, claim_bound, claim_bracket, reals
from safety.prove.laws import law
from safety.prove.weakest import ABOVE, BELOW, weakest_real

SOURCE = "[P] points and levels; [A] dimensioning"
SIZES = (
    "top", "stop_before", "level_a", "level_b", "fastest", "x2", "x3", "b_service", "t_service", "b_emergency",
    "t_emergency",
)  # fmt: skip

# --- the algebra -----------------------------------------------------------------------------------------------------


@law(expect=PROVED, requirement="SP-M1", source="[D] constant deceleration")
def brake_that_suffices_from_the_top_suffices(
    v: Real, top: Real, b: Real, t: Real, way: Real, fastest: Real, reached: Real
) -> Bit:
    """Where braking from a top speed comes down to v4max in time, so does braking from any lower speed."""
    known = (v >= 0) & (v <= top) & (b > 0) & (t >= 0) & (fastest >= 0) & (reached >= 0)
    laid = need(top, b, t, fastest) <= 2 * b * way
    return implies(known & laid & (need(v, b, t, reached) >= 2 * b * way), reached <= fastest)


@law(expect=PROVED, requirement="SP-M1", source="[D] deceleration b or more")
def stronger_brake_needs_no_longer_way(v: Real, b: Real, d: Real, t: Real, way: Real, reached: Real) -> Bit:
    """What a brake of b or more leaves of the speed after a way, a brake of b leaves, too."""
    known = (v >= 0) & (b > 0) & (d >= b) & (t >= 0) & (reached >= 0) & (reached <= v)
    return implies(known & (need(v, d, t, reached) >= 2 * d * way), need(v, b, t, reached) >= 2 * b * way)


@law(expect=REFUTED, requirement="SP-M1", twin_of=stronger_brake_needs_no_longer_way)
def weaker_brake_needs_no_longer_way(v: Real, b: Real, d: Real, t: Real, way: Real, reached: Real) -> Bit:
    """The same of a brake that gives less than b.  False."""
    known = (v >= 0) & (b > 0) & (d > 0) & (t >= 0) & (reached >= 0) & (reached <= v)
    return implies(known & (need(v, d, t, reached) >= 2 * d * way), need(v, b, t, reached) >= 2 * b * way)


@law(expect=REFUTED, requirement="SP-M1", twin_of=brake_that_suffices_from_the_top_suffices)
def faster_train_is_braked_in_time(
    v: Real, top: Real, b: Real, t: Real, way: Real, fastest: Real, reached: Real
) -> Bit:
    """The same of a train that is faster than Vmax.  False."""
    known = (v >= 0) & (top >= 0) & (b > 0) & (t >= 0) & (fastest >= 0) & (reached >= 0)
    laid = need(top, b, t, fastest) <= 2 * b * way
    return implies(known & laid & (need(v, b, t, reached) >= 2 * b * way), reached <= fastest)


@law(expect=REFUTED, requirement="SP-M1", twin_of=brake_that_suffices_from_the_top_suffices)
def brake_without_free_run_suffices(
    v: Real, top: Real, b: Real, t: Real, way: Real, fastest: Real, reached: Real
) -> Bit:
    """The same where the way allows for no free run.  False: point 2 as drawn."""
    known = (v >= 0) & (v <= top) & (b > 0) & (t >= 0) & (fastest >= 0) & (reached >= 0)
    laid = need(top, b, 0 * t, fastest) <= 2 * b * way
    return implies(known & laid & (need(v, b, t, reached) >= 2 * b * way), reached <= fastest)


@law(expect=PROVED, requirement="SP-M1", source="[P] emergency brake at 4; [A] v4max")
def emergency_brake_from_v4max_stops(v: Real, fastest: Real, b: Real, t: Real, ahead: Real) -> Bit:
    """Who passes 4 at v4max or less stops before the signal, whatever l, the emergency brake and its free run are."""
    known = (v >= 0) & (v <= fastest) & (b > 0) & (t >= 0)
    return implies(known & stops_within(fastest, ahead, b, t), stops_within(v, ahead, b, t))


@law(expect=REFUTED, requirement="SP-M1", twin_of=emergency_brake_from_v4max_stops)
def emergency_brake_from_b_above_v4max_stops(v: Real, fastest: Real, b: Real, t: Real, ahead: Real) -> Bit:
    """The same of a train released at a B that is above v4max.  False."""
    known = (v >= 0) & (fastest >= 0) & (b > 0) & (t >= 0)
    return implies(known & stops_within(fastest, ahead, b, t), stops_within(v, ahead, b, t))


@law(expect=PROVED, requirement="SP-M1", source="[P] the curve that meets B at 3 meets A at 2")
def driver_on_the_curve_is_left_alone(a: Real, b: Real, d: Real, way: Real, v2: Real, v3: Real) -> Bit:
    """A driver who brakes along the standard curve and is at B or less at 3 has been at A or less at 2."""
    known = (a >= 0) & (b >= 0) & (d > 0) & (v2 >= 0) & (v3 >= 0) & (v3 <= b)
    return implies(known & (a * a >= b * b + 2 * d * way) & (v2 * v2 == v3 * v3 + 2 * d * way), v2 <= a)


@law(expect=REFUTED, requirement="SP-M1", twin_of=driver_on_the_curve_is_left_alone)
def driver_off_the_curve_is_left_alone(a: Real, b: Real, d: Real, way: Real, v2: Real, v3: Real) -> Bit:
    """The same with A below the curve.  False."""
    known = (a >= b) & (b >= 0) & (d > 0) & (v2 >= 0) & (v3 >= 0) & (v3 <= b)
    return implies(known & (v2 * v2 == v3 * v3 + 2 * d * way), v2 <= a)


# --- SP-M1, all sizes ------------------------------------------------------------------------------------------------


class Sized:
    """Signals and sizes under one name: those left open are signals, the others numbers."""

    def __init__(self, s: Seen, sizes: Mapping[str, Fraction]) -> None:
        self._s, self._sizes = s, sizes

    def __getattr__(self, name: str) -> Any:
        return real(self._sizes[name]) if name in self._sizes else self._s[name]


Formula = Callable[[Any], Bit]


def sized(formula: Formula, sizes: Mapping[str, Fraction]) -> Formula:
    """A formula with the sizes given."""

    def of_the_sizes(s: Seen) -> Bit:
        return formula(Sized(s, sizes))

    of_the_sizes.__name__, of_the_sizes.__doc__ = formula.__name__, formula.__doc__
    return of_the_sizes


def brakes_as_guaranteed(s: Any) -> Bit:
    """The service brake, once ordered, gives b_s after t_s, and is held until the speed is B or less; no traction
    then."""
    slowed = need(s.began_v, s.b_service, s.t_service, s.v) >= 2 * s.b_service * (s.began_x - s.at)
    return implies(s.braking, select(s.released, s.v <= s.level_b, slowed & (s.v <= s.began_v)))


def order_of_points(s: Any) -> Bit:
    """Point 3 comes after point 2; between two signals nothing is left of the brake."""
    order = implies(s.past_3, s.past_2) & implies(~s.past_2, ~s.braking)
    return all_of(order, s.before >= 0, s.began_v >= 0)


def braked_from_a_point(s: Any) -> Bit:
    """The service brake has been on from point 2, from Vmax or less, or from point 3, from A or less."""
    from_2 = (s.began_x == s.x2) & (s.began_v <= s.top)
    from_3 = (s.began_x == s.x3) & (s.began_v <= s.level_a)
    return implies(s.braking, from_2 | (s.past_3 & from_3))


def slow_without_brake(s: Any) -> Bit:
    """Without it point 2 was passed at A or less, point 3 at B or less."""
    return implies(s.past_2 & ~s.braking, s.before <= select(s.past_3, s.level_b, s.level_a))


LEMMAS = [order_of_points, braked_from_a_point, slow_without_brake]
AT_B = Scenario(3, {"v": RELEASE})
ACKNOWLEDGED = Scenario(3, {"v": RELEASE, "acknowledged": True})


@claim(Markers, expect=PROVED, given=brakes_as_guaranteed, lemmas=LEMMAS, symbolic=SIZES, requirement="SP-M1",
       source=SOURCE, witness=AT_B)  # fmt: skip
def point_4_is_passed_at_v4max_or_less(s: Seen) -> Bit:
    """Whoever enters at Vmax or less, and brakes or not as they like, passes 4 at v4max or less: for all lengths,
    levels and brakes that keep the dimensioning."""
    return implies(s.past_3, s.v <= s.fastest)


@claim(Markers, expect=PROVED, symbolic=SIZES, requirement="SP-M1", source="[P] emergency brake at 4", witness=AT_B)
def emergency_brake_comes_at_4(s: Seen) -> Bit:
    """Who passes 4 without a stop acknowledged gets the emergency brake, whatever the sizes."""
    return implies(s.past_3 & ~s.acknowledged, s.emergency)


@claim(Markers, expect=REFUTED, requirement="SP-M1", twin_of=emergency_brake_comes_at_4, scenario=AT_B)
def emergency_brake_comes_at_every_point(s: Seen) -> Bit:
    """Who passes any point gets the emergency brake."""
    return all_of(s.emergency)


# --- SP-M1, the sizes given -------------------------------------------------------------------------------------------


def acknowledged_at_rest(s: Seen) -> Bit:
    """A stop is acknowledged at standstill only."""
    return implies(s.acknowledged, s.v <= 0)


def stopped(s: Seen, ahead: Fraction = STOP_BEFORE, b: Fraction = B_EMERGENCY) -> Bit:
    """At 4 the train stands, or the emergency brake comes and stops it before the signal."""
    return implies(s.past_3, (s.v <= 0) | (s.emergency & stops_within(s.v, ahead, b, T_EMERGENCY)))


def lemmas_of(sizes: Mapping[str, Fraction]) -> list[Formula]:
    """The lemmas with the sizes given."""
    return [sized(lemma, sizes) for lemma in LEMMAS]


def by_the_rules(sizes: Mapping[str, Fraction]) -> Formula:
    """What is given, with the sizes given."""

    def rules(s: Seen) -> Bit:
        return acknowledged_at_rest(s) & brakes_as_guaranteed(Sized(s, sizes))

    rules.__doc__ = f"{acknowledged_at_rest.__doc__} {brakes_as_guaranteed.__doc__}"
    return rules


GIVEN = {**AS_DIMENSIONED, "t_service": T_SERVICE}
RULES = by_the_rules(GIVEN)


@claim(Markers, expect=PROVED, given=RULES, lemmas=lemmas_of(GIVEN), requirement="SP-M1",
       source=SOURCE, witness=AT_B)  # fmt: skip
def no_train_passes_the_signal(s: Seen) -> Bit:
    """Whoever enters at Vmax or less, and brakes or not as they like, is stopped before the signal."""
    return stopped(s)


def braked(v: Fraction, ways: list[Fraction], b: Fraction = B_SERVICE) -> Callable[[int], Fraction]:
    """The greatest speeds that the service brake, ordered at v, leaves after these ways, one a step; from below."""
    speeds = [root(v * v + 2 * b * v * T_SERVICE - 2 * b * way).low if way > v * T_SERVICE else v for way in ways]
    return lambda k: speeds[min(k, len(speeds) - 1)]


def from_2(sizes: dict[str, Fraction]) -> Scenario:
    """Vmax at 2, and the service brake from there to 4."""
    ways = [Fraction(0), sizes["x2"] - sizes["x3"], sizes["x2"] - sizes["stop_before"]]
    return Scenario(3, {"v": braked(sizes["top"], ways, sizes["b_service"])})


@claim(MarkersAsDrawn, expect=REFUTED, defeat=True, requirement="SP-M1", source="[P] point 2 on the standard curve",
       given=by_the_rules({**DRAWN, "t_service": T_SERVICE}), twin_of=no_train_passes_the_signal,
       scenario=from_2(DRAWN))  # fmt: skip
def no_train_passes_the_signal_as_drawn(s: Seen) -> Bit:
    """With point 2 where the standard curve meets the top speed, no train passes the signal.  False: without free run
    in it a train at Vmax is at 31.623 km/h at 4 and overruns the signal by 2.859 m, if the service brake in progress
    is not credited during the free run of the emergency brake; if it is, 43.224 m of the 50 suffice."""
    return stopped(s)


AT_4 = braked(TOP, [AS_DIMENSIONED["x3"] - STOP_BEFORE])(0)
NO_BRAKE_TO_3 = Scenario(3, {"v": lambda k: [AS_DIMENSIONED["level_a"], TOP, AT_4][min(k, 2)]})


@claim(Markers, expect=REFUTED, defeat=True, given=RULES, settings={"gains": ACCELERATION}, requirement="SP-M1",
       source="[A] 0.8 m/s^2 from A at 2", twin_of=no_train_passes_the_signal, scenario=NO_BRAKE_TO_3)  # fmt: skip
def no_train_passes_the_signal_with_traction(s: Seen) -> Bit:
    """With traction from 2 to 4 no train passes the signal.  False: who passes 2 at A and accelerates has Vmax at 3,
    74.933 km/h at 4, and overruns by 204.039 m."""
    return stopped(s)


@claim(Markers, expect=REFUTED, given=sized(brakes_as_guaranteed, GIVEN), requirement="SP-M1", scenario=ACKNOWLEDGED,
       source="[P] stop acknowledgement", twin_of=no_train_passes_the_signal)  # fmt: skip
def no_train_passes_the_signal_whenever_acknowledged(s: Seen) -> Bit:
    """The same where a stop may be acknowledged in motion.  False: no emergency brake comes."""
    return stopped(s)


@claim(Markers, expect=REFUTED, given=acknowledged_at_rest, requirement="SP-M1", scenario=Scenario(3, {"v": TOP}),
       source="[A] brake as guaranteed", twin_of=no_train_passes_the_signal)  # fmt: skip
def no_train_passes_the_signal_whatever_the_brake_gives(s: Seen) -> Bit:
    """The same where the service brake gives less than guaranteed, or is let go before B.  False."""
    return stopped(s)


def failing(name: str, what: str, at: str, value: int, scenario: Scenario) -> None:
    """A part that fails to the wrong side is not tolerated."""

    def formula(s: Seen) -> Bit:
        return stopped(s)

    formula.__name__ = f"no_train_passes_the_signal_{name}"
    formula.__doc__ = f"With one part failing ({what}) no train passes the signal.  False: no second one watches it."
    fault = Fault(stuck(value), [at], ANY_TIME, name=what)
    claim(Markers, expect=REFUTED, defeat=True, faults=at_most(1, [fault]), given=RULES,
          requirement="SP-M1", source="[A] component table", twin_of=no_train_passes_the_signal,
          scenario=Scenario(3, scenario.inputs, present=[what]))(formula)  # fmt: skip


failing("without_service_brake", "service valve does not vent", "service_valve", 1, Scenario(3, {"v": TOP}))
failing("without_emergency_brake", "emergency valve does not vent", "emergency_valve", 1, AT_B)
failing("without_point_4", "track coil of point 4 missing", "point_4", 0, AT_B)
LATE = Scenario(3, {"v": lambda k: TOP if k < 2 else NO_BRAKE_TO_3.inputs["v"](k)})
failing("without_check_at_2", "comparator at 2 stuck below", "comparator_2", 0, LATE)


# --- on a downgrade --------------------------------------------------------------------------------------------------

STEEP = Scheme(stop_before=Fraction(60), gradient=-20).settings()
ON_STEEP = {**STEEP, "t_service": T_SERVICE}
ROLLS = G * 20 / 1000  # m/s^2


def stopped_on_the_downgrade(s: Seen) -> Bit:
    """As on the level, with the brakes that are left."""
    return stopped(s, STEEP["stop_before"], STEEP["b_emergency"])


@claim(Markers, expect=PROVED, given=by_the_rules(ON_STEEP), settings=STEEP, lemmas=lemmas_of(ON_STEEP),
       requirement="SP-M1", source="[P] spacing stretched with the gradient", witness=AT_B)  # fmt: skip
def no_train_passes_the_signal_at_20_down(s: Seen) -> Bit:
    """With the spacing stretched for a downgrade of 20 permille, and a train that is held at its speed between the
    points, no train passes the signal."""
    return stopped_on_the_downgrade(s)


def rolling() -> Scenario:
    """A at 2, no brake: faster at 3 by what the gradient gives, and from there the service brake."""
    at_3 = root(STEEP["level_a"] ** 2 + 2 * ROLLS * (STEEP["x2"] - STEEP["x3"])).low
    at_4 = braked(at_3, [STEEP["x3"] - STEEP["stop_before"]], STEEP["b_service"])(0)
    return Scenario(3, {"v": lambda k: [STEEP["level_a"], at_3, at_4][min(k, 2)]})


@claim(Markers, expect=REFUTED, defeat=True, given=by_the_rules(ON_STEEP), settings={**STEEP, "gains": ROLLS},
       requirement="SP-M1", source="[P] spacing stretched with the gradient", scenario=rolling(),
       twin_of=no_train_passes_the_signal_at_20_down)  # fmt: skip
def no_train_that_rolls_passes_the_signal_at_20_down(s: Seen) -> Bit:
    """With the spacing stretched likewise no train passes the signal that rolls without traction.  False: who passes 2
    at A, and rolls, is too fast at 3."""
    return no_train_passes_the_signal_at_20_down(s)


# --- point X ---------------------------------------------------------------------------------------------------------

v0, v4, x2, x3, a, ahead = reals("v0 v4 x2 x3 a ahead")
POINT_X = Bound(
    "patterns_markers.brakes_at_1_and_never_eases", "Way from point 1 of a driver who brakes there and never eases",
    2 * B_SERVICE * T_SERVICE * v0 + v0 * v0, (between(0, v0, TOP),), 2 * B_SERVICE + 0 * v0, unit="m",
    requirement="SP-M1", source="[P] point X", assumed=("[A] b_s, t_s, Vmax",),
)  # fmt: skip
stops_short = claim_bound(POINT_X, Fraction(612), expect=PROVED)
claim_bound(POINT_X, Fraction(611), id=f"{POINT_X.id}_is_less", expect=REFUTED, twin_of=stops_short)

# --- how far the sizes may go ----------------------------------------------------------------------------------------


def beyond(
    name: str, what: str, start: Real | Fraction, way: Real | Fraction, room: Real | Fraction, *given: Bit
) -> Bound:
    """Way of the emergency brake from 4 beyond the signal, times 2 b_e; the service brake on from a point before."""
    held = (between(0, v4, TOP), between(0, v0, TOP), v4 <= v0, v0 <= start, *given,
            need(v0, B_SERVICE, T_SERVICE, v4) >= 2 * B_SERVICE * way)  # fmt: skip
    return Bound(
        f"patterns_markers.{name}", f"Overrun of the signal, {what}", need(v4, B_EMERGENCY, T_EMERGENCY)
        - 2 * B_EMERGENCY * room, held, 2 * B_EMERGENCY + 0 * v4, unit="m", requirement="SP-M1", source=SOURCE,
        assumed=("[A] l, Vmax, B, brakes",),
    )  # fmt: skip


CM, KEPT = Fraction(1, 100), AS_DIMENSIONED
claim_bracket(beyond("overrun_as_drawn", "point 2 as drawn", TOP, TOP * TOP / (2 * B_SERVICE), STOP_BEFORE))
claim_bracket(beyond("overrun_with_traction", "Vmax at point 3", TOP, KEPT["x3"] - STOP_BEFORE, STOP_BEFORE))
weakest_real(
    beyond("x2", "service brake from Vmax at point 2", TOP, x2 - STOP_BEFORE, STOP_BEFORE, between(560, x2, 660)),
    0, x2, safe=ABOVE, within=(560, 660), gap=CM, unit="m", id="patterns_markers.least_x2", at={"l": "50 m"},
)  # fmt: skip
weakest_real(
    beyond("x3", "service brake from A at point 3", KEPT["level_a"], x3 - STOP_BEFORE, STOP_BEFORE,
           between(300, x3, 400)), 0, x3, safe=ABOVE, within=(300, 400), gap=CM, unit="m",
    id="patterns_markers.least_x3", at={"A": "74.677 km/h"},
)  # fmt: skip
weakest_real(
    beyond("a", "service brake from A at point 3", a, KEPT["x3"] - STOP_BEFORE, STOP_BEFORE, between(20, a, 25)), 0, a,
    safe=BELOW, within=(20, 25), gap=Fraction(1, 1000), unit="m/s", id="patterns_markers.greatest_a",
    at={"x3": "349.168 m"},
)  # fmt: skip
weakest_real(
    beyond("l", "point 2 as drawn", TOP, TOP * TOP / (2 * B_SERVICE), ahead, between(40, ahead, 80)), 0, ahead,
    safe=ABOVE, within=(40, 80), gap=CM, unit="m", id="patterns_markers.least_l_as_drawn", at={"x2 - l": "555.556 m"},
)  # fmt: skip
