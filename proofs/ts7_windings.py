"""TS-7, the sense of rotation from the phase of two windings: when roll-back is reported, and what defeats it.

One step is one frame, 125 us.  All phases, all nine wheel settings (set right, kept for the run), any speed in every
frame with f_s below 2 kHz (294 km/h on the smallest wheel).  The true sense is an input; the channel knows the windings
alone.

Main results: backward at 8 km/h is reported within 0.4 s, forward running never is.  Winding A dead takes the speed
away, winding B dead at 0 the sense: roll-back brings no emergency brake; at 1 running forward brings it.  Windings
swapped do both.  One disturbed sample of winding A brings the emergency brake between 5.2 and 6.07 km/h, where the
false sense outlasts the release time of the EB relay; from 6.08 km/h on it never does.
Source: two windings, 6.0 +- 2.0 km/h [P]; edges, sampling, relay times [A].
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from models.ts7.numbers import ROLLBACK_WORD
from models.ts7.train import PER_WORD, SCALE
from models.ts7.windings import WoundBench, WoundTs7
from proofs.ts7_brake_chain import RELEASE
from proofs.ts7_formulas import (
    LARGEST_WHEEL,
    PULSE,
    REFERENCE_FRACTION,
    ROLL_BACK,
    Formula,
    at_least_kmh,
    frames_for,
    latch_at_the_ends,
    named,
)
from safety import (
    PROVED,
    REFUTED,
    TRANSIENT,
    Bit,
    Fault,
    Int,
    Scenario,
    Seen,
    age,
    any_of_faults,
    at_most,
    claim,
    flip,
    has,
    implies,
    persists,
    previous,
    select,
    struck,
    stuck,
    swapped,
)

QUARTER = SCALE // 4  # phase of a quarter period for each 5 mm of wheel diameter
OPEN = ["wheel"]


def forward(s: Seen) -> Bit:
    """The train never runs backward."""
    return ~s.backward


def backward(s: Seen) -> Bit:
    """The train never runs forward."""
    return s.backward


def rolls(speed: int, *present: str, back: bool = True, steps: int = 6000) -> Scenario:
    """At signal 65 and a constant speed, one way."""
    return Scenario(steps, {"word": 138, "speed": speed, "backward": back}, {"axle.was_high": True}, present)


# --- healthy windings ----------------------------------------------------------------------------------------------


def level_of_a(s: Seen) -> Bit:
    """The circuit remembers the level of winding A."""
    return s.axle.was_high == (s.axle.phase < 2 * QUARTER * s.wheel)


LATCH = latch_at_the_ends(race=ROLL_BACK)


def way_back(s: Seen) -> Int:
    """Way backward since A last rose, as phase: A rises where the phase falls below half a period."""
    half = 2 * QUARTER * s.wheel.int()
    return select(s.axle.phase < half, half, 3 * half) - 1 - s.axle.phase


def fast_backward(s: Seen) -> Bit:
    """Backward at 8 km/h or faster."""
    return s.backward & (s.speed >= at_least_kmh(8))


RATE = at_least_kmh(8) - PER_WORD * ROLLBACK_WORD
REPORTED = frames_for(RATE)


def sense_is_found(s: Seen) -> Bit:
    """Backward: the circuit says so, or A has not risen since."""
    return s.axle.reverse | (way_back(s) >= at_least_kmh(8) * age(fast_backward(s), REPORTED).int())


def roll_back_counts(s: Seen) -> Bit:
    """Backward: the race is latched, or its potential, counted by the way backward, rises."""
    c = s.a
    pulses = PULSE * c.rollback.u.int() + SCALE * c.ring.j1.int() + way_back(s)
    ahead = pulses - PER_WORD * (c.ring.j3.int() + 256 * c.div3.n.int())
    latched = c.rollback.latch & (ahead >= 3 * PULSE - REFERENCE_FRACTION)
    return latched | (ahead >= RATE * age(fast_backward(s), REPORTED).int() - REFERENCE_FRACTION)


@claim(WoundBench, symbolic=OPEN, start=level_of_a, anywhere=True, expect=PROVED, requirement="TS7-13",
       lemmas=[level_of_a, sense_is_found, roll_back_counts],
       source="[P] upper end of 6.0 +- 2.0; time [D]", witness=rolls(at_least_kmh(8)))  # fmt: skip
def windings_report_eight_backward(s: Seen) -> Bit:
    """8 km/h or faster backward for 3200 frames (0.4 s): roll-back is reported, whatever the train did before."""
    return implies(persists(fast_backward(s), REPORTED), s.rev)


@claim(WoundBench, symbolic=OPEN, given=forward, expect=PROVED, requirement="TS7-13", source="[P]",
       witness=rolls(at_least_kmh(65), back=False))  # fmt: skip
def windings_report_no_roll_back_forward(s: Seen) -> Bit:
    """Forward since power-up, at any speed and phase: no roll-back is reported."""
    return ~s.rev


def one_is_present(faults: Sequence[Fault]) -> Formula:
    """One of the faults is there."""

    def start(s: Seen) -> Bit:
        return has(s, *(f.name for f in faults))

    return named(" or ".join(f.name for f in faults), start)


# --- windings lost or swapped --------------------------------------------------------------------------------------

A_DEAD = [Fault(stuck(value), "axle.winding_a", name=f"winding A stuck at {value}") for value in (0, 1)]
B_LOW, B_HIGH = (Fault(stuck(value), "axle.winding_b", name=f"winding B stuck at {value}") for value in (0, 1))
SWAPPED = Fault(swapped(), ["axle.winding_a", "axle.winding_b"], name="windings swapped")


def defeats(fault: Fault, speed: int, back: bool, twin: Formula) -> Callable[[Formula], Formula]:
    """Declare: refuted by a run one way at a constant speed, with this fault from the start."""
    run = rolls(speed, fault.name, back=back)
    return claim(WoundBench, faults=any_of_faults([fault]), given=backward if back else forward, expect=REFUTED,
                 defeat=True, requirement="TS7-13", scenario=run, twin_of=twin,
                 source="failure of the generator [A]")  # fmt: skip


def reported_backward(s: Seen) -> Bit:
    """8 km/h or faster backward for 0.4 s is reported."""
    return implies(persists(fast_backward(s), REPORTED), s.rev)


@defeats(A_DEAD[0], at_least_kmh(30), True, windings_report_eight_backward)
def reports_without_winding_a(s: Seen) -> Bit:
    """Winding A dead: roll-back at 8 km/h or faster is reported after 0.4 s.  False: no pulses, no speed."""
    return reported_backward(s)


@defeats(B_LOW, at_least_kmh(30), True, windings_report_eight_backward)
def reports_without_winding_b(s: Seen) -> Bit:
    """Winding B dead: roll-back at 8 km/h or faster is reported after 0.4 s.  False: every sense reads as forward."""
    return reported_backward(s)


@defeats(B_HIGH, at_least_kmh(30), False, windings_report_no_roll_back_forward)
def no_false_report_with_winding_b_high(s: Seen) -> Bit:
    """Winding B stuck high: forward running is not reported.  False: every sense reads as backward."""
    return ~s.rev


@defeats(SWAPPED, at_least_kmh(30), True, windings_report_eight_backward)
def reports_with_windings_swapped(s: Seen) -> Bit:
    """Windings swapped: roll-back at 8 km/h or faster is reported after 0.4 s.  False: backward reads as forward."""
    return reported_backward(s)


@defeats(SWAPPED, at_least_kmh(30), False, windings_report_no_roll_back_forward)
def no_false_report_with_windings_swapped(s: Seen) -> Bit:
    """Windings swapped: forward running is not reported.  False: forward reads as backward."""
    return ~s.rev


NO_REPORT = [A_DEAD[0], B_LOW]


@claim(WoundBench, symbolic=OPEN, faults=any_of_faults(NO_REPORT), start=one_is_present(NO_REPORT), expect=PROVED,
       requirement="TS7-13", source="[D]", witness=rolls(at_least_kmh(30), B_LOW.name))  # fmt: skip
def without_a_winding_nothing_is_reported(s: Seen) -> Bit:
    """Winding A or B dead at 0 from the start: no roll-back is ever reported, at any speed."""
    return ~s.rev


@claim(WoundBench, symbolic=OPEN, faults=any_of_faults([SWAPPED]), start=one_is_present([SWAPPED]), given=backward,
       expect=PROVED, requirement="TS7-13", source="[D]",
       witness=rolls(at_least_kmh(30), SWAPPED.name))  # fmt: skip
def swapped_windings_never_report_a_roll_back(s: Seen) -> Bit:
    """Windings swapped from the start: running backward is never reported, at any speed and phase."""
    return ~s.rev


@claim(WoundBench, symbolic=OPEN, given=backward, expect=REFUTED, requirement="TS7-13",
       twin_of=swapped_windings_never_report_a_roll_back, scenario=rolls(at_least_kmh(30)))  # fmt: skip
def healthy_windings_never_report_a_roll_back(s: Seen) -> Bit:
    """Healthy windings: running backward is never reported."""
    return ~s.rev


# --- one disturbed sample ------------------------------------------------------------------------------------------

DISTURBED = Fault(flip(), "axle.winding_a", TRANSIENT, ticks=1, name="a sample of winding A disturbed")
LEAST = at_least_kmh("6.08")


def forward_at(kmh: str) -> Formula:
    """Forward, never slower."""

    def given(s: Seen) -> Bit:
        return ~s.backward & (s.speed >= at_least_kmh(kmh))

    return named(f"forward at {kmh} km/h or faster", given)


def false_sense_ends(s: Seen) -> Bit:
    """A false sense begins where B is high, after the disturbance; since then the next rise of A has come nearer."""
    lasted, race, period = age(s.rev, RELEASE + 1).int(), s.a.rollback, 4 * QUARTER * s.wheel.int()
    struck_already, fresh = struck(s, DISTURBED.name), (race.u == 0) & ~race.latch
    nearer = s.axle.phase >= QUARTER * s.wheel.int() + LEAST * (lasted - 1)
    seen = level_of_a(s) | (4 * s.axle.phase < 3 * period)
    reported = ((lasted == 0) ^ (race.latch & s.axle.reverse)) & ((lasted == 0) | (nearer & seen & struck_already))
    return reported & (struck_already | level_of_a(s) | fresh)


def disturbed_at(speed: int) -> Scenario:
    """Forward at a constant speed on the largest wheel; one sample of A is lost just before B rises."""
    when, period = 8000, SCALE * LARGEST_WHEEL
    phase = (QUARTER * LARGEST_WHEEL - speed * (when + 2)) % period
    return Scenario(9000, {"word": 138, "speed": speed}, {"axle.phase": phase, "wheel": LARGEST_WHEEL},
                    [DISTURBED.name], at=when)  # fmt: skip


@claim(WoundBench, symbolic=OPEN, faults=at_most(1, [DISTURBED]), given=forward_at("6.08"), expect=PROVED,
       lemmas=[LATCH, false_sense_ends], requirement="TS7-13", source="[D]",
       witness=disturbed_at(LEAST))  # fmt: skip
def a_disturbed_sample_is_over_before_eb(s: Seen) -> Bit:
    """Forward at 6.08 km/h or faster, one sample of winding A disturbed: no report lasts for 161 frames, so that the EB
    relay does not fall."""
    return ~persists(s.rev, RELEASE + 1)


@claim(WoundBench, symbolic=OPEN, faults=at_most(1, [DISTURBED]), given=forward_at("6.07"), expect=REFUTED, defeat=True,
       requirement="TS7-13", source="[A] edges, sampling", twin_of=a_disturbed_sample_is_over_before_eb,
       scenario=disturbed_at(at_least_kmh("6.07")))  # fmt: skip
def a_disturbed_sample_is_over_before_eb_at_6_07(s: Seen) -> Bit:
    """The same at 6.07 km/h or faster.  False: on the wheel of 860 mm A rises again only after 161 frames."""
    return ~persists(s.rev, RELEASE + 1)


# --- the whole equipment -------------------------------------------------------------------------------------------

SUPPLIED = {"lines.s65": True, "inverter": True, "mg": True}


@claim(WoundTs7, faults=any_of_faults([B_LOW]), given=backward, expect=REFUTED, defeat=True, requirement="TS7-13",
       source="[P] one generator for all channels", twin_of=windings_report_eight_backward, scenario=Scenario(
           REPORTED + 400, {**SUPPLIED, "speed": at_least_kmh(30), "backward": True}, {"axle.was_high": True},
           [B_LOW.name]))  # fmt: skip
def winding_b_dead_still_brings_eb(s: Seen) -> Bit:
    """Winding B dead, 8 km/h or faster backward for 0.45 s: EB.  False: all channels take it for forward running."""
    return implies(persists(fast_backward(s), REPORTED + RELEASE + 240), s.eb)


SLOWLY = disturbed_at(at_least_kmh("5.5"))


@claim(WoundTs7, symbolic=OPEN, faults=at_most(1, [DISTURBED]), given=forward, expect=REFUTED, defeat=True,
       requirement="TS7-13", source="[A] edges, sampling, relay times", twin_of=a_disturbed_sample_is_over_before_eb,
       scenario=replace(SLOWLY, inputs={**SUPPLIED, "speed": at_least_kmh("5.5")}))  # fmt: skip
def one_disturbed_sample_brings_no_eb(s: Seen) -> Bit:
    """Forward, EB released, one sample of winding A disturbed: EB does not come.  False at 5.5 km/h."""
    return implies(previous(~s.eb, False) & struck(s, DISTURBED.name), ~s.eb)
