"""Two-counter ATC: the parts list, failures per hour.  Every number is INVENTED [A]: it shows the method, no more.

A stage, line or gate fails at 1 FIT (1e-9 per hour) to each of its values; what is larger has its own number.
"""

from __future__ import annotations

from fractions import Fraction

from safety import Fault

INVENTED = "[A] invented parts list"
ELEMENT = "1e-9"  # a stage, line or gate, to one value

COMPONENTS = {
    "generator open or short": "2e-7", "one generator pulse in 100 lost": "1e-7",
    "noise edge every 200 periods": "1e-7", "generator 5 km/h high": "1e-8", "generator 5 km/h low": "1e-8",
    "oscillator stops": "3e-7", "oscillator 1 % slow": "1e-7", "oscillator 1 % fast": "1e-7",
    "oscillator on its second harmonic": "1e-8",
    "FF6 flips": "1e-7", "FF2 flips": "1e-7",
    "Ry-1 coil open": "2e-7", "Ry-1 contact welded": "1e-8", "Ry-1 contact open": "2e-7",
    "power off": "5e-7", "power dips": "1e-6",
}  # fmt: skip


def component_rate(fault: Fault) -> str:
    """Failures per hour of a failure mode, as the list has it."""
    return COMPONENTS.get(fault.name, ELEMENT)


def mode_rate(fault: Fault) -> Fraction:
    """The same as a number."""
    return Fraction(component_rate(fault))
