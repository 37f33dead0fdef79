"""Stuck and flipped bits as masks: whatever their number, they cost two array operations a point.

A kind that maps each bit on its own is, per bit, one of: pass, invert, 0, 1.  All four are `(healthy & keep) ^ turn`,
and so is any sequence of them.  The masks are read off the kind's own effect (`safety.faults`), so there is one
definition of each effect; a kind with memory, free choices or arithmetic has no mask and is built in by `instrument`.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass

from safety.faults import Fault, Kind, Seat, placed
from safety.kinds import POINT
from safety.system import System, substitute
from safety.terms.graph import Sort, Term, node, postorder, rewrite, variable
from safety.terms.values import bit, build, const

BITWISE = {"var", "const", "not", "and", "or", "xor", "band", "bor", "bxor"}
KEEP, TURN = " keep", " turn"  # a mask's variables are named after their point


@dataclass(frozen=True)
class Mask:
    """What a fault does to each bit: `(healthy & keep) ^ turn`."""

    keep: int
    turn: int

    def after(self, first: Mask) -> Mask:
        """This mask on what `first` left."""
        return Mask(first.keep & self.keep, first.turn & self.keep ^ self.turn)


def mask_of(kind: Kind, sort: Sort) -> Mask | None:
    """The mask of a kind on a point of a sort, read off its effect; None where it does more than map bits.

    Raises `ModelError` when the kind names a bit that the point does not have.
    """
    if sort.kind not in ("bit", "uint") or sort.kind not in kind.sorts:
        return None
    healthy = variable("healthy value", sort)
    seat = Seat("probe", bit(True))
    seen = kind.effect(seat, healthy)
    if seat.states or seat.inputs or seen.sort != sort or not all(_bitwise(t, sort) for t in postorder([seen])):
        return None
    zero, ones = (_number(substitute([seen], {healthy.uid: const(v, sort)})[0]) for v in _extremes(sort))
    return Mask(zero ^ ones, zero)


def _bitwise(term: Term, sort: Sort) -> bool:
    return term.op in BITWISE and term.sort == sort


def _extremes(sort: Sort) -> tuple[bool | int, bool | int]:
    low, high = sort.bounds
    return (False, True) if sort.kind == "bit" else (low, high)


def _number(term: Term) -> int:
    assert term.is_const
    return int(term.attr)


def masks(system: System, fault: Fault) -> dict[str, Mask] | None:
    """The masks of a fault at its points, or None when one of them needs more than a mask.

    Raises `ModelError` for a kind that does not fit a point, and for a point that does not exist.
    """
    found: dict[str, Mask] = {}
    for place in placed(system, fault):
        if place.kind.place != POINT:
            return None
        (point,) = place.names
        mask = mask_of(place.kind, system.points[point].sort)
        if mask is None:
            return None
        found[point] = mask
    return found


@dataclass(frozen=True)
class Masked:
    """A system whose points carry masks: for each of them the variables of `keep` and `turn`."""

    system: System
    variables: Mapping[str, tuple[Term, Term]]


def masked(system: System, points: Iterable[str]) -> Masked:
    """The system with `(healthy & keep) ^ turn` at each of the points; every point then gives way to its value."""
    found = {p: (variable(p + KEEP, system.points[p].sort), variable(p + TURN, system.points[p].sort)) for p in points}

    def rule(old: Term, args: tuple[Term, ...]) -> Term:
        if not old.args:
            return old
        if old.op == "point" and old.attr in found:
            keep, turn = found[old.attr]
            and_, xor = ("and", "xor") if old.sort.kind == "bit" else ("band", "bxor")
            return node(
                "point",
                (build(xor, (build(and_, (args[0], keep), None, old.sort), turn), None, old.sort),),
                old.attr,
                old.sort,
            )
        return build(old.op, args, old.attr, old.sort) if old.op != "point" else node("point", args, old.attr, old.sort)

    return Masked(system.mapped(lambda roots: rewrite(roots, rule)), found)


def without_points(roots: Sequence[Term], but: Container[str] = ()) -> list[Term]:
    """The terms with each point, `but` those of some names, replaced by what is there: constants fold through it."""

    def rule(old: Term, args: tuple[Term, ...]) -> Term:
        if old.op == "point":
            return node("point", args, old.attr, old.sort) if old.attr in but else args[0]
        return build(old.op, args, old.attr, old.sort) if old.args else old

    return rewrite(roots, rule)


def changes_nothing(system: System, found: Mapping[str, Mask]) -> bool:
    """Whether the masks leave the equipment as it is by construction: each acts on a constant and keeps its value.

    For example a memory cell stuck at what it stores.
    """
    inner = without_points([system.points[p] for p in found])
    return all(
        t.is_const and (int(t.attr) & mask.keep) ^ mask.turn == int(t.attr)
        for t, mask in zip(inner, found.values(), strict=True)
    )
