"""Kinematics as laws: for all real speeds, distances, brakes, free runs and accelerations, without any bound.

c is the ceiling, given by its definition with the square root; v the speed, x the distance left, b the effective
deceleration, t the free run.  A premise that is not listed is not needed; each that is listed has its twin without it.
Source: speed patterns, common physics and properties SP-P1 to SP-P6 [D].

Main results: under the ceiling the stop fits, above it it does not, and ceiling and distance are inverse to each other.
"""

from __future__ import annotations

from models.kinematics import (
    intervenes,
    is_ceiling,
    is_ceiling_accelerating,
    need,
    permits,
    permits_accelerating,
    stops_accelerating,
    stops_within,
)
from safety import PROVED, REFUTED, Bit, Real, implies
from safety.prove.laws import law

SOURCE = "[D] constant deceleration after a free run at constant speed"


# --- the rule without a root is the ceiling -------------------------------------------------------------------------


@law(expect=PROVED, requirement="SP-P1", source=SOURCE)
def permits_is_the_ceiling(v: Real, x: Real, b: Real, t: Real, v1: Real, c: Real) -> Bit:
    """What the rule without a square root permits is v <= v_p(x, v1), and it intervenes exactly where v > v_p."""
    known = (v >= 0) & (b > 0) & (t >= 0) & (v1 >= 0) & is_ceiling(c, x, b, t, v1)
    return implies(known, (permits(v, x, b, t, v1) == (v <= c)) & (intervenes(v, x, b, t, v1) == (v > c)))


@law(expect=REFUTED, requirement="SP-P1", source=SOURCE, twin_of=permits_is_the_ceiling)
def permits_is_the_ceiling_of_free_runs_below_zero(v: Real, x: Real, b: Real, t: Real, v1: Real, c: Real) -> Bit:
    """The same for any free run.  False below 0: the ceiling may then lie below v1."""
    known = (v >= 0) & (b > 0) & (v1 >= 0) & is_ceiling(c, x, b, t, v1)
    return implies(known, permits(v, x, b, t, v1) == (v <= c))


@law(expect=PROVED, requirement="SP-P3", source=SOURCE)
def permits_accelerating_is_the_conservative_ceiling(v: Real, x: Real, b: Real, t: Real, a: Real, c: Real) -> Bit:
    """What the conservative rule without a square root permits is v <= v_pc(x), not clamped."""
    known = (v >= 0) & (b > 0) & (t >= 0) & (a >= 0) & is_ceiling_accelerating(c, x, b, t, a)
    return implies(known, permits_accelerating(v, x, b, t, a) == (v <= c))


# --- SP-P1: under the ceiling the stop fits --------------------------------------------------------------------------


@law(expect=PROVED, requirement="SP-P1", source=SOURCE)
def stop_fits(v: Real, x: Real, b: Real, t: Real, c: Real) -> Bit:
    """Who is not above the ceiling stops within the distance left: v t + v^2 / 2b <= x."""
    return implies((v >= 0) & (x >= 0) & (b > 0) & is_ceiling(c, x, b, t) & (v <= c), stops_within(v, x, b, t))


@law(expect=REFUTED, requirement="SP-P1", source=SOURCE, twin_of=stop_fits)
def stop_fits_behind_the_point(v: Real, x: Real, b: Real, t: Real, c: Real) -> Bit:
    """The same wherever the point is.  False behind it: v = 0 is permitted at x = -1."""
    return implies((v >= 0) & (b > 0) & is_ceiling(c, x, b, t) & (v <= c), stops_within(v, x, b, t))


@law(expect=REFUTED, requirement="SP-P1", source=SOURCE, twin_of=stop_fits)
def stop_fits_running_backwards(v: Real, x: Real, b: Real, t: Real, c: Real) -> Bit:
    """The same for any speed.  False below 0: a train that runs backwards is no slower."""
    return implies((x >= 0) & (b > 0) & is_ceiling(c, x, b, t) & (v <= c), stops_within(v, x, b, t))


@law(expect=REFUTED, requirement="SP-P1", source=SOURCE, twin_of=stop_fits)
def stop_fits_without_a_brake(v: Real, x: Real, b: Real, t: Real, c: Real) -> Bit:
    """The same for any deceleration.  False below 0, where the train gains speed."""
    return implies((v >= 0) & (x >= 0) & is_ceiling(c, x, b, t) & (v <= c), stops_within(v, x, b, t))


# --- SP-P2: braking keeps v^2 <= 2 b X -------------------------------------------------------------------------------


def braked_for(v: Real, x: Real, b: Real, d: Real, h: Real) -> Bit:
    """After h seconds at deceleration d the speed still fits: (v - d h)^2 <= 2 b (x - v h + d h^2 / 2)."""
    return (v - d * h) * (v - d * h) <= 2 * b * (x - v * h) + b * d * h * h


@law(expect=PROVED, requirement="SP-P2", source=SOURCE)
def braking_keeps_the_stop(v: Real, x: Real, b: Real, d: Real, h: Real) -> Bit:
    """Whose stop fits and who brakes at b or more still fits at every later instant up to standstill."""
    known = (v * v <= 2 * b * x) & (d >= b) & (v >= d * h) & (h >= 0) & (v >= 0)
    return implies(known, braked_for(v, x, b, d, h))


@law(expect=REFUTED, requirement="SP-P2", source=SOURCE, twin_of=braking_keeps_the_stop)
def braking_less_keeps_the_stop(v: Real, x: Real, b: Real, d: Real, h: Real) -> Bit:
    """The same for any deceleration.  False: v = 1, x = 1, b = 1, d = 0, h = 1."""
    known = (v * v <= 2 * b * x) & (v >= d * h) & (h >= 0) & (v >= 0)
    return implies(known, braked_for(v, x, b, d, h))


@law(expect=REFUTED, requirement="SP-P2", source=SOURCE, twin_of=braking_keeps_the_stop)
def braking_keeps_the_stop_beyond_standstill(v: Real, x: Real, b: Real, d: Real, h: Real) -> Bit:
    """The same for any time.  False beyond standstill: the formula then runs backwards."""
    known = (v * v <= 2 * b * x) & (d >= b) & (h >= 0) & (v >= 0)
    return implies(known, braked_for(v, x, b, d, h))


@law(expect=REFUTED, requirement="SP-P2", source=SOURCE, twin_of=braking_keeps_the_stop)
def braking_kept_the_stop_before(v: Real, x: Real, b: Real, d: Real, h: Real) -> Bit:
    """The same for times before.  False: a train that brakes harder than b was too fast earlier."""
    known = (v * v <= 2 * b * x) & (d >= b) & (v >= d * h) & (v >= 0)
    return implies(known, braked_for(v, x, b, d, h))


@law(expect=REFUTED, requirement="SP-P2", source=SOURCE, twin_of=braking_keeps_the_stop)
def braking_keeps_the_stop_running_backwards(v: Real, x: Real, b: Real, d: Real, h: Real) -> Bit:
    """The same for any speed.  False below 0, with decelerations below 0."""
    known = (v * v <= 2 * b * x) & (d >= b) & (v >= d * h) & (h >= 0)
    return implies(known, braked_for(v, x, b, d, h))


# --- SP-P3: the same with acceleration in the reaction ---------------------------------------------------------------


@law(expect=PROVED, requirement="SP-P3", source=SOURCE)
def stop_fits_after_accelerating(v: Real, x: Real, b: Real, t: Real, a: Real, c: Real) -> Bit:
    """Who is not above the conservative ceiling may accelerate by a for t, and the stop then fits."""
    known = (v >= 0) & (b > 0) & (t >= 0) & (a >= 0) & is_ceiling_accelerating(c, x, b, t, a) & (v <= c)
    return implies(known, stops_accelerating(v, x, b, t, a))


@law(expect=REFUTED, requirement="SP-P3", source=SOURCE, twin_of=stop_fits_after_accelerating)
def stop_fits_after_accelerating_under_a_clamped_ceiling(v: Real, x: Real, b: Real, t: Real, a: Real, c: Real) -> Bit:
    """The same with a ceiling below 0 taken as 0.  False: v = 0, x = 1/8, a = b = t = 1."""
    known = (v >= 0) & (x >= 0) & (b > 0) & (t >= 0) & (a >= 0) & is_ceiling_accelerating(c, x, b, t, a)
    return implies(known & ((v <= c) | (v <= 0)), stops_accelerating(v, x, b, t, a))


@law(expect=REFUTED, requirement="SP-P3", source=SOURCE, twin_of=stop_fits_after_accelerating)
def stop_fits_after_accelerating_backwards(v: Real, x: Real, b: Real, t: Real, a: Real, c: Real) -> Bit:
    """The same for any speed.  False below 0."""
    known = (b > 0) & (t >= 0) & (a >= 0) & is_ceiling_accelerating(c, x, b, t, a) & (v <= c)
    return implies(known, stops_accelerating(v, x, b, t, a))


@law(expect=REFUTED, requirement="SP-P3", source=SOURCE, twin_of=stop_fits_after_accelerating)
def stop_fits_after_accelerating_without_a_brake(v: Real, x: Real, b: Real, t: Real, a: Real, c: Real) -> Bit:
    """The same for any deceleration.  False below 0."""
    known = (v >= 0) & (t >= 0) & (a >= 0) & is_ceiling_accelerating(c, x, b, t, a) & (v <= c)
    return implies(known, stops_accelerating(v, x, b, t, a))


@law(expect=REFUTED, requirement="SP-P3", source=SOURCE, twin_of=stop_fits_after_accelerating)
def stop_fits_after_a_reaction_below_zero(v: Real, x: Real, b: Real, t: Real, a: Real, c: Real) -> Bit:
    """The same for any reaction time.  False below 0."""
    known = (v >= 0) & (b > 0) & (a >= 0) & is_ceiling_accelerating(c, x, b, t, a) & (v <= c)
    return implies(known, stops_accelerating(v, x, b, t, a))


@law(expect=REFUTED, requirement="SP-P3", source=SOURCE, twin_of=stop_fits_after_accelerating)
def stop_fits_after_braking_in_the_reaction(v: Real, x: Real, b: Real, t: Real, a: Real, c: Real) -> Bit:
    """The same for accelerations below 0.  False: the train would have turned round before the reaction ends."""
    known = (v >= 0) & (b > 0) & (t >= 0) & is_ceiling_accelerating(c, x, b, t, a) & (v <= c)
    return implies(known, stops_accelerating(v, x, b, t, a))


# --- SP-P4: the latest intervention ----------------------------------------------------------------------------------


@law(expect=PROVED, requirement="SP-P4", source=SOURCE, assumed=("[A] deceleration exactly b, free run exactly t",))
def above_the_ceiling_it_overruns(v: Real, x: Real, b: Real, t: Real, c: Real) -> Bit:
    """Whatever speed above the ceiling a rule permits, the train overruns: v t + v^2 / 2b > x."""
    return implies((b > 0) & (t >= 0) & is_ceiling(c, x, b, t) & (v > c), need(v, b, t) > 2 * b * x)


@law(expect=REFUTED, requirement="SP-P4", source=SOURCE, twin_of=above_the_ceiling_it_overruns)
def at_the_ceiling_it_overruns(v: Real, x: Real, b: Real, t: Real, c: Real) -> Bit:
    """The same at the ceiling.  False: there the stop just fits, so equality does not intervene."""
    return implies((b > 0) & (t >= 0) & is_ceiling(c, x, b, t) & (v >= c), need(v, b, t) > 2 * b * x)


@law(expect=REFUTED, requirement="SP-P4", source=SOURCE, twin_of=above_the_ceiling_it_overruns)
def above_the_ceiling_it_overruns_without_a_brake(v: Real, x: Real, b: Real, t: Real, c: Real) -> Bit:
    """The same for any b.  False below 0."""
    return implies((t >= 0) & is_ceiling(c, x, b, t) & (v > c), need(v, b, t) > 2 * b * x)


@law(expect=REFUTED, requirement="SP-P4", source=SOURCE, twin_of=above_the_ceiling_it_overruns)
def above_the_ceiling_it_overruns_after_a_free_run_below_zero(v: Real, x: Real, b: Real, t: Real, c: Real) -> Bit:
    """The same for any free run.  False below 0."""
    return implies((b > 0) & is_ceiling(c, x, b, t) & (v > c), need(v, b, t) > 2 * b * x)


@law(expect=REFUTED, requirement="SP-P4", source=SOURCE, twin_of=above_the_ceiling_it_overruns)
def above_the_ceiling_a_better_brake_overruns(v: Real, x: Real, b: Real, d: Real, t: Real, c: Real) -> Bit:
    """The same for a brake d that is better than b.  False: who has more than is guaranteed may stop in time."""
    return implies((b > 0) & (d >= b) & (t >= 0) & is_ceiling(c, x, b, t) & (v > c), need(v, d, t) > 2 * d * x)


@law(expect=REFUTED, requirement="SP-P4", source=SOURCE, twin_of=above_the_ceiling_it_overruns)
def above_the_ceiling_a_shorter_free_run_overruns(v: Real, x: Real, b: Real, s: Real, t: Real, c: Real) -> Bit:
    """The same for a free run s that is shorter than t.  False: the brake may come in time."""
    return implies((b > 0) & (s <= t) & (s >= 0) & is_ceiling(c, x, b, t) & (v > c), need(v, b, s) > 2 * b * x)
