"""ATS-SP and radio control: which modes of the component table are wrong-side by themselves, and pairs that are.

What the campaigns have to find, and what the fault trees are made of.  Rates are those of `Mode.fit`: INVENTED [A], the
table has none.
"""

from __future__ import annotations

from fractions import Fraction

from models.ats.failures import FIT, RADIO, Mode, table

PAIRS = (("comparator: stuck equal", "processor: single fault"),)  # of the processor that drives the output
MAPPED = ("signal balise: missing / detuned", "branch balise: missing")  # found in time where the map is consulted


def named() -> dict[str, Mode]:
    """The rows by name."""
    return {mode.name: mode for mode in table()}


def dangerous(mode: Mode) -> bool:
    """Wrong-side by itself, as it stands in the table or as injection finds it."""
    return (mode.found or mode.direction) == "D"


def singles(mapped: bool = False) -> list[str]:
    """Rows of ATS-SP that are wrong-side by themselves; with the map, without those that it finds."""
    own = [mode.name for mode in table() if dangerous(mode) and mode.bench != RADIO]
    return [name for name in own if not (mapped and name in MAPPED)]


def of_radio() -> list[str]:
    """Rows of radio control that are wrong-side by themselves."""
    return [mode.name for mode in table() if dangerous(mode) and mode.bench == RADIO]


def per_hour(name: str) -> Fraction:
    """Failures per hour of a row."""
    return named()[name].fit * FIT
