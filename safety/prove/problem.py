"""From a claim to a problem: one system (model, faults, watching registers) and the formulas over it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any, cast

from safety.faults import Fault, Faulted, instrument, together, within
from safety.prove.claims import Claim, Formula, Seen, label, premises_of, watching
from safety.system import ANY, ModelError, State, System, substitute
from safety.terms import Bit
from safety.terms.graph import BIT, Term, describe, postorder, variable, variables
from safety.terms.values import all_of, any_of, bit
from safety.tracing import trace


@dataclass(frozen=True)
class Problem:
    """What has to be shown: from `start`, while `given` holds at every step, `holds` at every step.

    `lemmas` read registers only.  Each of the `premises` has to be reachable for the claim to say all that it says.
    """

    claim: Claim
    system: System
    faulted: Faulted
    holds: Bit
    premises: tuple[Bit, ...]
    given: Bit
    start: Bit
    lemmas: dict[str, Bit]

    @property
    def faults(self) -> tuple[Fault, ...]:
        """The faults that may be present."""
        return self.faulted.faults

    @property
    def premise(self) -> Bit:
        """Whether one of the premises is met; constantly true for a claim without."""
        return any_of(*self.premises)


Change = Callable[[System], System]


def as_written(system: System) -> System:
    """No change of the model."""
    return system


def build_problem(claim: Claim, settings: dict[str, Any] | None = None, change: Change = as_written) -> Problem:
    """Trace the model, `change` it (for mutants of it), build in the faults, evaluate the claim's formulas.

    Raises `ModelError` (or `TermError`) for a claim that names no signal, a lemma that reads an input, and the like.
    """
    bare = change(trace(claim.model, {**(settings or {}), **claim.settings}, claim.symbolic))
    if claim.anywhere:
        bare = replace(bare, states=tuple(replace(s, power_up=ANY) for s in bare.states))
    faulted = equipped(claim, bare, claim.steps_per_frame)
    seen = Seen(faulted.system, faulted)
    registers: dict[Any, State] = {}

    def formula(f: Formula | None) -> Bit:
        return bit(True) if f is None else watching(registers, f, seen)

    holds, given, start = formula(claim.formula), formula(claim.given), formula(claim.start)
    lemmas: dict[str, Bit] = {}
    for f in claim.lemmas:
        lemmas[_unused(label(f), lemmas)] = formula(f)
    system = replace(faulted.system, states=(*faulted.system.states, *registers.values()))
    _check_variables(claim, system, holds, given, {**lemmas, "start": start})
    budget = within(claim.faults, faulted) if claim.faults else bit(True)
    assumed = (cast(Bit, a) for a in system.assumptions.values())
    every_step = all_of(given, budget, _rigid(system, system.start), *assumed)
    premises = tuple(premises_of(holds))
    return Problem(claim, system, faulted, holds, premises, every_step, all_of(start, system.start, budget), lemmas)


def equipped(claim: Claim, bare: System, steps: int = 1) -> Faulted:
    """The model with the claim's faults, each of which may be present, `steps` of its steps taken as one."""
    faults = claim.faults.expand(bare) if claim.faults else []
    names = [f.name for f in faults]
    for name in names:
        if names.count(name) > 1:
            raise ModelError(
                f"{claim.id}: two faults are called {name!r}; give one a name of its own: Fault(..., name=...)"
            )
    faulted = instrument(bare, faults, present=None)
    _check_assumptions(claim, bare, faulted)
    return faulted if steps == 1 else together(faulted, steps)


def _check_assumptions(claim: Claim, bare: System, faulted: Faulted) -> None:
    """Refuse a model's assumption that a fault can break: assumed at every step, it would hold the fault to it."""
    healthy = {s.var.uid for s in bare.states} | {v.uid for v in bare.inputs.values()}
    following = {s.var.uid: s.next for s in faulted.system.states}
    for text, assumption in faulted.system.assumptions.items():
        met: set[int] = set()
        edge = variables([assumption])
        for v in edge:  # grows while it is walked
            if v.uid not in healthy:
                raise ModelError(
                    f"{claim.id}: faults reach what the model assumes, {text!r}, and would be held to it; "
                    "assume it of inputs only, or say it in given="
                )
            if v.uid in following and v.uid not in met:
                edge += [w for w in variables([following[v.uid]]) if w.uid not in met]
            met.add(v.uid)


def _unused(name: str, taken: Iterable[str]) -> str:
    """The name, numbered where it is taken already."""
    number = sum(t == name or t.startswith(f"{name} (") for t in taken)
    return f"{name} ({number + 1})" if number else name


def _check_variables(claim: Claim, system: System, holds: Bit, given: Bit, on_registers: dict[str, Bit]) -> None:
    """Refuse a constant claim, terms of another model, and lemmas and start conditions that read inputs."""
    if not any(t.op in ("var", "point") for t in postorder([holds])):
        raise ModelError(f"{claim.id} names no signal: it says {describe(holds)} whatever the model does")
    registers = {s.var.uid for s in system.states}
    inputs = {v.uid for v in system.inputs.values()}
    for v in variables([holds, given, *on_registers.values()]):
        if v.uid not in registers and v.uid not in inputs:
            raise ModelError(f"{claim.id} reads {describe(v)}, which {system.name} does not have; take it from `s`")
    for name, condition in on_registers.items():
        for v in variables([condition]):
            if v.uid not in registers:
                raise ModelError(
                    f"{claim.id}: {name!r} reads the input {describe(v)}; lemmas and start read registers only"
                )


def _rigid(system: System, condition: Bit) -> Bit:
    """The condition, if it reads only registers that never change (then it holds at every step); else true."""
    rigid = {s.var.uid for s in system.states if s.next is s.var}
    return condition if all(v.uid in rigid for v in variables([condition])) else bit(True)


def premise_name(problem: Problem, index: int) -> str:
    """The signal of a premise in a run."""
    return "claim.premise" if len(problem.premises) == 1 else f"claim.premise{index}"


def observed(problem: Problem) -> System:
    """The problem's system with `claim.holds`, `claim.premise` and `claim.given` as signals, for replay.

    At the first step `claim.given` includes what the claim says of the start.  Of several premises, each has a signal.
    """
    first = cast(Bit, variable("watch.first", BIT))
    given = problem.given & (~first | problem.start)
    extra: dict[str, Term] = {"claim.holds": problem.holds, "claim.premise": problem.premise, "claim.given": given}
    extra |= {premise_name(problem, i): premise for i, premise in enumerate(problem.premises)}
    states = (*problem.system.states, State(first, bit(False), True))
    return replace(problem.system, states=states, signals={**problem.system.signals, **extra})


Progress = Callable[[str], None]


def named_in(problem: Problem) -> dict[str, Term]:
    """The signals that the claim's formula mentions, by full name."""
    names = {problem.system.lookup(p).uid: p for p in problem.system.names()}
    found: dict[str, Term] = {}
    edge: list[Term] = [problem.holds]
    walked = {problem.holds.uid}
    for term in edge:  # grows while it is walked; a named term hides what it is made of
        if term.uid in names and term is not problem.holds:
            found.setdefault(names[term.uid], term)
        else:
            edge += [a for a in term.args if a.uid not in walked]
            walked |= {a.uid for a in term.args}
    return found


def without_model(problem: Problem) -> Bit:
    """The claim's formula with its signals cut loose from the model: valid if it holds whatever any model does."""
    loose = {term.uid: variable(f"any {name}", term.sort) for name, term in named_in(problem).items()}
    return cast(Bit, substitute([problem.holds], loose)[0])
