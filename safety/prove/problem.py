"""From a claim to a problem: one system (model, faults, watching registers) and the formulas over it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, cast

from safety.faults import Fault, Faulted, instrument, within
from safety.prove.claims import Claim, Formula, Seen, label, premise_of, watching
from safety.system import ANY, ModelError, State, System, repeat
from safety.terms import Bit
from safety.terms.graph import BIT, Term, describe, postorder, variable, variables
from safety.terms.values import all_of, bit
from safety.tracing import trace


@dataclass(frozen=True)
class Problem:
    """What has to be shown: from `start`, while `given` holds at every step, `holds` at every step.

    `lemmas` read registers only.  `premise` is what has to be reachable for the claim to say anything.
    """

    claim: Claim
    system: System
    faulted: Faulted
    holds: Bit
    premise: Bit
    given: Bit
    start: Bit
    lemmas: dict[str, Bit]

    @property
    def faults(self) -> tuple[Fault, ...]:
        """The faults that may be present."""
        return self.faulted.faults


def build_problem(claim: Claim, settings: dict[str, Any] | None = None) -> Problem:
    """Trace the model, build in the faults, evaluate the claim's formulas.

    Raises `ModelError` (or `TermError`) for a claim that names no signal, a lemma that reads an input, and the like.
    """
    bare = trace(claim.model, {**claim.settings, **(settings or {})}, claim.symbolic)
    if claim.anywhere:
        bare = replace(bare, states=tuple(replace(s, power_up=ANY) for s in bare.states))
    faults = claim.faults.expand(bare) if claim.faults else []
    faulted = instrument(bare, faults, present=None)
    if claim.steps_per_frame > 1:
        faulted = replace(faulted, system=repeat(faulted.system, claim.steps_per_frame))
    seen = Seen(faulted.system, faulted)
    registers: dict[Any, State] = {}

    def formula(f: Formula | None) -> Bit:
        return bit(True) if f is None else watching(registers, f, seen)

    holds, given, start = formula(claim.formula), formula(claim.given), formula(claim.start)
    lemmas = {label(f): formula(f) for f in claim.lemmas}
    system = replace(faulted.system, states=(*faulted.system.states, *registers.values()))
    registers_only = {s.var.uid for s in system.states}
    for name, lemma in [*lemmas.items(), ("start", start)]:
        for v in variables([lemma]):
            if v.uid not in registers_only:
                raise ModelError(f"{claim.id}: {name!r} reads the input {describe(v)}; lemmas and start conditions read registers only")
    if not any(t.op == "var" for t in postorder([holds])):
        raise ModelError(f"{claim.id} names no signal: it says {describe(holds)} whatever the model does")
    budget = within(claim.faults, faulted) if claim.faults else bit(True)
    fixed = _rigid(system, cast(Bit, system.start))
    every_step = all_of(given, budget, fixed, *(cast(Bit, a) for a in system.assumptions.values()))
    return Problem(claim, system, faulted, holds, premise_of(holds), every_step, all_of(start, system.start, budget), lemmas)


def _rigid(system: System, condition: Bit) -> Bit:
    """The condition, if it reads only registers that never change (then it holds at every step); else true."""
    rigid = {s.var.uid for s in system.states if s.next is s.var}
    return condition if all(v.uid in rigid for v in variables([condition])) else bit(True)


def observed(problem: Problem) -> System:
    """The problem's system with `claim.holds`, `claim.premise` and `claim.given` as signals, for replay.

    At the first step `claim.given` includes what the claim says of the start.
    """
    first = cast(Bit, variable("watch.first", BIT))
    given = problem.given & (~first | problem.start)
    extra: dict[str, Term] = {"claim.holds": problem.holds, "claim.premise": problem.premise, "claim.given": given}
    states = (*problem.system.states, State(first, bit(False), True))
    return replace(problem.system, states=states, signals={**problem.system.signals, **extra})


Progress = Callable[[str], None]
