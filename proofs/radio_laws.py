"""Radio control: the laws of authority and headway, for all reals.

    rep, rear  rear of the leader as reported and in truth     x, d   head of the follower and its stopping distance
    m          margin                                          end    of the authority

Source: section 10, AR-1, AR-2, AR-9; section 9 [P]; every number [A].
"""

from __future__ import annotations

import inspect
from collections.abc import Callable

from models.kinematics import permits_accelerating, stops_accelerating, stops_within
from safety import PROVED, REFUTED, Bit, Real, all_of, implies
from safety.prove.bounds import reals
from safety.prove.laws import law

Premises = Callable[..., dict[str, Bit]]


def needed(sentence: Callable[..., Bit], premises: Premises, conclusion: Callable[..., Bit], requirement: str) -> None:
    """Declare, for each premise of a law, the twin that drops it."""
    for dropped in premises(*reals(" ".join(inspect.signature(sentence).parameters))):

        def twin(*values: Real, dropped: str = dropped) -> Bit:
            kept = (premise for name, premise in premises(*values).items() if name != dropped)
            return implies(all_of(*kept), conclusion(*values))

        twin.__doc__ = f"The same without the premise: {dropped}."
        twin.__signature__ = inspect.signature(sentence)  # type: ignore[attr-defined]
        law(expect=REFUTED, requirement=requirement, twin_of=sentence,
            id=f"radio_laws.{sentence.__name__}_without_{dropped.replace(' ', '_')}")(twin)  # fmt: skip


# --- the authority ---------------------------------------------------------------------------------------------------


@law(expect=PROVED, requirement="AR-1", source="[D] section 9")
def stop_point_lies_behind_the_leader(rep: Real, rear: Real, m: Real, end: Real, x: Real, d: Real) -> Bit:
    """Whoever can stop within an authority that ends a margin before a true report stops behind the leader's rear."""
    return implies((rep <= rear) & (m >= 0) & (end <= rep - m) & (x + d <= end), x + d <= rear)


@law(expect=REFUTED, requirement="AR-1", twin_of=stop_point_lies_behind_the_leader)
def even_with_a_margin_below_0(rep: Real, rear: Real, m: Real, end: Real, x: Real, d: Real) -> Bit:
    """The same whatever the margin."""
    return implies((rep <= rear) & (end <= rep - m) & (x + d <= end), x + d <= rear)


@law(expect=REFUTED, requirement="AR-1", twin_of=stop_point_lies_behind_the_leader)
def even_with_an_authority_up_to_the_report(rep: Real, rear: Real, m: Real, end: Real, x: Real, d: Real) -> Bit:
    """The same where the authority may end anywhere."""
    return implies((rep <= rear) & (m >= 0) & (x + d <= end), x + d <= rear)


@law(expect=REFUTED, requirement="AR-1", twin_of=stop_point_lies_behind_the_leader)
def even_where_the_stop_does_not_fit(rep: Real, rear: Real, m: Real, end: Real, x: Real, d: Real) -> Bit:
    """The same for a train that cannot stop within its authority."""
    return implies((rep <= rear) & (m >= 0) & (end <= rep - m), x + d <= rear)


@law(expect=REFUTED, requirement="AR-2", source="[D] section 10, AR-2", assumed=("[A] rolls back 20 m, m = 10 m",),
     twin_of=stop_point_lies_behind_the_leader)  # fmt: skip
def even_where_the_leader_rolls_back_20_m(rep: Real, rear: Real, end: Real, x: Real, d: Real) -> Bit:
    """The same with a leader that has rolled back up to 20 m since its report, a margin of 10 m and no allowance."""
    return implies((rep <= rear + 20) & (end <= rep - 10) & (d >= 0) & (x + d <= end), x + d <= rear)


@law(expect=PROVED, requirement="AR-2", source="[D] section 9, R4")
def an_allowance_makes_good_for_rolling_back(
    rep: Real, rear: Real, m: Real, allowance: Real, back: Real, end: Real, x: Real, d: Real
) -> Bit:
    """With allowance and margin together not below what it rolls back, he stops behind the leader's rear."""
    rolled = (rep <= rear + back) & (back <= allowance + m)
    return implies(rolled & (end <= rep - allowance - m) & (x + d <= end), x + d <= rear)


# --- the pattern to its end ------------------------------------------------------------------------------------------


def in_free_run(v: Real, x: Real, b: Real, a: Real, t: Real, cycle: Real, way: Real, reached: Real) -> dict[str, Bit]:
    """A cycle of the reaction time."""
    return {
        "forward": reached >= 0,
        "traction": reached <= v + a * cycle,
        "way": 2 * way <= 2 * v * cycle + a * cycle * cycle,
        "brake": b > 0,
        "acceleration": a >= 0,
        "time": t >= cycle,
        "fits": stops_accelerating(v, x, b, t, a),
    }


def fits_after(v: Real, x: Real, b: Real, a: Real, t: Real, cycle: Real, way: Real, reached: Real) -> Bit:
    """The stop that is left fits."""
    return all_of(stops_accelerating(reached, x - way, b, t - cycle, a))


@law(expect=PROVED, requirement="AR-3", source="[D] the step of the induction over a train's cycles, in free run")
def free_run_keeps_the_stop(v: Real, x: Real, b: Real, a: Real, t: Real, cycle: Real, way: Real, reached: Real) -> Bit:
    """A cycle of the reaction time, in any motion with at most a, leaves a stop that fits: one that fits."""
    given = in_free_run(v, x, b, a, t, cycle, way, reached)
    sensible = (v >= 0) & (cycle >= 0)  # not needed: it spares cvc5 minutes
    return implies(all_of(sensible, *given.values()), fits_after(v, x, b, a, t, cycle, way, reached))


needed(free_run_keeps_the_stop, in_free_run, fits_after, "AR-3")


def under_the_brake(v: Real, x: Real, b: Real, a: Real, t: Real, way: Real, reached: Real) -> dict[str, Bit]:
    """A cycle in which the brake acts."""
    return {
        "energy": reached * reached + 2 * b * way <= v * v, "speed": v >= 0, "brake": b > 0, "acceleration": a >= 0,
        "time": t >= 0, "fits": stops_accelerating(v, x, b, t, a),
    }  # fmt: skip


def fits_at_once(v: Real, x: Real, b: Real, a: Real, t: Real, way: Real, reached: Real) -> Bit:
    """Braking at once fits."""
    return all_of(stops_accelerating(reached, x - way, b, 0, a))


@law(expect=PROVED, requirement="AR-3", source="[D] the same, under the brake")
def brake_keeps_the_stop(v: Real, x: Real, b: Real, a: Real, t: Real, way: Real, reached: Real) -> Bit:
    """A cycle under the brake leaves a stop that fits: one that fits."""
    given = under_the_brake(v, x, b, a, t, way, reached)
    return implies(all_of(*given.values()), fits_at_once(v, x, b, a, t, way, reached))


needed(brake_keeps_the_stop, under_the_brake, fits_at_once, "AR-3")


def a_stop_fits(v: Real, x: Real, b: Real, a: Real, t: Real) -> dict[str, Bit]:
    """A train whose stop fits, traction going on for t."""
    return {"speed": v >= 0, "brake": b > 0, "acceleration": a >= 0, "time": t >= 0,
            "fits": permits_accelerating(v, x, b, t, a)}  # fmt: skip


def before_the_end(v: Real, x: Real, b: Real, a: Real, t: Real) -> Bit:
    """The end lies ahead."""
    return x >= 0


@law(expect=PROVED, requirement="AR-3", source="[D] speed patterns, section 1")
def a_stop_that_fits_ends_before_the_end(v: Real, x: Real, b: Real, a: Real, t: Real) -> Bit:
    """Where the stop fits, the head is not beyond the end of the authority."""
    return implies(all_of(*a_stop_fits(v, x, b, a, t).values()), before_the_end(v, x, b, a, t))


needed(a_stop_that_fits_ends_before_the_end, a_stop_fits, before_the_end, "AR-3")


def can_stop(v: Real, x: Real, b: Real, a: Real, t: Real) -> Bit:
    """Free run at constant speed and braking fit."""
    return all_of(stops_within(v, x, b, t))


@law(expect=PROVED, requirement="AR-4", source="[D] section 9, R1")
def who_acknowledges_can_keep_it(v: Real, x: Real, b: Real, a: Real, t: Real) -> Bit:
    """A train that acknowledges a shorter authority, x ahead, stops within it."""
    return implies(all_of(*a_stop_fits(v, x, b, a, t).values()), can_stop(v, x, b, a, t))


needed(who_acknowledges_can_keep_it, a_stop_fits, can_stop, "AR-4")


# --- headway ---------------------------------------------------------------------------------------------------------


def headways(v: Real, b: Real, length: Real, best: Real, h: Real, least: Real) -> dict[str, Bit]:
    """v*^2 = 2 b (L + m), 2 b v (H - t_sys) = v^2 + v*^2, b (H* - t_sys) = v*."""
    return {"speed": v > 0, "brake": b > 0, "best speed": best * best == 2 * b * length,
            "headway": 2 * b * v * h == v * v + 2 * b * length, "least headway": b * least == best}  # fmt: skip


def no_shorter(v: Real, b: Real, length: Real, best: Real, h: Real, least: Real) -> Bit:
    """H(v) >= H(v*)."""
    return h >= least


@law(expect=PROVED, requirement="AR-9", source="[D] section 9, headway: arithmetic and geometric mean")
def no_speed_has_a_shorter_headway(v: Real, b: Real, length: Real, best: Real, h: Real, least: Real) -> Bit:
    """H(v) >= H(v*) for all v > 0, where v*^2 = 2 b (L + m), H = t_sys + v / 2b + (L + m) / v, H* = t_sys + v* / b."""
    given = headways(v, b, length, best, h, least)
    return implies(all_of(*given.values()), no_shorter(v, b, length, best, h, least))


needed(no_speed_has_a_shorter_headway, headways, no_shorter, "AR-9")


@law(expect=REFUTED, requirement="AR-9", twin_of=no_speed_has_a_shorter_headway)
def every_other_speed_has_a_longer_headway(v: Real, b: Real, length: Real, best: Real, h: Real, least: Real) -> Bit:
    """H(v) > H(v*) for all v > 0, v* not excepted."""
    return implies(all_of(*headways(v, b, length, best, h, least).values()), h > least)
