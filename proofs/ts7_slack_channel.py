"""TS-7, said exactly: what comparators and dividers of a channel do in one frame, wherever they stand.

For the same purpose as ts7_slack: the claims about times and speeds need a comparator at its ends only far from a
change of speed; here each frame counts.
Steps: a frame of 125 us.
Source: dividers by 16, counters 0..3 with latch, roll-back as not reverse at power-up [A].
"""

from __future__ import annotations

from models.ts7.train import SCALE, Bench
from safety import PROVED, REFUTED, Bit, Scenario, Seen, all_of, any_of, bit, claim, implies, once, previous, select

FASTEST = SCALE * 164 - 1  # speed, a pulse in nearly every frame
THERE_AND_BACK = Scenario(
    2600, {"wheel": 164, "true_wheel": 164, "word": 40, "speed": lambda k: FASTEST if k < 20 or k >= 2000 else 0}
)


@claim(Bench, expect=PROVED, requirement="TS7-3", source="60 pulses a revolution [A]", witness=THERE_AND_BACK)
def axle_turns_just_so(s: Seen) -> Bit:
    """A pulse comes just where the axle has turned by 65536 for each 5 mm of the wheel, which then is taken off."""
    turned, period = s.axle.phase + s.speed, SCALE * s.true_wheel.int()
    after = select(turned >= period, turned - period, turned)
    return (s.axle.pulse == (turned >= period)) & implies(once(bit(True)), s.axle.phase == previous(after, 0))


@claim(Bench, expect=REFUTED, requirement="TS7-3", twin_of=axle_turns_just_so)
def axle_begins_anew_with_a_pulse(s: Seen) -> Bit:
    """With a pulse the axle's phase begins anew at 0.  What is over stays."""
    return implies(previous(s.axle.pulse, False), s.axle.phase == 0)


def counts(s: Seen, name: str, ahead: int, up: Bit, down: Bit) -> Bit:
    """A comparator has counted the pulses of the frame before, not both, between 0 and 3; its latch has followed.

    At power-up it is so many pulses ahead, latched where that is 3.
    """
    u, latch = s.a[name].u, s.a[name].latch
    after = (u.int() + up.word() - down.word()).clip(0, 3)
    latched = any_of(after == 3, latch & (after >= 1))
    return (u.int() == previous(after, ahead)) & (latch == previous(latched, ahead == 3))


@claim(Bench, expect=PROVED, requirement="TS7-3", source="counters 0..3 with latch [A]", witness=THERE_AND_BACK)
def comparators_count_just_so(s: Seen) -> Bit:
    """Each comparator counts its pulses between 0 and 3, neither when both come; its latch sets at 3, clears at 0."""
    brake = counts(s, "comparator", 3, s.a.f_v, s.a.f_p)
    return brake & counts(s, "rollback", 0, s.a.f_v, s.a.f_rev)


@claim(Bench, expect=REFUTED, requirement="TS7-3", twin_of=comparators_count_just_so, scenario=THERE_AND_BACK)
def roll_back_powers_up_like_the_brake(s: Seen) -> Bit:
    """The comparator of roll-back counts so too, but powers up three pulses ahead."""
    return counts(s, "rollback", 3, s.a.f_v, s.a.f_rev)


def counted(s: Seen, n: int) -> Bit:
    """A divider has counted the overflows of its word modulo 16, whatever it began with."""
    stage, pulse = s.a[f"div{n}"].n, s.a.ring[f"overflow.o{n}"]
    after = select(pulse, select(stage == 15, 0, stage.int() + 1), stage.int())
    return implies(once(bit(True)), stage.int() == previous(after, 0))


@claim(Bench, expect=PROVED, requirement="TS7-3", source="divider by 16 [A]", witness=THERE_AND_BACK)
def dividers_count_just_so(s: Seen) -> Bit:
    """Each divider counts up modulo 16, and its pulse comes just with the overflow that takes it from 15 to 0."""
    pulses = {n: (s.a[f"div{n}"].n == 15) & s.a.ring[f"overflow.o{n}"] for n in (0, 3)}
    return all_of(counted(s, 0), counted(s, 3), s.a.f_p == pulses[0], s.a.f_rev == pulses[3])


@claim(Bench, expect=REFUTED, requirement="TS7-3", twin_of=dividers_count_just_so)
def dividers_count_every_frame(s: Seen) -> Bit:
    """The divider of the reference comes to 0 only with a pulse.  It may power up there."""
    return implies(s.a.div0.n == 0, once(s.a.f_p))
