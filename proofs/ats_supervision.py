"""ATS-SP supervision: the home signal is never passed while its target is active, and what each premise is for.

AV-1 stands as a law over all reals and on the model: one target, the brakes, and a train that does whatever the
premises allow, while other targets ask for the brake as they like; cycle, free run, brake, margin and place are left
open.  Each premise is necessary: without it a run or a point is found.
Source: one-stage pattern, service first [P]; m, t, b [A].
Main results: proved for ever with the pattern v_p where an order cuts traction, and with v_pc where it does not; the
plain pattern with traction going on overruns from 20 m at 4 m/s.
"""

from __future__ import annotations

from models.ats.ride import AcceleratingRide, GuardRide, NearEndRide, NoFreeRunRide
from models.kinematics import ACCELERATION
from proofs.premises import together
from safety import PROVED, REFUTED, Bit, Real, Seen, claim, implies

SOURCE = "[P] one-stage pattern; [A] m, t, b"
OPEN = ("train.cycle", "train.acts", "b_s", "t_s", "margin", "place")


def left(s: Seen) -> Real:
    """Way to the point m before the signal or switch."""
    return s.place - s.margin - s.train.head


def within_interval(s: Seen) -> Bit:
    """The train is not beyond s_hi."""
    return s.train.head <= s.where.high


def no_faster_than_read(s: Seen) -> Bit:
    """v_hi bounds the speed from the reading to the next one, unless the brake is ordered."""
    runs = (s.course.speed <= s.where.fastest) & (s.course.rolled <= s.where.fastest * s.train.cycle)
    return s.order | runs


def decelerates(s: Seen) -> Bit:
    """The brake gives b_s at least: the energy left is no more than what it still takes."""
    return implies(s.order, s.course.speed * s.course.speed <= 2 * s.b_s * (s.train.way - s.course.braked))


def made_in_time(s: Seen) -> Bit:
    """Where the target is made the train can still be stopped: d(v) + m before the signal, or farther out."""
    return implies(s.made & ~s.guard.target.active, left(s) >= s.train.roll + s.train.way)


def premises(s: Seen) -> Bit:
    """AV-1: within the interval, speed bounded, b_s at least, made in time."""
    return within_interval(s) & no_faster_than_read(s) & decelerates(s) & made_in_time(s)


def moving(s: Seen) -> Bit:
    """The ways are from 0 up."""
    return (s.train.roll >= 0) & (s.train.way >= 0)


def fits(s: Seen) -> Bit:
    """Lemma: what is left of the free run, and braking, fit in front of the target, which is that of the signal."""
    fit = (left(s) >= s.train.roll + s.train.way) & (s.guard.target.place == s.place)
    return moving(s) & implies(s.guard.target.active, fit)


@claim(GuardRide, expect=PROVED, start=moving, given=premises, lemmas=[fits], symbolic=OPEN, requirement="AV-1",
       source=SOURCE)  # fmt: skip
def signal_is_never_passed(s: Seen) -> Bit:
    """While the home signal's target is active the train is before the signal, by the margin, for ever and for all
    cycles, brakes, free runs, margins and places."""
    return implies(s.guard.target.active, s.train.head <= s.place - s.margin)


# --- each premise, left out ------------------------------------------------------------------------------------------


@claim(GuardRide, expect=REFUTED, start=moving, requirement="AV-1", source=SOURCE, twin_of=signal_is_never_passed,
       symbolic=OPEN, given=together(no_faster_than_read, decelerates, made_in_time))  # fmt: skip
def beyond_the_interval(s: Seen) -> Bit:
    """So it is where the train may be beyond s_hi."""
    return signal_is_never_passed(s)


@claim(GuardRide, expect=REFUTED, start=moving, requirement="AV-1", source=SOURCE, twin_of=signal_is_never_passed,
       symbolic=OPEN, given=together(within_interval, decelerates, made_in_time))  # fmt: skip
def faster_than_read(s: Seen) -> Bit:
    """So it is where the train may be faster than v_hi."""
    return signal_is_never_passed(s)


@claim(GuardRide, expect=REFUTED, start=moving, requirement="AV-1", source=SOURCE, twin_of=signal_is_never_passed,
       symbolic=OPEN, given=together(within_interval, no_faster_than_read, made_in_time))  # fmt: skip
def braking_too_little(s: Seen) -> Bit:
    """So it is where the brake gives less than b_s."""
    return signal_is_never_passed(s)


@claim(GuardRide, expect=REFUTED, start=moving, requirement="AV-1", source=SOURCE, twin_of=signal_is_never_passed,
       symbolic=OPEN, given=together(within_interval, no_faster_than_read, decelerates))  # fmt: skip
def made_too_late(s: Seen) -> Bit:
    """So it is where the target is made too late."""
    return signal_is_never_passed(s)


@claim(GuardRide, expect=REFUTED, start=moving, requirement="AV-1", source=SOURCE, twin_of=signal_is_never_passed,
       symbolic=OPEN, given=premises, settings={"train.push": ACCELERATION})  # fmt: skip
def with_traction_going_on(s: Seen) -> Bit:
    """So it is where an order does not cut traction."""
    return signal_is_never_passed(s)


@claim(NearEndRide, expect=REFUTED, start=moving, requirement="AV-1", source=SOURCE, twin_of=signal_is_never_passed,
       symbolic=OPEN, given=premises)  # fmt: skip
def from_the_near_end(s: Seen) -> Bit:
    """So it is with distances from the near end of the interval."""
    return signal_is_never_passed(s)


@claim(NoFreeRunRide, expect=REFUTED, start=moving, requirement="AV-1", source=SOURCE, twin_of=signal_is_never_passed,
       symbolic=OPEN, given=premises)  # fmt: skip
def without_free_run(s: Seen) -> Bit:
    """So it is with the free run left out of the pattern."""
    return signal_is_never_passed(s)


# --- the conservative pattern ----------------------------------------------------------------------------------------


def pushed(s: Seen) -> Bit:
    """What traction gains after an order is within what the pattern allows for."""
    return premises(s) & (s.train.push <= s.guard.a_max)


@claim(AcceleratingRide, expect=PROVED, start=moving, given=pushed, lemmas=[fits],
       symbolic=(*OPEN, "train.push", "guard.a_max"), requirement="AV-1", source=SOURCE)  # fmt: skip
def signal_is_never_passed_with_traction(s: Seen) -> Bit:
    """With the conservative pattern the same holds where traction goes on after an order."""
    return signal_is_never_passed(s)


@claim(AcceleratingRide, expect=REFUTED, start=moving, given=premises, symbolic=(*OPEN, "train.push", "guard.a_max"),
       requirement="AV-1", source=SOURCE, twin_of=signal_is_never_passed_with_traction)  # fmt: skip
def signal_is_never_passed_with_more_traction(s: Seen) -> Bit:
    """So it does where traction is more than the pattern allows for."""
    return signal_is_never_passed_with_traction(s)
