"""TS-7, the whole equipment: all pairs of the 392 listed failure modes of its components, injected against overspeed.

Ride and judgement are those of `ts7_system_campaign`; both faults strike at once.  Nothing is sampled.

Results: of 76 636 pairs 3392 are dangerous.  2624 of these contain one of the 7 modes that are so by themselves; the
others are 768 = 3 * 16 * 16, two channels silenced, each in one of 16 ways: those that the sample there let expect, and
no others.  550 are found in time, all of them with a single one: no pair that silences two channels is.
"""

from __future__ import annotations

from dataclasses import replace

from models.ts7.failures import component_modes
from proofs.ts7_system_campaign import overspeed, struck

all_pairs = replace(
    overspeed,
    id="ts7_overspeed_all_pairs",
    proofs=(), faults=struck(component_modes().values()), order=2,
    expect={"safe": 2052, "detected": 43_978, "dangerous_undetected": 2842, "no_effect": 27_764, "wrong/yes": 550},
)  # fmt: skip
