"""The odometer's interval holds the train through every slip and slide: for ever, all accelerations, all parameters.

Each premise is dropped once, and the run that it excludes is shown.  The weakest spots are the two that no odometer
can check for itself: that a slip or slide is seen at all, and that it is over when wheel and estimate agree again.
Source: AP-1 to AP-3; slip and slide corrected, only balises bound what stays undetected [P]; numbers [A].

Main results: with the premises the train never leaves the interval; the plain count is 56.4 m short after 3 s with a
locked wheel, and 120 m after 1 km of creep by 12 %.  "No gain of speed while the wheel slides" has to be taken of the
means over cycles, from the cycle before SLIDE on: a slide begins within a cycle, perhaps above v_0, and in SLIDE the
train may grip, gain and slide again.  Both are covered when the odometer keeps the highest speed that the wheel has
shown, and 2 a_hi T more.  The estimate itself can leave the interval.
"""

from __future__ import annotations

from fractions import Fraction
from typing import cast

from models.position.ride import RememberingRide, Ride
from proofs.premises import Premise, together
from safety import PROVED, REFUTED, Bit, Scenario, Seen, claim, implies, previous, real, select

WATCH = ("a_slip", "a_slide", "agrees", "recovery")
MOTION = tuple(f"odometer.{name}" for name in ("cycle", "eps", "a_hi", "b_hi"))
ALL = (*MOTION, *(f"odometer.watch.{name}" for name in WATCH))


def was_normal(s: Seen) -> Bit:
    """NORMAL in the cycle before."""
    return ~s.odometer.watch.slip & ~s.odometer.watch.slide


def is_normal(s: Seen) -> Bit:
    """NORMAL in this cycle."""
    return ~s.odometer.watch.slipping & ~s.odometer.watch.sliding


def grips(s: Seen) -> Bit:
    """The wheel neither spins nor slides."""
    return ~s.at.spins & ~s.at.slides


# --- premises --------------------------------------------------------------------------------------------------------


def scale(s: Seen) -> Bit:
    """A wheel that does not slide shows at most eps too little, one that does not spin at most eps too much"""
    return (s.at.slides | s.kept.under) & (s.at.spins | s.kept.over)


def gains(s: Seen) -> Bit:
    """the train gains at most a_hi"""
    return s.kept.gains


def loses(s: Seen) -> Bit:
    """it loses at most b_hi"""
    return s.kept.loses


def brakes(s: Seen) -> Bit:
    """in SLIDE it gains no speed"""
    return implies(s.odometer.watch.sliding, s.at.gain <= 0)


def no_traction(s: Seen) -> Bit:
    """in SLIDE no wheel spins"""
    return ~(s.odometer.watch.sliding & s.at.spins)


def onset(s: Seen) -> Bit:
    """slip and slide are detected at their onset"""
    unseen = s.odometer.watch.slipping & ~s.odometer.watch.fallen & s.at.slides
    return implies(was_normal(s) & is_normal(s), grips(s)) & ~unseen


def adhesion(s: Seen) -> Bit:
    """recovery is declared only after real re-adhesion"""
    return implies(~was_normal(s) & is_normal(s), grips(s))


def true_fix(s: Seen) -> Bit:
    """a fix holds the train"""
    return implies(s.fix.given, (s.fix.low <= s.way) & (s.way <= s.fix.high))


PREMISES: tuple[Premise, ...] = (scale, gains, loses, brakes, no_traction, onset, adhesion, true_fix)


def without(left_out: Premise) -> Premise:
    """All but one."""
    return together(*(each for each in PREMISES if each is not left_out))


# --- the interval ----------------------------------------------------------------------------------------------------


def within(s: Seen) -> Bit:
    """The train's head lies in the interval at the end of the cycle."""
    return (s.odometer.low <= s.there) & (s.there <= s.odometer.high)


def speed_is_bounded(s: Seen) -> Bit:
    """The true mean speed lies between `floor` and `top`, and is none below 0."""
    bounds = s.odometer.bounds
    return (bounds.floor <= s.speed) & (s.speed <= bounds.top) & (s.speed >= 0)


def train_is_inside(s: Seen) -> Bit:
    """The train is in the interval."""
    return (s.odometer.s_lo <= s.way) & (s.way <= s.odometer.s_hi)


LEMMAS = (speed_is_bounded, train_is_inside)


@claim(Ride, expect=PROVED, symbolic=ALL, given=together(*PREMISES), lemmas=LEMMAS, requirement="AP-1",
       source="[P] slip and slide corrected; rules, parameters [A]")  # fmt: skip
def interval_holds_the_train(s: Seen) -> Bit:
    """The head of the train lies in [s_lo, s_hi] at the end of every cycle, whatever it gains and loses, whatever the
    wheel shows, for every cycle time, scale error, limit of acceleration and threshold of detection."""
    return within(s)


@claim(Ride, expect=PROVED, symbolic=ALL, given=together(*PREMISES), lemmas=LEMMAS, requirement="AP-1",
       source="[D] supervision needs the speed at the end of a cycle, not its mean")  # fmt: skip
def speed_is_bounded_at_the_end(s: Seen) -> Bit:
    """The speed at the end of a cycle, anywhere between its mean less b_hi T and its mean plus a_hi T, lies in
    [v_lo, v_hi]."""
    return ((s.odometer.slowest <= s.least) | (s.odometer.slowest <= 0)) & (s.most <= s.odometer.fastest)


@claim(Ride, expect=REFUTED, given=together(*PREMISES), requirement="AP-1", twin_of=speed_is_bounded_at_the_end)
def mean_bounds_the_speed(s: Seen) -> Bit:
    """The speed at the end of a cycle is at most the speed that enters s_hi.  False: that one is a mean."""
    return s.most <= s.odometer.bounds.high


def no_fix(s: Seen) -> Bit:
    """no fix comes"""
    return ~s.fix.given


@claim(Ride, expect=REFUTED, given=together(*PREMISES, no_fix), requirement="AP-1", twin_of=interval_holds_the_train,
       steps=6, defeat=True)  # fmt: skip
def estimate_is_inside(s: Seen) -> Bit:
    """The estimate lies in [s_lo, s_hi] as the train does.  False: in SLIDE s_lo goes with a wheel that turns faster
    than the estimate."""
    return (s.odometer.low <= s.odometer.guess) & (s.odometer.guess <= s.odometer.high)


# --- every premise is needed -----------------------------------------------------------------------------------------


@claim(Ride, expect=REFUTED, given=without(scale), requirement="AP-1", twin_of=interval_holds_the_train)
def inside_with_any_scale(s: Seen) -> Bit:
    """The interval holds the train whatever the scale error.  False: a wheel larger than set is enough."""
    return within(s)


@claim(Ride, expect=REFUTED, given=without(gains), requirement="AP-1", twin_of=interval_holds_the_train)
def inside_with_any_gain(s: Seen) -> Bit:
    """The interval holds the train however fast it gains speed.  False: in SLIP it leaves s_hi behind."""
    return within(s)


@claim(Ride, expect=REFUTED, given=without(loses), requirement="AP-1", twin_of=interval_holds_the_train, steps=6)
def inside_with_any_loss(s: Seen) -> Bit:
    """The interval holds the train however hard it brakes.  False: in SLIP or SLIDE it stays behind s_lo."""
    return within(s)


@claim(Ride, expect=REFUTED, given=without(brakes), requirement="AP-1", twin_of=interval_holds_the_train)
def inside_with_gain_in_a_slide(s: Seen) -> Bit:
    """The interval holds a train that may gain speed in SLIDE.  False: s_hi holds v_0."""
    return within(s)


@claim(Ride, expect=REFUTED, given=without(no_traction), requirement="AP-1", twin_of=interval_holds_the_train)
def inside_with_spin_in_a_slide(s: Seen) -> Bit:
    """The interval holds a train whose wheel may spin in SLIDE.  False: s_lo follows the wheel."""
    return within(s)


@claim(Ride, expect=REFUTED, given=without(onset), requirement="AP-1", twin_of=interval_holds_the_train)
def inside_with_creep(s: Seen) -> Bit:
    """The interval holds the train when a slip or slide need not be detected.  False: creep below the thresholds."""
    return within(s)


def locked(k: int) -> dict[str, Fraction]:
    """Up to 1 m/s, a cycle of braking by 1 m/s^2, then a wheel that is locked while the train rolls on at 0.9 m/s."""
    return {"gain": Fraction(1 if k < 10 else -1 if k == 10 else 0), "wheel": Fraction(min(k + 1, 10) - (k == 10), 10)}


LOCKED = Scenario(22, {
    "at.gain": lambda k: locked(k)["gain"], "at.wheel": lambda k: locked(k)["wheel"] if k < 11 else 0,
    "at.slides": lambda k: k > 10,
})  # fmt: skip


@claim(Ride, expect=REFUTED, given=without(adhesion), requirement="AP-1", twin_of=interval_holds_the_train,
       scenario=LOCKED, defeat=True, source="[A] recovery at 1 km/h for 0.5 s")  # fmt: skip
def inside_with_the_recovery_test_alone(s: Seen) -> Bit:
    """The interval holds the train when recovery is what the test says.  False: a wheel locked to the end agrees with
    an estimate that has come to 0 too early, and counts as a train that stands."""
    return within(s)


@claim(Ride, expect=REFUTED, given=without(true_fix), requirement="AP-1", twin_of=interval_holds_the_train)
def inside_after_any_fix(s: Seen) -> Bit:
    """The interval holds the train after any fix.  False: one from a wrong balise moves it away."""
    return within(s)


# --- weaker premises, and what they take -----------------------------------------------------------------------------


def brakes_after_onset(s: Seen) -> Bit:
    """in SLIDE, but for the cycle in which it begins, the train gains no speed"""
    return implies(s.odometer.watch.sliding & s.odometer.watch.slide, s.at.gain <= 0)


def slid_before(s: Seen) -> Bit:
    """The wheel slid in the cycle before."""
    return cast(Bit, previous(s.at.slides, False))


def slid_twice(s: Seen) -> Bit:
    """The wheel slid in the two cycles before."""
    return slid_before(s) & cast(Bit, previous(slid_before(s), False))


def brakes_in_a_slide(s: Seen) -> Bit:
    """while the wheel slides the train gains no speed, but for the first two cycles"""
    return implies(s.odometer.watch.sliding & s.at.slides & slid_twice(s), s.at.gain <= 0)


def weaker(premise: Premise) -> Premise:
    """Another premise in place of that of no gain in SLIDE."""
    return together(*(premise if each is brakes else each for each in PREMISES))


@claim(Ride, expect=REFUTED, given=weaker(brakes_after_onset), requirement="AP-1", twin_of=interval_holds_the_train,
       steps=4, defeat=True)  # fmt: skip
def inside_with_gain_until_the_onset(s: Seen) -> Bit:
    """The interval holds a train that gains no speed after the cycle in which SLIDE begins.  False: v_0 is the mean of
    the cycle before, not the speed at which the slide begins."""
    return within(s)


@claim(Ride, expect=REFUTED, given=weaker(brakes_in_a_slide), requirement="AP-1", twin_of=interval_holds_the_train,
       steps=5, defeat=True)  # fmt: skip
def inside_with_gain_while_gripping(s: Seen) -> Bit:
    """The interval holds a train that gains no speed while the wheel slides.  False: in SLIDE, before NORMAL is
    declared, it may grip, gain speed and slide again, which is no slide of its own for the rule."""
    return within(s)


def one_mode(s: Seen) -> Bit:
    """SLIP or SLIDE or NORMAL; in NORMAL no wheel has slid."""
    watch = s.odometer.watch
    return ~(watch.slip & watch.slide) & implies(slid_before(s), ~was_normal(s))


def speed_is_above_floor(s: Seen) -> Bit:
    """The true mean speed is at least `floor`, and is none below 0."""
    return (s.odometer.bounds.floor <= s.speed) & (s.speed >= 0)


def speed_is_below_top(s: Seen) -> Bit:
    """The true mean speed is at most `top`, and what one or two cycles can gain once the wheel slides."""
    slide, gain = s.odometer.watch.slide, s["odometer.a_hi"] * s["odometer.cycle"]
    grown = select(slide & slid_twice(s), 2 * gain, select(slide & slid_before(s), gain, real(0)))
    return s.speed <= s.odometer.bounds.top + grown


@claim(RememberingRide, expect=PROVED, symbolic=MOTION, given=weaker(brakes_in_a_slide), requirement="AP-1",
       lemmas=[one_mode, speed_is_above_floor, speed_is_below_top, train_is_inside],
       source="[A] in SLIDE the odometer keeps the highest speed that the wheel has shown, and 2 a_hi T")  # fmt: skip
def inside_in_the_variant(s: Seen) -> Bit:
    """The variant's interval holds a train that gains no speed while the wheel slides but for the first two cycles, for
    every cycle time, scale error and limit of acceleration."""
    return within(s)
