"""What every format writes: the registers, inputs and conditions that a claim depends on, and nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol, cast

from safety.system import ANY, ModelError, State, System
from safety.terms import Bit
from safety.terms.graph import Term, Value, describe, variables
from safety.terms.values import all_of


class Problem(Protocol):
    """What is exported: from `start`, while `given` holds at every step, `holds` at every step.

    `safety.prove.problem.Problem` is one.
    """

    @property
    def system(self) -> System:
        """The system, with the registers that watch."""

    @property
    def holds(self) -> Bit:
        """What has to hold at every step."""

    @property
    def given(self) -> Bit:
        """What is assumed at every step."""

    @property
    def start(self) -> Bit:
        """What is assumed at power-up, of the registers."""

    @property
    def lemmas(self) -> Mapping[str, Bit]:
        """Invariants of the registers."""


@dataclass(frozen=True)
class Transition:
    """A safety problem over the registers and inputs that matter: in no run is `holds` false.

    A run begins with power-up values that satisfy `start`, and `given` is true at each of its steps, the one at which
    `holds` is false included.  `named` are the signals and points that can be told of such a run.
    """

    name: str
    states: tuple[State, ...]
    inputs: tuple[Term, ...]
    start: Bit
    given: Bit
    holds: Bit
    named: Mapping[str, Term]

    @property
    def has_start(self) -> bool:
        """Whether the power-up values are restricted further."""
        return not (self.start.is_const and self.start.attr)


def transition(problem: Problem, lemmas: bool = False, words_as_integers: bool = False) -> Transition:
    """The part of a problem that its verdict depends on.

    With `lemmas` they have to hold as the claim does: they strengthen an induction, and none is taken on trust.  What
    the sorts promise is part of `given`: bounded integers stay in range, and words too where a format has integers
    for them.  For an input and a free power-up value this is what the model says, for any other register it follows,
    as its next value is of its own sort.  Raises `ModelError` where that is not so, and for a start that reads inputs.
    """
    registers = {s.var.uid: s for s in problem.system.states}
    holds = all_of(problem.holds, *(problem.lemmas.values() if lemmas else ()))
    edge: list[Term] = [*variables([problem.start, problem.given, holds])]
    met = {v.uid for v in edge}
    for v in edge:  # grows while it is walked
        if v.uid in registers:
            new = [w for w in variables([_next(registers[v.uid])]) if w.uid not in met]
            edge += new
            met |= {w.uid for w in new}
    states = tuple(s for s in problem.system.states if s.var.uid in met)
    inputs = tuple(sorted((v for v in edge if v.uid not in registers), key=lambda v: str(v.attr)))
    for v in variables([problem.start]):
        if v.uid not in registers:
            raise ModelError(f"the start reads the input {describe(v)}; let it read registers only")
    bounded = ("int", "uint") if words_as_integers else ("int",)
    ranges = [_in_range(v) for v in (*(s.var for s in states), *inputs) if v.sort.kind in bounded]
    given = all_of(problem.given, *ranges)
    return Transition(problem.system.name, states, inputs, problem.start, given, holds, _named(problem.system, met))


def power_up(state: State) -> Value | None:
    """What a register holds at power-up; None when it may hold anything."""
    return None if state.power_up is ANY else cast(Value, state.power_up)


def _named(system: System, met: set[int]) -> dict[str, Term]:
    """Signals and points that read nothing but what the verdict depends on, by full name."""
    known = {**system.points, **system.signals}
    return {
        path: term
        for path, term in known.items()
        if path not in system.state and path not in system.inputs and all(v.uid in met for v in variables([term]))
    }


def _next(state: State) -> Term:
    if state.next.sort != state.var.sort:
        raise ModelError(f"{state.path} is {state.var.sort}, its next value {state.next.sort}: bring it to one sort")
    return state.next


def _in_range(variable: Any) -> Bit:
    """What the sort of a number promises."""
    low, high = variable.sort.bounds
    return cast(Bit, (variable >= low) & (variable <= high))
