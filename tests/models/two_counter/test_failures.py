"""Component failures of the two-counter ATC: which way they go, by simulation, 1 km/h below and above 250 km/h."""

from __future__ import annotations

from dataclasses import replace

import pytest

from models.two_counter.failures import component_faults
from safety.faults import ANY_TIME, TRANSIENT
from tests.models.two_counter.runs import KMH, ride, threshold

ONSET, FASTER, JUDGED, END = 2500, 6600, 10_700, 12_800  # steps; the response at 250 km/h takes 4019
FAULTS = {fault.name: fault for fault in component_faults()}


def direction(name: str) -> str:
    """`safe` brakes needlessly, `wrong` does not brake, `hold` has no read-out besides; `none` changes nothing lasting.

    The fault begins when the brake is released; a transient one stays for as long as it says.
    """
    fault = FAULTS[name]
    fault = replace(fault, at=ONSET) if fault.onset == TRANSIENT else replace(fault, onset=ANY_TIME, at=ONSET)
    speed = threshold(250)
    seen = ride(lambda k: speed + (KMH if k >= FASTER else -KMH), END, faults=[fault], keep=["brake", "signal1"])
    assert not seen["brake"][ONSET - 1]
    if not all(seen["brake"][JUDGED:]):
        return "wrong" if any(seen["signal1"][JUDGED - 2100 :]) else "hold"
    return "safe" if any(seen["brake"][ONSET:FASTER]) else "none"


EXPECTED = {
    "hold": [
        "generator open or short", "signal 1 missing", "signal 3 always", "counting gate at 1",
        "counter 2: stage 10 at 0", "counter 2: stage 3 at 0",
    ],
    "wrong": [
        "one generator pulse in 100 lost", "oscillator 1 % fast", "oscillator on its second harmonic",
        "counter 2 misses one count in 100", "gate circuit 1 at 1", "AND1 at 1", "AND2 at 0", "signal 2 missing",
        "signals 2 and 3 swapped", "FF6 at 1", "FF2 at 0", "Ry-1 contact welded", "preset bit 4 at 1",
        "counter 1 is not reset", "counter 1: stage 5 at 1",
    ],
    "safe": [
        "noise edge every 200 periods", "oscillator stops", "oscillator 1 % slow", "gate circuit 1 at 0", "AND1 at 0",
        "AND2 at 1", "FF6 at 0", "FF2 at 1", "Ry-1 coil open", "Ry-1 contact open", "power off", "power dips",
        "preset bit 10 at 0", "no selection", "counter 1: stage 5 at 0", "line s5 besides", "signal 2 always",
    ],
    "none": ["AND3 at 0", "AND3 at 1", "signal 3 missing", "FF6 flips"],
}  # fmt: skip


@pytest.mark.parametrize("expected", EXPECTED)
def test_direction_of_a_failure(expected: str) -> None:
    """AND3 at 0 never releases again; without signal 3 counter 2 runs round and reads out a reset FF6."""
    assert {name: direction(name) for name in EXPECTED[expected]} == dict.fromkeys(EXPECTED[expected], expected)


@pytest.mark.slow
def test_how_many_failures_go_which_way() -> None:
    found = [direction(name) for name in FAULTS]
    assert {kind: found.count(kind) for kind in EXPECTED} == {"hold": 26, "wrong": 32, "safe": 41, "none": 26}
