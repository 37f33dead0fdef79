"""ATS-SP targets: what makes a pattern, what ends it, where a turnout's limit holds, and the algebra of AV-1.

Source: pattern set, release, branch balises of another kind [P]; rules in detail [A].
Main results: a stop reading makes the pattern in its cycle, and nothing ends it but the listed events, each of which
can (AV-2); the limit of a turnout holds at its first facing switch, not at the balise (AV-6).
"""

from __future__ import annotations

from collections.abc import Callable

from models.ats.ride import GuardRide
from models.ats.supervision import Supervision
from models.ats.variants import BlindAtAPlace, BlindMovesOn, EndingGoesFirst, LimitAtBalise
from models.kinematics import ACCELERATION, B_SERVICE, T_SERVICE, permits
from proofs.ats_supervision import OPEN, left, no_faster_than_read, within_interval
from safety import PROVED, REFUTED, Bit, Real, Seen, all_of, any_of, bit, claim, implies
from safety.prove.laws import law

SOURCE = "[P] pattern set and release; [A] rules in detail"
TARGETS = ("home", "turnout", "station", "blind")
LINE = ("signal_at", "switch_at", "mark_at", "standstill", "length", "margin", "b_s", "t_s", "b_e", "t_e")

# --- AV-2: what makes and what ends the pattern ----------------------------------------------------------------------


def passed(s: Seen) -> Bit:
    """The train is surely past the signal."""
    return s.where.low >= s.signal_at


ENDS: dict[str, Callable[[Seen], Bit]] = {
    "not-stop balise": lambda s: s.events.clear_read,
    "release balise": lambda s: s.events.release_read,
    "phase": lambda s: s.events.phase_released,
    "stop and reset": lambda s: s.freed,
    "passing": passed,
}


@claim(Supervision, expect=PROVED, symbolic=LINE, requirement="AV-2", source=SOURCE)
def stop_reading_makes_the_pattern(s: Seen) -> Bit:
    """A stop reading of the signal balise makes the pattern in its cycle, at the signal, whatever ends it otherwise."""
    return implies(s.events.stop_read, s.home.target.pattern & (s.home.target.target == s.signal_at))


@claim(EndingGoesFirst, expect=REFUTED, symbolic=LINE, requirement="AV-2", source=SOURCE,
       twin_of=stop_reading_makes_the_pattern)  # fmt: skip
def stop_reading_makes_the_pattern_where_ending_goes_first(s: Seen) -> Bit:
    """So it does where what ends a pattern goes before what makes it."""
    return stop_reading_makes_the_pattern(s)


@claim(Supervision, expect=PROVED, symbolic=LINE, requirement="AV-2", source=SOURCE)
def only_listed_events_end_it(s: Seen) -> Bit:
    """A pattern ends only with a not-stop balise of its signal, a release balise, the phase, stop and reset, or
    passing."""
    ends = any_of(*(end(s) for end in ENDS.values()))
    return implies(s.home.target.active & ~s.home.target.pattern, ends)


def without(name: str) -> None:
    """The twin in which one of these events is missing from the list."""

    def fewer(s: Seen) -> Bit:
        ends = any_of(*(end(s) for key, end in ENDS.items() if key != name))
        return implies(s.home.target.active & ~s.home.target.pattern, ends)

    fewer.__name__ = f"{name.replace(' ', '_').replace('-', '_')}_does_not_end_it"
    fewer.__doc__ = f"So it is with '{name}' left out of that list."
    fewer.__module__ = __name__
    claim(Supervision, expect=REFUTED, symbolic=("signal_at",), requirement="AV-2", source=SOURCE,
          twin_of=only_listed_events_end_it)(fewer)  # fmt: skip


for each in ENDS:
    without(each)


@claim(Supervision, expect=PROVED, symbolic=(*LINE, "switch_clear"), requirement="AV-2", source=SOURCE)
def only_the_clear_rear_ends_the_turnout(s: Seen) -> Bit:
    """The turnout's limit ends only when the rear of the train is surely clear of it."""
    ended = s.turnout.target.active & ~s.turnout.target.pattern
    return implies(ended, s.where.low - s.length >= s.switch_clear)


@claim(Supervision, expect=REFUTED, symbolic=(*LINE, "switch_clear"), requirement="AV-2", source=SOURCE,
       twin_of=only_the_clear_rear_ends_the_turnout)  # fmt: skip
def only_the_rear_clear_by_a_metre_ends_the_turnout(s: Seen) -> Bit:
    """It ends only when the rear is clear of it by a metre more."""
    ended = s.turnout.target.active & ~s.turnout.target.pattern
    return implies(ended, s.where.low - s.length >= s.switch_clear + 1)


@claim(Supervision, expect=PROVED, requirement="AV-2", source=SOURCE)
def each_target_has_its_brakes(s: Seen) -> Bit:
    """Above the pattern of any target the service brake is on, above its emergency pattern the emergency brake."""
    return all_of(*(implies(s[t].over, s.service) & implies(s[t].far_over, s.emergency) for t in TARGETS))


@claim(Supervision, expect=REFUTED, requirement="AV-2", source=SOURCE, twin_of=each_target_has_its_brakes)
def each_target_has_the_emergency_brake(s: Seen) -> Bit:
    """Above the pattern of any target the emergency brake is on: it comes second."""
    return all_of(*(implies(s[t].over, s.emergency) for t in TARGETS))


@claim(Supervision, expect=PROVED, requirement="AV-2", source=SOURCE)
def emergency_is_latched(s: Seen) -> Bit:
    """The emergency brake stays on until the train stands and is reset."""
    return implies(s.brakes.latched & ~s.freed, s.emergency)


@claim(Supervision, expect=REFUTED, requirement="AV-2", source=SOURCE, twin_of=emergency_is_latched)
def service_is_latched(s: Seen) -> Bit:
    """The service brake stays on until then, too."""
    return implies(s.brakes.held & ~s.freed, s.service)


# --- AV-2: a stop that cannot be assigned ----------------------------------------------------------------------------

BLIND = ("shortest", "blind.target.cycle", *LINE)


def forward(s: Seen) -> Bit:
    """The upper speed is from 0 up."""
    return s.where.fastest >= 0


def run_off(s: Seen) -> Real:
    """What the upper speed runs in the cycle, m."""
    return s.where.fastest * s.blind.target.cycle


@claim(Supervision, expect=PROVED, symbolic=BLIND, requirement="AV-2", source=SOURCE)
def an_unassigned_stop_makes_the_worst_pattern(s: Seen) -> Bit:
    """A stop that cannot be assigned makes a pattern in its cycle, for the shortest distance on the line from there on,
    or less."""
    near = s.blind.target.left <= s.shortest - run_off(s)
    return implies(s.events.stray_stop, s.blind.target.pattern & near)


@claim(BlindAtAPlace, expect=REFUTED, symbolic=BLIND, requirement="AV-2", source=SOURCE,
       twin_of=an_unassigned_stop_makes_the_worst_pattern)  # fmt: skip
def an_unassigned_stop_makes_the_worst_pattern_at_a_place(s: Seen) -> Bit:
    """So it does where it is kept as a place."""
    return an_unassigned_stop_makes_the_worst_pattern(s)


@claim(Supervision, expect=PROVED, symbolic=BLIND, requirement="AV-2", source=SOURCE)
def only_stop_and_reset_lifts_it(s: Seen) -> Bit:
    """Only stop and reset ends it, and its target never moves forward: what is left falls in each cycle by what the
    upper speed runs, or by more, whatever the position is set to, and whatever else is read."""
    falls = s.blind.target.left <= s.blind.target.rest - run_off(s)
    return implies(s.blind.target.active & ~s.freed, s.blind.target.pattern & falls)


@claim(BlindAtAPlace, expect=REFUTED, symbolic=BLIND, requirement="AV-2", source=SOURCE,
       twin_of=only_stop_and_reset_lifts_it)  # fmt: skip
def only_stop_and_reset_lifts_it_at_a_place(s: Seen) -> Bit:
    """So it is where it is kept as a place: a fix moves the train away from it."""
    return only_stop_and_reset_lifts_it(s)


@claim(BlindMovesOn, expect=REFUTED, symbolic=BLIND, requirement="AV-2", source=SOURCE,
       twin_of=only_stop_and_reset_lifts_it)  # fmt: skip
def only_stop_and_reset_lifts_it_where_it_moves_on(s: Seen) -> Bit:
    """So it is where the next such stop replaces it."""
    return only_stop_and_reset_lifts_it(s)


def standing_or_running(s: Seen) -> Bit:
    """Not stopped and reset; the upper speed is from 0 up."""
    return ~s.freed & forward(s)


@claim(Supervision, expect=PROVED, symbolic=BLIND, given=standing_or_running, requirement="AV-2", source=SOURCE)
def its_brake_stays_on(s: Seen) -> Bit:
    """A train above the pattern of the blind target that does not slow down stays above it, so its brake is on,
    whatever the position is set to."""
    still = s.where.fastest * s.where.fastest + 2 * s.b_s * s.t_s * s.where.fastest > 2 * s.b_s * (
        s.blind.target.rest - s.margin
    )
    return implies(s.blind.target.active & still & (s.where.fastest > 0), s.service)


@claim(BlindAtAPlace, expect=REFUTED, symbolic=BLIND, given=standing_or_running, requirement="AV-2", source=SOURCE,
       twin_of=its_brake_stays_on)  # fmt: skip
def its_brake_stays_on_at_a_place(s: Seen) -> Bit:
    """So it is where it is kept as a place."""
    return its_brake_stays_on(s)


@claim(BlindMovesOn, expect=REFUTED, symbolic=BLIND, given=standing_or_running, requirement="AV-2", source=SOURCE,
       twin_of=its_brake_stays_on)  # fmt: skip
def its_brake_stays_on_where_it_moves_on(s: Seen) -> Bit:
    """So it is where the next such stop replaces it."""
    return its_brake_stays_on(s)


# --- AV-6: the turnout -----------------------------------------------------------------------------------------------


def slows(s: Seen) -> Bit:
    """The brake gives b_s at least: the energy above the limit is no more than what it still takes."""
    energy = s.course.speed * s.course.speed - s.limit * s.limit
    return implies(s.order, (energy <= 2 * s.b_s * (s.train.way - s.course.braked)) | (s.course.speed <= s.limit))


def cut(s: Seen) -> Bit:
    """An order cuts traction: the train gains no speed."""
    return implies(s.order, s.course.speed <= s.train.speed)


def in_time(s: Seen) -> Bit:
    """The target is made in time, or below the limit."""
    late = s.made & ~s.guard.target.active & ~(left(s) >= s.train.roll + s.train.way)
    return implies(late, s.train.speed <= s.limit)


LIMIT_PREMISES = (within_interval, no_faster_than_read, slows, cut, in_time)


def limit_premises(s: Seen) -> Bit:
    """AV-6: within the interval, speed bounded, traction cut, b_s at least, made in time, or below the limit."""
    return all_of(*(premise(s) for premise in LIMIT_PREMISES))


def running(s: Seen) -> Bit:
    """The way until the brake acts is from 0 up, the speed that of the ways."""
    energy = s.train.speed * s.train.speed - s.limit * s.limit
    above = (energy <= 2 * s.b_s * s.train.way) | (s.train.speed <= s.limit)
    return (s.train.roll >= 0) & (s.train.speed >= 0) & above


def limit_fits(s: Seen) -> Bit:
    """Lemma: above the limit, free run and braking to it fit in front of the target, which is the switch."""
    fit = (s.train.speed <= s.limit) | (left(s) >= s.train.roll + s.train.way)
    return running(s) & implies(s.guard.target.active, fit & (s.guard.target.place == s.place))


@claim(GuardRide, expect=PROVED, start=running, given=limit_premises, lemmas=[limit_fits], symbolic=(*OPEN, "limit"),
       requirement="AV-6", source=SOURCE)  # fmt: skip
def turnout_is_not_entered_too_fast(s: Seen) -> Bit:
    """From the first facing switch on the train keeps the limit while the target is active: for ever and for all
    limits, cycles, brakes, free runs, margins and places."""
    beyond = s.train.head > s.place - s.margin
    return implies(s.guard.target.active & beyond, s.train.speed <= s.limit)


@claim(GuardRide, expect=REFUTED, start=running, given=limit_premises, symbolic=(*OPEN, "limit"), requirement="AV-6",
       source=SOURCE, twin_of=turnout_is_not_entered_too_fast)  # fmt: skip
def the_limit_holds_from_the_balise_on(s: Seen) -> Bit:
    """It keeps the limit from the branch balise on, where the target was made."""
    return implies(s.guard.target.active, s.train.speed <= s.limit)


def limit_without(dropped: Callable[[Seen], Bit]) -> None:
    """The twin in which one of the premises is missing."""

    def given(s: Seen) -> Bit:
        return all_of(*(premise(s) for premise in LIMIT_PREMISES if premise is not dropped))

    def fewer(s: Seen) -> Bit:
        return turnout_is_not_entered_too_fast(s)

    given.__doc__ = f"The same without '{(dropped.__doc__ or '').rstrip('.')}'."
    fewer.__name__ = f"turnout_is_not_entered_too_fast_without_{dropped.__name__}"
    fewer.__doc__ = f"So it does without '{(dropped.__doc__ or '').rstrip('.')}'."
    fewer.__module__ = __name__
    claim(GuardRide, expect=REFUTED, start=running, given=given, symbolic=(*OPEN, "limit"), requirement="AV-6",
          source=SOURCE, twin_of=turnout_is_not_entered_too_fast)(fewer)  # fmt: skip


for premise in LIMIT_PREMISES:
    limit_without(premise)


@claim(Supervision, expect=PROVED, symbolic=LINE, requirement="AV-6", source=SOURCE)
def the_target_is_the_switch(s: Seen) -> Bit:
    """A branch balise makes a target at the first facing switch."""
    return implies(s.events.branch_read, s.turnout.target.target == s.switch_at)


@claim(LimitAtBalise, expect=REFUTED, symbolic=LINE, requirement="AV-6", source=SOURCE,
       twin_of=the_target_is_the_switch)  # fmt: skip
def the_target_is_the_switch_in_the_variant(s: Seen) -> Bit:
    """So it does where the limit is enforced at the balise."""
    return the_target_is_the_switch(s)


# --- the algebra of AV-1 ---------------------------------------------------------------------------------------------


@law(expect=PROVED, requirement="AV-1", source="[D]")
def who_is_permitted_still_stops(
    v: Real, read: Real, pos: Real, high: Real, place: Real, m: Real, b: Real, t: Real, rolled: Real, braked: Real
) -> Bit:
    """A train within its interval, no faster than read, that is permitted, stops before the signal when it then rolls t
    without traction and brakes with b."""
    sound = (v >= 0) & (b > 0) & (t >= 0) & (m >= 0) & (pos <= high) & (v <= read) & (read > 0)
    way = (rolled <= v * t) & (2 * b * braked <= v * v)
    return implies(sound & way & permits(read, place - m - high, b, t), pos + rolled + braked <= place - m)


@law(expect=REFUTED, requirement="AV-1", source="[D]", twin_of=who_is_permitted_still_stops)
def who_is_permitted_still_stops_with_traction(pos: Real, rolled: Real, braked: Real, reached: Real) -> Bit:
    """So does one 20 m before the point at 4 m/s, traction going on at 0.8 m/s^2 in the free run."""
    v, t, b = 4, T_SERVICE, B_SERVICE
    gains = (reached == v + ACCELERATION * t) & (2 * rolled == (v + reached) * t)
    way = gains & (2 * b * braked == reached * reached) & (pos == -20)
    return implies(way & bit(permits(v, 20, b, t)), pos + rolled + braked <= 0)
