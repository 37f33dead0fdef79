"""Discrete-time supervisor on the model: a supervised train never passes the protected point.

By induction over the train's speed and distance as reals, for every acceleration in each cycle (constant within it),
every width of the intervals, and all parameters of the supervisor in range.  The lemma is the conservative ceiling with
the time that is left until the brake acts, case by case: as one sentence it takes a solver a minute.
`kinematics_cycle` has one cycle of it as laws.
Source: speed patterns, discrete-time supervisor and properties SP-P3, AV-1 [D]; cycle, budget, hysteresis [A].

Main results: service and emergency brake are each enough; each slip of the equipment, and each broken promise of the
surroundings, is refuted by a run of a few cycles.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from models.kinematics import (
    ACCELERATION,
    B_SERVICE,
    CYCLE,
    HYSTERESIS,
    T_SERVICE,
    distance,
    permits_accelerating,
    stops_accelerating,
)
from models.patterns.slips import (
    ClampedRun,
    FartherPointRun,
    LowerSpeedRun,
    NoFreeRunEmergency,
    NoFreeRunRun,
    NoHysteresis,
    PlainRun,
    SlowBrake,
    StrongTraction,
    TruthOutside,
    WeakBrake,
    WeakEmergencyBrake,
    WithoutTraction,
)
from models.patterns.supervised import EmergencyRun, ServiceRun
from models.patterns.supervisor import Supervisor
from models.patterns.train import T, runs
from safety import PROVED, REFUTED, Bit, Scenario, Seen, all_of, claim, implies

Formula = Callable[[Seen], Bit]
ABOUT: dict[str, Any] = {"requirement": "SP-P3", "source": "[D] conservative ceiling; [A] cycle, budget, hysteresis"}


def never_below_0(s: Seen) -> Bit:
    """The time left until the brake acts is none below 0."""
    return all_of(s["brake.left"] >= 0)


def stop_fits(line: str, b: str, t: str, a: str = "") -> list[Formula]:
    """With the time left until the brake on a line acts, the train accelerating until then, the stop fits: by cases."""

    def whole(s: Seen) -> Bit:
        return all_of(s["brake.left"] == s[t] - CYCLE)

    def while_released(s: Seen) -> Bit:
        fits = stops_accelerating(s["train.v"], s["train.x"], s[b], s[t] - CYCLE, s[a] if a else 0)
        return implies(~s[line] & whole(s), all_of(fits))

    def at_power_up(s: Seen) -> Bit:
        return implies(~s[line] & ~whole(s), s.fits)

    def before_it_acts(s: Seen) -> Bit:
        return implies(s[line] & (s["brake.left"] > 0), s.fits)

    def while_it_acts(s: Seen) -> Bit:
        return implies(s[line] & (s["brake.left"] <= 0), s.fits)

    return [while_released, at_power_up, before_it_acts, while_it_acts, never_below_0]


def in_order(s: Seen) -> Bit:
    """The train's stop fits at power-up, and it does not run backwards."""
    return s.fits & s.budgeted & (s["train.v"] >= 0)


def from_rest(acceleration: Fraction, late: int) -> Scenario:
    """From a standstill where the ceiling is just kept: traction until the brake acts, `late` cycles late."""
    reacting = int(T_SERVICE / T) - 1 + late
    reached, moving = runs(Fraction(0), [acceleration] * reacting + [-B_SERVICE] * 40)
    x = ACCELERATION * T_SERVICE**2 / 2 + distance(ACCELERATION * T_SERVICE, B_SERVICE, Fraction(0))
    inputs = {"reached": reached.__getitem__, "moving": moving.__getitem__}
    return Scenario(reacting + 40, inputs, {"train.v": Fraction(0), "train.x": x, "brake.left": 2 * T})


OPEN = tuple(f"guard.{name}" for name in ("b_s", "t_s", "a", "h", "b_e", "t_e", "t_w"))
PROOF: dict[str, Any] = ABOUT | {"expect": PROVED, "start": in_order, "symbolic": OPEN}
REFUTATION: dict[str, Any] = ABOUT | {"expect": REFUTED, "start": in_order, "steps": 4}


@claim(ServiceRun, lemmas=stop_fits("guard.braking", "guard.b_s", "guard.t_s", "guard.a"), **PROOF)
def service_brake_keeps_the_point(s: Seen) -> Bit:
    """A train under its service brake never passes the protected point."""
    return s["train.x"] >= 0


@claim(EmergencyRun, lemmas=stop_fits("guard.latched", "guard.b_e", "guard.t_e", "guard.a"), **PROOF)
def emergency_brake_keeps_the_point(s: Seen) -> Bit:
    """A train under its emergency brake alone never passes the protected point."""
    return s["train.x"] >= 0


@claim(WithoutTraction, lemmas=stop_fits("guard.braking", "guard.b_s", "guard.t_s"), **PROOF)
def plain_ceiling_keeps_the_point_without_traction(s: Seen) -> Bit:
    """Under the plain ceiling a train that has no traction never passes the protected point."""
    return s["train.x"] >= 0


@claim(PlainRun, twin_of=plain_ceiling_keeps_the_point_without_traction, **REFUTATION)
def plain_ceiling_keeps_the_point(s: Seen) -> Bit:
    """Under the plain ceiling a train never passes the protected point.  False: it accelerates until the brake acts."""
    return plain_ceiling_keeps_the_point_without_traction(s)


@claim(ServiceRun, twin_of=service_brake_keeps_the_point, **REFUTATION | {"start": None})
def keeps_the_point_wherever_it_starts(s: Seen) -> Bit:
    """The same wherever the train is at power-up.  False: it may be too near already."""
    return service_brake_keeps_the_point(s)


@claim(LowerSpeedRun, twin_of=service_brake_keeps_the_point, **REFUTATION)
def keeps_the_point_by_the_lower_speed(s: Seen) -> Bit:
    """The same with the lower end of the speed's interval compared.  False: the train may be faster."""
    return service_brake_keeps_the_point(s)


@claim(FartherPointRun, twin_of=service_brake_keeps_the_point, **REFUTATION)
def keeps_the_point_by_the_farther_end(s: Seen) -> Bit:
    """The same with the upper end of the distance's interval compared.  False: the point may be nearer."""
    return service_brake_keeps_the_point(s)


@claim(NoFreeRunRun, twin_of=service_brake_keeps_the_point, **REFUTATION)
def keeps_the_point_without_free_run(s: Seen) -> Bit:
    """The same with a ceiling that leaves the free run out.  False: the brake comes too late."""
    return service_brake_keeps_the_point(s)


@claim(ClampedRun, twin_of=service_brake_keeps_the_point, **REFUTATION)
def keeps_the_point_under_a_clamped_ceiling(s: Seen) -> Bit:
    """The same with a ceiling below 0 taken as 0.  False: a train that stands may start towards the point."""
    return service_brake_keeps_the_point(s)


@claim(WeakBrake, twin_of=service_brake_keeps_the_point, **REFUTATION)
def keeps_the_point_with_a_weak_brake(s: Seen) -> Bit:
    """The same with a brake that gives less than is guaranteed.  False."""
    return service_brake_keeps_the_point(s)


@claim(WeakEmergencyBrake, twin_of=emergency_brake_keeps_the_point, **REFUTATION)
def emergency_brake_keeps_the_point_with_a_weak_brake(s: Seen) -> Bit:
    """The same with an emergency brake that gives less than is guaranteed.  False."""
    return emergency_brake_keeps_the_point(s)


@claim(NoFreeRunEmergency, twin_of=emergency_brake_keeps_the_point, **REFUTATION)
def emergency_brake_keeps_the_point_without_free_run(s: Seen) -> Bit:
    """The same with a ceiling that leaves the free run out.  False: the emergency brake comes too late."""
    return emergency_brake_keeps_the_point(s)


@claim(StrongTraction, twin_of=service_brake_keeps_the_point, **ABOUT, expect=REFUTED, start=in_order,
       scenario=from_rest(ACCELERATION * Fraction(11, 10), 0))  # fmt: skip
def keeps_the_point_under_stronger_traction(s: Seen) -> Bit:
    """The same with more acceleration than is assumed.  False."""
    return service_brake_keeps_the_point(s)


@claim(SlowBrake, twin_of=service_brake_keeps_the_point, **ABOUT, expect=REFUTED, start=in_order,
       scenario=from_rest(ACCELERATION, 2))  # fmt: skip
def keeps_the_point_with_a_slow_brake(s: Seen) -> Bit:
    """The same with a brake that takes two cycles more than the budget.  False."""
    return service_brake_keeps_the_point(s)


@claim(TruthOutside, twin_of=service_brake_keeps_the_point, **REFUTATION)
def keeps_the_point_with_the_truth_outside(s: Seen) -> Bit:
    """The same with intervals that need not contain the truth.  False."""
    return service_brake_keeps_the_point(s)


# --- release and warning ---------------------------------------------------------------------------------------------


@claim(Supervisor, expect=PROVED, requirement="SP-P3", source="[A] hysteresis 2 km/h")
def released_well_below_the_ceiling(s: Seen) -> Bit:
    """When the service brake is released, the ceiling would permit 2 km/h more."""
    higher = permits_accelerating(s.seen.v_hi + HYSTERESIS, s.seen.x_lo, B_SERVICE, T_SERVICE, ACCELERATION)
    return implies(s.braking & ~s.service, higher)


@claim(NoHysteresis, expect=REFUTED, requirement="SP-P3", source="[A]", steps=2,
       twin_of=released_well_below_the_ceiling)  # fmt: skip
def released_well_below_the_ceiling_without_hysteresis(s: Seen) -> Bit:
    """The same where the brake is released at the ceiling.  False: it would come and go from cycle to cycle."""
    return released_well_below_the_ceiling(s)


@claim(Supervisor, expect=PROVED, requirement="SP-P3", source="[A] latched to standstill and acknowledgement")
def emergency_is_kept_to_standstill(s: Seen) -> Bit:
    """The emergency brake is released only at a standstill that the driver has acknowledged."""
    return implies(s.latched & ~s.emergency, (s.seen.v_hi <= 0) & s.seen.acknowledged)


@claim(Supervisor, expect=REFUTED, requirement="SP-P3", source="[A]", steps=2, twin_of=emergency_is_kept_to_standstill)
def emergency_is_kept_for_ever(s: Seen) -> Bit:
    """The emergency brake is never released.  False: at an acknowledged standstill it is."""
    return implies(s.latched, s.emergency)


@claim(Supervisor, expect=PROVED, requirement="SP-P5", source="[A] warning 5 s")
def the_brake_never_comes_unwarned(s: Seen) -> Bit:
    """Where the ceiling is exceeded, there is a warning, too."""
    return implies((s.seen.v_hi >= 0) & s.over, s.warning)


@claim(Supervisor, expect=REFUTED, requirement="SP-P5", source="[A]", steps=1, twin_of=the_brake_never_comes_unwarned)
def a_warning_never_comes_without_the_brake(s: Seen) -> Bit:
    """Where there is a warning, the brake is asked for, too.  False: it comes first."""
    return implies(s.warning, s.service)
