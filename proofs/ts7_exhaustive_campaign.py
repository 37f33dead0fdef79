"""TS-7, the whole equipment at every point: each bit flipped at each moment, and all stuck bits two at a time.

One second of 8000 frames at signal 65 with a wheel of 820 mm, the brake being released: 2000 frames at 63 km/h, within
the limit, then 6000 at 68.8 km/h, 8 words above it.

* **Upsets**: each of 294 bits of the 137 points inverted for one frame, at each of the 8000 frames.
* **Pairs**: each of these bits stuck at 0 or 1 from the first frame on, all 172 578 pairs.

Dangerous: the train has been too fast for the time by which the proof has the brake applied (`Chain.braked`, relays
with their 30 ms and 20 ms), and for the release time of a relay, 20 ms, there is neither normal nor emergency brake: an
interruption that no relay follows does no harm.  Safe side: a brake within the limit, for as long.  Detected: a target
drops, a relay CHR falls, or a channel finds its own fault, for as long, no later than the hazard.  The channels start
in equal phases without error.

Results: no upset is dangerous, wherever and whenever it comes; 47 046 are shown by a target, the others leave no sign.
Five single stuck bits defeat the brake: no speed pulse, two bits of the wheel word, the coil and the contact of relay
NB.  Of the pairs 5053 do: 2866 with one of these five, and 3 * 27 * 27 that silence two channels, each in one of 27
ways.  2687 are found in time; so these are 53 % coverage of pairs, and none of singles.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from models.ts7.system import Ts7
from proofs.ts7_brake_chain import CHANNELS, RELEASE, WORDS
from proofs.ts7_formulas import at_most_kmh
from proofs.ts7_system_campaign import STRIKE, TOO_FAST
from safety import Bit, any_of
from safety.inject import Campaign, Wires, flipped_bits, stuck_bits

WITHIN, SECOND = 2000, 8000  # frames within the limit, frames in all


def ride(frame: int) -> dict[str, int | bool]:
    """Slow until the brake is released, within the limit, too fast."""
    kmh = at_most_kmh(15 if frame < STRIKE else 63)
    return {"speed": kmh if frame < STRIKE + WITHIN else TOO_FAST.speed, "backward": False}


def unbraked(wires: Wires) -> Bit:
    """No brake for as long as a relay takes to follow, though the time to brake is over."""
    return wires.lasting(too_fast(wires), TOO_FAST.allowed) & wires.lasting(~braked(wires), RELEASE)


def stopped(wires: Wires) -> Bit:
    """A brake within the limit, for as long as a relay takes to follow."""
    return wires.lasting(braked(wires) & ~too_fast(wires), RELEASE)


def too_fast(wires: Wires) -> Bit:
    """The train is 8 words above the limit."""
    return wires["speed"] >= TOO_FAST.speed


def braked(wires: Wires) -> Bit:
    """The normal or the emergency brake is applied."""
    return wires["nb"] | wires["eb"]


def shown(sign: str) -> Callable[[Wires], Bit]:
    """A sign of some channel (?), for as long as a relay takes to follow."""
    return lambda wires: any_of(*(wires.lasting(wires[sign.replace("?", n)], RELEASE) for n in CHANNELS))


upsets = Campaign(
    id="ts7_upsets",
    model=Ts7,
    constant={**{f"lines.{line}": line == "s65" for line in WORDS}, "inverter": True, "mg": True},
    stimulus=ride, run_in=STRIKE, measured=SECOND,
    faults=flipped_bits("*"), onsets=range(STRIKE, STRIKE + SECOND), length=1,
    hazard=unbraked,
    detectors={"target": shown("targets.?"), "isolation": shown("isolated.?"), "channel": shown("?.fault")},
    safe=stopped,
    expect={"safe": 0, "detected": 47_046, "dangerous_undetected": 0, "no_effect": 2_304_954},
)  # fmt: skip

stuck_pairs = replace(
    upsets,
    id="ts7_stuck_pairs",
    faults=stuck_bits("*"), order=2, onsets=range(STRIKE, STRIKE + 1), length=None,
    expect={"safe": 9329, "detected": 58_296, "dangerous_undetected": 2366, "no_effect": 102_587, "wrong/yes": 2687},
)  # fmt: skip
