"""TS-7, the check window of one channel: a wrong check rate is found, a healthy channel is never found faulty.

One step is one frame, 125 us; a block is 256 frames (32 ms).  All start phases, any word, wheel, speed and lowering;
faults come at any time.

Main results: a check word 85 that overflows never, or in every frame, drops the drive within exactly 320 frames
(40.0 ms), any other one within 447 (55.9 ms): both inside the 64 ms of two blocks.  The words 65 to 127 are never found
faulty, all others at the end of the first block.
Source: 1/3 between 1/4 and 1/2 of the word frequency [R]; times [D].
"""

from dataclasses import replace

from models.ts7.train import Bench
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Int,
    Scenario,
    Seen,
    age,
    at_most,
    claim,
    has,
    implies,
    new_fault,
    once,
    persists,
    select,
    struck,
    stuck,
)

NEVER = Fault(stuck(0), "a.ring.overflow.o2", ANY_TIME, name="check word never overflows")
ALWAYS = Fault(stuck(1), "a.ring.overflow.o2", ANY_TIME, name="check word always overflows")
BIT6 = Fault(stuck(0, bit=6), "a.ring.matrix.j2", ANY_TIME, name="check word is 21")
BIT7 = Fault(stuck(1, bit=7), "a.ring.matrix.j2", ANY_TIME, name="check word is 213")
BIT0 = Fault(stuck(0, bit=0), "a.ring.matrix.j2", ANY_TIME, name="check word is 84")
DEAD, WRONG = at_most(1, [NEVER, ALWAYS]), at_most(1, [BIT6, BIT7])


def four_blocks(**start):
    """Standing still for 1024 frames."""
    return Scenario(1024, {"wheel": 164, "true_wheel": 164}, start)


def struck_at(frame, fault, **start):
    """Standing still for 1024 frames; the fault begins to act in one of them."""
    return replace(four_blocks(**start), present=[fault.name], at=frame)


def acts(s: Seen, *faults: Fault) -> Bit:
    """One of the faults acts, now or since an earlier frame."""
    return struck(s, *(f.name for f in faults)) | (has(s, *(f.name for f in faults)) & new_fault(s))


def found(s: Seen) -> Bit:
    """The channel reports its fault and its drive has no AC, so that NBRR_i and CHR_i drop."""
    return s.fault & ~s.drive


# --- a check word that overflows never or always -------------------------------------------------------------------


def acted(s: Seen) -> Int:
    """For how many frames the fault has acted before this one, counted to 511."""
    return age(acts(s, NEVER, ALWAYS), 511).int()


def has_acted(s: Seen, frames: int) -> Bit:
    """The fault acts, for so many frames with this one."""
    return acts(s, NEVER, ALWAYS) & (acted(s) >= frames - 1)


def old_fault_shows_in_count(s: Seen) -> Bit:
    """A fault as old as the block: the count is 0, or full."""
    dead = select(has(s, ALWAYS.name), s.a.check.count == s.a.check.frame, s.a.check.count == 0)
    return implies(acted(s) >= s.a.check.frame, dead)


def young_fault_bounds_count(s: Seen) -> Bit:
    """A fault younger than the block: the count is that of the onset, one a frame at most, or has grown by its age."""
    count, frame = s.a.check.count.int(), s.a.check.frame
    young = select(has(s, ALWAYS.name), count >= acted(s), count <= frame - acted(s))
    return (count <= frame) & implies(acted(s) <= frame, young)


def found_unless_64_came_before(s: Seen) -> Bit:
    """A fault that began in frame 64 of its block or before is found at that block's end."""
    return implies((acted(s) > s.a.check.frame) & (acted(s) >= 192 + s.a.check.frame.int()), s.a.check.faulty)


@claim(
    Bench, faults=DEAD, symbolic=["a.check_word"],
    lemmas=[old_fault_shows_in_count, young_fault_bounds_count, found_unless_64_came_before],
    requirement="TS7-11", source="[D] of the window [R]", expect=PROVED, witness=struck_at(1, NEVER),
)  # fmt: skip
def dead_check_is_found(s: Seen) -> Bit:
    """Whatever the check word: no overflow, or one in every frame, for 447 frames (55.9 ms) drops the drive."""
    return implies(has_acted(s, 447), found(s))


@claim(
    Bench, faults=DEAD, symbolic=["a.check_word"], requirement="TS7-11", expect=REFUTED, twin_of=dead_check_is_found,
    scenario=struck_at(65, NEVER, **{"a.check_word": 255, "a.ring.j2": 255}),
)  # fmt: skip
def dead_check_is_found_one_frame_earlier(s: Seen) -> Bit:
    """Whatever the check word: no overflow, or one in every frame, for 446 frames drops the drive."""
    return implies(has_acted(s, 446), found(s))


def age_is_of_the_fault(s: Seen) -> Bit:
    """The age that is counted is that of a fault which acts."""
    return struck(s, NEVER.name, ALWAYS.name) | (acted(s) == 0)


def young_fault_leaves_count(s: Seen) -> Bit:
    """Check word 85: the count keeps the exact rate up to the fault's onset, then nothing or one a frame is added."""
    check, healthy = s.a.check, s.a.check.frame - acted(s)
    exact = 256 * check.count.int() + s.a.ring.j2.int() - 85 * healthy
    never = 256 * check.count.int() - 85 * healthy
    always = 256 * (check.count.int() - acted(s)) - 85 * healthy
    young = select(has(s, ALWAYS.name), always >= -255, never <= 255)
    bound = select(acted(s) == 0, (exact >= 0) & (exact <= 255), young)
    return (check.count <= check.frame) & implies(healthy >= 0, bound)


def found_unless_late_in_its_block(s: Seen) -> Bit:
    """A fault that began in frame 191 of its block or before is found at that block's end."""
    return implies((acted(s) > s.a.check.frame) & (acted(s) >= 65 + s.a.check.frame.int()), s.a.check.faulty)


@claim(
    Bench, faults=DEAD,
    lemmas=[age_is_of_the_fault, old_fault_shows_in_count, young_fault_leaves_count, found_unless_late_in_its_block],
    requirement="TS7-11", source="[D]", expect=PROVED, witness=struck_at(1, NEVER),
)  # fmt: skip
def dead_check_word_85_is_found_at_once(s: Seen) -> Bit:
    """Check word 85: no overflow, or one in every frame, for 320 frames (40.0 ms) drops the drive."""
    return implies(has_acted(s, 320), found(s))


@claim(
    Bench, faults=DEAD, requirement="TS7-11", expect=REFUTED, twin_of=dead_check_word_85_is_found_at_once,
    scenario=struck_at(192, ALWAYS),
)  # fmt: skip
def dead_check_word_85_is_found_one_frame_earlier(s: Seen) -> Bit:
    """Check word 85: no overflow, or one in every frame, for 319 frames drops the drive."""
    return implies(has_acted(s, 319), found(s))


# --- wrong check words ---------------------------------------------------------------------------------------------


def normal(s: Seen) -> Bit:
    """The check word is one of 65 to 127."""
    return (s["a.check_word"] > 64) & (s["a.check_word"] < 128)


@claim(
    Bench, symbolic=["a.check_word"], 
    requirement="TS7-11", source="[R] 1/4 and 1/2", expect=PROVED, witness=four_blocks(),
)  # fmt: skip
def window_passes_65_to_127(s: Seen) -> Bit:
    """Any check word and phase: outside 65 to 127 found faulty from the end of the first block on, inside never."""
    return implies(once(s.a.check.frame == 255), found(s) | normal(s)) & implies(normal(s), ~s.fault)


@claim(
    Bench, symbolic=["a.check_word"], requirement="TS7-11", expect=REFUTED, twin_of=window_passes_65_to_127,
    scenario=four_blocks(**{"a.check_word": 64}),
)  # fmt: skip
def window_passes_64(s: Seen) -> Bit:
    """A channel whose check word is 64 to 127 is never found faulty."""
    return implies((s["a.check_word"] >= 64) & (s["a.check_word"] < 128), ~s.fault)


@claim(
    Bench, symbolic=["a.check_word"], requirement="TS7-11", expect=REFUTED, twin_of=window_passes_65_to_127,
    scenario=four_blocks(**{"a.check_word": 128}),
)  # fmt: skip
def window_passes_128(s: Seen) -> Bit:
    """A channel whose check word is 65 to 128 is never found faulty."""
    return implies((s["a.check_word"] > 64) & (s["a.check_word"] <= 128), ~s.fault)


@claim(
    Bench, symbolic=["a.check_word"], requirement="TS7-11", expect=REFUTED, twin_of=window_passes_65_to_127,
    scenario=four_blocks(**{"a.check_word": 65}),
)  # fmt: skip
def window_refuses_65(s: Seen) -> Bit:
    """A channel whose check word is not 66 to 127 is found faulty at the end of the first block."""
    return implies(once(s.a.check.frame == 255) & (s["a.check_word"] <= 65), found(s))


@claim(
    Bench, symbolic=["a.check_word"], requirement="TS7-11", expect=REFUTED, twin_of=window_passes_65_to_127,
    scenario=four_blocks(**{"a.check_word": 127}),
)  # fmt: skip
def window_refuses_127(s: Seen) -> Bit:
    """A channel whose check word is not 65 to 126 is found faulty at the end of the first block."""
    return implies(once(s.a.check.frame == 255) & (s["a.check_word"] >= 127), found(s))


@claim(Bench, requirement="TS7-11", source="[D]", expect=PROVED)
def healthy_channel_is_never_found_faulty(s: Seen) -> Bit:
    """Check word 85, from any phases, at any word, wheel, speed and lowering: never found faulty."""
    return ~s.fault


# --- one cell of the check word wrong ------------------------------------------------------------------------------


def wrong_word_shows_in_the_count(s: Seen) -> Bit:
    """A wrong word as old as the block: the count has its exact rate; older than a whole block, it is found."""
    check, frames = s.a.check, age(acts(s, BIT6, BIT7), 511).int()
    word = select(has(s, BIT7.name), 213 * check.frame.int(), 21 * check.frame.int())
    rest = 256 * check.count.int() + s.a.ring.j2.int() - word
    exact = implies(frames >= check.frame, (rest >= 0) & (rest <= 255))
    acting = struck(s, BIT6.name, BIT7.name) | (frames == 0)
    return acting & exact & implies(frames >= 256 + check.frame.int(), check.faulty)


@claim(
    Bench, faults=WRONG, lemmas=[wrong_word_shows_in_the_count],
    requirement="TS7-11", source="[D]", expect=PROVED, witness=struck_at(1, BIT6),
)  # fmt: skip
def wrong_cell_of_bit_6_or_7_is_found(s: Seen) -> Bit:
    """Check word 21 or 213 instead of 85 for 511 frames (63.9 ms) drops the drive."""
    return implies(persists(acts(s, BIT6, BIT7), 511), found(s))


@claim(
    Bench, faults=at_most(1, [BIT0]), requirement="TS7-11", expect=REFUTED, defeat=True,
    twin_of=wrong_cell_of_bit_6_or_7_is_found, scenario=struck_at(1, BIT0),
)  # fmt: skip
def wrong_cell_of_bit_0_is_found(s: Seen) -> Bit:
    """Check word 84 instead of 85 for 511 frames drops the drive.  The window does not see its own low bits."""
    return implies(persists(acts(s, BIT0), 511), found(s))
