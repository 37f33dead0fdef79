"""Kinds that join lines: shorts, bridges, and two lines swapped.

Each takes several points of one sort at once, and sees the healthy value of each.  Where one of these values depends on
another through logic without a register, the values have no order; such a fault is refused when it is built in.
`late=True` is the way out: each point then meets the values that the others had at the step before (at first: 0).
"""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable
from typing import Any, cast

from safety.kinds.kind import ANY_SORT, WIRES, Joint, Kind, Seat, resting
from safety.system import ModelError
from safety.terms import Bit, UInt, select
from safety.terms.graph import BIT, Term

_SHORTS = "IEC 61508-2:2010 table A.1 (DC fault model: short circuits)"


def wired_and(*, late: bool = False) -> Kind:
    """Short, wired-and: lines that touch, of which 0 is the stronger; all read the AND, bit by bit."""
    return _short("wired-and", "all read 1 only where each is 1", operator.and_, late)


def wired_or(*, late: bool = False) -> Kind:
    """Short, wired-or: lines that touch, of which 1 is the stronger; all read the OR, bit by bit."""
    return _short("wired-or", "all read 1 where one is 1", operator.or_, late)


def _short(name: str, meaning: str, gate: Callable[[Any, Any], Any], late: bool) -> Kind:
    def joint(_: Seat, healthy: tuple[Term, ...]) -> tuple[Term, ...]:
        return (functools.reduce(gate, healthy),) * len(healthy)

    return Kind(_named(name, late), meaning, sorts=WIRES, joint=_meeting(joint, late), reference=_SHORTS)


def bridge(dominant: int | None = None, *, late: bool = False) -> Kind:
    """Bridge: two lines take a common value, that of the first (`dominant=0`) or of the second point (`dominant=1`).

    Without `dominant` neither is the stronger for sure: where they differ, each bit is that of either, anew at each
    step (of the first in a run that says nothing else).
    """
    if dominant is not None and (type(dominant) is not int or dominant not in (0, 1)):
        raise ModelError(f"bridge({dominant!r}): the dominant line is 0, the first point, or 1, the second; or none")

    def joint(seat: Seat, healthy: tuple[Term, ...]) -> tuple[Term, ...]:
        if dominant is not None:
            return (healthy[dominant],) * 2
        first, second = healthy
        chosen = seat.free("value", first.sort)
        if first.sort == BIT:
            return (select(cast(Bit, chosen), cast(Bit, second), cast(Bit, first)),) * 2
        one, other, mix = cast(UInt, first), cast(UInt, second), cast(UInt, chosen)
        return ((one & ~mix) | (other & mix),) * 2

    how = "bridge" if dominant is None else f"bridge, {'second' if dominant else 'first'} dominant"
    meaning = "both read " + ("one or the other" if dominant is None else "the dominant one")
    return Kind(
        _named(how, late),
        meaning,
        sorts=WIRES,
        joint=_meeting(joint, late),
        at_once=(2, 2),
        unit="position of the point",
        reference=_SHORTS,
    )


def swapped(*, late: bool = False) -> Kind:
    """Swapped: two lines are exchanged, such as the two phases of a speed sensor."""
    return Kind(
        _named("swapped", late),
        "each reads the other",
        sorts=ANY_SORT,
        joint=_meeting(lambda _, healthy: healthy[::-1], late),
        at_once=(2, 2),
    )


def _named(name: str, late: bool) -> str:
    return f"{name}, a step late" if late else name


def _meeting(joint: Joint, late: bool) -> Joint:
    """The effect as it is, or with the values that the other points had at the step before."""

    def effect(seat: Seat, healthy: tuple[Term, ...]) -> tuple[Term, ...]:
        before = []
        for k, value in enumerate(healthy):
            before.append(seat.register(f"last{k}", value.sort, resting(value.sort)))
            seat.then(before[k], value)
        return tuple(joint(seat, (*before[:k], h, *before[k + 1 :]))[k] for k, h in enumerate(healthy))

    return effect if late else joint
