"""Which faults there may be: faults of a kind at many places, and how many of them at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, cast

from safety.faults.fault import ANY_TIME, FROM_START, Fault
from safety.faults.places import matching
from safety.kinds import POINT, Kind, byzantine
from safety.system import ModelError, System, nearest


def every(
    kind: Kind, *patterns: str, onset: str = FROM_START, ticks: int | None = None
) -> Callable[[System], list[Fault]]:
    """A fault of its own at each point that fits a pattern and has a sort that the kind is for.

    Raises `ModelError` for a kind that does not act at a point alone.
    """
    if kind.place != POINT:
        raise ModelError(f"every({kind}, ...): it acts on {kind.place} at once; write Fault(kind, [...]) for each")

    def expand(system: System) -> list[Fault]:
        return [
            Fault(kind, [p], onset, ticks=ticks)
            for p in matching(system, patterns)
            if system.points[p].sort.kind in kind.sorts
        ]

    return expand


@dataclass(frozen=True)
class Budget:
    """Which faults may be present at once: at most `most` of them (None: any number)."""

    faults: Any
    most: int | None

    def expand(self, system: System) -> list[Fault]:
        """The faults of this budget in a system."""
        return expand(system, self.faults)


def at_most(most: int, faults: Any) -> Budget:
    """At most `most` faults of a list, of `every(...)`, or of the parts of a kind: `at_most(1, "channel")`."""
    if type(most) is not int or most < 0:
        raise ModelError(f"at_most({most!r}, ...): a number of faults is 0 or more; any_of_faults(...) is any number")
    return Budget(faults, most)


def any_of_faults(faults: Any) -> Budget:
    """Any combination of the faults."""
    return Budget(faults, None)


def expand(system: System, faults: Any) -> list[Fault]:
    """The list of faults that a budget's description stands for in a system.

    A string names the parts whose model class it is: each such part may have all its points byzantine at any time.
    """
    if isinstance(faults, str):
        hit = [path for path, kind in system.parts.items() if kind.lower() == faults.lower()]
        if not hit:
            there = {kind.lower() for kind in system.parts.values()}
            raise ModelError(f"{system.name} has no part of kind {faults!r}; {nearest(faults, there)}")
        return [Fault(byzantine(), [f"{path}.*"], ANY_TIME, name=path) for path in hit]
    if callable(faults):
        return cast(list[Fault], faults(system))
    return [f for item in faults for f in ([item] if isinstance(item, Fault) else expand(system, item))]
