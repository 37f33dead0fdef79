"""Stepped high-speed limiter: brake with a dead band, sections that allow for it, and those that do not.

Speeds m/s, distances m.  Steps of 0.1 s for the equipment, a section for the train.
Source: principle, a force for each step, no signal [P]; ladder, forces, dead band, free run [A].

Main results: above V_k + h_on the brake comes at once and stays to V_k - h_off, whatever the dead band; without signal
it is on at any speed.  Sections from V_(k-1) + h_on let no train enter the next one above V_k + h_on, for ever; those
from V_(k-1) do.  With a dead band at step 0 a train may creep for ever at 2 km/h.
"""

from __future__ import annotations

from fractions import Fraction

from models.kinematics import need, root
from models.patterns.stepped_limiter import (
    FORCES,
    FREE_RUN,
    H_ON,
    LADDER,
    LENGTHS,
    PRINTED,
    DeadBandAtZero,
    PrintedSections,
    Sections,
    SteppedLimiter,
    force_to,
)
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
    any_of,
    any_of_faults,
    at_most,
    claim,
    dead,
    implies,
    open_circuit,
    persists,
    previous,
    real,
    select,
    stuck,
)
from safety.prove.bounds import Bound, between, claim_bracket, reals
from safety.prove.laws import law

SOURCE = "[P] a force for each step; ladder, dead band [A]"
BANDS = ("h_on", "h_off")
LINES = [Fault(open_circuit(), [p], ANY_TIME, name=f"{p} lost") for p in ("track_current", "valve")]

# --- the equipment ---------------------------------------------------------------------------------------------------


@claim(SteppedLimiter, expect=PROVED, faults=any_of_faults(LINES), symbolic=BANDS, requirement="SP-C1", source=SOURCE,
       witness=Scenario(1, {"v": 60, "signal": LADDER[1]}))  # fmt: skip
def brakes_above_the_step(s: Seen) -> Bit:
    """Faster than the step by more than h_on the brake comes at once, with at least the force of the step, whatever the
    dead band."""
    carried = s.track_current & (s.signal > 0)
    return implies(s.v > s.signal + s.h_on, s.brake) & implies(carried, s.force == force_to(s.signal))


@claim(SteppedLimiter, expect=REFUTED, symbolic=BANDS, requirement="SP-C1", twin_of=brakes_above_the_step,
       scenario=Scenario(2, {"v": lambda k: 0 if k == 0 else LADDER[1] + Fraction(1, 10), "signal": LADDER[1]},
                         {"h_on": H_ON}))  # fmt: skip
def brakes_at_the_step(s: Seen) -> Bit:
    """Faster than the step the brake comes at once.  False: in the dead band it stays off."""
    return implies(s.v > s.signal, s.brake)


@claim(SteppedLimiter, expect=PROVED, symbolic=BANDS, requirement="SP-C1", source="[A] dead band")
def brake_stays_through_the_dead_band(s: Seen) -> Bit:
    """The brake, once on, stays until the speed is h_off below the step."""
    return implies(previous(s.brake, True) & (s.v > s.signal - s.h_off), s.brake)


@claim(SteppedLimiter, expect=REFUTED, symbolic=BANDS, requirement="SP-C1", twin_of=brake_stays_through_the_dead_band)
def brake_stays_below_the_dead_band(s: Seen) -> Bit:
    """The brake, once on, stays."""
    return implies(previous(s.brake, True), s.brake)


@claim(SteppedLimiter, expect=PROVED, faults=any_of_faults(LINES), symbolic=BANDS, requirement="SP-H1",
       source="[P] no signal; step 0 [A]")  # fmt: skip
def no_signal_brakes_at_any_speed(s: Seen) -> Bit:
    """Without signal, or with the current lost, the brake is on at any speed, standstill included."""
    return implies((s.signal <= 0) | ~s.track_current, s.brake)


@claim(DeadBandAtZero, expect=REFUTED, defeat=True, requirement="SP-H1", source="[A] dead band at step 0",
       twin_of=no_signal_brakes_at_any_speed, steps=30,
       scenario=Scenario(30, {"v": lambda k: H_ON if k else 0, "signal": lambda k: 0 if k else LADDER[4]}))  # fmt: skip
def no_signal_stops_with_a_dead_band_at_zero(s: Seen) -> Bit:
    """With the dead band at step 0, too, a train without signal stands or is braked within 2 s.  False: one that has
    stood, and moves off, creeps at 2 km/h."""
    return implies(persists(s.signal <= 0, ticks=20), (s.v <= 0) | s.brake)


def follows(s: Seen) -> Bit:
    """The register keeps the brake."""
    return all_of(s.on == previous(s.brake, True))


@claim(SteppedLimiter, expect=PROVED, lemmas=[follows], symbolic=BANDS, requirement="SP-C1", source=SOURCE)
def brake_comes_just_then(s: Seen) -> Bit:
    """The brake is on just without signal, above the step and h_on, or since then until h_off below it; the emergency
    force is 7/5 of the step's."""
    stays = previous(s.brake, True) & (s.v + s.h_off > s.signal)
    on = (s.signal <= 0) | (s.v - s.signal > s.h_on) | stays
    return all_of(s.brake == on, s.emergency * 5 == s.force * 7)


@claim(SteppedLimiter, expect=REFUTED, symbolic=BANDS, requirement="SP-C1", twin_of=brake_comes_just_then)
def brake_comes_just_above_the_step(s: Seen) -> Bit:
    """The brake is on just above the step and h_on.  False: at power-up, and in the dead band, it stays."""
    return all_of(s.brake == (s.v > s.signal + s.h_on))


def failing(name: str, fault: Fault, v: Fraction) -> None:
    """A part that fails to the wrong side is not tolerated."""

    def formula(s: Seen) -> Bit:
        return implies(s.v > s.signal + H_ON, s.brake)

    formula.__name__ = f"brakes_above_the_step_{name}"
    formula.__doc__ = f"With one part failing ({fault.name}) the brake comes above the step.  False."
    slow_first = Scenario(2, {"v": lambda k: v if k else 0, "signal": LADDER[1]}, present=[fault.name])
    claim(SteppedLimiter, expect=REFUTED, defeat=True, faults=at_most(1, [fault]), requirement="SP-C1",
          source="[A] component table", twin_of=brakes_above_the_step, scenario=slow_first)(formula)  # fmt: skip


failing("with_no_speed", Fault(dead(), ["speed_generator"], ANY_TIME, name="speed reads 0"), LADDER[0])
failing("with_a_check_stuck", Fault(stuck(0), ["speed_check"], ANY_TIME, name="speed check stuck below"), LADDER[0])
failing("with_a_valve_that_holds", Fault(stuck(1), ["valve"], ANY_TIME, name="valve does not vent"), LADDER[0])

# --- the sections ----------------------------------------------------------------------------------------------------


@law(expect=PROVED, requirement="SP-C1", source="[D] constant deceleration")
def section_for_the_dead_band(
    v: Real, upper: Real, lower: Real, h: Real, b: Real, t: Real, way: Real, reached: Real
) -> Bit:
    """A section that brings a train from its limit and the dead band down to the next limit and the dead band does so
    with any slower train."""
    known = (v >= 0) & (v <= upper + h) & (h >= 0) & (b > 0) & (t >= 0) & (lower >= 0) & (reached >= 0)
    laid = need(upper + h, b, t, lower + h) <= 2 * b * way
    return implies(known & laid & (need(v, b, t, reached) >= 2 * b * way), reached <= lower + h)


@law(expect=REFUTED, requirement="SP-C1", twin_of=section_for_the_dead_band)
def section_without_dead_band(
    v: Real, upper: Real, lower: Real, h: Real, b: Real, t: Real, way: Real, reached: Real
) -> Bit:
    """The same with a section from limit to limit.  False: the train that enters in the dead band needs more."""
    known = (v >= 0) & (v <= upper + h) & (h >= 0) & (b > 0) & (t >= 0) & (lower >= 0) & (reached >= 0)
    laid = need(upper, b, t, lower) <= 2 * b * way
    return implies(known & laid & (need(v, b, t, reached) >= 2 * b * way), reached <= lower + h)


def sections(s: Seen) -> list[Bit]:
    """In which section the train is."""
    return [s[f"in_{number}"] for number in range(1, 6)]


def inside(s: Seen) -> Bit:
    """The train is in one of the sections."""
    return any_of(*sections(s))


def allowed(limit: Real) -> Real:
    """The limit and the dead band; 0 at step 0."""
    return select(limit > 0, limit + H_ON, limit)


def slowed(s: Seen) -> Bit:
    """The force of the step is given after 2 s, the brake held to V_k - h_off; no traction at or above V_k; a train
    comes at 210 km/h and the dead band at most."""
    b = force_to(s.was)
    braked = (need(s.before, b, real(FREE_RUN), s.v) >= 2 * b * s.way) & (s.v <= s.before)
    runs = select(s.limiter.on, braked | ((s.was > 0) & (s.v <= allowed(s.was))), s.v <= allowed(s.was))
    return implies(inside(s), runs) & implies(~inside(s), s.v <= LADDER[0] + H_ON)


def entered_slow_enough(s: Seen) -> Bit:
    """The section that the train is in was entered at the limit before and the dead band, or less."""
    known = (implies(here, s.before <= limit + H_ON) for here, limit in zip(sections(s), LADDER, strict=False))
    return all_of(s.before >= 0, *known, implies(s.in_5, s.limiter.on))


def one_section(s: Seen) -> Bit:
    """The train is in one section at most."""
    return all_of(*(~(a & b) for k, a in enumerate(sections(s)) for b in sections(s)[k + 1 :]))


DOWN = Scenario(6, {"v": lambda k: [*LADDER[:4], LADDER[4] + H_ON, 0][min(k, 5)]})


@claim(Sections, expect=PROVED, given=slowed, lemmas=[entered_slow_enough, one_section], requirement="SP-C1",
       source=SOURCE, witness=DOWN)  # fmt: skip
def no_section_is_left_too_fast(s: Seen) -> Bit:
    """No train leaves a section faster than its limit and the dead band, and none leaves the last one in motion."""
    return implies(inside(s), s.v <= allowed(s.was))


def through_the_first(v: Fraction, length: Fraction) -> Scenario:
    """A train enters the first section at v, and is slowed by its force."""
    left = root(v * v + 2 * FORCES[0] * (v * FREE_RUN - length)).low
    return Scenario(2, {"v": lambda k: left if k else v})


@claim(PrintedSections, expect=REFUTED, defeat=True, given=slowed, requirement="SP-C1",
       source="[A] lengths from V_(k-1)", twin_of=no_section_is_left_too_fast,
       scenario=through_the_first(LADDER[0] + H_ON, PRINTED[0]))  # fmt: skip
def no_printed_section_is_left_too_fast(s: Seen) -> Bit:
    """The same with sections dimensioned from V_(k-1).  False: who enters the first at 212 km/h leaves it too fast."""
    return no_section_is_left_too_fast(s)


def slowed_from_any_speed(s: Seen) -> Bit:
    """The force of the step is given after 2 s."""
    b = force_to(s.was)
    return implies(inside(s), (need(s.before, b, real(FREE_RUN), s.v) >= 2 * b * s.way) & (s.v <= s.before))


@claim(Sections, expect=REFUTED, given=slowed_from_any_speed, requirement="SP-C1", source="[A] 210 km/h",
       scenario=through_the_first(Fraction(70), LENGTHS[0]), twin_of=no_section_is_left_too_fast)  # fmt: skip
def no_section_is_left_too_fast_from_any_speed(s: Seen) -> Bit:
    """The same of a train that comes faster than 210 km/h and the dead band.  False."""
    return no_section_is_left_too_fast(s)


@claim(Sections, expect=REFUTED, requirement="SP-C1", source="[A] brake as guaranteed", scenario=Scenario(2, {"v": 58}),
       twin_of=no_section_is_left_too_fast)  # fmt: skip
def no_section_is_left_too_fast_whatever_the_brake_gives(s: Seen) -> Bit:
    """The same of a train whose brake does not give the force of the step.  False."""
    return no_section_is_left_too_fast(s)


# --- scatter and reading ---------------------------------------------------------------------------------------------

late, error = reals("late error")
claim_bracket(
    Bound(
        "patterns_stepped_limiter.scatter_of_free_run",
        "Free-run distance more at 210 km/h",
        LADDER[0] * late,
        (between(0, late, Fraction(1, 2)),),
        unit="m",
        requirement="SP-C1",
        source="[P] scatter of the build-up time",
        assumed=("[A] up to 0.5 s",),
    )
)
claim_bracket(
    Bound(
        "patterns_stepped_limiter.reading_error",
        "Braking from 210 km/h longer, free run apart, speed reading low",
        LADDER[0] * LADDER[0] * (2 * error + error * error),
        (between(0, error, Fraction(1, 100)),),
        real(2 * FORCES[0]),
        unit="m",
        requirement="SP-C1",
        source="[P] high-precision speed check",
        assumed=("[A] up to 1 %, 1.5 km/h/s",),
    )
)
