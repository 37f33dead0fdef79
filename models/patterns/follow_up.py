"""Follow-up control: after the brake start the brake effort is regulated so that the speed follows the curve.

The curve is v_ref^2 = 2 b_0 x.  Over a cycle T in which the deceleration is held, error e = v - v_ref and effort a go
exactly (law `error_over_a_cycle` in the proofs) by

    e' = (1 + 2q) e - T (1 + q) (a - b_0 + g i)        q = b_0 T / (v_ref + v_ref' - b_0 T)
    a' = a + (T / lag) (clip(b_0 + k e) - a)

so q says how far down the curve the train is: up to 0.007 from 18 km/h upwards.  One step is a cycle of 0.1 s.
Source: principle [P]; proportional law, gain, lag, limits of the effort [A].

Main results: the correction that a gradient demands is -g i: 0.1961 m/s^2 at 20 permille with one curve, 0.03923 with
five.  The error stays within 2.12 km/h with one curve and 0.43 with five, from 18 km/h upwards, if the limits of the
effort leave the margin.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from models.kinematics import B_SERVICE, CYCLE, Exact, G, Quantity
from safety import Model, Real, assume, parameter, point, power_up, require, select

GAIN, LAG = Fraction(1, 2), Fraction(1, 2)  # 1/s, s [A]
LEAST, MOST = Fraction(0), Fraction("1.2")  # m/s^2, limits of the effort [A]
SHARPEST = Fraction(7, 1000)  # q at a curve speed of 5 m/s and b_0 = 2.5 km/h/s
SHARE = Fraction(3, 2)  # of the demanded correction: e - (a - b_0) and a - b_0 stay within


class Regulated(NamedTuple):
    """What a cycle brings."""

    commanded: Real  # m/s^2
    correction: Real  # m/s^2, commanded less b_0, before the limits
    after: Real  # m/s, error at the end of the cycle
    effort: Real  # m/s^2, at the end of the cycle


class FollowUp(Model, tick_s="0.1"):
    """Regulator, brake with lag and limits, train on the curve; begun on the curve with its own deceleration."""

    error: Real = power_up(0)  # v - v_ref, m/s
    surplus: Real = power_up(0)  # a - b_0, m/s^2
    curve: Real = parameter(B_SERVICE, unit="m/s^2", within=(Fraction(1, 10), MOST), source="[A] b_0 of the curve")
    steepest: Real = parameter(
        20, unit="permille", within=(0, 40), source="[P] +-20, with five curves 4, off the curve's"
    )
    sharpest: Real = parameter(SHARPEST, unit="1", within=(0, 1), source="[D] q at 5 m/s and 2.5 km/h/s")

    def step(self, i: Real, q: Real) -> tuple[FollowUp, Regulated]:
        """Gradient less that of the curve, permille uphill positive; q of this place of the curve."""
        self.margin()
        assume("gradient within what the curve leaves", (i <= self.steepest) & (i >= -self.steepest))
        assume("not beyond the place up to which the curve is followed", (q >= 0) & (q <= self.sharpest))
        correction = GAIN * point("speed_error", self.error)
        wanted = point("regulator", self.curve + correction)
        commanded = select(wanted > MOST, MOST, select(wanted < LEAST, LEAST, wanted))
        surplus = self.surplus + CYCLE / LAG * (commanded - self.curve - self.surplus)
        off = self.surplus + pull(i)
        error = self.error + 2 * q * self.error - CYCLE * (off + q * off)
        effort = point("brake", surplus)
        return type(self)(error=error, surplus=effort), Regulated(commanded, correction, error, self.curve + effort)

    def margin(self) -> None:
        """The limits of the effort leave room for the correction."""
        most = GAIN * 2 * bound(self.steepest)
        kept = (self.curve + most <= MOST) & (self.curve - most >= LEAST)
        require("limits of the effort leave no margin", kept, lambda: f"the nearest admissible curves are {ends(most)}")


class WithoutMargin(FollowUp, tick_s="0.1"):
    """The variant to be refuted: the limits of the effort may leave no margin."""

    def margin(self) -> None:
        """Nothing is required."""


def ends(margin: Real) -> str:
    """The decelerations between which a margin is left, of parameters that are set."""
    return f"{float(LEAST + margin.attr):.4f} and {float(MOST - margin.attr):.4f} m/s^2"


def pull(i: Quantity) -> Quantity:
    """What a gradient adds to the deceleration, m/s^2."""
    return i * G / 1000


def bound(steepest: Quantity) -> Quantity:
    """Within what e - (a - b_0) and a - b_0 stay, so that |e| stays within twice that; m/s and m/s^2."""
    return SHARE * pull(steepest)


def sharpness(curve: Exact, speed: Exact) -> Fraction:
    """q of a cycle in which the curve's speed is `speed` in the mean, m/s."""
    return Fraction(curve * CYCLE) / (2 * Fraction(speed) - curve * CYCLE)
