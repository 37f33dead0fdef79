"""Mutation coverage of proofs: would the claims on a model notice if the model said something else?

Each mutant of a model (`safety.prove.mutation`) is put to all claims on that model:

    counterexample  a proved claim is false in a run of the mutant
    twin            a claim that must be refuted no longer is: not by its known run, nor by a search at least as long
    proof lost      a proof no longer goes through with the same lemmas; it is not shown whether a claim would notice
    equivalent      the mutant steps as the model does, in every state that matters: shown by a solver
    slack           all proofs go through, yet there is a run in which registers or outputs differ
    undecided       none of these could be shown
    unclaimed       no claim on the model depends on the place

The first two kill the mutant.  Slack says which claim is missing; a mutant whose proof is lost may be slack too.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast

from safety.faults import Faulted
from safety.prove.claims import PROVED, REFUTED, Claim
from safety.prove.engines.engine import in_integers, uses_reals
from safety.prove.exclusions import exclusions
from safety.prove.mutation import Mutant, Mutants, mutants_of
from safety.prove.mutation_pair import difference
from safety.prove.mutation_questions import (
    breakable,
    cone,
    equivalent,
    equivalent_for,
    in_either_reading,
    still_proved,
    with_open_power_up,
)
from safety.prove.mutation_runs import Course, Lanes, Seen, confirmed, courses, only, single
from safety.prove.problem import Problem, build_problem
from safety.prove.refinement import build_refinement
from safety.prove.synthesis.synthesise import synthesise
from safety.system import System
from safety.terms import Bit, all_of, bit
from safety.terms.graph import variables

COUNTEREXAMPLE, TWIN, PROOF_LOST = "counterexample", "twin", "proof lost"
EQUIVALENT, SLACK, UNDECIDED, UNCLAIMED = "equivalent", "slack", "undecided", "unclaimed"
KILLED = (COUNTEREXAMPLE, TWIN)
SHORT = 12  # steps of the search for a run behind a proof that is lost
FAR = 20  # steps of the search for a run in which a mutant differs
SYNTHESIS = 30.0  # seconds for finding the lemmas of a claim
LONG = 512  # steps: a longer known run is run by fewer mutants
KINDS = (*KILLED, PROOF_LOST, EQUIVALENT, SLACK, UNDECIDED, UNCLAIMED)


@dataclass(frozen=True)
class Fate:
    """What became of a mutant: the kind, the claim that it came by, and what was seen."""

    mutant: Mutant
    kind: str
    claim: str = ""
    how: str = ""


@dataclass(eq=False)
class Case:
    """A claim with all mutants of its model."""

    claim: Claim
    mutants: Mutants
    timeout: float

    @cached_property
    def stated(self) -> Problem:
        """The claim's problem, about the mutant that SELECTOR says."""
        build = build_refinement if self.claim.refinement is not None else build_problem
        return build(self.claim, change=self.mutants.for_claim)

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
    def sees(self) -> set[int]:
        """The mutants that the claim depends on."""
        numbers, registers = cone(self.problem)
        return numbers | {m.number for m in self.mutants.mutants if m.power_up and m.power_up[0] in registers}

    @cached_property
    def courses(self) -> list[Course]:
        """The runs that the claim is known by."""
        return list(courses(self.as_written, uses_reals(self.as_written), self.timeout))

    @cached_property
    def problem(self) -> Problem:
        """The same with lemmas that the tool finds where the claim brings none and is not proved without."""
        problem = self.stated
        if problem.lemmas or self.claim.expect != PROVED or still_proved(problem, (), self.integers, self.timeout):
            return problem
        return replace(problem, lemmas=synthesise(self.as_written, SYNTHESIS).lemmas)

    def some(self, numbers: Collection[int]) -> Problem:
        """The problem of a few mutants, with what their registers hold at power-up."""
        return with_open_power_up(only(self.problem, numbers), [self.mutants[n] for n in sorted(numbers) if n])


def judged(claims: Sequence[Claim]) -> list[Claim]:
    """The claims that can notice a mutant: those that are proved or refuted as written."""
    return [claim for claim in claims if claim.expect in (PROVED, REFUTED)]


def mutants_for(claims: Sequence[Claim]) -> Mutants:
    """The mutants of the model that some claims are about; parameters that one of them changes are left open."""
    return mutants_of(claims[0].model, sorted({path for c in claims for path in (*c.symbolic, *c.settings)}))


class Subject:
    """A model with the claims on it, ready to examine mutants of it; `timeout` in seconds for each question."""

    def __init__(self, claims: Sequence[Claim], timeout: float = 20.0) -> None:
        self.timeout = timeout
        self.claims = judged(claims)
        self.mutants = mutants_for(self.claims)
        self.open = {path for c in self.claims for path in (*c.symbolic, *c.settings)}
        cases = [Case(c, self.mutants, timeout) for c in self.claims]
        self.proved = [case for case in cases if case.claim.expect == PROVED]
        self.refuted = [case for case in cases if case.claim.expect == REFUTED]

    def healthy(self, numbers: Collection[int]) -> Problem:
        """These mutants of the healthy model, in all its runs: a problem that claims nothing."""
        system = self.mutants.some(numbers)
        given = all_of(system.start, *(cast(Bit, a) for a in system.assumptions.values()))
        faulted = Faulted(system, (), (), (), ())
        return Problem(self.claims[0], system, faulted, bit(True), (), given, system.start, {})

    def examine(self, numbers: Collection[int]) -> list[Fate]:
        """What becomes of these mutants."""
        return _Examination(self, set(numbers)).fates()


def _length(case: Case) -> int:
    """How long the known runs of a claim are."""
    return sum(len(known.rows) for known in case.courses)


def _alike(problem: Problem, numbers: set[int], timeout: float, known: Sequence[Bit]) -> set[int]:
    """The mutants that step alike in the states that a problem leaves."""
    return in_either_reading(
        lambda left, integers: equivalent_for(problem, left, integers, timeout, known), numbers, uses_reals(problem)
    )


class _Examination:
    """What is known of some mutants so far; each step of `fates` takes those away whose fate it settles."""

    def __init__(self, subject: Subject, numbers: set[int]) -> None:
        self.subject, self.left = subject, numbers
        self.settled: dict[int, Fate] = {}
        self.differs: dict[int, tuple[str, str]] = {}  # a claim on whose known run it differs, and where
        self.lost: dict[int, tuple[Case, str]] = {}
        self.unknown: dict[int, str] = {}
        self.proved: set[Case] = set()  # as the model is written, here

    def fates(self) -> list[Fate]:
        """All fates, in the order of the mutants."""
        numbers = sorted(self.left)
        self._unclaimed()
        self._equivalent()
        for case in self.subject.proved:
            self._prove(case)
        self._equivalent_for_claims(self._of_the_step(), found=False)
        self._search_for_lost()
        for case in sorted(self.subject.proved, key=_length):
            self._run(case)
        for case in sorted(self.subject.refuted, key=_length):
            self._twin(case)
        for number in self.lost.keys() & self.left:
            case, label = self.lost[number]
            self.settle(number, PROOF_LOST, case.claim.id, label)
        self._slack()
        return [self.settled[n] for n in numbers]

    def settle(self, number: int, kind: str, claim: str = "", how: str = "") -> None:
        self.settled[number] = Fate(self.subject.mutants[number], kind, claim, how)
        self.left.discard(number)

    def _unclaimed(self) -> None:
        seen = set().union(*(case.sees for case in (*self.subject.proved, *self.subject.refuted)))
        values = {number for steps in self.subject.mutants.settings.values() for number, _ in steps}
        for number in self.left - seen:
            why = "no claim works with the value as written" if number in values else "no claim depends on it"
            self.settle(number, UNCLAIMED, "", why)

    def _followed(self, case: Case, numbers: Collection[int]) -> Iterator[tuple[Course, dict[int, Seen]]]:
        """The mutants on the claim's known runs; where they first differ is kept in mind."""
        if not numbers or not case.courses:
            return
        lanes = Lanes(case.problem, [self.subject.mutants[n] for n in sorted(numbers)])
        for known in case.courses:
            found = lanes.follow(known)
            for number, seen in found.items():
                if seen.differs:
                    step, name = seen.differs
                    self.differs.setdefault(number, (case.claim.id, f"{name} differs at step {step} of its run"))
            yield known, found

    def _run(self, case: Case) -> None:
        """Mutants whose proof is lost on the claim's known runs; long ones only for those that this claim's proof lost.

        A mutant for which all proofs go through breaks no claim in any run.
        """
        numbers = {n for n, (by, _) in self.lost.items() if by is case or _length(case) <= LONG}
        for known, found in self._followed(case, self.left & numbers & case.sees):
            for number, seen in found.items():
                if seen.broken is not None and number in self.left:
                    some = only(case.problem, {number})
                    confirmed(single(some, self.subject.mutants[number]), known, seen.broken)
                    self.settle(number, COUNTEREXAMPLE, case.claim.id, f"after {seen.broken + 1} steps")

    def _twin(self, case: Case) -> None:
        """A proof that is lost asks its claim's own twins only, a mutant that keeps all proofs asks every one.

        A search shorter than the known run kills nobody: the mutant may just be refuted later.
        """
        strangers = {n for n, (by, _) in self.lost.items() if by.claim.id != case.claim.twin_of}
        lost = self.left & case.sees - strangers
        for _, found in self._followed(case, lost):
            lost = lost - {number for number, seen in found.items() if seen.broken is not None}
        steps, known = case.claim.steps, max((len(course.rows) for course in case.courses), default=None)
        if not lost:
            return
        if known is None or steps < known:
            why = "no run that refutes it is known" if known is None else f"its run has {known} steps, a search {steps}"
            self.unknown |= dict.fromkeys(lost, f"{case.claim.id} is not refuted by a known run: {why}")
            return
        some = case.some(lost)
        searched = breakable(some, ~some.holds, lost, steps, uses_reals(some), self.subject.timeout)
        self.unknown |= {number: f"{case.claim.id}: {why}" for number, why in searched.open.items()}
        for number in searched.kept:
            self.settle(number, TWIN, case.claim.id, f"not refuted in {steps} steps")

    def _of_the_step(self) -> set[int]:
        """Mutants whose step is changed: one that powers up otherwise steps like the model, and is not it."""
        return {number for number in self.left if self.subject.mutants[number].power_up is None}

    def _equivalent(self) -> None:
        asked, timeout = self._of_the_step(), self.subject.timeout
        some = self.subject.mutants.some(asked)
        alike = in_either_reading(
            lambda left, integers: equivalent(some, left, integers, timeout),
            asked,
            uses_reals(self.subject.healthy(asked)),
        )
        for number in alike:
            self.settle(number, EQUIVALENT, "", "the same step in every state, whatever faults act")

    def _prove(self, case: Case) -> None:
        asked = self.left & case.sees - self.lost.keys()
        if not asked:
            return
        found = still_proved(case.some(asked), asked, case.integers, self.subject.timeout)
        if found is None:
            self.unknown |= dict.fromkeys(asked, f"{case.claim.id} has no proof by induction to compare with")
        else:
            self.proved.add(case)
            self.lost |= {number: (case, label) for number, label in found.failed.items()}
            self.unknown |= {number: f"{case.claim.id}: {why}" for number, why in found.open.items()}

    def _search_for_lost(self) -> None:
        """A proof that is lost may be so for a run that breaks the claim."""
        by_case: dict[Case, set[int]] = {}
        for number in self.lost.keys() & self.left:
            case, _ = self.lost[number]
            by_case.setdefault(case, set()).add(number)
        for case, numbers in by_case.items():
            some = case.some(numbers)
            steps = min(case.claim.steps, SHORT)
            found = breakable(some, ~some.holds, numbers, steps, uses_reals(some), self.subject.timeout)
            for number, when in found.failed.items():
                self.settle(number, COUNTEREXAMPLE, case.claim.id, when)

    def _equivalent_for_claims(self, numbers: set[int], found: bool) -> None:
        """Equivalent in every state that proved lemmas and assumptions leave, for each claim that sees the mutant.

        Without faults it is so in all runs, or else the mutant might show in runs that none of the claims is about.
        With `found`, registers that were found to exclude one another do so too.
        """
        timeout, kept = self.subject.timeout, numbers - self.lost.keys()
        healthy = self.subject.healthy(kept)
        known = exclusions(single(healthy, None), timeout) if found else ()
        always = _alike(healthy, kept, timeout, (*known, *self._lemmas_for(healthy.system, self.subject.open)))
        for case in self.subject.proved:
            asked = kept & case.sees
            if asked:
                some, as_written = case.some(asked), case.as_written
                if case not in self.proved:  # what its lemmas say may be false
                    some, as_written = replace(some, lemmas={}), replace(as_written, lemmas={})
                known = exclusions(as_written, timeout) if found else ()
                if not case.claim.faults and case.claim.refinement is None:
                    known = (*known, *self._lemmas_for(some.system, set(case.claim.symbolic)))
                kept = kept - asked | _alike(some, asked, timeout, known)
                always |= asked if case.unconditional else set()
        for number in sorted(kept & always):
            self.settle(number, EQUIVALENT, "", "the same step in every state that the claims' invariants leave")

    def _lemmas_for(self, system: System, symbolic: set[str]) -> list[Bit]:
        """Lemmas of all runs, proved here, that speak of the model's registers only: so they hold for other claims too.

        A lemma that is proved with a parameter left open holds for each value of it.
        """
        own = {s.var.uid for s in self.subject.mutants.system.states}
        registers = own & {s.var.uid for s in system.states}
        return [
            lemma
            for case in self.subject.proved
            if case in self.proved and case.unconditional and symbolic <= set(case.claim.symbolic)
            for lemma in case.as_written.lemmas.values()
            if all(v.uid in registers for v in variables([lemma]))
        ]

    def _slack(self) -> None:
        """Where all proofs go through and the mutant is not equivalent: the run in which it differs."""
        for number in sorted(self.left - self.unknown.keys()):
            if number in self.differs or self._search_for_difference(number):
                self.settle(number, SLACK, *self.differs[number])
        self._equivalent_for_claims(self._of_the_step(), found=True)
        silent = f"no run of up to {FAR} steps is known in which it differs"
        for number in sorted(self.left):
            self.settle(number, UNDECIDED, "", self.unknown.get(number, silent))

    def _search_for_difference(self, number: int) -> bool:
        mutant = self.subject.mutants[number]
        faulted = [(c.claim.id, c.problem) for c in self.subject.proved if c.claim.faults and number in c.sees]
        for claim, problem in [("", self.subject.healthy({number})), *faulted]:
            some = only(problem, {number})
            found = difference(some, mutant, FAR, uses_reals(some), self.subject.timeout / 4)
            if found is not None:
                self.differs[number] = claim, f"{found[1]} differs after {len(found[0])} steps"
                return True
        return False
