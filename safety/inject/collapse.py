"""Faults that come to the same by construction: one of each class is run, and counts for all of them.

1. The same masks at the same points at the same time are one fault.
2. What nothing that is looked at depends on, now or later, may read anything.
3. A fault at a place that one other place alone reads is one at that place, where its mask can be told there: an
   inverter, the controlling value of a gate, a bit out of a word, a point of another name (fault collapsing of
   McCluskey and Clegg, IEEE Trans. Computers C-20 (1971), here on words, and at each step of a fault's time).
4. A fault on a constant is what it makes of the constant; one that keeps it changes nothing.

All hold whatever the values elsewhere are, so also beside other faults, unless one of these acts at the same points, on
the way (3) or on what makes the constant (4): that is the zone of a fault.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from safety.faults import Fault, where
from safety.inject.engine import NONE
from safety.inject.masks import Mask, changes_nothing, masks, without_points
from safety.inject.space import window
from safety.system import System
from safety.terms.graph import Term, postorder, variables

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from safety.inject.ranks import Positions

    Leaders = npt.NDArray[np.int64]
    Table = npt.NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Collapse:
    """Which single fault is run for each: itself, an earlier one, or `NONE` where it cannot show.

    That holds where no other fault acts in its zone; `apart[f, g]`: fault g acts neither in the zone of f, nor in that
    of its leader.  `idle`: the faults that leave the equipment as it is.
    """

    leaders: Leaders
    apart: Table
    idle: Table

    @property
    def nothing(self) -> bool:
        """Whether each fault is run for itself."""
        return bool((self.leaders == range(len(self.leaders))).all())

    def representatives(self, members: Positions) -> Positions:
        """What is run for combinations of faults, of shape (order, combinations): the same shape, ascending."""
        import numpy as np

        found = members.copy()
        for row in range(len(found)):
            own, free = found[row], found[row] != NONE
            for other in (o for k, o in enumerate(found) if k != row):
                free = free & ((other == NONE) | self.apart[own, other])
            found[row] = np.where(free, self.leaders[own], own)
        return np.sort(found, axis=0)  # faults at one point act in their order: they stayed as they were

    def to_json(self) -> dict[str, int]:
        """How many single faults there are, are run, and cannot show."""
        own = int((self.leaders == range(len(self.leaders))).sum())
        return {"single_faults": len(self.leaders), "run": own, "cannot_show": int((self.leaders == NONE).sum())}


@dataclass(frozen=True)
class End:
    """Where a fault ends up: its masks by place, and the points of its zone."""

    seen: Mapping[object, Mask]
    zone: frozenset[str]


def collapse(system: System, faults: Sequence[Fault], looked_at: Iterable[str]) -> Collapse:
    """Collapse single faults; `looked_at` names the signals that are.  Raises `ModelError` for what does not fit."""
    import numpy as np

    found = [masks(system, fault) for fault in faults]
    places = [frozenset(where(system, fault)) for fault in faults]
    others = [name for m, names in zip(found, places, strict=True) if m is None for name in names]
    graph = Graph.of(system, looked_at, others)
    ends = [None if m is None else graph.end(m) for m in found]
    leaders = _leaders(faults, [None if end is None else end.seen for end in ends])
    zones = [names if end is None else names | end.zone for names, end in zip(places, ends, strict=True)]
    both = [zone if led == NONE else zone | zones[led] for zone, led in zip(zones, leaders, strict=True)]
    names = sorted({name for names in places for name in names})
    acts, zone = (np.array([[n in s for n in names] for s in sets], dtype=np.float32) for sets in (places, both))
    idle = [m is not None and changes_nothing(system, m) for m in found]
    return Collapse(np.array(leaders), zone @ acts.T == 0, np.array(idle, dtype=np.bool_))


def _leaders(faults: Sequence[Fault], seen: Sequence[Mapping[Any, Mask] | None]) -> list[int]:
    """The first fault of the same masks at the same places and time; of one without masks, itself."""
    classes: dict[object, int] = {}
    return [
        place
        if masks is None
        else classes.setdefault((window(fault), frozenset(masks.items())), place)
        if masks
        else NONE
        for place, (fault, masks) in enumerate(zip(faults, seen, strict=True))
    ]


@dataclass(frozen=True)
class Graph:
    """What shows of a system: the terms of points, who reads a term (`None`: a register or a look), constants."""

    places: Mapping[str, list[Term]]
    readers: Mapping[int, list[Term | None]]
    constants: Mapping[int, int]

    @classmethod
    def of(cls, system: System, looked_at: Iterable[str], others: Iterable[str]) -> Graph:
        """The graph under what is looked at, and under what faults of other kinds than masks may read (`others`)."""
        roots = [system.lookup(name) for name in looked_at]
        roots += [system.points[name] for name in others if name in system.points]
        needed = live(system, roots, {name for name in others if name in system.state})
        readers: dict[int, list[Term | None]] = {root.uid: [] for root in needed}
        for root in needed:
            readers[root.uid].append(None)
        order = postorder(needed)
        places: dict[str, list[Term]] = {}
        for term in order:
            for arg in term.args:
                readers.setdefault(arg.uid, []).append(term)
            if term.op == "point":
                places.setdefault(term.attr, []).append(term)
        folded = without_points(order)
        constants = {t.uid: int(f.attr) for t, f in zip(order, folded, strict=True) if f.is_const and _bits(t)}
        return cls(places, readers, constants)

    def end(self, at: Mapping[str, Mask]) -> End:
        """Where masks show when no other fault acts in their zone; nowhere, where nothing does."""
        seen: dict[object, Mask] = {point: mask for point, mask in at.items() if point in self.places}
        terms = [term for point in seen for term in self.places[str(point)]]
        if len(terms) != 1:
            return End(seen, frozenset())
        (mask,) = seen.values()
        return self._followed(terms[0], mask)

    def _followed(self, term: Term, mask: Mask) -> End:
        """Up to the last place at which a mask can be told."""
        zone: set[str] = set()
        while True:
            if term.uid in self.constants:
                healthy = self.constants[term.uid]
                mask = Mask(0, healthy & mask.keep ^ mask.turn)
                zone |= {t.attr for t in postorder([term]) if t.op == "point"}
                if mask.turn == healthy:
                    return End({}, frozenset(zone))
            if mask == Mask(int(term.sort.bounds[1]), 0):
                return End({}, frozenset(zone))
            if term.op == "point":
                zone.add(term.attr)
            reader = self.readers[term.uid][0] if len(self.readers[term.uid]) == 1 else None
            further = None if reader is None else told(reader, term, mask)
            if reader is None or further is None:
                return End({term.uid: mask}, frozenset(zone))
            term, mask = reader, further


def live(system: System, roots: Sequence[Term], registers: Iterable[str] = ()) -> list[Term]:
    """The roots, with the next values of all registers that they depend on, now or later, and of the named ones."""
    following = {s.var.uid: s for s in system.states}
    found = list(roots)
    seen = {system.state[name].var.uid for name in registers}
    todo = [*seen, *(v.uid for v in variables(roots))]
    seen = set()
    while todo:
        uid = todo.pop()
        if uid in following and uid not in seen:
            seen.add(uid)
            found.append(following[uid].next)
            todo += [v.uid for v in variables([following[uid].next])]
    return found


def _bits(term: Term) -> bool:
    return term.sort.kind in ("bit", "uint")


_ALIKE = {"point", "not", "and", "or", "xor", "band", "bor", "bxor"}  # the result has the sort of the arguments


def told(reader: Term, term: Term, mask: Mask) -> Mask | None:
    """What a mask on `term` is at the one term that reads it, or None where it is no mask there."""
    if not all(map(_bits, (reader, *reader.args))) or (reader.op in _ALIKE and reader.sort != term.sort):
        return None
    ones = int(term.sort.bounds[1])
    low, high = mask.turn, mask.keep ^ mask.turn  # what 0 and what all ones become
    stuck_0, stuck_1, turned = ~low & ~high & ones, low & high, low & ~high & ones
    first = reader.args[0] is term
    match reader.op:
        case "point":
            return mask
        case "not":
            return Mask(mask.keep, mask.turn ^ (ones & ~mask.keep))
        case "and" | "band":
            return None if stuck_1 | turned else mask
        case "or" | "bor":
            return None if stuck_0 | turned else mask
        case "xor" | "bxor":
            return None if stuck_0 | stuck_1 else mask
        case "implies":
            wanted = stuck_0 if first else stuck_1
            return Mask(0, 1) if wanted else None
        case "bit":
            return Mask(mask.keep >> reader.attr & 1, mask.turn >> reader.attr & 1)
        case "slice":
            start, count = reader.attr
            return _cut(Mask(mask.keep >> start, mask.turn >> start), count)
        case "concat":
            below = reader.args[1].sort.width
            if first:
                return Mask(mask.keep << below | (1 << below) - 1, mask.turn << below)
            whole = int(reader.sort.bounds[1])
            return replace(mask, keep=mask.keep | whole & ~ones)
        case "cast":
            return replace(mask, keep=mask.keep | int(reader.sort.bounds[1]) & ~ones)
        case "select" if first and [a.attr for a in reader.args[1:] if a.is_const] == [1, 0]:
            return mask  # a wire as a word of one bit
    return None


def _cut(mask: Mask, count: int) -> Mask:
    part = (1 << count) - 1
    return Mask(mask.keep & part, mask.turn & part)
