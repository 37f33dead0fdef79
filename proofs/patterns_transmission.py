"""Transmission of a stop: what a point system does not see, and what the continuous one always shows.

Steps of 0.1 s.  Faults are those of the parts on the track and on board, from any step on.
Source: principles and failures [P]; cycle, codes, detection time of 5 cycles [A].

Main results: a healthy point brakes every train that passes it at stop, and a healthy coded current lowers the limit
within its detection time, for ever.  A point does not react between points (SP-X1); a missing or detuned track coil, a
contact that is welded or a magnet that is lost read as proceed (SP-X2); loss of the current only ever lowers the limit.
"""

from __future__ import annotations

from models.patterns.transmission import (
    CLEAR,
    LIMITS,
    MEDIUM,
    SLOW,
    STOP,
    ContinuousCode,
    MagnetPoint,
    ResonantPoint,
    TripStop,
    allowed,
)
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Scenario,
    Seen,
    age,
    all_of,
    any_of_faults,
    at_most,
    byzantine,
    claim,
    implies,
    open_circuit,
    persists,
    previous,
    stuck,
    welded,
)

AT_STOP = {"passing": True}  # proceed is false: the signal is at stop
PRINCIPLE = "[P] point control; cycle [A]"
DETECTION = 5  # cycles


def lost(*points: str) -> list[Fault]:
    """Each of these lines without current, from any step on."""
    return [Fault(open_circuit(), [p], ANY_TIME, name=f"{p} open") for p in points]


# --- a point acts on a train that passes it -------------------------------------------------------------------------


@claim(MagnetPoint, expect=PROVED, faults=any_of_faults(lost("clearing_coil", "valve")), requirement="SP-F1",
       source=PRINCIPLE, witness=Scenario(1, AT_STOP))  # fmt: skip
def magnet_stops_who_passes(s: Seen) -> Bit:
    """Whoever passes the magnet at stop is braked in the same cycle, even with the clearing coil or the valve's line
    without current."""
    return implies(s.passing & ~s.proceed, s.out)


@claim(MagnetPoint, expect=REFUTED, defeat=True, faults=at_most(1, lost("magnet")), requirement="SP-F1",
       source="[P] magnet lost", twin_of=magnet_stops_who_passes,
       scenario=Scenario(1, AT_STOP, present=["magnet open"]))  # fmt: skip
def magnet_that_is_lost_stops_who_passes(s: Seen) -> Bit:
    """Whoever passes the magnet at stop is braked, even where it is gone or demagnetised.  False: nothing acts on the
    train, and nothing on board tells."""
    return magnet_stops_who_passes(s)


@claim(ResonantPoint, expect=PROVED, faults=any_of_faults(lost("contact", "oscillator", "relay", "valve")),
       requirement="SP-F1", source=PRINCIPLE, witness=Scenario(1, AT_STOP))  # fmt: skip
def resonance_stops_who_passes(s: Seen) -> Bit:
    """Whoever passes the resonant coil at stop is braked in the same cycle, even with the contact open, the oscillator
    dead, the relay or the valve's line without current."""
    return implies(s.passing & ~s.proceed, s.out)


@claim(ResonantPoint, expect=PROVED, requirement="SP-F1", source=PRINCIPLE,
       faults=any_of_faults(lost("oscillator", "relay", "valve")))  # fmt: skip
def lost_line_on_board_brakes(s: Seen) -> Bit:
    """A line on board that has lost its current brakes in the same cycle, between points too."""
    return implies(~s.oscillator | ~s.relay | ~s.valve, s.out)


@claim(ResonantPoint, expect=REFUTED, requirement="SP-F1", source=PRINCIPLE, twin_of=lost_line_on_board_brakes,
       faults=at_most(1, lost("contact")))  # fmt: skip
def lost_contact_on_the_track_brakes(s: Seen) -> Bit:
    """A contact on the track that stays open brakes in the same cycle.  False: only a train that passes is braked."""
    return implies(~s.contact, s.out)


@claim(ResonantPoint, expect=PROVED, requirement="SP-F1", source="[A] reset at standstill only")
def brake_stays_until_reset_at_standstill(s: Seen) -> Bit:
    """Once on, the brake stays until it is reset at standstill."""
    return implies(previous(s.out, False) & ~(s.reset & s.standing), s.out)


@claim(ResonantPoint, expect=REFUTED, requirement="SP-F1", twin_of=brake_stays_until_reset_at_standstill)
def brake_stays_for_ever(s: Seen) -> Bit:
    """Once on, the brake stays for ever."""
    return implies(previous(s.out, False), s.out)


def brake_is_just(s: Seen, stopped: Bit) -> Bit:
    """The brake is on just where the point acts, or since then until it is reset at standstill."""
    return all_of(s.out == (stopped | (previous(s.out, False) & ~(s.reset & s.standing))))


def tripped(s: Seen) -> Bit:
    """The register keeps the brake."""
    return all_of(s.tripped == previous(s.out, False))


@claim(MagnetPoint, expect=PROVED, lemmas=[tripped], requirement="SP-F1", source=PRINCIPLE)
def magnet_brakes_just_who_passes_at_stop(s: Seen) -> Bit:
    """The magnet brakes just who passes it at stop, until the reset at standstill."""
    return brake_is_just(s, s.passing & ~s.proceed)


@claim(MagnetPoint, expect=REFUTED, requirement="SP-F1", twin_of=magnet_brakes_just_who_passes_at_stop)
def magnet_brakes_just_while_passing_at_stop(s: Seen) -> Bit:
    """The magnet brakes just while it is passed at stop.  False: the brake stays."""
    return all_of(s.out == (s.passing & ~s.proceed))


@claim(ResonantPoint, expect=PROVED, lemmas=[tripped], requirement="SP-F1", source=PRINCIPLE)
def resonance_brakes_just_who_passes_at_stop(s: Seen) -> Bit:
    """The resonant coil brakes just who passes it at stop, until the reset at standstill."""
    return brake_is_just(s, s.passing & ~s.proceed)


@claim(ResonantPoint, expect=REFUTED, requirement="SP-F1", twin_of=resonance_brakes_just_who_passes_at_stop)
def resonance_brakes_just_while_passing_at_stop(s: Seen) -> Bit:
    """The resonant coil brakes just while it is passed at stop.  False: the brake stays."""
    return all_of(s.out == (s.passing & ~s.proceed))


# --- SP-X1: blind between points -------------------------------------------------------------------------------------

BEHIND = Scenario(4, {"proceed": lambda k: k < 2, "passing": lambda k: k == 1})


def reacts_within_detection(s: Seen) -> Bit:
    """A stop that has lasted for the detection time brakes."""
    return implies(persists(~s.proceed, ticks=DETECTION), s.out)


@claim(ResonantPoint, expect=REFUTED, defeat=True, requirement="SP-X1", source=PRINCIPLE,
       twin_of=resonance_stops_who_passes, scenario=Scenario(8, BEHIND.inputs))  # fmt: skip
def resonant_point_reacts_between_points(s: Seen) -> Bit:
    """A signal that goes to stop brakes the train within 0.5 s.  False: the train has passed the point, and what it was
    told stays until the next one."""
    return reacts_within_detection(s)


@claim(MagnetPoint, expect=REFUTED, defeat=True, requirement="SP-X1", source=PRINCIPLE,
       twin_of=magnet_stops_who_passes, scenario=Scenario(8, BEHIND.inputs))  # fmt: skip
def magnet_reacts_between_points(s: Seen) -> Bit:
    """A signal that goes to stop brakes the train within 0.5 s.  False, as with any point."""
    return reacts_within_detection(s)


# --- SP-X2: what fails to the wrong side -----------------------------------------------------------------------------

WRONG_SIDE = {
    "track_coil": Fault(open_circuit(), ["track_coil"], ANY_TIME, name="track coil missing or detuned"),
    "contact": Fault(welded(), ["contact"], ANY_TIME, name="contact welded short"),
    "coupling": Fault(open_circuit(), ["coupling"], ANY_TIME, name="gap too large"),
    "oscillator": Fault(stuck(1), ["relay"], ANY_TIME, name="relay held, frequency stuck"),
    "valve": Fault(stuck(1), ["valve"], ANY_TIME, name="valve does not vent"),
}


def found_at_once(s: Seen) -> Bit:
    """A stop is not passed without a brake."""
    return implies(s.passing & ~s.proceed, s.out)


def wrong_side(name: str, fault: Fault, twin: object) -> None:
    """SP-X2 for one mode: the equipment takes it for proceed."""

    def formula(s: Seen) -> Bit:
        return found_at_once(s)

    formula.__name__ = f"{name}_that_fails_is_detected_at_once"
    formula.__doc__ = f"With this part failing ({fault.name}) a stop is not passed without a brake.  False: proceed."
    scenario = Scenario(1, AT_STOP, present=[fault.name])
    claim(ResonantPoint, expect=REFUTED, defeat=True, faults=at_most(1, [fault]), requirement="SP-X2", source=PRINCIPLE,
          twin_of=resonance_stops_who_passes, scenario=scenario)(formula)  # fmt: skip


for part, mode in WRONG_SIDE.items():
    wrong_side(part, mode, resonance_stops_who_passes)


# --- the mechanical trip stop ----------------------------------------------------------------------------------------


def slow_enough(s: Seen) -> Bit:
    """The train is no faster than the arm works."""
    return implies(s.passing & ~s.proceed & (s.v <= s.works_to), s.out)


@claim(TripStop, expect=PROVED, symbolic=("works_to",), requirement="SP-F1", source="[P] trip stop; speed [A]",
       witness=Scenario(1, AT_STOP))  # fmt: skip
def arm_stops_who_passes_slowly(s: Seen) -> Bit:
    """Whoever passes the raised arm no faster than it works is braked, whatever that speed is."""
    return slow_enough(s)


@claim(TripStop, expect=REFUTED, defeat=True, symbolic=("works_to",), requirement="SP-F1",
       twin_of=arm_stops_who_passes_slowly, source="[P] cannot work at high speed")  # fmt: skip
def arm_stops_who_passes(s: Seen) -> Bit:
    """Whoever passes the raised arm is braked.  False: too fast for it."""
    return implies(s.passing & ~s.proceed, s.out)


@claim(TripStop, expect=PROVED, lemmas=[tripped], symbolic=("works_to",), requirement="SP-F1", source=PRINCIPLE)
def arm_brakes_just_who_passes_slowly_at_stop(s: Seen) -> Bit:
    """The arm brakes just who passes it at stop no faster than it works, until the reset at standstill."""
    return brake_is_just(s, s.passing & ~s.proceed & (s.v <= s.works_to))


@claim(TripStop, expect=REFUTED, symbolic=("works_to",), requirement="SP-F1",
       twin_of=arm_brakes_just_who_passes_slowly_at_stop)  # fmt: skip
def arm_brakes_just_who_passes_at_stop(s: Seen) -> Bit:
    """The arm brakes just who passes it at stop, until the reset at standstill."""
    return brake_is_just(s, s.passing & ~s.proceed)


@claim(TripStop, expect=REFUTED, defeat=True, faults=at_most(1, lost("cock")), symbolic=("works_to",),
       requirement="SP-F1",
       twin_of=arm_stops_who_passes_slowly, source="[P] wears fast")  # fmt: skip
def worn_arm_stops_who_passes_slowly(s: Seen) -> Bit:
    """Whoever passes the raised arm no faster than it works is braked, even where arm or cock is worn.  False."""
    return slow_enough(s)


# --- SP-C1, SP-H1: the coded current ---------------------------------------------------------------------------------

CODES = (STOP, SLOW, MEDIUM, CLEAR)
RECEIVER_LOST = lost("track_current", "valve")


def waited_out(s: Seen) -> Bit:
    """A held code above what has been in the rails: for as long as that, less has been received."""
    return all_of(
        *(implies(s.held > code, s.below >= age(s.code <= code, DETECTION)) for code in CODES[:-1]),
        s.below <= DETECTION - 1,
        s.above <= DETECTION - 1,
    )


@claim(ContinuousCode, expect=PROVED, lemmas=[waited_out], faults=at_most(2, RECEIVER_LOST), requirement="SP-C1",
       source="[P] continuous; codes, detection time [A]")  # fmt: skip
def restriction_acts_within_detection(s: Seen) -> Bit:
    """Once the rails have carried no more than a code for 0.5 s, the limit is no higher than the code's, whatever was
    in them before, and even if the current is lost."""
    return all_of(*(implies(persists(s.code <= code, ticks=DETECTION), s.limit <= LIMITS[code]) for code in CODES[:-1]))


@claim(ContinuousCode, expect=REFUTED, requirement="SP-C1", twin_of=restriction_acts_within_detection)
def restriction_acts_one_cycle_sooner(s: Seen) -> Bit:
    """Once the rails have carried no more than a code for 0.4 s, the limit is no higher than the code's."""
    held = (persists(s.code <= code, ticks=DETECTION - 1) for code in CODES[:-1])
    return all_of(*(implies(h, s.limit <= LIMITS[code]) for h, code in zip(held, CODES, strict=False)))


def counted(s: Seen) -> Bit:
    """What has been counted has been so: less, or more, than the held code was received for as long."""
    less, more = age(s.receiver < s.held, DETECTION), age(s.receiver > s.held, DETECTION)
    return all_of(s.below <= less, s.above <= more, s.below <= DETECTION - 1, s.above <= DETECTION - 1)


@claim(ContinuousCode, expect=PROVED, lemmas=[counted], requirement="SP-C1", source="[A] detection time")
def limit_rises_no_sooner(s: Seen) -> Bit:
    """A higher code is taken only when more than the held one has been in the rails for 0.5 s, and then the one that is
    there; the brake comes just above the limit, and at stop."""
    rises = s.decoded > s.held
    taken = implies(rises, persists(s.code > s.held, ticks=DETECTION) & (s.decoded == s.code))
    limits = (implies(s.decoded == code, s.limit == limit) for code, limit in enumerate(LIMITS))
    return all_of(taken, s.brake == ((s.v > s.limit) | (s.decoded == STOP)), *limits)


@claim(ContinuousCode, expect=REFUTED, requirement="SP-C1", twin_of=limit_rises_no_sooner,
       scenario=Scenario(8, {"code": CLEAR}))  # fmt: skip
def limit_never_rises(s: Seen) -> Bit:
    """No higher code is ever taken."""
    return all_of(s.decoded <= s.held)


HIGHER = Fault(byzantine(), ["receiver"], ANY_TIME, name="receiver decodes any code")


@claim(ContinuousCode, expect=REFUTED, defeat=True, faults=at_most(1, [HIGHER]), requirement="SP-C1",
       twin_of=restriction_acts_within_detection, source="[A] wrong-side: decodes a higher code")  # fmt: skip
def restriction_acts_whatever_the_receiver_decodes(s: Seen) -> Bit:
    """The restriction acts in time even with a receiver that decodes a higher code than there is.  False."""
    return implies(persists(s.code <= SLOW, ticks=DETECTION), s.limit <= LIMITS[SLOW])


@claim(ContinuousCode, expect=PROVED, faults=at_most(2, RECEIVER_LOST), symbolic=("detection",), requirement="SP-H1",
       source="[P] loss of current is the most restrictive")  # fmt: skip
def loss_takes_the_limit_to_zero(s: Seen) -> Bit:
    """In the cycle in which the current is lost, or carries no code, the limit is 0 and the brake comes, whatever the
    detection time."""
    return implies(~s.track_current | (s.code == STOP), (s.limit <= 0) & s.brake)


@claim(ContinuousCode, expect=REFUTED, defeat=True, faults=at_most(1, [HIGHER]), requirement="SP-H1",
       twin_of=loss_takes_the_limit_to_zero, source="[A] wrong-side: decodes a higher code")  # fmt: skip
def loss_takes_the_limit_to_zero_whatever_is_decoded(s: Seen) -> Bit:
    """Loss of the current takes the limit to 0 even with a receiver that decodes a code that is not there.  False."""
    return loss_takes_the_limit_to_zero(s)


@claim(ContinuousCode, expect=PROVED, symbolic=("detection",), faults=at_most(2, RECEIVER_LOST), requirement="SP-F1",
       source="[P] fail-safe direction")  # fmt: skip
def brakes_above_the_limit(s: Seen) -> Bit:
    """Faster than the limit of the held code, or with the valve's line without current, the brake comes at once."""
    return implies((s.v > allowed(s.decoded)) | ~s.valve, s.brake)


VALVE = Fault(stuck(1), ["valve"], ANY_TIME, name="valve does not vent")


@claim(ContinuousCode, expect=REFUTED, defeat=True, faults=at_most(1, [VALVE]), requirement="SP-F1",
       twin_of=brakes_above_the_limit)  # fmt: skip
def brakes_above_the_limit_with_any_valve(s: Seen) -> Bit:
    """Faster than the limit of the held code the brake comes, even if the valve does not vent.  False."""
    return brakes_above_the_limit(s)
