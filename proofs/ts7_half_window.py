"""TS-7, the other reading of the check window: 1/2 between 1/4 and 3/4, word 128; what it finds and what it misses.

One step is one frame, 125 us, on the bench; bit by bit, 32 steps to a frame, on the ring.  Start phases, word, wheel
and speed are anything; faults of the ring come at the start of any frame.

Main results.  By counts the two readings are as good as each other: of the 163 stuck faults of the campaign either
finds 77, and of the 46 that are wrong-sided this one 36, the reference 35; either finds two cells of its own word (here
bit 6 at 1 and bit 7 at 0).  But word 128 is one bit: no carry ever passes from bit to bit, so a carry that does not
reach the adder is never found, though it makes the equipment permit too much.  The reference finds it.  A check word
that stands still drops the drive within 383 frames (47.9 ms), where the reference needs 320.
Source: fractions of the window [R]; times [D].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import cast

from models.ts7.half_window import THREE_QUARTERS, HalfBench, HalfCheckedRing
from models.ts7.ring import ring_words
from proofs.ts7_campaign import channel_single_stuck, ring_single_stuck
from proofs.ts7_parts import INVENTED_ELEMENTS, RING
from proofs.ts7_ring import (
    DOWN,
    FULL,
    HALF,
    SILENT,
    age_in_frames,
    among,
    at,
    found_after_a_block,
    frame_begins,
    stuck_stage_fills_the_ring,
)
from proofs.ts7_window import (
    ALWAYS,
    DEAD,
    NEVER,
    acted,
    acts,
    age_is_of_the_fault,
    found,
    four_blocks,
    has_acted,
    old_fault_shows_in_count,
    struck_at,
)
from safety import (
    ANY_TIME,
    BITS,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Scenario,
    Seen,
    age,
    all_of,
    at_most,
    claim,
    faulty,
    has,
    implies,
    once,
    persists,
    select,
    struck,
    stuck,
)
from safety.inject import Counts, Group, Runs, stuck_bits

WORD = 128

# --- edges of the window -------------------------------------------------------------------------------------------


def passes(s: Seen, first: int, last: int) -> Bit:
    """Check words in this range are never found faulty, others from the end of the first block on."""
    word = s["a.check_word"]
    normal = (word >= first) & (word <= last)
    return implies(once(s.a.check.frame == 255), found(s) | normal) & implies(normal, ~s.fault)


@claim(HalfBench, symbolic=["a.check_word"], requirement="TS7-11", source="[R] 1/4 and 3/4", expect=PROVED,
       witness=four_blocks())  # fmt: skip
def half_window_passes_65_to_191(s: Seen) -> Bit:
    """Any check word and phase: outside 65 to 191 found faulty from the end of the first block on, inside never."""
    return passes(s, 65, 191)


def edge(name: str, says: str, first: int, last: int, word: int) -> None:
    """Declare: with another range the sentence is false, as the run with a check word at its end shows."""

    def formula(s: Seen) -> Bit:
        return passes(s, first, last)

    formula.__name__, formula.__doc__ = name, says
    claim(HalfBench, symbolic=["a.check_word"], requirement="TS7-11", expect=REFUTED,
          twin_of=half_window_passes_65_to_191, scenario=four_blocks(**{"a.check_word": word}))(formula)  # fmt: skip


edge("half_window_passes_64", "The same for 64 to 191.", 64, 191, 64)
edge("half_window_passes_192", "The same for 65 to 192.", 65, 192, 192)
edge("half_window_refuses_65", "The same for 66 to 191.", 66, 191, 65)
edge("half_window_refuses_191", "The same for 65 to 190.", 65, 190, 191)


@claim(HalfBench, requirement="TS7-11", source="[D]", expect=PROVED)
def healthy_channel_is_never_found_faulty_by_half(s: Seen) -> Bit:
    """Check word 128, from any phases, at any word, wheel, speed and lowering: never found faulty."""
    return ~s.fault


# --- a check word that stands still --------------------------------------------------------------------------------


def young_fault_leaves_half(s: Seen) -> Bit:
    """Check word 128: the count keeps half the frames up to the onset, then nothing or one a frame is added."""
    check, healthy = s.a.check, s.a.check.frame - acted(s)
    doubled = 2 * select(has(s, ALWAYS.name), check.count.int() - acted(s), check.count.int()) - healthy
    exact = 256 * check.count.int() + s.a.ring.j2.int() - WORD * healthy
    begun = select(has(s, ALWAYS.name), doubled >= -1, doubled <= 1)
    bound = select(acted(s) == 0, (exact >= 0) & (exact <= 255), begun)
    return (check.count <= check.frame) & implies(healthy >= 0, bound)


def found_unless_past_the_middle(s: Seen) -> Bit:
    """A fault that began in frame 128 of its block or before is found at that block's end."""
    return implies((acted(s) > s.a.check.frame) & (acted(s) >= 128 + s.a.check.frame.int()), s.a.check.faulty)


STILL = [age_is_of_the_fault, old_fault_shows_in_count, young_fault_leaves_half, found_unless_past_the_middle]


@claim(HalfBench, faults=DEAD, lemmas=STILL, requirement="TS7-11", source="[D]", expect=PROVED,
       witness=struck_at(1, NEVER))  # fmt: skip
def dead_check_word_128_is_found(s: Seen) -> Bit:
    """Check word 128: no overflow, or one in every frame, for 383 frames (47.9 ms) drops the drive."""
    return implies(has_acted(s, 383), found(s))


@claim(HalfBench, faults=DEAD, requirement="TS7-11", expect=REFUTED, twin_of=dead_check_word_128_is_found,
       scenario=struck_at(129, NEVER, **{"a.ring.j2": 128}))  # fmt: skip
def dead_check_word_128_is_found_one_frame_earlier(s: Seen) -> Bit:
    """Check word 128: no overflow, or one in every frame, for 382 frames drops the drive."""
    return implies(has_acted(s, 382), found(s))


# --- one cell of the check word wrong ------------------------------------------------------------------------------

CELL = {
    word: Fault(stuck(value, bit=k), "a.ring.matrix.j2", ANY_TIME, name=f"check word is {word}")
    for word, value, k in ((0, 0, 7), (192, 1, 6), (160, 1, 5))
}


def wrong_half_shows_in_the_count(s: Seen) -> Bit:
    """A wrong word as old as the block: the count has its exact rate; older than a whole block, it is found."""
    check, frames = s.a.check, age(acts(s, CELL[0], CELL[192]), 511).int()
    rest = 256 * check.count.int() + s.a.ring.j2.int() - select(has(s, CELL[192].name), 192 * check.frame.int(), 0)
    exact = implies(frames >= check.frame, (rest >= 0) & (rest <= 255))
    acting = struck(s, CELL[0].name, CELL[192].name) | (frames == 0)
    return acting & exact & implies(frames >= 256 + check.frame.int(), check.faulty)


@claim(HalfBench, faults=at_most(1, [CELL[0], CELL[192]]), lemmas=[wrong_half_shows_in_the_count], requirement="TS7-11",
       source="[D]", expect=PROVED, witness=struck_at(1, CELL[0]))  # fmt: skip
def wrong_cell_of_bit_7_or_6_is_found_by_half(s: Seen) -> Bit:
    """Check word 0 or 192 instead of 128 for 511 frames (63.9 ms) drops the drive."""
    return implies(persists(acts(s, CELL[0], CELL[192]), 511), found(s))


@claim(HalfBench, faults=at_most(1, [CELL[160]]), requirement="TS7-11", expect=REFUTED,
       twin_of=wrong_cell_of_bit_7_or_6_is_found_by_half, scenario=struck_at(1, CELL[160]))  # fmt: skip
def wrong_cell_of_bit_5_is_found_by_half(s: Seen) -> Bit:
    """Check word 160 instead of 128 for 511 frames drops the drive.  It is as blind to its low bits as word 85."""
    return implies(persists(acts(s, CELL[160]), 511), found(s))


# --- faults in what the words share --------------------------------------------------------------------------------

NO_CARRY = at(0, "carry.in")
SILENT_HERE, FULL_HERE = [f for f in SILENT if f.name != NO_CARRY.name], [*FULL, HALF]
FOUND_HERE = at_most(1, [*SILENT_HERE, *FULL_HERE, DOWN])


def check_word_is_128(s: Seen) -> Bit:
    """The check word is 128; the other data and the speed pulses are anything, in every frame anew."""
    return s.d2 == WORD


def count_leaves_the_half_window(s: Seen) -> Bit:
    """In a block as young as the fault: none overflow, or all, or 255 of 256."""
    count, frame, phase = s.check.count.int(), s.check.frame.int(), ring_words(s.ring.ring)[2]
    down = 256 * count + phase.int() - 255 * frame
    by_class = all_of(
        implies(among(s, SILENT_HERE), count <= 1), implies(among(s, FULL_HERE), count + 1 >= frame),
        implies(among(s, [DOWN]), (down >= 0) & (down <= 255)),
    )  # fmt: skip
    return implies(age_in_frames(s) >= frame, by_class)


def runs(fault: Fault) -> Scenario:
    """600 frames with a fault, check word 128, nothing else added."""
    return Scenario(600, {"d2": WORD}, {}, [fault.name])


IN_FRAMES = {
    "steps_per_frame": 32, "anywhere": True, "start": frame_begins, "given": check_word_is_128, "requirement": "TS7-12",
}  # fmt: skip


@claim(HalfCheckedRing, arithmetic=BITS, faults=FOUND_HERE, witness=runs(DOWN), source="[P] 3.1; window [R]",
       lemmas=[frame_begins, stuck_stage_fills_the_ring, count_leaves_the_half_window, found_after_a_block],
       expect=PROVED, **IN_FRAMES)  # fmt: skip
def every_shared_fault_but_one_is_found_by_half(s: Seen) -> Bit:
    """Any stage, carry, sum or serial data stuck, save a carry that never reaches the adder: found within 511 frames,
    whatever the state before."""
    return implies(faulty(s) & (age_in_frames(s) >= 510), s.fault)


@claim(HalfCheckedRing, faults=at_most(1, [NO_CARRY]), expect=REFUTED, scenario=runs(NO_CARRY),
       twin_of=every_shared_fault_but_one_is_found_by_half, **IN_FRAMES)  # fmt: skip
def a_carry_that_never_comes_is_found_by_half(s: Seen) -> Bit:
    """A carry that never reaches the adder: found within 511 frames.  False: word 128 needs none from bit to bit."""
    return implies(faulty(s) & (age_in_frames(s) >= 510), s.fault)


# --- the campaigns over -------------------------------------------------------------------------------------------


def out_of_half_window(counts: Counts) -> Runs:
    """The check word leaves its window in some block."""
    return ((counts["o2"] <= 64) | (counts["o2"] >= THREE_QUARTERS)).any(axis=0)


COLUMN = {"neutral/no": 10, "safe/no": 2, "safe/yes": 1, "wrong/no": 2, "wrong/yes": 1}
CARRY_INTO_ADDER = Group(
    "carry into the adder", stuck_bits("carry.in"), RING["carry"].part, "carry into the adder",
    RING["carry"].rate_per_h, INVENTED_ELEMENTS, {"wrong/no": 1, "wrong/yes": 1},
)  # fmt: skip

REFERENCE_GROUPS = [
    replace(group, expect=COLUMN) if group.name == "column" else group
    for group in cast(Sequence[Group], ring_single_stuck.faults)
]

half_window_ring = replace(
    ring_single_stuck,
    id="ts7_half_window_ring",
    constant={**ring_single_stuck.constant, "d2": WORD},
    detected=out_of_half_window,
    faults=[*REFERENCE_GROUPS, CARRY_INTO_ADDER],
    expect={"detected": 78, "safe": 10, "dangerous_undetected": 11, "no_effect": 66, "wrong/yes": 37, "wrong/no": 11},
)

half_window_channel = replace(channel_single_stuck, id="ts7_half_window_channel", model=HalfBench)
