"""Dual bus-synchronous processors: what the comparison promises for ever, and what it cannot see.

One step is one bus cycle; the balise, the line data, the odometer and the speed are anything at every step.  A broken
processor is one of which every word on its bus and every register shows anything in every cycle (byzantine).

Main results: with one processor broken, in any way and from any cycle on, the relay is energised only where both
permit and where the truth permits (AV-7); a mismatch brakes in the next cycle and for ever.  Identical wrong line data,
or one and the same fault in both processors, is not seen (AV-8); a second source of line data finds a wrong entry of
one.  A comparator with a steady instead of an alternating signal is unsafe by the loss of the clock alone.
"""

from __future__ import annotations

from models.dual_processor import (
    CHECK_BITS,
    DATA_BITS,
    BusCompared,
    OnBoard,
    StaticSignal,
    TwoSourceOnBoard,
)
from proofs.ts7_formulas import Formula, named
from safety import (
    ANY_TIME,
    BITS,
    PROVED,
    REFUTED,
    TRANSIENT,
    Bit,
    Fault,
    Scenario,
    Seen,
    all_of,
    any_of,
    at_most,
    byzantine,
    claim,
    flip,
    implies,
    once,
    previous,
    select,
    struck,
    stuck,
)

AV7, AV8 = "AV-7", "AV-8"
PRINTED = "[P] comparison of both buses in each cycle, mismatch brakes"
WORDS = ("address", "data", "write", "place", "told", "active", "left", "permit")
REGISTERS = WORDS[3:]
WIDTHS = dict(zip(WORDS, (2, 8, 1, 2, 1, 1, 8, 1), strict=True))

A, B = (Fault(byzantine(), [f"dual.{n}.*"], ANY_TIME, name=f"processor {n.upper()} broken") for n in "ab")
ONE_BROKEN = at_most(1, [A, B])
EQUAL = Fault(stuck(1), ["dual.comparator.equal"], ANY_TIME, name="comparator says equal")


def bits(word: str, n: str) -> list[tuple[str, int | None]]:
    """The bits of a word of processor n."""
    width = WIDTHS[word]
    return [(f"dual.{n}.{word}", None if width == 1 else k) for k in range(width)]


FLIPS = [
    Fault(flip(k), [point], TRANSIENT, ticks=1, name=f"{point}{'' if k is None else f' bit {k}'} flips")
    for n in "ab" for word in WORDS for point, k in bits(word, n)
]  # fmt: skip
NAMES = [f.name for f in FLIPS]


def differ(s: Seen) -> Bit:
    """Some word of the buses or some register is not the same in both processors."""
    return any_of(*(s[f"dual.a.{word}"] != s[f"dual.b.{word}"] for word in ("address", "data", "write", "stored")))


def just_differed(s: Seen) -> Bit:
    """There was a mismatch in the cycle before."""
    return previous(differ(s), initially=False)


def mismatch(s: Seen) -> Bit:
    """There has been a mismatch before this cycle."""
    return once(just_differed(s))


def fed(s: Seen) -> Bit:
    """The comparator's output has changed: the relay is fed."""
    return s.dual.comparator.level ^ s.dual.output.before


def a_stopped_comparator_stands_still(s: Seen) -> Bit:
    """Lemma: once it has stopped, the comparator feeds the relay no more."""
    return implies(s.dual.comparator.stopped, ~fed(s))


def not_stopped_is_equal(s: Seen) -> Bit:
    """Lemma: as long as nothing is stopped, both store the same, and the command is the one last written."""
    a, b = s.dual.a, s.dual.b
    same = all_of(*(a[name] == b[name] for name in REGISTERS), s.dual.output.command == b.permit)
    return s.dual.comparator.stopped | same


def healthy_follows_the_truth(a: Fault = A, b: Fault = B) -> Formula:
    """Lemma: a processor that is not broken stores what the truth has, unless it has been stopped."""

    def lemma(s: Seen) -> Bit:
        follows = (
            struck(s, fault.name) | all_of(*(s.dual[n][name] == s.truth[name] for name in REGISTERS))
            for n, fault in (("a", a), ("b", b))
        )
        return s.dual.comparator.stopped | all_of(*follows)

    return named("a healthy processor follows the truth", lemma)


def a_mismatch_stops(s: Seen) -> Bit:
    """Lemma: a mismatch has stopped the comparator."""
    return implies(just_differed(s) | mismatch(s), s.dual.comparator.stopped)


def a_flip_stops(s: Seen) -> Bit:
    """Lemma: a bit that was inverted has stopped the comparator."""
    return implies(struck(s, *NAMES), s.dual.comparator.stopped)


LOCKED = (a_stopped_comparator_stands_still, not_stopped_is_equal)
SAFE = (*LOCKED, healthy_follows_the_truth())


def the_command_is_the_healthy_one(s: Seen) -> Bit:
    """Lemma: where only the buses are compared, the command is at least what the truth has written."""
    return s.dual.comparator.stopped | (s.dual.output.command == s.truth.permit)


BUS_SAFE = (a_stopped_comparator_stands_still, healthy_follows_the_truth(), the_command_is_the_healthy_one)


# --- AV-7 -------------------------------------------------------------------------------------------------------------


@claim(OnBoard, faults=ONE_BROKEN, lemmas=LOCKED, expect=PROVED, requirement=AV7, source=PRINTED)
def runs_only_if_both_permit(s: Seen) -> Bit:
    """One processor broken in any way: the relay is energised only where A and B both have written a permit."""
    return implies(~s.brake, s.dual.a.permit & s.dual.b.permit)


@claim(OnBoard, faults=at_most(2, [B, EQUAL]), expect=REFUTED, requirement=AV7, twin_of=runs_only_if_both_permit)
def runs_only_if_both_permit_with_a_blind_comparator(s: Seen) -> Bit:
    """The same with a comparator that says equal: B, which drives the output, is believed alone."""
    return runs_only_if_both_permit(s)


@claim(OnBoard, faults=ONE_BROKEN, lemmas=[*LOCKED, a_mismatch_stops], expect=PROVED, requirement=AV7, source=PRINTED)
def a_mismatch_brakes_for_ever(s: Seen) -> Bit:
    """One processor broken: from the cycle after the first mismatch on, the relay is de-energised for ever."""
    return implies(mismatch(s), s.brake)


@claim(OnBoard, faults=ONE_BROKEN, expect=REFUTED, requirement=AV7, twin_of=a_mismatch_brakes_for_ever)
def a_mismatch_brakes_at_once(s: Seen) -> Bit:
    """The relay is de-energised in the very cycle of the mismatch."""
    return implies(differ(s), s.brake)


@claim(OnBoard, faults=ONE_BROKEN, lemmas=SAFE, expect=PROVED, requirement=AV7, source=PRINTED)
def one_broken_processor_is_safe(s: Seen) -> Bit:
    """One processor broken in any way: the relay is energised only where the truth permits."""
    return implies(~s.brake, s.safe)


@claim(OnBoard, faults=at_most(2, [A, B]), expect=REFUTED, requirement=AV7, twin_of=one_broken_processor_is_safe)
def two_broken_processors_are_safe(s: Seen) -> Bit:
    """Both processors broken, in any way: the same."""
    return one_broken_processor_is_safe(s)


@claim(OnBoard, faults=at_most(1, FLIPS), lemmas=[*LOCKED, a_flip_stops], arithmetic=BITS, expect=PROVED,
       requirement=AV7, source=PRINTED)  # fmt: skip
def any_flipped_bit_brakes(s: Seen) -> Bit:
    """Any of the 48 bits of buses and registers inverted for one cycle, at any time: the relay is de-energised from the
    next cycle on for ever."""
    return implies(struck(s, *NAMES), s.brake)


@claim(BusCompared, faults=at_most(1, FLIPS), expect=REFUTED, requirement=AV7, twin_of=any_flipped_bit_brakes)
def any_flipped_bit_brakes_by_the_buses_alone(s: Seen) -> Bit:
    """The same where only the buses are compared: a wrong register shows when it is used."""
    return any_flipped_bit_brakes(s)


@claim(BusCompared, faults=ONE_BROKEN, lemmas=BUS_SAFE, expect=PROVED, requirement=AV7,
       source="[D] the command passes over the bus")  # fmt: skip
def buses_alone_are_safe(s: Seen) -> Bit:
    """One processor broken, only the buses compared: the relay is energised only where the truth permits."""
    return implies(~s.brake, s.safe)


@claim(BusCompared, faults=at_most(2, [B, EQUAL]), expect=REFUTED, requirement=AV7, twin_of=buses_alone_are_safe)
def blind_buses_are_safe(s: Seen) -> Bit:
    """The same with a comparator that says equal: B is believed alone."""
    return buses_alone_are_safe(s)


# --- what the comparison does not see ---------------------------------------------------------------------------------

RUN, STRIKE = 24, 8  # steps
NEAR = {"reading.balise": True, "reading.stop": True, "reading.distance": 9, "reading.speed": 4}


CHOSEN = {  # what a fault shows in these runs, where it may show anything
    A.name: {"dual.a.data": 1, "dual.a.write": True},
    B.name: {"dual.b.data": 1, "dual.b.write": True},
    "wrong entry in the ROM": {"line.rom.entry": 200},
}


def near(*present: str) -> Scenario:
    """Too fast, close to a signal at stop, and some faults strike."""
    values = {point: value for name in present for point, value in CHOSEN.get(name, {}).items()}
    return Scenario(RUN, NEAR, present=present, values=values, at=STRIKE)


def same_in_both(word: str, k: int | None) -> Fault:
    """One bit wrong in both processors at once, by a common cause or by an error in the program."""
    points = [f"dual.{n}.{word}" for n in "ab"]
    return Fault(stuck(1, bit=k), points, ANY_TIME, name=f"{word} wrong in both")


SAME_FAULT = same_in_both("left", 6)


@claim(OnBoard, faults=at_most(1, [SAME_FAULT]), expect=REFUTED, requirement=AV7, twin_of=one_broken_processor_is_safe,
       scenario=near(SAME_FAULT.name))  # fmt: skip
def one_fault_in_both_is_safe(s: Seen) -> Bit:
    """The same bit of the distance stuck in both processors.  False: both believe the signal farther away."""
    return one_broken_processor_is_safe(s)


@claim(OnBoard, faults=at_most(1, [SAME_FAULT]), lemmas=[not_stopped_is_equal], expect=PROVED, requirement=AV7,
       source="[D] what is equal is not seen")  # fmt: skip
def one_fault_in_both_never_stops(s: Seen) -> Bit:
    """The same bit stuck in both processors: the comparator never stops them."""
    return ~s.dual.comparator.stopped


FAULT_IN_ONE = Fault(stuck(1, bit=6), ["dual.a.left"], ANY_TIME, name="left wrong in A")


@claim(OnBoard, faults=at_most(1, [FAULT_IN_ONE]), expect=REFUTED, requirement=AV7,
       twin_of=one_fault_in_both_never_stops)  # fmt: skip
def one_fault_in_one_never_stops(s: Seen) -> Bit:
    """The bit stuck in A alone: the same."""
    return one_fault_in_both_never_stops(s)


WRONG_ENTRY = Fault(byzantine(), ["line.rom.entry"], ANY_TIME, name="wrong entry in the ROM")
WRONG_CARD = Fault(byzantine(), ["line.card.entry"], ANY_TIME, name="wrong entry on the card")


@claim(OnBoard, faults=at_most(1, [WRONG_ENTRY]), expect=REFUTED, requirement=AV8,
       source="[D] both read the same", scenario=near(WRONG_ENTRY.name))  # fmt: skip
def a_wrong_entry_is_safe(s: Seen) -> Bit:
    """A wrong entry in the only source of line data.  False: both processors read the same, and compare equal."""
    return implies(~s.brake, s.safe)


def restricts_no_less_than_the_truth(s: Seen) -> Bit:
    """Lemma: both processors are where the truth is in the program, and believe the signal no farther away."""
    a, truth = s.dual.a, s.truth
    where = all_of(*(a[name] == truth[name] for name in ("place", "told", "active")))
    return s.dual.comparator.stopped | (where & (a.left <= truth.left) & implies(a.permit, truth.permit))


@claim(TwoSourceOnBoard, faults=at_most(1, [WRONG_ENTRY, WRONG_CARD]), expect=PROVED, requirement=AV8,
       lemmas=[*LOCKED, restricts_no_less_than_the_truth], source="[D] both sources have to be equal")  # fmt: skip
def a_wrong_entry_of_one_source_is_safe(s: Seen) -> Bit:
    """A wrong entry in one of two sources of line data: energised only where the truth permits."""
    return implies(~s.brake, s.safe)


@claim(TwoSourceOnBoard, faults=at_most(2, [WRONG_ENTRY, WRONG_CARD]), expect=REFUTED, requirement=AV8,
       twin_of=a_wrong_entry_of_one_source_is_safe)  # fmt: skip
def the_same_wrong_entry_in_both_sources_is_safe(s: Seen) -> Bit:
    """Wrong entries in both sources, as one wrong drawing behind both gives them: the same."""
    return a_wrong_entry_of_one_source_is_safe(s)


STORE_BITS = [
    *(Fault(flip(k), ["line.rom.word"], ANY_TIME, name=f"data bit {k}") for k in range(DATA_BITS)),
    *(Fault(flip(), [f"line.rom.check{k}"], ANY_TIME, name=f"check bit {k}") for k in range(CHECK_BITS)),
]


@claim(OnBoard, faults=at_most(2, STORE_BITS), arithmetic=BITS, expect=PROVED, requirement=AV8,
       source="[A] x^4 + x + 1 over 12 bits")  # fmt: skip
def two_wrong_bits_are_rejected(s: Seen) -> Bit:
    """One or two wrong bits of an entry and its check bits: what is used is what was written."""
    return implies(s["line.usable"], s["line.rom.word"] == s["line.rom.entry"])


@claim(OnBoard, faults=at_most(3, STORE_BITS), expect=REFUTED, requirement=AV8, twin_of=two_wrong_bits_are_rejected)
def three_wrong_bits_are_rejected(s: Seen) -> Bit:
    """Three wrong bits: the same."""
    return two_wrong_bits_are_rejected(s)


# --- alternating and steady signal ------------------------------------------------------------------------------------

SIGNAL_HIGH, SIGNAL_LOW = (
    Fault(stuck(v), ["dual.comparator.signal"], ANY_TIME, name=f"comparator output at {v}") for v in (1, 0)
)
UNEQUAL = Fault(stuck(0), ["dual.comparator.equal"], ANY_TIME, name="comparator says unequal")
NO_CLOCK = Fault(stuck(0), ["dual.clock"], ANY_TIME, name="no clock")
STANDING = [SIGNAL_HIGH, SIGNAL_LOW, UNEQUAL, NO_CLOCK]


def wrong(s: Seen) -> Bit:
    """The relay is energised and the truth forbids it."""
    return ~s.brake & ~s.safe


def was_wrong(s: Seen) -> Bit:
    """In the cycle before."""
    return previous(wrong(s), initially=False)


def was_twice_wrong(s: Seen) -> Bit:
    """In the two cycles before."""
    return previous(wrong(s) & was_wrong(s), initially=False)


def stands(s: Seen) -> Bit:
    """Stopped, or without a clock."""
    return s.dual.comparator.stopped | struck(s, NO_CLOCK.name)


def output_stands(s: Seen) -> Bit:
    """Lemma: an output that is stuck, stopped or not clocked does not change any more."""
    high, low, before = struck(s, SIGNAL_HIGH.name), struck(s, SIGNAL_LOW.name), s.dual.output.before
    return select(low, ~before, select(high, before, ~stands(s) | ~fed(s)))


def not_standing_is_the_truth(s: Seen) -> Bit:
    """Lemma: while neither stopped nor without a clock, processors and command are as the truth has them."""
    stored = (s.dual[n][name] == s.truth[name] for n in "ab" for name in REGISTERS)
    return stands(s) | all_of(*stored, s.dual.output.command == s.truth.permit)


def a_last_change_is_an_onset(s: Seen) -> Bit:
    """Lemma: wrong for a cycle, then the output is stuck; for two, then it is stuck at one level after the other."""
    levels = [struck(s, fault.name) for fault in (SIGNAL_HIGH, SIGNAL_LOW)]
    return implies(was_wrong(s), any_of(*levels)) & implies(was_twice_wrong(s), all_of(*levels))


@claim(OnBoard, faults=at_most(5, [*STANDING, B]), expect=PROVED, requirement=AV7, source="[A] alternating signal",
       lemmas=[output_stands, not_standing_is_the_truth, a_last_change_is_an_onset])  # fmt: skip
def a_signal_that_stands_still_brakes(s: Seen) -> Bit:
    """The comparator's output at a level, its verdict unequal, no clock, and B broken, in any combination: never
    energised for three cycles in which the truth forbids it."""
    return ~(wrong(s) & was_twice_wrong(s))


@claim(OnBoard, faults=at_most(2, [SIGNAL_HIGH, B]), expect=REFUTED, requirement=AV7,
       twin_of=a_signal_that_stands_still_brakes)  # fmt: skip
def an_output_at_1_brakes_at_once(s: Seen) -> Bit:
    """Not for one cycle either.  False: where the output sticks at 1 after it stood at 0, this last change feeds."""
    return ~wrong(s)


@claim(StaticSignal, faults=at_most(1, [NO_CLOCK]), expect=REFUTED, requirement=AV7,
       twin_of=a_signal_that_stands_still_brakes)  # fmt: skip
def no_clock_is_safe_with_a_steady_signal(s: Seen) -> Bit:
    """With a steady signal, the clock lost.  False: the last command stays, whatever becomes of the speed."""
    return a_signal_that_stands_still_brakes(s)


@claim(StaticSignal, faults=at_most(2, [SIGNAL_HIGH, B]), expect=REFUTED, requirement=AV7,
       twin_of=a_signal_that_stands_still_brakes)  # fmt: skip
def an_output_at_1_is_safe_with_a_steady_signal(s: Seen) -> Bit:
    """With a steady signal, the comparator's output at 1 and B broken.  False: B is believed alone."""
    return a_signal_that_stands_still_brakes(s)
