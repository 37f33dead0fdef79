"""TS-7: what defeats it.  Refuted claims say that the train is braked; a replayed run shows that it is not.

All runs: signal 65, released at a low speed; the fault strikes; then the train is 8 words (3.8 km/h) too fast for 5104
frames (0.64 s) and more, and neither brake comes.  An oscillator that is too fast is represented in its own frames,
which are shorter: one generator pulse in 16 is missing at the axle for an oscillator shared by all (6.7 % fast), one in
10 at one channel for its own (11 % fast: at 6.7 % the lowering by synchronisation still made it brake).
Source: common parts, window blind to drift, isolation of the channel that stands alone [P], [R]; sizes [A].

Main result: five common causes and every pair of silenced channels; synchronisation, which should find a silent
channel, isolates the healthy one when two are silent, and raises no emergency brake.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from models.ts7.failures import WORD_90, component_faults, fewer_pulses, reads
from models.ts7.system import Ts7, WiredSignals
from models.ts7.train import PER_WORD, SCALE
from proofs.ts7_brake_chain import Chain, permitted
from proofs.ts7_formulas import PULSE, REFERENCE_FRACTION, Formula, at_least_kmh, latch_at_the_ends
from proofs.ts7_voting import brakes_with_one_channel_broken, too_fast
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Scenario,
    Seen,
    age,
    any_of_faults,
    claim,
    faulty,
    implies,
    persists,
)

CHAIN = Chain(words=4, blind=faulty, mute=faulty)
LATE = 2300  # frame at which the faults strike; the train runs released
NAMED = {fault.name: replace(fault, onset=ANY_TIME) for fault in component_faults()}
TOO_SMALL = {
    steps: Fault(reads(164 - 2 * steps), ["wheel_switch"], name=f"wheel switch {steps} too small") for steps in (1, 2)
}
SHARED_FAST = Fault(fewer_pulses(16), ["axle.pulse"], ANY_TIME, name="shared oscillator fast")
A_FAST = Fault(fewer_pulses(10), ["a.f_s"], ANY_TIME, name="oscillator of a fast")


def brakes(s: Seen) -> Bit:
    """Overspeed of 4 words above every healthy limit for 5104 frames brings NB or EB."""
    return implies(persists(CHAIN.overspeed(s), CHAIN.braked), s.nb | s.eb)


def defeated(*faults: Fault, source: str) -> Callable[[Formula], Formula]:
    """Declare: refuted by the run in which just these faults strike."""
    run = too_fast(8, CHAIN.braked + 100, present=[f.name for f in faults], at=LATE)
    return claim(Ts7, faults=any_of_faults(faults), expect=REFUTED, defeat=True, scenario=run, requirement="TS7-16",
                 source=source, twin_of=brakes_with_one_channel_broken)  # fmt: skip


# --- common causes -------------------------------------------------------------------------------------------------


@defeated(NAMED["speed generator dead"], source="[P] one axle speed generator")
def brakes_with_a_dead_generator(s: Seen) -> Bit:
    """With the speed generator dead, overspeed still brakes.  False: no pulses mean no speed in all channels."""
    return brakes(s)


@defeated(NAMED["wrong row in all channels"], source="[P] contents in a matrix that is exchanged alone")
def brakes_with_the_same_wrong_row(s: Seen) -> Bit:
    """With the row of 90 km/h in place of 65 in all matrices, overspeed still brakes.  False: the vote is unanimous and
    wrong."""
    return brakes(s)


@defeated(NAMED["signal lines wire-ORed with 25"], source="[A] rows ORed onto the columns")
def brakes_with_wire_ored_rows(s: Seen) -> Bit:
    """With the line of 25 ORed onto that of 65, overspeed still brakes.  False: the two read as 90 km/h, more
    permissive than either."""
    return brakes(s)


@claim(WiredSignals, expect=REFUTED, defeat=True, requirement="TS7-16", source="[A] lines wire-ORed",
       twin_of=brakes_with_one_channel_broken, scenario=Scenario(8000, {"lines.s25": True, "lines.s65": True,
       "inverter": True, "speed": lambda k: PER_WORD * (30 if k < LATE else 100)}))  # fmt: skip
def brakes_with_two_lines_on_wired_rows(s: Seen) -> Bit:
    """On a matrix with wired rows and no broken part, overspeed brakes.  False: lines 25 and 65 together permit 90."""
    return brakes(s)


# --- wheel switch --------------------------------------------------------------------------------------------------

TRUE, ONE_STEP = 164, 162  # 820 mm, switch one step too small, 5 mm
RATE = ONE_STEP * at_least_kmh(92) - TRUE * PER_WORD * WORD_90  # growth of the potential, times the true wheel
SLOWEST = (TRUE * (2 * PULSE + 255 * SCALE + REFERENCE_FRACTION) + ONE_STEP * TRUE * SCALE) // RATE + 1  # frames


def two_too_fast(s: Seen) -> Bit:
    """Signal 90, the train at 92 km/h or more."""
    return (permitted(s) == WORD_90) & (s.speed >= at_least_kmh(92))


def rises_with_a_small_wheel(s: Seen) -> Bit:
    """Overspeed brakes a or raises its potential; the axle counts in it by the set wheel, the rest by the true."""
    c = s.a
    rest = PULSE * c.comparator.u.int() + SCALE * c.ring.j1.int() - PER_WORD * (c.ring.j0.int() + 256 * c.div0.n.int())
    seen = TRUE * rest + ONE_STEP * s.axle.phase
    ahead = c.comparator.latch & (seen >= TRUE * (3 * PULSE - REFERENCE_FRACTION))
    return ahead | (seen >= RATE * age(two_too_fast(s), SLOWEST).int() - TRUE * REFERENCE_FRACTION)


def at_92(steps: int) -> Scenario:
    """Signal 90, released, then 92 km/h, with the wheel switch so many steps too small."""
    speed = {"speed": lambda k: PER_WORD * 30 if k < LATE else at_least_kmh(92)}
    return Scenario(LATE + SLOWEST, {"lines.s90": True, "inverter": True, **speed}, present=[TOO_SMALL[steps].name])


@claim(Ts7, faults=any_of_faults([TOO_SMALL[1]]), expect=PROVED, requirement="TS7-16", source="[P] steps of 10 mm",
       lemmas=[latch_at_the_ends("a"), rises_with_a_small_wheel], witness=at_92(1))  # fmt: skip
def demands_with_the_wheel_one_step_too_small(s: Seen) -> Bit:
    """Wheel switch one step (10 mm) too small at 820 mm: 2.0 km/h above 90 still demands the brake, after 1.3 s."""
    return implies(persists(two_too_fast(s), SLOWEST), s.a.brake)


@claim(Ts7, faults=any_of_faults([TOO_SMALL[2]]), expect=REFUTED, defeat=True, requirement="TS7-16",
       source="[P] one switch for all", scenario=at_92(2),
       twin_of=demands_with_the_wheel_one_step_too_small)  # fmt: skip
def demands_with_the_wheel_two_steps_too_small(s: Seen) -> Bit:
    """Wheel switch two steps (20 mm) too small at 820 mm: 2.0 km/h above 90 some channel demands the brake after 1.3 s.
    False: none does, for they read less than 90."""
    return implies(persists(two_too_fast(s), SLOWEST), s.a.brake | s.b.brake | s.c.brake)


# --- shared oscillator ---------------------------------------------------------------------------------------------


@defeated(SHARED_FAST, source="[A] one oscillator for all")
def brakes_with_a_fast_shared_oscillator(s: Seen) -> Bit:
    """With an oscillator shared by all, 6.7 % fast, overspeed still brakes.  False: every reference is too high, and
    every window in proportion."""
    return brakes(s)


# --- two silent channels -------------------------------------------------------------------------------------------

SILENT_PAIR = [NAMED["a: latch at release"], NAMED["b: no f_v"]]


@defeated(*SILENT_PAIR, source="[P] two out of three")
def brakes_with_two_silent_channels(s: Seen) -> Bit:
    """With two channels that never brake, overspeed still brakes.  False: one vote is left."""
    return brakes(s)


@claim(Ts7, faults=any_of_faults(SILENT_PAIR), expect=REFUTED, defeat=True, requirement="TS7-16", source="[P] 1.6",
       twin_of=brakes_with_one_channel_broken, scenario=too_fast(8, CHAIN.braked + 6000,
       present=[f.name for f in SILENT_PAIR], at=LATE))  # fmt: skip
def the_healthy_channel_stays_in_service(s: Seen) -> Bit:
    """With two silent channels the healthy one stays in service, or EB comes.  False: it stands alone, synchronisation
    isolates it, and EB does not come."""
    return ~s.targets.c | s.eb


# --- one fast oscillator -------------------------------------------------------------------------------------------


def window_of_a_is_right(s: Seen) -> Bit:
    """The check window of channel a counts its own frames: nothing that befalls f_s is seen there."""
    check = s.a.check
    counted = 256 * check["count"].int() + s.a.ring.j2.int() - 85 * check.frame.int()
    return ~check.faulty & (counted >= 0) & (counted <= 255)


@claim(Ts7, faults=any_of_faults([A_FAST]), start=window_of_a_is_right, anywhere=True, expect=PROVED,
       requirement="TS7-16", source="[R] all rates from one oscillator")  # fmt: skip
def the_window_is_blind_to_drift(s: Seen) -> Bit:
    """Own oscillator fast: the check window never finds it."""
    return ~s.a.fault


@claim(Ts7, faults=any_of_faults([A_FAST, NAMED["a: ring stuck"]]), expect=REFUTED, requirement="TS7-11",
       twin_of=the_window_is_blind_to_drift, scenario=Scenario(600, present=["a: ring stuck"]))  # fmt: skip
def the_window_is_blind_to_a_stuck_ring(s: Seen) -> Bit:
    """The check window never finds a ring that stands still.  False: it does."""
    return ~s.a.fault


@claim(Ts7, faults=any_of_faults([A_FAST]), expect=PROVED, lemmas=CHAIN.lemmas(), requirement="TS7-16", source="[P]",
       witness=too_fast(8, CHAIN.braked + 100, present=[A_FAST.name], at=LATE))  # fmt: skip
def the_vote_masks_a_fast_oscillator(s: Seen) -> Bit:
    """One fast oscillator is masked: the other two brake the train."""
    return implies(persists(CHAIN.overspeed(s), CHAIN.braked), s.nb)


@defeated(A_FAST, NAMED["b: latch at release"], source="[P] two out of three")
def brakes_with_a_fast_oscillator_and_a_silent_channel(s: Seen) -> Bit:
    """With one oscillator fast and another channel silent, overspeed still brakes.  False: one vote is left."""
    return brakes(s)


# --- behind the vote -----------------------------------------------------------------------------------------------


@defeated(NAMED["NB output welded"], source="[A] one output contact")
def brakes_with_a_welded_output_contact(s: Seen) -> Bit:
    """With the NB output contact welded, overspeed still brakes.  False: three channels brake, the train does not, and
    EB is not asked."""
    return brakes(s)
