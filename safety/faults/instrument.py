"""The system that carries faults: their effects built in at points and registers."""

from __future__ import annotations

import functools
import itertools
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import cast

from safety.faults.fault import FROM_START, INTERMITTENT, TRANSIENT, Fault
from safety.faults.places import Placed, names_of, placed
from safety.kinds import PART, Part, Seat, choose
from safety.system import ANY, ModelError, State, System, repeat, substeps, substitute
from safety.terms import Bit, UInt, select, word
from safety.terms.graph import BIT, Term, Value, node, postorder, uint, variable, variables
from safety.terms.values import any_of, bit, build

PREFIX = "fault"  # of the registers and inputs that faults add
_FREE = re.compile(rf"{PREFIX}\d+\.")  # a part of such a name would clash with the registers of a fault


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
    before this step (a register; a fault from the start counts as having acted before the first step).  `where[i]`:
    full names of the points and registers at which it acts.  `draws`: what a run chooses by the number of the step, by
    name of the input, where its schedule says nothing.
    """

    system: System
    faults: tuple[Fault, ...]
    present: tuple[Bit, ...]
    active: tuple[Bit, ...]
    acted: tuple[Bit, ...]
    where: tuple[tuple[str, ...], ...] = ()
    draws: Mapping[str, Callable[[int], Value]] = field(default_factory=dict)

    @property
    def choices(self) -> list[str]:
        """Names of the inputs that are the faults' free choices."""
        return [name for name in self.system.inputs if _FREE.match(name)]


def instrument(system: System, faults: Sequence[Fault], *, present: bool | None = True) -> Faulted:
    """The system with the faults built in: at each place in their order, those of registers after those of points.

    `present=True`: all of them are there; `None`: each has a register that says so: any value at power-up, then fixed.
    Raises `ModelError` for a place that does not exist, a kind that does not fit it, joined points that depend on each
    other, or a system whose steps have been taken together: a fault is built in first.
    """
    for taken in (*system.state, *system.inputs) if faults else ():
        if re.fullmatch(rf"{PREFIX}\d+(\..*)?", taken):
            raise ModelError(f"{system.name}: {taken!r} is a name of the registers of faults; give it another")
    work = _Instrument(system)
    acting = [work.activity(i, fault, present) for i, fault in enumerate(faults)]
    there, active, acted = zip(*acting, strict=True) if acting else ((), (), ())
    places = [placed(system, fault) for fault in faults]
    each = [(i, fault, place) for i, fault in enumerate(faults) for place in places[i]]
    for i, fault, place in each:
        if place.kind.place != PART:
            work.at_points(fault, place, Seat(f"{present_name(i)}.{place.names[0]}", active[i]))
    changed = work.with_points_seen()
    for i, fault, place in each:
        if place.kind.place == PART:
            seat = Seat(f"{present_name(i)}.part.{place.names[0]}", active[i])
            changed = work.at_registers(changed, fault, place, seat)
    whole = replace(changed, states=(*changed.states, *work.states), inputs={**changed.inputs, **work.inputs})
    where = tuple(names_of(found) for found in places)
    return Faulted(whole, tuple(faults), there, active, acted, where, work.draws)


class _Instrument:
    """What is built in, place by place.

    `seen` says what is seen at a point, as a term over `healthy`: the variables that stand for what is there without
    faults.  So faults that follow each other, or join points, need no order of the points but their own.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self.states: list[State] = []
        self.inputs: dict[str, Term] = {}
        self.draws: dict[str, Callable[[int], Value]] = {}
        self.healthy: dict[str, Term] = {}
        self.seen: dict[str, Term] = {}
        self.copies: dict[str, list[Term]] = {}
        for term in postorder(system.roots()):
            if term.op == "point":
                self.copies.setdefault(term.attr, []).append(term)

    def activity(self, index: int, fault: Fault, present: bool | None) -> tuple[Bit, Bit, Bit]:
        """Whether a fault is present, whether it acts at this step, whether it did before."""
        name, there = present_name(index), bit(True)
        if present is None:
            there = cast(Bit, variable(name, BIT))
            self.states.append(State(there, there, ANY))
        if fault.onset == FROM_START:
            return there, there, there
        chosen = cast(Bit, variable(now_name(index), BIT))
        self.inputs[now_name(index)] = chosen
        if fault.onset == TRANSIENT:
            assert fault.ticks is not None
            width = fault.ticks.bit_length()
            used = cast(UInt, variable(f"{name}.used", uint(width)))
            active = there & chosen & (used < fault.ticks)
            spent = select(used > 0, word(fault.ticks, width), used)
            self.states.append(State(used, select(active, (used + 1).low(width), spent), 0))
            return there, active, there & (used > 0)
        on = cast(Bit, variable(f"{name}.on", BIT))
        ever = there & (on | chosen)
        self.states.append(State(on, ever, False))
        return there, there & chosen if fault.onset == INTERMITTENT else ever, there & on

    def at_points(self, fault: Fault, place: Placed, seat: Seat) -> None:
        """A kind at a point, or at the points that it joins, after what is there already."""
        for name in place.names:
            if name not in self.copies:
                raise ModelError(f"{self.system.name} has lost its point {name!r}; build its fault in before that")
            if name not in self.seen:
                self.healthy[name] = variable(f"healthy {name}", self.system.points[name].sort)
                self.seen[name] = self.healthy[name]
        before = tuple(self.seen[name] for name in place.names)
        joint = place.kind.joint
        after = joint(seat, before) if joint else (place.kind.effect(seat, before[0]),)
        if joint or seat.states or seat.inputs or fault.onset != FROM_START:
            self._refuse_steps_as_one(place.names)
        for name, chosen in zip(place.names, _chosen(fault, place, seat, after, before), strict=True):
            self.seen[name] = chosen
        self._take(seat)

    def at_registers(self, system: System, fault: Fault, place: Placed, seat: Seat) -> System:
        """A kind at the registers of a part, after what is there already."""
        assert place.kind.update is not None
        self._refuse_steps_as_one(self.copies)
        part = Part(tuple(s for s in system.states if s.path in place.names))
        before = tuple(s.next for s in part.states)
        chosen = _chosen(fault, place, seat, place.kind.update(seat, part), before)
        following = dict(zip(place.names, chosen, strict=True))
        self._take(seat)
        return replace(system, states=tuple(replace(s, next=following.get(s.path, s.next)) for s in system.states))

    def _refuse_steps_as_one(self, points: Iterable[str]) -> None:
        for name in points:
            if len(self.copies[name]) > 1:
                raise ModelError(
                    f"{self.system.name} has {name!r} in several steps taken as one; build its fault in before"
                )

    def _take(self, seat: Seat) -> None:
        self.states += seat.states
        self.inputs |= seat.inputs
        for name, draw in seat.draws.items():
            place = name.partition(".")[2].rpartition(".")[0]
            self.draws[name] = functools.partial(draw, place)

    def with_points_seen(self) -> System:
        """The system with each point showing what is seen there, and the registers of faults fed from what is there."""
        new: dict[int, Term] = {}
        changed = self.system.mapped(lambda roots: self._rewritten(roots, new))
        there = {variable.uid: new[self.copies[p][0].args[0].uid] for p, variable in self.healthy.items()}
        following = substitute([s.next for s in self.states], there)
        self.states = [replace(s, next=term) for s, term in zip(self.states, following, strict=True)]
        return changed

    def _rewritten(self, roots: Sequence[Term], new: dict[int, Term]) -> list[Term]:
        """The terms with each point showing what is seen there, noted in `new` (no recursion: graphs may be deep)."""
        begun: set[int] = set()
        stack = [(root, False) for root in reversed(roots)]
        while stack:
            term, ready = stack.pop()
            if ready:
                new[term.uid] = self._replaced(term, new)
            elif term.uid not in new:
                if term.uid in begun:
                    self._refuse_cycle(term, [t for t, waits in stack if waits])
                begun.add(term.uid)
                stack.append((term, True))
                stack += [(a, False) for a in reversed(self._needed(term)) if a.uid not in new]
        return [new[root.uid] for root in roots]

    def _joined(self, term: Term) -> dict[int, Term]:
        """For a point with faults: what is there without them at the points that it depends on, by their variable."""
        read = {v.uid for v in variables([self.seen[term.attr]])}
        others = {v.uid: self.copies[p][0].args[0] for p, v in self.healthy.items() if v.uid in read}
        return others | {self.healthy[term.attr].uid: term.args[0]}

    def _needed(self, term: Term) -> tuple[Term, ...]:
        return tuple(self._joined(term).values()) if term.op == "point" and term.attr in self.seen else term.args

    def _replaced(self, term: Term, new: Mapping[int, Term]) -> Term:
        if not term.args:
            return term
        if term.op != "point":
            return build(term.op, tuple(new[a.uid] for a in term.args), term.attr, term.sort)
        if term.attr not in self.seen:
            return node("point", (new[term.args[0].uid],), term.attr, term.sort)
        there = {uid: new[healthy.uid] for uid, healthy in self._joined(term).items()}
        return node("point", (substitute([self.seen[term.attr]], there)[0],), term.attr, term.sort)

    def _refuse_cycle(self, term: Term, path: list[Term]) -> None:
        around = path[[t.uid for t in path].index(term.uid) :]
        names: list[str] = []  # from each point to one that it is made of, or meets
        for here, there in zip(around, [*around[1:], term], strict=True):
            if here.op == "point":
                met = [p for p in self.healthy if p != here.attr and self.copies[p][0].args[0] is there]
                names += [here.attr, *met[:1]] if here.attr in self.seen else [here.attr]
        circle = " -> ".join(reversed([names[-1], *names] if names[0] != names[-1] else names))
        raise ModelError(
            f"{self.system.name}: joined points depend on each other within one step: {circle}; "
            "join points with a register between them, or write late=True: each meets the others' last values"
        )


def _chosen(fault: Fault, place: Placed, seat: Seat, after: Sequence[Term], before: Sequence[Term]) -> Iterator[Term]:
    """What an effect gives while the fault acts, what was there else.  Raises `ModelError` where they do not fit."""
    for name, then, otherwise in itertools.zip_longest(place.names, after, before):
        if not isinstance(then, Term) or then.sort != otherwise.sort:
            given = then.sort if isinstance(then, Term) else repr(then)
            raise ModelError(f"fault {fault.name!r}: the effect gives {given} at {name}, a {otherwise.sort}")
        yield choose(seat.active, then, otherwise)


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
