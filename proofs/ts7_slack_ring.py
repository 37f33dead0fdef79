"""TS-7, said exactly: what the ring does in one bit time, its words in one frame, the check window at a frame's end.

For the same purpose as ts7_slack: no other text of these parts could stand there unnoticed.
Steps: `Words` a frame of 125 us, the others a bit time of 3.90625 us.
Source: ring of 4 x 8 bits, serial adder [P]; window [R].
"""

from __future__ import annotations

from models.ts7.bench import CheckedRing
from models.ts7.ring import Ring, Words
from safety import BITS, PROVED, REFUTED, Bit, Int, Scenario, Seen, all_of, bit, claim, implies, once, previous, select

WORDS = range(4)


def held_in(ring: Seen) -> Bit:
    """A held pulse came at the last bit of its word in this frame."""
    return all_of(*(implies(ring[f"held{w}"], (ring.place >= 8 * w + 8) | (ring.place == 0)) for w in WORDS))


def held_since_its_word(s: Seen) -> Bit:
    """Lemma: that of the ring alone."""
    return held_in(s)


FULL = {"d0": 255, "d1": 255, "d2": 255, "d3": 255}


@claim(Ring, expect=PROVED, lemmas=[held_since_its_word], arithmetic=BITS, requirement="TS7-4",
       source="[P] overflow pulses", witness=Scenario(40, {**FULL, "pulse": True}, {"ring": 2**32 - 1}))  # fmt: skip
def pulses_come_just_with_the_last_carry(s: Seen) -> Bit:
    """A word's pulse comes just with the carry of its last bit, for J1 at a speed pulse only, and stays for the frame.

    This is so at every bit time, whatever the data and the speed pulse do within a frame; a latch holds just the pulse
    of the bit time before.
    """
    counts = [s["carry.out"] & (s.pulse if w == 1 else bit(True)) for w in WORDS]
    comes = [(s.place == 8 * w + 7) & counts[w] for w in WORDS]
    exact = (s[f"o{w}"] == ((s[f"held{w}"] & (s.place != 0)) | comes[w]) for w in WORDS)
    held = (s[f"held{w}"] == previous(s[f"o{w}"], False) for w in WORDS)
    return all_of(*exact, *held, *(implies(s[f"o{w}"], s.place >= 8 * w + 7) for w in WORDS))


@claim(Ring, expect=REFUTED, requirement="TS7-4", twin_of=pulses_come_just_with_the_last_carry,
       scenario=Scenario(40, {**FULL, "pulse": lambda k: k < 15}, {"ring": 2**32 - 1}))  # fmt: skip
def no_carry_without_a_pulse(s: Seen) -> Bit:
    """Every carry out of the last bit of J1 gives a pulse, whether the speed pulse is still there or not."""
    return implies((s.place == 15) & s["carry.out"], s.o1)


def sums(s: Seen) -> list[Int]:
    """What each word and its datum add up to, for J1 at a speed pulse only."""
    data = (s.d0, select(s.pulse, s.d1, 0), s.d2, s.d3)
    return [s[f"j{w}"].int() + datum.int() for w, datum in enumerate(data)]


@claim(Words, expect=PROVED, requirement="TS7-4", source="[P] ring of 4 x 8 bits, serial adder")
def each_word_counts_its_datum_modulo_256(s: Seen) -> Bit:
    """Each frame adds to each word its datum; from 256 on it overflows and keeps the rest."""
    rest = [previous(select(total >= 256, total - 256, total), 0) for total in sums(s)]
    kept = all_of(*(s[f"j{w}"].int() == rest[w] for w in WORDS))
    return implies(once(bit(True)), kept) & all_of(*(s[f"o{w}"] == (total >= 256) for w, total in enumerate(sums(s))))


@claim(Words, expect=REFUTED, requirement="TS7-4", twin_of=each_word_counts_its_datum_modulo_256)
def speed_overflows_without_a_speed_pulse(s: Seen) -> Bit:
    """J1 overflows wherever its datum would take it there, whether a speed pulse comes or not."""
    return s.o1 == (s.j1.int() + s.d1.int() >= 256)


# --- with the check window ------------------------------------------------------------------------------------------


def held_beside_the_window(s: Seen) -> Bit:
    """Lemma: that of the ring within the greater model."""
    return held_in(s.ring)


A_BLOCK = Scenario(256 * 32 + 100, {"d2": 255})


def strobed_just_so(s: Seen, most: int) -> Bit:
    """The window of a ring moves on in the last bit time only; more than 64 pulses and less than `most` are normal."""
    strobe, phase, counted = s.ring.place == 31, s.check.frame, s.check.count + s.ring.held2.word()
    begins = implies(~once(bit(True)), s.ring.place == 0)
    frame = phase == previous(select(strobe, (phase + 1).low(8), phase), 0)
    count = s.check.count == previous(select(strobe, select(phase == 255, 0, counted.low(8)), s.check.count), 0)
    found = strobe & (phase == 255) & ((counted <= 64) | (counted >= most))
    fault = (s.fault == (s.check.faulty | found)) & (s.check.faulty == previous(s.fault, False))
    pulses = all_of(*(implies(s.ring[f"overflow.o{w}"], s.ring.place >= 8 * w + 7) for w in WORDS))
    return all_of(begins, frame, count, fault, pulses)


@claim(CheckedRing, expect=PROVED, lemmas=[held_beside_the_window], arithmetic=BITS, requirement="TS7-12",
       source="[P] overflow pulses; window [R]", witness=A_BLOCK)  # fmt: skip
def window_sees_the_pulse_of_the_whole_frame(s: Seen) -> Bit:
    """The window moves on just in the last bit time, with the pulse held since J2's last bit; else it stands still.

    A frame begins at power-up, the window is empty and has found no fault.
    """
    return strobed_just_so(s, 128)


@claim(CheckedRing, expect=REFUTED, requirement="TS7-12", twin_of=window_sees_the_pulse_of_the_whole_frame,
       scenario=Scenario(100, {}))  # fmt: skip
def window_stands_still(s: Seen) -> Bit:
    """The window never moves on."""
    return s.check.frame == 0
