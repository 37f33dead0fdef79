"""TS-7, check window: how late a fault can be found that comes at any time, exactly.

One step is one frame, 125 us; a block is 256 frames (32 ms), and a fault may come at any frame of it, at any phases.
A fault of the ring may also come within a frame: then whole frames with it begin up to 31 bit times later, in a state
that is one of those from which the claims about the ring start.

Main results: the printed scheme finds within two blocks, 64 ms.  The latest is a carry stuck at 1: 511 frames (63.9 ms)
from the first whole frame on, and 510 are not enough; with a frame begun that is 16383 bit times at most, one less than
64 ms.  A wrong cell of bit 6 or 7 of the check word drops the drive within exactly 341 frames (42.6 ms), a check word
that stands still within exactly 320 (ts7_window).
Source: window [R]; times [D].
"""

from __future__ import annotations

from models.ts7.bench import CheckedRing
from models.ts7.ring import BITS_A_FRAME
from models.ts7.train import Bench
from proofs.ts7_ring import (
    HALF,
    SHARED,
    age_in_frames,
    check_word_is_85,
    every_shared_fault_is_found,
    frame_begins,
    runs,
)
from proofs.ts7_window import BIT6, BIT7, WRONG, acts, found, struck_at
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Int,
    Seen,
    age,
    at_most,
    byzantine,
    claim,
    faulty,
    has,
    implies,
    select,
    struck,
)

# --- the ring ------------------------------------------------------------------------------------------------------


@claim(CheckedRing, steps_per_frame=BITS_A_FRAME, anywhere=True, start=frame_begins, given=check_word_is_85,
       faults=SHARED, expect=REFUTED, requirement="TS7-12", twin_of=every_shared_fault_is_found,
       scenario=runs(HALF, {"check.frame": 1}))  # fmt: skip
def every_shared_fault_is_found_a_frame_earlier(s: Seen) -> Bit:
    """Any stage, carry, sum or serial data stuck at 0 or 1: found within 510 frames.  False: a carry stuck at 1 makes
    the check word count as 128, and a block in which it comes a frame late ends with 127."""
    return implies(faulty(s) & (age_in_frames(s) >= 509), s.fault)


ANY_PULSE = at_most(1, [Fault(byzantine(), "ring.overflow.o2", ANY_TIME, name="any pulses of the check word")])


@claim(CheckedRing, faults=ANY_PULSE, expect=PROVED, requirement="TS7-12", source="[D]")
def a_frame_begins_as_the_proof_of_the_ring_starts(s: Seen) -> Bit:
    """Whatever pulses the check word gives, from any bit time on: at every bit time, and so where a frame begins, the
    window has counted no more overflows than frames."""
    return s.check.count <= s.check.frame


@claim(CheckedRing, faults=ANY_PULSE, expect=REFUTED, requirement="TS7-12",
       twin_of=a_frame_begins_as_the_proof_of_the_ring_starts)  # fmt: skip
def a_frame_begins_with_fewer_overflows_than_frames(s: Seen) -> Bit:
    """Whatever pulses the check word gives: the window has counted fewer overflows than frames."""
    return s.check.count < s.check.frame


# --- cells of the check word ---------------------------------------------------------------------------------------

FOUND = 341  # frames


def acted(s: Seen) -> Int:
    """For how many frames the wrong word has acted before this one, counted to 511."""
    return age(acts(s, BIT6, BIT7), 511).int()


def count_is_exact(s: Seen) -> Bit:
    """The count has the rate of 85 up to the onset in its block, and that of the wrong word since, to the last bit."""
    check = s.a.check
    here = select(acted(s) < check.frame.int(), acted(s), check.frame.int())
    rest = 256 * check.count.int() + s.a.ring.j2.int() - 85 * (check.frame.int() - here)
    by_wrong = select(has(s, BIT7.name), 213 * here, 21 * here)
    acting = struck(s, BIT6.name, BIT7.name) | (acted(s) == 0)
    return acting & (rest - by_wrong >= 0) & (rest - by_wrong <= 255)


def found_unless_late_in_its_block(s: Seen) -> Bit:
    """A wrong word that began in frame 170 of its block or before is found at that block's end."""
    frame = s.a.check.frame.int()
    return implies((acted(s) > frame) & (acted(s) >= 86 + frame), s.a.check.faulty)


@claim(Bench, faults=WRONG, lemmas=[count_is_exact, found_unless_late_in_its_block], expect=PROVED,
       requirement="TS7-11", source="[D]", witness=struck_at(1, BIT6))  # fmt: skip
def wrong_cell_is_found_whenever_it_comes(s: Seen) -> Bit:
    """Check word 21 or 213 instead of 85 for 341 frames (42.6 ms) drops the drive."""
    return implies(acts(s, BIT6, BIT7) & (acted(s) >= FOUND - 1), found(s))


@claim(Bench, faults=WRONG, expect=REFUTED, requirement="TS7-11", twin_of=wrong_cell_is_found_whenever_it_comes,
       scenario=struck_at(171, BIT7))  # fmt: skip
def wrong_cell_is_found_a_frame_earlier(s: Seen) -> Bit:
    """Check word 21 or 213 instead of 85 for 340 frames drops the drive."""
    return implies(acts(s, BIT6, BIT7) & (acted(s) >= FOUND - 2), found(s))
