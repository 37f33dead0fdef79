"""Level-crossing warning time: it is put off only behind a stop pattern, and is long enough for every train.

Source: principle [P]; 30 s, 20 s, 100 m, 100 km/h, 0.7 m/s^2 [A].
Main results: AO-1 for ever; AO-2 for every train within line speed and acceleration, with messages lost or not; without
the pattern a warning shorter than 20 s (AS-15); the least start point and the least notice for 20 s.
"""

from __future__ import annotations

from fractions import Fraction

from models.ats.crossing import LINE_SPEED, MARK, NOTICE, STARTING, Crossing, NoPattern, start_point
from models.kinematics import mps
from safety import PROVED, REFUTED, Bit, Scenario, Seen, claim, implies, select
from safety.prove.bounds import Bound, between, claim_bound, claim_bracket, reals
from safety.prove.weakest import ABOVE, weakest_real

SOURCE = "[P] warning-time control; [A] times, speeds, distances"
OPEN = ("start", "mark", "notice", "least", "v_max", "a_max")


def outside(s: Seen) -> Bit:
    """The train comes from before the start point."""
    return (s.head < -s.start) & (s.speed >= 0) & (s.speed <= s.v_max)


OUTSIDE = {
    "head": -853, "speed": 20, "start": 833, "least": 20, "mark": 100, "notice": 13, "v_max": 100, "a_max": 1,
}  # fmt: skip
COMES_NEARER = {
    "says.stops": True, "elapsed": lambda k: int(k > 0), "way": lambda k: 20 * (k > 0), "reached": 20,
}  # fmt: skip

# --- AO-1 ------------------------------------------------------------------------------------------------------------


@claim(Crossing, expect=PROVED, start=outside, symbolic=OPEN, requirement="AO-1", source=SOURCE,
       witness=Scenario(3, COMES_NEARER, OUTSIDE))  # fmt: skip
def delay_needs_a_stop_pattern(s: Seen) -> Bit:
    """The warning is put off only while the train is held by a stop pattern, whose end lies before the crossing."""
    return implies(s.put_off, s.stopping & (s.mark > 0) & (s.head + s.way <= -s.mark))


@claim(NoPattern, expect=REFUTED, start=outside, symbolic=OPEN, requirement="AO-1", source=SOURCE,
       twin_of=delay_needs_a_stop_pattern)  # fmt: skip
def delay_needs_only_the_timetable(s: Seen) -> Bit:
    """So it is where the train says "stopping" by its timetable alone."""
    return delay_needs_a_stop_pattern(s)


# --- AO-2 ------------------------------------------------------------------------------------------------------------


def sound(s: Seen) -> Bit:
    """Lemma: times are from 0 up, no train is faster than the line speed, an announcement stands."""
    times = (s.waited >= 0) & (s.since >= 0) & (s.warned >= 0)
    return times & (s.speed >= 0) & (s.speed <= s.v_max) & implies(s.departed, ~s.pattern & s.silent)


def held(s: Seen) -> Bit:
    """Lemma: an active pattern keeps the head before the mark."""
    return implies(s.pattern, s.head <= -s.mark)


def started(s: Seen) -> Bit:
    """Lemma: past the start point, and only there, is a warning, or a pattern that puts it off."""
    past = s.head >= -s.start
    before = ~s.warns & (s.warned == 0)
    return select(past, s.warns | (s.pattern & ~s.silent), before)


def covered(s: Seen) -> Bit:
    """Lemma: past the start point a train has been warned of since that point, or since its announcement, or is
    held."""
    since_start = s.head <= s.v_max * s.warned - s.start
    since_announced = s.silent & (s.warned >= s.waited) & (s.pattern | s.departed)
    return implies(s.head >= -s.start, since_start | since_announced | (s.pattern & ~s.silent))


def noticed(s: Seen) -> Bit:
    """Lemma: a departure was announced in time."""
    return implies(s.departed, s.waited >= s.notice + s.since)


def run(s: Seen) -> Bit:
    """Lemma: since its departure from the mark or before, a train is no farther than a_max takes it."""
    far = (s.speed <= s.a_max * s.since) & (2 * (s.head + s.mark) <= s.a_max * s.since * s.since)
    return implies(s.departed, far)


def dimensioned(s: Seen) -> Bit:
    """Start point and notice are long enough: v_max T_min before the crossing, and T_min less the run from the mark."""
    rest = s.least - s.notice
    return (s.start >= s.v_max * s.least) & ((rest <= 0) | (s.a_max * rest * rest <= 2 * s.mark))


@claim(Crossing, expect=PROVED, start=outside, given=dimensioned, symbolic=OPEN, requirement="AO-2", source=SOURCE,
       lemmas=[sound, held, started, covered, noticed, run])  # fmt: skip
def warned_of_for_long_enough(s: Seen) -> Bit:
    """When the head reaches the crossing the warning has been on for T_min, for every train within line speed and
    acceleration, whether it stops or not, whatever messages are lost, and for all such parameters."""
    return ~s.too_short


PASSES = Scenario(
    4, {"elapsed": [0, 1, 20, 20].__getitem__, "way": [0, 20, 440, 400].__getitem__, "reached": 22, "says.stops": True},
    {"head": -853, "speed": 22, "start": 833, "mark": 100, "notice": 13, "least": 20, "v_max": 22, "a_max": 1},
)  # fmt: skip


@claim(NoPattern, expect=REFUTED, start=outside, given=dimensioned, symbolic=OPEN, requirement="AO-2", source=SOURCE,
       twin_of=warned_of_for_long_enough, scenario=PASSES)  # fmt: skip
def warned_of_for_long_enough_without_a_pattern(s: Seen) -> Bit:
    """So it has been where a train says "stopping" without a pattern, and passes."""
    return warned_of_for_long_enough(s)


def start_too_near(s: Seen) -> Bit:
    """Start point a metre short of v_max T_min; notice long enough."""
    rest = s.least - s.notice
    return (s.start >= s.v_max * s.least - 1) & ((rest <= 0) | (s.a_max * rest * rest <= 2 * s.mark))


@claim(Crossing, expect=REFUTED, start=outside, given=start_too_near, symbolic=OPEN, requirement="AO-2", source=SOURCE,
       twin_of=warned_of_for_long_enough)  # fmt: skip
def warned_of_for_long_enough_from_nearer(s: Seen) -> Bit:
    """So it has been with the start point a metre nearer."""
    return warned_of_for_long_enough(s)


def notice_too_short(s: Seen) -> Bit:
    """Start point far enough; notice half a second short."""
    rest = s.least - s.notice - Fraction(1, 2)
    return (s.start >= s.v_max * s.least) & ((rest <= 0) | (s.a_max * rest * rest <= 2 * s.mark))


@claim(Crossing, expect=REFUTED, start=outside, given=notice_too_short, symbolic=OPEN, requirement="AO-2",
       source=SOURCE, twin_of=warned_of_for_long_enough)  # fmt: skip
def warned_of_for_long_enough_with_less_notice(s: Seen) -> Bit:
    """So it has been with the departure announced half a second later."""
    return warned_of_for_long_enough(s)


# --- as bounds: how short the warning can be -------------------------------------------------------------------------

time, run_s, way, gain, notice, speed, start = reals("time run_s way gain notice speed start")


def lacking(told: str, name: str, of: int, *given: Bit) -> Bound:
    """By how much a warning can fall short of so many seconds."""
    return Bound(
        f"ats_crossing.{name}", f"What a warning lacks of {of} s: {told}", of - time, (between(0, time, 300), *given),
        unit="s", requirement="AO-2", source=SOURCE, assumed=("[A] line speed, starting acceleration, mark",),
    )  # fmt: skip


STARTS = (
    gain * run_s * run_s == 2 * way,
    way == MARK,
    between(Fraction(1, 100), gain, STARTING),
    between(0, run_s, 200),
)
RUNS = (time * speed >= start, between(mps(1), speed, LINE_SPEED))

controlled = claim_bound(
    lacking("a train that starts at the mark, announced 13.10 s before", "controlled", 30, time == notice + run_s,
            notice == NOTICE, *STARTS), Fraction(0), expect=PROVED,
)  # fmt: skip
claim_bound(
    lacking("the same, announced 13 s before", "controlled_with_13_s", 30, time == notice + run_s, notice == 13,
            *STARTS),
    Fraction(0), expect=REFUTED, twin_of=controlled,
)  # fmt: skip
claim_bracket(
    lacking("a train that starts at the mark, unannounced", "unannounced", 30, time == run_s, *STARTS),
    id="ats_crossing.least_notice",
)  # fmt: skip
claim_bracket(
    lacking("plain control from 833.33 m, of 40 s", "plain_control", 40, start == start_point(), *RUNS),
    id="ats_crossing.express",
)  # fmt: skip

# --- the weakest that will do ----------------------------------------------------------------------------------------

weakest_real(
    lacking("plain control", "start_point", 20, *RUNS, between(1, start, 2000)), Fraction(0), start, safe=ABOVE,
    within=(1, 2000), gap=Fraction(1, 10), unit="m", id="ats_crossing.least_start_point",
    at={"T_min": "20 s", "line speed": "100 km/h"},
)  # fmt: skip
weakest_real(
    lacking("a train that starts at the mark", "notice", 20, time >= notice + run_s, between(0, notice, 30), *STARTS),
    Fraction(0), notice, safe=ABOVE, within=(0, 30), gap=Fraction(1, 100), unit="s",
    id="ats_crossing.least_notice_for_20_s",
    at={"T_min": "20 s", "mark": "100 m before the crossing"},
)  # fmt: skip
