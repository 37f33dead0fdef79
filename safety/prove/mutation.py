"""Mutants of a model, all in one system: a rigid register says which of them is meant, 0 the model as it is.

So one run on lanes, or one question to a solver, is about thousands of mutants at once; a number put in for the
register gives a single mutant.
Source: mutant schemata, R. H. Untch, A. J. Offutt, M. J. Harrold (1993).
"""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from operator import is_
from pathlib import Path
from types import FrameType
from typing import Any, cast

from safety.model import Model
from safety.prove.mutation_operators import Edit, edits
from safety.system import ANY, State, System, substitute
from safety.terms.graph import BIT, Sort, Term, describe, integer, noting, postorder, rewrite, variable
from safety.terms.values import build, const
from safety.tracing import trace

SELECTOR = "which mutant"  # no model has a register of this name: it is no identifier
_PACKAGE = str(Path(inspect.getfile(Model)).parent)


@dataclass(frozen=True)
class Place:
    """Where a term is first written."""

    file: str
    line: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}"


@dataclass(frozen=True)
class Mutant:
    """One change of a model: what was written, what is written instead, and where."""

    number: int
    was: str
    change: str
    place: Place | None
    power_up: tuple[str, Any] | None = None  # a register, and what it holds at power-up instead

    def __str__(self) -> str:
        return f"{self.place or 'unknown place'}: {self.was}: {self.change}"


@dataclass(frozen=True)
class Mutants:
    """A model's mutants, from number 1 up, and the system that is any of them as its register SELECTOR says.

    `trivial`: how many changes gave back the model as it is, or a mutant that there was already.
    """

    system: System
    mutants: tuple[Mutant, ...]
    selector: Term
    trivial: int = 0
    settings: Mapping[str, tuple[tuple[int, Any], ...]] = field(default_factory=dict)

    def __getitem__(self, number: int) -> Mutant:
        return self.mutants[number - 1]

    @cached_property
    def _parts(self) -> re.Pattern[str]:
        paths = {path.rpartition(".")[0] for path in self.system.state} - {""}
        longest_first = sorted(map(re.escape, paths), key=len, reverse=True)
        return re.compile(rf"(?<![\w.])(?:{'|'.join(longest_first)})\.") if paths else re.compile(r"(?!)")

    def as_in_its_part(self, mutant: Mutant) -> str:
        """What was written, names without the parts they are in: the same whatever greater model a part is put in."""
        return self._parts.sub("", mutant.was)

    def some(self, numbers: Collection[int]) -> System:
        """The system of these mutants only."""
        return self.system.mapped(folded(numbers))

    def for_claim(self, bare: System) -> System:
        """The system with all mutants for one claim, whose traced model is `bare`: with its settings, as it starts."""
        fixed: dict[int, Term] = {}
        for path, state in self.system.state.items():
            if path not in bare.state and path != SELECTOR:
                fixed[state.var.uid] = self._setting(path, state.var.sort, bare.settings[path].value)
        kept = tuple(s for s in self.system.states if s.var.uid not in fixed)
        whole = replace(self.system, states=kept).mapped(lambda terms: substitute(terms, fixed))
        return replace(whole, settings=bare.settings, start=bare.start, assumptions=bare.assumptions)

    def _setting(self, path: str, sort: Sort, value: Any) -> Term:
        """A parameter that a claim does not leave open: its value, or what a mutant makes of that."""
        chosen = const(value, sort)
        for number, step in self.settings.get(path, ()):
            if sort.admits(value + step):
                chosen = _choice(self.selector, number, const(value + step, sort), chosen)
        return chosen


def _choice(selector: Term, number: int, mutated: Term, original: Term) -> Term:
    meant = build("eq", (selector, const(number, selector.sort)), None, BIT)
    return build("select", (meant, mutated, original), None, original.sort)


def with_places(
    model: type[Model], settings: Mapping[str, Any], symbolic: Iterable[str]
) -> tuple[System, dict[int, Place]]:
    """The traced model, and where each of its terms is first written in a file outside this package."""
    places: dict[int, Place] = {}

    def note(term: Term) -> None:
        if term.uid not in places:
            found = _written(sys._getframe(2))
            if found is not None:
                places[term.uid] = found

    with noting(note):
        system = trace(model, settings, symbolic)
    order = postorder(system.roots())
    places |= {t.uid: places[t.args[0].uid] for t in order if t.op == "point" and t.args[0].uid in places}
    for term in reversed(order):  # what the trace itself has made: where it is used
        for argument in term.args:
            if argument.uid not in places and term.uid in places:
                places[argument.uid] = places[term.uid]
    return system, places


def _written(frame: FrameType | None) -> Place | None:
    while frame is not None and frame.f_code is not trace.__code__:
        if not frame.f_code.co_filename.startswith(_PACKAGE):
            return Place(frame.f_code.co_filename, frame.f_lineno)
        frame = frame.f_back
    return None


def mutants_of(model: type[Model], symbolic: Iterable[str] = ()) -> Mutants:
    """All mutants of a model whose parameters `symbolic` are left open, those that are alike once.

    Assumptions are no part of the equipment and stay as they are.
    """
    system, places = with_places(model, {}, symbolic)
    found = _Found(system, places)
    for term in postorder(found.roots({})):
        found.at_term(term)
    for state in system.states:
        found.at_register(state)
    selector = variable(SELECTOR, integer(0, len(found.mutants)))
    whole = found.schemata(selector)
    return Mutants(whole, tuple(found.mutants), selector, found.trivial, found.settings)


class _Found:
    """The mutants of a system as they are found, and what each changes."""

    def __init__(self, system: System, places: Mapping[int, Place]) -> None:
        self.system, self.places = system, places
        self.mutants: list[Mutant] = []
        self.at: dict[int, list[tuple[int, Edit]]] = {}
        self.frozen: dict[str, int] = {}
        self.settings: dict[str, tuple[tuple[int, Any], ...]] = {}
        self.trivial = 0
        self.met = {self._identity({}, {})}

    def roots(self, nexts: Mapping[str, Term]) -> list[Term]:
        """All that the system computes, some next registers replaced."""
        system = self.system
        moving = [nexts.get(s.path, s.next) for s in system.states if s.next is not s.var]
        return [*moving, *system.signals.values(), *system.points.values()]

    def _identity(self, instead: Mapping[int, Term], nexts: Mapping[str, Term]) -> tuple[int, ...]:
        """What tells two mutants apart: all that they compute."""

        def rule(old: Term, args: tuple[Term, ...]) -> Term:
            if old.uid in instead:
                return instead[old.uid]
            return old if all(map(is_, args, old.args)) else build(old.op, args, old.attr, old.sort)

        return tuple(t.uid for t in rewrite(self.roots(nexts), rule))

    def _is_new(self, instead: Mapping[int, Term], nexts: Mapping[str, Term]) -> bool:
        identity = self._identity(instead, nexts)
        known = identity in self.met
        self.met.add(identity)
        self.trivial += known
        return not known

    def _add(self, was: str, change: str, near: Term, power_up: tuple[str, Any] | None = None) -> int:
        self.mutants.append(Mutant(len(self.mutants) + 1, was, change, self.places.get(near.uid), power_up))
        return len(self.mutants)

    def at_term(self, term: Term) -> None:
        """The changes of what a term computes."""
        for change, edit in edits(term):
            if self._is_new({term.uid: edit(term.args)}, {}):
                self.at.setdefault(term.uid, []).append((self._add(describe(term), change, term), edit))

    def at_register(self, state: State) -> None:
        """A register that stands still, one that powers up otherwise, a parameter with another value."""
        path, near = state.path, state.var
        if state.next is state.var:
            if path in self.system.settings:
                steps = [(self._add(f"parameter {path}", f"{step:+d}", near), step) for step in (-1, 1)]
                self.settings[path] = tuple(steps)
            return
        if self._is_new({}, {path: state.var}):
            self.frozen[path] = self._add(f"next {path}", "frozen", state.next)
        if state.power_up is not ANY:
            for value in _other_values(state):
                self._add(f"{path} at power-up", f"{value} for {state.power_up}", near, (path, value))

    def schemata(self, selector: Term) -> System:
        """The system that is any of the mutants, as the selector says."""

        def rule(old: Term, args: tuple[Term, ...]) -> Term:
            new = build(old.op, args, old.attr, old.sort) if old.args else old
            for number, edit in self.at.get(old.uid, ()):
                new = _choice(selector, number, edit(args), new)
            return new

        changed = self.system.mapped(lambda roots: rewrite(roots, rule))
        states = [State(selector, selector, ANY)]
        for before, after in zip(self.system.states, changed.states, strict=True):
            following = before.var if before.next is before.var else after.next
            if before.path in self.frozen:
                following = _choice(selector, self.frozen[before.path], before.var, following)
            states.append(replace(after, next=following))
        return replace(changed, states=tuple(states), assumptions=self.system.assumptions)


def _other_values(state: State) -> list[Any]:
    if state.var.sort == BIT:
        return [not state.power_up]
    return [v for v in (cast(Any, state.power_up) - 1, cast(Any, state.power_up) + 1) if state.var.sort.admits(v)]


def meant(term: Term) -> int | None:
    """The mutant whose choice this term is, if it is one."""
    if term.op == "eq" and term.args[0].op == "var" and term.args[0].attr == SELECTOR:
        return cast(int, term.args[1].attr)
    return None


def folded(numbers: Collection[int]) -> Callable[[Sequence[Term]], list[Any]]:
    """A change of terms that leaves the choice between these mutants and folds that of the others away."""

    def rule(old: Term, args: tuple[Term, ...]) -> Term:
        number = meant(old)
        if number is not None:
            return old if number in numbers else const(False, BIT)
        return build(old.op, args, old.attr, old.sort) if old.args else old

    return lambda terms: rewrite(terms, rule)
