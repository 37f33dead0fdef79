"""TS-7 ring arithmetic at two levels: `Words`, one frame a step, and `Ring`, one bit time a step.

A ring of four words of 8 bits circulates through one serial adder.  Each frame adds a datum to each word modulo 256;
the carry out of a word is its overflow pulse, so a word D added r times a second overflows r*D/256 times a second.

| word | datum                                 | added          | overflow means                             |
|------|---------------------------------------|----------------|--------------------------------------------|
| J0   | speed limit of the signal             | every frame    | reference, 16 times the pattern rate f_p   |
| J1   | wheel diameter / 5 mm                 | at a pulse f_s | speed f_v, corrected for the wheel         |
| J2   | check word                            | every frame    | check rate, 85/256 of 8 kHz                |
| J3   | speed limit of roll-back              | every frame    | roll-back reference, 16 times its rate     |

Steps: `Words` 125 us (one frame), `Ring` 3.90625 us (one bit time; 32 make a frame).
Source: ring of 4 x 8 bits, 8 kHz, serial adder, data matrix [P]; two oscillator periods of 512 kHz a bit time [R].
"""

from __future__ import annotations

from typing import NamedTuple

from safety import ANY, U5, U8, U32, Bit, Model, UInt, any_of, bit, point, power_up, select


class Overflow(NamedTuple):
    """Overflow pulses of one frame."""

    o0: Bit
    o1: Bit
    o2: Bit
    o3: Bit


def row(name: str, datum: UInt, selected: Bit) -> UInt:
    """What a row of the data matrix puts on the columns: its word when its select line is on, else 0."""
    return select(point(f"select.{name}", selected), point(f"matrix.{name}", datum), 0)


class Words(Model, tick_s="125e-6"):
    """The ring, a whole frame a step: four words of 8 bits, each with its own addition."""

    j0: U8 = power_up(ANY)  # phase of the reference
    j1: U8 = power_up(ANY)  # phase of the wheel correction
    j2: U8 = power_up(ANY)  # phase of the check word
    j3: U8 = power_up(ANY)  # phase of the roll-back reference

    def step(self, d0: U8, d1: U8, d2: U8, d3: U8, pulse: Bit) -> tuple[Words, Overflow]:
        """Add the data; J1 only in a frame with a speed pulse."""
        t0 = self.j0 + row("j0", d0, bit(True))
        t1 = self.j1 + select(pulse, row("j1", d1, bit(True)), 0)
        t2 = self.j2 + row("j2", d2, bit(True))
        t3 = self.j3 + row("j3", d3, bit(True))
        overflow = Overflow(*(point(f"overflow.o{w}", t.bit(8)) for w, t in enumerate((t0, t1, t2, t3))))
        return type(self)(j0=t0.low(8), j1=t1.low(8), j2=t2.low(8), j3=t3.low(8)), overflow


class HeldPulses(Model):
    """Four latches that keep the overflow pulses of a frame until it ends."""

    held0: Bit = power_up(False)
    held1: Bit = power_up(False)
    held2: Bit = power_up(False)
    held3: Bit = power_up(False)

    def hold(self, pulses: list[Bit], begins: Bit) -> dict[str, Bit]:
        """The latches after a bit time: `begins` a frame, they start empty."""
        before = (self.held0, self.held1, self.held2, self.held3)
        return {f"held{w}": (h & ~begins) | p for w, (h, p) in enumerate(zip(before, pulses, strict=True))}


class Ring(HeldPulses, tick_s="3.90625e-6"):
    """The ring as built: a shift register of 32 stages, one serial adder, one carry flip-flop.

    The overflow pulses stay until the frame ends, so that the outputs of step 31 are those of the whole frame.
    """

    ring: U32 = power_up(ANY)  # stage 0 goes into the adder; J0 stands lowest, each word lowest bit first
    carry: Bit = power_up(ANY)  # cleared before it is used
    place: U5 = power_up(0)  # bit time in the frame: word 0..3 above bit 0..7 [A] a frame starts at power-up

    def step(self, d0: U8, d1: U8, d2: U8, d3: U8, pulse: Bit) -> tuple[Ring, Overflow]:
        """Add one bit; data and `pulse` stay as they are for the 32 steps of a frame."""
        p, j = self.place.low(3), [self.place.slice(3, 2) == w for w in range(4)]
        enabled = ~j[1] | pulse
        ring = point("ring", self.ring)
        rows = [row(f"j{w}", d, j[w]) for w, d in enumerate((d0, d1, d2, d3))]
        column = point("column", rows[0] | rows[1] | rows[2] | rows[3])
        datum = any_of(*((p == k) & column.bit(k) for k in range(8)))
        a, d = ring.bit(0), point("data", datum & enabled)
        c = point("carry.in", self.carry & ~point("carry.clear", self.clears(p)))
        total = point("sum", a ^ d ^ c)
        carry = point("carry.out", (a & d) | (c & (a ^ d)))
        pulse_out = carry & enabled & point("overflow.strobe", p == 7)
        held = self.hold([word & pulse_out for word in j], begins=self.place == 0)
        shifted = total.word().concat(ring.slice(1, 31))
        following = type(self)(ring=shifted, carry=carry, place=(self.place + 1).low(5), **held)
        return following, Overflow(*(point(f"overflow.o{w}", h) for w, h in enumerate(held.values())))

    def clears(self, p: UInt) -> Bit:
        """Each word is added for itself: its lowest bit takes no carry from the word before."""
        return p == 0


BITS_A_FRAME = 32


def ring_words(ring: UInt) -> tuple[UInt, UInt, UInt, UInt]:
    """The words J0..J3 that the ring register holds at the start of a frame: what `Words` calls j0..j3."""
    return ring.slice(0, 8), ring.slice(8, 8), ring.slice(16, 8), ring.slice(24, 8)


def frame_starts(place: UInt) -> Bit:
    """Whether the bit to come is the first of a frame: only there do the ring's stages read as words."""
    return place == 0
