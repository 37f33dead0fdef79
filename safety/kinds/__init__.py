"""Fault kinds: what a wire, a word, a contact, a sensor, a clock or a supply does when it fails.

A kind is a small machine at a point, at points that it joins, or at the registers of a part: from the healthy values it
makes those that are there, with memory and free choices of its own where it needs them.  Each says what it means in
one line, which results repeat.  `kinds()` lists them all.
"""

from safety.kinds.kind import (
    GROUP,
    PART,
    POINT,
    POINTS,
    Draw,
    Effect,
    Joint,
    Kind,
    Part,
    Seat,
    Update,
    choose,
)
from safety.kinds.levels import byzantine, dead, flip, open_circuit, oscillating, reads, stuck, upset, welded
from safety.kinds.lines import bridge, swapped, wired_and, wired_or
from safety.kinds.parts import clock_fast, clock_glitch, clock_slow, clock_stop, memory_flip, power_dip
from safety.kinds.pulses import extra, missing
from safety.kinds.registry import Entry, kinds, makers, table
from safety.kinds.timing import delayed, frozen, intermittent, slow_to_operate, slow_to_release
from safety.kinds.values import drift, noise, offset

__all__ = [
    "GROUP", "PART", "POINT", "POINTS", "Draw", "Effect", "Entry", "Joint", "Kind", "Part", "Seat", "Update",
    "bridge", "byzantine", "choose", "clock_fast", "clock_glitch", "clock_slow", "clock_stop", "dead", "delayed",
    "drift", "extra", "flip", "frozen", "intermittent", "kinds", "makers", "memory_flip", "missing", "noise", "offset",
    "open_circuit", "oscillating", "power_dip", "reads", "slow_to_operate", "slow_to_release", "stuck", "swapped",
    "table", "upset", "welded", "wired_and", "wired_or",
]  # fmt: skip
