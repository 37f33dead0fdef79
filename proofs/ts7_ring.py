"""TS-7 ring arithmetic: exact rates, the serial ring does what whole words do, and every shared fault is found.

A word D added to a phase of 8 bits in n frames overflows n*D/256 times, rounded down or up, for ever: the phase is the
remainder.  The ring as built, bit by bit, is that adder for four words at once.  What all four words share (stages,
carry, sum, serial data) cannot fail without the check word overflowing at a rate outside its window.

Steps: 125 us on `Words`; 3.90625 us, 32 to a frame, on `Ring`.
Source: ring of 4 x 8 bits, serial adder, fault-detection word [P]; check window [R].
"""

from models.ts7.bench import CheckedRing
from models.ts7.numbers import CHECK_WORD
from models.ts7.ring import BITS_A_FRAME, Ring, Words, frame_starts, ring_words
from models.ts7.train import SCALE, Bench
from proofs.ts7_formulas import PULSE, SPEED_FRACTION, wheel_set_right
from safety import (
    BITS,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Int,
    Scenario,
    Seen,
    UInt,
    all_of,
    at_most,
    claim,
    faulty,
    has,
    implies,
    previous,
    refines,
    stuck,
    total,
    word,
)

# --- exact rate ----------------------------------------------------------------------------------------------------

LONG = 2**44  # frames that the ghost counters can count: 70 years


def frames(s: Seen) -> Int:
    """Frames since the start."""
    return total(word(1, 1), LONG).int()


def overflows(s: Seen) -> Int:
    """Overflows of J0 since the start."""
    return total(s.o0.word(), LONG).int()


def datum_before(s: Seen) -> UInt:
    """The datum of J0 one frame before."""
    return previous(s.d0, 0)


@claim(Words, requirement="TS7-4", source="[P] ring arithmetic", expect=PROVED)
def nothing_is_lost_in_a_frame(s: Seen) -> Bit:
    """In each frame: phase + datum = 256 * overflow + next phase.  Summed up: the exact rate for any n frames."""
    before = previous(s.j0, 0).int() + datum_before(s).int()
    return implies(frames(s) > 0, 256 * previous(s.o0.word(), 0).int() + s.j0.int() == before)


def sum_is_count_and_phase(s: Seen) -> Bit:
    """The sum of the data is 256 * overflows + phase - phase at the start."""
    rest = 256 * overflows(s) + s.j0.int() - total(s.d0, 256 * LONG).int()
    return (rest >= 0) & (rest <= 255)


def sum_is_frames_times_word(s: Seen) -> Bit:
    """With one word all the time the sum of the data is frames * word."""
    return implies(frames(s) < LONG, total(s.d0, 256 * LONG).int() == frames(s) * datum_before(s).int())


def one_word(s: Seen) -> Bit:
    """The datum of J0 is the same in every frame."""
    return (frames(s) == 0) | (s.d0 == datum_before(s))


@claim(
    Words, anywhere=True, given=one_word, lemmas=[sum_is_count_and_phase, sum_is_frames_times_word],
    requirement="TS7-4", source="[P] ring arithmetic", expect=PROVED,
)  # fmt: skip
def overflows_are_n_d_over_256(s: Seen) -> Bit:
    """Any word D, any phase, any n frames (to 70 years) from any moment: n*D/256 overflows, rounded down or up."""
    rest = 256 * overflows(s) - frames(s) * datum_before(s).int()
    return implies(frames(s) < LONG, (rest > -256) & (rest < 256))


@claim(Words, anywhere=True, given=one_word, requirement="TS7-4", expect=REFUTED, twin_of=overflows_are_n_d_over_256)
def overflows_are_n_d_over_256_rounded_down(s: Seen) -> Bit:
    """Any word D, any phase, any n frames: never more than n*D/256 overflows."""
    return 256 * overflows(s) <= frames(s) * datum_before(s).int()


@claim(
    Words, anywhere=True, given=one_word, lemmas=[sum_is_count_and_phase, sum_is_frames_times_word],
    requirement="TS7-4", source="[D]", expect=PROVED, witness=Scenario(300, {"d0": CHECK_WORD}),
)  # fmt: skip
def word_d_overflows_d_times_in_256_frames(s: Seen) -> Bit:
    """Any word D, any 256 consecutive frames: exactly D overflows; 85 for the check word."""
    return implies(frames(s) == 256, overflows(s) == datum_before(s).int())


@claim(
    Words, anywhere=True, given=one_word, requirement="TS7-4", expect=REFUTED,
    twin_of=word_d_overflows_d_times_in_256_frames, scenario=Scenario(300, {"d0": CHECK_WORD}),
)  # fmt: skip
def word_d_overflows_d_times_in_255_frames(s: Seen) -> Bit:
    """Any word D, any 255 consecutive frames: exactly D overflows."""
    return implies(frames(s) == 255, overflows(s) == datum_before(s).int())


def check_word_is_85(s: Seen) -> Bit:
    """The check word is 85; the other data and the speed pulses are anything, in every frame anew."""
    return s.d2 == CHECK_WORD


@claim(
    Words, anywhere=True, given=check_word_is_85, 
    requirement="TS7-4", source="[D]", expect=PROVED, witness=Scenario(300, {"d2": CHECK_WORD}),
)  # fmt: skip
def check_word_overflows_85_times_in_256_frames(s: Seen) -> Bit:
    """Check word 85, any phase, any 256 consecutive frames: exactly 85 overflows of J2."""
    return implies(frames(s) == 256, total(s.o2.word(), LONG) == 85)


# --- wheel words ---------------------------------------------------------------------------------------------------


def way(s: Seen) -> Int:
    """Way since the start, 2**-24 of the way from one f_v pulse to the next."""
    return total(s.speed.sat(24), PULSE * LONG).int()


@claim(
    Bench, given=wheel_set_right, 
    requirement="TS7-5", source="[P] nine steps; words diameter / 5 mm [A]", expect=PROVED,
)  # fmt: skip
def way_of_a_pulse_is_the_same_for_all_wheels(s: Seen) -> Bit:
    """All nine wheels, set right: the f_v pulses count the way, never off by more than 1.7 pulses, at any distance."""
    off = PULSE * total(s.a.f_v.word(), LONG).int() - way(s)
    return implies(way(s) < PULSE * LONG, (off >= -SPEED_FRACTION) & (off <= SPEED_FRACTION))


def wheel_one_step_too_small(s: Seen) -> Bit:
    """The wheel switch shows 10 mm less than the true diameter."""
    return s.wheel + 2 == s.true_wheel


@claim(
    Bench, given=wheel_one_step_too_small, requirement="TS7-5", expect=REFUTED,
    twin_of=way_of_a_pulse_is_the_same_for_all_wheels,
    scenario=Scenario(600, {"wheel": 164, "true_wheel": 166, "speed": 160 * SCALE}),
)  # fmt: skip
def way_of_a_pulse_is_the_same_one_step_off(s: Seen) -> Bit:
    """Wheel set one step too small: the f_v pulses count the way, never off by more than 1.7 pulses."""
    return way_of_a_pulse_is_the_same_for_all_wheels(s)


# --- the ring as built does what the words do ----------------------------------------------------------------------

OVERFLOWS = ("o0", "o1", "o2", "o3")


def words_of(s: Seen) -> dict[str, UInt]:
    """The words J0 to J3 in the ring."""
    return dict(zip(("j0", "j1", "j2", "j3"), ring_words(s.ring), strict=True))


def frame_at(s: Seen) -> Bit:
    """The next bit time is the first of a frame."""
    return frame_starts(s.place)


@refines(
    Ring, Words, steps=BITS_A_FRAME, at=frame_at, outputs=OVERFLOWS,
    requirement="TS7-4", source="[P] ring, serial adder", expect=PROVED,
)  # fmt: skip
def ring_adds_four_words(s: Seen) -> dict[str, UInt]:
    """In 32 bit times the ring does to its four words, with any data, what four adders do in one frame."""
    return words_of(s)


NO_CLEAR = at_most(1, [Fault(stuck(0), "carry.clear", name="carry is not cleared")])


@refines(
    Ring, Words, steps=BITS_A_FRAME, at=frame_at, outputs=OVERFLOWS, faults=NO_CLEAR,
    requirement="TS7-4", expect=REFUTED, twin_of=ring_adds_four_words,
)  # fmt: skip
def ring_adds_four_words_without_clear(s: Seen) -> dict[str, UInt]:
    """The same where the carry is not cleared at the first bit of a word."""
    return words_of(s)


# --- every fault in what the words share is found ------------------------------------------------------------------

STAGES = range(32)


def at(value: int, *points: str, bit: int | None = None) -> Fault:
    """Points of the ring stuck at a value together, named by the points."""
    name = f"{'+'.join(points)}{'' if bit is None else f' bit {bit}'} at {value}"
    return Fault(stuck(value, bit), [f"ring.{p}" for p in points], name=name)


STAGE = {value: [at(value, "ring", bit=k) for k in STAGES] for value in (0, 1)}
SILENT = [*STAGE[0], at(0, "sum"), at(0, "data"), at(0, "carry.in"), at(0, "carry.out"), at(0, "carry.in", "carry.out")]
FULL = [*STAGE[1], at(1, "sum"), at(1, "carry.out"), at(1, "carry.in", "carry.out")]
HALF, DOWN = at(1, "carry.in"), at(1, "data")  # check word counts as 128, as 255
SHARED = at_most(1, [*SILENT, *FULL, HALF, DOWN])


def among(s: Seen, faults: list[Fault]) -> Bit:
    """One of the faults is in the ring."""
    return has(s, *(f.name for f in faults))


def runs(fault, start=None):
    """600 frames with a fault, check word 85, nothing else added."""
    return Scenario(600, {"d2": CHECK_WORD}, start or {}, [fault.name])


def frame_begins(s: Seen) -> Bit:
    """A frame begins; the window has counted no more overflows than frames; ring, carry and phases are anything."""
    return frame_starts(s.ring.place) & (s.check.count <= s.check.frame)


def age_in_frames(s: Seen) -> Int:
    """Frames since the fault came, counted to 511."""
    return total(word(1, 1), 511).int()


def stuck_stage_fills_the_ring(s: Seen) -> Bit:
    """After a frame, what has passed a stuck stage is constant."""
    passed = [(value, k, s.ring.ring.slice(0, k)) for value in (0, 1) for k in STAGES if k]
    constant = [implies(has(s, STAGE[v][k].name), bits == v * (2**k - 1)) for v, k, bits in passed]
    empty = implies(among(s, [at(0, "sum")]), s.ring.ring == 0)
    full = implies(among(s, [at(1, "sum")]), s.ring.ring == 2**32 - 1)
    return implies(age_in_frames(s) >= 1, all_of(*constant, empty, full))


def count_leaves_the_window(s: Seen) -> Bit:
    """In a block as young as the fault: none overflow, or all, or half of the frames, or 255 of 256."""
    count, frame, phase = s.check.count.int(), s.check.frame.int(), ring_words(s.ring.ring)[2]
    down = 256 * count + phase.int() - 255 * frame
    half = 2 * count + phase.bit(7).word().int() - frame
    by_class = all_of(
        implies(among(s, SILENT), count <= 1), implies(among(s, FULL), count + 1 >= frame),
        implies(among(s, [DOWN]), (down >= 0) & (down <= 255)), implies(among(s, [HALF]), (half >= 0) & (half <= 1)),
    )  # fmt: skip
    return implies(age_in_frames(s) >= frame, by_class)


def found_after_a_block(s: Seen) -> Bit:
    """A fault older than this block and the one before is found."""
    return implies(faulty(s) & (age_in_frames(s) >= 256 + s.check.frame.int()), s.check.faulty)


@claim(
    CheckedRing, steps_per_frame=BITS_A_FRAME, arithmetic=BITS, anywhere=True, start=frame_begins,
    given=check_word_is_85, faults=SHARED,
    lemmas=[frame_begins, stuck_stage_fills_the_ring, count_leaves_the_window, found_after_a_block],
    requirement="TS7-12", source="[P] 3.1; window [R]", expect=PROVED, witness=runs(DOWN),
)  # fmt: skip
def every_shared_fault_is_found(s: Seen) -> Bit:
    """Any stage, carry, sum or serial data stuck at 0 or 1: found within 511 frames, whatever the state before."""
    return implies(faulty(s) & (age_in_frames(s) >= 510), s.fault)


@claim(
    CheckedRing, steps_per_frame=BITS_A_FRAME, anywhere=True, start=frame_begins, given=check_word_is_85,
    faults=SHARED, requirement="TS7-12", expect=REFUTED, twin_of=every_shared_fault_is_found,
    scenario=runs(at(0, "sum"), {"check.frame": 193, "check.count": 65}),
)  # fmt: skip
def every_shared_fault_is_found_within_a_block(s: Seen) -> Bit:
    """Any stage, carry, sum or serial data stuck at 0 or 1: found within 256 frames."""
    return implies(faulty(s) & (age_in_frames(s) >= 255), s.fault)


COLUMNS = at_most(1, [at(value, "column", bit=k) for value in (0, 1) for k in range(8)])


@claim(
    CheckedRing, steps_per_frame=BITS_A_FRAME, anywhere=True, start=frame_begins, given=check_word_is_85,
    faults=COLUMNS, requirement="TS7-12", expect=REFUTED, defeat=True, twin_of=every_shared_fault_is_found,
    scenario=runs(at(1, "column", bit=5)),
)  # fmt: skip
def every_column_fault_is_found(s: Seen) -> Bit:
    """Any column line of the data matrix stuck at 0 or 1, shared by all words: found within 511 frames."""
    return implies(faulty(s) & (age_in_frames(s) >= 510), s.fault)


CELLS = at_most(1, [at(value, "matrix.j0", bit=k) for value in (0, 1) for k in range(8)])


@claim(
    CheckedRing, steps_per_frame=BITS_A_FRAME, anywhere=True, start=frame_begins, given=check_word_is_85,
    faults=CELLS, requirement="TS7-12", expect=REFUTED, defeat=True, twin_of=every_shared_fault_is_found,
    scenario=runs(at(1, "matrix.j0", bit=7)),
)  # fmt: skip
def every_cell_fault_is_found(s: Seen) -> Bit:
    """Any matrix cell of the speed limit stuck at 0 or 1: found within 511 frames.  The check word cannot see it."""
    return implies(faulty(s) & (age_in_frames(s) >= 510), s.fault)
