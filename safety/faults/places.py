"""Where in a system a fault acts: its points, or the registers of its parts, checked against its kind."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

from safety.faults.fault import Fault
from safety.kinds import GROUP, PART, POINTS, Kind
from safety.system import ModelError, System, nearest
from safety.terms.graph import Sort


@dataclass(frozen=True)
class Placed:
    """A kind where it acts: one point, the points that it joins, or the registers (all by full name)."""

    kind: Kind
    names: tuple[str, ...]


def matching(system: System, patterns: Iterable[str]) -> list[str]:
    """Full names of the points that fit, each once.  Raises `ModelError` for a pattern that fits none."""
    found: list[str] = []
    for pattern in patterns:
        hits = [p for p in system.points if fnmatchcase(p, pattern)]
        if not hits:
            raise ModelError(f"{system.name} has no point {pattern!r}; {nearest(pattern, system.points)}")
        found += [p for p in hits if p not in found]
    return found


def registers_of(system: System, patterns: Iterable[str]) -> list[str]:
    """Full names of the registers of parts, each once and without parameters, in the order of the system.

    A pattern fits parts, single registers, or the name of the whole.  Raises `ModelError` for one that fits none.
    """
    found: set[str] = set()
    own = [s.path for s in system.states if s.path not in system.settings]
    for pattern in patterns:
        parts = [part for part in system.parts if fnmatchcase(part, pattern)]
        hits = {p for p in own if fnmatchcase(p, pattern) or any(p.startswith(f"{part}.") for part in parts)}
        if not hits and not parts and pattern != system.name:
            there = {*system.parts, *own, system.name}
            raise ModelError(f"{system.name} has no part or register {pattern!r}; {nearest(pattern, there)}")
        hits |= set(own) if pattern == system.name else set()
        if not hits:
            raise ModelError(f"{pattern!r} of {system.name} has no register: nothing for such a fault to act on")
        found |= hits
    return [p for p in own if p in found]


def placed(system: System, fault: Fault) -> list[Placed]:
    """Where a fault acts.

    Raises `ModelError` for a place that does not exist or has another sort than the kind is for, for the wrong number
    of points, and for a group with two kinds at one place.
    """
    found = _placed(system, fault, fault.kind, fault.points)
    names = [name for place in found for name in (place.names if place.kind.place != PART else ())]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise ModelError(f"fault {fault.name!r} has two kinds at {twice}; leave one to a fault of its own")
    return found


def _placed(system: System, fault: Fault, kind: Kind, points: Sequence[str]) -> list[Placed]:
    if kind.place == GROUP:
        return [
            place for pattern, member in kind.members for place in _placed(system, fault, member, pattern.split("+"))
        ]
    if kind.place == PART:
        registers = registers_of(system, points)
        _check_sorts(fault, kind, {p: system.state[p].var.sort for p in registers})
        return [Placed(kind, tuple(registers))]
    names = matching(system, points)
    sorts = {p: system.points[p].sort for p in names}
    _check_sorts(fault, kind, sorts)
    if kind.place != POINTS:
        return [Placed(kind, (p,)) for p in names]
    least, most = kind.at_once
    if not least <= len(names) <= (most or len(names)):
        wanted = f"{least}" if most == least else f"{least} or more"
        here = ", ".join(names)
        raise ModelError(f"fault {fault.name!r}: {kind} joins {wanted} points; here are {len(names)}: {here}")
    if len(set(sorts.values())) > 1:
        found = ", ".join(f"{p} is {sort}" for p, sort in sorts.items())
        raise ModelError(f"fault {fault.name!r}: {kind} joins points of one sort; {found}")
    return [Placed(kind, tuple(names))]


def _check_sorts(fault: Fault, kind: Kind, sorts: dict[str, Sort]) -> None:
    for name, sort in sorts.items():
        if sort.kind not in kind.sorts:
            wanted = ", ".join(kind.sorts)
            raise ModelError(f"fault {fault.name!r}: {kind} does not apply to {name}, a {sort}; it is for {wanted}")


def names_of(places: Iterable[Placed]) -> tuple[str, ...]:
    """The points and registers of some places, each once."""
    return tuple(dict.fromkeys(name for place in places for name in place.names))


def where(system: System, fault: Fault) -> tuple[str, ...]:
    """Full names of the points or registers at which a fault acts, each once; raises as `placed` does."""
    return names_of(placed(system, fault))


def is_wide(system: System, fault: Fault) -> bool:
    """Whether a fault joins points or acts on parts.

    Several such faults, if not meant to be there at once, are better built into a system each: lines that are joined
    in two ways may depend on each other, and each fast clock multiplies the terms of the steps that it repeats.
    """
    return any(place.kind.place in (POINTS, PART) for place in placed(system, fault))
