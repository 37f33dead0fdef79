"""Fault kinds, and the system that carries them.

A fault is a small machine at one or more points: from the healthy value it makes the value that is seen.  The same
machine serves a run, where a schedule says when it acts, and a proof, where the solver chooses; so what is simulated
and what is proved are the same fault.  No second, faulty copy of a model exists.

    Fault(stuck(1, bit=3), ["ring"])                          present from power-up for ever
    Fault(byzantine(), ["a.*"], onset=ANY_TIME)               every point of part a, from any step on
    Fault(flip(), ["a.latch"], onset=TRANSIENT, ticks=2)      up to two steps, once
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from typing import Any, cast

from safety.system import ANY, ModelError, PowerUpValue, State, System, nearest
from safety.terms import Bit, UInt, count, select
from safety.terms.graph import BIT, Sort, Term, node, rewrite, uint, variable
from safety.terms.values import any_of, bit, build, const

FROM_START, ANY_TIME, TRANSIENT, INTERMITTENT = "from start", "any time", "transient", "intermittent"
ONSETS = (FROM_START, ANY_TIME, TRANSIENT, INTERMITTENT)


class Seat:
    """What a fault's effect is built from: whether it acts now, memory, and free choices."""

    def __init__(self, name: str, active: Bit) -> None:
        self.name, self.active = name, active
        self.states: list[State] = []
        self.inputs: dict[str, Term] = {}

    def register(self, label: str, sort: Sort, start: PowerUpValue) -> Term:
        """A register of the fault; give its next value with `then`."""
        var = variable(f"{self.name}.{label}", sort)
        self.states.append(State(var, var, start))
        return var

    def then(self, register: Term, value: Term) -> None:
        """The register's next value."""
        self.states = [replace(s, next=value) if s.var is register else s for s in self.states]

    def free(self, label: str, sort: Sort) -> Term:
        """A value chosen anew at every step: by the schedule of a run, by the solver in a proof."""
        self.inputs[f"{self.name}.{label}"] = variable(f"{self.name}.{label}", sort)
        return self.inputs[f"{self.name}.{label}"]


Effect = Callable[[Seat, Term], Term]


@dataclass(frozen=True)
class Kind:
    """A way to fail: name, meaning, the sorts it applies to, and its effect while active."""

    name: str
    meaning: str
    effect: Effect
    sorts: tuple[str, ...] = ("bit", "uint", "int", "real")

    def __str__(self) -> str:
        return self.name


def _mask(sort: Sort, number: int | None) -> int:
    if number is not None and not 0 <= number < sort.width:
        raise ModelError(f"a point of {sort} has bits 0..{sort.width - 1}, not bit {number}")
    return (1 << sort.width) - 1 if number is None else 1 << number


def stuck(value: int, bit: int | None = None) -> Kind:
    """Stuck-at: the wire, one bit of the word, or (without `bit`) the whole word reads `value` (0 or 1)."""
    if value not in (0, 1):
        raise ModelError(f"stuck({value!r}): a wire is stuck at 0 or at 1")

    def effect(_: Seat, healthy: Term) -> Term:
        if healthy.sort == BIT:
            return const(bool(value), BIT)
        word, mask = cast(UInt, healthy), _mask(healthy.sort, bit)
        return word | mask if value else word & (healthy.sort.bounds[1] & ~mask)

    place = "" if bit is None else f" bit {bit}"
    return Kind(f"stuck-at-{value}{place}", f"reads {value} whatever the equipment does", effect, ("bit", "uint"))


def flip(bit: int | None = None) -> Kind:
    """Bit flip: the wire, one bit, or all bits of the word are inverted."""

    def effect(_: Seat, healthy: Term) -> Term:
        return ~cast(Bit, healthy) if healthy.sort == BIT else cast(UInt, healthy) ^ _mask(healthy.sort, bit)

    return Kind("flip" if bit is None else f"flip bit {bit}", "reads the opposite", effect, ("bit", "uint"))


def frozen() -> Kind:
    """Frozen: the value seen at the last healthy step stays."""

    def effect(seat: Seat, healthy: Term) -> Term:
        last = seat.register("last", healthy.sort, ANY)
        seat.then(last, _choose(seat.active, last, healthy))
        return last

    return Kind("frozen", "keeps the last healthy value (at power-up: any value)", effect)


def delayed(ticks: int) -> Kind:
    """Delayed: the value of `ticks` steps ago is seen."""
    if ticks < 1:
        raise ModelError(f"delayed({ticks}): a delay is 1 step or more")

    def effect(seat: Seat, healthy: Term) -> Term:
        low: PowerUpValue = False if healthy.sort == BIT else 0 if healthy.sort.admits(0) else healthy.sort.bounds[0]
        value = healthy
        for k in range(ticks):
            stage = seat.register(f"stage{k}", healthy.sort, low)
            seat.then(stage, value)
            value = stage
        return value

    return Kind(f"delayed by {ticks}", f"shows the value of {ticks} steps before (at first: 0)", effect)


def missing(pulses: int = 1) -> Kind:
    """Missing pulses: while active, the first `pulses` pulses do not come."""

    def effect(seat: Seat, healthy: Term) -> Term:
        width = max(pulses.bit_length(), 1)
        lost = cast(UInt, seat.register("lost", uint(width), 0))
        swallow = cast(Bit, healthy) & seat.active & (lost < pulses)
        seat.then(lost, select(swallow, (lost + 1).low(width), lost))
        return healthy & ~swallow  # type: ignore[operator,no-any-return]

    return Kind(f"{pulses} missing pulse(s)", f"the first {pulses} pulse(s) are lost", effect, ("bit",))


def extra() -> Kind:
    """Extra pulse: one pulse too many at the step at which the fault becomes active."""

    def effect(seat: Seat, healthy: Term) -> Term:
        before = cast(Bit, seat.register("before", BIT, False))
        seat.then(before, seat.active)
        return cast(Bit, healthy) | (seat.active & ~before)

    return Kind("extra pulse", "one pulse more, at onset", effect, ("bit",))


def open_circuit() -> Kind:
    """Open: a broken wire or an open coil or contact; de-energised, reads 0."""
    return Kind("open", "de-energised for ever: broken wire, open coil or contact", lambda _, h: const(False, BIT), ("bit",))


def welded() -> Kind:
    """Welded: a contact that cannot open any more; reads 1."""
    return Kind("welded", "the contact stays closed", lambda _, h: const(True, BIT), ("bit",))


def byzantine() -> Kind:
    """Byzantine: any value at every step, differently at every point."""
    return Kind("byzantine", "any value at every step", lambda seat, healthy: seat.free("value", healthy.sort))


def _choose(condition: Bit, then: Term, otherwise: Term) -> Term:
    return build("select", (condition, then, otherwise), None, then.sort)


@dataclass(frozen=True)
class Fault:
    """A kind at points (full names or patterns such as `a.*`), with its onset.

    `at` and `ticks` fix the schedule of a run; in a proof the onset is free unless it is FROM_START, and `ticks`
    bounds a transient.  `name` identifies the fault in results.
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
        if isinstance(self.points, str):
            object.__setattr__(self, "points", [self.points])
        if not self.name:
            object.__setattr__(self, "name", f"{'+'.join(self.points)} {self.kind}")

    def __str__(self) -> str:
        return self.name if self.onset == FROM_START else f"{self.name}, {self.onset}"


def every(kind: Kind, *patterns: str, onset: str = FROM_START, ticks: int | None = None) -> Callable[[System], list[Fault]]:
    """A fault of its own at each point that fits a pattern."""

    def expand(system: System) -> list[Fault]:
        return [Fault(kind, [p], onset, ticks=ticks) for p in _matching(system, patterns) if system.points[p].sort.kind in kind.sorts]

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
            raise ModelError(f"{system.name} has no part of kind {faults!r}; {nearest(faults, {k.lower() for k in system.parts.values()})}")
        return [Fault(byzantine(), [f"{path}.*"], ANY_TIME, name=path) for path in hit]
    if callable(faults):
        return cast(list[Fault], faults(system))
    return [f for item in faults for f in ([item] if isinstance(item, Fault) else expand(system, item))]


def _matching(system: System, patterns: Iterable[str]) -> list[str]:
    found: list[str] = []
    for pattern in patterns:
        hits = [p for p in system.points if fnmatchcase(p, pattern)]
        if not hits:
            raise ModelError(f"{system.name} has no point {pattern!r}; {nearest(pattern, system.points)}")
        found += [p for p in hits if p not in found]
    return found


def present_name(index: int) -> str:
    """Name of the register that says whether a fault is in the equipment."""
    return f"fault{index}"


@dataclass(frozen=True)
class Faulted:
    """A system with faults.

    `present[i]`: fault i is in the equipment, now or later; `active[i]`: it acts at this step; `acted[i]`: it acted
    before this step (a register, where its onset is free).
    """

    system: System
    faults: tuple[Fault, ...]
    present: tuple[Bit, ...]
    active: tuple[Bit, ...]
    acted: tuple[Bit, ...]


def instrument(system: System, faults: Sequence[Fault], *, present: bool | None = True) -> Faulted:
    """The system with the faults built in at their points.

    `present=True`: all of them are there; `None`: each has a register that says so, any value at power-up, never changing.
    Raises `ModelError` for a point that does not exist or a kind that does not fit its sort.
    """
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
        for point in _matching(system, fault.points):
            if system.points[point].sort.kind not in fault.kind.sorts:
                raise ModelError(f"fault {fault.name!r}: {fault.kind} does not apply to {point}, a {system.points[point].sort}")
            at.setdefault(point, []).append((i, fault))

    def rule(old: Term, args: tuple[Term, ...]) -> Term:
        if not old.args:
            return old
        if old.op != "point":
            return build(old.op, args, old.attr, old.sort)
        seen = args[0]
        for i, fault in at.get(old.attr, ()):
            seat = Seat(f"{present_name(i)}.{old.attr}", actives[i])
            effect = fault.kind.effect(seat, seen)
            states.extend(seat.states)
            inputs.update(seat.inputs)
            seen = _choose(actives[i], effect, seen)
        return node("point", (seen,), old.attr, old.sort)

    changed = system.mapped(lambda roots: rewrite(roots, rule))
    whole = replace(changed, states=(*changed.states, *states), inputs={**changed.inputs, **inputs})
    return Faulted(whole, tuple(faults), tuple(presents), tuple(actives), tuple(acted))


def _activity(fault: Fault, index: int, there: Bit) -> tuple[Bit, Bit, list[State], dict[str, Term]]:
    """Whether the fault acts at this step, whether it did before, the registers that decide it, its free choices."""
    name = present_name(index)
    if fault.onset == FROM_START:
        return there, there, [], {}
    chosen = cast(Bit, variable(f"{name}.now", BIT))
    free: dict[str, Term] = {f"{name}.now": chosen}
    if fault.onset == INTERMITTENT:
        return there & chosen, there, [], free
    if fault.onset == ANY_TIME:
        on = cast(Bit, variable(f"{name}.on", BIT))
        active = there & (on | chosen)
        return active, there & on, [State(on, active, False)], free
    assert fault.ticks is not None
    width = fault.ticks.bit_length()
    used = cast(UInt, variable(f"{name}.used", uint(width)))
    active = there & chosen & (used < fault.ticks)
    spent = select(used > 0, const_word(fault.ticks, width), used)
    return active, there & (used > 0), [State(used, select(active, (used + 1).low(width), spent), 0)], free


def const_word(value: int, width: int) -> UInt:
    """A constant word."""
    return cast(UInt, const(value, uint(width)))


def within(budget: Budget, faulted: Faulted) -> Bit:
    """The budget as a condition on which faults are present."""
    if budget.most is None or budget.most >= len(faulted.faults):
        return bit(True)
    return count(*faulted.present) <= budget.most if faulted.present else bit(True)


def any_active(faulted: Faulted, prefix: str = "") -> Bit:
    """Whether a fault of those whose points all lie under a prefix acts now."""
    return any_of(*(a for f, a in zip(faulted.faults, faulted.active, strict=True) if all(p.startswith(prefix) for p in f.points)))


def schedule(faulted: Faulted) -> Callable[[int], dict[str, Any]]:
    """The free choices of a run, step by step, from each fault's `at`, `ticks` and `values`."""
    def choices(step: int) -> dict[str, Any]:
        row: dict[str, Any] = {}
        for i, fault in enumerate(faulted.faults):
            acts = step >= fault.at and (fault.ticks is None or step < fault.at + fault.ticks)
            row[f"{present_name(i)}.now"] = acts
            for name, term in faulted.system.inputs.items():
                if name.startswith(f"{present_name(i)}.") and name.endswith(".value"):
                    point = name[len(present_name(i)) + 1 : -len(".value")]
                    values = (fault.values or {}).get(point)
                    low = False if term.sort == BIT else term.sort.low or 0
                    row[name] = values[min(step, len(values) - 1)] if values else low
        return {name: row[name] for name in row if name in faulted.system.inputs}

    return choices
