"""TS-7: the parts lists, failures per hour.  Every number here is INVENTED [A]: it shows the method, not the equipment.

Two lists at two levels, which do not add up to each other: `COMPONENTS` are the failure modes of the hazard's cut sets,
`RING` and `CHANNEL` the groups of stuck faults of the injection campaigns, 1 to 2 FIT an element.
"""

from typing import NamedTuple

INVENTED_COMPONENTS = "[A] invented parts list"
INVENTED_ELEMENTS = "[A] invented for the example: 1 FIT to 2 FIT an element"

COMPONENTS = {  # failure mode of a channel or of what the channels share
    "no f_v": "2e-7", "f_p in every frame": "1e-7", "ring stuck": "1e-6", "wrong word": "1e-7",
    "comparator at 0": "2e-7", "latch at release": "1e-7", "NBRR welded": "1e-8", "CHR welded": "1e-8",
    "fault detector dead": "5e-7", "latch at brake": "1e-7", "speed generator dead": "2e-7",
    "wrong row in all channels": "1e-9", "signal lines wire-ORed with 25": "1e-9", "wheel switch on 780 mm": "5e-8",
    "wheel switch open": "1e-7", "shared oscillator fast": "1e-8",
    "NB output welded": "1e-8", "EB relay welded": "1e-8", "synchronisation isolates anyone": "1e-7",
}  # fmt: skip


class Elements(NamedTuple):
    """A group of elements that fail alike: the part they belong to, failures per hour of them all."""

    part: str
    rate_per_h: str


RING = {  # bit by bit
    "stage": Elements("ring register", "6.4e-8"),
    "carry": Elements("adder", "2e-9"),
    "sum": Elements("adder", "2e-9"),
    "data": Elements("adder", "2e-9"),
    "column": Elements("data matrix", "8e-9"),
    "cell J0": Elements("data matrix", "8e-9"),
    "cell J1": Elements("data matrix", "8e-9"),
    "cell J2": Elements("data matrix", "8e-9"),
    "cell J3": Elements("data matrix", "8e-9"),
    "carry clear": Elements("adder", "1e-9"),
    "word select": Elements("data matrix", "4e-9"),
    "overflow": Elements("overflow gates", "8e-9"),
}

CHANNEL = {  # frame by frame
    "inputs": Elements("input buffer", "6e-9"),
    "limit": Elements("data matrix", "8e-9"),
    "cells": Elements("data matrix", "3.2e-8"),
    "word select": Elements("data matrix", "4e-9"),
    "overflow": Elements("overflow gates", "8e-9"),
    "stages": Elements("dividers", "1.6e-8"),
    "counter, latch": Elements("comparator", "4e-9"),
    "counter, latch, gate": Elements("roll-back", "5e-9"),
    "latch": Elements("fault detector", "2e-9"),
    "amplifier": Elements("output", "5e-9"),
}

BIT_BY_BIT_ONLY = ("stage", "carry", "sum", "data", "column", "carry clear")
"""Groups of RING that no group of CHANNEL repeats: with CHANNEL they are one whole channel."""


def component_rate(fault: str) -> str:
    """Failures per hour of a fault of the equipment; the list is the same for each channel, `a: no f_v`."""
    return COMPONENTS[fault.split(": ")[-1]]
