"""A system with faults that are switched lane by lane: masks at points, and faults built in, each with a switch."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from safety.faults import INTERMITTENT, Fault, instrument, now_name, schedule
from safety.inject.masks import masked, without_points
from safety.system import System, substitute
from safety.terms.graph import Term
from safety.terms.values import const


@dataclass(frozen=True)
class Tapped:
    """The system, its points with masks left; `masks`: `keep` and `turn` of each of these.

    `switches` say of each fault built in whether it acts; `choices` gives what these faults choose at a step, the same
    in all lanes, up to a last step after which nothing changes (None: it always may).
    """

    system: System
    masks: Mapping[str, tuple[Term, Term]]
    switches: tuple[Term, ...]
    choices: Callable[[int], Mapping[str, Any]]
    changes: int | None

    @property
    def taps(self) -> tuple[Term, ...]:
        """The variables that faults set: of masks, then of switches."""
        return (*(term for pair in self.masks.values() for term in pair), *self.switches)

    def without_faults(self) -> System:
        """The same system while no fault acts; registers of faults are still there."""
        off = {switch.uid: const(False, switch.sort) for switch in self.switches}
        return self.passing().mapped(lambda roots: without_points(substitute(roots, off)))

    def passing(self) -> System:
        """The same system with masks that let everything pass; its points and switches are left."""
        passing = {keep.uid: const(_all(keep), keep.sort) for keep, _ in self.masks.values()}
        passing |= {turn.uid: const(turn.sort.admits(0) and 0, turn.sort) for _, turn in self.masks.values()}
        return self.system.mapped(lambda roots: substitute(roots, passing))


def _all(keep: Term) -> bool | int:
    return True if keep.sort.kind == "bit" else int(keep.sort.bounds[1])


def tapped(system: System, points: Sequence[str], faults: Sequence[Fault] = ()) -> Tapped:
    """A system with masks at `points`, and faults built in: at one point in the order given, masks after them."""
    faulted = instrument(system, [replace(fault, onset=INTERMITTENT, at=0, ticks=None) for fault in faults])
    carried = masked(faulted.system, points)
    inputs = carried.system.inputs
    names = [now_name(i) for i in range(len(faults))]
    choose = schedule(faulted)
    free = [name for name in faulted.choices if name not in names]
    longest = max((len(v) for fault in faults for v in (fault.values or {}).values()), default=1)
    return Tapped(
        replace(carried.system, inputs={n: t for n, t in inputs.items() if n not in names}).mapped(
            partial(without_points, but=carried.variables)
        ),
        carried.variables,
        tuple(inputs[name] for name in names),
        lambda step: {name: value for name, value in choose(step).items() if name in free},
        None if faulted.draws else longest,
    )
