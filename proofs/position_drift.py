"""What the plain count is worth: drift between balises, and how far it falls behind in a slide, in creep, with a wheel
set wrongly.

Source: AP-2, AP-3; balises at most about 1 km apart [P]; scale error 1 %, jitter 0.1 m, braking 0.8 m/s^2 [A].

Main results: without slip, slide or creep at most e + 1 % of the way since the last balise, 10.1 m in 1 km; 56.4 m
short after 3 s with a locked wheel from 20 m/s; 120 m short after 1 km of creep by 12 %, which no threshold sees.
"""

from __future__ import annotations

from fractions import Fraction

from models.position.ride import Ride
from proofs.position_odometer import PREMISES, grips, is_normal, scale, was_normal
from proofs.premises import together
from safety import PROVED, REFUTED, Bit, Real, Scenario, Seen, claim, implies, real
from safety.prove.bounds import Bound, between, claim_bracket, magnitude, reals
from safety.prove.laws import law

JITTER, SCALE, FARTHEST = Fraction(1, 10), Fraction(1, 100), 1000  # m, 1, m
SOURCE = "[P] balises at most about 1 km apart; 1 %, 0.1 m [A]"


# --- drift -----------------------------------------------------------------------------------------------------------


def from_a_balise(s: Seen) -> Bit:
    """NORMAL, a balise within 0.1 m of its place has just set position and count"""
    off = s.way - s.odometer.s
    return was_normal(s) & (s.raw == 0) & (off <= JITTER) & (-off <= JITTER) & (s.speed >= 0)


def gripping(s: Seen) -> Bit:
    """the wheel grips, nothing is taken for a slip or slide, no further fix, scale error at most 1 %"""
    return grips(s) & is_normal(s) & scale(s) & ~s.fix.given


def drifts(off: Real, allowed: Real) -> Bit:
    """Whether a distance either way is within what is allowed."""
    return (off <= allowed) & (-off <= allowed)


def drift_so_far(s: Seen) -> Bit:
    """The estimate is off by e and 1 % of the count at most, in NORMAL."""
    return was_normal(s) & drifts(s.way - s.odometer.s, JITTER + SCALE * s.raw)


@claim(Ride, expect=PROVED, given=gripping, start=from_a_balise, anywhere=True, lemmas=[drift_so_far],
       requirement="AP-3", source=SOURCE)  # fmt: skip
def drift_is_within_e_and_scale(s: Seen) -> Bit:
    """Since a matched balise the estimate is off by at most 0.1 m and 1 % of the counted way; within 1 km, 10.1 m."""
    off = s.there - s.odometer.guess
    near = drifts(off, real(JITTER + SCALE * FARTHEST))
    return drifts(off, JITTER + SCALE * s.counted) & implies(s.counted <= FARTHEST, near)


@claim(Ride, expect=REFUTED, given=gripping, start=from_a_balise, anywhere=True, requirement="AP-3",
       twin_of=drift_is_within_e_and_scale)  # fmt: skip
def drift_is_within_scale(s: Seen) -> Bit:
    """Since a matched balise the estimate is off by at most 1 % of the counted way.  False: the balise has jitter."""
    return drifts(s.there - s.odometer.guess, SCALE * s.counted)


jitter, error, counted = reals("jitter error counted")
claim_bracket(
    Bound(
        "position_drift.error_before_the_next_balise",
        "Error of the estimate up to 1 km after a matched balise, without slip, slide or creep",
        magnitude(jitter + error * counted),
        (between(-JITTER, jitter, JITTER), between(-SCALE, error, SCALE), between(0, counted, FARTHEST)),
        unit="m",
        requirement="AP-3",
        source=SOURCE,
        assumed=("[A] scale error 1 %", "[A] jitter 0.1 m"),
    )
)


# --- slide and creep -------------------------------------------------------------------------------------------------


def at_20(s: Seen) -> Bit:
    """NORMAL at 20 m/s, everything known exactly"""
    return moving_at(s, 20)


def at_25(s: Seen) -> Bit:
    """NORMAL at 25 m/s, the wheel 12 % slower, everything else known exactly"""
    return moving_at(s, 25, creep=Fraction("0.12"))


def moving_at(s: Seen, speed: int, creep: Fraction = Fraction(0), trend: Fraction = Fraction(0)) -> Bit:
    """NORMAL at a speed, at 0 m."""
    o, watch, bounds = s.odometer, s.odometer.watch, s.odometer.bounds
    known = (s.way == 0) & (s.raw == 0) & (o.s == 0) & (o.s_lo == 0) & (o.s_hi == 0)
    wheel = (s.speed == speed) & (watch.wheel == speed * (1 - creep)) & (watch.guess == watch.wheel)
    bounded = (bounds.floor == watch.wheel * (1 - SCALE)) & (bounds.top == watch.wheel * (1 + SCALE))
    return was_normal(s) & known & wheel & bounded & (watch.trend == trend) & (watch.near == 0) & ~watch.fell


def start_at(speed: int, creep: Fraction = Fraction(0)) -> dict[str, Fraction]:
    """The registers of such a start."""
    wheel = speed * (1 - creep)
    return {
        "speed": Fraction(speed), "odometer.watch.wheel": wheel, "odometer.watch.guess": wheel,
        "odometer.bounds.floor": wheel * (1 - SCALE), "odometer.bounds.top": wheel * (1 + SCALE),
    }  # fmt: skip


BRAKING = Fraction("0.8")  # m/s^2, true
LOCKED = {"at.gain": lambda k: -BRAKING / (2 if k == 0 else 1), "at.slides": True}


@claim(Ride, expect=REFUTED, given=together(*PREMISES), start=at_20, anywhere=True, requirement="AP-2", defeat=True,
       scenario=Scenario(30, LOCKED, start_at(20)), source="[D] 20 m/s, 0.8 m/s^2, 3 s: 56.4 m")  # fmt: skip
def count_falls_less_than_56_4_short(s: Seen) -> Bit:
    """The plain count of the wheel's way falls less than 56.4 m behind, from 20 m/s on.  False: a wheel that is locked
    for 3 s of braking by 0.8 m/s^2; the interval holds the train all the while."""
    return s.there - s.counted < Fraction("56.4")


CREEP = Scenario(400, {"at.wheel": 22, "at.slides": True}, start_at(25, Fraction("0.12")))


@claim(Ride, expect=REFUTED, start=at_25, anywhere=True, requirement="AP-1", defeat=True, scenario=CREEP,
       source="[D] 12 % of 1 km")  # fmt: skip
def creep_stays_below_120_m(s: Seen) -> Bit:
    """Within 1 km the estimate falls less than 120 m behind.  False: creep by 12 % at constant speed shows no
    acceleration that the detection could see."""
    return implies(s.there <= FARTHEST, s.there - s.odometer.guess < 120)


# --- the estimate in a slide -----------------------------------------------------------------------------------------


@law(expect=PROVED, requirement="AP-2", source="[D] constant decelerations")
def estimate_is_ahead_of_the_train(v: Real, t: Real, true: Real, taken: Real) -> Bit:
    """After t seconds of a slide an estimate that brakes by b_ref is (b_true - b_ref) t^2 / 2 ahead of the train: not
    behind it if and only if b_ref <= b_true."""
    ahead = (2 * v * t - taken * t * t) - (2 * v * t - true * t * t)
    return implies(t > 0, (ahead == (true - taken) * t * t) & ((ahead >= 0) == (taken <= true)))


def braking_at_20(s: Seen) -> Bit:
    """NORMAL at 20 m/s, braking by 1.0 m/s^2 so far, everything known exactly"""
    return moving_at(s, 20, trend=Fraction("-0.1"))


@claim(Ride, expect=REFUTED, given=together(*PREMISES), start=braking_at_20, anywhere=True, requirement="AP-2",
       defeat=True, scenario=Scenario(30, LOCKED, start_at(20) | {"odometer.watch.trend": Fraction("-0.1")}),
       source="[D] b_ref 1.0 m/s^2, true 0.8 m/s^2: 0.9 m")  # fmt: skip
def estimate_is_less_than_0_9_m_behind(s: Seen) -> Bit:
    """In a slide the estimate is less than 0.9 m behind the train.  False: it goes on with the braking before the
    slide, which was harder than the braking in it."""
    return s.there - s.odometer.guess < Fraction("0.9")
