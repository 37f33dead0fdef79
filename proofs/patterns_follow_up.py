"""Follow-up control: the correction that a gradient demands, and the error that regulating leaves.

Error m/s, effort and correction m/s^2, gradient permille; steps of 0.1 s.  The gradient may change at any step.
Source: principle [P]; proportional law 0.5 1/s, lag 0.5 s, effort 0 to 1.2 m/s^2, curve 2.5 km/h/s [A].

Main results: proved for ever, for every course of the gradient, from 18 km/h upwards: |e| <= 3 g i / 1000, 0.588 m/s
with one curve (20 permille) and 0.118 with five (4 permille).  Below 18 km/h nothing is claimed: the curve then falls
faster with the distance than the regulator follows.  Where the limits of the effort leave no margin the error grows
without end.
"""

from __future__ import annotations

from fractions import Fraction

from models.kinematics import CYCLE
from models.patterns.follow_up import LEAST, MOST, FollowUp, WithoutMargin, bound, pull
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Real,
    Scenario,
    Seen,
    all_of,
    at_most,
    claim,
    dead,
    implies,
    offset,
)
from safety.prove.laws import law

SOURCE = "[P] effort regulated to the curve; law, gain, lag, limits [A]"
OPEN = ("curve", "steepest")

# --- the algebra -----------------------------------------------------------------------------------------------------


@law(expect=PROVED, requirement="SP-P2", source="[D] constant deceleration over a cycle")
def error_over_a_cycle(v: Real, ref: Real, following: Real, a: Real, b: Real) -> Bit:
    """Over a cycle with deceleration a the error from the curve v_ref^2 = 2 b x goes as in the model, times
    v_ref + v_ref' - b T."""
    on_curve = following * following == ref * ref - b * CYCLE * (2 * v - CYCLE * a)
    sharp, error = b * CYCLE, v - ref
    scale = ref + following - sharp
    gone = error * (scale + 2 * sharp) - CYCLE * (a - b) * (scale + sharp)
    return implies(on_curve, (v - CYCLE * a - following) * scale == gone)


@law(expect=REFUTED, requirement="SP-P2", twin_of=error_over_a_cycle)
def error_over_a_cycle_on_a_straight_line(v: Real, ref: Real, following: Real, a: Real, b: Real) -> Bit:
    """The same as if the reference fell by b in time.  False: it falls with the distance."""
    on_curve = following * following == ref * ref - b * CYCLE * (2 * v - CYCLE * a)
    scale = ref + following - b * CYCLE
    return implies(on_curve, (v - CYCLE * a - following) * scale == (v - ref - CYCLE * (a - b)) * scale)


@law(expect=PROVED, requirement="SP-P2", source="[D] quotient of the same")
def q_is_the_quotient(after: Real, error: Real, off: Real, scale: Real, sharp: Real, q: Real) -> Bit:
    """With q the quotient of b T and v_ref + v_ref' - b T, that is the model's equation."""
    known = (scale > 0) & (q * scale == sharp)
    scaled = after * scale == error * (scale + 2 * sharp) - CYCLE * off * (scale + sharp)
    return implies(known & scaled, after == error + 2 * q * error - CYCLE * (off + q * off))


@law(expect=REFUTED, requirement="SP-P2", twin_of=q_is_the_quotient)
def q_is_any_quotient(after: Real, error: Real, off: Real, scale: Real, sharp: Real, q: Real) -> Bit:
    """The same where v_ref + v_ref' may be b T.  False: there the curve ends."""
    known = (scale >= 0) & (q * scale == sharp)
    scaled = after * scale == error * (scale + 2 * sharp) - CYCLE * off * (scale + sharp)
    return implies(known & scaled, after == error + 2 * q * error - CYCLE * (off + q * off))


# --- SP-16 -----------------------------------------------------------------------------------------------------------


def steady(s: Seen) -> Bit:
    """Error and effort did not change in this cycle; the curve is straight here; the effort is within its limits."""
    kept = (s.after == s.error) & (s.effort - s.curve == s.surplus)
    return all_of(kept, s.q <= 0, s.regulator >= LEAST, s.regulator <= MOST)


@claim(FollowUp, expect=PROVED, symbolic=OPEN, requirement="SP-P2", source="[P] remark on the correction demanded")
def steady_correction_is_the_gradient(s: Seen) -> Bit:
    """The correction demanded of a train that follows the curve at rest is -g i, whatever curve and gradient."""
    return implies(steady(s), s.correction == -pull(s.i))


@claim(FollowUp, expect=REFUTED, symbolic=OPEN, requirement="SP-P2", twin_of=steady_correction_is_the_gradient)
def correction_is_the_gradient(s: Seen) -> Bit:
    """The correction demanded is -g i at any time.  False: the error has to come up first."""
    return all_of(s.correction == -pull(s.i))


# --- the error stays bounded -----------------------------------------------------------------------------------------


def within(x: Real, most: Real | Fraction) -> Bit:
    """Not further from 0."""
    return (x <= most) & (x >= -most)


def error_and_effort(s: Seen) -> Bit:
    """Effort off the curve's, and error less that, lie within 3/2 of the correction that the steepest demands."""
    return within(s.surplus, bound(s.steepest)) & within(s.error - s.surplus, bound(s.steepest))


DOWNHILL = Scenario(80, {"i": -20})


@claim(FollowUp, expect=PROVED, lemmas=[error_and_effort], symbolic=OPEN, requirement="SP-P2", source=SOURCE)
def error_stays_bounded(s: Seen) -> Bit:
    """As long as the curve is followed at 18 km/h or more the error is at most 3 g i / 1000, for every curve and every
    course of a gradient up to i whose correction the limits of the effort leave room for."""
    return within(s.after, 2 * bound(s.steepest))


@claim(FollowUp, expect=REFUTED, requirement="SP-P2", source=SOURCE, twin_of=error_stays_bounded, scenario=DOWNHILL)
def error_stays_half_as_large(s: Seen) -> Bit:
    """The error is at most half of that.  False: a steady gradient alone leaves 2 g i / 1000."""
    return within(s.after, bound(Fraction(20)))


@claim(WithoutMargin, expect=REFUTED, defeat=True, settings={"curve": Fraction(11, 10)}, requirement="SP-P2",
       source="[A] limits of effort", twin_of=error_stays_bounded, scenario=Scenario(160, DOWNHILL.inputs))  # fmt: skip
def error_stays_bounded_without_margin(s: Seen) -> Bit:
    """The same with a curve of 1.1 m/s^2 at -20 permille.  False: 1.296 m/s^2 is demanded, 1.2 is there, and the error
    grows without end."""
    return within(s.after, 2 * bound(Fraction(20)))


@claim(FollowUp, expect=REFUTED, settings={"sharpest": Fraction(1, 2)}, requirement="SP-P2", source="[A] from 18 km/h",
       twin_of=error_stays_bounded,
       scenario=Scenario(40, {"i": -20, "q": lambda k: 0 if k < 20 else Fraction(1, 5)}))  # fmt: skip
def error_stays_bounded_to_the_stop(s: Seen) -> Bit:
    """The same down to the stop.  False: near it the curve falls faster than the regulator follows."""
    return within(s.after, 2 * bound(Fraction(20)))


def failing(name: str, fault: Fault) -> None:
    """A part that fails is not tolerated."""

    def formula(s: Seen) -> Bit:
        return within(s.after, 2 * bound(Fraction(20)))

    formula.__name__ = f"error_stays_bounded_{name}"
    formula.__doc__ = f"With one part failing ({fault.name}) the error stays as small.  False."
    claim(FollowUp, expect=REFUTED, defeat=True, faults=at_most(1, [fault]), requirement="SP-P2",
          source="[A] component table", twin_of=error_stays_bounded,
          scenario=Scenario(120, DOWNHILL.inputs, present=[fault.name]))(formula)  # fmt: skip


failing("with_no_error_signal", Fault(dead(), ["speed_error"], ANY_TIME, name="speed comparison dead"))
failing("with_a_weak_brake", Fault(offset(Fraction(-1, 2)), ["brake"], ANY_TIME, name="brake force low"))
