"""TS-7, response at 2.0 km/h above the signal with the wheel switch off by half a step: true 5 mm more than set.

One step is one frame, 125 us.  The train is then taken for slower than it is by 5 mm in 785 to 855; at 90 km/h there is
so little excess left at 92 that the printed 0.3 s is not kept.  All phases, and in every frame any speed from 2.0 km/h
above the signal on; proved by closed form.

Main results, at 90 km/h: 780 mm set, 785 true, brakes within 2523 frames (0.3154 s), and 2521 are not enough.  The
worst seen is another setting: 850 mm set, 855 true, brakes within 2636 frames (0.3295 s), and 2634 are not enough, for
there the reference and the speed pulses beat.  No setting needs 2800 (0.35 s).  At the other four signals a wheel of
785 mm set as 780 keeps the printed 0.3 s.  With the wheel set right the worst seen is signal 25 on 830 mm: within 2134
frames (0.2668 s), and 2132 are not enough.
Source: accuracy +-2.0 km/h, 0.3 s, steps of 10 mm [P]; 60 pulses, comparator and words [A].
"""

from __future__ import annotations

from models.ts7.numbers import SPEEDS, WORD
from models.ts7.wheel_bench import WheelBench
from proofs.ts7_channel import RESPONSE
from proofs.ts7_formulas import Formula, at_least_kmh, latch_at_the_ends, named
from safety import PROVED, REFUTED, Bit, Scenario, Seen, claim, implies, persists

LATCH = latch_at_the_ends()
ENOUGH = {780: 2523, 850: 2636}  # frames at 90 km/h, by the setting in mm
EVERYWHERE = 2800


def setting(set_mm: int, error_mm: int = 5) -> dict[str, int]:
    """The switch at a setting, the wheel so much greater."""
    return {"wheel": set_mm // 5, "wheel_error": error_mm // 5}


def too_fast(s: Seen, signal: int) -> Bit:
    """2.0 km/h or more above a signal, not lowered by synchronisation."""
    return ~s.lowered & (s.word == WORD[signal]) & (s.speed >= at_least_kmh(signal + 2))


def start_off(signal: int, axle: int = 0, j1: int = 0, reference: int = 0) -> Scenario:
    """Standing for 4000 frames under a signal, then 2.0 km/h above it; the phases of axle, of j1, and of j0 with its
    divider are those at the change."""
    begins, word = 4000, WORD[signal]
    start = (reference - begins * word) % 4096
    inputs = {"word": word, "speed": lambda k: at_least_kmh(signal + 2) if k >= begins else 0}
    phases = {"axle.phase": axle, "a.ring.j1": j1, "a.ring.j0": start % 256, "a.div0.n": start // 256}
    return Scenario(begins + EVERYWHERE, inputs, phases)


def brakes(signal: int, set_mm: int, frames: int, name: str, source: str, error_mm: int = 5) -> Formula:
    """Declare: 2.0 km/h above a signal brakes within so many frames."""

    def formula(s: Seen) -> Bit:
        return implies(persists(too_fast(s, signal), frames), s.brake)

    formula.__doc__ = f"""{signal + 2} km/h or more at signal {signal} for {frames} frames ({frames / 8:.1f} ms), a
    wheel of {set_mm + error_mm} mm set as {set_mm} mm: the channel brakes."""
    return claim(WheelBench, settings=setting(set_mm, error_mm), lemmas=[LATCH], steps=2, expect=PROVED, source=source,
                 requirement="TS7-3", witness=start_off(signal))(named(name, formula))  # fmt: skip


BRAKES = {mm: brakes(90, mm, n, f"brakes_at_90_set_as_{mm}", "time [D]") for mm, n in ENOUGH.items()}


@claim(WheelBench, settings=setting(780), expect=REFUTED, requirement="TS7-3", twin_of=BRAKES[780],
       scenario=start_off(90, j1=144, reference=819))  # fmt: skip
def brakes_at_90_set_as_780_two_frames_earlier(s: Seen) -> Bit:
    """92 km/h or more at signal 90 for 2521 frames, a wheel of 785 mm set as 780 mm: the channel brakes."""
    return implies(persists(too_fast(s, 90), ENOUGH[780] - 2), s.brake)


@claim(WheelBench, settings=setting(850), expect=REFUTED, requirement="TS7-3", twin_of=BRAKES[850], defeat=True,
       source="[P] 0.3 s", scenario=start_off(90, axle=114_237, j1=104, reference=353))  # fmt: skip
def brakes_at_90_set_as_850_two_frames_earlier(s: Seen) -> Bit:
    """92 km/h or more at signal 90 for 2634 frames (0.3293 s), a wheel of 855 mm set as 850 mm: the channel brakes."""
    return implies(persists(too_fast(s, 90), ENOUGH[850] - 2), s.brake)


RIGHT = brakes(25, 830, 2134, "brakes_at_25_on_830_set_right", "time [D]", error_mm=0)


@claim(WheelBench, settings=setting(830, 0), expect=REFUTED, requirement="TS7-3", twin_of=RIGHT,
       scenario=start_off(25, j1=104, reference=822))  # fmt: skip
def brakes_at_25_on_830_set_right_two_frames_earlier(s: Seen) -> Bit:
    """27 km/h or more at signal 25 for 2132 frames (0.2665 s), a wheel of 830 mm set right: the channel brakes."""
    return implies(persists(too_fast(s, 25), 2132), s.brake)


for _mm in range(790, 850, 10):
    brakes(90, _mm, EVERYWHERE, f"brakes_at_90_set_as_{_mm}", "time [D]")
for _signal in SPEEDS[:-1]:
    brakes(_signal, 780, RESPONSE, f"brakes_at_{_signal}_set_as_780", "[P] 0.3 s")
