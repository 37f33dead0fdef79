"""Two-counter ATC: which single faults are wrong-side, by check speed, and why: what proofs and injections must find.

The known defeats of property 15 by their letters, and what else there is with its reason.  Where the preset m of the
check speed matters, these differ from one check speed to the next:

* bits of the preset that m has not set, and the preset of 250 km/h, lengthen the count of that check speed (e);
* stages of counter 2 beyond m stand at 0 anyway (g);
* counter 2 runs through its 2048 edges in time for 250 km/h, where property 4 allows 2 m + 10 = 2080, but not for any
  other, so a counting gate that breaks off a count is wrong-side there.

So 61 single faults are wrong-side at 250 km/h, 59 at 210, 61 at 160, 58 at 110, 59 at 70 and 30, 58 at 5, and at each
of them also the generator that reads low.
"""

from __future__ import annotations

from models.two_counter.failures import STAGES
from models.two_counter.numbers import PRESETS

CAPACITY = 2048  # edges after which counter 2 is at 0 again
LOW = "generator 5 km/h low"


def defeats(m: int) -> dict[str, list[str]]:
    """The single faults of property 15 that are wrong-side at the check speed of preset `m`, by letter."""
    return {
        "a": ["generator open or short"],
        "b": ["oscillator 1 % fast", "oscillator on its second harmonic"],
        "c": ["one generator pulse in 100 lost"],
        "d": ["FF6 at 1", "gate circuit 1 at 1", "FF2 at 0", "Ry-1 contact welded"],
        "e": [f"preset bit {k} at 1" for k in STAGES if not _has(m, k)] + _larger(m),
        "f": ["AND1 at 1"],
        "g": [f"counter 2: stage {k} at {value}" for k in STAGES for value in (0, 1) if value or 2**k <= m],
        "h": ["signal 2 missing"],
        "i": ["AND2 at 0"],
        "j": ["signal 1 missing", "signal 3 missing"],
        "k": ["counter 2 misses one count in 100"],
        "l": ["counter 1 is not reset", *(f"counter 1: stage {k} at 1" for k in STAGES)],
    }


def _has(m: int, k: int) -> bool:
    """Whether bit k of the preset is set."""
    return bool(m >> k & 1)


def _larger(m: int) -> list[str]:
    """The preset of another check speed, where it is the larger one."""
    return ["preset of 250 km/h"] if m < max(PRESETS) else []


def further(m: int) -> dict[str, str]:
    """What else is wrong-side by itself, and why."""
    return {
        "counter 2 is not reset": "after a count it runs on to 2048 before a read-out can come: late, at half the rate",
        "counting gate at 1": "a count follows a count without a preparation, so no read-out comes: hold",
        "signal 3 always": "counter 2 is cleared in each step, so no read-out comes: hold",
        "signals 2 and 3 swapped": "the count begins where signal 2 was due, which so never comes: stale safe",
        "signals 1 and 3 swapped": "the count begins where signal 1 was due, which so never comes: hold",
        "FF6 flips": "between signal 2 and the count nothing resets it: one sample reads safe, the brake is late",
    } | _broken_off(m)


def _broken_off(m: int) -> dict[str, str]:
    """What a count that is broken off does where counter 2 is not round again in time."""
    why = "the count breaks off and counter 2 runs on to 2048 before a read-out comes: late"
    return {"counting gate at 0": why} if 2 * m + 10 < CAPACITY else {}


def singles(m: int) -> list[str]:
    """All single faults that are wrong-side, of those that a proof is about."""
    return [name for names in (*defeats(m).values(), further(m)) for name in names]
