"""TS-7 with full-scale wheel words (231 .. 255): how exactly the speed pulses count the way.

One step is one frame, 125 us.  Nine steps of the switch, wheel as set, any speed in every frame, all phases; way in
2**-24 of the way between two f_v pulses of the reference words.

Main result: the words round by 0.1207 % at most (at 780 mm), for any distance, whereas the reference words do not round
at all (ts7_ring).  At 90 km/h that is 0.11 km/h.
Source: nine steps [P]; words [A].
"""

from __future__ import annotations

from models.ts7.full_scale import LARGEST_WORD, SMALLEST, STEPS, FullScaleBench
from models.ts7.train import SCALE
from proofs.ts7_formulas import PULSE
from proofs.ts7_ring import LONG, way
from safety import PROVED, REFUTED, Bit, Int, Scenario, Seen, all_of, claim, implies, total

WHOLE = 172  # largest wheel, 5 mm, whose word is 255: a pulse of full-scale words comes every 172/255 of the way


def pulses(s: Seen) -> Int:
    """Pulses of f_v since the start."""
    return total(s.a.f_v.word(), LONG).int()


def counts_its_own_word(s: Seen) -> Bit:
    """At each step of the switch the pulses are its word over its diameter times the way, to the last fraction."""
    return all_of(*(implies(s.place == k, _exact(s, SMALLEST + 2 * k, LARGEST_WORD - 3 * (STEPS - k)))
                    for k in range(STEPS + 1)))  # fmt: skip


def _exact(s: Seen, wheel: int, word: int) -> Bit:
    rest = wheel * (PULSE * pulses(s) + SCALE * s.a.ring.j1.int()) + word * s.axle.phase - word * way(s)
    bound = (wheel * SCALE * 255) + word * wheel * SCALE
    return implies(way(s) < PULSE * LONG // 2, (rest >= 0) & (rest < bound))


def within(s: Seen, millionths: int) -> Bit:
    """Pulses and way differ by so many millionths of the way, and by two pulses at most."""
    off = WHOLE * PULSE * pulses(s) - 255 * way(s)
    most = millionths * 255 * way(s) + 1_000_000 * WHOLE * 2 * PULSE
    return implies(way(s) < PULSE * LONG // 2, (1_000_000 * off <= most) & (-1_000_000 * off <= most))


@claim(FullScaleBench, symbolic=["place"], lemmas=[counts_its_own_word], expect=PROVED, requirement="TS7-5",
       source="[D] 0.1207 %", witness=Scenario(10, {"speed": SCALE}))  # fmt: skip
def way_is_counted_within_0_1207_percent(s: Seen) -> Bit:
    """Full-scale wheel words, wheel as set: the f_v pulses count any way to 0.1207 % and two pulses."""
    return within(s, 1207)


@claim(FullScaleBench, symbolic=["place"], expect=REFUTED, requirement="TS7-5",
       twin_of=way_is_counted_within_0_1207_percent,
       scenario=Scenario(24_000, {"speed": 155 * SCALE}, {"place": 0, "axle.phase": 0}))  # fmt: skip
def way_is_counted_within_0_12_percent(s: Seen) -> Bit:
    """Full-scale wheel words, wheel as set: the f_v pulses count any way to 0.12 % and two pulses."""
    return within(s, 1200)
