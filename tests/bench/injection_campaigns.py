"""The campaigns of the benchmark on the second of `injection_task`: dangerous when no brake is there at its end."""

from __future__ import annotations

import random
from collections.abc import Callable
from functools import partial
from typing import Any

from models.ts7.system import Ts7
from models.ts7.train import PER_WORD
from proofs.ts7_system_campaign import OBSERVED, STRIKE, overspeed
from safety.faults import ANY_TIME
from safety.inject import Campaign, flipped_bits, stuck_bits
from tests.bench.injection_task import FRAMES, HAZARD, ride

JUDGED = 400  # frames at the end
LARGE = 43  # scenarios of a campaign of 1e8: 294 bits, 8000 frames each


def faster(pick: random.Random) -> Callable[[int], int]:
    """The speed of the ride, up to 16 words more in its last part."""
    more = PER_WORD * pick.randint(0, 16)
    return lambda frame: ride(frame)["speed"] + (more if frame >= HAZARD else 0)


_second: dict[str, Any] = {
    "model": Ts7, "constant": overspeed.constant, "stimulus": ride, "run_in": FRAMES - JUDGED, "measured": JUDGED,
    "hazard": OBSERVED["free"], "detectors": {"shown": OBSERVED["shown"]},
}  # fmt: skip
_upsets: dict[str, Any] = {**_second, "faults": flipped_bits("*"), "onsets": range(FRAMES), "length": 1}
_permanent: dict[str, Any] = {**_second, "faults": stuck_bits("*", onset=ANY_TIME, at=STRIKE)}

CAMPAIGNS: dict[str, Callable[[], Campaign]] = {
    "a thousand upsets, drawn": partial(Campaign, id="bench_first", **_upsets, sample=1000),
    "every bit inverted at every frame": partial(Campaign, id="bench_upsets", **_upsets),
    "every bit stuck": partial(Campaign, id="bench_single", **_permanent),
    "all pairs of stuck bits": partial(Campaign, id="bench_pairs", **_permanent, order=2),
    "all triples of stuck bits": partial(Campaign, id="bench_triples", **_permanent, order=3),
    "every bit inverted at every frame, many rides": partial(
        Campaign, id="bench_large", **_upsets, vary={"speed": faster}, scenarios=LARGE
    ),
}


def campaign(name: str) -> Campaign:
    """One of them, anew."""
    return CAMPAIGNS[name]()
