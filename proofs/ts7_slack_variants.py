"""TS-7, said exactly: what the variants of signals, wheel, windings and check window do in one step.

For the same purpose as ts7_slack; what a variant shares with the reference is said there.
Steps: a frame of 125 us; 3.90625 us for the ring in bit times.
Source: wired rows, square waves [A]; windings, switch [P]; window between 1/4 and 3/4 [R].
"""

from __future__ import annotations

from models.ts7.full_scale import FullScaleBench
from models.ts7.half_window import HalfBench, HalfCheckedRing
from models.ts7.signals import WiredOr
from models.ts7.train import SCALE
from models.ts7.wheel_bench import WheelBench
from models.ts7.windings import WoundBench
from proofs.ts7_delivered import four_words_lower
from proofs.ts7_slack import LINES, SHOWN
from proofs.ts7_slack_channel import FASTEST
from proofs.ts7_slack_ring import held_beside_the_window, strobed_just_so
from safety import (
    BITS,
    PROVED,
    REFUTED,
    Bit,
    Int,
    Model,
    Scenario,
    Seen,
    all_of,
    any_of,
    bit,
    claim,
    implies,
    once,
    previous,
    select,
    word,
)

# --- wired rows -----------------------------------------------------------------------------------------------------


@claim(WiredOr, expect=PROVED, requirement="TS7-16", source="wired rows [A]; words [D]")
def wired_rows_give_what_any_row_has(s: Seen) -> Bit:
    """On wired rows a column is on just where a row with an active line has it on."""
    rows = [(s.lines[name], datum) for name, datum in zip(LINES, SHOWN, strict=True)]
    on = [[line for line, datum in rows if datum >> k & 1] for k in range(8)]
    return all_of(*(s.word.bit(k) == any_of(*lines) for k, lines in enumerate(on)))


@claim(WiredOr, expect=REFUTED, requirement="TS7-16", twin_of=wired_rows_give_what_any_row_has)
def wired_rows_give_what_the_highest_row_has(s: Seen) -> Bit:
    """On wired rows the row of 90 km/h stands alone."""
    return implies(s.lines.s90, s.word == SHOWN[-1])


# --- wheels -----------------------------------------------------------------------------------------------------------


def turns(s: Seen, wheel: Int) -> Bit:
    """A pulse comes just where the axle's phase comes to a period of the wheel, which is taken off."""
    turned, period = s.axle.phase + s.speed, SCALE * wheel
    full = turned >= period
    return (s.axle.pulse == full) & after(s.axle.phase, select(full, turned - period, turned))


def adds(s: Seen, datum: Int) -> Bit:
    """A speed pulse adds the wheel's word to J1, modulo 256."""
    j1 = s.a.ring.j1.int()
    return after(j1, select(s.axle.pulse, select(j1 + datum > 255, j1 + datum - 256, j1 + datum), j1))


def after(register: Int, value: Int) -> Bit:
    """A register holds what a value was one step before; at power-up it may hold any."""
    return implies(once(bit(True)), register == previous(value, 0))


SPINS = Scenario(40, {"speed": FASTEST})


@claim(WheelBench, symbolic=["wheel", "wheel_error"], expect=PROVED, requirement="TS7-5", source="switch [P]")
def wheel_turns_by_its_true_diameter(s: Seen) -> Bit:
    """The axle turns by the true diameter, J1 counts that of the switch."""
    return turns(s, s.wheel.int() + s.wheel_error) & adds(s, s.wheel.int())


@claim(WheelBench, symbolic=["wheel", "wheel_error"], expect=REFUTED, requirement="TS7-5",
       twin_of=wheel_turns_by_its_true_diameter)  # fmt: skip
def wheel_turns_by_the_switch(s: Seen) -> Bit:
    """The axle turns by the diameter of the switch."""
    return turns(s, s.wheel.int())


@claim(WheelBench, expect=PROVED, requirement="TS7-5", source="switch on 820 mm as delivered [A]", witness=SPINS)
def wheel_as_delivered(s: Seen) -> Bit:
    """As delivered the wheel has 820 mm, the switch is right."""
    return (s.axle.pulse == (s.axle.phase + s.speed >= 164 * SCALE)) & adds(s, word(164, 8).int())


@claim(WheelBench, expect=REFUTED, requirement="TS7-5", twin_of=wheel_as_delivered, scenario=SPINS)
def wheel_of_815_mm_as_delivered(s: Seen) -> Bit:
    """As delivered the wheel has 815 mm."""
    return s.axle.pulse == (s.axle.phase + s.speed >= 163 * SCALE)


@claim(FullScaleBench, symbolic=["place"], expect=PROVED, requirement="TS7-5", source="nine steps [P]")
def full_scale_words_rise_by_three(s: Seen) -> Bit:
    """Each step of the switch adds 10 mm to the wheel and 3 to the word that J1 counts, from 780 mm and 231 on."""
    return turns(s, 156 + 2 * s.place.int()) & adds(s, 231 + 3 * s.place.int())


@claim(FullScaleBench, symbolic=["place"], expect=REFUTED, requirement="TS7-5", twin_of=full_scale_words_rise_by_three)
def full_scale_words_rise_by_two(s: Seen) -> Bit:
    """Each step of the switch adds 2 to the word that J1 counts."""
    return adds(s, 231 + 2 * s.place.int())


@claim(FullScaleBench, expect=PROVED, requirement="TS7-5", source="switch on 820 mm as delivered [A]", witness=SPINS)
def full_scale_wheel_as_delivered(s: Seen) -> Bit:
    """As delivered the wheel has 820 mm."""
    return s.axle.pulse == (s.axle.phase + s.speed >= 164 * SCALE)


@claim(FullScaleBench, expect=REFUTED, requirement="TS7-5", twin_of=full_scale_wheel_as_delivered, scenario=SPINS)
def full_scale_wheel_of_810_mm_as_delivered(s: Seen) -> Bit:
    """As delivered the wheel has 810 mm."""
    return s.axle.pulse == (s.axle.phase + s.speed >= 162 * SCALE)


def lowers(model: type[Model], variant: str, **wheels: int) -> None:
    """Declare that a bench lowers the limit by 4 words as delivered, and that it is not by 3."""
    witness = Scenario(3, {"word": 100, "lowered": True, **wheels})

    def lowered(s: Seen) -> Bit:
        return four_words_lower(s.a.limit, s.word, s.lowered)

    def less(s: Seen) -> Bit:
        return implies(s.lowered & (s.word.int() >= 3), s.a.limit.int() == s.word.int() - 3)

    lowered.__name__, less.__name__ = f"limit_with_{variant}_as_delivered", f"limit_with_{variant}_is_three_words_lower"
    lowered.__doc__ = "As delivered the limit is the signal's word, and 4 words less where it is lowered, 0 staying 0."
    less.__doc__ = "As delivered the limit is 3 words less where it is lowered."
    claim(model, expect=PROVED, requirement="TS7-8", source="[D] 4 words lower", witness=witness)(lowered)
    claim(model, expect=REFUTED, requirement="TS7-8", twin_of=lowered)(less)


lowers(WheelBench, "a_wheel_error")
lowers(FullScaleBench, "full_scale_words")
lowers(WoundBench, "two_windings")
lowers(HalfBench, "the_half_window", wheel=164, true_wheel=164)


# --- windings -------------------------------------------------------------------------------------------------------


def seen_by_both(s: Seen, wheel: Int) -> tuple[Int, Bit, Bit]:
    """The phase after this frame, and the levels of both windings there: by quarters of the period."""
    quarter = SCALE // 4 * wheel
    moved = select(s.backward, s.axle.phase - s.speed, s.axle.phase + s.speed)
    phase = select(moved < 0, moved + 4 * quarter, select(moved >= 4 * quarter, moved - 4 * quarter, moved))
    high_a = phase < 2 * quarter
    return phase, high_a, (phase >= quarter) & (phase < 3 * quarter)


def to_and_fro(k: int) -> bool:
    """The sense changes every 40 frames."""
    return k // 40 % 2 == 1


ROCKS = Scenario(400, {"speed": SCALE * 164 // 5, "backward": to_and_fro})


@claim(WoundBench, symbolic=["wheel", "wheel_error"], expect=PROVED, requirement="TS7-13", source="windings [P]")
def windings_tell_the_sense_just_so(s: Seen) -> Bit:
    """A pulse comes just where A rises; the sense is the level of B there, and is kept until A rises again."""
    phase, high_a, high_b = seen_by_both(s, s.wheel.int() + s.wheel_error)
    pulse, sense = high_a & ~s.axle.was_high, s.axle["backward"]
    levels = (s.axle.winding_a == high_a) & (s.axle.winding_b == high_b) & (s.axle.pulse == pulse)
    told = sense == ((pulse & high_b) | (~pulse & s.axle.reverse))
    kept = (s.axle.was_high == previous(high_a, False)) & (s.axle.reverse == previous(sense, False))
    return levels & told & after(s.axle.phase, phase) & implies(once(bit(True)), kept) & adds(s, s.wheel.int())


@claim(WoundBench, symbolic=["wheel", "wheel_error"], expect=REFUTED, requirement="TS7-13",
       twin_of=windings_tell_the_sense_just_so)  # fmt: skip
def windings_tell_the_sense_at_once(s: Seen) -> Bit:
    """The sense is the level of B, whether A rises or not."""
    return s.axle["backward"] == s.axle.winding_b


@claim(WoundBench, expect=PROVED, requirement="TS7-13", source="switch on 820 mm as delivered [A]", witness=ROCKS)
def wound_wheel_as_delivered(s: Seen) -> Bit:
    """As delivered the wheel has 820 mm, the switch is right."""
    phase, high_a, _ = seen_by_both(s, word(164, 8).int())
    return (s.axle.winding_a == high_a) & after(s.axle.phase, phase) & adds(s, word(164, 8).int())


@claim(WoundBench, expect=REFUTED, requirement="TS7-13", twin_of=wound_wheel_as_delivered, scenario=ROCKS)
def wound_wheel_stands_still(s: Seen) -> Bit:
    """As delivered winding A is high all the time."""
    return s.axle.winding_a


# --- check window between 1/4 and 3/4 -------------------------------------------------------------------------------


@claim(HalfBench, expect=PROVED, requirement="TS7-11", source="window [R]",
       witness=Scenario(600, {"wheel": 164, "true_wheel": 164}))  # fmt: skip
def half_window_counts_just_so(s: Seen) -> Bit:
    """A block of 256 frames counts its overflows; just with 64 or fewer, or 192 or more, the fault stays for ever."""
    check, counted = s.a.check, s.a.check.count + s.a.ring["overflow.o2"].word()
    last = check.frame == 255
    frame = check.frame == previous((check.frame + 1).low(8), 0)
    count = check.count == previous(select(last, 0, counted.low(8)), 0)
    found = last & any_of(counted <= 64, counted >= 192)
    return all_of(frame, count, s.fault == (check.faulty | found), check.faulty == previous(s.fault, False))


@claim(HalfBench, expect=REFUTED, requirement="TS7-11", twin_of=half_window_counts_just_so,
       scenario=Scenario(600, {"wheel": 164, "true_wheel": 164}))  # fmt: skip
def half_window_counts_for_ever(s: Seen) -> Bit:
    """The overflows are counted on from block to block."""
    return s.a.check.count == previous((s.a.check.count + s.a.ring["overflow.o2"].word()).low(8), 0)


BLOCK = 256 * 32  # bit times; a check word n gives n overflows a block
FIRST_AND_LAST_NORMAL = Scenario(3 * BLOCK + 100, {"d2": lambda k: (65, 191, 64, 64)[k // BLOCK]})
ONE_TOO_MANY = Scenario(BLOCK + 100, {"d2": 192})


@claim(HalfCheckedRing, expect=PROVED, lemmas=[held_beside_the_window], arithmetic=BITS, requirement="TS7-12",
       source="[P] overflow pulses; window [R]", witness=FIRST_AND_LAST_NORMAL)  # fmt: skip
def half_window_sees_the_pulse_of_the_whole_frame(s: Seen) -> Bit:
    """In bit times this window moves on just in the last, with the pulse held since J2's last bit."""
    return strobed_just_so(s, 192)


@claim(HalfCheckedRing, expect=REFUTED, requirement="TS7-12", twin_of=half_window_sees_the_pulse_of_the_whole_frame,
       scenario=ONE_TOO_MANY)  # fmt: skip
def half_window_finds_no_fault(s: Seen) -> Bit:
    """In bit times this window never finds a fault."""
    return ~s.fault
