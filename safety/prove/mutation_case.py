"""A model's claims, each ready for questions about all mutants of the model at once."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, cast

from safety.faults import Faulted
from safety.kinds import GROUP, PART
from safety.prove.claims import PROVED, REFUTED, Claim, Scenario, Seen
from safety.prove.engines.engine import in_integers, uses_reals
from safety.prove.mutation import SELECTOR, Mutant, Mutants, mutants_of
from safety.prove.mutation_drive import Drive
from safety.prove.mutation_questions import cone, still_proved, with_open_power_up
from safety.prove.mutation_runs import Course, Replay, courses, only, single
from safety.prove.outcome import Limits
from safety.prove.problem import Change, Problem, build_problem
from safety.prove.prove import decide
from safety.prove.refinement import build_refinement
from safety.prove.solve import Disagreement
from safety.prove.synthesis.synthesise import synthesise
from safety.system import System
from safety.terms import Bit, all_of, bit
from safety.terms.graph import variables
from safety.tracing import trace

AT_HAND = 32  # steps: a shorter run is replayed with all mutants at hand, a longer one on the mutant by itself
SYNTHESIS = 30.0  # seconds for finding the lemmas of a claim


@dataclass(eq=False)
class Case:
    """A claim with all mutants of its model."""

    claim: Claim
    mutants: Mutants
    timeout: float
    twins: Sequence[Scenario] = ()  # of twins that assume the same

    @cached_property
    def stated(self) -> Problem:
        """The claim's problem, about the mutant that SELECTOR says."""
        return self._built(self.mutants.for_claim)

    @cached_property
    def as_written(self) -> Problem:
        """The claim's problem without mutants."""
        return single(self.stated, None)

    @cached_property
    def integers(self) -> bool:
        """Whether obligations are read in integers."""
        return in_integers(self.as_written)

    @property
    def unconditional(self) -> bool:
        """Whether the claim is about all runs of the healthy model, step by step."""
        claim = self.claim
        by_steps = claim.steps_per_frame == 1 and claim.refinement is None
        return claim.given is None and claim.start is None and not claim.settings and by_steps

    @cached_property
    def untouched(self) -> set[int]:
        """Registers of the model, by variable, that hold in the claim's runs what they hold in healthy ones.

        No fault, no other setting and no start in any state reaches what they depend on.
        """
        c, healthy = self.claim, trace(self.claim.model, {}, self.claim.symbolic).state
        every = {s.var.uid for s in healthy.values()}
        if c.refinement is not None:
            return set()
        if not (c.faults or c.anywhere or c.settings):
            return every
        now = self.as_written.system.state
        same = {p for p, s in healthy.items() if p in now and now[p].next is s.next and now[p].power_up == s.power_up}
        kept = {healthy[p].var.uid for p in same}
        reads = {s.var.uid: {v.uid for v in variables([s.next])} & every for s in healthy.values()}
        while lost := {uid for uid in kept if not reads[uid] <= kept}:
            kept -= lost
        return kept

    @cached_property
    def sees(self) -> set[int]:
        """The mutants that the claim depends on; on others it is as true as on the model."""
        numbers, registers = cone(replace(self.stated, lemmas={}))
        return numbers | {m.number for m in self.mutants.mutants if m.power_up and m.power_up[0] in registers}

    @cached_property
    def restarting(self) -> set[int]:
        """Mutants that power up otherwise where a fault of the claim puts that value into the register again.

        The system of all mutants has the value as written there: such a mutant is asked about by itself (`single`).
        """
        if not any(fault.kind.place in (PART, GROUP) for fault in self.stated.faults):
            return set()
        told = {m.number: m.power_up for m in self.mutants.mutants if m.power_up}
        other, state = self._powering_up(dict(told.values())).system.state, self.stated.system.state
        return {n for n, (path, _) in told.items() if path in state and state[path].next is not other[path].next}

    def single(self, mutant: Mutant) -> Problem:
        """The claim's problem about one mutant, as if the model had been written so."""
        if mutant.power_up is None or mutant.number not in self.restarting:
            return single(self.stated, mutant)
        return single(self._powering_up(dict([mutant.power_up])), mutant)

    def _powering_up(self, values: Mapping[str, Any]) -> Problem:
        """The claim's problem, some registers with other values at power-up before faults are built in."""

        def change(bare: System) -> System:
            whole = self.mutants.for_claim(bare)
            return replace(
                whole, states=tuple(replace(s, power_up=values.get(s.path, s.power_up)) for s in whole.states)
            )

        return self._built(change)

    def _built(self, change: Change) -> Problem:
        build = build_refinement if self.claim.refinement is not None else build_problem
        return build(self.claim, change=change)

    @cached_property
    def courses(self) -> list[Course]:
        """The runs that the claim is known by."""
        return list(courses(self.as_written, uses_reals(self.as_written), self.timeout, self.twins))

    @cached_property
    def problem(self) -> Problem:
        """The same with lemmas that the tool finds where the claim brings none and is not proved without."""
        problem = self.stated
        if problem.lemmas or self.claim.expect != PROVED or still_proved(problem, (), self.integers, self.timeout):
            return problem
        found = synthesise(self.as_written, SYNTHESIS)
        if found.depth is not None:
            return replace(problem, lemmas=found.lemmas)
        by_others = decide(self.as_written, Limits(self.timeout, synthesis=0)).problem  # an engine's invariant
        return replace(problem, lemmas=by_others.lemmas if by_others is not None else {})

    @cached_property
    def proved(self) -> bool:
        """Whether its lemmas are proved, with the claim, of the model as written."""
        return still_proved(self.problem, (), self.integers, self.timeout) is not None

    def some(self, numbers: Collection[int]) -> Problem:
        """The problem of a few mutants, with what their registers hold at power-up."""
        return with_open_power_up(only(self.problem, numbers), [self.mutants[n] for n in sorted(numbers) if n])


def judged(claims: Sequence[Claim]) -> list[Claim]:
    """The claims that can notice a mutant: those that are proved or refuted as written."""
    return [claim for claim in claims if claim.expect in (PROVED, REFUTED)]


def mutants_for(claims: Sequence[Claim]) -> Mutants:
    """The mutants of the model that some claims are about; parameters that one of them changes are left open."""
    return mutants_of(claims[0].model, sorted({path for c in claims for path in (*c.symbolic, *c.settings)}))


def assumed(claim: Claim) -> tuple[object, ...]:
    """All that a run of a claim has to keep, and how it is read."""
    c = claim
    return c.faults, c.given, c.start, c.symbolic, c.settings, c.anywhere, c.steps_per_frame, c.refinement


def twins_of(claim: Claim, claims: Sequence[Claim]) -> list[Scenario]:
    """The scenarios of the claim's twins, where they are runs of the claim too."""
    some = [c for c in claims if c.twin_of == claim.id and c.model is claim.model and assumed(c) == assumed(claim)]
    return [c.scenario for c in some if c.scenario is not None]


class Subject:
    """A model with the claims on it, ready to examine mutants of it; `timeout` in seconds for each question."""

    def __init__(self, claims: Sequence[Claim], timeout: float = 20.0) -> None:
        self.timeout = timeout
        self.claims = judged(claims)
        self.mutants = mutants_for(self.claims)
        self.open = {path for c in self.claims for path in (*c.symbolic, *c.settings)}
        cases = [Case(c, self.mutants, timeout, twins_of(c, self.claims)) for c in self.claims]
        self.proved = [case for case in cases if case.claim.expect == PROVED]
        self.refuted = [case for case in cases if case.claim.expect == REFUTED]
        self.panels = panels(self.proved, [case for case in self.refuted if case.claim.scenario is not None])

    def healthy(self, numbers: Collection[int]) -> Problem:
        """These mutants of the healthy model, in all its runs: a problem that claims nothing."""
        system = self.mutants.some(numbers)
        given = all_of(system.start, *(cast(Bit, a) for a in system.assumptions.values()))
        faulted = Faulted(system, (), (), (), ())
        return Problem(self.claims[0], system, faulted, bit(True), (), given, system.start, {})


# --- claims side by side ----------------------------------------------------------------------------------------------


@dataclass(eq=False)
class Panel:
    """Claims that assume the same, as one problem that holds where all of them do: one run tells of all at once."""

    cases: list[Case]
    scripted: Sequence[Case]  # other claims on the model that are known by a scenario

    @cached_property
    def problem(self) -> Problem:
        """The problem of all of them, about the mutant that SELECTOR says; without lemmas."""
        first, terms = self.cases[0], list[Bit]()
        if first.claim.refinement is not None:
            return replace(first.stated, lemmas={})

        def formula(s: Seen) -> Bit:
            terms.extend(case.claim.formula(s) for case in self.cases)
            return all_of(*terms)

        whole = build_problem(replace(first.claim, formula=formula, lemmas=()), change=first.mutants.for_claim)
        signals = {**whole.system.signals, **dict(zip(self.names, terms, strict=True))}
        return replace(whole, system=replace(whole.system, signals=signals))

    @property
    def names(self) -> list[str]:
        """The signal of each claim."""
        if self.cases[0].claim.refinement is not None:
            return ["claim.holds"]
        return [f"claim.{case.claim.id}" for case in self.cases]

    @cached_property
    def drive(self) -> Drive:
        """Runs for it, beginning with those that its claims are known by, and the scripted ones of the model."""
        known = [(list(c.as_written.system.inputs), k) for c in (*self.cases, *self.scripted) for k in c.courses]
        return Drive(self.problem, known)

    @cached_property
    def replay(self) -> Replay:
        """The Python reading of all mutants."""
        return Replay(self.problem, self.names)

    def broken_by(self, mutant: Mutant, course: Course, step: int) -> Case:
        """The claim that a mutant breaks at a step of a course, on the Python reading; `Disagreement` without."""
        if step < AT_HAND and mutant.power_up is None:
            chosen = replace(course, start=course.start | {SELECTOR: mutant.number})
            found = self.replay.broken(chosen, step)
        else:
            found = Replay(single(self.problem, mutant), self.names).broken(course, step)
        if not found:
            raise Disagreement(f"lanes and the Python reading differ on {mutant} at step {step}")
        return self.cases[self.names.index(found[0])]


def panels(cases: Sequence[Case], scripted: Sequence[Case]) -> list[Panel]:
    """The claims in groups, by what they assume."""
    found: list[tuple[tuple[object, ...], list[Case]]] = []
    for case in cases:
        key = assumed(case.claim)
        alike = next((some for known, some in found if known == key and case.claim.refinement is None), None)
        if alike is None:
            found.append((key, [case]))
        else:
            alike.append(case)
    return [Panel(some, scripted) for _, some in found]
