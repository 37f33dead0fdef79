"""Step supervision: no section is entered above its limit (SP-S1), overlap (SP-S2), loss of current (SP-C1, SP-H1).

SP-S1 by induction over sections, for any ladder, lengths that are long enough, any brake and free run; also as a law.
Source: speed-step supervision and its properties [D]; ladder, worst train, double reception [A].
"""

from __future__ import annotations

from typing import Any

from models.kinematics import need, permits
from models.patterns.step_supervision import (
    Balises,
    Continuous,
    HoldsLast,
    Sections,
    ShortSections,
    SlowTrain,
    Traction,
    WeakTrain,
)
from safety import PROVED, REFUTED, Bit, Real, Seen, claim, implies
from safety.prove.laws import law

OPEN = ("b", "t")
S1: dict[str, Any] = {"requirement": "SP-S1", "source": "[D] sections as long as the worst train needs"}


def in_order(s: Seen) -> Bit:
    """The train enters its first section within the limit before it; speeds are from 0 up."""
    return (s.entry >= 0) & (s.before >= 0) & (s.entry <= s.before)


def kept(s: Seen) -> Bit:
    """The limit of the section left was kept."""
    return in_order(s)


@claim(Sections, symbolic=OPEN, start=in_order, lemmas=[kept], expect=PROVED, **S1)
def no_section_is_left_above_its_limit(s: Seen) -> Bit:
    """However many sections, none is left above its limit."""
    return ~s.out


@claim(Sections, expect=REFUTED, twin_of=no_section_is_left_above_its_limit, steps=1, **S1)
def no_section_is_left_above_its_limit_whoever_enters(s: Seen) -> Bit:
    """The same for a train that enters at any speed.  False: it may be too fast already."""
    return ~s.out


@claim(ShortSections, start=in_order, expect=REFUTED, twin_of=no_section_is_left_above_its_limit, steps=1, **S1)
def no_short_section_is_left_above_its_limit(s: Seen) -> Bit:
    """The same with sections of any length.  False."""
    return ~s.out


@claim(WeakTrain, start=in_order, expect=REFUTED, twin_of=no_section_is_left_above_its_limit, steps=1, **S1)
def no_section_is_left_above_its_limit_by_a_weak_train(s: Seen) -> Bit:
    """The same with less deceleration than the worst train's.  False."""
    return ~s.out


@claim(SlowTrain, start=in_order, expect=REFUTED, twin_of=no_section_is_left_above_its_limit, steps=1, **S1)
def no_section_is_left_above_its_limit_by_a_slow_brake(s: Seen) -> Bit:
    """The same with a longer free run.  False."""
    return ~s.out


@claim(Traction, start=in_order, expect=REFUTED, twin_of=no_section_is_left_above_its_limit, steps=1, **S1)
def no_section_is_left_above_its_limit_under_traction(s: Seen) -> Bit:
    """The same with traction at or above the limit.  False: the limit is passed just before the section's end."""
    return ~s.out


@law(expect=PROVED, **S1)
def a_long_enough_section_slows_down(v: Real, above: Real, below: Real, w: Real, b: Real, t: Real, x: Real) -> Bit:
    """Who enters at the limit before or less, and brakes after the free run, is down to the next limit at the end."""
    known = (v >= 0) & (v <= above) & (below >= 0) & (w >= 0) & (b > 0) & (t >= 0)
    braked = w * w <= v * v - 2 * b * (x - v * t)
    return implies(known & (need(above, b, t, below) <= 2 * b * x) & braked, w <= below)


@law(expect=REFUTED, twin_of=a_long_enough_section_slows_down, **S1)
def a_section_slows_down(v: Real, above: Real, below: Real, w: Real, b: Real, t: Real, x: Real) -> Bit:
    """The same for a section of any length.  False."""
    known = (v >= 0) & (v <= above) & (below >= 0) & (w >= 0) & (b > 0) & (t >= 0)
    return implies(known & (w * w <= v * v - 2 * b * (x - v * t)), w <= below)


# --- overlap ---------------------------------------------------------------------------------------------------------


@law(expect=PROVED, requirement="SP-S2", source="[D] emergency brake at the signal")
def the_overlap_is_that_of_the_last_step(v: Real, last: Real, b: Real, t: Real, y: Real) -> Bit:
    """A train that passes the signal at the last step or less stops within V t + V^2 / 2b behind it."""
    known = (v >= 0) & (v <= last) & (b > 0) & (t >= 0) & (2 * b * y == need(v, b, t))
    return implies(known, 2 * b * y <= need(last, b, t))


@law(expect=REFUTED, requirement="SP-S2", source="[D]", twin_of=the_overlap_is_that_of_the_last_step)
def a_last_step_above_0_needs_no_overlap(v: Real, last: Real, b: Real, t: Real, y: Real) -> Bit:
    """A train that passes the signal at the last step or less does not get behind it.  False above 0."""
    known = (v >= 0) & (v <= last) & (b > 0) & (t >= 0) & (2 * b * y == need(v, b, t))
    return implies(known, y <= 0)


@law(expect=PROVED, requirement="SP-S1", source="[D] steps against one pattern for the same train")
def a_step_is_never_above_the_pattern(v: Real, x: Real, below: Real, b: Real, t: Real, rest: Real) -> Bit:
    """What the steps permit, a pattern for the same train permits too: it intervenes no earlier."""
    known = (v >= 0) & (v <= below) & (below >= 0) & (b > 0) & (t >= 0) & (rest >= 0)
    return implies(known & (need(below, b, t) <= 2 * b * rest) & (x >= rest), permits(v, x, b, t))


@law(expect=REFUTED, requirement="SP-S1", source="[D]", twin_of=a_step_is_never_above_the_pattern)
def a_pattern_is_never_above_the_step(v: Real, x: Real, below: Real, b: Real, t: Real, rest: Real) -> Bit:
    """What the pattern permits, the steps permit too.  False: the pattern lets the train run on."""
    known = (v >= 0) & (below >= 0) & (b > 0) & (t >= 0) & (rest >= 0) & (need(below, b, t) <= 2 * b * rest)
    return implies(known & (x >= rest) & permits(v, x, b, t), v <= below)


# --- continuous and point --------------------------------------------------------------------------------------------


@claim(Continuous, expect=PROVED, requirement="SP-C1", source="[A] lower of two receptions")
def a_restriction_acts_at_once(s: Seen) -> Bit:
    """While there is current, the limit never exceeds the aspect: a restriction acts in the cycle it comes."""
    return implies(s.current, s.limit <= s.aspect)


@claim(Balises, expect=REFUTED, requirement="SP-C1", source="[D]", twin_of=a_restriction_acts_at_once, steps=2)
def a_restriction_acts_at_once_by_balises(s: Seen) -> Bit:
    """By balises the limit never exceeds the aspect.  False: it stays until the next balise."""
    return s.limit <= s.aspect


@claim(Continuous, expect=PROVED, requirement="SP-H1", source="[A] no current is speed 0")
def loss_of_current_is_limit_0(s: Seen) -> Bit:
    """Without current the limit is 0, and so it is never raised."""
    return implies(~s.current, s.limit <= 0)


@claim(HoldsLast, expect=REFUTED, requirement="SP-H1", source="[A]", twin_of=loss_of_current_is_limit_0, steps=2)
def loss_of_current_is_limit_0_where_it_is_held(s: Seen) -> Bit:
    """The same where the limit is held without current.  False: the limit before stays."""
    return loss_of_current_is_limit_0(s)
