"""TS-7, what stands between the parts: who is lowered, what a channel's own fault does, and the AC drive.

One step is one frame, 125 us.  Relays release in 160 frames (20 ms).
Source: the level of the other two is lowered, a faulty channel is cut off, AC drive of the output [P]; relay times [A].

Main results: only a channel that did not brake first is lowered, within a window; a channel that finds itself faulty
has its target dropped in the same frame and votes to brake 40 ms later; an output that stands still drops its drive.
"""

from __future__ import annotations

from models.ts7.system import Ts7
from models.ts7.train import Bench
from models.ts7.voting import CommonPart
from proofs.ts7_brake_chain import CHANNELS, RELEASE
from proofs.ts7_formulas import Formula, named
from proofs.ts7_power import falls
from proofs.ts7_voting import OFFSETS, too_fast
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Scenario,
    Seen,
    age,
    all_of,
    any_of,
    at_most,
    claim,
    implies,
    persists,
    struck,
    stuck,
)

# --- lowering --------------------------------------------------------------------------------------------------------

A_BRAKES_FIRST = too_fast(0, 3000, start={"a.offset": -4})


@claim(Ts7, symbolic=OFFSETS, expect=PROVED, witness=A_BRAKES_FIRST, requirement="TS7-8",
       source="[P] the level of the other two is lowered")  # fmt: skip
def the_first_to_brake_is_not_lowered(s: Seen) -> Bit:
    """A channel's limit is lowered only within a window of synchronisation, and not if it braked first."""
    sync = s.common.sync
    late = all_of(*(~s[n].lowered | ~sync.window[f"first_{n}"] for n in CHANNELS))
    return implies(any_of(*(s[n].lowered for n in CHANNELS)), sync.window.open & late)


@claim(Ts7, symbolic=OFFSETS, expect=REFUTED, twin_of=the_first_to_brake_is_not_lowered, requirement="TS7-8",
       scenario=A_BRAKES_FIRST)  # fmt: skip
def no_channel_is_lowered(s: Seen) -> Bit:
    """No limit is ever lowered."""
    return all_of(*(~s[n].lowered for n in CHANNELS))


# --- a channel that finds itself faulty ------------------------------------------------------------------------------

ISOLATED = 2 * RELEASE + 2  # frames from the channel's report to its vote: latch, CHR, NBRR


def cut_off(n: str) -> Formula:
    """Lemma: since its report channel n is cut, its CHR falls, then its NBRR."""

    def lemma(s: Seen) -> Bit:
        t, relays = age(s[n].fault, ISOLATED).int(), s[n]
        fallen = falls(relays.chr_relay, t - 1) & falls(relays.nbrr_relay, t - 1 - RELEASE)
        return (t == 0) | (s.sync[f"cut_{n}"] & fallen)

    return named(f"{n} is cut off since its report", lemma)


B_REPORTS = Scenario(2000, {"supply": True, **{f"{n}.drive": True for n in CHANNELS}, "b.fault": lambda k: k >= 1000})


def isolated_after(s: Seen, frames: int) -> Bit:
    """A channel that has reported its fault for so many frames is out of service and votes to brake."""
    reports = {n: persists(s[n].fault, frames) for n in CHANNELS}
    out = all_of(*(~reports[n] | (s.isolated[n] & s.brakes[n]) for n in CHANNELS))
    return implies(any_of(*reports.values()), out)


@claim(CommonPart, expect=PROVED, lemmas=[cut_off(n) for n in CHANNELS], witness=B_REPORTS, requirement="TS7-11",
       source="[P] a detected channel is cut off and flagged")  # fmt: skip
def a_channel_that_reports_its_fault_is_isolated(s: Seen) -> Bit:
    """A channel that reports its own fault drops its target at once, CHR and NBRR within 322 frames (40 ms)."""
    at_once = all_of(*(~s[n].fault | s.targets[n] for n in CHANNELS))
    return at_once & isolated_after(s, ISOLATED)


@claim(CommonPart, expect=REFUTED, twin_of=a_channel_that_reports_its_fault_is_isolated, scenario=B_REPORTS,
       requirement="TS7-11")  # fmt: skip
def a_channel_that_reports_its_fault_is_isolated_a_frame_earlier(s: Seen) -> Bit:
    """The time is exact."""
    return isolated_after(s, ISOLATED - 1)


# --- the AC drive ----------------------------------------------------------------------------------------------------

STANDS = [Fault(stuck(value), ["a.output.level"], ANY_TIME, name=f"output stands at {value}") for value in (0, 1)]
OSCILLATES = Fault(stuck(1), ["a.output.toggle"], ANY_TIME, name="output oscillates")


def released(**more) -> Scenario:
    """The channel at 30 words under signal 65, wheel of 820 mm."""
    inputs = {"word": 138, "wheel": 164, "true_wheel": 164, "speed": 30 * 4096}
    return Scenario(3000, inputs, at=2000, **more)


@claim(Bench, faults=at_most(1, STANDS), expect=PROVED, requirement="TS7-1",
       source="[P] AC drive", witness=released(present=[STANDS[1].name]))  # fmt: skip
def an_output_that_stands_still_drops_the_drive(s: Seen) -> Bit:
    """Output stuck high or low at any time: from the next frame on there is no AC, and NBRR has no drive."""
    return implies(struck(s, *(fault.name for fault in STANDS)), ~s.drive)


@claim(Bench, faults=at_most(1, [OSCILLATES]), expect=REFUTED, requirement="TS7-1",
       twin_of=an_output_that_stands_still_drops_the_drive, scenario=released(present=[OSCILLATES.name]))  # fmt: skip
def an_output_that_oscillates_drops_the_drive(s: Seen) -> Bit:
    """An amplifier that oscillates by itself drops the drive too: it does not, and the channel never brakes."""
    return implies(struck(s, OSCILLATES.name), ~s.drive)
