"""Dual processors: every bit of buses and registers inverted at every instant, in one processor and in both alike.

A train approaches a signal at stop, 60 units away at the balise, at speed 7, two units a sweep; 10 sweeps of four bus
cycles after the balise are measured.  Dangerous: the relay is energised where the truth forbids it, or in the cycle
after a mismatch.  Detected: the comparator has stopped the processors.

Results: each of the 48 bits at each of 40 instants, 1920 upsets, brakes in the next cycle; none is dangerous.  The same
bit in both processors at once is never found: 960 upsets, of which 231 permit what the truth forbids.
"""

from __future__ import annotations

from models.dual_processor import SWEEP, OnBoard
from proofs.dual_processor import WORDS, bits
from safety import Bit, Fault, flip
from safety.inject import Campaign, Wires, flipped_bits

BALISE, SWEEPS = 2 * SWEEP, 11  # step of the balise; sweeps measured
SPEED, DISTANCE = 7, 60


def approach(step: int) -> dict[str, int | bool]:
    """Past the balise, two units a sweep."""
    passed = step >= BALISE
    return {"reading.balise": step == BALISE, "reading.stop": True, "reading.distance": DISTANCE,
            "reading.run": 2 * passed, "reading.speed": SPEED if passed else 0}  # fmt: skip


def wrong(wires: Wires) -> Bit:
    """Energised where the truth forbids it, or in the cycle after a mismatch."""
    return ~wires["brake"] & (~wires["safe"] | wires["dual.comparator.stopped"])


one = Campaign(
    id="dual_processor_upsets",
    model=OnBoard,
    stimulus=approach, run_in=BALISE + SWEEP, measured=SWEEP * SWEEPS,
    faults=flipped_bits("dual.a.*", "dual.b.*"),
    onsets=range(BALISE + SWEEP, BALISE + SWEEP * SWEEPS), length=1,
    hazard=wrong,
    detectors={"comparator": lambda wires: wires["dual.comparator.stopped"]},
    expect={"detected": 1920},
)  # fmt: skip


def alike() -> list[Fault]:
    """One bit inverted in both processors."""
    return [
        Fault(flip(k), [point, point.replace("dual.a", "dual.b")], name=f"{point[7:]} bit {k or 0} in both flips")
        for word in WORDS for point, k in bits(word, "a")
    ]  # fmt: skip


both = Campaign(
    id="dual_processor_upsets_of_both",
    model=OnBoard,
    stimulus=approach, run_in=BALISE + SWEEP, measured=SWEEP * SWEEPS,
    faults=alike(),
    onsets=range(BALISE + SWEEP, BALISE + SWEEP * SWEEPS), length=1,
    hazard=wrong,
    detectors={"comparator": lambda wires: wires["dual.comparator.stopped"]},
    expect={"detected": 0, "dangerous_undetected": 231, "no_effect": 729},
)  # fmt: skip
