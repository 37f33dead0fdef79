"""Fault kinds, and the system that carries them.

A fault is a small machine at one or more points: from the healthy value it makes the value that is seen.  The same
machine serves a run, where a schedule says when it acts, and a proof, where the solver chooses; so what is simulated
and what is proved are the same fault.  No second, faulty copy of a model exists.

    Fault(stuck(1, bit=3), ["ring"])                          present from power-up for ever
    Fault(byzantine(), ["a.*"], onset=ANY_TIME)               every point of part a, from any step on
    Fault(flip(), ["a.latch"], onset=TRANSIENT, ticks=2)      up to two steps, once
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from typing import Any, cast

from safety.kinds import (
    Kind,
    Seat,
    byzantine,
    choose,
    delayed,
    extra,
    flip,
    frozen,
    missing,
    open_circuit,
    stuck,
    welded,
)
from safety.system import ANY, ModelError, State, System, nearest, repeat, substeps, substitute
from safety.terms import Bit, UInt, count, select, word
from safety.terms.graph import BIT, Sort, Term, node, rewrite, uint, variable
from safety.terms.values import any_of, bit, build

__all__ = [
    "ANY_TIME", "FROM_START", "INTERMITTENT", "ONSETS", "PREFIX", "TRANSIENT",
    "Budget", "Fault", "Faulted", "Kind", "Seat",
    "any_active", "any_of_faults", "at_most", "byzantine", "delayed", "every", "expand", "extra", "flip", "frozen",
    "instrument", "matching", "missing", "now_name", "open_circuit", "present_name", "schedule", "stuck", "together",
    "welded", "within",
]  # fmt: skip

PREFIX = "fault"  # of the registers and inputs that faults add
FROM_START, ANY_TIME, TRANSIENT, INTERMITTENT = "from start", "any time", "transient", "intermittent"
ONSETS = (FROM_START, ANY_TIME, TRANSIENT, INTERMITTENT)


@dataclass(frozen=True)
class Fault:
    """A kind at points (full names or patterns such as `a.*`), with its onset.

    `at` and `ticks` fix the schedule of a run, `values` (by point, one a step, the last for ever) what a byzantine
    point reads then; in a proof the onset is free unless it is FROM_START, and `ticks` bounds a transient.  `name`
    identifies the fault in results.
    """

    kind: Kind
    points: Sequence[str]
    onset: str = FROM_START
    at: int = 0
    ticks: int | None = None
    name: str = ""
    values: Mapping[str, Sequence[Any]] | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        if self.onset not in ONSETS:
            raise ModelError(f"fault onset {self.onset!r}; it is one of: {', '.join(ONSETS)}")
        if self.onset == TRANSIENT and (self.ticks is None or self.ticks < 1):
            raise ModelError("a transient fault needs its greatest length: Fault(..., onset=TRANSIENT, ticks=n)")
        if self.onset == FROM_START and self.at:
            raise ModelError(
                f"a fault with at={self.at} is not there from the start: write onset=ANY_TIME or TRANSIENT"
            )
        if self.ticks is not None and self.onset in (FROM_START, ANY_TIME):
            raise ModelError(
                f"a fault {self.onset} stays for ever; ticks={self.ticks} is for TRANSIENT or INTERMITTENT"
            )
        if isinstance(self.points, str):
            object.__setattr__(self, "points", [self.points])
        if not self.name:
            object.__setattr__(self, "name", f"{'+'.join(self.points)} {self.kind}")

    def __str__(self) -> str:
        return self.name if self.onset == FROM_START else f"{self.name}, {self.onset}"


def every(
    kind: Kind, *patterns: str, onset: str = FROM_START, ticks: int | None = None
) -> Callable[[System], list[Fault]]:
    """A fault of its own at each point that fits a pattern."""

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


def matching(system: System, patterns: Iterable[str]) -> list[str]:
    """Full names of the points that fit, each once.  Raises `ModelError` for a pattern that fits none."""
    found: list[str] = []
    for pattern in patterns:
        hits = [p for p in system.points if fnmatchcase(p, pattern)]
        if not hits:
            raise ModelError(f"{system.name} has no point {pattern!r}; {nearest(pattern, system.points)}")
        found += [p for p in hits if p not in found]
    return found


def present_name(index: int) -> str:
    """Name of the register that says whether a fault is in the equipment."""
    return f"{PREFIX}{index}"


def now_name(index: int) -> str:
    """Name of the input that lets a fault of free onset act."""
    return f"{present_name(index)}.now"


@dataclass(frozen=True)
class Faulted:
    """A system with faults.

    `present[i]`: fault i is in the equipment, now or later; `active[i]`: it acts at this step; `acted[i]`: it acted
    before this step (a register; a fault from the start counts as having acted before the first step).
    """

    system: System
    faults: tuple[Fault, ...]
    present: tuple[Bit, ...]
    active: tuple[Bit, ...]
    acted: tuple[Bit, ...]

    @property
    def choices(self) -> list[str]:
        """Names of the inputs that are the faults' free choices."""
        return [name for name in self.system.inputs if _FREE.match(name)]

    @functools.cached_property
    def where(self) -> list[list[str]]:
        """Full names of the points at which each fault acts."""
        return [matching(self.system, fault.points) for fault in self.faults]


_FREE = re.compile(rf"{PREFIX}\d+\.")  # a part of such a name would clash with the registers of a fault


def instrument(system: System, faults: Sequence[Fault], *, present: bool | None = True) -> Faulted:
    """The system with the faults built in at their points.

    `present=True`: all of them are there; `None`: each has a register that says so: any value at power-up, then fixed.
    Raises `ModelError` for a point that does not exist, a kind that does not fit its sort, or a system whose steps
    have been taken together: a fault is built in first.
    """
    for taken in (*system.state, *system.inputs) if faults else ():
        if re.fullmatch(rf"{PREFIX}\d+(\..*)?", taken):
            raise ModelError(f"{system.name}: {taken!r} is a name of the registers of faults; give it another")
    states: list[State] = []
    inputs: dict[str, Term] = {}
    presents: list[Bit] = []
    actives: list[Bit] = []
    acted: list[Bit] = []
    at: dict[str, list[tuple[int, Fault]]] = {}
    for i, fault in enumerate(faults):
        there = bit(True)
        if present is None:
            there = cast(Bit, variable(present_name(i), BIT))
            states.append(State(there, there, ANY))
        active, before, more, free = _activity(fault, i, there)
        states += more
        inputs |= free
        presents.append(there)
        actives.append(active)
        acted.append(before)
        for point in matching(system, fault.points):
            if system.points[point].sort.kind not in fault.kind.sorts:
                raise ModelError(
                    f"fault {fault.name!r}: {fault.kind} does not apply to {point}, a {system.points[point].sort}"
                )
            at.setdefault(point, []).append((i, fault))

    met: set[str] = set()

    def rule(old: Term, args: tuple[Term, ...]) -> Term:
        if not old.args:
            return old
        if old.op != "point":
            return build(old.op, args, old.attr, old.sort)
        seen = args[0]
        for i, fault in at.get(old.attr, ()):
            seat = Seat(f"{present_name(i)}.{old.attr}", actives[i])
            effect = fault.kind.effect(seat, seen)
            if old.attr in met and (seat.states or seat.inputs or fault.onset != FROM_START):
                raise ModelError(
                    f"{system.name} has {old.attr!r} in several steps taken as one; build its fault in before"
                )
            states.extend(seat.states)
            inputs.update(seat.inputs)
            seen = choose(actives[i], effect, seen)
        met.add(old.attr)
        return node("point", (seen,), old.attr, old.sort)

    changed = system.mapped(lambda roots: rewrite(roots, rule))
    whole = replace(changed, states=(*changed.states, *states), inputs={**changed.inputs, **inputs})
    return Faulted(whole, tuple(faults), tuple(presents), tuple(actives), tuple(acted))


def _activity(fault: Fault, index: int, there: Bit) -> tuple[Bit, Bit, list[State], dict[str, Term]]:
    """Whether the fault acts at this step, whether it did before, the registers that decide it, its free choices."""
    name = present_name(index)
    if fault.onset == FROM_START:
        return there, there, [], {}
    chosen = cast(Bit, variable(now_name(index), BIT))
    free: dict[str, Term] = {now_name(index): chosen}
    if fault.onset == TRANSIENT:
        assert fault.ticks is not None
        width = fault.ticks.bit_length()
        used = cast(UInt, variable(f"{name}.used", uint(width)))
        active = there & chosen & (used < fault.ticks)
        spent = select(used > 0, word(fault.ticks, width), used)
        return active, there & (used > 0), [State(used, select(active, (used + 1).low(width), spent), 0)], free
    on = cast(Bit, variable(f"{name}.on", BIT))
    ever = there & (on | chosen)
    return there & chosen if fault.onset == INTERMITTENT else ever, there & on, [State(on, ever, False)], free


def within(budget: Budget, faulted: Faulted) -> Bit:
    """The budget as a condition on which faults are present."""
    if budget.most is None or budget.most >= len(faulted.faults):
        return bit(True)
    return count(*faulted.present) <= budget.most if faulted.present else bit(True)


def any_active(faulted: Faulted, prefix: str = "") -> Bit:
    """Whether a fault of those whose points all lie under a prefix acts now."""
    inside = [all(p.startswith(prefix) for p in points) for points in faulted.where]
    return any_of(*(a for a, own in zip(faulted.active, inside, strict=True) if own))


def together(faulted: Faulted, steps: int) -> Faulted:
    """`steps` steps as one: the inputs of the model are held, what the faults choose is chosen anew at each step.

    `active` then says that the fault acts at one of these steps at least.
    """
    maps = substeps(faulted.system, steps, faulted.choices)
    acting = [substitute(faulted.active, held) for held in maps]
    active = tuple(any_of(*(cast(Bit, a) for a in column)) for column in zip(*acting, strict=True))
    return replace(faulted, system=repeat(faulted.system, steps, faulted.choices), active=active)


def schedule(faulted: Faulted) -> Callable[[int], dict[str, Any]]:
    """The free choices of a run, step by step, from each fault's `at`, `ticks` and `values`; 0 or false else."""
    usual = {name: _least(faulted.system.inputs[name].sort) for name in faulted.choices}
    timed = {now_name(i): fault for i, fault in enumerate(faulted.faults) if now_name(i) in usual}
    given: dict[str, Sequence[Any]] = {}
    for i, fault in enumerate(faulted.faults):
        for point, sequence in (fault.values or {}).items():
            name = f"{present_name(i)}.{point}.value"
            if name not in usual or not sequence:
                raise ModelError(
                    f"fault {fault.name!r} has values for {point!r}, where it chooses none; leave them out"
                )
            given[name] = sequence

    def choices(step: int) -> dict[str, Any]:
        now = {name: _acts(fault, step) for name, fault in timed.items()}
        return usual | now | {name: sequence[min(step, len(sequence) - 1)] for name, sequence in given.items()}

    return choices


def _acts(fault: Fault, step: int) -> bool:
    return step >= fault.at and (fault.ticks is None or step < fault.at + fault.ticks)


def _least(sort: Sort) -> bool | int:
    return False if sort == BIT else sort.low or 0
