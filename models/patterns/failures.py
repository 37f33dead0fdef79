"""How the components of speed supervision fail: the fault table, row by row, and the faults of the equipments for it.

A row acts in each equipment that has its points; directions are S (restrictive) and D (dangerous).
Source: components, modes, directions, detectors of the fault table [A]; failure rates in FIT [A]; sizes (5 m/s, 80 m,
the bin of +16 permille, 0.2 m/s^2, a clock 25 % fast) [A].
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

from models.patterns.stored_pattern import BINS
from safety import ANY_TIME, Fault, Model, dead, offset, open_circuit, reads, stuck, welded
from safety.kinds import Kind
from safety.tracing import trace

SHORT = Fraction(-1, 5)  # m/s^2, of a brake that gives less than guaranteed
FAST = Fraction(5, 4)  # ticks of a fast clock for each one due
ASSUMED_RATES = "[A] FIT of the fault table"


class Mode(NamedTuple):
    """A row of the table (two for the clock): `places` are the ways in which it shows, by kind and points."""

    component: str
    mode: str
    direction: str  # S or D
    detected_by: str
    fit: int
    places: Sequence[tuple[Kind, Sequence[str]]]

    @property
    def name(self) -> str:
        """Component and mode, also the name of its faults."""
        return f"{self.component}: {self.mode}"

    @property
    def rate(self) -> str:
        """Failures per hour."""
        return f"{self.fit}e-9"


BELOW = ("pattern.comparator", "pattern.comparator_test")  # one element, at work and under test
TABLE = (
    Mode("track coil", "missing or detuned", "D", "expected-balise map, pair code", 200,
         [(stuck(0), ["inductor.track_coil"])]),
    Mode("track coil contact", "welded", "D", "none on board; ground check", 20, [(welded(), ["contact"])]),
    Mode("track coil contact", "open", "S", "yes", 100, [(open_circuit(), ["contact"])]),
    Mode("permanent magnet", "lost or demagnetised", "D", "inspection", 10, [(stuck(0), ["magnet.magnet"])]),
    Mode("clearing coil or supply", "open", "S", "yes", 200, [(open_circuit(), ["magnet.clearing_coil"])]),
    Mode("on-board coil and oscillator", "stops oscillating", "S", "yes", 300, [(stuck(0), ["inductor.oscillator"])]),
    Mode("on-board coil and oscillator", "frequency stuck", "D", "periodic test coil", 30,
         [(stuck(0), ["inductor.coupling", "test_coil"])]),
    Mode("speed generator", "zero output", "D", "two-sensor compare, zero-speed plausibility", 150,
         [(dead(), ["speed.first"])]),
    Mode("speed generator", "reads high", "S", "compare", 50, [(offset(5), ["speed.first"])]),
    Mode("function generator", "value high", "D", "duplicate compare", 100, [(offset(80), ["pattern.generator"])]),
    Mode("function generator", "value low or none", "S", "yes", 100, [(dead(), ["pattern.generator"])]),
    Mode("gradient selector", "wrong bin", "D", "echo, range check", 50, [(reads(BINS[-1]), ["pattern.selector"])]),
    Mode("comparator", "stuck below", "D", "dynamic test each cycle", 30,
         [(stuck(1), BELOW), (stuck(1), ["comparator", "comparator_test"])]),
    Mode("comparator", "stuck above", "S", "yes", 70,
         [(stuck(0), ["pattern.comparator"]), (stuck(0), ["comparator"])]),
    Mode("brake valve", "fails to vent", "D", "periodic test, second valve", 20, [(stuck(0), ["vehicle.vent"])]),
    Mode("brake valve", "coil open", "S", "yes", 200, [(open_circuit(), ["vehicle.coil"])]),
    Mode("brake force", "less than guaranteed", "D", "departure brake test, margin", 100,
         [(offset(SHORT), ["vehicle.force"])]),
    Mode("code receiver", "loss", "S", "yes", 300, [(stuck(0), ["receiver"])]),
    Mode("code receiver", "decodes a higher code", "D", "code separation, double reception", 5,
         [(stuck(1), ["receiver"])]),
    Mode("acknowledgement button", "stuck closed", "D", "edge-triggered, must be released", 50,
         [(stuck(1), ["pressed"])]),
    Mode("program clock", "fast", "D", "watchdog", 20, [(reads(FAST), ["ticks"])]),
    Mode("program clock", "stops", "S", "watchdog", 20, [(dead(), ["ticks"])]),
)  # fmt: skip
"""The 21 rows of the table, of which that of the clock is two modes."""

ADDED = (
    Mode("second point coil", "not announced", "D", "", 200, [(stuck(0), ["announcement"])]),
    Mode("second speed generator", "zero output", "D", "", 150, [(dead(), ["speed.second"])]),
    Mode("second function generator", "value high", "D", "", 100, [(offset(80), ["pattern.second_generator"])]),
    Mode("dynamic test", "always passed", "D", "", 30,
         [(stuck(0), ["pattern.comparator_test"]), (stuck(0), ["comparator_test"])]),
    Mode("test coil", "always answered", "D", "", 30, [(stuck(1), ["test_coil"])]),
    Mode("second brake valve", "fails to vent", "D", "", 20, [(stuck(0), ["vehicle.second_vent"])]),
    Mode("second code receiver", "decodes a higher code", "D", "", 5, [(stuck(1), ["second_receiver"])]),
    Mode("second clock", "fast", "D", "", 20, [(reads(FAST), ["second_ticks"])]),
)  # fmt: skip
"""How the units fail that the detectors add, with the rates of the first ones [A]; by themselves they do no harm."""


def component_faults(equipment: type[Model], rows: Sequence[Mode] = TABLE) -> list[Fault]:
    """The rows that an equipment has the components for, as faults that may strike at any time, named as the rows."""
    there = trace(equipment).points
    faults = []
    for row in rows:
        for kind, places in row.places:
            points = [point for point in places if point in there]
            if points:
                faults.append(Fault(kind, points, onset=ANY_TIME, name=row.name))
    return faults
