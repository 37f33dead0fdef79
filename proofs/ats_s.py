"""ATS-S: what the 5 s alarm guarantees, and what it does not.

The timer is proved against a stop-watch that knows nothing of the states, at time stamps as close as one likes.
Source: 5 s [P]; state machine [R]; t_e 1.5 s, b_e 3.5 km/h/s [A].
Main results: an unanswered stop reading brakes at 5.000 s and not before (AS-1); a passive driver is stopped before the
signal from D_req = v (5 + t_e) + v^2 / (2 b_e) on, for all v, t_e, b_e (AS-2); who brakes at 4.9 s and lets go is not
(AS-3).
"""

from __future__ import annotations

from fractions import Fraction

from models.ats.ats_s import ALARM, ALARM_S, CONFIRMED, EMERGENCY, IDLE, Approach, Bench, LateBench, warning_distance
from models.kinematics import B_EMERGENCY, T_EMERGENCY, mps
from safety import PROVED, REFUTED, Bit, Real, Scenario, Seen, claim, implies, previous
from safety.prove.laws import law

SOURCE = "[P] 5 s alarm; [R] state machine"
BRAKE = "[A] t_e, b_e"

# --- AS-1: the timer -------------------------------------------------------------------------------------------------


def unanswered_is_alarm(s: Seen) -> Bit:
    """Lemma: while a stop reading is unanswered the alarm runs, as long as the stop-watch, or the brake is on."""
    alarm = s.ats.state == ALARM
    return implies(s.open, alarm | (s.ats.state == EMERGENCY)) & implies(alarm, s.open & (s.ats.waited == s.clock))


@claim(Bench, expect=PROVED, lemmas=[unanswered_is_alarm], symbolic=["ats.alarm_s"], requirement="AS-1", source=SOURCE,
       witness=Scenario(8, {"healthy": True, "elapsed": 1, "stop_read": lambda k: k == 1, "standing": True,
                            "reset": lambda k: k == 0}))  # fmt: skip
def an_unanswered_stop_brakes(s: Seen) -> Bit:
    """A stop reading that neither the brake nor a reset has answered for 5 s gives the emergency brake, for ever."""
    return implies(s.overdue, s.ats.emergency)


@claim(LateBench, expect=REFUTED, requirement="AS-1", source=SOURCE, twin_of=an_unanswered_stop_brakes)
def an_unanswered_stop_brakes_although_answers_come_first(s: Seen) -> Bit:
    """So it does where the handle is looked at before the time is: an answer at 5.000 s counts there."""
    return an_unanswered_stop_brakes(s)


@claim(Bench, expect=PROVED, lemmas=[unanswered_is_alarm], requirement="AS-1", source=SOURCE)
def the_alarm_alone_brakes_no_sooner(s: Seen) -> Bit:
    """Healthy equipment gives the emergency brake only where an alarm is 5 s old, or where it was on already."""
    alarm = (s.ats.state == ALARM) & (s.ats.waited + s.elapsed >= ALARM_S)
    return implies(s.ats.emergency & s.ats.healthy, alarm | (s.ats.state == EMERGENCY))


@claim(Bench, expect=REFUTED, requirement="AS-1", source=SOURCE, twin_of=the_alarm_alone_brakes_no_sooner)
def equipment_brakes_no_sooner(s: Seen) -> Bit:
    """So it is with supply, cycle or coil failed."""
    alarm = (s.ats.state == ALARM) & (s.ats.waited + s.elapsed >= ALARM_S)
    return implies(s.ats.emergency, alarm | (s.ats.state == EMERGENCY))


@claim(Bench, expect=PROVED, requirement="AS-1", source=SOURCE)
def a_fault_brakes(s: Seen) -> Bit:
    """Supply, cycle or coil failed gives the emergency brake at that time stamp."""
    return implies(~s.ats.healthy, s.ats.emergency)


@claim(Bench, expect=REFUTED, requirement="AS-1", source=SOURCE, twin_of=a_fault_brakes)
def a_fault_that_is_over_brakes(s: Seen) -> Bit:
    """So it still does at the next time stamp, the train standing and reset or not."""
    return implies(~previous(s.ats.healthy, True), s.ats.emergency)


@claim(Bench, expect=PROVED, requirement="AS-1", source=SOURCE)
def only_standstill_and_reset_end_it(s: Seen) -> Bit:
    """An emergency brake stays on until the train stands and is reset."""
    return implies((s.ats.state == EMERGENCY) & ~(s.standing & s.reset), s.ats.emergency)


@claim(Bench, expect=REFUTED, requirement="AS-1", source=SOURCE, twin_of=only_standstill_and_reset_end_it)
def only_standstill_ends_it(s: Seen) -> Bit:
    """It stays on until the train stands, reset or not."""
    return implies((s.ats.state == EMERGENCY) & ~(s.standing & ~s.reset), s.ats.emergency)


# --- AS-2: the warning distance --------------------------------------------------------------------------------------


def stops_in_time(v: Real, d: Real, alarm: Real, free: Real, b: Real, during: Real, later: Real, braked: Real) -> Bit:
    """The way of a passive driver: alarm, free run, braking from a speed that is no higher."""
    way = (during <= v * alarm) & (later <= v * free) & (2 * b * braked <= v * v)
    sound = (v >= 0) & (b > 0) & (alarm >= 0) & (free >= 0)
    return implies(sound & way & (2 * b * (d - v * (alarm + free)) >= v * v), during + later + braked <= d)


@law(expect=PROVED, requirement="AS-2", source="[D]")
def the_warning_distance_suffices(
    v: Real, d: Real, alarm: Real, free: Real, b: Real, during: Real, later: Real, braked: Real
) -> Bit:
    """From D_req on, a passive driver is stopped before the signal: for all speeds, times and decelerations."""
    return stops_in_time(v, d, alarm, free, b, during, later, braked)


@law(expect=REFUTED, requirement="AS-2", source="[D]", twin_of=the_warning_distance_suffices)
def the_braking_distance_suffices(
    v: Real, d: Real, alarm: Real, free: Real, b: Real, during: Real, later: Real, braked: Real
) -> Bit:
    """The braking distance alone is enough."""
    way = (during <= v * alarm) & (later <= v * free) & (2 * b * braked <= v * v)
    sound = (v >= 0) & (b > 0) & (alarm >= 0) & (free >= 0)
    return implies(sound & way & (2 * b * d >= v * v), during + later + braked <= d)


def warned(s: Seen, seconds: Real | int, nearer: int = 0) -> Bit:
    """The train is at the balise, in front of the signal by the way of so many seconds and the emergency brake."""
    ready = s.reading & ((s.ats.state == IDLE) | (s.ats.state == CONFIRMED)) & (s.ats.waited == 0) & (s.ordered == 0)
    ghosts = (s.warned_at == s.speed) & (s.speed * s.speed <= 2 * s.b_e * s.way)
    return ready & ghosts & (s.speed >= 0) & (s.to_go + nearer >= s.speed * seconds + s.way)


def warned_in_time(s: Seen) -> Bit:
    """The train is at the balise, at least D_req before the signal; neither alarm nor brake is on."""
    return warned(s, ALARM_S + s.t_e)


def warned_late(s: Seen) -> Bit:
    """The same, one metre nearer."""
    return warned(s, ALARM_S + s.t_e, 1)


def on_time(s: Seen) -> Bit:
    """A time stamp comes when 5 s are over."""
    return implies(s.ats.state == ALARM, s.ats.waited + s.elapsed <= ALARM_S)


def passive(s: Seen) -> Bit:
    """The driver does not operate the brake, and a time stamp comes when 5 s are over."""
    return ~s.braking & on_time(s)


def no_faster(s: Seen) -> Bit:
    """Lemma: the train runs forward, no faster than at the balise, nor than the way kept for the brake allows."""
    return (s.speed >= 0) & (s.speed <= s.warned_at) & (s.speed * s.speed <= 2 * s.b_e * s.way)


def at_the_balise(s: Seen) -> Bit:
    """Lemma: before the first step, the way left is enough for alarm, free run and emergency brake."""
    return implies(s.reading, warned_in_time(s))


def in_alarm(s: Seen) -> Bit:
    """Lemma: in an alarm it is enough for what is left of the 5 s, free run and emergency brake."""
    left = ALARM_S - s.ats.waited + s.t_e
    enough = (s.ats.waited >= 0) & (s.ats.waited < ALARM_S) & (s.to_go >= s.warned_at * left + s.way)
    alarm = (s.ats.state == ALARM) & enough & (s.ordered == 0)
    return implies(~s.reading, alarm | (s.ats.state == EMERGENCY))


def in_free_run(s: Seen) -> Bit:
    """Lemma: once the emergency brake is ordered, it is enough for what is left of the free run, and the brake."""
    ordered = ~s.reading & (s.ats.state == EMERGENCY) & (s.ordered <= s.t_e)
    return implies(ordered, (s.ordered >= 0) & (s.to_go >= s.warned_at * (s.t_e - s.ordered) + s.way))


def in_braking(s: Seen) -> Bit:
    """Lemma: after the free run it is enough for the brake."""
    braking = ~s.reading & (s.ats.state == EMERGENCY) & (s.ordered >= s.t_e)
    return implies(braking, s.to_go >= s.way)


@claim(Approach, expect=PROVED, start=warned_in_time, given=passive, anywhere=True,
       lemmas=[no_faster, at_the_balise, in_alarm, in_free_run, in_braking], symbolic=["t_e", "b_e"],
       requirement="AS-2", source=BRAKE)  # fmt: skip
def a_passive_driver_is_stopped(s: Seen) -> Bit:
    """Warned at D_req or farther out, a train whose driver does nothing never passes the signal, for every speed, free
    run and emergency brake."""
    return s.to_go >= 0


@claim(Approach, expect=REFUTED, start=warned_late, given=passive, anywhere=True, symbolic=["t_e", "b_e"],
       requirement="AS-2", source=BRAKE, twin_of=a_passive_driver_is_stopped)  # fmt: skip
def warned_a_metre_late_a_passive_driver_is_stopped(s: Seen) -> Bit:
    """So is a train warned one metre nearer to the signal."""
    return a_passive_driver_is_stopped(s)


def silent(s: Seen) -> Bit:
    """The driver does not operate the brake; time stamps come when they will."""
    return ~s.braking


@claim(Approach, expect=REFUTED, start=warned_in_time, given=silent, anywhere=True, symbolic=["t_e", "b_e"],
       requirement="AS-2", source=BRAKE, twin_of=a_passive_driver_is_stopped)  # fmt: skip
def a_passive_driver_is_stopped_whenever_time_is_looked_at(s: Seen) -> Bit:
    """So is a train whose equipment may look at the time too late."""
    return a_passive_driver_is_stopped(s)


# --- AS-3: what nobody supervises ------------------------------------------------------------------------------------

V = mps(100)
D = warning_distance(V)


def operated_and_released(step: int) -> bool:
    """The handle: into a braking position at 4.9 s, and back."""
    return step == 1


LET_GO = Scenario(
    4, {
        "healthy": True, "braking": operated_and_released,
        "elapsed": lambda k: [0, Fraction("4.9"), Fraction("0.1"), 20][k],
        "motion.speed": V, "motion.gone": lambda k: V * [0, Fraction("4.9"), Fraction("0.1"), 20][k],
        "motion.free": lambda k: [0, Fraction("4.9"), Fraction("0.1"), 20][k],
    }, {"t_e": T_EMERGENCY, "b_e": B_EMERGENCY, "to_go": D, "speed": V, "warned_at": V,
       "way": V * V / (2 * B_EMERGENCY), "ats.state": IDLE, "ats.waited": 0, "reading": True},
)  # fmt: skip


@claim(Approach, expect=REFUTED, start=warned_in_time, given=on_time, anywhere=True, symbolic=["t_e", "b_e"],
       requirement="AS-3", source=SOURCE, defeat=True, scenario=LET_GO,
       twin_of=a_passive_driver_is_stopped)  # fmt: skip
def no_train_passes_a_stop_signal(s: Seen) -> Bit:
    """A train warned at D_req never passes the signal, whatever the driver does."""
    return a_passive_driver_is_stopped(s)


@claim(Approach, expect=REFUTED, start=warned_in_time, given=on_time, anywhere=True, symbolic=["t_e", "b_e"],
       requirement="AS-3", source=SOURCE, defeat=True, twin_of=a_passive_driver_is_stopped)  # fmt: skip
def no_train_passes_a_stop_signal_as_searched(s: Seen) -> Bit:
    """The same, the run left to the search."""
    return a_passive_driver_is_stopped(s)
