"""TS-7, one speed-check channel: it releases while signals change from frame to frame.

One step is one frame, 125 us.  With the signal unchanged 0.3 s is enough (ts7_channel); here the reference may jump at
will, and a run is shown in which the brake stays on for longer.  Braking stays within 0.3 s whatever the signals do.
Source: response 0.3 s [P].
"""

from models.ts7.numbers import WORD
from models.ts7.train import SCALE, Bench
from proofs.ts7_formulas import at_most_kmh, two_below, wheel_kept, wheel_set_right
from safety import PROVED, REFUTED, Bit, Scenario, Seen, claim, implies, persists

RESPONSE = 2400  # frames in the printed 0.3 s
STEADY = Scenario(2602, {"wheel": 164, "true_wheel": 164, "word": WORD[65], "speed": at_most_kmh(63)})


@claim(
    Bench, given=wheel_set_right, witness=STEADY, steps=4, requirement="TS7-3", source="[D]", expect=PROVED,
)  # fmt: skip
def releases_though_signals_change(s: Seen) -> Bit:
    """2.0 km/h below any of the five signals for 2600 frames (0.325 s), not lowered, it does not brake.

    The signal may change in every frame; the wheel setting stays as it is.
    """
    return implies(persists(two_below(s) & wheel_kept(s), 2600), ~s.brake)


CHANGING = """
    25:73
    90:1 45:80 25:2 45:1 25:2 45:1 90:1 45:82 25:1 75:1 90:1 45:82 25:1 75:1 90:1 45:81 75:1 65:1 90:7 45:1254
    90:24 45:1 90:25 45:1 90:33 45:1 90:25 45:9 90:37 45:1 90:23 45:3 90:27 45:7 90:33 45:1 90:25 45:5 90:27
    75:1 90:31 75:1 90:10 45:75 25:10 90:3 45:84 90:9 45:66 90:5 45:50 25:13 45:11 25:11 90:8 45:67
"""  # signal : frames


def signals_change():
    """Standing for 73 frames, then always 2.0 km/h below the signal; these follow one another in a few frames."""
    frames = [int(v) for v, n in (run.split(":") for run in CHANGING.split()) for _ in range(int(n))]
    inputs = {
        "wheel": 164, "true_wheel": 164, "word": lambda k: WORD[frames[k]],
        "speed": lambda k: at_most_kmh(frames[k] - 2) if k >= 73 else 0,
    }  # fmt: skip
    start = {"axle.phase": 164 * SCALE - 1, "a.ring.j1": 180, "a.ring.j0": 42, "a.div0.n": 0}
    return Scenario(len(frames), inputs, start)


@claim(
    Bench, given=wheel_set_right, requirement="TS7-3", source="[P] 0.3 s", expect=REFUTED,
    twin_of=releases_though_signals_change, scenario=signals_change(),
)  # fmt: skip
def releases_within_the_printed_response_while_signals_change(s: Seen) -> Bit:
    """2.0 km/h below any of the five signals for 0.3 s, not lowered, it does not brake, though the signals change."""
    return implies(persists(two_below(s) & wheel_kept(s), RESPONSE), ~s.brake)
